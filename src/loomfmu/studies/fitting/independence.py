"""Tests of what a fit leaves of a signal: its intervals assume that these residuals are independent."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
SEEN = 1e-8  # of the square of what an offset changes: as little is left where a parameter does the same


@dataclass(frozen=True)
class Residuals:
    """The residuals of a signal's `count` values, in the order in which they were measured.

    `durbin_watson` is the sum of the squared steps from one residual to the next over that of the squared
    residuals, `runs` the number of stretches of one sign; both with what independent noise gives on
    average, and the `chance` of as little.
    """

    signal: str
    count: int
    durbin_watson: float
    expected_durbin_watson: float
    chance_of_durbin_watson: float
    runs: int
    expected_runs: float
    chance_of_runs: float

    @property
    def chance(self) -> float:
        """The lower one."""
        return min(self.chance_of_durbin_watson, self.chance_of_runs)


@dataclass(frozen=True)
class Shift:
    """The estimate of an offset of the places that is not fitted: its size, its standard error (rad or s),
    and the `chance` of as large a size if there is none.

    `moved` is what each parameter moves by, shape (p,), with an offset of 1 rad or 1 s.
    """

    size: float
    error: float
    chance: float
    moved: Floats


def residuals_of(signal: str, residuals: Floats, slopes: Floats, covariance: Floats) -> Residuals:
    """Test residuals, shape (n,), for a trend or slow swings that the fit has left.

    Args:
        signal: what they are of
        residuals: in the order of the places
        slopes: of the residuals by the parameters, shape (n, p)
        covariance: of the parameters for residuals of variance 1, shape (p, p)
    """
    return Residuals(
        signal, len(residuals), *_durbin_watson(residuals, slopes, covariance), *_runs(residuals)
    )


def _durbin_watson(residuals: Floats, slopes: Floats, covariance: Floats) -> tuple[float, float, float]:
    """The statistic of Durbin and Watson, its mean and its chance.

    Mean and variance are exact for these slopes (Durbin and Watson 1950, Biometrika 37, 409-428); the
    chance is that of the beta distribution from 0 to 4 that has them (1971, Biometrika 58, 1-19).
    """
    from scipy.special import betainc

    count, square = len(residuals), float(np.sum(residuals**2))
    steps = np.diff(slopes, axis=0)
    bends = np.diff(np.pad(steps, ((1, 1), (0, 0))), axis=0)
    taken = covariance @ steps.T @ steps
    freedom = count - float(np.trace(covariance @ slopes.T @ slopes))
    first = 2.0 * (count - 1) - float(np.trace(taken))
    second = (
        6.0 * count
        - 8.0
        - 2.0 * float(np.trace(covariance @ bends.T @ bends))
        + float(np.trace(taken @ taken))
    )
    if square == 0.0 or freedom <= 0.0:
        return math.nan, math.nan, 1.0
    mean = first / freedom
    variance = 2.0 * (second - first * mean) / (freedom * (freedom + 2.0))
    found = float(np.sum(np.diff(residuals) ** 2)) / square
    if variance <= 0.0:
        return found, mean, 1.0
    both = mean * (4.0 - mean) / variance - 1.0
    return found, mean, float(betainc(0.25 * mean * both, (1.0 - 0.25 * mean) * both, 0.25 * found))


def _runs(residuals: Floats) -> tuple[int, float, float]:
    """The number of runs, its mean and its chance (Wald and Wolfowitz 1940), by the normal distribution."""
    from scipy.special import ndtr

    above = residuals[residuals != 0.0] > 0.0
    count, positive = len(above), int(np.sum(above))
    if positive in (0, count):
        return int(count > 0), 1.0, 1.0
    runs = 1 + int(np.sum(above[1:] != above[:-1]))
    mean = 1.0 + 2.0 * positive * (count - positive) / count
    variance = (mean - 1.0) * (mean - 2.0) / (count - 1.0)
    chance = float(ndtr((runs + 0.5 - mean) / math.sqrt(variance))) if variance > 0.0 else 1.0
    return runs, mean, chance


def shift_of(residuals: Floats, slopes: Floats, covariance: Floats, drift: Floats) -> Shift:
    """Test residuals, all of them, for an offset of the places; arguments as of `residuals_of`.

    Args:
        drift: what the residuals change by with an offset, shape (n,)
    """
    from scipy.special import stdtr

    moved = -covariance @ slopes.T @ drift
    left = drift + slopes @ moved  # of an offset, after a fit
    square, freedom = float(left @ left), len(residuals) - slopes.shape[1] - 1
    if square <= SEEN * float(drift @ drift) or freedom < 1:
        return Shift(0.0, math.inf, 1.0, moved)
    size = -float(left @ residuals) / square
    error = float(np.linalg.norm(residuals + size * left)) / math.sqrt(freedom * square)
    chance = 2.0 * float(stdtr(freedom, -abs(size) / error)) if error > 0.0 else 1.0
    return Shift(size, error, chance, moved)
