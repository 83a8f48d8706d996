"""The length factor of Zhu and Zhou beside that of a guide with free play: a finding of our own."""

import math

from belt_guide_reference import CLAMPED, guide_for, length_factor, length_factor_in_motion, measured

from validation.digits import number

__all__ = ["clamped_factor", "guides", "length_factor", "length_factor_in_motion", "measured"]


def clamped_factor() -> float:
    """Length factor of a belt that is clamped in its guide."""
    return math.pi / CLAMPED


def guides(column: str, length: float) -> str:
    """Say which guides give a measured length factor, in millimetres."""
    clearance = 1e-3 * float(column.removeprefix("c_"))
    longest, shortest = (1e3 * guide_for(mu, clearance, length) for mu in measured(column, length))
    if longest == 0.0:
        return "none"
    if math.isinf(longest):
        return "any"
    return f"{number(shortest, 0)} to {number(longest, 0)}" if shortest else f"up to {number(longest, 0)}"
