"""Every function of the standard in every state: what its table of calling sequences asks for."""

import ctypes
from ctypes import byref, c_double, c_int, c_size_t, c_void_p

import pytest
from natives import DISCARD, ERROR, OK, WARNING, Native

STATES = ("instantiated", "initialization", "step complete", "step failed", "terminated", "error")

# section 4.2.4 of FMI 2.0: where each function may be called
TABLE = {
    "SetDebugLogging": STATES,
    "SetupExperiment": ("instantiated",),
    "EnterInitializationMode": ("instantiated",),
    "ExitInitializationMode": ("initialization",),
    "Terminate": ("step complete", "step failed"),
    "Reset": STATES,
    "GetReal": STATES[1:],
    "GetInteger": STATES[1:],
    "GetBoolean": STATES[1:],
    "GetString": STATES[1:],
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
    "GetDirectionalDerivative": (),  # not provided
    "SetRealInputDerivatives": STATES[:3],
    "GetRealOutputDerivatives": STATES[2:],
    "DoStep": ("step complete",),
    "CancelStep": (),  # a step is never under way
    "GetStatus": ("step complete", "step failed", "terminated"),
    "GetRealStatus": ("step complete", "step failed", "terminated"),
    "GetIntegerStatus": ("step complete", "step failed", "terminated"),
    "GetBooleanStatus": ("step complete", "step failed", "terminated"),
    "GetStringStatus": ("step complete", "step failed", "terminated"),
}
NONE_KEPT = ("GetIntegerStatus", "GetStringStatus")  # allowed, but there is nothing to tell


def brought_to(instance: Native, state: str) -> c_void_p:
    """Bring an instance into a state; a saved state to call functions with."""
    instance.call("Reset")
    saved = instance.save()
    assert instance.set_up() == OK
    if state != "instantiated":
        assert instance.call("EnterInitializationMode") == OK
    if state not in STATES[:2]:
        assert instance.call("ExitInitializationMode") == OK
        assert instance.step(0.0, 1e-3) == OK
    if state == "step failed":
        assert instance.step(1e-3, -1.0) == DISCARD
    if state == "terminated":
        assert instance.call("Terminate") == OK
    if state == "error":
        assert instance.call("SetupExperiment", 0, c_double(), c_double(), 0, c_double()) == ERROR
    return saved


def arguments(instance: Native, function: str, saved: c_void_p) -> tuple[object, ...]:
    """What makes a proper call, where it is allowed."""
    none, one, real = c_size_t(0), c_size_t(1), c_double()
    speed, ports = instance.references(["shaft_velocity"]), instance.references(["travel"])
    if function in ("SetReal", "GetReal"):
        return speed, one, byref(c_double(40.0))
    if function.startswith(("Set", "Get")) and function.endswith(("Integer", "Boolean", "String")):
        return None, none, None
    size = len(instance.packed(instance.save()))
    return {
        "SetDebugLogging": (1, none, None),
        "SetupExperiment": (0, real, real, 0, real),
        "GetFMUstate": (byref(c_void_p()),),
        "SetFMUstate": (saved,),
        "FreeFMUstate": (byref(c_void_p(saved.value)),),
        "SerializedFMUstateSize": (saved, byref(c_size_t())),
        "SerializeFMUstate": (saved, ctypes.create_string_buffer(size), c_size_t(size)),
        "DeSerializeFMUstate": (instance.packed(saved), c_size_t(size), byref(c_void_p())),
        "GetDirectionalDerivative": (ports, one, speed, one, byref(real), byref(real)),
        "SetRealInputDerivatives": (speed, one, (c_int * 1)(1), byref(real)),
        "GetRealOutputDerivatives": (ports, one, (c_int * 1)(1), byref(real)),
        "DoStep": (c_double(1e-3), c_double(1e-3), 1),
        "GetStatus": (0, byref(c_int())),
        "GetRealStatus": (2, byref(real)),
        "GetIntegerStatus": (0, byref(c_int())),
        "GetBooleanStatus": (3, byref(c_int())),
        "GetStringStatus": (1, byref(c_void_p())),
    }.get(function, ())


@pytest.mark.parametrize("state", STATES)
def test_every_function_in_every_state(native, state):
    instance = native("WeftInsertion")
    for function, allowed in TABLE.items():
        saved = brought_to(instance, state)
        given = arguments(instance, function, saved)
        instance.log.clear()
        status = instance.call(function, *given)
        if state not in allowed:
            assert status == ERROR, function
            assert [level for level, _category, _text in instance.log] == [ERROR], function
            if function not in ("GetDirectionalDerivative",):
                assert f"fmi2{function} is not allowed in the state" in instance.texts[0]
        else:
            assert status == (DISCARD if function in NONE_KEPT else OK), (function, instance.texts)


def test_the_table_is_complete(built):
    import re

    from loomfmu.fmi.native.builder import HEADERS

    header = (HEADERS / "fmi2Functions.h").read_text()
    everywhere = {"GetTypesPlatform", "GetVersion", "Instantiate", "FreeInstance"}
    parts = re.split(r"Functions for FMI2 for .*", header)
    named = set(re.findall(r"#define fmi2(\w+) +fmi2FullName", parts[0] + parts[2]))
    assert named == {*TABLE, *everywhere}


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
        for function in TABLE:
            given = (None, c_size_t(0), None, None, None, None)
            if function in ("SetupExperiment", "DoStep"):
                given = (0, c_double(), c_double(), 0, c_double())
            assert instance.call(function, *given) == ERROR, function
        instance.library.fmi2FreeInstance(c_void_p())
    finally:
        instance.component = proper


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        ({"guid": "another"}, "the GUID must be that of MainShaft"),
        ({"name": ""}, "the instance name is empty"),
        ({"name": " \t"}, "the instance name is empty"),
        ({"name": None}, "the instance name is empty"),
        ({"kind": 2}, "the type must be fmi2CoSimulation or fmi2ModelExchange"),
    ],
)
def test_an_instance_that_cannot_be_is_refused_with_a_reason(native, options, reason):
    instance = native("MainShaft", logging=False, **options)
    assert not instance.component
    assert len(instance.log) == 1
    status, category, text = instance.log[0]
    assert (status, category) == (ERROR, "logStatusError") and reason in text
    assert not instance.memory


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
