"""Arrays of spans: the low and the high bound of a number in the last axis, rounded outwards."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ends = tuple[float, float]
ULP = 2.0**-52
TINY = 2.0**-1021  # more than a rounding of the smallest numbers


def outwards(low: Floats, high: Floats) -> Floats:
    """Return spans that the rounding of their bounds cannot have made too narrow; NaN opens them."""
    low = low - (np.abs(low) * ULP + TINY)
    high = high + (np.abs(high) * ULP + TINY)
    return np.stack([np.where(low <= high, low, -np.inf), np.where(low <= high, high, np.inf)], axis=-1)


def plus(a: Floats, b: Floats) -> Floats:
    """Return the sums of two arrays of spans; a sum that is 0, or with 0, is exact."""
    total = a + b
    exact = (total == 0.0) | (a == 0.0) | (b == 0.0)
    return np.where(exact, total, outwards(total[..., 0], total[..., 1]))


def minus(a: Floats, b: Floats) -> Floats:
    """Return the differences of two arrays of spans."""
    return plus(a, -b[..., ::-1])


def times(a: Floats, b: Floats) -> Floats:
    """Return the products of two arrays of spans; an infinite bound is no value, so that 0 times it is 0."""
    with np.errstate(invalid="ignore", over="ignore"):
        products = a[..., :, None] * b[..., None, :]
    products[(a[..., :, None] == 0.0) | (b[..., None, :] == 0.0)] = 0.0
    flat = products.reshape(*products.shape[:-2], 4)
    found = outwards(flat.min(axis=-1), flat.max(axis=-1))
    exact = np.all((np.abs(a) == 1.0) | (a == 0.0), axis=-1) | np.all(
        (np.abs(b) == 1.0) | (b == 0.0), axis=-1
    )
    found[exact] = np.stack([flat.min(axis=-1), flat.max(axis=-1)], axis=-1)[exact]
    return found


def both(a: Floats, b: Floats) -> Floats:
    """Return what two arrays of spans have in common, where both hold the same number."""
    low, high = np.maximum(a[..., 0], b[..., 0]), np.minimum(a[..., 1], b[..., 1])
    assert np.all(low <= high), "two enclosures of one number have nothing in common"
    return np.stack([low, high], axis=-1)


def constant(value: float, shape: tuple[int, ...] = ()) -> Floats:
    """Return spans of one number."""
    return np.full((*shape, 2), value)
