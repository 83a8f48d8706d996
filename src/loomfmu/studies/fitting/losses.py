"""Losses: how much of a residual counts in a fit; those of scipy's `least_squares`, by their names."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Loss(NamedTuple):
    """A loss rho(z) of the squared residual z, with its first two derivatives, shape (3, n).

    `scale` is the residual, in standard errors, for which z is 1: with normal noise intervals are then as
    wide as those of least squares whose data are fewer by 5 %.
    """

    scale: float
    rho: Callable[[Floats], Floats]

    def weighed(self, residuals: Floats) -> tuple[Floats, Floats]:
        """Slope and curvature of half the loss at residuals, given in standard errors."""
        z = (residuals / self.scale) ** 2
        _value, slope, bend = self.rho(z)
        return residuals * slope, slope + 2.0 * z * bend


def _linear(z: Floats) -> Floats:
    return np.array([z, np.ones_like(z), np.zeros_like(z)])


def _soft_l1(z: Floats) -> Floats:
    root = np.sqrt(1.0 + z)
    return np.array([2.0 * (root - 1.0), 1.0 / root, -0.5 / root**3])


def _huber(z: Floats) -> Floats:
    root = np.sqrt(np.maximum(z, 1.0))
    return np.where(z <= 1.0, _linear(z), [2.0 * root - 1.0, 1.0 / root, -0.5 / root**3])


def _cauchy(z: Floats) -> Floats:
    return np.array([np.log1p(z), 1.0 / (1.0 + z), -1.0 / (1.0 + z) ** 2])


def _arctan(z: Floats) -> Floats:
    return np.array([np.arctan(z), 1.0 / (1.0 + z**2), -2.0 * z / (1.0 + z**2) ** 2])


LEAST_SQUARES = "linear"
LOSSES = {
    LEAST_SQUARES: Loss(1.0, _linear),
    "soft_l1": Loss(1.2871, _soft_l1),
    "huber": Loss(1.3450, _huber),
    "cauchy": Loss(2.3849, _cauchy),
    "arctan": Loss(2.5714, _arctan),
}
