"""DobbyDrive: the rotor over many picks, its slow point and its dwell."""

from math import pi

import pytest

from loomfmu.components import DobbyDrive

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


@pytest.mark.parametrize(("theta", "pick"), [(-0.1, -1), (0.0, 0), (6.28, 0), (6.29, 1), (700.0, 111)])
def test_picks_are_turns_of_the_shaft(theta, pick):
    dobby = DobbyDrive(speed=1.0)
    dobby.initialize(0.0)
    assert placed(dobby, theta).pick == pick
