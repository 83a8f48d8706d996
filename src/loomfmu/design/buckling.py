"""The length factor of a belt, fitted to a user's own buckling tests.

Source: Zhu and Zhou, J. Zhejiang Sci-Tech Univ. 45 (2021) 497, section 3.2, equation (8), Tables 2 and 3.
"""

from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import ArrayLike

from ..errors import LoomfmuError
from .loom import BENDING_STIFFNESS
from .quantities import Quantity, listed, read


@dataclass(frozen=True)
class LengthFactor:
    """A fitted length factor [1], its standard error [1], and what of each load it does not explain [N]."""

    factor: float
    standard_error: float
    residuals: tuple[float, ...]


def fit_length_factor(
    lengths: ArrayLike, loads: ArrayLike, stiffness: Quantity = BENDING_STIFFNESS
) -> LengthFactor:
    """Length factor that fits buckling loads at one clearance best, by least squares on equation (8).

    `F = pi^2 EI / (mu l)^2` is linear in `1 / mu^2`, so the fit is exact. The standard error assumes loads
    that scatter equally, whatever the length.

    Args:
        lengths: free lengths l [m]
        loads: measured critical loads [N], one for each length
        stiffness: bending stiffness EI [N m2]

    Raises:
        LoomfmuError: fewer than two tests, a length or load that is not positive, or a factor that is no
            column's, as of lengths in mm

    >>> fit = fit_length_factor(["414 mm", "514 mm", "665 mm"], [22, 15, 9])  # Table 2, c = 0.3 mm
    >>> round(fit.factor, 3), round(fit.standard_error, 3)  # Table 3: 0.80
    (0.801, 0.007)
    """
    length, load = listed("lengths", lengths, "m"), listed("loads", loads, "N")
    if length.shape != load.shape or length.size < 2:
        raise LoomfmuError(
            f"{length.size} lengths and {load.size} loads: give as many of each, and at least two"
        )
    for name, values, unit in (("lengths", length, "m"), ("loads", load, "N")):
        bad = np.flatnonzero(~((values > 0.0) & np.isfinite(values)))
        if bad.size:
            raise LoomfmuError(f"{name}[{bad[0]}] = {values[bad[0]]:.7g} {unit} must be positive and finite")
    pinned = pi * pi * read("stiffness", stiffness) / length**2
    square = float(pinned @ pinned)
    inverse = float(pinned @ load) / square  # 1 / mu^2
    residuals = load - inverse * pinned
    factor = read("length_factor", 1.0 / sqrt(inverse))
    scatter = sqrt(float(residuals @ residuals) / (length.size - 1) / square)
    return LengthFactor(factor, 0.5 * factor**3 * scatter, tuple(float(each) for each in residuals))
