"""PatternLock: a pawl that goes and comes, in time or not, on a shaft that turns as it likes."""

from math import degrees, pi, radians

import numpy as np
import pytest

from loomfmu.components.dobby.drive import DobbyDrive
from loomfmu.components.pattern_lock import PatternLock
from loomfmu.physics.pattern_lock import UNLIMITED_TIME

RPM = pi / 30.0
TWELVE = radians(12) * 0.16 / 0.03 - 1.0  # the share that makes the turn 12 degrees


def turned(steps=720, turns=2, **parameters):
    """The lock after each of equal steps, as rows of its outputs."""
    lock = PatternLock(**parameters)
    lock.initialize(0.0)
    step = 2.0 * pi / abs(lock.speed) / steps
    rows = []
    for n in range(turns * steps):
        assert lock.step(n * step, step) == 0
        rows.append((lock.turn, lock.turn_velocity, lock.turn_acceleration, lock.torque_margin))
    return lock, rows


def test_pawl_goes_in_one_pick_and_comes_in_the_next():
    lock, rows = turned()
    assert degrees(lock.whole_turn) == pytest.approx(12.354, abs=5e-4)
    at = {n / 2.0: row[0] for n, row in enumerate(rows, start=1)}  # degrees of the shaft
    # the engagement takes 142.5 to 217.5 degrees, with its middle at the slow point
    assert at[100.0] == at[142.0] == 0.0
    assert at[180.0] == pytest.approx(0.5 * lock.whole_turn, rel=1e-14)  # rounding
    assert at[218.0] == at[300.0] == at[502.0] == lock.whole_turn
    assert at[540.0] == pytest.approx(0.5 * lock.whole_turn, rel=1e-14)
    assert at[578.0] == at[720.0] == 0.0


def test_engagement_is_centred_on_the_slow_point_of_the_drive():
    lock, drive = PatternLock(), DobbyDrive()
    middle = lock.engagement_start + 0.5 * lock.engagement_angle
    assert middle == pytest.approx(drive.slow_point, rel=1e-15)
    # the source's dwell of 90 degrees is about what the default drive gives
    drive.initialize(0.0)
    assert lock.available_angle == pytest.approx(drive.dwell_angle, rel=0.06)


@pytest.mark.no_cover
@pytest.mark.parametrize("speed", [400 * RPM, -400 * RPM])
@pytest.mark.parametrize("start", [-30.0, 0.0, 7.0])
def test_turn_is_continuous_and_has_its_rates(speed, start):
    lock = PatternLock(speed=speed, start_angle=start)
    lock.initialize(0.0)
    step = 1e-5
    rows = []
    for n in range(40000):
        lock.step(n * step, step)
        rows.append((lock.turn, lock.turn_velocity, lock.turn_acceleration))
    turn, velocity, acceleration = np.array(rows).T
    # over a step of 10 us: velocity and acceleration change by 1e-5 of 1400 and of 2e5 at most
    assert np.all(np.abs(np.diff(turn) - velocity[:-1] * step) <= 0.5 * step * step * 1500.0)
    assert np.all(np.abs(np.diff(velocity) - acceleration[:-1] * step) <= 0.5 * step * step * 3e5)
    assert turn.max() == pytest.approx(lock.whole_turn, rel=1e-15)
    assert turn.min() == pytest.approx(0.0, abs=1e-15)


def test_backwards_is_the_same_motion():
    _lock, forwards = turned(speed=400 * RPM, turns=2)
    _lock, backwards = turned(speed=-400 * RPM, turns=2)
    # the same angles from the other side, a whole two picks apart
    for one, other in zip(forwards[:-1], reversed(backwards[:-1]), strict=True):
        assert other[0] == pytest.approx(one[0], abs=1e-14)  # angles of up to 4 pi, rounded
        assert other[1] == pytest.approx(-one[1], abs=1e-12)
        assert other[2] == pytest.approx(one[2], abs=1e-9)  # up to 1400, over a step of 0.009 rad


def test_following_a_shaft_that_speeds_up():
    # theta = w t + e t^2 / 2, handed over at the end of each step: the second rate has both its parts
    lock = PatternLock(follow_shaft=True, inputs_at_step_end=True)
    w, e, step = 40.0, 300.0, 1e-5
    rows = []
    for n in range(8000):
        t = n * step
        lock.shaft_angle = w * t + 0.5 * e * t * t
        lock.shaft_velocity = w + e * t
        lock.shaft_acceleration = e
        if n == 0:
            lock.initialize(0.0)
        else:
            lock.step(t - step, step)
        rows.append((lock.turn, lock.turn_velocity, lock.turn_acceleration))
    for before, here, after in zip(rows, rows[1:], rows[2:], strict=False):
        # centred differences: step^2 / 6 of the third rate, and half a step of its jump where the engagement
        # begins or ends; it is 4 pi^2 phi0 w^3 / T^3, up to 1e6
        assert (after[0] - before[0]) / (2 * step) == pytest.approx(here[1], abs=2e-5)
        assert (after[1] - before[1]) / (2 * step) == pytest.approx(here[2], abs=0.5 * step * 1e6)
    assert max(abs(row[2]) for row in rows) > 1000.0


def test_shaft_is_carried_over_a_step():
    given = {"shaft_angle": 2.6, "shaft_velocity": 40.0, "shaft_acceleration": 100.0}
    at_start = PatternLock(follow_shaft=True, **given)
    at_start.initialize(0.0)
    at_start.step(0.0, 0.01)
    at_end = PatternLock(
        follow_shaft=True,
        inputs_at_step_end=True,
        shaft_angle=2.6 + 0.4 + 0.005,
        shaft_velocity=41.0,
        shaft_acceleration=100.0,
    )
    at_end.initialize(0.0)
    at_end.step(0.0, 0.01)
    assert at_start.turn == pytest.approx(at_end.turn, rel=1e-14)  # rounding of the carried angle
    assert at_start.turn_acceleration == pytest.approx(at_end.turn_acceleration, rel=1e-13)


# Published numbers


@pytest.mark.parametrize(("share", "rpm"), [(TWELVE, 562.4), (0.15, 554.3)])
def test_speed_limits_of_the_source(share, rpm):
    # a constant torque is that of a spring without stiffness; the release then has only its preload
    lock = PatternLock(rest_share=share, spring_stiffness=1e-3)
    lock.initialize(0.0)
    assert lock.torque_speed_limit / RPM == pytest.approx(rpm, abs=0.05)
    # and the source's release is that of a spring without preload
    lock = PatternLock(rest_share=share, spring_force=1e-6)
    lock.initialize(0.0)
    assert lock.release_speed_limit / RPM == pytest.approx(1232, abs=0.5)
    assert lock.release_time == pytest.approx(12.17e-3, abs=5e-6)


def test_speed_limits_with_one_torque():
    lock = PatternLock()
    lock.initialize(0.0)
    assert lock.speed_limit == lock.torque_speed_limit
    assert lock.torque_speed_limit / RPM == pytest.approx(824.66, abs=5e-3)
    assert lock.release_time == pytest.approx(8.764e-3, abs=5e-7)


@pytest.mark.parametrize(("rpm", "in_time"), [(400, True), (824, True), (825, False), (900, False)])
def test_the_spring_is_strong_enough_up_to_the_limit(rpm, in_time):
    lock, rows = turned(speed=rpm * RPM, steps=7200, turns=1)
    assert lock.in_time is in_time
    lowest = min(row[3] for row in rows)
    # the torque goes with the square of the speed; samples lie within 0.05 degrees of the peak
    assert lowest == pytest.approx(1.0 - (rpm * RPM / lock.speed_limit) ** 2, abs=1e-5)
    assert (lowest >= 0.0) is in_time


def test_620_turns():
    # the source's limit: time enough, but a spring of its constant torque is a fifth too weak
    lock, rows = turned(
        speed=620 * RPM, steps=7200, turns=1, rest_share=TWELVE, spring_stiffness=1e-3, available_angle=pi
    )
    assert lock.available_time == pytest.approx(2.0 * 24.2e-3, abs=1e-4)
    assert lock.release_time < lock.available_time
    assert not lock.in_time
    assert min(row[3] for row in rows) == pytest.approx(-0.215, abs=5e-3)


def test_a_dwell_too_short():
    lock = PatternLock(available_angle=radians(20), speed=400 * RPM)
    lock.initialize(0.0)
    assert lock.speed_limit == lock.release_speed_limit < lock.torque_speed_limit
    assert lock.release_speed_limit / RPM == pytest.approx(20 / 6 / 8.76383e-3, abs=0.05)  # deg in ms
    assert not lock.in_time


def test_friction_power():
    lock = PatternLock(speed=650 * RPM)
    lock.initialize(0.0)
    assert lock.friction_power == pytest.approx(111, abs=0.5)
    assert PatternLock(speed=-650 * RPM).initialize(0.0) == 0
    for factor, count in ((-1.0, 20), (0.5, 20), (1.0, 10), (0.0, 20)):
        other = PatternLock(speed=factor * 650 * RPM, frame_count=count)
        other.initialize(0.0)
        share = abs(factor) * count / 20
        assert other.friction_power == pytest.approx(share * lock.friction_power, rel=1e-15)  # rounding


def test_standing_shaft():
    lock = PatternLock(speed=0.0)
    lock.initialize(0.0)
    lock.step(0.0, 1.0)
    assert lock.available_time == UNLIMITED_TIME
    assert lock.in_time
    assert (lock.turn_velocity, lock.inertia_torque, lock.torque_margin, lock.friction_power) == (0, 0, 1, 0)
