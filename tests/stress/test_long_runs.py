"""A million revolutions on: nothing has drifted but the angle by its own rounding."""

import itertools
from math import fabs, isfinite
from typing import Any

import numpy as np
import pytest
from damper_reference import frame
from driving import declared
from whole_loom import TURN, WholeLoom

from loomfmu.components import COMPONENTS, HealdDamper, WarpTension

MILLION = 10**6
SPEED = 60.0  # rad/s
# An angle of 6.3e6 rad is rounded to 4.7e-10, the time that it comes from to as much of it and 2 pi to
# 2.5e-16 of itself in each turn: together
ANGLE_ROUNDING = 2e-9
FOLLOWERS = ("WeftInsertion", "DobbyDrive", "PatternLock", "ReedBeatUp", "DetachingRoller")
COUNTED = ("rotor_angle", "pick", "angle")  # what goes on from turn to turn


def rows(name: str, turns: int, angles: list[float]) -> list[dict[str, Any]]:
    """Outputs of a mechanism that turns by itself, at angles after so many turns."""
    part = COMPONENTS[name](speed=SPEED)
    assert part.initialize(0.0) == 0
    found = []
    for angle in angles:
        assert part.step((turns * TURN + angle) / SPEED, 0.0) == 0
        found.append({v.name: getattr(part, v.name) for v in declared(type(part)) if v.causality == "output"})
    return found


@pytest.mark.parametrize("turns", [MILLION, -MILLION, 2])
@pytest.mark.parametrize("name", FOLLOWERS)
def test_a_million_turns_later_a_mechanism_does_what_it_did(name, turns):
    angles = [TURN * (n + 0.37) / 1500 for n in range(1500)]
    first, later = rows(name, 0, angles), rows(name, turns, angles)
    rounding = ANGLE_ROUNDING * abs(turns) / MILLION + 1e-14
    for output, value in first[0].items():
        one, other = ([row[output] for row in each] for each in (first, later))
        if output in COUNTED:
            whole = turns if isinstance(value, int) else TURN * turns
            assert all(
                fabs(b - a - whole) <= 2.0 * rounding * (1 + 9 * (output == "rotor_angle"))
                for a, b in zip(one, other, strict=True)
            ), output
        elif isinstance(value, float):
            # as much as an output may change over the rounding of the angle: twice its steepest slope
            steepest = max(fabs(b - a) for a, b in itertools.pairwise(one)) * 1500 / TURN
            slack = 2.0 * rounding * steepest + 1e-14 * max(map(fabs, one))
            worst = max(fabs(b - a) for a, b in zip(one, other, strict=True))
            assert worst <= slack, (output, worst, slack)
        else:
            assert one == other, output


def test_a_loom_started_a_million_turns_later_does_the_same():
    looms = []
    for turns in (0, MILLION - 4):  # a multiple of two picks of the lock and of three of the weave
        start = turns * TURN / SPEED
        loom = WholeLoom(SPEED, follow=True, time=start)
        loom.parts["HealdDamper"].free_travel = 1.0  # no contacts: they would multiply every rounding
        for n in range(700):  # not to the very end of a turn, where counts go on
            loom.step(start + n * TURN / SPEED / 720, TURN / SPEED / 720)
        looms.append(loom)
    worst = (0.0, "")
    for (name, _unit, one), (_name, _unit, other) in zip(*(loom.outputs() for loom in looms), strict=True):
        output = name.split(".")[1]
        if output in COUNTED:
            continue
        assert isfinite(other)
        worst = max(worst, (fabs(other - one) / max(fabs(one), 1.0), name))
    print(worst)
    # the angle's rounding over the length of a step, 9 mrad, is what velocities and accelerations of the
    # samples contradict each other by: 2e-7. A carrier that meets its stops multiplies it by ten
    assert worst[0] < 1e-6, worst[1]


def driven(damper: HealdDamper, revolutions: int, steps: int) -> np.ndarray:
    """Displacement, rate and energy at the end of each revolution, and the largest displacement in it."""
    damper.inputs_at_step_end = True
    size = TURN / SPEED / steps
    motion = [frame(n * size, SPEED) for n in range(2 * steps)]  # two picks are a period
    damper.lift, damper.velocity, damper.acceleration = motion[0]
    assert damper.initialize(0.0) == 0
    found = []
    for turn in range(revolutions):
        largest = 0.0
        for n in range(steps):
            damper.lift, damper.velocity, damper.acceleration = motion[(turn * steps + n + 1) % (2 * steps)]
            assert damper.step((turn * steps + n) * size, size) == 0
            largest = max(largest, fabs(damper.displacement))
        own = (
            0.5 * damper.carrier_mass * damper.rate**2
            + 2.0 * damper.spring_stiffness * damper.displacement**2
        )
        found.append((damper.displacement, damper.rate, own, largest))
    return np.array(found)


@pytest.mark.parametrize("revolutions", [200, pytest.param(10**4, marks=pytest.mark.slow)])
def test_a_damped_carrier_settles_and_stays(revolutions):
    found = driven(HealdDamper(damping_ratio=0.05, free_travel=1.0), revolutions, 45)
    # after 60 revolutions exp(-0.05 * 40 * 6.3) of the start is left; two picks are a period
    settled = found[160:]
    for column in settled[::2].T, settled[1::2].T:
        for values in column:
            assert np.ptp(values) <= 1e-11 * np.max(np.abs(found))


@pytest.mark.parametrize("revolutions", [200, pytest.param(10**4, marks=pytest.mark.slow)])
@pytest.mark.parametrize("free_travel", [1.0, 0.015])
def test_an_undamped_carrier_gains_no_energy(revolutions, free_travel):
    found = driven(
        HealdDamper(damping_ratio=0.0, free_travel=free_travel, stop_restitution=1.0), revolutions, 45
    )
    largest = found[:, 3]
    half = revolutions // 2
    if free_travel == 1.0:
        # a sum of two motions that do not fade: its largest is the same early and late, but for the beat
        # of their phases, which a hundred turns show to a hundredth
        assert largest[half:].max() == pytest.approx(largest[:half].max(), rel=1e-2)
        assert found[half:, 2].max() == pytest.approx(found[:half, 2].max(), rel=2e-2)
    else:
        # between elastic stops it rattles without rule, as fast as frame and stops can throw it, no faster
        assert np.all(np.isfinite(found))
        assert largest.max() < 0.03


def test_the_warps_extremes_do_not_creep():
    warp = WarpTension(inputs_at_step_end=True)
    size = TURN / SPEED / 45
    motion = [frame(n * size, SPEED) for n in range(90)]
    warp.lift, warp.velocity, warp.acceleration = motion[0]
    warp.initialize(0.0)
    rows = []
    for n in range(45 * 400):
        warp.lift, warp.velocity, warp.acceleration = motion[(n + 1) % 90]
        assert warp.step(n * size, size) == 0
        if n % 90 == 89:
            rows.append((warp.highest_tension, warp.lowest_tension, warp.tension))
    # relaxed after 20 periods of 0.2 s at 10 / s: exp(-40)
    for one, other in zip(rows[20], rows[-1], strict=True):
        assert other == pytest.approx(one, rel=1e-13)
    # the mean forgets its beginning as 1 / t: two stretches of the same length differ by nothing else
    assert warp.elapsed == pytest.approx(400 * TURN / SPEED, rel=1e-12)


def test_a_shaft_beyond_all_counting_is_refused():
    # 2e9 rad, 3e8 turns: before a count of picks would leave the 32 bits of an FMI integer
    for name in (*FOLLOWERS, "BeltMonitor", "WeftTension"):
        part = COMPONENTS[name](speed=1000.0)
        assert part.initialize(0.0) == 0
        assert part.step(1.9e6, 0.0) == 0
        problem = part.step(2.1e6, 0.0)
        assert "more than 2e9 rad from zero" in part.problems[problem - 1].text
        for time in (1e300, -1e300, 1.7e308):
            assert part.initialize(time) == problem
    frame_ = COMPONENTS["HealdFrame"](rotor_angle=1e9, rotor_velocity=1e6)
    assert frame_.initialize(0.0) == 0
    assert frame_.step(0.0, 1e3) == 0
    assert frame_.step(0.0, 1.1e3) == 1
    assert 2e9 / TURN < 2**31
