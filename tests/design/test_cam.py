"""Cam design: exact curves of a round cam, the published cam, what is refused, and what the workshop gets."""

import csv
import re
import sys
from itertools import pairwise
from math import cos, pi, radians, sin, sqrt

import numpy as np
import pytest

from loomfmu.design.cam import design_cam, lift_law, published_path, sampled_law, spline_law
from loomfmu.design.cam_export import cutter_moves, gcode, write_csv, write_dxf
from loomfmu.errors import LoomfmuError
from loomfmu.machines import table

ROUND, OFF = 0.1, 0.015  # m: a round cam and how far off its axis it turns


def round_cam_radius(angle):
    return OFF * cos(angle) + sqrt(ROUND**2 - (OFF * sin(angle)) ** 2)


def round_cam(**given):
    law = lift_law(round_cam_radius)
    return design_cam(law, lowest_radius=ROUND - OFF, highest_radius=ROUND + OFF, **given)


def distances(points, curve):
    """Of each point from the polygon through a curve."""
    start, along = curve[:-1], np.diff(curve, axis=0)
    found = []
    for point in points:
        to = point - start
        share = np.clip(np.sum(to * along, axis=1) / np.sum(along * along, axis=1), 0.0, 1.0)
        found.append(np.min(np.hypot(*(to - share[:, None] * along).T)))
    return np.array(found)


# Geometry


@pytest.mark.parametrize("law_on_roller", [False, True])
def test_round_cam_is_exact(law_on_roller):
    cam = round_cam(law_on_roller=law_on_roller)
    other = ROUND + (-0.019 if law_on_roller else 0.019)
    for curve, radius in ((cam.profile, ROUND), (cam.path, ROUND)):
        given = (curve is cam.path) == law_on_roller
        # the spline of fifth degree through 720 samples: second derivatives good to (2 pi / 720)^4 = 6e-9
        found = np.hypot(*(curve - (OFF, 0.0)).T)
        assert found == pytest.approx(np.full(found.size, radius if given else other), rel=1e-9)
    profile_radius = other if law_on_roller else ROUND
    assert cam.curvature_radius == pytest.approx(np.full(cam.angle.size, profile_radius), rel=1e-7)
    # between the normal, which points from the circle's centre, and the roller's radius
    normal = np.arctan2(cam.path[:, 1], cam.path[:, 0] - OFF)
    direction = np.arctan2(cam.path[:, 1], cam.path[:, 0])
    expected = (direction - normal + pi) % (2.0 * pi) - pi
    assert cam.pressure_angle == pytest.approx(expected, abs=1e-9)


def test_published_cam():
    cam = design_cam()
    radii = 1e3 * np.hypot(*cam.profile.T)
    assert radii.max() == pytest.approx(107.0, abs=1e-4)  # the top lies between two points, 0.25 deg apart
    assert radii[0] == pytest.approx(84.0, abs=1e-12)
    assert radii.min() == pytest.approx(83.994, abs=5e-4)  # where the spline sinks below its start
    # a roller on a radial guide is pushed aside by less than 6 degrees; no part of the cam is hollow
    assert np.degrees(abs(cam.pressure_angle)).max() == pytest.approx(5.82, abs=5e-3)
    assert 1e3 * cam.curvature_radius.min() == pytest.approx(94.3, abs=0.05)


def test_radial_addition_of_appendix_2_cuts_into_the_flanks():
    cam = design_cam()
    excess = cam.radial_excess()
    assert 1e3 * excess.min() == pytest.approx(-0.119, abs=5e-4)  # mm: that much too deep
    assert excess.max() < 1e-9  # and nowhere outside
    # the same by the distance of the source's path from the profile: 19 mm cos of the pressure angle
    radius, _slope, _bend = cam.radius(cam.angle)
    added = (radius + 0.019)[:, None] * np.column_stack([np.cos(cam.angle), np.sin(cam.angle)])
    short = 0.019 - distances(added[::5], cam.profile).min()
    assert short == pytest.approx(0.119e-3, rel=0.02)  # radially or across: 1 - cos 6 deg, and chords


def test_radial_addition_is_right_for_a_law_of_the_roller():
    # its centre then runs on the radii of Appendix 2; the profile that is offset from it is another one
    cam = design_cam(law_on_roller=True, lowest_radius=0.103, highest_radius=0.126)
    radius, _slope, _bend = cam.radius(cam.angle)
    assert np.hypot(*cam.path.T) == pytest.approx(radius, rel=1e-15)  # one rounding
    assert 1e3 * abs(cam.radial_excess()).max() == pytest.approx(0.12, abs=0.01)


# Laws


def test_law_of_the_spline_has_its_derivatives():
    law = spline_law()
    angle = np.linspace(0.01, 6.27, 500)
    h = 1e-4
    before, here, after = (law(angle + d) for d in (-h, 0.0, h))
    # central differences: h^2 / 6 times the third derivative, below 1
    assert (after[0] - before[0]) / (2.0 * h) == pytest.approx(here[1], abs=1e-8)
    assert (after[1] - before[1]) / (2.0 * h) == pytest.approx(here[2], abs=1e-4)  # across its knots
    assert law(np.linspace(0.0, 2.0 * pi, 100001))[0].max() == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: spline_law([0.0, 1.0, 2.0], [0.0, 1.0, 0.0]), "at least four"),
        (lambda: spline_law([0.0, 2.0, 1.0, 4.0 * pi], [0.0, 1.0, 1.0, 0.0]), "from 0 to 720 deg"),
        (lambda: spline_law([0.0, 2.0, 3.0, 12.0], [0.0, 1.0, 1.0, 0.0]), "from 0 to 720 deg"),
        (lambda: spline_law([0.0, 2.0, 3.0, 4.0 * pi], [0.0, 1.0, 1.0, 0.5]), "must be equal"),
        (lambda: spline_law([0.0, 2.0, 3.0, 4.0 * pi], [0.0, 0.0, 0.0, 0.0]), "must rise"),
        (lambda: sampled_law([0.0, 1.0]), "at least eight"),
        (lambda: sampled_law(np.ones(20)), "not all equal"),
        (
            lambda: design_cam(lowest_radius=0.2),
            "lowest_radius = 200 mm is not below highest_radius = 107 mm",
        ),
        (lambda: design_cam(roller_radius=0.0), r"roller_radius = 0 mm is outside \[0\.1, 1000\] mm"),
        (lambda: design_cam(roller_radius="19 deg"), "roller_radius: '19 deg' is in deg"),
        (lambda: design_cam(highest_radius=None), "highest_radius: None is not a quantity"),
        (lambda: sampled_law(3), "lifts = 3 is not a list"),
        (lambda: gcode(design_cam(), cut="1 s"), "cut: '1 s' is in s"),
        (lambda: design_cam(points=10), "points = 10 must be a whole number, 36 or more"),
    ],
)
def test_impossible_laws_and_dimensions_are_refused(make, message):
    with pytest.raises(LoomfmuError, match=message) as refusal:
        make()
    assert "\n" not in str(refusal.value)


# Undercut


def hollow_law():
    return lift_law(lambda angle: cos(3.0 * angle))


def test_hollow_that_is_tighter_than_the_roller_is_refused():
    # r = 60 + 10 cos 3x is hollow at its lowest points: (r^2 - r r'') / r^3, r'' = 90, is -1 / 62.5 mm there
    given = {"law": hollow_law(), "lowest_radius": 0.05, "highest_radius": 0.07}
    cam = design_cam(roller_radius=0.0624, **given)
    assert 1e3 * cam.curvature_radius[120 * 2] == pytest.approx(-62.5, abs=1e-3)
    with pytest.raises(
        LoomfmuError, match=r"the hollow there has a radius of curvature of 62\.5 mm"
    ) as refusal:
        design_cam(roller_radius=0.0626, **given)
    message = str(refusal.value)
    assert re.match(r"the cam is undercut at cam angle (60|180|300) deg: ", message)
    assert "the roller a radius of 62.6 mm" in message
    assert "\n" not in message
    # what is allowed touches the profile nowhere but where it should; the chords lie up to 0.3 um inside
    assert distances(cam.path[::5], cam.profile).min() > 0.0624 - 2e-6


def test_crest_that_is_tighter_than_the_roller_is_refused():
    # the same with r'' = -90 at its highest points, inwards: 70^2 / (70 + 90) = 30.6 mm
    given = {"law": hollow_law(), "lowest_radius": 0.05, "highest_radius": 0.07, "law_on_roller": True}
    cam = design_cam(roller_radius=0.030, **given)
    assert 1e3 * cam.curvature_radius[0] == pytest.approx(0.625, abs=1e-3)
    with pytest.raises(LoomfmuError, match=r"the crest there has a radius of curvature of 30\.6\d mm"):
        design_cam(roller_radius=0.031, **given)


def test_corner_where_the_turn_closes_is_judged():
    # it comes down steeply and goes up steeply: a notch, into which no roller goes
    notch = spline_law([0.0, 3.0, 6.0, 9.0, 4.0 * pi], [0.0, 1.0, 1.5, 1.0, 0.0])
    with pytest.raises(
        LoomfmuError, match="at cam angle 0 deg: the hollow there has a radius of curvature of 0 mm"
    ):
        design_cam(notch)
    assert design_cam(notch, law_on_roller=True)  # a roller's centre may turn a corner that way
    # the published one is slight, and a crest: in its path a fan of 0.27 deg about the corner
    cam = design_cam()
    gap = 1e3 * np.hypot(*(cam.path[0] - cam.path[-1]))
    assert gap == pytest.approx(19.0 * radians(0.2726), abs=1e-4)
    assert design_cam(law_on_roller=True)  # inwards it costs the profile 0.05 um


# The workshop


def test_table_of_points(tmp_path):
    cam = design_cam(points=360)
    write_csv(cam, tmp_path / "cam.csv")
    write_csv(cam, tmp_path / "cam.csv")  # over its own kind
    (tmp_path / "costs.csv").write_text("my own")
    with pytest.raises(LoomfmuError, match=r"costs\.csv: exists and is not a table of a cam"):
        write_csv(cam, tmp_path / "costs.csv")
    write_csv(cam, tmp_path / "costs.csv", overwrite=True)
    assert (tmp_path / "costs.csv").read_bytes() == (tmp_path / "cam.csv").read_bytes()
    rows = list(csv.DictReader((tmp_path / "cam.csv").read_text(encoding="utf-8").splitlines()))
    assert len(rows) == 361
    for k in (0, 90, 300):
        found = [float(value) for value in rows[k].values()]
        expected = [
            k,
            *(1e3 * cam.profile[k]),
            *(1e3 * cam.path[k]),
            np.degrees(cam.pressure_angle[k]),
            1e3 * cam.curvature_radius[k],
        ]
        assert found == pytest.approx(expected, abs=5e-7)  # six decimals


def test_drawing(tmp_path):
    from ezdxf.filemanagement import readfile

    cam = design_cam(points=360)
    write_dxf(cam, tmp_path / "cam.dxf")
    write_dxf(cam, tmp_path / "cam.dxf")
    drawing = readfile(tmp_path / "cam.dxf")
    assert drawing.header["$INSUNITS"] == 4  # mm
    lines = {line.dxf.layer: line for line in drawing.modelspace().query("LWPOLYLINE")}
    assert all(line.closed for line in lines.values())
    for layer, curve in (("PROFILE", cam.profile), ("CUTTER", cam.path)):
        corners = np.array(lines[layer].get_points("xy"))
        assert corners == pytest.approx(1e3 * curve[: len(corners)], abs=1e-9)  # DXF keeps 16 digits
        assert len(corners) in (360, 361)  # the path has a corner at its join, the profile none
    (circle,) = drawing.modelspace().query("CIRCLE")
    assert circle.dxf.radius == pytest.approx(84.0)


def test_drawing_without_its_package(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "ezdxf", None)  # as if it were not installed
    with pytest.raises(LoomfmuError, match='needs the extra "cam"'):
        write_dxf(design_cam(points=36), tmp_path / "cam.dxf")


def read_program(text):
    """Points that a program passes, arcs at twenty of each, with the largest mismatch of an arc's radii."""
    number = r"(-?\d+\.\d+)"
    match = re.search(rf"^G0 X{number} Y{number}$", text, re.MULTILINE)
    at = np.array([float(match[1]), float(match[2])])
    passed, mismatch = [at], 0.0
    for line in text[text.index("G1 Z#1") :].splitlines()[1:]:
        if match := re.fullmatch(rf"G1 X{number} Y{number}", line):
            passed.append(np.array([float(match[1]), float(match[2])]))
        elif match := re.fullmatch(rf"(G2|G3) X{number} Y{number} I{number} J{number}", line):
            end = np.array([float(match[2]), float(match[3])])
            centre = at + np.array([float(match[4]), float(match[5])])
            radius = np.hypot(*(at - centre))
            mismatch = max(mismatch, abs(radius - np.hypot(*(end - centre))))
            turn = np.angle(complex(*(end - centre)) / complex(*(at - centre)))
            assert (turn < 0.0) == (match[1] == "G2")  # each arc is the shorter way round
            start = np.arctan2(*(at - centre)[::-1])
            angles = start + turn * np.linspace(0.05, 1.0, 20)
            passed += list(centre + radius * np.column_stack([np.cos(angles), np.sin(angles)]))
            at = end
            continue
        else:
            break
        at = passed[-1]
    return np.array(passed), mismatch


@pytest.mark.parametrize("arcs", [True, False])
@pytest.mark.parametrize(
    "make", [design_cam, round_cam, lambda: design_cam(hollow_law(), roller_radius=0.01)]
)
def test_program_runs_round_the_cam(make, arcs):
    cam = make()
    text = gcode(cam, arcs=arcs)
    passed, mismatch = read_program(text)
    assert mismatch < 3e-4  # mm: ends and centres in steps of 0.1 um
    assert np.hypot(*(passed[0] - passed[-1])) < 1e-3  # closed; arcs end where their centres let them
    turned = np.sum(np.diff(np.unwrap(np.angle(passed @ (1.0, 1.0j)))))
    assert turned == pytest.approx(-2.0 * pi, abs=1e-4)  # clockwise, as in Appendix 3
    # the arcs' tolerance, 2 um, and the points' chords: 0.5 um at 126 mm and 0.25 deg, 0.1 um in writing
    assert distances(passed[::3], 1e3 * cam.path).max() < 3e-3
    assert ("\nG2 " in text) == arcs


def test_program_is_laid_out_as_the_published_one():
    lines = gcode(design_cam()).splitlines()
    assert lines[1:6] == ["G21 G90 G64 G17 G40 G49", "F150", "T1 M6", "M3 M8", "S4000"]
    assert lines[6].startswith("G0 X103.0000 Y0.00")
    assert lines[7:13] == ["#1=0", "M98 P1 L11", "G0 Z5", "M30", "O1", "G1 Z#1"]
    assert lines[-2:] == ["#1=[#1-1]", "M99"]
    _start, moves = cutter_moves(design_cam())
    assert len(moves) < 40  # of 1440 points


# The published program


def test_arcs_of_the_published_program_join():
    # so the digits of the program are sound, as printed with three decimals
    ends = 1e3 * published_path()
    for (start, end), row in zip(pairwise(ends), table("cam_nc_arcs"), strict=True):
        centre = start + np.array([float(row["i_mm"]), float(row["j_mm"])])
        assert np.hypot(*(start - centre)) == pytest.approx(np.hypot(*(end - centre)), abs=1.5e-3)
    assert np.hypot(*(ends[0] - ends[-1])) == 0.0


def test_dimensions_are_given_in_si_or_with_units():
    plain = design_cam(lowest_radius=0.08, highest_radius=0.1, roller_radius=0.02)
    written = design_cam(lowest_radius="80 mm", highest_radius="10 cm", roller_radius="20 mm")
    # the units' factors are not exact in binary: rounding
    np.testing.assert_allclose(written.path, plain.path, rtol=1e-13, atol=1e-16)
    knots = ["0 deg", "180 deg", "360 deg", "720 deg"]
    law, same = (
        spline_law(knots, ["0 mm", "5 mm", "9 mm", "0 mm"]),
        spline_law(np.radians([0, 180, 360, 720]), [0, 5, 9, 0]),
    )
    angles = np.linspace(0.0, 2 * pi, 7)
    np.testing.assert_allclose(law(angles)[0], same(angles)[0], rtol=1e-12, atol=1e-13)
