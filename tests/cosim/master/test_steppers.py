"""The compiled stepper makes the calls of the Python loop: equal to the last bit, with the same failures."""

import signal
import sys
import threading
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from direct_loom import small
from foreign_motors import WHOLE, motor3
from odd_components import odd
from stepped import same_bits, sampled, stepped

from loomfmu import LoomfmuError
from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing import fmus
from loomfmu.cosim.importing.built import file_of
from loomfmu.cosim.master import steppers
from loomfmu.cosim.master.grid import grid_of_points, uniform
from loomfmu.cosim.master.master import Interrupted, Master
from loomfmu.cosim.master.steppers import CompiledStepper, PythonStepper
from loomfmu.cosim.planning.pruning import prune
from loomfmu.cosim.reading import in_flavour
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.fmi.native.platforms import host

__all__ = ["odd"]

pytestmark = pytest.mark.skipif(
    find_spec("ziglang") is None or not sys.platform.startswith("linux"),
    reason="there is no compiler to build the stepper with",
)

DRIVEN = '[inputs]\n"belt.guide_clearance" = [[0.1, "0.3 mm"], [0.3, "0.5 mm"], [0.6, "0.9 mm"]]\n'
SCENES = {
    "constant": {},
    "ramp and ripple": {"shaft__ramp_duration": 0.05, "shaft__ripple_amplitude": 0.05},
    "driven": {"rest": DRIVEN},
    "loop": {"coupling": "lagged", "rest": '[wires]\n"belt.yarn_tension" = "belt.inertia_force"\n'},
}


@pytest.mark.parametrize("flavour", fmus.FLAVOURS)
@pytest.mark.parametrize("changed", SCENES.values(), ids=list(SCENES))
def test_both_steppers_give_the_same_bits(changed: dict[str, object], flavour: str) -> None:
    scene = in_flavour(small(180, **changed), flavour)
    same_bits(stepped(scene, CompiledStepper), stepped(scene, PythonStepper))


def test_the_python_loop_calls_the_fmus_without_a_call_of_its_own_around_each() -> None:
    """A call in Python around each call of an FMU made a step three times as long."""
    calls = 0

    def count(_frame: object, event: str, _argument: object) -> None:
        nonlocal calls
        calls += event == "call"

    scene = in_flavour(small(180), "native")
    with Master(scene, compiled=False) as master:
        master.initialize()
        sys.setprofile(count)
        try:
            master.run(scene.steps, lambda *_parts: None, lambda _step: None)
        finally:
            sys.setprofile(None)
    assert calls < 3 * scene.steps + 200  # the driven inputs of a step, and what a run does once


def test_fmus_of_fmi_3_are_stepped_in_c_to_the_bits_of_fmi_2(tmp_path: Path) -> None:
    files = {
        instance: file_of(COMPONENTS[name], "native", (host(),), 3)
        for instance, name in (("shaft", "MainShaft"), ("weft", "WeftInsertion"), ("belt", "BeltMonitor"))
    }
    text = 'revolutions = 1\nsteps_per_revolution = 180\n[loom]\nmachine = "WL680-3600"\n'
    given = text + "".join(f'[{instance}]\nfmu = "{path}"\n' for instance, path in files.items())
    fmi2, fmi3 = (in_flavour(scenes.parse(each, "loom"), "native") for each in (text, given))
    assert all(each.fmu.fmi == 3 for each in fmi3.instances.values())
    same_bits(stepped(fmi2, CompiledStepper), stepped(fmi3, CompiledStepper))


MOTOR3 = """
duration = "0.2 s"
step = "1 ms"
isolated = false
[shaft]
fmu = "Motor3.fmu"
to_Int8 = -128
to_UInt64 = 2147483647
[other]
fmu = "Motor3.fmu"
[wires]
"other.to_UInt16" = "shaft.steps"
"other.to_Int8" = "shaft.Int8"
"other.stalled" = "shaft.at_speed"
"""


def test_values_of_all_types_of_fmi_3_are_converted_alike(tmp_path: Path) -> None:
    motor3(tmp_path, description=WHOLE)
    scene = scenes.parse(MOTOR3, "motors", directory=tmp_path)
    same_bits(stepped(scene, CompiledStepper), stepped(scene, PythonStepper))
    assert {"Float32", "Boolean", "Enumeration", "Int64"} <= {
        port.base_type for port in scene.instances["shaft"].fmu.ports.values()
    }


SWITCHED = """
revolutions = 1
steps_per_revolution = 90
[odd]
component = "Switched"
[inputs]
"odd.gear" = [[0, 2], [0.4, -3], [0.7, "4"]]
"odd.engaged" = [[0.2, false], [0.5, true]]
"odd.ratio" = [[0, 0.0], [1, 1.0]]
"""


@pytest.mark.usefixtures("odd")
@pytest.mark.parametrize("stepper", [CompiledStepper, PythonStepper])
def test_driven_integers_and_booleans_are_held_until_the_next_row(stepper: type) -> None:
    scene = scenes.parse(SWITCHED, "switched")
    slots = {
        variable: slot for (name, variable), (_kind, slot) in Master(scene).slots.items() if name == "odd"
    }
    times, reals, integers = stepped(scene, stepper)
    turns = np.arange(91) / 90
    gear = np.where(turns < 0.4, 2, np.where(turns < 0.7, -3, 4))
    for variable in ("gear", "gear_in_use"):
        np.testing.assert_array_equal(integers[:, slots[variable]], gear)
    for variable in ("engaged", "running"):
        np.testing.assert_array_equal(integers[:, slots[variable]], turns >= 0.5)
    ratio = reals[:, slots["ratio"]]
    np.testing.assert_allclose(ratio, turns, rtol=0, atol=2e-16)  # one rounding
    np.testing.assert_array_equal(reals[:, slots["value"]], np.where(turns < 0.5, 0.0, gear * ratio))
    assert len(times) == 91


@pytest.mark.parametrize("block", [1, 2, 7, 4096])
def test_the_size_of_a_block_changes_nothing(block: int) -> None:
    scene = small(90, rest=DRIVEN)
    same_bits(stepped(scene, CompiledStepper), stepped(scene, CompiledStepper, block=block))


def test_chosen_points_are_stepped_by_both_alike() -> None:
    scene = small(90, shaft__ramp_duration=0.05, rest=DRIVEN)
    random = np.random.default_rng(1)
    points = np.concatenate([[0.0], np.cumsum(random.uniform(1e-7, 2e-3, 200))])
    grid = grid_of_points(scene, points)
    compiled = stepped(scene, CompiledStepper, grid)
    same_bits(compiled, stepped(scene, PythonStepper, grid))
    np.testing.assert_array_equal(compiled[0], points)


def test_a_loom_without_its_constant_shaft_turns_alike_to_the_last_bit() -> None:
    scene = small(180)
    everything = [f"{name}.{variable}" for name, variable in Master(scene).slots]
    less = prune(scene, everything)
    assert "shaft" not in less.scene.instances
    whole, without = Master(scene), Master(less.scene, uniform(scene), less.fetched, less.shafts)
    found = {}
    for master in (whole, without):
        with master:
            master.initialize()
            _times, *found[master] = sampled(master)
    for key, (kind, slot) in whole.slots.items():
        other_kind, other_slot = without.slots[key]
        place = 0 if kind == "Real" else 1
        assert kind == other_kind
        np.testing.assert_array_equal(found[whole][place][:, slot], found[without][place][:, other_slot])


# ---- failures


@pytest.mark.usefixtures("odd")
@pytest.mark.parametrize("component", ["Raising", "Overflowing"])
def test_both_fail_alike_and_keep_the_same_rows(component: str) -> None:
    scene = scenes.parse(f'steps_per_revolution = 3000\n[odd]\ncomponent = "{component}"\n', "odd")
    failures, kept = [], []
    for compiled in (True, False):
        times: list[float] = []
        with Master(scene, compiled=compiled) as master:
            master.initialize()
            with pytest.raises(LoomfmuError) as raised:
                master.run(1024, lambda block, *_, times=times: times.extend(block), lambda _step: None)
        failures.append(str(raised.value))
        kept.append(len(times))
    assert failures[0] == failures[1]
    assert kept == [2002, 2002]


def test_an_interrupt_ends_a_compiled_run_soon_and_between_two_steps() -> None:
    scene = in_flavour(small(1440, revolutions=5000.0), "native")  # tens of seconds
    times: list[float] = []
    main = threading.main_thread().ident
    assert main is not None
    timer = threading.Timer(0.3, signal.pthread_kill, (main, signal.SIGINT))
    with pytest.raises(Interrupted), Master(scene, compiled=True) as master:
        master.initialize()
        timer.start()
        master.run(1024, lambda block, *_: times.extend(block), lambda _step: None)
    timer.join()
    assert 0 < len(times) < scene.steps


def test_without_a_compiler_the_python_loop_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(steppers, "library_of", lambda _source: None)
    with Master(small(90)) as master:
        master.initialize()
        assert type(master._stepper) is PythonStepper
    with (
        pytest.raises(LoomfmuError, match="the compiled stepper is not available"),
        Master(small(90), compiled=True) as master,
    ):
        master.initialize()
