"""The master: dependency order, the same bits by every path, loops, failures, reuse."""

import math
import os
import threading
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from signal import SIGINT, getsignal

import numpy as np
import pytest
from direct_loom import by_components, by_public_methods, small, traced
from odd_components import odd

from loomfmu import LoomfmuError
from loomfmu.cosim.importing import fmus, pool, slave
from loomfmu.cosim.importing.process import Limits
from loomfmu.cosim.master.master import Master
from loomfmu.cosim.run import run
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.fmi import live_fmu
from loomfmu.traces import ROWS, Trace

__all__ = ["odd"]

SHAFTS = {
    "constant": {"shaft__speed": "600 rpm"},
    "ramp": {"shaft__speed": "600 rpm", "shaft__ramp_duration": 0.08},
    "ripple": {"shaft__speed": "600 rpm", "shaft__ripple_amplitude": 0.05, "shaft__ripple_order": 4},
}


def agree(trace: Trace, expected: dict[str, np.ndarray], tolerance: float) -> None:
    assert set(trace) == set(expected)
    for signal, values in expected.items():
        scale = np.max(np.abs(values))
        np.testing.assert_allclose(
            trace[signal], values, rtol=0, atol=tolerance * scale, err_msg=f"{signal} differs"
        )


# ---- the same results by every path


@pytest.mark.few(2)
@pytest.mark.no_cover
@pytest.mark.parametrize(("steps", "revolutions"), [(90, 2), (1440, 1), (5760, 0.3)])
@pytest.mark.parametrize("shaft", SHAFTS)
def test_a_loom_of_fmus_is_its_components_in_dependency_order(
    tmp_path: Path, steps: int, revolutions: float, shaft: str
) -> None:
    scene = small(steps, revolutions, **SHAFTS[shaft])  # 0.3 goes beyond the belt's window of risk
    # the FMUs run the same operations on the same values: only what a compiler might fuse is left open
    agree(traced(scene, tmp_path), by_components(scene), tolerance=1e-13)


@pytest.mark.parametrize("shaft", SHAFTS)
def test_prepared_pointers_give_the_bits_of_the_public_methods(tmp_path: Path, shaft: str) -> None:
    scene = small(180, **SHAFTS[shaft])
    agree(traced(scene, tmp_path), by_public_methods(scene), tolerance=0.0)


# ---- time


@pytest.mark.few(2)
@pytest.mark.no_cover
@pytest.mark.parametrize(
    ("steps", "revolutions"),
    [*((n, 1) for n in (1, 2, ROWS - 2, ROWS - 1, ROWS, ROWS + 1, 2 * ROWS + 500)), (1440, 0.25), (90, 100)],
)
def test_every_step_is_recorded_once_whatever_the_blocks(
    tmp_path: Path, steps: int, revolutions: float
) -> None:
    scene = scenes.parse(f"revolutions = {revolutions}\nsteps_per_revolution = {steps}\n[shaft]\n[weft]\n")
    with traced(scene, tmp_path) as trace:
        rows = int(steps * revolutions) + 1
        # counted as integers: equal to the last bit
        np.testing.assert_array_equal(trace.time, np.arange(rows) * scene.step_size)
        assert trace.shaft_angle[0] == 0.0
        assert math.isclose(trace.shaft_angle[-1], 2 * math.pi * revolutions, rel_tol=1e-15)  # one product
        assert {len(trace[signal]) for signal in trace} == {trace.rows} == {rows}


def test_a_shaft_may_turn_backwards(tmp_path: Path) -> None:
    scene = small(720, shaft__speed="-300 rpm")
    trace = traced(scene, tmp_path)
    agree(trace, by_components(scene), tolerance=1e-13)
    assert np.all(np.diff(trace.time) > 0)
    assert np.all(np.diff(trace.shaft_angle) < 0)
    assert math.isclose(trace.shaft_angle[-1], -2 * math.pi, rel_tol=1e-15)
    forward = traced(small(720, shaft__speed="300 rpm"), tmp_path)
    # the head's way depends on the angle alone, and the angle goes through the same turn the other way
    scale = np.max(np.abs(forward["weft.travel"]))
    np.testing.assert_allclose(trace["weft.travel"], forward["weft.travel"][::-1], atol=1e-13 * scale)


# ---- loops


SELF = '[wires]\n"belt.yarn_tension" = "belt.inertia_force"\n'


def test_a_wire_back_to_itself_carries_the_value_of_the_step_before(tmp_path: Path) -> None:
    result = run(small(360, rest=SELF, coupling="lagged"), output=tmp_path / "loop.h5")
    assert (
        "loop: belt.inertia_force -> belt.yarn_tension carries the value of the step before"
        in result.warnings
    )
    inertia, axial = (result.trace[f"belt.{name}"] for name in ("inertia_force", "axial_force"))
    # while the head is on its way in: on its way back it carries no weft
    np.testing.assert_array_equal(axial[1:180], inertia[1:180] + inertia[:179])
    np.testing.assert_array_equal(axial[181:360], inertia[181:360])
    # at the start nothing was before: the exchange is repeated until it settles
    assert axial[0] == 2 * inertia[0]


def test_a_loop_of_two_is_settled_at_the_start_and_lagged_after_it(tmp_path: Path) -> None:
    # the carrier's acceleration is the belt's, the belt's force is the carrier's load
    rest = """
[belt]
yarn_tension = "5 N"
[wires]
"belt.acceleration" = "damper_1.carrier_acceleration"
"damper_1.warp_force" = "belt.axial_force"
"damper_1.lift" = false
"damper_1.velocity" = false
"damper_1.acceleration" = false
"""
    scene = small(90, rest=rest, coupling="lagged")
    result = run(scene, output=tmp_path / "loop.h5")
    assert [text for text in result.warnings if text.startswith("loop")] == [
        "loop: damper_1.carrier_acceleration -> belt.acceleration carries the value of the step before"
    ]
    force = result.trace["belt.axial_force"]
    carrier = result.trace["damper_1.carrier_acceleration"]
    mass, head = 7.5, 0.1105
    # the damper is at rest: its acceleration is force / mass, the force is head * acceleration + 5 N
    assert math.isclose(force[0], 5.0 / (1.0 - head / mass), rel_tol=1e-14)
    assert math.isclose(carrier[0], force[0] / mass, rel_tol=1e-14)
    # on its way back, from half a turn on, the head carries no weft
    np.testing.assert_array_equal(force[1:45], head * carrier[:44] + 5.0)
    np.testing.assert_array_equal(force[46:90], head * carrier[45:89])


def test_a_loop_that_does_not_settle_is_told(tmp_path: Path) -> None:
    rest = """
[belt]
yarn_tension = "5 N"
[damper_1]
carrier_mass = 0.1105 # the head's own: the belt's force is 5 N more than what it would have to be
[wires]
"belt.acceleration" = "damper_1.carrier_acceleration"
"damper_1.warp_force" = "belt.axial_force"
"""
    result = run(small(2, revolutions=0.5, rest=rest), output=tmp_path / "loop.h5")
    assert "loop: the start values did not converge in 50 exchanges" in result.warnings


# ---- instances are reused, and given back


@pytest.fixture
def counted(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """Names of the instances that are made, of the freed ones with a minus."""
    pool.free_all()
    made: list[str] = []

    class Counted(slave.Slave):
        def __init__(self, fmu: fmus.Fmu, name: str):
            made.append(name)
            super().__init__(fmu, name)

        def free(self) -> None:
            made.append(f"-{self.name}")
            super().free()

    monkeypatch.setattr(pool, "Slave", Counted)
    yield made
    pool.free_all()


def all_of(trace: Trace) -> dict[str, np.ndarray]:
    return {signal: trace[signal].copy() for signal in trace}


def test_later_runs_make_no_new_instances_and_know_nothing_of_the_others_values(
    tmp_path: Path, counted: list[str]
) -> None:
    scene = small(90)
    first = all_of(traced(scene, tmp_path))
    traced(small(90, shaft__speed="700 rpm", belt__guide_clearance="0.7 mm"), tmp_path)
    again = all_of(traced(scene, tmp_path))
    for signal, values in first.items():
        np.testing.assert_array_equal(again[signal], values)
    assert sorted(counted) == sorted(set(scene.instances) - {"shaft"})  # its speed is constant


def test_two_instances_of_one_fmu_are_two(tmp_path: Path) -> None:
    rest = '[worn]\ncomponent = "BeltMonitor"\nguide_clearance = "0.7 mm"\n'
    with traced(small(90, rest=rest), tmp_path) as trace:
        assert trace["belt.length_factor"][-1] == 0.8
        assert trace["worn.length_factor"][-1] > 0.9
        np.testing.assert_array_equal(trace["worn.free_length"], trace["belt.free_length"])


# ---- failures


def odd_scene(component: str, rest: str = "") -> Scene:
    text = f'steps_per_revolution = 3000\n[odd]\ncomponent = "{component}"\n{rest}'
    return scenes.parse(text, "odd")


@pytest.mark.usefixtures("odd")
@pytest.mark.parametrize(("kind", "value"), [(0, "inf"), (1, "nan"), (2, "-inf")])
def test_a_value_that_is_not_finite_ends_the_run(tmp_path: Path, kind: int, value: str) -> None:
    # 400 rev/min: 0.15 s a revolution, 3,000 steps of 50 us; the value comes after 0.1 s
    scene = odd_scene("Overflowing", f"kind = {kind}")
    with pytest.raises(LoomfmuError) as raised:
        traced(scene, tmp_path)
    assert str(raised.value) == f"odd.value at 0.1001 s is {value}"
    assert [path.name for path in tmp_path.iterdir()] == ["odd.h5.partial"]
    with Trace(tmp_path / "odd.h5.partial") as kept:
        assert kept.status == "failed"
        assert kept.rows == 2002  # every step before that
        assert np.all(np.isfinite(kept["odd.value"]))


@pytest.mark.usefixtures("odd")
def test_large_finite_values_are_no_failure(tmp_path: Path) -> None:
    with traced(odd_scene("Overflowing", "kind = 3"), tmp_path) as trace:
        assert trace["odd.value"][-1] == 1.7e308


@pytest.mark.usefixtures("odd")
def test_an_exception_in_a_component_is_told_in_one_line(tmp_path: Path, counted: list[str]) -> None:
    with pytest.raises(LoomfmuError) as raised:
        traced(odd_scene("Raising"), tmp_path)
    said = str(raised.value)
    assert said.startswith("odd at 0.10005 s: fmi2DoStep returned fmi2Fatal: at 0.100")
    assert said.endswith("ZeroDivisionError: float division by zero")
    with Trace(tmp_path / "odd.h5.partial") as kept:
        assert kept.status == "failed"
        assert kept.rows == 2002  # every step that was made
    # the instances were given back: they run again, and none was freed or made anew
    made = [name for name in counted if not name.startswith("-")]
    with pytest.raises(LoomfmuError):
        traced(odd_scene("Raising"), tmp_path)
    assert counted == made == ["odd"]


@pytest.mark.usefixtures("odd")
def test_a_problem_that_is_not_declared_ends_the_run_and_not_the_process(tmp_path: Path) -> None:
    with pytest.raises(LoomfmuError, match=r"odd at 0\.10005 s: .* IndexError"):
        traced(odd_scene("Undeclared"), tmp_path)


@pytest.mark.usefixtures("odd")
def test_a_complaint_at_the_start_is_told_before_anything_is_written(tmp_path: Path) -> None:
    with pytest.raises(LoomfmuError, match=r"^odd: the level of 7 is no level$"):
        traced(odd_scene("Complaining"), tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("odd")
def test_a_wire_between_kinds_is_refused() -> None:
    wires = '[wires]\n"odd.taken" = "odd.counted"\n'
    with pytest.raises(LoomfmuError, match=r"wire odd.counted -> odd.taken: odd.counted is of type Integer"):
        odd_scene("Overflowing", wires)


def test_instances_are_given_back_when_one_cannot_be_made(
    monkeypatch: pytest.MonkeyPatch, counted: list[str]
) -> None:
    scene = small(90)
    borrowed = pool.borrow

    def failing(fmu: fmus.Fmu, name: str, limits: Limits | None) -> slave.Slave:
        if name == "belt":
            raise LoomfmuError("no belt")
        return borrowed(fmu, name, limits)

    monkeypatch.setattr("loomfmu.cosim.master.master.borrow", failing)
    master = Master(scene)
    with pytest.raises(LoomfmuError, match="no belt"):
        master.__enter__()
    assert master.slaves == {}
    resting = [resting.name for slaves in pool._resting.values() for resting in slaves]
    assert sorted(resting) == sorted(counted)
    assert "shaft" in resting


@pytest.mark.usefixtures("odd")
def test_an_fmu_that_cannot_be_instantiated_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live_fmu, "__version__", "0.0.broken")  # an identity of its own
    monkeypatch.setattr(live_fmu, "_entry", lambda *_arguments: "raise ValueError('no entry')")
    fmu = fmus.of_component("Complaining")
    said = rf"^mine: {fmu.path} cannot be instantiated: .*ValueError\('no entry'\)$"
    with pytest.raises(LoomfmuError, match=said):
        slave.Slave(fmu, "mine")


def test_a_live_fmu_where_its_wrapper_has_no_library_is_told_with_what_it_has(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    fmu = fmus.of_component("MainShaft")
    monkeypatch.setattr("fmpy.platform", "darwin64")
    said = "has no library for this platform, darwin64; it has linux64 and win64"
    with pytest.raises(LoomfmuError, match=f"^mine: {fmu.path} {said}$"):
        slave.Slave(fmu, "mine")


def test_an_instance_that_ended_fatally_is_neither_reused_nor_freed(
    monkeypatch: pytest.MonkeyPatch, counted: list[str]
) -> None:
    # freeing it would be a use after free; the next run takes a new one. Our own outlive it
    fmu = replace(fmus.of_component("MainShaft"), trusted=False)
    broken = pool.borrow(fmu, "fatal")
    freed: list[str] = []
    monkeypatch.setattr(broken._slave, "freeInstance", lambda: freed.append("freed"))
    assert "fmi2DoStep returned fmi2Fatal" in str(broken.failed(4, "fmi2DoStep", 0.0))
    pool.give_back(broken)
    assert freed == []
    assert pool.borrow(fmu, "fatal") is not broken


def test_ctrl_c_before_the_first_step_ends_the_run_too(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    handler = getsignal(SIGINT)
    initialize = Master.initialize

    def interrupted(master: Master) -> None:
        os.kill(os.getpid(), SIGINT)
        initialize(master)

    monkeypatch.setattr(Master, "initialize", interrupted)
    with pytest.raises(KeyboardInterrupt, match="interrupted before the first step"):
        traced(small(90), tmp_path)
    assert list(tmp_path.iterdir()) == []
    assert getsignal(SIGINT) is handler


def test_a_run_in_a_thread_leaves_the_handling_of_ctrl_c_alone(tmp_path: Path) -> None:
    scene, found = small(90), []
    thread = threading.Thread(target=lambda: found.append(traced(scene, tmp_path).rows))
    thread.start()
    thread.join()
    assert found == [91]


def test_values_out_of_bounds_that_only_the_fmu_sees_end_the_run(tmp_path: Path) -> None:
    # the belt's limit for the weft tension is 1e6 N; the loop of two blows up beyond it
    rest = """
[wires]
"belt.yarn_tension" = "damper_1.peak_load"
[damper_1]
start_rate = 1000.0
stop_stiffness = 1e12
"""
    with pytest.raises(
        LoomfmuError, match=r"belt at .* s: fmi2DoStep returned fmi2Fatal: yarn_tension = "
    ) as raised:
        traced(small(360, rest=rest), tmp_path)
    assert str(raised.value).endswith("is outside [-1e+08, 1e+08] cN")
