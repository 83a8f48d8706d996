"""Claims on heald frames: how long they dwell and leave the shed clear, by the angle that the shaft turns."""

import math

import numpy as np

from ... import units
from ...errors import LoomfmuError
from ...traces import Signals
from . import curves
from .verdict import ANGLE, PERCENT, Verdict, verdict

TOLERANCE = 0.015  # of the stroke: within it a frame dwells, if nothing else is said


def dwell(trace: Signals, heald: str, at_least: float | str, tolerance: float | str = TOLERANCE) -> Verdict:
    """Every dwell of a frame, within a share of its stroke from an end, lasts that shaft angle.

    Judged by the dwells that begin and end within the run, and by those that the run's ends cut off as far
    as they last that long nevertheless.
    """
    share = units.parse(tolerance, "1")
    distance = share * trace.parameter(f"{heald}.stroke")
    claim = f"dwell within {100 * share:g} % of the stroke"
    return _shortest(trace, claim, f"{heald}.lift", heald, distance, at_least)


def clear_shed(trace: Signals, heald: str, clearance: float | str, at_least: float | str) -> Verdict:
    """Every time that a frame's warp is beyond a height, either way, lasts that shaft angle; see `dwell`."""
    height = units.parse(clearance, "m")
    stroke = trace.parameter(f"{heald}.stroke")
    ratio = trace.parameter(f"{heald}.warp_ratio")
    if not 0.0 < height < 0.5 * stroke * ratio:
        raise LoomfmuError(
            f"clear_shed of {heald}: clearance = {1e3 * height:.7g} mm is outside"
            f" (0, {500 * stroke * ratio:.7g}) mm, the warp's way to either side"
        )
    claim = f"warp beyond {1e3 * height:g} mm"
    return _shortest(trace, claim, f"{heald}.warp_height", heald, 0.5 * stroke - height / ratio, at_least)


def dwell_contains(
    trace: Signals, heald: str, angles: list[float | str], tolerance: float | str = TOLERANCE
) -> Verdict:
    """At these shaft angles of every revolution the frame is within a share of its stroke from an end."""
    limit = units.parse(tolerance, "1")
    stroke = trace.parameter(f"{heald}.stroke")
    lift = curves.Motion(trace, f"{heald}.lift")
    times = [time for angle in angles for time in curves.times_at(trace, units.parse(angle, "rad"))]
    shown = ", ".join(units.show(units.parse(angle, "rad"), "deg") for angle in angles)
    claim, signal = f"dwell at {shown}", f"{heald}.lift"
    if not times:
        reason = "the run never reaches these angles"
        return verdict(trace, claim, signal, False, limit, math.nan, PERCENT, math.nan, reason)
    moments = np.array(times)
    lifts = lift.along(moments)
    away = np.minimum(np.abs(lifts), np.abs(stroke - lifts)) / stroke
    lowest, time = curves.first_lowest(-away, moments)
    return verdict(trace, claim, signal, -lowest <= limit, limit, -lowest, PERCENT, time, lift.note)


def _shortest(
    trace: Signals, claim: str, signal: str, heald: str, distance: float, at_least: float | str
) -> Verdict:
    """The shortest time that a frame stays within a distance from an end of its stroke, as a shaft angle."""
    limit = units.parse(at_least, "rad")
    lift = curves.Motion(trace, f"{heald}.lift")
    shaft = curves.needed_shaft(trace)
    stroke = trace.parameter(f"{heald}.stroke")
    spans = curves.spans_within(lift, distance, stroke)
    turned = [abs(shaft.at(span.end) - shaft.at(span.start)) for span in spans]
    judged = [(turn, span.start) for turn, span in zip(turned, spans, strict=True) if span.whole]
    note = ""
    if not judged:
        judged, note = _cut_off(spans, turned, limit, _repeats(lift, stroke, shaft), lift.time)
    if not judged:
        return verdict(trace, claim, signal, False, limit, math.nan, ANGLE, math.nan, note, lift.note)
    worst, time = curves.first_lowest([turn for turn, _ in judged], [start for _, start in judged])
    return verdict(trace, claim, signal, worst >= limit, limit, worst, ANGLE, time, note, lift.note)


def _cut_off(
    spans: list[curves.Stretch], turned: list[float], limit: float, repeats: bool, time: curves.Floats
) -> tuple[list[tuple[float, float]], str]:
    """What spans that the run's ends cut off tell: lengths and starts to be judged, and a note.

    Cut off, a span lasts at least as long as it is seen. Where the motion repeats, the piece at the run's end
    goes on like the one at its start, so both make up one span; whole turns of holding are left out.
    """
    if not spans:
        return [], "the frame is never there in the run"
    if len(spans) == 1 and (spans[0].start, spans[0].end) == (time[0], time[-1]):
        if turned[0] < limit:
            return [], "the frame is there throughout, but the run is shorter than that"
        return [(turned[0], spans[0].start)], "the frame is there throughout the run"
    enough = [(turn, span.start) for turn, span in zip(turned, spans, strict=True) if turn >= limit]
    if len(enough) == len(spans):
        return enough, "cut off by an end of the run: it lasts at least that long"
    joined = math.fmod(sum(turned), curves.TURN)
    held = joined < sum(turned)
    if len(spans) == 2 and repeats and (joined >= limit or not held):
        note = "its pieces at the run's end and start taken together"
        return [(joined, spans[1].start)], f"{note}: it lasts at least that long" if held else note
    if enough:
        return enough, "the other one is cut off by an end of the run, and not judged"
    return [], "none begins and ends within the run"


def _repeats(lift: curves.Motion, stroke: float, shaft: curves.Motion) -> bool:
    """Whether the run is whole revolutions, and the frame ends as far from an end as it began."""
    turns = abs(float(shaft.values[0][-1] - shaft.values[0][0])) / curves.TURN
    first, last = (min(abs(lift.values[0][end]), abs(stroke - lift.values[0][end])) for end in (0, -1))
    return round(turns) > 0 and abs(turns - round(turns)) < 1e-9 and abs(last - first) <= 1e-9 * stroke
