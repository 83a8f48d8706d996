"""Arithmetic between printed numbers."""

import math
from statistics import fmean


def sum(*given: float) -> float:
    """Return their sum."""
    return math.fsum(given)


def mean(*given: float) -> float:
    """Return their mean."""
    return fmean(given)


def product(*given: float) -> float:
    """Return their product."""
    return math.prod(given)


def quotient(one: float, other: float) -> float:
    """Return one over the other."""
    return one / other


def difference(one: float, other: float) -> float:
    """Return by how much one exceeds the other."""
    return one - other


def growth(before: float, after: float) -> float:
    """Return by what share of it a number grows."""
    return after / before - 1.0


def sine(angle: float) -> float:
    """Return its sine."""
    return math.sin(angle)


def root(given: float) -> float:
    """Return its square root."""
    return math.sqrt(given)


def scaled(one: float, other: float, exponent: float) -> float:
    """Return one over a power of the other."""
    return one / other**exponent
