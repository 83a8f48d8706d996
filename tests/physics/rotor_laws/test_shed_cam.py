"""The spline cam's law: the spline with cubic ends, its published figures, the join of two picks."""

from math import degrees, pi, radians

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from loomfmu.machines import table
from loomfmu.physics.rotor_laws.shed_cam import cam_phase, not_a_knot

ROWS = table("shed_control_points")
ANGLES = [radians(float(row["shaft_angle_deg"])) for row in ROWS]
HEIGHTS = [1e-3 * float(row["warp_height_mm"]) for row in ROWS]
FRAME = 6.0  # travel of the frame over the height of the warp


def published():
    return CubicSpline(ANGLES, HEIGHTS, bc_type="not-a-knot")


@given(
    st.lists(st.floats(0.05, 3.0), min_size=5, max_size=5),
    st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6),
)
def test_spline_is_that_of_scipy(gaps, heights):
    places = np.concatenate([[0.0], np.cumsum(gaps)])
    exact = CubicSpline(places, heights, bc_type="not-a-knot")(places, 2)
    found = not_a_knot(places.tolist(), list(heights))
    # rounding of second differences, over the largest, where the gaps differ by a factor of 60
    assert np.all(abs(found - exact) <= 1e-12 * max(abs(exact).max(), abs(np.array(heights)).max()))


@given(st.lists(st.floats(-1.0, 1.0), min_size=4, max_size=4))
def test_any_cubic_is_kept(coefficients):
    cubic = np.polynomial.Polynomial(coefficients)
    found = not_a_knot(list(ANGLES), [float(cubic(x)) for x in ANGLES])
    # heights up to 2000 rounded to 2e-13, over the smallest gap squared: 1
    assert found == pytest.approx([cubic.deriv(2)(x) for x in ANGLES], abs=1e-10)


def test_published_spline():
    # 1e-12 of the largest: rounding
    exact = published()(ANGLES, 2)
    found = not_a_knot(list(ANGLES), list(HEIGHTS))
    assert found == pytest.approx(exact, abs=1e-12 * abs(exact).max())


def test_published_figures():
    spline = published()
    grid = np.linspace(0.0, 4.0 * pi, 720001)
    # two decimals of a millimetre; on so fine a grid the crests are missed by 1e-10
    assert 1e3 * FRAME * spline(grid).max() == pytest.approx(98.17, abs=5e-3)
    assert 1e3 * FRAME * abs(spline(grid, 1)).max() == pytest.approx(24.76, abs=5e-3)
    assert 1e3 * FRAME * abs(spline(grid, 2)).max() == pytest.approx(16.99, abs=5e-3)
    clear = np.ptp(spline.solve(0.015, extrapolate=False))
    assert degrees(clear) == pytest.approx(142.9, abs=0.05)  # the source: not less than 140
    assert degrees(clear) > 140.0


def test_velocity_jumps_where_two_picks_join():
    # the cubic ends know nothing of each other: the frame arrives almost at rest and sets out downwards
    spline = published()
    start, end = (1e3 * FRAME * float(spline(x, 1)) for x in (0.0, 4.0 * pi))
    assert (start, end) == pytest.approx((-0.874, -0.021), abs=5e-4)  # mm per rad, three decimals
    fastest = 1e3 * FRAME * abs(spline(np.linspace(0.0, 4.0 * pi, 7201), 1)).max()
    assert (start - end) / fastest == pytest.approx(-0.034, abs=5e-4)
    # so it sinks below its start, and is back after 6.4 degrees of the shaft
    (lowest,) = spline.derivative().roots(extrapolate=False)[:1]
    assert 1e3 * FRAME * float(spline(lowest)) == pytest.approx(-0.024, abs=5e-4)
    assert degrees(spline.roots(extrapolate=False)[1]) == pytest.approx(6.35, abs=5e-3)
    # and its acceleration, in mm per rad squared, goes on from 16.99 to 15.96
    ends = [1e3 * FRAME * float(spline(x, 2)) for x in (4.0 * pi, 0.0)]
    assert ends == pytest.approx([16.99, 15.96], abs=5e-3)


# Misprints of the source


def test_printed_height_of_table_4_2_makes_no_shed():
    # 657, the angle above it, in place of 1.5 mm
    printed = [*HEIGHTS[:4], 0.657, HEIGHTS[5]]
    spline = CubicSpline(ANGLES, printed, bc_type="not-a-knot")
    assert FRAME * spline(np.linspace(0.0, 4.0 * pi, 7201)).max() > 3.0  # m of travel


def test_scale_of_appendix_2_is_not_that_of_its_own_spline():
    travel = 1e3 * FRAME * published()(np.linspace(0.0, 4.0 * pi, 720001)).max()
    # 23 mm of the cam for 108 mm of travel: at the spline's own top the cam has 104.9 mm, not 107
    assert 84.0 + 23.0 / 108.0 * travel == pytest.approx(104.9, abs=0.05)
    assert 84.0 + 23.0 / 98.17 * travel == pytest.approx(107.0, abs=1e-3)  # 98.17 has four digits


# Phase


@given(st.floats(0.1, 12.4), st.floats(0.0, 1.0))
def test_phase_is_a_line_to_either_side_of_the_top(top, share):
    x = 4.0 * pi * share
    phase, rate = cam_phase(x, top)
    assert cam_phase(0.0, top)[0] == 0.0
    assert cam_phase(top, top)[0] == pytest.approx(2.0 * pi, abs=1e-15)  # one rounding
    assert cam_phase(4.0 * pi, top)[0] == pytest.approx(4.0 * pi, abs=4e-15)  # two
    assert rate == pytest.approx(2.0 * pi / (top if x <= top else 4.0 * pi - top), rel=1e-14)
    assert phase == pytest.approx(np.interp(x, [0.0, top, 4.0 * pi], [0.0, 2.0 * pi, 4.0 * pi]), abs=1e-13)
