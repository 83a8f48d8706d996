"""Dimensions of a reed's linkage: published ones, and that they do what they are made for."""

from math import atan2, hypot, pi, radians

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from loomfmu.design.reed import crank_place, crank_rocker_without_quick_return, frame_angle_for, reed_dyad
from loomfmu.physics.linkage import four_bar, wrapped
from loomfmu.physics.reed import dead_centre, reed_motion, rod_margin, smallest_transmission_angle

SWING = radians(13.610)
ROCKER = 0.550
SLOPE = 0.1154

angle = st.floats(-7.0, 7.0)
length = st.floats(0.05, 1.0)
swing = st.floats(0.05, 1.5)


@given(swing, st.floats(0.05, 0.95), length)
def test_design_takes_the_same_time_to_and_fro(psi, share, rocker):
    frame_angle = psi / 2 + share * (pi / 2 - psi / 2)
    crank, coupler, frame, smallest = crank_rocker_without_quick_return(rocker, psi, frame_angle)
    x, y = crank_place(rocker, psi, SLOPE, frame_angle)
    assert hypot(x, y) == pytest.approx(frame, rel=1e-14)  # rounding
    # the frame is as long as near a right angle: what rounding does to the dead centres grows with it
    far = 1e-14 * (1 + frame / crank) ** 2
    ends = [dead_centre(crank, coupler, rocker, -x, -y, -1, extended) for extended in (True, False)]
    assert abs(wrapped(ends[1] - ends[0])) == pytest.approx(pi, abs=far)
    arms = [four_bar(end, 1.0, 0.0, crank, coupler, rocker, -x, -y, -1)[0] for end in ends]
    assert wrapped(arms[1] - arms[0]) == pytest.approx(psi, abs=far)
    assert smallest_transmission_angle(crank, coupler, rocker, frame) == pytest.approx(
        smallest, abs=far * 1e2
    )


@given(swing, st.floats(0.05, 0.95))
def test_frame_angle_gives_the_transmission_angle_back(psi, share):
    smallest = share * (pi - psi) / 2
    *_lengths, found = crank_rocker_without_quick_return(1.0, psi, frame_angle_for(psi, smallest))
    assert found == pytest.approx(smallest, abs=1e-13)  # an arc cosine of at most cos(0.04): rounding x 25


@given(st.floats(0.3, 0.8), st.floats(0.2, 0.9), swing, st.floats(-0.3, 0.3), st.floats(-0.2, 0.2))
def test_dyad_reaches_both_limits(front, share, psi, slope, pressure):
    back = share * front
    arm, rod, height = reed_dyad(front, back, psi, slope, pressure)
    assume(arm > 0.0)
    middle = atan2(1.0, -slope)
    there, _first, _second, found = reed_motion(middle - psi / 2, 1.0, 0.0, arm, rod, height)
    assert there == pytest.approx(front, abs=1e-12)
    assert found == pytest.approx(pressure, abs=1e-11)
    assume(rod_margin(middle, psi / 2, arm, rod, height) > 1e-3)
    there, *_rest = reed_motion(middle + psi / 2, 1.0, 0.0, arm, rod, height)
    # rounding of lengths of some metres, over the root of the margin
    assert there == pytest.approx(back, abs=1e-12)


@given(st.floats(0.1, 0.8), st.floats(0.0, 0.5), swing, st.floats(-0.3, 0.3), st.floats(-0.2, 0.2))
def test_no_dyad_for_limits_the_wrong_way_round(back, less, psi, slope, pressure):
    assert reed_dyad(back - less, back, psi, slope, pressure) == (0.0, 0.0, 0.0)


def test_no_dyad_where_the_reed_would_pass_its_arm():
    # the arm leans to the reed all the time, and the back limit is right over the pivot
    assert reed_dyad(0.8, 0.01, 0.05, -3.0, 0.0) == (0.0, 0.0, 0.0)
