"""The uncertainty of a fit: intervals, correlations, and whether the residuals are noise.

Intervals assume that residuals are independent, so what a fit leaves of each signal is tested for that.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...errors import LoomfmuError, listed
from ..span import Span
from .measured import Measured
from .search import Found, Loss

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


SURE = 0.95  # probability of the intervals
# share of the strongest direction below which parameters cannot be told apart: slopes are known to 1e-8
ALIKE = 1e-6


@dataclass(frozen=True)
class Fitted:
    """A fitted parameter (SI): its value and its 95 % interval, NaN for one that ended `at_bound`.

    The interval is not `trusted` where the residuals are not independent: it is then probably too narrow.
    `shift` is the offset of the data, rad or s, that moves the parameter to the end of its interval, infinite
    where one is fitted.
    """

    span: Span
    value: float
    low: float
    high: float
    at_bound: bool
    trusted: bool
    shift: float


@dataclass(frozen=True, repr=False)
class Sure:
    """Fitted parameters, with all that says how sure they are.

    `correlations`, shape (p, p), are those of the parameters' errors, NaN for one at its bound. `residuals`
    and `shift` say whether what remains is independent, as the intervals assume: of each signal, and of all
    with an offset of the data, None where that is fitted.
    """

    parameters: tuple[Fitted, ...]
    correlations: Floats = field(compare=False)
    residuals: tuple[Residuals, ...]
    shift: Shift | None


def sure(data: Measured, spans: Sequence[Span], found: Found, loss: Loss) -> Sure:
    """Intervals by a linear model around the result. Raises LoomfmuError where parameters are alike in it."""
    from scipy.special import stdtrit

    free = np.flatnonzero(~found.at_bound)
    slopes = found.slopes[:, free]
    inverse = _inverse(data, slopes, [spans[each] for each in free.tolist()])
    pulls, bends = loss.weighed(found.residuals)
    covariance = np.full((len(spans), len(spans)), math.nan)
    covariance[np.ix_(free, free)] = inverse * _variance(pulls, bends, len(free))
    errors = np.sqrt(np.diag(covariance))
    with np.errstate(invalid="ignore"):
        correlations = covariance / np.outer(errors, errors)
    residuals = tuple(
        residuals_of(name, pulls[rows], slopes[rows], inverse) for name, rows in data.rows.items()
    )
    fitted = any(not span.varied.targets for span in spans)
    offset = None if fitted else shift_of(pulls / np.mean(bends), slopes, inverse, found.drift)
    reach = stdtrit(len(pulls) - len(free), 0.5 + 0.5 * SURE) * errors
    shifts = np.full(len(spans), math.inf)
    if offset is not None:
        with np.errstate(divide="ignore"):
            shifts[free] = reach[free] / np.abs(offset.moved)
    trusted = not doubtful(residuals, offset)
    parameters = []
    for span, share, half, shift, ended in zip(
        spans, found.shares, reach.tolist(), shifts.tolist(), found.at_bound.tolist(), strict=True
    ):
        value, width = span.at(share), half * (span.high - span.low)
        parameters.append(Fitted(span, value, value - width, value + width, ended, trusted, shift))
    return Sure(tuple(parameters), correlations, residuals, offset)


def doubtful(residuals: Sequence[Residuals], offset: Shift | None) -> list[Residuals | Shift]:
    """Return the tests that reject independent residuals; together they err in at most 5 % of cases."""
    tests = 2 * len(residuals) + (offset is not None)
    found: list[Residuals | Shift] = [*residuals, *([] if offset is None else [offset])]
    return [each for each in found if each.chance < (1.0 - SURE) / tests]


def _variance(pulls: Floats, bends: Floats, size: int) -> float:
    """Variance of the residuals as it counts for a loss (Huber 1981, Robust Statistics, section 7.6)."""
    mean = float(np.mean(bends))
    spread = 1.0 + size / len(pulls) * float(np.var(bends)) / mean**2
    return spread**2 * float(np.sum(pulls**2)) / (len(pulls) - size) / mean**2


def _inverse(data: Measured, slopes: Floats, spans: Sequence[Span]) -> Floats:
    """The inverse of the slopes' squares, from singular values: squares would lose half of the digits.

    Refuses parameters whose effects on the data are the same.
    """
    if not spans:
        return np.empty((0, 0))
    lengths = np.linalg.norm(slopes, axis=0)
    if not np.all(lengths):
        weakest = lengths.tolist().index(0.0)
        raise LoomfmuError(f"{spans[weakest].key} changes none of the measured signals at the result")
    _left, strengths, directions = np.linalg.svd(slopes / lengths, full_matrices=False)
    if strengths[-1] <= ALIKE * strengths[0]:
        weak = [span.key for span, part in zip(spans, directions[-1], strict=True) if abs(part) > 0.1]
        raise LoomfmuError(f"{data.path}: the data cannot tell {listed(weak)} apart; fit only one of them")
    scaled = directions / strengths[:, None] / lengths
    return np.asarray(scaled.T @ scaled, dtype=float)
