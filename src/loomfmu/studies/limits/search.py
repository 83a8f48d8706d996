"""Roots and extremes of a function of one variable, which may jump and may have no value (NaN).

Above or at 0 a claim holds; below 0, or without a value, it fails. Functions are called through a cache by
whoever passes them, so no point is paid for twice.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

Function = Callable[[float], float]
WIDTH = 1e-10  # of the value: how narrow a root is bracketed
ABOUT_ZERO = 1e-6  # of the bracket: a root closer to 0 is found to that share of it, not of itself
JUMP = (
    1e-3  # of the change over the first bracket that is left in the last one: continuous functions leave less
)
NARROWEST = 1e-7  # of the first bracket: where the search for an extreme ends
MOST = 60  # calls for one extreme
GOLDEN = 0.5 * (3.0 - math.sqrt(5.0))


class Root(NamedTuple):
    """A root of a function: between `low` and `high`, at `value`, and whether it jumps there."""

    value: float
    low: float
    high: float
    jumps: bool


def holds(distance: float) -> bool:
    """Return whether a claim holds at that distance from its bound; NaN fails."""
    return distance >= 0.0


def root(function: Function, low: float, high: float) -> Root:
    """The place in a bracket where the function changes sides, by Chandrupatla's method.

    It interpolates where that is safe and else halves, so steps, jumps and missing values cost no more than
    bisection does. T. R. Chandrupatla, Advances in Engineering Software 28 (1997) 145-149.
    """
    a, b = low, high
    fa, fb = function(a), function(b)
    change = abs(fb - fa) if math.isfinite(fb - fa) else max(abs(each) for each in (fa, fb) if each == each)
    c, fc, share = a, fa, 0.5
    while abs(b - a) > (width := WIDTH * max(abs(a), abs(b), ABOUT_ZERO * (high - low))):
        x = a + share * (b - a)
        fx = function(x)
        if holds(fx) == holds(fa):
            c, fc = a, fa
        else:
            c, fc, b, fb = b, fb, a, fa
        a, fa = x, fx
        share = _share(a, fa, b, fb, c, fc)
        least = 0.5 * width / max(abs(b - a), width)
        share = min(max(share, least), 1.0 - least)
    value = a if math.isnan(fb) or abs(fa) <= abs(fb) else b
    continuous = math.isfinite(fb - fa) and abs(fb - fa) <= JUMP * change
    return Root(value, min(a, b), max(a, b), not continuous)


def _share(a: float, fa: float, b: float, fb: float, c: float, fc: float) -> float:
    """Return the next place to try between a and b: by inverse quadratic interpolation if safe, else 0.5."""
    if fa in (fb, fc) or fb == fc or b == c:
        return 0.5
    xi, phi = (a - b) / (c - b), (fa - fb) / (fc - fb)
    if not (phi * phi < xi and (1.0 - phi) * (1.0 - phi) < 1.0 - xi):  # also for NaN
        return 0.5
    return fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)


def near_zero(before: float, here: float, after: float) -> bool:
    """Return whether an extreme about the middle one of three values may pass 0 between them.

    The middle one is the nearest to 0 on its side. The function may go on from it for one interval as steeply
    as it came.
    """
    if not (holds(before) == holds(here) == holds(after)) or math.isnan(before + here + after):
        return False
    side = 1.0 if holds(here) else -1.0
    steepest = max(side * (before - here), side * (after - here))
    return min(side * (before - here), side * (after - here)) >= 0.0 < steepest >= side * here


def touching(function: Function, low: float, middle: float, high: float) -> float | None:
    """A place between `low` and `high` where the function is on the other side of 0; None if none is found.

    The extreme about `middle` is searched for by parabolas and golden sections, until the other side is
    reached or the function, going on as steeply as it does, cannot reach it any more.
    """
    points = low, middle, high
    values = function(low), function(middle), function(high)
    narrowest, widths = NARROWEST * (high - low), (math.inf, math.inf)
    for _call in range(MOST):
        (a, m, b), (fa, fm, fb) = points, values
        if not near_zero(fa, fm, fb) or b - a < narrowest:
            break
        x = _vertex(a, fa, m, fm, b, fb)
        slow = b - a > 0.5 * widths[0]
        if slow or not a < x < b or x == m:
            x = m + GOLDEN * (b - m) if b - m > m - a else m - GOLDEN * (m - a)
        if abs(x - m) < 0.1 * narrowest:
            x = m + math.copysign(0.1 * narrowest, b + a - 2.0 * m)
        widths = widths[1], b - a
        fx = function(x)
        if holds(fx) != holds(fm):
            return x
        if fx == fm:  # flat, as a count is
            break
        side = 1.0 if holds(fm) else -1.0
        left, right = ((m, fm), (x, fx)) if m < x else ((x, fx), (m, fm))
        if side * left[1] < side * right[1]:
            points, values = (a, left[0], right[0]), (fa, left[1], right[1])
        else:
            points, values = (left[0], right[0], b), (left[1], right[1], fb)
    return None


def _vertex(a: float, fa: float, m: float, fm: float, b: float, fb: float) -> float:
    """Return the vertex of the parabola through three points; NaN for a straight line."""
    before, after = (m - a) * (fm - fb), (m - b) * (fm - fa)
    if before == after:
        return math.nan
    return m - 0.5 * ((m - a) * before - (m - b) * after) / (before - after)
