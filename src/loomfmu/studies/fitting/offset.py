"""An offset of the places at which data were measured, as a parameter of a fit."""

import math
from functools import partial

from ... import units
from ...errors import LoomfmuError, shown
from ...sweeps.varied import Varied
from ..span import Span
from .measured import ALONG, Measured

DISPLAY = {"shaft_angle": "deg", "time": "ms"}
USUAL = {"shaft_angle": "-2deg..2deg", "time": "-2ms..2ms"}


def offset_of(data: Measured, text: str) -> Span:
    """Return the offset of all places, within a range such as "-2ms..2ms". Raises LoomfmuError."""
    first, last = units.ends_of(text) if isinstance(text, str) else ("", "")
    if not (first and last):
        raise LoomfmuError(f"offset = {shown(text)} is not a range such as {USUAL[data.over]}")
    unit, display = ALONG[data.over], DISPLAY[data.over]
    read = partial(_read, unit=unit, over=data.over)
    varied = Varied("offset", (), "Real", unit, display, "Added to the places of the data", read)
    span = Span(varied, read(first), read(last), 0.0, "given")
    if not span.low < span.high:
        raise LoomfmuError(f"offset: the range from {span.show(span.low)} to {span.show(span.high)} is empty")
    return span


def _read(given: str, unit: str, over: str) -> float:
    try:
        value = units.parse(given, unit)
    except units.UnitError as error:
        raise LoomfmuError(f"offset: {error}; the data are over {over}") from None
    if not math.isfinite(value):
        raise LoomfmuError(f"offset = {shown(given)} is not finite")
    if units.is_plain(given) and value:
        raise LoomfmuError(f"offset = {shown(given)} has no unit; write a range such as {USUAL[over]}")
    return value
