"""Polynomials between samples, by their Bernstein points.

The polynomial stays between the lowest and the highest of its points and begins and ends at the outer ones.
Cut in half, the points come closer to it by a factor of four: so its extremes and its zeros are found for any
degree, for many pieces at once, and none is missed.
"""

from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Number = TypeVar("Number", float, Floats)

HALVINGS = 60  # more than doubles can tell apart
ROUNDING = 4.0 * float(np.finfo(float).eps)


def joining(ends: list[tuple[Number, Number]]) -> list[Number]:
    """Points of the polynomials that join samples, of one piece or of many.

    Args:
        ends: values at both ends of each piece, then their rates and second rates as far as they are known,
            by the share of the way: straight lines, cubics or quintics
    """
    y0, y1 = ends[0]
    if len(ends) == 1:
        return [y0, y1]
    v0, v1 = ends[1]
    if len(ends) == 2:
        return [y0, y0 + v0 / 3.0, y1 - v1 / 3.0, y1]
    a0, a1 = ends[2]
    return [
        y0,
        y0 + 0.2 * v0,
        y0 + 0.4 * v0 + 0.05 * a0,
        y1 - 0.4 * v1 + 0.05 * a1,
        y1 - 0.2 * v1,
        y1,
    ]


def raised(points: Floats, height: Floats) -> Floats:
    """Points of cubics or quintics with a bump on each, which leaves values and rates at the ends.

    The bump `16 s^2 (1 - s)^2` times its height is what an unknown rate of change of the rates may add.
    """
    if len(points) == 4:
        c0, c1, c2, c3 = points
        middle = 0.5 * (c1 + c2) + 16.0 / 6.0 * height
        return np.stack([c0, 0.25 * (c0 + 3.0 * c1), middle, 0.25 * (3.0 * c2 + c3), c3])
    bumps = np.zeros_like(points)
    bumps[2:4] = 1.6 * height
    return np.asarray(points + bumps)


def split(points: Floats, share: float | Floats) -> tuple[Floats, Floats]:
    """The pieces before and after a share of the way, by de Casteljau's scheme."""
    left, right = np.empty_like(points), np.empty_like(points)
    degree = len(points) - 1
    for order in range(degree + 1):
        left[order], right[degree - order] = points[0], points[-1]
        points = points[:-1] + share * np.diff(points, axis=0)
    return left, right


def value(points: Floats, share: float | Floats) -> Floats:
    """Value at a share of the way."""
    for _ in range(len(points) - 1):
        points = points[:-1] + share * np.diff(points, axis=0)
    return np.asarray(points[0])


def clipped(points: Floats, low: Floats, high: Floats) -> Floats:
    """The part of each piece between two shares of its way; a whole one stays as it is, to the last bit."""
    cut = (low > 0.0) | (high < 1.0)
    if cut.any():
        points = points.copy()
        points[:, cut] = split(split(points[:, cut], high[cut])[0], low[cut] / high[cut])[1]
    return points


def lowest(points: Floats) -> tuple[Floats, Floats]:
    """Lowest value of each piece, and the share of the way at which it is."""
    best = np.minimum(points[0], points[-1])
    share = np.where(points[-1] < points[0], 1.0, 0.0)
    noise = ROUNDING * np.abs(points).max(axis=0)
    piece, begin, width = np.arange(points.shape[1]), np.zeros(points.shape[1]), 1.0
    for _ in range(HALVINGS):
        lower = points.min(axis=0) < best[piece] - noise[piece]
        if not lower.any():
            break
        points, piece, begin, width = points[:, lower], piece[lower], begin[lower], 0.5 * width
        left, right = split(points, 0.5)
        # of several halves of one piece the last one assigned stays: the lowest
        order = np.argsort(-right[0])
        order = order[right[0][order] < best[piece[order]]]
        best[piece[order]] = right[0][order]
        share[piece[order]] = begin[order] + width
        points = np.concatenate([left, right], axis=1)
        piece, begin = np.tile(piece, 2), np.concatenate([begin, begin + width])
    return best, share


def value_of_piece(points: list[float], share: float) -> float:
    """Value at a share of the way of one piece: the same as `value`, to the last bit."""
    while len(points) > 1:
        points = [a + share * (b - a) for a, b in pairwise(points)]
    return points[0]


def sign_changes(points: list[float], begin: float = 0.0, width: float = 1.0) -> list[float]:
    """Shares of the way at which one piece changes its sign, in order; 0 counts as positive."""
    changes = sum((a < 0.0) != (b < 0.0) for a, b in pairwise(points))
    if changes == 0:
        return []
    if changes == 1:
        return [begin + width * _sign_change(points)]
    if width < 2.0**-HALVINGS:
        return [begin] if (points[0] < 0.0) != (points[-1] < 0.0) else []
    left, right = (half[:, 0].tolist() for half in split(np.array(points)[:, np.newaxis], 0.5))
    half = 0.5 * width
    return sign_changes(left, begin, half) + sign_changes(right, begin + half, half)


def _sign_change(points: list[float]) -> float:
    """Return the place of the only sign change of a piece, by bisection down to rounding."""
    low, high = 0.0, 1.0
    begins_negative = points[0] < 0.0
    while low < (middle := 0.5 * (low + high)) < high:
        if (value_of_piece(points, middle) < 0.0) == begins_negative:
            low = middle
        else:
            high = middle
    return high
