"""A piece of a cubic spline: against polynomials of scipy, and what is found on it."""

from dataclasses import astuple
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import PPoly

from loomfmu.physics.numerics.spline import Cubic, cubic_piece, slope_extremes, stretch_above, turning_points

unit = st.integers(-1000, 1000).map(lambda thousandths: thousandths / 1000)
pieces = st.builds(Cubic, st.floats(0.1, 10.0), unit, unit, unit, unit)


def polynomial(piece):
    """The piece in powers of the distance from its left knot, with 0 beyond the ends left out."""
    length, left, right, left_bend, right_bend = astuple(piece)
    third = (right_bend - left_bend) / length
    slope = (right - left) / length - length * (2.0 * left_bend + right_bend) / 6.0
    return PPoly([[third / 6.0], [0.5 * left_bend], [slope], [left]], [0.0, length], extrapolate=False)


@given(pieces, st.floats(0.0, 1.0))
def test_pieces_are_cubics(piece, share):
    place = share * piece.length
    exact = polynomial(piece)
    # rounding of terms up to length^2: 100
    for order, found in enumerate(cubic_piece(piece, place)):
        assert found == pytest.approx(float(exact(place, order)), abs=1e-13)


@given(pieces, st.floats(0.0, 1.0))
def test_slopes_lie_between_their_extremes(piece, share):
    lowest, highest = slope_extremes(piece)
    slope = cubic_piece(piece, share * piece.length)[1]
    assert lowest - 1e-14 <= slope <= highest + 1e-14  # rounding of terms up to 10
    ends = [cubic_piece(piece, place)[1] for place in (0.0, piece.length)]
    exact = polynomial(piece)
    crests = [float(exact(x, 1)) for x in exact.derivative(2).roots() if 0.0 < x < piece.length]
    assert (lowest, highest) == pytest.approx((min(ends + crests), max(ends + crests)), abs=1e-13)  # rounding


@given(pieces)
def test_turning_points_are_in_order_and_none_is_missed(piece):
    length = piece.length
    first, second = turning_points(piece)
    assert 0.0 <= first <= second <= length
    for low, high in ((0.0, first), (first, second), (second, length)):
        # between them it rises or falls throughout; 1e-12: rounding of terms up to 100
        steps = np.diff([cubic_piece(piece, x)[0] for x in np.linspace(low, high, 50)])
        assert np.all(steps >= -1e-12) or np.all(steps <= 1e-12)


@given(pieces, st.floats(-2.0, 2.0))
def test_stretch_above_a_level(piece, level):
    length = piece.length
    exact = polynomial(piece)
    cuts = [float(x) for x in exact.solve(level, extrapolate=False) if 0.0 < x < length]
    edges = [0.0, *sorted(cuts), length]
    above = sum(high - low for low, high in pairwise(edges) if exact(0.5 * (low + high)) >= level)
    # a crossing is known to 1e-14 over the slope there, and where the piece but touches the level, to the
    # square root of that: 1e-6 holds both
    assert stretch_above(piece, level) == pytest.approx(above, abs=1e-6)


def test_stretch_above_is_found_to_rounding():
    third_power = Cubic(2.0, -1.0, 1.0, -6.0, 6.0)  # from -1 to 1: above 0.001 from 0.1 on
    assert stretch_above(third_power, 1e-3) == pytest.approx(0.9, abs=1e-14)  # 1e-16 over 0.03
    assert stretch_above(third_power, -1.0) == 2.0
    assert stretch_above(third_power, 1.5) == 0.0


def test_a_straight_piece_has_no_turning_point():
    assert turning_points(Cubic(2.0, 0.0, 1.0, 0.0, 0.0)) == (0.0, 2.0)
    assert slope_extremes(Cubic(2.0, 0.0, 1.0, 0.0, 0.0)) == (0.5, 0.5)
    assert stretch_above(Cubic(2.0, 0.0, 1.0, 0.0, 0.0), 0.25) == 1.5
