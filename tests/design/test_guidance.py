"""Rigid-body guidance: what it is given it gives back, the published machine, and what is refused."""

from math import atan2, cos, degrees, hypot, pi, radians, sin

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from loomfmu.components import ReedBeatUp
from loomfmu.design.guidance import beat_up_linkage, guided_joint
from loomfmu.design.reed import reed_dyad
from loomfmu.errors import LoomfmuError

PUBLISHED = {
    "front": "490 mm",
    "back": "330 mm",
    "swing": "13.610 deg",
    "slope": 0.1154,
    "pressure_angle": "-1.235 deg",
    "rocker": "550 mm",
}


def places(joint, length, arms, tilts):
    """Points at the end of a rod on a rocker, the rocker turned by `arms`, the rod at `tilts`."""
    radius, start = hypot(*joint), atan2(joint[1], joint[0])
    return [
        (radius * cos(start + arm) + length * cos(tilt), radius * sin(start + arm) + length * sin(tilt))
        for arm, tilt in zip(arms, tilts, strict=True)
    ]


@given(
    st.floats(0.2, 1.0),
    st.floats(0.5, 2.5),
    st.floats(0.2, 1.0),
    st.integers(3, 7),
    st.floats(0.1, 0.5),
    st.floats(0.1, 0.5),
    st.booleans(),
)
def test_the_joint_comes_back_from_any_number_of_places(radius, start, length, count, swing, turn, sloped):
    assume(abs(swing - turn) > 0.05)  # a rod that turns with the rocker says nothing of the joint
    joint = (radius * cos(start), radius * sin(start))
    arms = [swing * k / (count - 1) for k in range(count)]
    tilts = [0.3 + turn * (k / (count - 1)) ** 2 for k in range(count)]  # not in step with the arm
    points = places(joint, length, arms, tilts)
    found = guided_joint(points, [tilt - tilts[0] for tilt in tilts], 0.3 if sloped else None)
    # places 0.05 apart determine the joint with a condition of up to 1 / 0.05^3
    assert (found.x, found.y) == pytest.approx(joint, abs=1e-10)
    assert (found.arm, found.rod) == pytest.approx((radius, length), abs=1e-10)
    assert found.swing == pytest.approx(swing, abs=1e-9)
    assert found.error < 1e-11


def test_two_places_and_a_pressure_angle_give_the_published_machine():
    # by another method: `reed_dyad` solves a quadratic equation in the arm for a given chord
    swing, slope, pressure = radians(13.610), 0.1154, radians(-1.235)
    arm, rod, height = reed_dyad(0.490, 0.330, swing, slope, pressure)
    middle = atan2(1.0, -slope)
    tilts = [
        atan2(height - arm * sin(angle), limit - arm * cos(angle))
        for angle, limit in ((middle - swing / 2, 0.490), (middle + swing / 2, 0.330))
    ]
    found = guided_joint([(0.490, height), (0.330, height)], [0.0, tilts[1] - tilts[0]], pressure)
    assert (found.arm, found.rod) == pytest.approx((arm, rod), rel=1e-12)  # rounding over a turn of 0.04
    assert degrees(found.swing) == pytest.approx(13.610, abs=1e-9)


def test_places_that_no_joint_meets_are_met_as_well_as_can_be():
    joint = (0.3, 0.6)
    points = places(joint, 0.5, [0.0, 0.1, 0.2, 0.3], [0.0, 0.03, 0.1, 0.25])
    points[2] = (points[2][0] + 1e-3, points[2][1])
    found = guided_joint(points, [0.0, 0.03, 0.1, 0.25])
    assert 1e-6 < found.error < 2e-3  # of a place that is off by 1 mm

    def residual(x, y):
        rows = []
        for (px, py), turn in zip(points, [0.0, 0.03, 0.1, 0.25], strict=True):
            dx, dy = x - points[0][0], y - points[0][1]
            rows.append(
                hypot(cos(turn) * dx - sin(turn) * dy + px, sin(turn) * dx + cos(turn) * dy + py) ** 2
            )
        return sum((each - rows[0]) ** 2 for each in rows)

    best = residual(found.x, found.y)
    for angle in np.linspace(0.0, 2 * pi, 12):
        assert residual(found.x + 1e-4 * cos(angle), found.y + 1e-4 * sin(angle)) > best


@pytest.mark.parametrize("more", [{"frame_angle": "15 deg"}, {"smallest_transmission_angle": "62.754 deg"}])
def test_the_whole_synthesis_gives_a_reed_that_runs(more):
    reed = ReedBeatUp(**beat_up_linkage(**PUBLISHED, **more))
    assert reed.initialize(0.0) == 0
    assert (reed.front_limit, reed.back_limit) == pytest.approx((0.490, 0.330), abs=1e-12)
    assert degrees(reed.pressure_angle) == pytest.approx(-1.235, abs=1e-9)
    # the angle is given to 0.001 deg
    assert degrees(reed.smallest_transmission_angle) == pytest.approx(62.754, abs=1e-3)


@given(st.floats(0.05, 1.0), st.floats(0.1, 0.9), st.floats(0.1, 1.0))
def test_any_transmission_angle_within_reach(swing, share, rocker):
    wanted = share * (pi - swing) / 2
    try:
        lengths = beat_up_linkage(
            **PUBLISHED | {"swing": swing, "rocker": rocker}, smallest_transmission_angle=wanted
        )
    except LoomfmuError:
        assume(False)
    reed = ReedBeatUp(**lengths)
    assume(reed.initialize(0.0) == 0)
    assert reed.smallest_transmission_angle == pytest.approx(wanted, abs=1e-6)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: guided_joint([(1, 0), (2, 0)], [0, 0.1]), "2 points and 2 turns: .* at least 3 without"),
        (lambda: guided_joint([(1, 0)], [0], 0.1), "at least 2 with a pressure angle"),
        (lambda: guided_joint([(1, 0), (2, 0), (3, 0)], [0, 0, 0]), "undetermined: let the rod turn"),
        (lambda: guided_joint([(1, 0), (2, 0)], [0.1, 0.2], 0.1), r"turns\[0\] = 0.1 rad must be 0"),
        (lambda: beat_up_linkage(**PUBLISHED), "give either frame_angle or smallest_transmission_angle"),
        (lambda: beat_up_linkage(**PUBLISHED, frame_angle="5 deg"), "frame_angle = 5 deg must lie between"),
        (lambda: beat_up_linkage(**PUBLISHED, smallest_transmission_angle="85 deg"), "must be below"),
        (lambda: beat_up_linkage(**PUBLISHED | {"back": "500 mm"}, frame_angle="15 deg"), "no rod takes"),
    ],
)
def test_what_is_refused(call, message):
    with pytest.raises(LoomfmuError, match=message):
        call()
