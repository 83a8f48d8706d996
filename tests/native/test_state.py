"""The state of a native FMU: saved, restored, as bytes, and what is none."""

import random
import struct
from ctypes import byref, c_size_t, c_void_p, create_string_buffer

import pytest
from driving import drawn_inputs
from hypothesis import given, settings
from hypothesis import strategies as st
from natives import ERROR, OK, Native

from loomfmu.components import COMPONENTS

pytestmark = pytest.mark.no_cover  # FMUs beside components, step by step: the tests of these cover them
every_fmu = pytest.mark.parametrize("name", COMPONENTS)

NOT_OURS = "the FMU state is damaged, or of another FMU or another version of this one"


def run(instance: Native, name: str, first: int, last: int) -> list[dict[str, object]]:
    """Steps with inputs that belong to their numbers; all variables after each."""
    found = []
    for step in range(first, last):
        inputs = drawn_inputs(COMPONENTS[name], random.Random(step))
        assert instance.set(**inputs) == OK
        assert instance.step(step * 1e-3, 1e-3) == OK, instance.texts
        found.append(instance.variables())
    return found


@pytest.mark.parametrize("fmi", [2, 3])
@every_fmu
def test_a_restored_state_goes_on_as_if_nothing_had_happened(native, name, fmi):
    instance = native(name, fmi=fmi).start()
    run(instance, name, 0, 20)
    state = instance.save()
    content = instance.packed(state)
    ahead = run(instance, name, 20, 40)
    assert instance.call("SetFMUstate", state) == OK
    assert run(instance, name, 20, 40) == ahead
    other = native(name, fmi=fmi)  # a new instance, and from bytes
    status, unpacked = other.unpack(content)
    assert status == OK and other.call("SetFMUstate", unpacked) == OK
    assert run(other, name, 20, 40) == ahead
    assert other.packed(unpacked) == content
    assert (instance.drop(state), other.drop(unpacked)) == (OK, OK)


@every_fmu
def test_a_state_of_every_mode(native, name):
    instance = native(name)
    saved = [instance.save()]
    assert instance.set_up() == OK
    assert instance.call("EnterInitializationMode") == OK
    saved.append(instance.save())
    assert instance.call("ExitInitializationMode") == OK
    run(instance, name, 0, 1)
    saved.append(instance.save())
    assert instance.call("Terminate") == OK
    for state, following in zip(
        saved, ("SetupExperiment", "ExitInitializationMode", "Terminate"), strict=True
    ):
        assert instance.call("SetFMUstate", state) == OK
        assert (instance.set_up() if following == "SetupExperiment" else instance.call(following)) == OK
        assert instance.drop(state) == OK


def test_bytes_are_the_same_for_the_same_state(native):
    contents = []
    for _ in range(2):
        instance = native("BeltMonitor").start()
        run(instance, "BeltMonitor", 0, 5)
        state = instance.save()
        contents.append(instance.packed(state))
        instance.drop(state)
    assert contents[0] == contents[1]
    assert contents[0][:8] == b"LOOMFMU\x02" and contents[0][8:44].decode() == instance.fmu.guid


def test_given_derivatives_are_part_of_the_state(native):
    instance = native("WeftInsertion").start(follow_shaft=True)
    assert instance.set_derivatives({("shaft_angle", 1): 40.0}) == OK
    state = instance.save()
    assert instance.step(0.0, 1e-2) == OK
    wanted = instance.outputs()
    other = native("WeftInsertion")
    status, copy = other.unpack(instance.packed(state))
    assert status == OK and other.call("SetFMUstate", copy) == OK
    assert other.step(0.0, 1e-2) == OK and other.outputs() == wanted
    assert (instance.drop(state), other.drop(copy)) == (OK, OK)


# ---- what is no state


def test_a_handle_that_is_none(native):
    for function in ("SetFMUstate", "SerializedFMUstateSize", "SerializeFMUstate"):
        for handle in (c_void_p(), byref(create_string_buffer(64))):
            instance = native("MainShaft")
            assert instance.call(function, handle, byref(c_size_t()), c_size_t(0)) == ERROR
            assert instance.texts == [NOT_OURS]
    instance = native("MainShaft")
    assert instance.call("GetFMUstate", None) == ERROR
    instance = native("MainShaft")
    assert instance.call("FreeFMUstate", None) == OK
    assert instance.call("FreeFMUstate", byref(c_void_p())) == OK


def test_sizes(native):
    instance = native("MainShaft")
    state = instance.save()
    content = instance.packed(state)
    assert instance.call("SerializeFMUstate", state, create_string_buffer(9), c_size_t(9)) == ERROR
    assert instance.texts == [f"an FMU state needs {len(content)} bytes"]
    assert instance.call("Reset") == OK
    assert instance.call("SerializedFMUstateSize", state, None) == ERROR
    for wrong in (b"", content[:-1], content + b"\0", content * 2):
        status, other = instance.unpack(wrong)
        assert status == ERROR and not other
        assert instance.texts[-1] == NOT_OURS
    assert instance.drop(state) == OK


def test_a_handle_of_another_fmu_is_refused_as_that_of_another_version(native):
    one, other = native("HealdFrame"), native("MainShaft")
    state = one.save()
    assert other.call("SetFMUstate", state) == ERROR
    assert other.texts == [NOT_OURS]
    assert one.drop(state) == OK


def test_bytes_of_another_fmu(native):
    one, other = native("MainShaft"), native("HealdFrame")
    state = one.save()
    assert other.unpack(one.packed(state))[0] == ERROR
    assert other.unpack(b"<" + one.packed(state)[1:])[0] == ERROR
    assert one.drop(state) == OK


def test_any_damage_is_found(native):
    instance = native("MainShaft").start()
    state = instance.save()
    content = instance.packed(state)
    for place in range(len(content)):
        for bit in (1, 128):
            damaged = bytearray(content)
            damaged[place] ^= bit
            assert instance.unpack(bytes(damaged))[0] == ERROR, place
    assert instance.drop(state) == OK


def forged(content: bytes, place: int, value: bytes) -> bytes:
    """A state with other bytes and a checksum that fits."""
    body = content[:place] + value + content[place + len(value) : -8]
    total = 14695981039346656037
    for byte in body:
        total = (total ^ byte) * 1099511628211 % 2**64
    return body + total.to_bytes(8, "little")


def test_a_state_that_cannot_be_is_refused_even_with_a_proper_checksum(native):
    instance = native("MainShaft").start()
    state = instance.save()
    content = instance.packed(state)
    assert instance.unpack(forged(content, 0, b"L"))[0] == OK
    nan, infinity = bytes.fromhex("000000000000f87f"), bytes.fromhex("000000000000f07f")
    speed = 8 + 36 + 4 + 16
    for place, value in (
        (44, b"\x00"),
        (44, b"\x03"),
        (44, b"\x41"),
        (44, b"\xff"),  # no mode
        (48, nan),
        (48, infinity),
        (56, nan),  # no times
        (speed, nan),
        (speed, infinity),
        (speed, bytes.fromhex("000000000088c340")),  # no speed
        (speed + 8, b"\x08"),
        (speed + 9, nan),  # no derivatives
    ):
        assert instance.unpack(forged(content, place, value))[0] == ERROR, (place, value)
    assert instance.drop(state) == OK


def test_a_state_beyond_the_limits_of_its_local_variables_is_refused(native):
    # of the time to come before the last sample the moments of the thread's memory were summed for ever
    instance = native("WarpTension").start()
    state = instance.save()
    content = instance.packed(state)
    names = list(instance.fmu.ports)
    for name, value in (("pending", -1e300), ("elapsed", -1.0)):
        place = 8 + 36 + 4 + 16 + names.index(name) * (8 + 1 + 3 * 8)
        assert instance.unpack(forged(content, place, struct.pack("<d", 1.0)))[0] == OK
        assert instance.unpack(forged(content, place, struct.pack("<d", value)))[0] == ERROR
    assert instance.drop(state) == OK


def test_any_bytes_are_refused(native):
    instance = native("MainShaft")

    @settings(max_examples=300)
    @given(st.binary(max_size=600))
    def check(content: bytes) -> None:
        status, state = instance.unpack(content)
        assert status == ERROR and not state

    check()
