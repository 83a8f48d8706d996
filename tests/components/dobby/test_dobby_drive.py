"""DobbyDrive: the rotor over many picks, its slow point and its dwell."""

from math import floor, pi

import pytest
from reference import MP, Rotor

from loomfmu.components import DobbyDrive
from loomfmu.physics.rotor_laws.rotor import dwell_angle

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
