"""The part of a run that a picture shows, as people name it: from, to, a revolution."""

import math

import numpy as np

from .. import units
from ..errors import LoomfmuError, within
from ..traces import Trace
from ..traces.plotting import Extent

UNITS = {"angle": ("deg", "rad", 180.0 / math.pi), "time": ("s", "s", 1.0)}  # of an axis, and to parse


def extent(
    trace: Trace, over: str, fold: bool, start: str | None, end: str | None, revolution: int | None
) -> Extent | None:
    """Return the part of the axis to draw; None for all of it.

    Raises LoomfmuError where a value cannot be read, the part is empty, or the run does not have it.
    """
    if start is None and end is None and revolution is None:
        return None
    shown, unit, factor = UNITS[over]
    along = np.degrees(trace.shaft_angle) if over == "angle" else trace.time
    low, high = (0.0, 360.0) if fold else (float(along.min()), float(along.max()))
    origin = 0.0
    if revolution is not None:
        low, high, origin = _turn(trace, revolution, over, fold)
    first = low if start is None else _number("--from", start, unit, factor)
    last = high if end is None else _number("--to", end, unit, factor)
    if not first < last or last <= low or first >= high:
        found = f"{first:.6g}..{last:.6g} {shown}"
        raise LoomfmuError(f"{found} is not a part of the axis, which has {low:.6g}..{high:.6g} {shown}")
    return Extent(first, last, origin)


def _turn(trace: Trace, number: int, over: str, fold: bool) -> tuple[float, float, float]:
    """Return the ends of a revolution on the axis, and where the axis has its zero."""
    if fold:
        raise LoomfmuError("--fold draws all revolutions over one another; leave it or --revolution out")
    if not trace.turns:
        raise LoomfmuError(f"{trace.given}: {trace.standing}, so there are no revolutions")
    degrees = np.degrees(trace.shaft_angle)
    first, last = 360.0 * (number - 1), 360.0 * number
    known = math.floor(degrees.min() / 360.0 + 1e-9) + 1, math.ceil(degrees.max() / 360.0 - 1e-9)
    if not known[0] <= number <= known[1]:
        raise LoomfmuError(f"revolution = {number} is outside [{known[0]}, {known[1]}] of {trace.given}")
    if over == "angle":
        return 0.0, 360.0, first
    inside = trace.time[(degrees >= first) & (degrees <= last)]
    return float(inside[0]), float(inside[-1]), 0.0


def _number(key: str, text: str, unit: str, factor: float) -> float:
    """Return a place on the axis; a plain number is in the unit of the axis."""
    with within(f"{key} {text}"):
        return float(text) if units.is_plain(text) else factor * units.parse(text, unit)
