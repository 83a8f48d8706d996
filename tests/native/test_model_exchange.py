"""Model exchange of native FMUs: the results of co-simulation, and events at the instants of jumps."""

import math
import random
from ctypes import Structure, byref, c_double, c_int, c_size_t
from itertools import pairwise

import fmpy
import numpy as np
import pytest
from driving import assign, drawn_inputs
from natives import ERROR, MEMORYLESS, OK, Native

from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi.native import builder as native_builder

solved = pytest.mark.parametrize("name", MEMORYLESS)
either_fmi = pytest.mark.parametrize("fmi", [2, 3])
MODEL_EXCHANGE, REVOLUTION = 0, 0.15  # s, at 400 rev/min


class EventInfo(Structure):
    _fields_ = (*((f"flag_{n}", c_int) for n in range(5)), ("next_event", c_double))


def update(instance: Native) -> int:
    info = EventInfo(*[1] * 5, 1.0)
    status = instance.call("NewDiscreteStates", byref(info))
    assert [getattr(info, name) for name, _type in EventInfo._fields_] == [0] * 6 or status != OK
    return status


def solver_ready(instance: Native, **values: object) -> Native:
    """A model-exchange instance in continuous-time mode."""
    instance.start(**values)
    assert (update(instance), instance.call("EnterContinuousTimeMode")) == (OK, OK)
    return instance


def completed(instance: Native) -> bool:
    event, terminate = c_int(7), c_int(7)
    assert instance.call("CompletedIntegratorStep", 1, byref(event), byref(terminate)) == OK
    assert terminate.value == 0
    return bool(event.value)


def indicators(instance: Native, count: int) -> list[float]:
    values = (c_double * count)()
    assert instance.call("GetEventIndicators", values, c_size_t(count)) == OK, instance.texts
    return list(values)


# ---- FMI 2.0: what FMI 3.0 has, by the calls of FMI 2.0


@solved
def test_outputs_are_those_of_the_time_that_is_set(native, name):
    component = COMPONENTS[name]()
    assert component.initialize(0.0) == 0
    instance = solver_ready(native(name, kind=MODEL_EXCHANGE))
    rng = random.Random(2)
    declared = variables_of(COMPONENTS[name])
    discrete = [v.name for v in declared if v.variability == "discrete"]
    zeros = [v.name for v in declared if v.indicator]
    for time in (rng.uniform(0.0, 2.0) for _ in range(50)):
        values = drawn_inputs(COMPONENTS[name], rng)
        assert instance.call("SetTime", c_double(time)) == OK
        assert instance.set(**values) == OK
        held = {key: getattr(component, key) for key in discrete}
        assign(component, values)
        assert component.step(time, 0.0) == 0
        assert indicators(instance, len(zeros)) == [getattr(component, key) for key in zeros]
        found = instance.variables()
        for variable in declared:
            if variable.causality == "output":
                wanted = held.get(variable.name, getattr(component, variable.name))
                assert found[variable.name] == wanted, variable.name
        moved = any(held[key] != getattr(component, key) for key in discrete)
        assert completed(instance) == moved
        if moved:  # the values that jump do so in event mode
            assert (instance.call("EnterEventMode"), update(instance)) == (OK, OK)
            assert instance.get(*discrete) == [getattr(component, key) for key in discrete]
            assert instance.call("EnterContinuousTimeMode") == OK


def test_a_component_that_remembers_is_for_co_simulation(native):
    instance = native("BeltMonitor", kind=MODEL_EXCHANGE)
    assert not instance.component
    assert "BeltMonitor keeps a state from step to step: it supports co-simulation only" in instance.texts[0]


def test_there_are_no_states_and_as_many_indicators_as_are_told(native):
    instance = solver_ready(native("DobbyDrive", kind=MODEL_EXCHANGE))
    none, one, value = c_size_t(0), c_size_t(1), c_double()
    for function in (
        "GetContinuousStates",
        "GetDerivatives",
        "GetNominalsOfContinuousStates",
        "SetContinuousStates",
    ):
        assert instance.call(function, None, none) == OK
        assert (
            solver_ready(native("DobbyDrive", kind=MODEL_EXCHANGE)).call(function, byref(value), one) == ERROR
        )
    assert instance.call("GetEventIndicators", byref(value), one) == OK
    assert instance.call("GetEventIndicators", byref(value), none) == ERROR
    assert solver_ready(native("MainShaft", kind=MODEL_EXCHANGE)).call("SetTime", c_double(math.inf)) == ERROR


def test_an_instant_that_cannot_be_computed(native):
    instance = solver_ready(native("MainShaft", kind=MODEL_EXCHANGE), speed=1000.0)
    assert instance.call("SetTime", c_double(1e307)) == OK
    value = c_double()
    assert instance.call("GetReal", instance.references(["angle"]), c_size_t(1), byref(value)) == ERROR
    assert instance.texts == ["at 1e+307 s: angle is not finite"]


def test_a_state_is_restored_in_its_own_interface_alone(native):
    solving, stepping = solver_ready(native("MainShaft", kind=MODEL_EXCHANGE)), native("MainShaft").start()
    assert solving.call("SetTime", c_double(0.5)) == OK
    saved, angle = solving.save(), solving.get("angle")
    assert solving.call("SetTime", c_double(0.7)) == OK
    assert solving.call("SetFMUstate", saved) == OK and solving.get("angle") == angle
    assert stepping.call("SetFMUstate", saved) == ERROR
    assert stepping.texts == ["the FMU state belongs to another interface type"]
    assert solving.call("SetFMUstate", native("MainShaft").start().save()) == ERROR


# section 3.2.3 of FMI 2.0: where each function may be called
STATES = ("instantiated", "initialization", "event", "continuous", "terminated", "error")
TABLE = {
    "ExitInitializationMode": ("initialization",),
    "Terminate": ("event", "continuous"),
    "GetReal": STATES[1:],
    "GetInteger": STATES[1:],
    "SetReal": STATES[:4],
    "SetInteger": STATES[:3],
    "SetBoolean": STATES[:3],
    "EnterEventMode": ("event", "continuous"),
    "NewDiscreteStates": ("event",),
    "EnterContinuousTimeMode": ("event",),
    "CompletedIntegratorStep": ("continuous",),
    "SetTime": ("event", "continuous"),
    "SetContinuousStates": ("continuous",),
    "GetEventIndicators": STATES[1:],
    "GetContinuousStates": STATES[1:],
    "GetDerivatives": STATES[1:],
    "GetNominalsOfContinuousStates": STATES[1:],
    "DoStep": (),
    "GetRealOutputDerivatives": ("terminated", "error"),
}


@pytest.mark.parametrize("state", STATES)
def test_every_function_in_every_state(native, state):
    instance = native("MainShaft", kind=MODEL_EXCHANGE)
    none = c_size_t(0)
    arguments = {
        "SetTime": (c_double(0.1),),
        "NewDiscreteStates": (byref(EventInfo()),),
        "CompletedIntegratorStep": (1, byref(c_int()), byref(c_int())),
        "DoStep": (c_double(0.0), c_double(1e-3), 1),
        "GetRealOutputDerivatives": (None, none, None, None),
    }
    for function, allowed in TABLE.items():
        assert instance.call("Reset") == OK
        assert instance.set_up() == OK
        if state != "instantiated":
            assert instance.call("EnterInitializationMode") == OK
        if state not in STATES[:2]:
            assert instance.call("ExitInitializationMode") == OK
        if state == "continuous":
            assert (update(instance), instance.call("EnterContinuousTimeMode")) == (OK, OK)
        if state == "terminated":
            assert instance.call("Terminate") == OK
        if state == "error":
            assert instance.call("CancelStep") == ERROR
        values = (None, none) if "States" in function or "Indic" in function or "Deriv" in function else ()
        given = arguments.get(function, values)
        if function in ("GetReal", "GetInteger", "SetReal", "SetInteger", "SetBoolean"):
            given = (None, none, None)
        assert instance.call(function, *given) == (OK if state in allowed else ERROR), function


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
        for kind in ("ModelExchange", "CoSimulation")
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
def solve(built, tmp_path):
    """Runs an FMU of either FMI with fmpy's solver, all events recorded."""

    def run(name: str, fmi: int, **options: object) -> np.ndarray:
        path = built[name].path
        if fmi == 3:
            path = native_builder.build_native(name, tmp_path, ("linux64",), 3)
        return fmpy.simulate_fmu(
            str(path), fmi_type="ModelExchange", stop_time=1.0, output_interval=0.1, **options
        )

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
