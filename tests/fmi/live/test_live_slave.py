"""Live FMUs under hosts that keep the rules of FMI and hosts that do not."""

import json
import math
import struct
import subprocess
import sys
import zlib
from collections.abc import Callable

import fmpy
import numpy as np
import pytest
from live_fmus import (
    COMPONENTS,
    FATAL,
    NAMES,
    OK,
    REVOLUTION,
    SPEED,
    Live,
    excited,
    in_a_process,
    live,
    outputs_of,
)

from loomfmu import units
from loomfmu.cosim.importing import fmus
from loomfmu.declaring.variables import Variable, variables_of
from loomfmu.fmi.live.live_slave import CATEGORIES, CAUSALITIES

__all__ = ["live"]

Open = Callable[..., Live]
every_fmu = pytest.mark.parametrize("name", NAMES)
STEP = REVOLUTION / 144


def excite(live: Live, name: str, step: int) -> list[object]:
    """One step with inputs that never stand still; the outputs after it."""
    assert live.set(**excited(COMPONENTS[name], step * STEP)) == OK
    assert live.step(step * STEP, STEP) == OK, live.texts
    return live.outputs()


# ---- a run alone, again, side by side


@pytest.mark.few(5)
@every_fmu
def test_alone_with_defaults_it_gives_the_bits_of_its_component(name: str) -> None:
    result = fmpy.simulate_fmu(fmus.of_component(name).path, stop_time=REVOLUTION, output_interval=STEP)
    component = COMPONENTS[name]()
    assert component.initialize(0.0) == 0
    times = result["time"]
    assert len(times) == 145
    for sample, time in enumerate(times):
        found = {output: result[output][sample] for output in result.dtype.names[1:]}
        assert found == outputs_of(component)  # the same code on the same values: no tolerance
        if sample < 144:
            component.step(float(time), float(times[sample + 1] - time))


@pytest.mark.few(5)
@every_fmu
def test_a_second_run_after_reset_repeats_the_first(live: Open, name: str) -> None:
    instance = live(name)
    runs = []
    for _ in range(2):
        instance.start()
        runs.append([excite(instance, name, step) for step in range(60)])
        assert instance.call("terminate") == OK
        assert instance.call("reset") == OK
    assert runs[0] == runs[1]


def test_instances_side_by_side_do_not_touch_each_other(live: Open) -> None:
    speeds = {f"{name}_{number}": (name, SPEED * number) for name in NAMES for number in (1, 2)}

    def started(key: str) -> Live:
        name, speed = speeds[key]
        own = {"speed": speed} if "speed" in fmus.of_component(name).ports else {}
        return live(name, key).start(**own)

    alone = {}
    for key in speeds:
        instance = started(key)
        alone[key] = [excite(instance, speeds[key][0], step) for step in range(12)]
        instance.free()
    together = {key: started(key) for key in speeds}
    traces: dict[str, list[object]] = {key: [] for key in speeds}
    for step in range(12):
        for key, instance in together.items():
            traces[key].append(excite(instance, speeds[key][0], step))
    assert traces == alone


def test_a_step_of_no_length_is_allowed_and_changes_nothing(live: Open) -> None:
    for name in NAMES:
        instance = live(name).start()
        excite(instance, name, 0)
        assert instance.step(STEP, 0.0) == OK
        before = instance.variables()
        assert instance.step(STEP, 0.0) == OK
        assert instance.variables() == before


# ---- state


@pytest.mark.few(5)
@every_fmu
def test_a_restored_state_goes_on_with_the_same_bits(live: Open, name: str) -> None:
    """A run that was put back goes on as before, in this instance and in a new one."""

    def go(instance: Live, first: int, last: int) -> list[object]:
        found = []
        for step in range(first, last):
            excite(instance, name, step)
            found.append(instance.variables())
        return found

    instance, other = live(name).start(), live(name, "other")
    go(instance, 0, 37)
    state = instance.slave.getFMUState()
    data = instance.slave.serializeFMUState(state)
    onward = go(instance, 37, 120)
    assert instance.call("setFMUState", state) == OK
    assert go(instance, 37, 120) == onward
    restored = other.slave.deSerializeFMUstate(data)
    assert other.call("setFMUState", restored) == OK
    assert other.slave.serializeFMUState(other.slave.getFMUState()) == data
    assert go(other, 37, 120) == onward
    other.slave.freeFMUState(restored)
    instance.slave.freeFMUState(state)


def test_a_state_keeps_a_refusal(live: Open) -> None:
    instance = live("BeltMonitor").start()
    good = instance.slave.getFMUState()
    instance.set(guide_clearance=9.0)
    bad = instance.slave.getFMUState()
    data = instance.slave.serializeFMUState(bad)
    assert instance.call("setFMUState", good) == OK
    assert instance.step(0.0, STEP) == OK
    assert instance.call("setFMUState", instance.slave.deSerializeFMUstate(data)) == OK
    instance.log.clear()
    assert instance.step(STEP, STEP) == FATAL
    assert instance.texts == ["guide_clearance = 9000 mm is outside [0, 50] mm"]


def test_bytes_that_are_no_state_are_refused_without_a_crash() -> None:
    text = in_a_process(
        """
import random
from live_fmus import *
rng = random.Random(7)
said = set()
for name in NAMES:
    donor = Live("MainShaft" if name != "MainShaft" else "DobbyDrive", "donor").start()
    foreign = donor.slave.serializeFMUState(donor.slave.getFMUState())
    donor.free()
    instance = Live(name).start()
    data = bytes(instance.slave.serializeFMUState(instance.slave.getFMUState()))
    bad = [data[:length] for length in (1, 35, 36, 48, len(data) // 2, len(data) - 1)]
    bad += [data + b"x", bytes(len(data)), foreign, b"\\xff" * len(data)]
    bad += [rng.randbytes(rng.randint(1, 2 * len(data))) for _ in range(10)]
    # any flipped bit among the values too
    bad += [data[:place] + bytes([data[place] ^ 1 << rng.randrange(8)]) + data[place + 1:]
            for place in rng.sample(range(len(data)), 30)]
    for junk in bad:
        assert instance.call("reset") == OK
        instance.start()
        state = instance.slave.deSerializeFMUstate(junk)
        instance.log.clear()
        assert instance.call("setFMUState", state) == OK  # the wrapper can return nothing else
        assert instance.step(0.0, 1e-3) == FATAL, (name, junk)
        assert instance.step(0.0, 1e-3) == FATAL, (name, junk)
        said.update(instance.texts)
    instance.free()
print("\\n".join(sorted(said)))
"""
    )
    assert text == "the FMU state is damaged, or of another FMU or another version of this one\n"


# ---- values that are refused


def refused(instance: Live, text: str) -> None:
    """The complaint was logged under a declared category, and the next steps fail with it."""
    status, category, said = instance.log[-1]
    if status != FATAL:
        assert category == CATEGORIES[status][0]
    assert said == text
    instance.log.clear()
    assert instance.step(0.0, STEP) == FATAL
    assert instance.step(0.0, STEP) == FATAL
    assert instance.texts == [text, text]


def said_of(variable: Variable, value: float) -> str:
    factor = units.unit(variable.display).factor
    low = -math.inf if variable.minimum is None else variable.minimum
    high = math.inf if variable.maximum is None else variable.maximum
    unit = "" if variable.display == "1" else f" {variable.display}"
    bounds = f"[{low / factor:.7g}, {high / factor:.7g}]"
    return f"{variable.name} = {value / factor:.7g}{unit} is outside {bounds}{unit}"


@every_fmu
def test_a_value_out_of_its_limits_is_told_and_ends_the_run_but_not_the_process(
    live: Open, name: str
) -> None:
    instance = live(name)
    for variable in variables_of(COMPONENTS[name]):
        if not variable.settable or variable.type is bool:
            continue
        wrong: list[float] = [] if variable.type is int else [math.nan, math.inf, -math.inf]
        if variable.minimum is not None:
            wrong.append(variable.minimum - max(1, abs(variable.minimum)))
        if variable.maximum is not None:
            wrong.append(variable.maximum + max(1, abs(variable.maximum)))
        for value in wrong:
            given = int(value) if variable.type is int else float(value)
            if variable.causality == "input":
                instance.start()
                instance.set(**{variable.name: given})
            else:
                instance.begin(**{variable.name: given})
            refused(instance, said_of(variable, given))
            instance.log.clear()
            assert instance.call("reset") == OK
    instance.start()
    assert instance.step(0.0, STEP) == OK


@every_fmu
def test_a_value_reference_of_another_kind_is_told(live: Open, name: str) -> None:
    instance = live(name)
    kinds = {"Real": 0.5, "Integer": 1, "Boolean": True}
    for kind, value in kinds.items():
        other = next((p.reference for p in instance.fmu.ports.values() if p.kind != kind), 9999)
        for reference in (other, 9999, 4294967295):
            said = f"value reference {reference} is not a variable of type {kind}"
            instance.start()
            instance.variables()  # what is kept of a reading must not serve one of another kind
            assert instance.call(f"get{kind}", [reference]) == OK  # the wrapper can return nothing else
            refused(instance, said)
            assert instance.call("reset") == OK
            instance.start()
            assert instance.call(f"set{kind}", [reference], [value]) == OK
            refused(instance, said)
            assert instance.call("reset") == OK
    instance.start()
    instance.call("getString", [0])
    refused(instance, "value reference 0 is not a variable of type String")


@every_fmu
def test_outputs_states_and_fixed_parameters_cannot_be_set_while_stepping(live: Open, name: str) -> None:
    instance = live(name)
    for variable in variables_of(COMPONENTS[name]):
        if variable.causality == "input":
            continue
        instance.start()
        instance.set(**{variable.name: variable.start})
        when = " while stepping" if variable.causality == "parameter" else ""
        refused(instance, f"{variable.name} is {CAUSALITIES[variable.causality]} and cannot be set{when}")
        assert instance.call("reset") == OK


def test_an_output_cannot_be_set_before_the_start_either(live: Open) -> None:
    instance = live("MainShaft")
    instance.begin(angle=1.0)
    refused(instance, "angle is an output and cannot be set")


@every_fmu
@pytest.mark.parametrize(
    ("time", "step_size"),
    [
        *((0.0, size) for size in (-1e-3, math.nan, math.inf, -math.inf)),
        *((time, 1e-3) for time in (math.nan, math.inf, 1e16, -1e300)),  # at which angles would overflow
    ],
)
def test_a_step_that_is_not_finite_and_forward_is_refused(
    live: Open, name: str, time: float, step_size: float
) -> None:
    instance = live(name).start()
    assert instance.step(time, step_size) == FATAL
    said = f"step from {time!r} s by {step_size!r} s: time must be finite and the step not negative"
    assert set(instance.texts) == {said}
    assert all(math.isfinite(value) for value in instance.outputs())


@every_fmu
def test_a_step_before_the_initialization_is_refused(live: Open, name: str) -> None:
    said = "fmi2DoStep is not allowed in the state '{}'"
    instance = live(name)
    assert instance.step(0.0, STEP) == FATAL
    assert set(instance.texts) == {said.format("instantiated")}
    instance.call("reset")
    instance.call("setupExperiment", None, 0.0, None)
    instance.call("enterInitializationMode")
    instance.log.clear()
    assert instance.step(0.0, STEP) == FATAL
    assert set(instance.texts) == {said.format("initialization mode")}
    instance.call("reset")
    instance.start()
    assert instance.step(0.0, STEP) == OK


def test_a_linkage_that_does_not_close_is_told_with_its_values(live: Open) -> None:
    instance = live("WeftInsertion")
    instance.begin(crank_cone=math.radians(80.0))
    assert instance.texts[0].startswith(
        "the spherical linkage does not close over a whole turn: |cos(rocker_angle = 60 deg)| reaches or"
        " exceeds |cos(crank_cone = 80 deg)|"
    )
    assert instance.step(0.0, STEP) == FATAL
    assert instance.call("reset") == OK
    instance.start()
    assert instance.step(0.0, STEP) == OK


def test_a_warning_is_told_once_and_the_run_goes_on(live: Open) -> None:
    instance = live("BeltMonitor").start(guide_clearance=1.5e-3)
    for step in range(5):
        assert instance.step(step * STEP, STEP) == OK
    said = "guide_clearance = 1.5 mm: above 1 mm replace the belt or slow the loom down"
    assert instance.log == [(1, "logStatusWarning", said)]


def test_a_shaft_beyond_all_picks_is_refused_without_a_crash() -> None:
    # 1e12 rad does not fit the 32 bits of fmi2Integer, 1e20 rad not the 64 bits of the serialised state:
    # neither by the input nor by the own speed can the shaft get there
    text = in_a_process(
        """
from live_fmus import *
for angle in (1e12, 1e20, 1e300):
    for follow in (True, False):
        instance = Live("DobbyDrive").start(follow_shaft=follow)
        if follow:
            instance.set(shaft_angle=angle)
        assert instance.step(min(angle, 1e14), 1e-3) == FATAL
        assert instance.get("pick") == [0]
        instance.slave.serializeFMUState(instance.slave.getFMUState())
        print(instance.texts[-1])
        instance.free()
"""
    )
    lines = text.splitlines()
    assert lines[0] == "shaft_angle = 5.729578e+13 deg is outside [-5.729578e+10, 5.729578e+10] deg"
    assert all("is outside" in line for line in lines[::2])
    assert all("more than 2e9 rad from zero" in line for line in lines[1::2])


# ---- hosts


@pytest.mark.slow
def test_three_hundred_failures_and_frees_do_not_crash() -> None:
    # without catching every exception the process crashed after 3 to 114 of these
    text = in_a_process(
        """
import math
from live_fmus import *
for cycle in range(300):
    name = NAMES[cycle % len(NAMES)]
    instance = Live(name).start()
    port = next(p for p in instance.fmu.ports.values() if p.kind == "Real" and p.causality != "output")
    instance.set(**{port.name: math.nan})
    assert instance.step(0.0, 1e-3) == FATAL
    if cycle % 3:
        instance.call("terminate")
    instance.free()
print("done")
"""
    )
    assert text == "done\n"


BAD = """
import math, sys
import fmpy, numpy as np
from fmpy.fmi1 import FMICallException
rising = np.array([(0.0, 1.0), (0.05, 1.0), (0.1, 1e9)], dtype=[("time", float), ("yarn_tension", float)])
wrong = {wrong}
for path, given in zip(sys.argv[1:], wrong.values()):
    for debug_logging in (False, True):
        try:
            rows = fmpy.simulate_fmu(
                path, stop_time=0.1, debug_logging=debug_logging, logger=lambda *said: None, **given)
            print(f"{len(rows)} rows, as if all was well")
        except FMICallException as error:
            print(error.function)
"""
WRONG = {
    "MainShaft": "dict(start_values={'speed': math.nan})",
    "WeftInsertion": "dict(start_values={'crank_cone': math.radians(80.0)})",  # the linkage does not close
    "DobbyDrive": "dict(start_values={'speed': 1e12})",
    "BeltMonitor": "dict(input=rising)",
}


@pytest.mark.parametrize("name", WRONG)
def test_in_fmpy_a_wrong_value_fails_and_says_why_even_without_logging(name: str) -> None:
    script = BAD.replace("{wrong}", f"{{{name!r}: {WRONG[name]}}}")
    done = subprocess.run(
        [sys.executable, "-X", "faulthandler", "-c", script, str(fmus.of_component(name).path)],
        capture_output=True,
        text=True,
        timeout=300,
        check=True,
    )
    function = "fmi2DoStep" if name == "BeltMonitor" else "fmi2ExitInitializationMode"
    failed = [line for line in done.stdout.splitlines() if not line.startswith("Warning: missing input")]
    assert failed == [function] * 2  # a run that ends early would look like a result
    said = done.stderr.splitlines()
    assert len(said) == 2 and all(line.startswith(f"{name}: ") for line in said), said


def test_a_failed_instance_is_freed_whole_however_often_it_failed() -> None:
    text = in_a_process(
        """
import gc, weakref
import logging
from live_fmus import *
logging.disable()
def instances():
    gc.collect()
    return sum(type(each).__name__ == "BeltMonitorSlave" for each in gc.get_objects())
for calls in range(8):
    instance = Live("BeltMonitor")
    instance.call("setupExperiment", None, 0.0, None)
    instance.set(head_mass=-1.0)
    assert instance.call("enterInitializationMode") == OK
    for _ in range(calls):
        assert instance.call("exitInitializationMode") == FATAL
        assert instance.step(0.0, 1e-3) == FATAL
    if calls % 2:
        assert instance.call("reset") == OK
        instance.start()
        assert instance.step(0.0, 1e-3) == OK
    assert instances() == 1
    instance.free()
    assert instances() == 0, calls
print("done")
"""
    )
    assert text == "done\n"


HOST = """
import json, sys
sys.path.insert(0, sys.argv[1])
{before}
import fmpy
modules = set(sys.modules)
for path in sys.argv[2:]:
    fmpy.simulate_fmu(path, stop_time=0.01, output_interval=1e-3)
import loomfmu
print(json.dumps([loomfmu.__file__, loomfmu.OWNER, sorted(set(sys.modules) - modules)]))
"""


@pytest.mark.parametrize("before", ["import loomfmu", ""])
def test_the_hosts_own_loomfmu_is_neither_used_nor_disturbed(tmp_path, before: str) -> None:
    package = tmp_path / "loomfmu"
    package.mkdir()
    (package / "__init__.py").write_text("OWNER = 'the host'\n")
    for part in ("components", "physics", "variables", "units"):
        (package / f"{part}.py").write_text("raise RuntimeError('an FMU used the package of its host')\n")
    paths = [str(fmus.of_component(name).path) for name in NAMES]
    text = in_a_process(HOST.replace("{before}", before), str(tmp_path), *paths)
    file, owner, modules = json.loads(text)
    assert file == str(package / "__init__.py")
    assert owner == "the host"
    assert not [name for name in modules if name.startswith("loomfmu.")]


# the FMI calls by ctypes alone: what is imported after them, an FMU imported
BARE = """
import ctypes, sys
before = set(sys.modules)
class Callbacks(ctypes.Structure):
    _fields_ = [(name, ctypes.c_void_p) for name in ("logger", "allocate", "free", "finished", "environment")]
for line in sys.argv[1:]:
    library, resources, guid = line.split("|")
    fmu = ctypes.PyDLL(library)
    fmu.fmi2Instantiate.restype = ctypes.c_void_p
    callbacks = Callbacks()
    instance = ctypes.c_void_p(fmu.fmi2Instantiate(
        b"bare", 1, guid.encode(), resources.encode(), ctypes.byref(callbacks), 0, 0))
    real = ctypes.c_double
    assert fmu.fmi2SetupExperiment(instance, 0, real(0), real(0), 0, real(0)) == 0
    assert fmu.fmi2EnterInitializationMode(instance) == 0
    assert fmu.fmi2ExitInitializationMode(instance) == 0
    for step in range(10):
        assert fmu.fmi2DoStep(instance, real(step * 1e-3), real(1e-3), 1) == 0
    fmu.fmi2FreeInstance(instance)
print(" ".join(sorted(set(sys.modules) - before)))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="names the library as Linux does")
def test_an_fmu_imports_no_more_than_a_little_of_the_standard_library() -> None:
    lines = []
    for name in NAMES:
        fmu = fmus.of_component(name)
        library = next((fmu.directory / "binaries" / "linux64").glob("*.so"))
        lines.append(f"{library}|file://{fmu.directory / 'resources'}|{fmu.guid}")
    imported = in_a_process(BARE, *lines).split()
    ours = [module for module in imported if module.startswith("loomfmu_")]
    assert len(ours) >= 2 * len(NAMES)
    foreign = {module.split(".")[0] for module in imported if module not in ours}
    assert foreign <= sys.stdlib_module_names
    assert "numpy" not in foreign
    assert "loomfmu" not in foreign


def test_what_a_state_holds_is_packed_without_gaps(live: Open) -> None:
    # the layout that other programs may keep: identity, mode, time, stale, values, a failure's text, checksum
    instance = live("MainShaft").start()
    data = bytes(instance.slave.serializeFMUState(instance.slave.getFMUState()))
    formats = {"Real": "d", "Integer": "q", "Boolean": "?"}
    layout = "<36sBd?" + "".join(formats[port.kind] for port in instance.fmu.ports.values())
    guid, mode, time, _stale, *values = struct.unpack(layout, data[:-4])
    assert (guid.decode(), mode, time) == (instance.fmu.guid, 2, 0.0)
    assert data[-4:] == zlib.crc32(data[:-4]).to_bytes(4, "little")
    np.testing.assert_array_equal(values, instance.variables())


def test_a_state_that_cannot_be_is_refused_even_with_a_proper_checksum(live: Open) -> None:
    instance = live("WarpTension").start()
    body = bytes(instance.slave.serializeFMUState(instance.slave.getFMUState()))[:-4]
    formats = {"Real": 8, "Integer": 8, "Boolean": 1}
    places = np.cumsum([46] + [formats[port.kind] for port in instance.fmu.ports.values()])
    at = dict(zip(instance.fmu.ports, map(int, places), strict=False))
    nan, far = struct.pack("<d", math.nan), struct.pack("<d", -1e300)
    for place, value in (
        (36, b"\x03"),
        (37, nan),
        (37, struct.pack("<d", 1e16)),  # mode and time
        (at["thread_count"], bytes(8)),
        (at["lift"], far),
        (at["tension"], nan),
        (at["pending"], far),
        (at["elapsed"], far),  # states: with these the moments were summed for ever
    ):
        forged = body[:place] + value + body[place + len(value) :]
        data = forged + zlib.crc32(forged).to_bytes(4, "little")
        state = instance.slave.deSerializeFMUstate(data)
        assert instance.call("setFMUState", state) == OK  # the wrapper can return nothing else
        refused(instance, "the FMU state is damaged, or of another FMU or another version of this one")
        assert instance.call("reset") == OK
        instance.start()


@pytest.mark.parametrize(
    "times", [(math.nan, None), (math.inf, None), (1e16, None), (1.0, 0.5), (0.0, math.nan)]
)
def test_a_start_that_cannot_be_is_refused(live: Open, times: tuple[float, float | None]) -> None:
    instance = live("MainShaft")
    instance.call("setupExperiment", None, *times)
    assert instance.call("enterInitializationMode") == OK
    assert instance.call("exitInitializationMode") == FATAL
    assert set(instance.texts) == {"the start time must be finite and not after the stop time"}
