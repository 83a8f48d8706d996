"""The length factor of Zhu and Zhou beside that of a guide with free play: a finding of our own."""

import math
from functools import cache

from belt_guide_reference import (
    ALLOWED,
    CLAMPED,
    guide_for,
    length_factor,
    length_factor_in_motion,
    measured,
    measured_load,
    sprung_factor,
)
from scipy.optimize import minimize_scalar

from loomfmu.components.belt_dynamics import BeltDynamics
from validation.digits import number

__all__ = [
    "clamped_factor",
    "guides",
    "length_factor",
    "length_factor_in_motion",
    "load",
    "measured",
    "measured_load",
    "stiffness",
    "worth",
]

COLUMNS = ("c_0", "c_0.30", "c_0.50", "c_0.75", "c_0.80")  # of Table 2, by the clearance in mm
LENGTHS = (0.414, 0.514, 0.665)


def clamped_factor() -> float:
    """Length factor of a belt that is clamped in its guide."""
    return math.pi / CLAMPED


def guides(column: str, length: float) -> str:
    """Say which guides give a measured length factor, in millimetres."""
    longest, shortest = (1e3 * guide_for(mu, _clearance(column), length) for mu in measured(column, length))
    if longest == 0.0:
        return "none"
    if math.isinf(longest):
        return "any"
    return f"{number(shortest, 0)} to {number(longest, 0)}" if shortest else f"up to {number(longest, 0)}"


def load(way: str, column: str, length: float) -> float:
    """Load of Table 2 as another guide would give it [N]: the one of `guide`, or of `stiffness`."""
    if way == "spring":
        return _load(
            clamped_factor() if column == "c_0" else sprung_factor(stiffness(column), length), length
        )
    return with_play(way, guide(way), column, length)


@cache
def guide(way: str) -> float:
    """Length of the stiff guide with play that is least off the loads, beyond their rounding [m]."""
    found = minimize_scalar(
        lambda long: sum(
            beyond(with_play(way, long, column, length), column, length) ** 2
            for column in COLUMNS
            for length in LENGTHS
        ),
        bounds=(0.02, 0.1),
        method="bounded",
        options={"xatol": 1e-6},
    )
    return float(found.x)


@cache
def stiffness(column: str) -> float:
    """Stiffness of an elastic guide that is least off the loads of a clearance [N.m]."""
    found = minimize_scalar(
        lambda exponent: sum(
            (_load(sprung_factor(10.0**exponent, length), length) - measured_load(column, length)) ** 2
            for length in LENGTHS
        ),
        bounds=(-3.0, 3.0),
        method="bounded",
    )
    return 10.0 ** float(found.x)


def worth(way: str) -> tuple[int, float]:
    """How many of the fifteen loads are within their rounding, and how far beyond it the worst one is [N]."""
    off = [beyond(load(way, each, length), each, length) for each in COLUMNS for length in LENGTHS]
    return sum(each == 0.0 for each in off), max(off)


def _clearance(column: str) -> float:
    return 1e-3 * float(column.removeprefix("c_"))


def _load(factor: float, length: float) -> float:
    return BeltDynamics().bending_stiffness * (math.pi / (factor * length)) ** 2


def with_play(way: str, guide: float, column: str, length: float) -> float:
    """Load at 2 mm of deflection, or at as large a share of the length [N]."""
    read_at = ALLOWED if way == "deflection" else ALLOWED * length / LENGTHS[0]
    return _load(length_factor(_clearance(column), guide, length, read_at), length)


def beyond(found: float, column: str, length: float) -> float:
    """How far a load is off the measured one, beyond its rounding [N]."""
    return max(abs(found - measured_load(column, length)) - 0.5, 0.0)
