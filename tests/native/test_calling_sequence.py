"""Every function of the standards in every state: what their tables of calling sequences ask for."""

import ctypes
import re
from ctypes import byref, c_double, c_int, c_size_t, c_void_p

import pytest
from natives import DISCARD, ERROR, OK, SOLVED, STEPPED, WARNING, EventInfo, Instance, Native

from loomfmu.fmi.native.native_fmu import HEADERS

# section 4.2.4 of FMI 2.0: where each function may be called in co-simulation, except that values may be read
# before it is set up, as in FMI 3.0
STATES = ("instantiated", "initialization", "step", "failed", "terminated", "error")
STEPPED_2 = {
    "SetDebugLogging": STATES,
    "SetupExperiment": ("instantiated",),
    "EnterInitializationMode": ("instantiated",),
    "ExitInitializationMode": ("initialization",),
    "Terminate": ("step", "failed"),
    "Reset": STATES,
    "GetReal": STATES,
    "GetInteger": STATES,
    "GetBoolean": STATES,
    "GetString": STATES,
    "SetReal": STATES[:3],
    "SetInteger": STATES[:3],
    "SetBoolean": STATES[:3],
    "SetString": STATES[:3],
    "GetFMUstate": STATES,
    "SetFMUstate": STATES,
    "FreeFMUstate": STATES,
    "SerializedFMUstateSize": STATES,
    "SerializeFMUstate": STATES,
    "DeSerializeFMUstate": STATES,
    "GetDirectionalDerivative": STATES[1:],
    "SetRealInputDerivatives": STATES[:3],
    "GetRealOutputDerivatives": STATES[2:],
    "DoStep": ("step",),
    "CancelStep": (),  # a step is never under way
    "GetStatus": ("step", "failed", "terminated"),
    "GetRealStatus": ("step", "failed", "terminated"),
    "GetIntegerStatus": ("step", "failed", "terminated"),
    "GetBooleanStatus": ("step", "failed", "terminated"),
    "GetStringStatus": ("step", "failed", "terminated"),
}
NONE_KEPT = ("GetIntegerStatus", "GetStringStatus")  # allowed, but there is nothing to tell

# section 3.2.3: and in model exchange
SOLVING = ("instantiated", "initialization", "event", "continuous", "terminated", "error")
SOLVED_2 = {
    "ExitInitializationMode": ("initialization",),
    "Terminate": ("event", "continuous"),
    "GetReal": SOLVING,
    "GetInteger": SOLVING,
    "SetReal": SOLVING[:4],
    "SetInteger": SOLVING[:3],
    "SetBoolean": SOLVING[:3],
    "EnterEventMode": ("event", "continuous"),
    "NewDiscreteStates": ("event",),
    "EnterContinuousTimeMode": ("event",),
    "CompletedIntegratorStep": ("continuous",),
    "SetTime": ("event", "continuous"),
    "SetContinuousStates": ("continuous",),
    "GetEventIndicators": SOLVING[1:],
    "GetContinuousStates": SOLVING[1:],
    "GetDerivatives": SOLVING[1:],
    "GetNominalsOfContinuousStates": SOLVING[1:],
    "DoStep": (),
    "GetRealOutputDerivatives": ("terminated", "error"),
    "GetDirectionalDerivative": SOLVING[1:],
}

# FMI 3.0, both interfaces; its functions by the names that FMI 2 has for them
EVERYWHERE = {"instantiated", "initialization", "step", "event", "continuous", "terminated", "error"}
SOLVERS = {"initialization", "event", "continuous", "terminated", "error"}
TABLE_3 = {
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
    "GetFMUstate": EVERYWHERE,
    "SetFMUstate": EVERYWHERE,
    "FreeFMUstate": EVERYWHERE,
    "SerializedFMUstateSize": EVERYWHERE,
    "SerializeFMUstate": EVERYWHERE,
    "DeSerializeFMUstate": EVERYWHERE,
    "DoStep": {"step"},
    "EnterStepMode": set(),
    "EnterEventMode": {"continuous"},
    "UpdateDiscreteStates": {"event"},
    "EnterContinuousTimeMode": {"event"},
    "CompletedIntegratorStep": {"continuous"},
    "SetTime": {"event", "continuous"},
    "SetContinuousStates": {"continuous"},
    "GetContinuousStates": SOLVERS,
    "GetContinuousStateDerivatives": SOLVERS,
    "GetNominalsOfContinuousStates": SOLVERS,
    "GetEventIndicators": SOLVERS,
    "GetOutputDerivatives": {"step", "terminated", "error"},
    "EvaluateDiscreteStates": set(),
    "EnterConfigurationMode": set(),
    "ExitConfigurationMode": set(),
    "GetDirectionalDerivative": EVERYWHERE - {"instantiated"},
    "GetAdjointDerivative": EVERYWHERE - {"instantiated"},
    "GetNumberOfVariableDependencies": set(),
    "GetVariableDependencies": set(),
    "ActivateModelPartition": set(),
    "GetClock": EVERYWHERE,
    "SetClock": EVERYWHERE,
}
ELSEWHERE = {  # what only the other interface has is an error wherever it is called
    STEPPED: {name for name in TABLE_3 if "Continuous" in name and "Get" in name}
    | {"GetEventIndicators", "SetContinuousStates"},
    SOLVED: {"GetOutputDerivatives"},
}


def of_3(kind: str) -> dict[str, set[str]]:
    return {name: set() if name in ELSEWHERE[kind] else states for name, states in TABLE_3.items()}


TABLES = {
    (2, STEPPED): (STATES, STEPPED_2),
    (2, SOLVED): (SOLVING, SOLVED_2),
    (3, STEPPED): ([state for state in STATES if state != "failed"], of_3(STEPPED)),
    (3, SOLVED): (SOLVING, of_3(SOLVED)),
}


def brought_to(instance: Instance, state: str) -> c_void_p:
    """Bring an instance into a state; a saved state to call functions with."""
    fmi = instance.fmu.fmi
    assert instance.call("Reset") == OK
    saved = instance.save()
    if fmi == 2:
        assert instance.set_up() == OK
    if state != "instantiated":
        assert instance.enter() == OK
    if state not in ("instantiated", "initialization"):
        assert instance.call("ExitInitializationMode") == OK
    if state in ("step", "failed"):
        assert instance.step(0.0, 1e-3) == OK
    if state == "failed":
        assert instance.step(1e-3, -1.0) == DISCARD
    if state == "continuous":
        assert (instance.update(), instance.call("EnterContinuousTimeMode")) == (OK, OK)
    if state == "terminated":
        assert instance.call("Terminate") == OK
    if state == "error":
        assert instance.call("CancelStep" if fmi == 2 else "EnterConfigurationMode") == ERROR
    return saved


def arguments(instance: Instance, function: str, saved: c_void_p) -> tuple[object, ...]:
    """What makes a proper call, where it is allowed; C passes over what FMI 2 does not take."""
    none, one, real, time = c_size_t(0), c_size_t(1), c_double(40.0), c_double(1e-3)
    speed, travel = instance.references(["shaft_velocity"]), instance.references(["travel"])
    size = len(instance.packed(instance.save()))
    flags = [byref(c_int()) for _ in range(5)]
    value = (speed, one, byref(real), one)
    rates = (travel, one, (c_int * 1)(1), byref(real), one)
    counts = (one,) if instance.fmu.fmi == 3 else ()
    by_speed = (travel, one, speed, one, byref(real), *counts, byref(real), *counts)
    return {
        "SetDebugLogging": (1, none, None),
        "SetupExperiment": (0, time, time, 0, time),
        "EnterInitializationMode": (False, time, time, False, time),
        **dict.fromkeys(("GetReal", "SetReal", "GetFloat64", "SetFloat64"), value),
        "GetFMUstate": (byref(c_void_p()),),
        "SetFMUstate": (saved,),
        "FreeFMUstate": (byref(c_void_p(saved.value)),),
        "SerializedFMUstateSize": (saved, byref(c_size_t())),
        "SerializeFMUstate": (saved, ctypes.create_string_buffer(size), c_size_t(size)),
        "DeSerializeFMUstate": (instance.packed(saved), c_size_t(size), byref(c_void_p())),
        **dict.fromkeys(("GetDirectionalDerivative", "GetAdjointDerivative"), by_speed),
        "SetRealInputDerivatives": (speed, one, (c_int * 1)(1), byref(real)),
        "GetRealOutputDerivatives": rates,
        "GetOutputDerivatives": rates,
        "DoStep": (time, time, 1, *flags[:3], byref(c_double())),
        "SetTime": (time,),
        "NewDiscreteStates": (byref(EventInfo()),),
        "UpdateDiscreteStates": (*flags, byref(c_double())),
        "CompletedIntegratorStep": (1, *flags[:2]),
        "GetStatus": (0, flags[0]),
        "GetRealStatus": (2, byref(real)),
        "GetIntegerStatus": (0, flags[0]),
        "GetBooleanStatus": (3, flags[0]),
        "GetStringStatus": (1, byref(c_void_p())),
    }.get(function, (None, none, None, none))


@pytest.mark.parametrize(
    ("fmi", "kind", "state"), [(*key, state) for key, (states, _table) in TABLES.items() for state in states]
)
def test_every_function_in_every_state(native, fmi, kind, state):
    instance = native("WeftInsertion", kind, fmi)
    for function, allowed in TABLES[fmi, kind][1].items():
        saved = brought_to(instance, state)
        given = arguments(instance, function, saved)
        instance.log.clear()
        status = instance.call(function, *given)
        proper = DISCARD if function in NONE_KEPT else OK
        assert status == (proper if state in allowed else ERROR), (function, instance.texts)
        assert [level for level, *_rest in instance.log] == [status] * (status != OK), function
        if (fmi, kind, status) == (2, STEPPED, ERROR):
            assert f"fmi2{function} is not allowed in the state" in instance.texts[0]


def test_the_table_is_complete():
    header = (HEADERS / "fmi2Functions.h").read_text()
    everywhere = {"GetTypesPlatform", "GetVersion", "Instantiate", "FreeInstance"}
    parts = re.split(r"Functions for FMI2 for .*", header)
    named = set(re.findall(r"#define fmi2(\w+) +fmi2FullName", parts[0] + parts[2]))
    assert named == {*STEPPED_2, *everywhere}


def test_the_table_of_fmi_3_is_complete():
    header = (HEADERS / "fmi3Functions.h").read_text()
    named = re.findall(r"#define fmi3(\w+) +fmi3FullName\(fmi3\w+\)", header)
    known = {name.lower() for name in TABLE_3}
    other = r"(Get|Set)(U?Int\d+|Float32|Binary)$|(Get|Set)(Interval|Shift)|Instantiate"
    rest = {name for name in named if name.lower() not in known and not re.match(other, name)}
    assert rest == {"GetVersion", "FreeInstance", "GetNumberOfContinuousStates", "GetNumberOfEventIndicators"}


def test_after_an_error_a_reset_or_a_saved_state_helps(native):
    instance = native("MainShaft").start()
    saved = instance.save()
    assert instance.call("SetupExperiment", 0, c_double(), c_double(), 0, c_double()) == ERROR
    assert instance.step(0.0, 0.1) == ERROR
    assert instance.call("SetFMUstate", saved) == OK
    assert instance.step(0.0, 0.1) == OK
    assert instance.call("CancelStep") == ERROR
    assert instance.call("Reset") == OK
    instance.start()
    assert instance.step(0.0, 0.1) == OK
    assert instance.drop(saved) == OK


def test_no_instance_answers_with_an_error(native):
    instance = native("MainShaft")
    proper, instance.component = instance.component, c_void_p()
    try:
        for function in STEPPED_2:
            given = (None, c_size_t(0), None, None, None, None)
            if function in ("SetupExperiment", "DoStep"):
                given = (0, c_double(), c_double(), 0, c_double())
            assert instance.call(function, *given) == ERROR, function
        instance.library.fmi2FreeInstance(c_void_p())
    finally:
        instance.component = proper


@pytest.mark.parametrize(
    ("name", "fmi", "kind", "options", "reason"),
    [
        ("MainShaft", 2, STEPPED, {"token": "another"}, "the GUID must be that of MainShaft"),
        ("MainShaft", 2, STEPPED, {"name": ""}, "the instance name is empty"),
        ("MainShaft", 2, STEPPED, {"name": " \t"}, "the instance name is empty"),
        ("MainShaft", 2, STEPPED, {"name": None}, "the instance name is empty"),
        ("MainShaft", 2, "none", {}, "the type must be fmi2CoSimulation or fmi2ModelExchange"),
        ("BeltMonitor", 2, SOLVED, {}, "keeps a state from step to step: it supports co-simulation only"),
        ("BeltMonitor", 3, STEPPED, {"token": "another"}, "the token must be that of BeltMonitor"),
        ("BeltMonitor", 3, STEPPED, {"name": " "}, "the instance name is empty"),
        ("BeltMonitor", 3, STEPPED, {"name": None}, "the instance name is empty"),
        ("BeltMonitor", 3, STEPPED, {"event_mode": True}, "event mode is not supported"),
        ("BeltMonitor", 3, SOLVED, {}, "keeps a state from step to step: it supports co-simulation only"),
        ("BeltMonitor", 3, "ScheduledExecution", {}, "scheduled execution is not supported"),
    ],
)
def test_an_instance_that_cannot_be_is_refused_with_a_reason(native, name, fmi, kind, options, reason):
    instance = native(name, kind, fmi, logging=False, **options)
    assert not instance.component
    ((status, category, text),) = instance.log
    assert (status, category) == (ERROR, "logStatusError") and reason in text
    assert fmi == 3 or not instance.memory


def test_memory_is_the_hosts_and_all_given_back(native):
    instance = native("BeltMonitor")
    assert len(instance.memory) == 1
    instance.start()
    allocated = list(instance.memory)
    for step in range(10):
        assert instance.set(travel=0.9) == OK
        assert instance.step(step * 1e-3, 1e-3) == OK
    assert instance.memory == allocated  # none while stepping
    state = instance.save()
    _status, other = instance.unpack(instance.packed(state))
    assert len(instance.memory) == 3
    assert instance.call("GetFMUstate", byref(state)) == OK  # in the place of the first
    assert len(instance.memory) == 3
    assert (instance.drop(state), instance.drop(other)) == (OK, OK)
    instance.free()
    assert instance.memory == []


def test_without_memory_it_says_so(native, built):
    instance = native("BeltMonitor")
    instance.fails = True
    state = c_void_p()
    assert instance.call("GetFMUstate", byref(state)) == ERROR
    assert instance.texts == ["out of memory for an FMU state"] and not state

    class Poor(Native):
        def __init__(self) -> None:
            self.fails = True
            super().__init__(built["BeltMonitor"])

        @property
        def fails(self) -> bool:
            return True

        @fails.setter
        def fails(self, _given: bool) -> None:
            pass

    poor = Poor()
    assert not poor.component and poor.texts == ["out of memory for an instance"]


def test_a_host_need_not_lend_its_memory(native):
    instance = native("MainShaft", own_memory=True).start()
    state = instance.save()
    assert instance.step(0.0, 0.1) == OK
    assert instance.drop(state) == OK


def test_logging_by_category(native):
    def warn(instance: Native) -> list[str]:
        instance.log.clear()
        instance.call("Reset")
        instance.start(guide_clearance=0.002)
        return [category for _status, category, _text in instance.log]

    def switch(instance: Native, on: int, *names: bytes) -> int:
        given = (ctypes.c_char_p * max(1, len(names)))(*names)
        return instance.call("SetDebugLogging", on, c_size_t(len(names)), given)

    quiet = native("BeltMonitor", logging=False)
    assert warn(quiet) == []
    assert switch(quiet, 1, b"logStatusWarning") == OK
    assert warn(quiet) == ["logStatusWarning"]
    assert switch(quiet, 0, b"logStatusWarning") == OK
    assert warn(quiet) == []
    assert switch(quiet, 1) == OK
    assert warn(quiet) == ["logStatusWarning"]
    assert quiet.step(0.0, -1.0) == DISCARD
    assert quiet.log[-1][1] == "logStatusDiscard"
    assert switch(quiet, 1, b"logAll") == WARNING
    assert quiet.texts[-1] == "unknown log category"
    assert switch(quiet, 0) == OK
    quiet.log.clear()
    quiet.call("Reset")
    quiet.start()
    assert quiet.step(0.0, -1.0) == DISCARD and quiet.log == []
    # the reason of an error is told always
    assert quiet.call("CancelStep") == ERROR and len(quiet.log) == 1


def test_instances_side_by_side_do_not_touch_each_other(native):
    def run(*instances: Native) -> list[list[object]]:
        for number, instance in enumerate(instances, start=1):
            instance.start(speed=10.0 * number)
        for step in range(50):
            for instance in instances:
                assert instance.step(step * 1e-3, 1e-3) == OK
        return [instance.outputs() for instance in instances]

    (one,) = run(native("WeftInsertion", name="alone"))
    assert run(native("WeftInsertion", name="one"), native("WeftInsertion", name="two"))[0] == one
