"""The spline cam's law: the spline with cubic ends, its published figures, the join of two picks."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicSpline

from loomfmu.physics.rotor_laws.shed_cam import cam_phase, not_a_knot


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
