"""Uniform periodic spline: the closed form of its second derivatives."""

from math import pi

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from loomfmu.physics.numerics.spline import Cubic, cubic_piece
from loomfmu.physics.rotor_laws.table import bend_weight

every_size = pytest.mark.parametrize("points", range(4, 37))


@every_size
def test_weights_invert_the_system_of_the_spline(points):
    system = 4.0 * np.eye(points)
    for k in range(points):
        system[k, (k + 1) % points] += 1.0
        system[k, k - 1] += 1.0
    step = 2.0 * pi / points
    weights = np.array([bend_weight(distance, points) for distance in range(points)])
    inverse = np.linalg.inv(system)[0] * 6.0 / step**2
    # rounding of a well-conditioned system (its condition is 3), over the largest weight
    assert np.all(abs(weights - inverse) < 1e-14 * weights[0])
    assert weights[1:] == pytest.approx(weights[:0:-1], rel=1e-12)  # the same to either side, to rounding


@every_size
def test_spline_is_that_of_scipy(points):
    rng = np.random.default_rng(points)
    values = rng.uniform(-1.0, 1.0, points)
    step = 2.0 * pi / points
    knots = step * np.arange(points + 1)
    spline = CubicSpline(knots, np.append(values, values[0]), bc_type="periodic")
    second = np.roll(values, 1) - 2.0 * values + np.roll(values, -1)
    bends = [
        sum(bend_weight(m, points) * second[(k + m) % points] for m in range(points)) for k in range(points)
    ]
    for k in range(points):
        for share in (0.0, 0.3, 0.9):
            after = (k + 1) % points
            piece = Cubic(step, values[k], values[after], bends[k], bends[after])
            found = cubic_piece(piece, share * step)
            for order in range(4):
                # rounding of values up to 1, divided by the step once for each derivative
                exact = spline(knots[k] + share * step, order)
                assert found[order] == pytest.approx(exact, abs=1e-14 / step**order * 10.0)
