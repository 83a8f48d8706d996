"""Arrays: variables like any other from outside, one tuple from inside."""

from dataclasses import dataclass

import pytest

from loomfmu.declaring.arrays import array
from loomfmu.declaring.declarations import output, parameter, state
from loomfmu.declaring.variables import Component, arrays_of, variables_of


@dataclass(slots=True)
class Pump(Component):
    """A pump without valves."""

    speed: float = parameter("rad/s", 10.0, "Speed")


@dataclass(slots=True)
class Valves(Pump):
    """A pump with valves that only tests know."""

    valve: tuple[float, ...] = array(
        parameter("m", 0.1 * number, f"Valve {number}", display="mm", minimum=0.0, maximum=1.0)
        for number in (1, 2, 3)
    )
    lifted: tuple[int, ...] = array(state("1", "How often it was lifted", start=0) for _ in range(3))
    height: float = output("m", "Height")


def test_an_array_is_numbered_variables_in_its_place():
    declared = variables_of(Valves)[len(variables_of(Pump)) :]
    names = [f"{stem}_{number}" for stem in ("valve", "lifted") for number in (1, 2, 3)]
    assert [variable.name for variable in declared] == [*names, "height"]
    second = declared[1]
    assert (second.start, second.type, second.display, second.maximum) == (0.2, float, "mm", 1.0)
    assert (second.description, second.member, second.structured) == ("Valve 2", "valve[1]", "valve[2]")
    assert declared[-1].member == "height"
    assert declared[3].structured == "internal.lifted[1]"
    assert {name: len(same) for name, same in arrays_of(Valves).items()} == {"valve": 3, "lifted": 3}
    assert arrays_of(Pump) == {}


def test_an_array_reads_and_sets_its_variables():
    pump = Valves(valve_2=0.5)
    assert pump.valve == (0.1, 0.5, 0.1 * 3)
    pump.valve_3 = 0.75
    assert pump.valve[-1] == 0.75
    pump.lifted = (4, 5, 6)
    assert (pump.lifted_1, pump.lifted_2, pump.lifted_3) == (4, 5, 6)
    assert Valves().lifted == (0, 0, 0), "another one has its own"
    assert pump.valve == (0.1, 0.5, 0.75)
    with pytest.raises(ValueError):
        pump.lifted = (1, 2)
    with pytest.raises(ValueError, match=r"Valves\.valve_2 = 2000 mm is outside \[0, 1000\] mm"):
        Valves(valve_2=2.0)


def test_an_array_is_of_one_type_and_has_one():
    for starts in ((), (1.0,), (1.0, 2)):
        with pytest.raises(TypeError, match="an array has two variables or more, all of one type"):
            array(parameter("1", start, "A number") for start in starts)
    with pytest.raises((TypeError, RuntimeError)) as refusal:  # a RuntimeError from it before Python 3.12

        class Untyped(Component):
            ratio = array(parameter("1", start, "A number") for start in (1.0, 2.0))

    text = f"{refusal.value} {refusal.value.__cause__}"
    assert "an array needs its type: ratio: tuple[float, ...] = array(...)" in text
