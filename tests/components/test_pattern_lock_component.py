"""PatternLock: a pawl that goes and comes, in time or not, on a shaft that turns as it likes."""

from math import degrees, pi, radians

import pytest

from loomfmu.components.dobby.drive import DobbyDrive
from loomfmu.components.pattern_lock import PatternLock
from loomfmu.physics.pattern_lock import UNLIMITED_TIME

RPM = pi / 30.0


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


def test_a_dwell_too_short():
    lock = PatternLock(available_angle=radians(20), speed=400 * RPM)
    lock.initialize(0.0)
    assert lock.speed_limit == lock.release_speed_limit < lock.torque_speed_limit
    assert lock.release_speed_limit / RPM == pytest.approx(20 / 6 / 8.76383e-3, abs=0.05)  # deg in ms
    assert not lock.in_time


@pytest.mark.parametrize(("speed", "count"), [(68.0, 20), (-68.0, 20), (34.0, 10), (68.0, 0)])
def test_friction_power(speed, count):
    lock = PatternLock(speed=speed, frame_count=count)
    lock.initialize(0.0)
    # of each frame, as the disc turns at most: (3.48)
    assert lock.friction_power == pytest.approx(
        count * 0.1 * 20.0 * 0.0875 * 1.4 / 3.0 * abs(speed), rel=1e-15
    )


def test_standing_shaft():
    lock = PatternLock(speed=0.0)
    lock.initialize(0.0)
    lock.step(0.0, 1.0)
    assert lock.available_time == UNLIMITED_TIME
    assert lock.in_time
    assert (lock.turn_velocity, lock.inertia_torque, lock.torque_margin, lock.friction_power) == (0, 0, 1, 0)
