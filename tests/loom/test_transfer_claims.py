"""Claims on the transfer of the weft: harmonic heads, whose overlap and velocity have a closed form."""

import math

import numpy as np
import pytest
from drawn_runs import drawn, turning

import loomfmu
from loomfmu import Verdict
from loomfmu.components.weft_insertion import WeftInsertion
from loomfmu.components.weft_transfer import WeftTransfer
from loomfmu.cosim.claims.claims import read
from loomfmu.cosim.claims.judging import Run
from loomfmu.traces import Recording

TURN = 2.0 * math.pi
SPEED, STROKE, DEEPEST, NEEDED = 60.0, 2.1, 0.1, 0.04
WINDOW = ["170 deg", "190 deg"]


def met(late: float = 0.0, turns: float = 2.0, start: float = 0.0, steps: int = 360) -> Recording:
    """Overlap of two equal harmonic heads of that stroke, greatest `late` after half a turn."""
    angle = start + np.linspace(0.0, TURN * turns, round(steps * turns) + 1)
    phase = angle - late
    motion = {
        "overlap": ("m", DEEPEST - STROKE * (1.0 + np.cos(phase)), {"rate": "closing_velocity"}),
        "closing_velocity": ("m/s", STROKE * SPEED * np.sin(phase), {"rate": "closing_acceleration"}),
        "closing_acceleration": ("m/s2", STROKE * SPEED**2 * np.cos(phase)),
    }
    signals = {f"transfer.{name}": each for name, each in motion.items()}
    needed = {"needed_overlap": NEEDED}
    return drawn(
        (angle - start) / SPEED, {**signals, **turning(angle, SPEED)}, lambda _, name: needed.get(name)
    )


def judged(trace: Recording, kind: str, **arguments: object) -> Verdict:
    return read({"kind": kind, **arguments}, trace.unit).judge(trace)


def half_hand_over() -> float:
    """Half the shaft angle during which the heads overlap by what is needed."""
    return math.acos(1.0 - (DEEPEST - NEEDED) / STROKE)


def test_heads_that_meet_in_mid_shed_are_in_time() -> None:
    found = judged(met(), "transfer_in_time", window=WINDOW)
    assert found
    # a sample lies there; sums of a few metres
    assert found.worst == pytest.approx(DEEPEST, abs=1e-12)
    assert (found.bound, found.unit, found.display_unit, found.signal) == (
        NEEDED,
        "m",
        "mm",
        "transfer.overlap",
    )
    assert found.angle == pytest.approx(math.pi, abs=1e-9)
    # quintics over a degree are off by (1 deg)^6 / 46080, 6e-16, of the stroke: rounding alone
    ends = [math.degrees(math.pi + sign * half_hand_over()) for sign in (-1.0, 1.0)]
    assert found.note == "hand-over from {:.7g} deg to {:.7g} deg".format(*ends)


@pytest.mark.parametrize("late", [-0.3, -0.21, 0.2, 0.4])
def test_heads_that_meet_outside_the_window_are_judged_at_its_edge(late: float) -> None:
    found = judged(met(late), "transfer_in_time", window=WINDOW)
    edge = math.radians(190.0 if late > 0.0 else 170.0)
    there = DEEPEST - STROKE * (1.0 + math.cos(edge - late))
    assert found.worst == pytest.approx(there, abs=1e-12)
    assert bool(found) == (there >= NEEDED)
    assert found.distance == pytest.approx(there - NEEDED, abs=1e-12)


def test_a_pass_that_the_run_cuts_off_does_not_count() -> None:
    # begins at 180 deg within the window and ends in the second one before the heads meet
    late = judged(met(0.1, turns=1.97, start=math.pi), "transfer_in_time", window=WINDOW)
    assert late
    assert late.worst == pytest.approx(DEEPEST, abs=1e-12)
    never = judged(met(turns=0.4), "transfer_in_time", window=WINDOW)
    assert not never
    assert math.isnan(never.worst)
    assert never.note == "the run never passes through the whole window"
    assert math.isnan(never.distance)


@pytest.mark.parametrize("start", [0.0, 10.0, 100.0, -90.0, 33.3])
def test_a_whole_revolution_is_one_pass_wherever_it_begins(start: float) -> None:
    """Its two edges are one angle, and the run's end is one time though rounding finds the edge before it."""
    window = [f"{start} deg", f"{start + 360.0} deg"]
    for turns in range(2, 8):
        for steps in (36, 37, 48, 240):
            found = judged(met(turns=turns, steps=steps), "transfer_in_time", window=window)
            # quintics over 10 deg are off by (10 deg)^6 / 46080 of the stroke
            assert found.worst == pytest.approx(DEEPEST, abs=2e-9), (turns, steps, found)


@pytest.mark.parametrize("begin", [170.0, 190.0, 10.0])
def test_the_ends_of_the_run_on_an_edge_of_the_window_are_counted_once(begin: float) -> None:
    for turns in range(2, 8):
        for off in (0.0, 1e-15, -1e-15, 4e-15, -4e-15):
            trace = met(0.1, turns=turns, start=math.radians(begin) + off, steps=240)
            for window in (WINDOW, ["0 deg", "360 deg"]):
                found = judged(trace, "transfer_in_time", window=window)
                assert found.worst == pytest.approx(DEEPEST, abs=1e-12), (turns, off, window, found)


def test_a_shaft_that_comes_back_to_an_angle_is_there_twice() -> None:
    time = np.linspace(0.0, 1.0, 101)
    swing = 1.5 * math.pi * time
    trace = drawn(time, turning(np.sin(swing), 1.5 * math.pi * np.cos(swing)))
    # from 0 to 1 rad, back to 0 and on to -1; begins at 0
    assert Run(trace).stands_at(0.0) == pytest.approx([0.0, 2.0 / 3.0], abs=1e-9)


@pytest.mark.parametrize("late", [0.0, 0.05])
def test_the_relative_speed_is_that_at_the_ends_of_the_hand_over(late: float) -> None:
    fastest = STROKE * SPEED * math.sin(half_hand_over())
    found = judged(met(late), "transfer_speed", at_most=fastest + 1e-6)
    assert found
    # the edge is known to rounding, 1e-15 of 4 m over 30 m/s, where the velocity changes by 7e3 m/s2; the
    # cubic of the velocity over a degree is off by (1 deg)^4 / 384 of it, 2e-10
    assert found.worst == pytest.approx(fastest, abs=1e-7)
    assert not judged(met(late), "transfer_speed", at_most=fastest - 1e-6)
    assert (found.unit, found.signal) == ("m/s", "transfer.closing_velocity")


def test_heads_that_never_meet_have_no_speed_to_judge() -> None:
    found = judged(met(turns=0.3), "transfer_speed", at_most="100 m/s")
    assert found.word == "undecided"
    assert found.note.endswith("the heads never overlap by what the hooks need in this run")


SCENE = """
revolutions = 2
steps_per_revolution = {steps}
[loom]
both_rapiers = true
[weft_2]
lead = "-6 deg"
[[claims]]
kind = "transfer_in_time"
window = ["170 deg", "190 deg"]
[[claims]]
kind = "transfer_speed"
at_most = "40 m/s"
"""


def test_few_steps_find_the_same(fmu_cache: None) -> None:
    every, few = (
        loomfmu.evaluate(loomfmu.cosim.scenes.scene.parse(SCENE.format(steps=steps), "both"))
        for steps in (720, 120)
    )
    for one, other in zip(every.claims, few.claims, strict=True):
        # the greatest overlap lies half the lag after 180 deg, to rounding; the hand-over's edges are those
        # of quintics over 3 deg
        assert other.worst == pytest.approx(one.worst, rel=1e-6)
    assert every.claims[0].angle == pytest.approx(math.radians(183.0), abs=1e-6)
    # both heads have the travel of 3 deg after half a turn, by the symmetry about their dead centres
    weft = WeftInsertion(start_angle=math.radians(183.0), speed=0.0)
    assert weft.initialize(0.0) == 0
    exact = 2.0 * weft.travel - WeftTransfer().separation
    assert [each.claims[0].worst for each in (every, few)] == pytest.approx([exact, exact], abs=1e-12)
