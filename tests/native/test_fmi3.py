"""Native FMUs of FMI 3: co-simulation of all components, model exchange of those without memory."""

import ctypes
import math
import os
import random
import re
import subprocess
import xml.etree.ElementTree as ElementTree
import zipfile
from concurrent.futures import ThreadPoolExecutor
from ctypes import byref, c_bool, c_double, c_size_t, c_void_p

import fmpy
import pytest
from driving import assign, drawn_inputs, drawn_parameters
from fmpy.validation import validate_fmu
from natives import MEMORYLESS
from natives3 import DISCARD, ERROR, OK, TIME, TYPES, Native3, Unpacked3

from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing.built import file_of
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi.builder import guid
from loomfmu.fmi.native import builder as native_builder

pytestmark = pytest.mark.no_cover  # FMUs beside components, step by step: the tests of these cover them
every_fmu = pytest.mark.parametrize("name", COMPONENTS)
solved = pytest.mark.parametrize("name", MEMORYLESS)


@pytest.fixture(scope="module")
def built3(built, tmp_path_factory):
    """All FMUs of FMI 3."""
    folder = tmp_path_factory.mktemp("fmi3")

    def build(name: str) -> Unpacked3:
        path = file_of(COMPONENTS[name], "native", ("linux64",), 3)
        with zipfile.ZipFile(path) as zipped:
            zipped.extractall(folder / name)
        return Unpacked3(COMPONENTS[name], path, folder / name)

    with ThreadPoolExecutor(max_workers=4) as pool:
        return dict(zip(COMPONENTS, pool.map(build, COMPONENTS), strict=True))


@pytest.fixture
def native3(built3):
    opened: list[Native3] = []

    def open_(component: str, *kind: str, **options: object) -> Native3:
        opened.append(Native3(built3[component], *kind, **options))
        return opened[-1]

    yield open_
    for instance in opened:
        instance.free()


def solver_ready(instance: Native3, **values: object) -> Native3:
    """A model-exchange instance in continuous-time mode."""
    instance.start(**values)
    assert instance.update() == OK and not any(flag.value for flag in instance.flags)
    assert instance.call("EnterContinuousTimeMode") == OK
    return instance


# ---- what it is made of


@pytest.mark.few(4)
@every_fmu
def test_it_is_valid(built3, name):
    assert validate_fmu(str(built3[name].path)) == []


@every_fmu
def test_its_variables_are_those_of_fmi_2_and_the_time(built, built3, name):
    root = ElementTree.parse(built3[name].directory / "modelDescription.xml").getroot()
    listed = root.find("ModelVariables")
    found = {each.get("name"): each for each in listed}
    assert list(found) == [*(port.own for port in built[name].ports.values()), TIME]
    assert found[TIME].get("causality") == "independent" and found[TIME].get("valueReference") == str(
        len(found)
    )
    for variable in variables_of(COMPONENTS[name]):
        port, element = built[name].ports[variable.name], found[variable.structured]
        assert element.tag == ("Enumeration" if variable.choices else TYPES[variable.type][0])
        assert (element.get("causality"), element.get("unit") or "1") == (port.causality, port.unit)
        assert int(element.get("valueReference")) == port.reference
        assert (element.get("start") is not None) == variable.settable
        assert element.get("initial") == (None if variable.settable else "calculated")
    assert root.get("instantiationToken") == guid(COMPONENTS[name])
    assert (root.find("ModelExchange") is not None) == (name in MEMORYLESS)


def test_outputs_depend_on_what_they_are_declared_to(built3):
    root = ElementTree.parse(built3["WeftInsertion"].directory / "modelDescription.xml").getroot()
    names = [each.get("name") for each in root.find("ModelVariables")]
    depends = {
        names[int(each.get("valueReference")) - 1]: {
            names[int(word) - 1] for word in each.get("dependencies").split()
        }
        for each in root.iter("Output")
    }
    shaft = {"shaft_angle", "shaft_velocity", "shaft_acceleration"}
    assert depends["travel"] >= {*shaft, "time", "speed"}
    assert not depends["stroke"] & {*shaft, "time"} and "gear_ratio" in depends["stroke"]


@every_fmu
def test_it_exports_the_functions_of_the_standard_and_needs_only_libc_and_libm(built3, name):
    header = (native_builder.HEADERS / "fmi3Functions.h").read_text()
    wanted = set(re.findall(r"#define (fmi3\w+) +fmi3FullName\(fmi3\w+\)", header))
    run = subprocess.run(["objdump", "-T", built3[name].binary], capture_output=True, text=True, check=True)
    assert {line.split()[-1] for line in run.stdout.splitlines() if " g " in line} == wanted
    versions = re.findall(r"GLIBC_(\d+)\.(\d+)", run.stdout)
    assert max((int(major), int(minor)) for major, minor in versions) <= (2, 17)
    run = subprocess.run(["ldd", built3[name].binary], capture_output=True, text=True, check=True)
    needed = {line.split()[0].rsplit("/", 1)[-1] for line in run.stdout.splitlines()}
    assert needed <= {"linux-vdso.so.1", "libm.so.6", "libc.so.6", "ld-linux-x86-64.so.2"}


@pytest.mark.few(4)
@every_fmu
def test_its_sources_compile_without_a_warning(built3, gcc, name):
    warnings = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
    call = [gcc, "-std=c99", "-O1", *warnings, "-c", "fmi3.c", "-o", os.devnull]
    run = subprocess.run(
        call, cwd=built3[name].directory / "sources", capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr


# ---- co-simulation


@pytest.mark.few(5)
@every_fmu
def test_co_simulation_gives_the_results_of_the_component(native3, name):
    rng = random.Random(3)
    component = COMPONENTS[name](**drawn_parameters(COMPONENTS[name], rng))
    parameters = {v.name: getattr(component, v.name) for v in variables_of(type(component)) if v.settable}
    instance = native3(name)
    assert instance.set(**parameters) == OK
    assert instance.enter() == OK
    problem = component.initialize(0.0)
    if problem and not component.problems[problem - 1].warning:
        assert instance.call("ExitInitializationMode") == ERROR
        return
    assert instance.call("ExitInitializationMode") == OK
    time = 0.0
    for _ in range(100):
        values = drawn_inputs(COMPONENTS[name], rng)
        assign(component, values)
        assert instance.set(**values) == OK
        size = rng.choice([1e-4, 1e-3, 5e-3])
        component.step(time, size)
        assert instance.step(time, size) == OK, instance.texts
        time += size
        assert not any(flag.value for flag in instance.flags) and instance.reached.value == time
        for key, found in instance.variables().items():
            wanted = getattr(component, key)
            assert math.isclose(found, wanted, rel_tol=1e-12, abs_tol=1e-300), key
    assert instance.get(TIME) == [time]


@every_fmu
@pytest.mark.parametrize("kind", ["CoSimulation", "ModelExchange"])
def test_fmpy_simulates_it(built3, name, kind):
    if kind == "ModelExchange" and name not in MEMORYLESS:
        pytest.skip("it has a memory")
    found = fmpy.simulate_fmu(
        str(built3[name].path), stop_time=0.02, output_interval=1e-3, fmi_type=kind, validate=False
    )
    component = COMPONENTS[name]()
    assert component.initialize(0.0) == 0
    for sample, time in enumerate(found["time"]):
        if kind == "ModelExchange":
            assert component.step(float(time), 0.0) == 0
        for output in found.dtype.names[1:]:
            wanted = float(getattr(component, output))
            assert math.isclose(float(found[output][sample]), wanted, rel_tol=1e-12, abs_tol=1e-300), output
        if kind == "CoSimulation" and sample + 1 < len(found):
            assert component.step(float(time), float(found["time"][sample + 1] - time)) == 0


def test_a_step_that_cannot_be_made_leaves_it_where_it_was(native3):
    instance = native3("WeftInsertion").start()
    assert instance.step(0.0, 0.1) == OK
    before = instance.variables()
    assert instance.step(0.1, -1.0) == DISCARD
    assert instance.reached.value == 0.1 and instance.variables() == before
    assert instance.step(0.1, 0.1) == OK  # the run goes on
    instance = native3("MainShaft")
    assert instance.enter(0.0, 1.0) == OK and instance.call("ExitInitializationMode") == OK
    assert instance.step(0.9, 0.2) == ERROR
    for start, stop in ((math.nan, None), (1.0, 0.0)):
        assert native3("MainShaft").enter(start, stop) == ERROR


def test_starts_can_be_read_before_the_initialization(native3):
    instance = native3("WeftInsertion")
    assert instance.get("gear_ratio") == [9.625]
    assert instance.set(gear_ratio=9.0) == OK and instance.get("gear_ratio") == [9.0]
    assert instance.enter(2.0) == OK
    component = COMPONENTS["WeftInsertion"](gear_ratio=9.0)
    component.initialize(2.0)
    assert instance.get("stroke", "travel", TIME) == [component.stroke, component.travel, 2.0]


def test_words_of_refusal(native3):
    instance = native3("BeltMonitor")
    assert instance.set(guide_clearance=0.1) == ERROR
    assert instance.log == [(ERROR, "logStatusError", "guide_clearance = 100 mm is outside [0, 50] mm")]
    instance = native3("MainShaft")
    reference, one = (ctypes.c_uint32 * 1)(9), c_size_t(1)
    assert instance.call("SetFloat64", reference, one, byref(c_double(1.0)), one) == ERROR  # the time
    assert instance.texts == ["value reference 9 is not a variable of type Float64"]
    instance = native3("MainShaft")
    assert instance.call("GetInt32", reference, one, byref(c_double()), one) == ERROR
    assert instance.texts == ["value reference 9 is not a variable of type Int32"]
    instance = native3("MainShaft")
    assert instance.call("GetFloat64", reference, one, byref(c_double()), c_size_t(2)) == ERROR
    assert instance.texts == ["there must be as many values as value references"]


@pytest.mark.parametrize(
    ("kind", "options", "reason"),
    [
        ("CoSimulation", {"token": "another"}, "the token must be that of BeltMonitor"),
        ("CoSimulation", {"name": " "}, "the instance name is empty"),
        ("CoSimulation", {"name": None}, "the instance name is empty"),
        ("CoSimulation", {"event_mode": True}, "event mode is not supported"),
        ("ModelExchange", {}, "BeltMonitor keeps a state from step to step: it supports co-simulation only"),
        ("ScheduledExecution", {}, "scheduled execution is not supported"),
    ],
)
def test_an_instance_that_cannot_be_is_refused_with_a_reason(native3, kind, options, reason):
    instance = native3("BeltMonitor", kind, logging=False, **options)
    assert not instance.instance
    assert len(instance.log) == 1 and reason in instance.texts[0]


@pytest.mark.parametrize("name", COMPONENTS)
def test_derivatives_of_outputs(native3, name):
    instance = native3(name).start()
    rates = {v.name: v.rate for v in variables_of(COMPONENTS[name])}
    for variable in variables_of(COMPONENTS[name]):
        if variable.causality == "output" and variable.type is float:
            rate = rates[variable.name]
            wanted = (DISCARD, 0.0) if rate is None else (OK, instance.get(rate)[0])
            assert instance.output_derivative(variable.name, 1) == wanted


# ---- model exchange


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


@solved
def test_outputs_are_those_of_the_time_that_is_set(native3, name):
    component = COMPONENTS[name]()
    assert component.initialize(0.0) == 0
    instance = solver_ready(native3(name, "ModelExchange"))
    rng = random.Random(2)
    discrete = [v.name for v in variables_of(COMPONENTS[name]) if v.variability == "discrete"]
    for time in (rng.uniform(0.0, 2.0) for _ in range(50)):
        values = drawn_inputs(COMPONENTS[name], rng)
        assert (instance.set_time(time), instance.set(**values)) == (OK, OK)
        held = {key: getattr(component, key) for key in discrete}
        assign(component, values)
        assert component.step(time, 0.0) == 0
        found = instance.variables()
        for variable in variables_of(COMPONENTS[name]):
            if variable.causality == "output":
                wanted = held.get(variable.name, getattr(component, variable.name))
                assert found[variable.name] == wanted, variable.name
        moved = any(held[key] != getattr(component, key) for key in discrete)
        assert instance.completed() == moved
        if moved:  # the values that jump do so in event mode
            assert (instance.call("EnterEventMode"), instance.update()) == (OK, OK)
            assert instance.get(*discrete) == [getattr(component, key) for key in discrete]
            assert instance.call("EnterContinuousTimeMode") == OK


def test_time_can_go_back(native3):
    instance = solver_ready(native3("WeftInsertion", "ModelExchange"))
    traces = []
    for times in ((0.1, 0.2, 0.3), (0.3, 0.2, 0.1)):
        found = {}
        for time in times:
            assert instance.set_time(time) == OK
            found[time] = instance.get("travel", "velocity", TIME)
        traces.append(found)
    assert traces[0] == traces[1]


def test_there_are_no_states_and_no_event_indicators(native3):
    instance = solver_ready(native3("MainShaft", "ModelExchange"))
    for function in ("GetNumberOfContinuousStates", "GetNumberOfEventIndicators"):
        count = c_size_t(7)
        assert instance.call(function, byref(count)) == OK and count.value == 0
    for function in (
        "GetContinuousStates",
        "GetContinuousStateDerivatives",
        "GetNominalsOfContinuousStates",
        "GetEventIndicators",
        "SetContinuousStates",
    ):
        assert instance.call(function, None, c_size_t(0)) == OK
    assert instance.call("GetContinuousStates", None, c_size_t(1)) == ERROR
    assert solver_ready(native3("MainShaft", "ModelExchange")).set_time(math.inf) == ERROR


def test_an_instant_that_cannot_be_computed(native3):
    instance = solver_ready(native3("MainShaft", "ModelExchange"), speed=1000.0)
    assert instance.set_time(1e307) == OK
    one, value = c_size_t(1), c_double()
    assert instance.call("GetFloat64", instance.references(["angle"]), one, byref(value), one) == DISCARD
    assert instance.texts == ["at 1e+307 s: angle is not finite"]
    assert instance.set_time(1.0) == OK and instance.get("angle") == [1000.0]  # the run goes on


# ---- where functions may be called

STATES = {
    "CoSimulation": ("instantiated", "initialization", "step", "terminated", "error"),
    "ModelExchange": ("instantiated", "initialization", "event", "continuous", "terminated", "error"),
}
EVERYWHERE = {"instantiated", "initialization", "step", "event", "continuous", "terminated", "error"}
SOLVING = {"initialization", "event", "continuous", "terminated", "error"}
TABLE: dict[str, set[str]] = {
    "SetDebugLogging": EVERYWHERE,
    "EnterInitializationMode": {"instantiated"},
    "ExitInitializationMode": {"initialization"},
    "Terminate": {"step", "event", "continuous"},
    "Reset": EVERYWHERE,
    "GetFloat64": EVERYWHERE,
    "GetInt64": EVERYWHERE,
    "GetBoolean": EVERYWHERE,
    "GetString": EVERYWHERE,
    "SetFloat64": {"instantiated", "initialization", "step", "event", "continuous"},
    "SetInt64": {"instantiated", "initialization", "step", "event"},
    "SetBoolean": {"instantiated", "initialization", "step", "event"},
    "SetString": {"instantiated", "initialization", "step", "event"},
    "GetFMUState": EVERYWHERE,
    "SetFMUState": EVERYWHERE,
    "FreeFMUState": EVERYWHERE,
    "SerializedFMUStateSize": EVERYWHERE,
    "SerializeFMUState": EVERYWHERE,
    "DeserializeFMUState": EVERYWHERE,
    "DoStep": {"step"},
    "EnterStepMode": set(),
    "EnterEventMode": {"continuous"},
    "UpdateDiscreteStates": {"event"},
    "EnterContinuousTimeMode": {"event"},
    "CompletedIntegratorStep": {"continuous"},
    "SetTime": {"event", "continuous"},
    "SetContinuousStates": {"continuous"},
    "GetContinuousStates": SOLVING,
    "GetContinuousStateDerivatives": SOLVING,
    "GetNominalsOfContinuousStates": SOLVING,
    "GetEventIndicators": SOLVING,
    "GetOutputDerivatives": {"step", "terminated", "error"},
    "EvaluateDiscreteStates": set(),
    "EnterConfigurationMode": set(),
    "ExitConfigurationMode": set(),
    "GetDirectionalDerivative": set(),
    "GetAdjointDerivative": set(),
    "GetNumberOfVariableDependencies": set(),
    "GetVariableDependencies": set(),
    "ActivateModelPartition": set(),
    "GetClock": EVERYWHERE,
    "SetClock": EVERYWHERE,
}
OF_ONE_KIND = {  # asked of the other kind these are an error wherever they are called
    "ModelExchange": {name for name in TABLE if "Continuous" in name and "Get" in name}
    | {"GetEventIndicators", "SetContinuousStates"},
    "CoSimulation": {"GetOutputDerivatives"},
}


def brought_to(instance: Native3, kind: str, state: str) -> c_void_p:
    assert instance.call("Reset") == OK
    saved = instance.save()
    if state not in ("instantiated", "error"):
        assert instance.enter() == OK
    if state in ("step", "event", "continuous", "terminated"):
        assert instance.call("ExitInitializationMode") == OK
    if state == "continuous":
        assert instance.call("EnterContinuousTimeMode") == OK
    if state == "terminated":
        assert instance.call("Terminate") == OK
    if state == "error":
        assert instance.call("EnterConfigurationMode") == ERROR
    assert state in STATES[kind]
    return saved


def arguments(instance: Native3, function: str, saved: c_void_p) -> tuple[object, ...]:
    none, one, real = c_size_t(0), c_size_t(1), c_double(1.0)
    size = len(instance.packed(instance.save()))
    flags = [byref(c_bool()) for _ in range(5)]
    inputs, outputs = instance.references(["shaft_velocity"]), instance.references(["travel"])
    return {
        "SetDebugLogging": (True, none, None),
        "EnterInitializationMode": (False, real, real, False, real),
        "GetFloat64": (inputs, one, byref(real), one),
        "SetFloat64": (inputs, one, byref(real), one),
        "GetFMUState": (byref(c_void_p()),),
        "SetFMUState": (saved,),
        "FreeFMUState": (byref(c_void_p(saved.value)),),
        "SerializedFMUStateSize": (saved, byref(c_size_t())),
        "SerializeFMUState": (saved, ctypes.create_string_buffer(size), c_size_t(size)),
        "DeserializeFMUState": (instance.packed(saved), c_size_t(size), byref(c_void_p())),
        "DoStep": (real, real, True, *flags[:3], byref(c_double())),
        "UpdateDiscreteStates": (*flags, byref(c_double())),
        "CompletedIntegratorStep": (True, *flags[:2]),
        "SetTime": (real,),
        "GetOutputDerivatives": (outputs, one, (ctypes.c_int32 * 1)(1), byref(real), one),
    }.get(function, (None, none, None, none))


@pytest.mark.parametrize(
    ("kind", "state"), [(kind, state) for kind, states in STATES.items() for state in states]
)
def test_every_function_in_every_state(native3, kind, state):
    instance = native3("WeftInsertion", kind)
    for function, allowed in TABLE.items():
        saved = brought_to(instance, kind, state)
        given = arguments(instance, function, saved)
        instance.log.clear()
        status = instance.call(function, *given)
        other = next(each for each in STATES if each != kind)
        fits = state in allowed and function not in OF_ONE_KIND[other]
        assert status == (OK if fits else ERROR), (function, instance.texts)
        assert len(instance.log) == (0 if fits else 1), function


def test_the_table_is_complete():
    header = (native_builder.HEADERS / "fmi3Functions.h").read_text()
    named = set(re.findall(r"#define fmi3(\w+) +fmi3FullName\(fmi3\w+\)", header))
    rest = {name for name in named - set(TABLE) if not re.match(r"(Get|Set)(U?Int\d+|Float32|Binary)$", name)}
    assert rest == {
        "GetVersion",
        "InstantiateCoSimulation",
        "InstantiateModelExchange",
        "InstantiateScheduledExecution",
        "FreeInstance",
        "GetIntervalDecimal",
        "GetIntervalFraction",
        "GetShiftDecimal",
        "GetShiftFraction",
        "SetIntervalDecimal",
        "SetIntervalFraction",
        "SetShiftDecimal",
        "SetShiftFraction",
        "GetNumberOfContinuousStates",
        "GetNumberOfEventIndicators",
    }


# ---- state


@every_fmu
def test_a_restored_state_goes_on_as_if_nothing_had_happened(native3, name):
    def run(instance: Native3, first: int, last: int) -> list[dict[str, object]]:
        found = []
        for step in range(first, last):
            assert instance.set(**drawn_inputs(COMPONENTS[name], random.Random(step))) == OK
            assert instance.step(step * 1e-3, 1e-3) == OK
            found.append(instance.variables())
        return found

    instance, other = native3(name).start(), native3(name)
    run(instance, 0, 10)
    state = instance.save()
    ahead = run(instance, 10, 20)
    assert instance.call("SetFMUState", state) == OK and run(instance, 10, 20) == ahead
    status, copy = other.unpack(instance.packed(state))
    assert status == OK and other.call("SetFMUState", copy) == OK and run(other, 10, 20) == ahead
    assert (instance.drop(state), other.drop(copy)) == (OK, OK)


def test_a_state_of_the_other_interface_is_refused(native3):
    stepped, solving = native3("MainShaft").start(), solver_ready(native3("MainShaft", "ModelExchange"))
    state = stepped.save()
    status, copy = solving.unpack(stepped.packed(state))
    assert status == OK
    assert solving.call("SetFMUState", copy) == ERROR
    assert solving.texts == ["the FMU state belongs to another interface type"]
    assert (stepped.drop(state), solving.drop(copy)) == (OK, OK)


@pytest.mark.slow
def test_it_is_built_for_all_platforms(tools, tmp_path):
    path = native_builder.build_native("MainShaft", tmp_path, fmi=3)
    with zipfile.ZipFile(path) as zipped:
        places = {name.split("/")[1] for name in zipped.namelist() if name.startswith("binaries/")}
    assert places == {"x86_64-linux", "x86_64-windows", "x86_64-darwin", "aarch64-darwin"}
