"""HealdFrame: patterns over any number of picks, and a motion that never jumps."""

import itertools
import random
from math import pi

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from loomfmu.components import HealdFrame
from loomfmu.physics.heald import lift_fraction


def words(pegs: list[int]) -> dict[str, int]:
    """Pattern parameters for the pegs of all picks, 1 for a raised frame."""
    padded = pegs + [0] * (128 - len(pegs))
    found = {"pattern_length": len(pegs)}
    for word in range(8):
        bits = padded[16 * word : 16 * word + 16]
        found[f"pattern_{word + 1}"] = sum(bit << place for place, bit in enumerate(bits))
    return found


def frame_of(pegs: list[int], **given: float) -> HealdFrame:
    frame = HealdFrame(**words(pegs), **given)
    assert frame.initialize(0.0) == 0
    return frame


def placed(frame: HealdFrame, angle: float, velocity: float = 0.0, acceleration: float = 0.0) -> HealdFrame:
    frame.rotor_angle, frame.rotor_velocity, frame.rotor_acceleration = angle, velocity, acceleration
    assert frame.step(0.0, 0.0) == 0
    return frame


@settings(max_examples=60)
@given(st.lists(st.integers(0, 1), min_size=1, max_size=128), st.integers(-300, 300))
def test_at_a_slow_point_the_frame_rests_where_its_peg_wants_it(pegs, pick):
    frame = frame_of(pegs, stroke=0.1)
    # just after the slow point of the pick, as the angle itself may be rounded to either side
    placed(frame, 2 * pi * pick + 1e-9, 50.0)
    wanted = pegs[pick % len(pegs)]
    then = pegs[(pick + 1) % len(pegs)]
    assert frame.lift == pytest.approx(0.1 * wanted, abs=1e-15)  # 1e-9 squared, and rounding
    assert frame.velocity == pytest.approx(0.0, abs=1e-8)  # 50 * 0.1 / 8 * 1e-9, and rounding of the angle
    assert frame.moving is (then != wanted)


@pytest.mark.parametrize("peg", [0, 1])
def test_a_frame_that_holds_does_not_move(peg):
    frame = frame_of([peg], stroke=0.1)
    for n in range(200):
        placed(frame, 0.1 * n - 5.0, 60.0, 900.0)
        assert (frame.lift, frame.velocity, frame.acceleration) == (0.1 * peg, 0.0, 0.0)
        assert not frame.moving


def test_the_event_is_a_change_of_sign_at_each_slow_point_and_nowhere_else():
    frame = frame_of([1, 0])
    signs = [placed(frame, pi * (n + 0.5) / 4).slow_point_event > 0.0 for n in range(-32, 32)]
    changes = [n for n, (before, after) in enumerate(itertools.pairwise(signs), start=-31) if before != after]
    assert changes == [-24, -16, -8, 0, 8, 16, 24]  # eighths of a turn


def test_motion_never_jumps():
    rng = random.Random(6)
    pegs = [rng.randint(0, 1) for _ in range(40)]
    frame = frame_of(pegs, stroke=0.1)
    step = 2 * pi / 200
    lifts = [placed(frame, n * step, 1.0).lift for n in range(-200 * 45, 200 * 45)]
    # at one radian a second the frame's velocity is at most a quarter of its stroke
    assert max(abs(b - a) for a, b in itertools.pairwise(lifts)) <= 0.25 * 0.1 * step * (1 + 1e-12)
    for pick in range(-45, 45):
        before, after = (placed(frame, 2 * pi * pick + side * 1e-6, 1.0) for side in (-1, 1))
        assert before.lift == pytest.approx(after.lift, abs=1e-12)  # (1e-6)^2 / 16, and rounding


def test_outputs_belong_together():
    frame = frame_of([0, 1, 1], stroke=0.12, frame_mass=20.0, warp_ratio=0.25)
    placed(frame, 2.0, 45.0, 800.0)
    share, rate, second = lift_fraction(2.0, 45.0, 800.0)
    assert frame.lift == 0.12 * share
    assert frame.velocity == 0.12 * rate
    assert frame.acceleration == 0.12 * second
    assert frame.inertia_force == 20.0 * frame.acceleration
    assert frame.warp_height == 0.25 * (frame.lift - 0.06)
    falling = placed(frame, 2.0 + 4 * pi, 45.0, 800.0)  # from pick 2 to pick 3, which is pick 0 again
    # the angle has been rounded to 2e-15
    assert falling.lift == pytest.approx(0.12 * (1.0 - share), abs=1e-15)
    assert falling.velocity == pytest.approx(-0.12 * rate, abs=1e-13)


def test_default_pattern_is_plain_weave_half_a_move_on():
    frame = HealdFrame()
    frame.initialize(0.0)
    # pick 0 raised, pick 1 lowered; the rotor half a turn on
    assert frame.moving
    assert frame.lift == pytest.approx(0.049, abs=1e-15)  # rounding of cos(pi / 2)
    assert frame.velocity < 0.0
