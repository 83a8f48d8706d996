"""Model exchange of native FMUs: the results of co-simulation, and events at the instants of jumps."""

import math
import random
from ctypes import byref, c_double, c_size_t
from itertools import pairwise

import fmpy
import numpy as np
import pytest
from driving import assign, drawn_inputs
from natives import DISCARD, ERROR, MEMORYLESS, OK, SOLVED, STEPPED

from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import variables_of

solved = pytest.mark.parametrize("name", MEMORYLESS)
either_fmi = pytest.mark.parametrize("fmi", [2, 3])
REVOLUTION = 0.15  # s, at 400 rev/min


@either_fmi
@solved
def test_outputs_are_those_of_the_time_that_is_set(native, name, fmi):
    component = COMPONENTS[name]()
    assert component.initialize(0.0) == 0
    instance = native(name, SOLVED, fmi).ready()
    rng = random.Random(2)
    declared = variables_of(COMPONENTS[name])
    discrete = [v.name for v in declared if v.variability == "discrete"]
    zeros = [v.name for v in declared if v.indicator]
    for time in (rng.uniform(0.0, 2.0) for _ in range(50)):
        values = drawn_inputs(COMPONENTS[name], rng)
        assert (instance.set_time(time), instance.set(**values)) == (OK, OK)
        held = {key: getattr(component, key) for key in discrete}
        assign(component, values)
        assert component.step(time, 0.0) == 0
        assert instance.indicators(len(zeros)) == [getattr(component, key) for key in zeros]
        found = instance.variables()
        for variable in declared:
            if variable.causality == "output":
                wanted = held.get(variable.name, getattr(component, variable.name))
                assert found[variable.name] == wanted, variable.name
        moved = any(held[key] != getattr(component, key) for key in discrete)
        assert instance.completed() == moved
        if moved:  # the values that jump do so in event mode
            assert (instance.call("EnterEventMode"), instance.update()) == (OK, OK)
            assert instance.get(*discrete) == [getattr(component, key) for key in discrete]
            assert instance.call("EnterContinuousTimeMode") == OK


@either_fmi
def test_there_are_no_states_and_as_many_indicators_as_are_told(native, fmi):
    def ready(name="DobbyDrive"):
        return native(name, SOLVED, fmi).ready()

    instance = ready()
    none, one, value = c_size_t(0), c_size_t(1), c_double()
    derivatives = "GetDerivatives" if fmi == 2 else "GetContinuousStateDerivatives"
    for function in (
        *("GetContinuousStates", derivatives),
        *("GetNominalsOfContinuousStates", "SetContinuousStates"),
    ):
        assert instance.call(function, None, none) == OK
        assert ready().call(function, byref(value), one) == ERROR
    assert instance.call("GetEventIndicators", byref(value), one) == OK
    assert instance.call("GetEventIndicators", byref(value), none) == ERROR
    assert ready("MainShaft").set_time(math.inf) == ERROR
    if fmi == 3:
        for function, wanted in (("GetNumberOfContinuousStates", 0), ("GetNumberOfEventIndicators", 1)):
            count = c_size_t(7)
            assert ready().call(function, byref(count)) == OK and count.value == wanted


@pytest.mark.parametrize(("fmi", "status"), [(2, ERROR), (3, DISCARD)])
def test_an_instant_that_cannot_be_computed(native, fmi, status):
    instance = native("MainShaft", SOLVED, fmi).ready(speed=1000.0)
    assert instance.set_time(1e307) == OK
    read = ("GetReal" if fmi == 2 else "GetFloat64", instance.references(["angle"]))
    assert instance.call(*read, *instance.counted(byref(c_double()))) == status
    assert instance.texts == ["at 1e+307 s: angle is not finite"]
    if fmi == 3:
        assert instance.set_time(1.0) == OK and instance.get("angle") == [1000.0]  # the run goes on


@either_fmi
def test_a_state_is_restored_in_its_own_interface_alone(native, fmi):
    solving, stepping = native("MainShaft", SOLVED, fmi).ready(), native("MainShaft", fmi=fmi).start()
    assert solving.set_time(0.5) == OK
    saved, angle = solving.save(), solving.get("angle")
    assert solving.set_time(0.7) == OK and solving.get("angle") != angle
    assert solving.call("SetFMUstate", saved) == OK and solving.get("angle") == angle
    assert stepping.call("SetFMUstate", saved) == ERROR
    assert stepping.texts == ["the FMU state belongs to another interface type"]
    stepped = native("MainShaft", fmi=fmi).start()
    status, copy = solving.unpack(stepped.packed(stepped.save()))
    assert (status, solving.call("SetFMUstate", copy)) == (OK, ERROR)


# ---- in a tool with a solver


@solved
def test_a_solver_finds_what_co_simulation_finds(built, name):
    declared = variables_of(COMPONENTS[name])
    outputs = [v.name for v in declared if v.causality == "output"]
    # inputs are not carried over the steps: a solver does not do that either
    held = {v.name: True for v in declared if v.name == "inputs_at_step_end"}
    solving, stepping = (
        fmpy.simulate_fmu(
            str(built[name].path),
            fmi_type=kind,
            stop_time=0.4,
            output_interval=1e-3,
            output=outputs,
            start_values=held,
            record_events=False,
        )
        for kind in (SOLVED, STEPPED)
    )
    assert len(solving) == len(stepping)
    for output in outputs:
        one, other = (found[output].astype(float) for found in (solving, stepping))
        # times differ by rounding, 1e-16 s, at rates of up to 1e6 of the largest value in a second; where an
        # output jumps at a sample, rounding says on which side of it the sample lies
        away = np.flatnonzero(np.abs(one - other) > 1e-9 * max(1.0, float(np.max(np.abs(other)))))
        assert len(away) <= 3, output
        for sample in away:
            assert one[sample] in (pytest.approx(other[sample - 1]), pytest.approx(other[sample + 1]))


@pytest.fixture
def solve(package):
    """Runs an FMU of either FMI with fmpy's solver, all events recorded."""

    def run(name: str, fmi: int, **options: object) -> np.ndarray:
        path = str(package(name, fmi).path)
        return fmpy.simulate_fmu(path, fmi_type=SOLVED, stop_time=1.0, output_interval=0.1, **options)

    return run


def jumps(result: np.ndarray, output: str) -> list[float]:
    """Times at which an output jumps: recorded before and after, at one and the same time."""
    found = []
    for before, after in pairwise(result):
        if before[output] != after[output]:
            assert before["time"] == after["time"], "it jumps in an event"
            found.append(float(after["time"]))
    return found


@either_fmi
def test_the_pick_changes_where_it_does_whatever_the_solver_steps(solve, fmi):
    # the solver brackets a sign change to some 1e-15 of its time
    found = solve("DobbyDrive", fmi, output=["pick"])
    assert jumps(found, "pick") == pytest.approx([n * REVOLUTION for n in range(1, 7)], abs=1e-12)


@either_fmi
def test_a_frame_begins_and_ends_its_changes_at_slow_points(solve, fmi):
    speed = 40.0
    turning = np.array(
        [(0.0, 0.0, speed, 0.0), (1.0, speed, speed, 0.0)],
        dtype=[(key, float) for key in ("time", "rotor_angle", "rotor_velocity", "rotor_acceleration")],
    )
    found = solve(
        "HealdFrame",
        fmi,
        input=turning,
        start_values={"pattern_length": 4, "pattern[1]": 6},
        output=["moving"],
    )
    # pegs 0 1 1 0: it changes, holds, changes, holds
    wanted = [2.0 * math.pi * n / speed for n in range(1, 7)]
    assert jumps(found, "moving") == pytest.approx(wanted, abs=1e-12)


@either_fmi
def test_the_lock_is_late_from_its_speed_limit_on(solve, fmi):
    faster = np.array(
        [(0.0, 0.0, 20.0, 0.0), (1.0, 0.0, 100.0, 0.0)],
        dtype=[(key, float) for key in ("time", "shaft_angle", "shaft_velocity", "shaft_acceleration")],
    )
    found = solve(
        "PatternLock",
        fmi,
        input=faster,
        start_values={"follow_shaft": True},
        output=["in_time", "speed_limit"],
    )
    limit = float(found["speed_limit"][0])
    assert jumps(found, "in_time") == pytest.approx([(limit - 20.0) / 80.0], abs=1e-11)
