"""Reading, setting and stepping a native FMU: the limits, statuses and words of the live flavour."""

import math
from ctypes import byref, c_double, c_int, c_size_t, c_uint, c_void_p

import pytest
from live_fmus import live
from natives import DISCARD, ERROR, FATAL, OK

from loomfmu.components import COMPONENTS, WeftInsertion
from loomfmu.declaring.variables import variables_of

__all__ = ["live"]

every_fmu = pytest.mark.parametrize("name", COMPONENTS)


@every_fmu
def test_starts_are_the_declared_ones(native, name):
    instance = native(name)
    assert instance.set_up() == OK
    assert instance.call("EnterInitializationMode") == OK
    for variable in variables_of(COMPONENTS[name]):
        if variable.settable:
            (found,) = instance.get(variable.name)
            assert found == variable.start and type(found) is variable.type, variable.name


@pytest.mark.few(3)
@every_fmu
def test_what_is_refused_is_refused_in_the_words_of_the_live_flavour(native, live, name):
    # one of an array stands for all; an instance for each word: after an error it is of no more use
    ones = {(v.element.partition("[")[0] or v.name): v for v in variables_of(COMPONENTS[name])}
    for variable in ones.values():
        values = []
        if variable.type is float and variable.settable:
            values = [math.nan, math.inf, -math.inf]
        if variable.minimum is not None and variable.type is not bool:
            values += [variable.type(variable.minimum - 1)]
        if variable.maximum is not None and variable.type is not bool:
            values += [variable.type(variable.maximum + 1)]
        if not variable.settable:
            values += [variable.start]
        for value in values:
            compiled, python = native(name), live(name)
            for instance in (compiled, python):
                instance.call("setupExperiment", None, 0.0, None) if instance is python else instance.set_up()
                instance.set(**{variable.name: value})
                instance.call("enterInitializationMode" if instance is python else "EnterInitializationMode")
            assert compiled.log[0] == python.log[0], (variable.name, value)
            compiled.free()


def test_a_value_out_of_its_limits(native):
    instance = native("BeltMonitor")
    assert instance.set(guide_clearance=0.1) == ERROR
    assert instance.log == [(ERROR, "logStatusError", "guide_clearance = 100 mm is outside [0, 50] mm")]


def test_parameters_are_fixed_and_outputs_not_set(native):
    instance = native("WeftInsertion").start()
    assert instance.set(gear_ratio=9.0) == ERROR
    assert instance.texts[-1] == "gear_ratio is a fixed parameter and cannot be set while stepping"
    instance = native("WeftInsertion")
    assert instance.set(travel=0.1) == ERROR
    assert instance.texts[-1] == "travel is an output and cannot be set"


def test_references_of_another_kind(native):
    for kind, reference, word in (
        ("Real", 3, "Real"),
        ("Boolean", 1, "Boolean"),
        ("Real", 0, "Real"),
        ("Integer", 999, "Integer"),
    ):
        instance = native("WeftInsertion").start()
        place = (c_double if kind == "Real" else c_int)()
        assert instance.call(f"Get{kind}", (c_uint * 1)(reference), c_size_t(1), byref(place)) == ERROR
        assert instance.texts == [f"value reference {reference} is not a variable of type {word}"]
    instance = native("WeftInsertion")
    assert instance.call("SetString", (c_uint * 1)(5), c_size_t(1), (c_void_p * 1)()) == ERROR
    assert instance.texts == ["value reference 5 is not a variable of type String"]


def test_missing_arrays(native):
    for function in ("GetReal", "GetInteger", "GetBoolean", "GetString", "SetReal", "SetString"):
        instance = native("WeftInsertion")
        assert instance.set_up() == OK and instance.call("EnterInitializationMode") == OK
        assert instance.call(function, None, c_size_t(1), None) == ERROR
        assert instance.texts == ["value references or values are missing"]


def test_the_start_is_computed_when_it_is_read(native):
    instance = native("WeftInsertion")
    assert instance.set_up() == OK and instance.call("EnterInitializationMode") == OK
    for ratio in (9.0, 10.0):
        assert instance.set(gear_ratio=ratio) == OK
        component = WeftInsertion(gear_ratio=ratio)
        component.initialize(0.0)
        assert instance.get("stroke") == [component.stroke]
    assert instance.call("ExitInitializationMode") == OK


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("WeftInsertion", {"rocker_angle": 0.2}),
        ("WeftInsertion", {"coupler_length": 0.05}),
        ("WeftInsertion", {"assembly": 0}),
        ("HealdDamper", {"start_displacement": 0.02}),
    ],
)
def test_problems_are_told_as_the_live_flavour_tells_them(native, live, name, values):
    compiled, python = native(name), live(name)
    assert compiled.set_up() == OK and compiled.set(**values) == OK
    assert compiled.call("EnterInitializationMode") == OK
    assert compiled.call("ExitInitializationMode") == ERROR
    python.call("setupExperiment", None, 0.0, None)
    python.set(**values)
    python.call("enterInitializationMode")
    python.call("exitInitializationMode")
    assert compiled.texts == python.texts and len(compiled.texts) == 1
    assert compiled.step(0.0, 0.1) == ERROR


def test_a_warning_is_told_once(native, live):
    compiled, python = native("BeltMonitor"), live("BeltMonitor")
    for instance in (compiled, python):
        instance.start(guide_clearance=0.0015)
        for step in range(3):
            assert instance.step(step * 1e-3, 1e-3) == OK
    assert compiled.log == python.log and len(compiled.log) == 1
    assert compiled.texts[0].startswith("guide_clearance = 1.5 mm: above 1 mm")
    assert compiled.call("Reset") == OK
    compiled.start(guide_clearance=0.0015)
    assert len(compiled.log) == 2


@pytest.mark.parametrize(
    ("time", "size"),
    [
        (0.0, -1e-3),
        (0.0, math.nan),
        (0.0, math.inf),
        (math.nan, 1e-3),
        (math.inf, 0.0),
        (0.3, -123456.789),
        (1e22, -1e-7),
        (1e15, -1.0),
        (1e16, -2.5),
        (0.0001, -0.00001),
        (100.0, -12.0),
    ],
)
def test_a_step_that_is_none(native, live, time, size):
    compiled, python = native("MainShaft").start(), live("MainShaft").start()
    assert (compiled.step(time, size), python.step(time, size)) == (DISCARD, FATAL)
    assert compiled.texts[0] == python.texts[0]


def test_after_a_step_that_could_not_be_made(native):
    instance = native("WeftInsertion").start()
    assert instance.step(0.0, 0.25) == OK
    before = instance.variables()
    assert instance.step(0.25, -1.0) == DISCARD
    place, status, wish = c_double(), c_int(), c_int(7)
    assert instance.call("GetRealStatus", 2, byref(place)) == OK and place.value == 0.25
    assert instance.call("GetStatus", 0, byref(status)) == OK and status.value == DISCARD
    assert instance.call("GetBooleanStatus", 3, byref(wish)) == OK and wish.value == 0
    assert instance.call("GetRealStatus", 0, byref(place)) == DISCARD
    assert instance.variables() == before  # as the last step left them
    assert instance.call("Terminate") == OK


def test_a_component_that_reports_a_problem_in_a_step_stays_as_it_was(native):
    instance = native("HealdDamper").start(spring_stiffness=1e12, carrier_mass=1e-3)
    before = instance.variables()
    assert instance.step(0.0, 3600.0) == DISCARD
    assert (
        "more than 10,000 contacts or pieces of the carrier's motion (spring_stiffness = 1e+09 N/mm"
        in instance.texts[-1]
    )
    assert instance.variables() == before


def test_a_result_that_is_not_finite_is_none(native):
    instance = native("MainShaft").start(speed=1000.0)
    assert instance.step(1e308, 1e307) == DISCARD
    assert instance.texts == ["at 1e+308 s: angle is not finite"]


def test_no_step_goes_past_the_stop_time(native):
    instance = native("MainShaft")
    assert (instance.enter(1.0, 2.0), instance.call("ExitInitializationMode")) == (OK, OK)
    # what a host's own sum of steps is off does not count
    assert instance.step(1.0, 1.0 + 1e-10) == OK
    assert instance.step(1.9, 0.2) == ERROR
    assert instance.texts == ["step from 1.9 s by 0.2 s goes past the stop time"]
    for start, stop in ((2.0, 1.0), (math.nan, None), (math.inf, None), (0.0, math.nan)):
        assert native("MainShaft").set_up(start, stop) == ERROR


def test_the_experiment_comes_first(native):
    instance = native("MainShaft")
    assert instance.call("EnterInitializationMode") == ERROR
    assert instance.texts == ["fmi2SetupExperiment must be called first"]


def test_a_run_may_start_at_any_time(native):
    instance = native("MainShaft")
    assert (instance.enter(10.0), instance.call("ExitInitializationMode")) == (OK, OK)
    component = COMPONENTS["MainShaft"]()
    component.initialize(10.0)
    assert instance.get("angle") == [component.angle]


def test_a_shaft_beyond_all_picks(native):
    # 1e12 rad: a pick that the 32 bits of fmi2Integer do not hold
    instance = native("DobbyDrive").start(speed=1000.0)
    assert instance.step(1e9, 0.0) == DISCARD
    assert "more than 2e9 rad from zero" in instance.texts[0]
    assert instance.get("pick") == [0]


def test_reset_is_a_new_instance(native):
    used, fresh = native("BeltMonitor"), native("BeltMonitor")
    used.start(travel=0.9, guide_clearance=0.002)
    assert used.step(0.0, 0.01) == OK
    assert used.call("Reset") == OK
    for instance in (used, fresh):
        instance.start()
        assert instance.step(0.0, 0.01) == OK
    assert used.variables() == fresh.variables()


def test_a_native_one_is_used_like_a_live_one(native, live):
    compiled, python = (
        native("HealdFrame").start(pattern_length=5),
        live("HealdFrame").start(pattern_length=5),
    )
    for step in range(100):
        for instance in (compiled, python):
            assert instance.set(rotor_angle=0.3 * step) == OK
            assert instance.step(step * 1e-3, 1e-3) == OK
        assert compiled.outputs() == python.outputs()
