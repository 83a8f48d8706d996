"""The uncertainty of a fit: intervals, correlations, and whether the residuals are noise."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...errors import LoomfmuError, listed
from ..span import Span
from .independence import Floats, Residuals, Shift, residuals_of, shift_of
from .losses import Loss
from .measured import Measured
from .search import Found

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


@dataclass(frozen=True)
class Sure:
    """The parameters with their intervals, the correlations of their errors, and what remains: each signal's
    residuals, and how they speak of an offset of the data, None where that is fitted."""

    parameters: tuple[Fitted, ...]
    correlations: Floats
    residuals: tuple[Residuals, ...]
    offset: Shift | None


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
