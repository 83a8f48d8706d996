"""DobbyDrive: the rotor over many picks, its slow point and its dwell."""

import itertools
from math import floor, pi

import pytest
from looms import RPM
from reference import MP, Rotor

from loomfmu.components import DobbyDrive
from loomfmu.physics.rotor_laws.rotor import dwell_angle, rotor_law

LAWS = ("uniform", "harmonic_ends", "sloped_line", "sloped_sine")
every_law = pytest.mark.parametrize("law", range(1, 5), ids=LAWS)


def placed(dobby: DobbyDrive, theta: float) -> DobbyDrive:
    """The dobby at that shaft angle: at 1 rad/s it is the time."""
    assert dobby.speed == 1.0
    assert dobby.step(theta, 0.0) == 0
    return dobby


@every_law
@pytest.mark.parametrize("slow_point", [0.0, pi, 195 * pi / 180, -1.0])
def test_slowest_at_the_slow_point(law, slow_point):
    dobby = DobbyDrive(law=law, speed_reduction=0.6, slow_point=slow_point, speed=1.0)
    assert dobby.initialize(0.0) == 0
    for pick in (-2, 0, 1, 5):
        placed(dobby, slow_point + 2 * pi * pick)
        # the angle is rounded to 4e-15
        assert dobby.rotor_angle == pytest.approx(2 * pi * pick, abs=1e-14)
        assert dobby.rotor_velocity == pytest.approx(1.0 if law == 1 else 0.4, abs=1e-13)
        assert dobby.rotor_acceleration == pytest.approx(0.0, abs=1e-13)
        assert dobby.lift_fraction == pytest.approx(pick % 2, abs=1e-14)
        assert dobby.lift_rate == pytest.approx(0.0, abs=1e-14)
    if law != 1:
        speeds = [placed(dobby, slow_point + x).rotor_velocity for x in (-1.0, -0.1, 0.0, 0.1, 1.0)]
        assert min(speeds) == speeds[2]


def test_default_slow_point_is_half_a_turn():
    dobby = DobbyDrive(speed=1.0)
    dobby.initialize(0.0)
    assert dobby.slow_point == pi
    assert placed(dobby, pi).rotor_velocity == pytest.approx(0.5, abs=1e-15)  # default reduction


@every_law
def test_motion_against_the_integrated_law(law):
    dobby = DobbyDrive(law=law, speed_reduction=0.7, speed=1.0)
    dobby.initialize(0.0)
    exact = Rotor(LAWS[law - 1], 0.7)
    for theta in (pi + 0.2, pi + 1.0, pi + 2.5, 3 * pi + 0.3):
        x = MP.mpf(theta) - MP.mpf(pi) - 2 * MP.mpf(pi) * floor((theta - pi) / (2 * pi))
        placed(dobby, theta)
        turned = 2 * MP.mpf(pi) * floor((theta - pi) / (2 * pi))
        # rounding of angles up to 10 rad
        assert abs(dobby.rotor_angle - turned - exact.angle(x)) < 1e-14
        assert abs(dobby.rotor_velocity - exact.velocity(x)) < 1e-14
        assert abs(dobby.rotor_acceleration - exact.acceleration(x)) < 2e-14


def test_rotor_angle_goes_on_over_the_picks():
    dobby = DobbyDrive(speed=1.0, law=3, speed_reduction=0.7)
    dobby.initialize(0.0)
    angles = [placed(dobby, -20.0 + 0.01 * n).rotor_angle for n in range(4000)]
    steps = [b - a for a, b in itertools.pairwise(angles)]
    # the rotor's speed lies between 1 - z and 1.402 of the shaft's
    assert min(steps) > 0.0029
    assert max(steps) < 0.0141


@every_law
def test_lift_is_that_of_the_rotor(law):
    dobby = DobbyDrive(speed=50.0, law=law)
    dobby.initialize(0.0)
    for n in range(200):
        dobby.step(n * 1e-3, 1e-3)
        s, w, e = (MP.mpf(v) for v in (dobby.rotor_angle, dobby.rotor_velocity, dobby.rotor_acceleration))
        # angles of 10 rad, velocities of 70 rad/s: rounding of each term
        assert abs(dobby.lift_fraction - (1 - MP.cos(s / 2)) / 2) < 1e-15
        assert abs(dobby.lift_rate - MP.sin(s / 2) * w / 4) < 1e-14
        assert abs(dobby.lift_acceleration - (MP.cos(s / 2) * w**2 / 8 + MP.sin(s / 2) * e / 4)) < 1e-11


@pytest.mark.parametrize(("theta", "pick"), [(-0.1, -1), (0.0, 0), (6.28, 0), (6.29, 1), (700.0, 111)])
def test_picks_are_turns_of_the_shaft(theta, pick):
    dobby = DobbyDrive(speed=1.0)
    dobby.initialize(0.0)
    assert placed(dobby, theta).pick == pick


@every_law
def test_dwell_is_the_time_that_the_frame_stays(law):
    dobby = DobbyDrive(speed=1.0, law=law, dwell_tolerance=0.015)
    dobby.initialize(0.0)
    assert dobby.dwell_angle == dwell_angle(law, 0.5, 0.015)
    steps = 20000
    lifts = (placed(dobby, 2 * pi * k / steps).lift_fraction for k in range(steps))
    # one pick: the rest of the rise before the slow point and the start of the fall after it
    dwelling = sum(lift < 0.015 or lift > 0.985 for lift in lifts)
    assert 2 * pi * dwelling / steps == pytest.approx(dobby.dwell_angle, abs=4 * pi / steps)  # the grid


def test_rotor_follows_the_shafts_acceleration():
    dobby = DobbyDrive(follow_shaft=True, inputs_at_step_end=True)
    dobby.initialize(0.0)
    for theta, speed, acceleration in ((3.0, 60.0, 500.0), (7.0, -20.0, -100.0)):
        dobby.shaft_angle, dobby.shaft_velocity, dobby.shaft_acceleration = theta, speed, acceleration
        dobby.step(0.0, 1e-3)
        x = (theta - pi) % (2 * pi)
        _angle, first, second = rotor_law(4, x, 0.5)
        assert dobby.rotor_velocity == pytest.approx(first * speed, rel=1e-13)  # rounding of x
        exact = second * speed**2 + first * acceleration
        assert dobby.rotor_acceleration == pytest.approx(exact, rel=1e-12)


def test_shaft_inputs_at_the_start_of_a_step_are_carried():
    own = DobbyDrive(speed=400 * RPM)
    follower = DobbyDrive(follow_shaft=True)
    own.initialize(0.0)
    follower.initialize(0.0)
    for n in range(200):
        follower.shaft_angle, follower.shaft_velocity = own.start_angle + own.speed * n * 1e-3, own.speed
        own.step(n * 1e-3, 1e-3)
        follower.step(n * 1e-3, 1e-3)
        # angles up to 10 rad, rounded twice
        assert follower.rotor_angle == pytest.approx(own.rotor_angle, abs=1e-14)
