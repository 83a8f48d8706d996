"""Native FMUs of FMI 3: what is not as in FMI 2."""

import ctypes
import math
import random
import xml.etree.ElementTree as ElementTree
import zipfile
from ctypes import byref, c_double, c_size_t

import pytest
from driving import assign, drawn_inputs, drawn_parameters
from natives import DISCARD, ERROR, MEMORYLESS, OK, SOLVED, TIME

from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi.live_fmu import guid
from loomfmu.fmi.native import native_fmu

pytestmark = pytest.mark.no_cover  # FMUs beside components, step by step: the tests of these cover them
every_fmu = pytest.mark.parametrize("name", COMPONENTS)
TYPES = {float: "Float64", int: "Int64", bool: "Boolean"}


@pytest.mark.parametrize("fmi", [3])
@every_fmu
def test_its_variables_are_those_of_fmi_2_and_the_time(built, package, name, fmi):
    root = ElementTree.parse(package(name, fmi).directory / "modelDescription.xml").getroot()
    listed = root.find("ModelVariables")
    found = {each.get("name"): each for each in listed}
    assert list(found) == [*(port.own for port in built[name].ports.values()), "time"]
    assert found["time"].get("causality") == "independent" and found["time"].get("valueReference") == str(
        len(found)
    )
    for variable in variables_of(COMPONENTS[name]):
        port, element = built[name].ports[variable.name], found[variable.structured]
        assert element.tag == ("Enumeration" if variable.choices else TYPES[variable.type])
        assert (element.get("causality"), element.get("unit") or "1") == (port.causality, port.unit)
        assert int(element.get("valueReference")) == port.reference
        assert (element.get("start") is not None) == variable.settable
        assert element.get("initial") == (None if variable.settable else "calculated")
    assert root.get("instantiationToken") == guid(COMPONENTS[name])
    assert (root.find("ModelExchange") is not None) == (name in MEMORYLESS)


def test_outputs_list_what_they_depend_on(package):
    root = ElementTree.parse(package("WeftInsertion", 3).directory / "modelDescription.xml").getroot()
    names = [each.get("name") for each in root.find("ModelVariables")]
    depends = {
        names[int(each.get("valueReference")) - 1]: {
            names[int(word) - 1] for word in each.get("dependencies").split()
        }
        for each in root.iter("Output")
    }
    shaft = {"shaft_angle", "shaft_velocity", "shaft_acceleration"}
    assert depends["travel"] >= {*shaft, "time", "speed"}
    assert "moving_mass" not in depends["travel"]  # which the torque needs
    assert not depends["stroke"] & {*shaft, "time"} and "gear_ratio" in depends["stroke"]


def test_a_step_that_cannot_be_made_leaves_it_where_it_was(native):
    instance = native("WeftInsertion", fmi=3).start()
    assert instance.step(0.0, 0.1) == OK
    before = instance.variables()
    assert instance.step(0.1, -1.0) == DISCARD
    assert instance.reached.value == 0.1 and instance.variables() == before
    assert instance.step(0.1, 0.1) == OK  # the run goes on
    instance = native("MainShaft", fmi=3)
    assert instance.enter(0.0, 1.0) == OK and instance.call("ExitInitializationMode") == OK
    assert instance.step(0.9, 0.2) == ERROR
    for start, stop in ((math.nan, None), (1.0, 0.0)):
        assert native("MainShaft", fmi=3).enter(start, stop) == ERROR


def test_starts_can_be_read_before_the_initialization(native):
    instance = native("WeftInsertion", fmi=3)
    assert instance.get("gear_ratio") == [9.625]
    assert instance.set(gear_ratio=9.0) == OK and instance.get("gear_ratio") == [9.0]
    assert instance.enter(2.0) == OK
    component = COMPONENTS["WeftInsertion"](gear_ratio=9.0)
    component.initialize(2.0)
    assert instance.get("stroke", "travel", TIME) == [component.stroke, component.travel, 2.0]


def test_words_of_refusal(native):
    instance = native("BeltMonitor", fmi=3)
    assert instance.set(guide_clearance=0.1) == ERROR
    assert instance.log == [(ERROR, "logStatusError", "guide_clearance = 100 mm is outside [0, 50] mm")]
    instance = native("MainShaft", fmi=3)
    reference, one = (ctypes.c_uint32 * 1)(9), c_size_t(1)
    assert instance.call("SetFloat64", reference, one, byref(c_double(1.0)), one) == ERROR  # the time
    assert instance.texts == ["value reference 9 is not a variable of type Float64"]
    instance = native("MainShaft", fmi=3)
    assert instance.call("GetInt32", reference, one, byref(c_double()), one) == ERROR
    assert instance.texts == ["value reference 9 is not a variable of type Int32"]
    instance = native("MainShaft", fmi=3)
    assert instance.call("GetFloat64", reference, one, byref(c_double()), c_size_t(2)) == ERROR
    assert instance.texts == ["there must be as many values as value references"]


@pytest.mark.few(4)
@every_fmu
def test_what_is_said_to_have_no_memory_has_none(name):
    """A step of no length after any history shows what it shows on a fresh component."""
    component = COMPONENTS[name]
    rng = random.Random(5)
    differs = False
    for _ in range(30):
        parameters = drawn_parameters(component, rng)
        used, fresh = component(**parameters), component(**parameters)
        if used.initialize(0.0) or fresh.initialize(0.0):
            continue
        for _ in range(20):
            assign(used, drawn_inputs(component, rng))
            used.step(rng.uniform(0.0, 1.0), rng.choice([0.0, 1e-3, 0.02]))
        values, time = drawn_inputs(component, rng), rng.uniform(0.0, 1.0)
        for each in (used, fresh):
            assign(each, values)
            each.step(time, 0.0)
        outputs = [v.name for v in variables_of(component) if v.causality == "output"]
        differs = any(getattr(used, key) != getattr(fresh, key) for key in outputs)
        if differs:
            break
    assert differs == (name not in MEMORYLESS)


def test_time_can_go_back(native):
    instance = native("WeftInsertion", SOLVED, 3).ready()
    traces = []
    for times in ((0.1, 0.2, 0.3), (0.3, 0.2, 0.1)):
        found = {}
        for time in times:
            assert instance.set_time(time) == OK
            found[time] = instance.get("travel", "velocity", TIME)
        traces.append(found)
    assert traces[0] == traces[1]


@pytest.mark.slow
def test_it_is_built_for_all_platforms(tools, tmp_path):
    path = native_fmu.build_native("MainShaft", tmp_path, fmi=3)
    with zipfile.ZipFile(path) as zipped:
        places = {name.split("/")[1] for name in zipped.namelist() if name.startswith("binaries/")}
    assert places == {"x86_64-linux", "aarch64-linux", "x86_64-windows", "x86_64-darwin", "aarch64-darwin"}
