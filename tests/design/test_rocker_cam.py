"""Cam with a roller on a rocker: a round cam, a radial follower as a limit, exact curves, refusals."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from reference import MP

from loomfmu.design.cam import lift_law, spline_law
from loomfmu.design.cam_export import gcode, write_csv
from loomfmu.design.rocker_cam import design_rocker_cam
from loomfmu.errors import LoomfmuError
from loomfmu.physics.linkage import four_bar

DRIVE = {"distance": "200 mm", "arm": "160 mm", "lowest_angle": "30 deg", "swing": "8 deg"}
COUNTER = DRIVE | {"lowest_angle": "38 deg", "swing": "-8 deg", "trailing": False}
both = pytest.mark.parametrize("drive", [DRIVE, COUNTER], ids=["cam", "counter-cam"])

CRANK, ROUND, ROLLER, APART, ARM = 0.02, 0.09, 0.019, 0.2, 0.17  # a round cam, off its centre by the crank


def swing_on_a_round_cam(side):
    """Angle of the arm over the cam's turn: a four-bar, its coupler from the round cam's centre."""

    def angle(turn):
        # the frame turns back with the cam: the round cam's centre stands at -turn from the pivot's line
        chi, _first, _second = four_bar(-turn, 1.0, 0.0, CRANK, ROUND + ROLLER, ARM, APART, 0.0, side)
        return abs((pi - chi + pi) % (2 * pi) - pi)

    return angle


@pytest.mark.parametrize("trailing", [True, False])
def test_round_cam_is_round(trailing):
    angle = swing_on_a_round_cam(1 if trailing else -1)
    swings = [angle(2.0 * pi * k / 720) for k in range(720)]
    cam = design_rocker_cam(
        lift_law(angle),
        distance=APART,
        arm=ARM,
        lowest_angle=min(swings),
        swing=max(swings) - min(swings),
        roller_radius=ROLLER,
        trailing=trailing,
    )
    # the spline of fifth degree through 720 samples, as for the radial follower
    assert np.hypot(*(cam.profile - (CRANK, 0.0)).T) == pytest.approx(np.full(1441, ROUND), rel=1e-8)
    assert cam.curvature_radius == pytest.approx(np.full(1441, ROUND), rel=1e-6)
    # pressure angle: the coupler pushes, the arm moves across itself
    assert np.hypot(*(cam.path - (CRANK, 0.0)).T) == pytest.approx(np.full(1441, ROUND + ROLLER), rel=1e-8)
    for k in range(0, 1440, 97):
        roller, pivot = cam.path[k], APART * np.array([cos(cam.angle[k]), sin(cam.angle[k])])
        push, arm = roller - (CRANK, 0.0), roller - pivot
        # sine of the transmission angle
        between = abs(push[0] * arm[1] - push[1] * arm[0]) / (np.hypot(*push) * np.hypot(*arm))
        assert cos(cam.pressure_angle[k]) == pytest.approx(between, abs=1e-7)


@both
def test_curves_to_fifty_digits(drive):
    # a law in closed form, its derivatives by mpmath's own differences, and no complex exponentials of ours
    def share(turn):
        return (1 - MP.cos(turn)) / 2 + (1 - MP.cos(2 * turn)) / 20

    def law(angle):
        return (
            0.5 * (1 - np.cos(angle)) + 0.05 * (1 - np.cos(2 * angle)),
            0.5 * np.sin(angle) + 0.1 * np.sin(2 * angle),
            0.5 * np.cos(angle) + 0.2 * np.cos(2 * angle),
        )

    cam = design_rocker_cam(law, **drive)
    side = 1 if drive is DRIVE else -1
    start, swing = (MP.mpf(radians(float(drive[name].split()[0]))) for name in ("lowest_angle", "swing"))

    def path(turn):
        psi = start + swing * share(turn)
        x, y = MP.mpf("0.2") - MP.mpf("0.16") * MP.cos(psi), -side * MP.mpf("0.16") * MP.sin(psi)
        return MP.matrix([x * MP.cos(turn) - y * MP.sin(turn), x * MP.sin(turn) + y * MP.cos(turn)])

    for k in (0, 100, 333, 720, 1100):
        turn = MP.mpf(float(cam.angle[k]))
        first = [MP.diff(lambda t, i=i: path(t)[i], turn) for i in (0, 1)]
        second = [MP.diff(lambda t, i=i: path(t)[i], turn, 2) for i in (0, 1)]
        speed = MP.sqrt(first[0] ** 2 + first[1] ** 2)
        bend = (first[0] * second[1] - first[1] * second[0]) / speed**3
        here = path(turn)
        normal = (first[1] / speed, -first[0] / speed)
        assert cam.path[k] == pytest.approx([float(each) for each in here], abs=1e-15)
        expected = [float(here[i] - MP.mpf("0.019") * normal[i]) for i in (0, 1)]
        assert cam.profile[k] == pytest.approx(expected, abs=1e-15)
        assert cam.curvature_radius[k] == pytest.approx(float(1 / bend - MP.mpf("0.019")), rel=1e-12)
        pivot = (MP.mpf("0.2") * MP.cos(turn), MP.mpf("0.2") * MP.sin(turn))
        arm = (here[0] - pivot[0], here[1] - pivot[1])
        outwards = (-side * arm[1], side * arm[0])  # across the arm, away from the cam
        cross = normal[0] * outwards[1] - normal[1] * outwards[0]
        dot = normal[0] * outwards[0] + normal[1] * outwards[1]
        assert dot > 0
        assert cam.pressure_angle[k] == pytest.approx(float(MP.atan2(cross, dot)), abs=1e-14)


def test_a_pair_of_cams_holds_the_rocker_both_ways():
    # both rollers are fixed to one rocker: what one arm gains the other loses
    one, other = (design_rocker_cam(**drive) for drive in (DRIVE, COUNTER))
    assert one.swing_angle + other.swing_angle == pytest.approx(np.full(1441, radians(68.0)), abs=1e-14)


def test_both_cams_go_to_the_workshop(tmp_path):
    cam = design_rocker_cam(spline_law(), **DRIVE)
    write_csv(cam, tmp_path / "cam.csv")
    assert len((tmp_path / "cam.csv").read_text().splitlines()) == 1442
    assert gcode(cam).startswith("(cutter radius 19.000, cam radii ")


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"swing": "0 deg"}, "the arm must swing within 0 to 180 deg .*, and not by 0"),
        ({"lowest_angle": "-5 deg"}, "lowest_angle = -5 deg and swing = 8 deg"),
        ({"law": lift_law(lambda turn: -cos(8 * turn))}, "the cam is undercut at cam angle"),
        ({"arm": "199 mm", "lowest_angle": "1 deg"}, "does not run round the cam's centre"),
        ({"distance": "0 mm"}, "distance"),
    ],
)
def test_what_is_refused(given, message):
    with pytest.raises(LoomfmuError, match=message):
        design_rocker_cam(**DRIVE | given)
