"""Losses against scipy's own, against differences, and against what their scales promise."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import least_squares

from loomfmu.studies.fitting.search import LOSSES


@pytest.mark.parametrize("name", LOSSES)
def test_losses_are_those_of_scipy_with_their_derivatives(name: str) -> None:
    loss = LOSSES[name]
    data = np.array([0.1, -0.4, 0.3, 9.0, 0.2, -5.0])
    ours, theirs = (
        least_squares(lambda x: x - data, [0.5], loss=each, f_scale=loss.scale) for each in (loss.rho, name)
    )
    assert ours.cost == pytest.approx(theirs.cost, rel=1e-12) and ours.x == pytest.approx(theirs.x, rel=1e-12)
    z, step = np.array([0.01, 0.5, 2.0, 40.0]), 1e-5
    value, slope, bend = loss.rho(z)
    # central differences leave the square of their step
    assert (loss.rho(z + step)[0] - loss.rho(z - step)[0]) / (2.0 * step) == pytest.approx(slope, rel=1e-6)
    assert (loss.rho(z + step)[1] - loss.rho(z - step)[1]) / (2.0 * step) == pytest.approx(bend, rel=1e-6)
    assert np.all(value <= z + 1e-15)


@pytest.mark.parametrize("name", [name for name in LOSSES if name != "linear"])
def test_with_normal_noise_a_robust_loss_wastes_5_percent_of_the_data(name: str) -> None:
    loss = LOSSES[name]

    def mean(part: int, power: int) -> float:
        def weighed(r: float) -> float:
            pull = loss.weighed(np.array([r]))[part]
            return float(pull[0] ** power * np.exp(-0.5 * r**2) / np.sqrt(2.0 * np.pi))

        ends = (0.0, loss.scale, 12.0)  # the slope of the slope of huber jumps at its scale
        return 2.0 * sum(quad(weighed, *each)[0] for each in pairwise(ends))

    # the variance of an estimate is the mean square of the slope over the square of the mean curvature;
    # scales have five digits
    assert mean(1, 1) ** 2 / mean(0, 2) == pytest.approx(0.95, abs=2e-5)
