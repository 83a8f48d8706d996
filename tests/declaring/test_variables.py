"""Declarations: what is derived from them, and what a component is refused for."""

import math
from dataclasses import dataclass, field

import pytest

from loomfmu.declaring.declarations import Quantity, input_, output, parameter, state
from loomfmu.declaring.variables import Component, Problem, variables_of


@dataclass(slots=True)
class Pump(Component):
    """A pump that only tests know."""

    speed: float = parameter(
        "rad/s", 10.0, "Speed", display="rev/min", minimum=0.0, maximum=100.0, nominal=50.0
    )
    kind: int = parameter("1", 2, "Kind", choices=("gear", "vane", "screw"))
    open: bool = parameter("1", True, "Whether it is open")
    load: float = input_("N", 5.0, "Load", display="cN", maximum=1e3)
    angle: float = input_("rad", 0.0, "Angle", unbounded=True, rate="turning")
    turning: float = input_("rad/s", 0.0, "Turning")
    flow: float = output("m/s", "Flow", nominal=2.0, constant=True)
    strokes: int = output("1", "Strokes", start=0)
    primes: bool = output("1", "Whether it takes in liquid", start=False)
    level: float = state("m", "Level", start=1.5)
    passes: int = state("1", "Passes", start=0)
    primed: bool = state("1", "Whether it is primed", start=False)


@dataclass(slots=True)
class BigPump(Pump):
    """A pump with one variable more."""

    width: float = parameter("m", 0.5, "Width", minimum=0.0)


ROLES = {
    "speed": ("parameter", "fixed", float),
    "kind": ("parameter", "fixed", int),
    "open": ("parameter", "fixed", bool),
    "load": ("input", "continuous", float),
    "angle": ("input", "continuous", float),
    "turning": ("input", "continuous", float),
    "flow": ("output", "continuous", float),
    "strokes": ("output", "discrete", int),
    "primes": ("output", "discrete", bool),
    "level": ("local", "continuous", float),
    "passes": ("local", "discrete", int),
    "primed": ("local", "discrete", bool),
}
BY_NAME = {variable.name: variable for variable in variables_of(Pump)}


def test_order_is_that_of_the_declaration():
    names = [variable.name for variable in variables_of(Pump)]
    assert names == list(ROLES)
    # inherited variables come first, so that a base's references hold
    assert [variable.name for variable in variables_of(BigPump)] == [*names, "width"]


@pytest.mark.parametrize("name", ROLES)
def test_declared_roles(name):
    variable = BY_NAME[name]
    assert (variable.causality, variable.variability, variable.type) == ROLES[name]
    assert variable.settable is (variable.causality in ("parameter", "input"))


@pytest.mark.parametrize(
    ("name", "attribute", "value"),
    [
        ("speed", "display", "rev/min"),
        ("turning", "display", "rad/s"),  # the unit itself where none is given
        ("speed", "nominal", 50.0),
        ("angle", "unbounded", True),
        ("angle", "rate", "turning"),
        ("flow", "constant", True),
        ("strokes", "constant", False),
        ("flow", "start", 0.0),
        ("level", "start", 1.5),
    ],
)
def test_attributes_come_through(name, attribute, value):
    assert getattr(BY_NAME[name], attribute) == value


def test_a_quantity_gives_what_a_declaration_leaves_out():
    bore = Quantity("m", "mm", nominal=0.1).within(0.0, 1.0)
    given = parameter(bore, 0.5, "Bore", maximum=2.0).metadata
    assert given == parameter("m", 0.5, "Bore", display="mm", minimum=0.0, maximum=2.0, nominal=0.1).metadata
    assert output(bore, "Bore").metadata == output("m", "Bore", display="mm", nominal=0.1).metadata
    assert bore.within(0.0, 2.0, nominal=1e-3).nominal == 1e-3


def test_choices_bound_their_number():
    kind = BY_NAME["kind"]
    assert kind.choices == ("gear", "vane", "screw")
    assert (kind.minimum, kind.maximum) == (1, 3)
    assert Pump(kind=3).kind == 3
    with pytest.raises(ValueError, match=r"Pump\.kind = 4 must be 1 \(gear\), 2 \(vane\) or 3 \(screw\)"):
        Pump(kind=4)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"speed": 120.0}, "Pump.speed = 1145.916 rev/min is outside [0, 954.9297] rev/min"),
        ({"speed": -1e-9}, "Pump.speed = -9.549297e-09 rev/min is outside [0, 954.9297] rev/min"),
        ({"speed": math.nan}, "Pump.speed = nan is not a finite number"),
        ({"load": 1001.0}, "Pump.load = 100100 cN is outside [-inf, 100000] cN"),
        ({"load": -math.inf}, "Pump.load = -inf is not a finite number"),
        ({"angle": math.inf}, "Pump.angle = inf is not a finite number"),
        ({"kind": 0}, "Pump.kind = 0 must be 1 (gear), 2 (vane) or 3 (screw)"),
    ],
)
def test_refusals_name_variable_value_and_limits(given, message):
    with pytest.raises(ValueError) as refusal:
        Pump(**given)
    assert str(refusal.value) == message


def test_limits_themselves_are_allowed_and_outputs_have_none():
    assert Pump(speed=0.0, load=1e3).speed == 0.0
    assert Pump(speed=100.0, flow=math.inf).speed == 100.0


def test_a_field_without_declaration_is_refused():
    @dataclass(slots=True)
    class Careless(Component):
        ratio: float = 1.0

    with pytest.raises(TypeError, match="ratio is not declared by"):
        Careless()

    @dataclass(slots=True)
    class Startless(Component):
        ratio: float = field(metadata={"causality": "input"})

    with pytest.raises(TypeError, match="ratio is not declared by"):
        variables_of(Startless)


def test_a_component_has_to_say_what_it_does():
    assert Pump().check() == 0
    assert not Problem("it leaks").warning, "a problem ends the step unless it says otherwise"
    with pytest.raises(NotImplementedError):
        Pump().initialize(0.0)
    with pytest.raises(NotImplementedError):
        Pump().step(0.0, 1.0)
