"""Claims on the whole loom: its mechanisms keep out of each other's way."""

import math

import numpy as np
from numpy.typing import NDArray

from .. import units
from ..errors import LoomfmuError
from ..traces import Signals
from . import curves
from .verdict import Verdict, verdict


def rapier_in_open_shed(
    trace: Signals,
    head_height: float | str,
    weft: str = "weft",
    belt: str = "belt",
    healds: list[str] | None = None,
) -> Verdict:
    """While the rapier head is in the shed, every warp sheet leaves it its height.

    The head is in the shed while its travel exceeds the idle travel. At the rapier's station each
    frame's warp must then be at least half the head's height above or below the closed shed; the worst
    is twice the least distance of any frame. Judged at every sample in the shed, and where the head enters
    and leaves it.
    """
    limit = units.parse(head_height, "m")
    frames = healds or sorted({name.split(".")[0] for name in trace if name.startswith("heald_")})
    if not frames:
        raise LoomfmuError("rapier_in_open_shed: the run records no heald frame")
    times, entries = _in_shed(trace, weft, belt)
    worst, moment, closest = math.inf, math.nan, frames[0]
    for frame in frames:
        stroke, ratio = trace.parameter(f"{frame}.stroke"), trace.parameter(f"{frame}.warp_ratio")
        lift = curves.Motion(trace, f"{frame}.lift")
        heights = np.abs(trace[f"{frame}.warp_height"][times])
        edges = [ratio * abs(lift.at(time) - 0.5 * stroke) for time in entries]
        moments = np.concatenate([trace.time[times], entries])
        openings = 2.0 * np.concatenate([heights, edges])
        if len(openings) and openings.min() < worst:
            place = int(np.argmin(openings))
            worst, moment, closest = float(openings[place]), float(moments[place]), frame
    note = "" if math.isfinite(worst) else "the head is never in the shed"
    holds = math.isfinite(worst) and worst >= limit
    shown = worst if math.isfinite(worst) else math.nan
    return verdict(
        trace, "the shed is open for the rapier head", f"{closest}.warp_height", holds, limit, shown, "mm",
        moment, note,
    )  # fmt: skip


def reed_clear_of_rapier(
    trace: Signals, clearance: float | str, reed: str = "reed", weft: str = "weft", belt: str = "belt"
) -> Verdict:
    """While the rapier head is in the shed, the reed stays that far behind its front limit."""
    limit = units.parse(clearance, "m")
    times, entries = _in_shed(trace, weft, belt)
    position = curves.Motion(trace, f"{reed}.position")
    front = float(np.max(position.values[0]))
    moments = np.concatenate([trace.time[times], entries])
    distances = front - np.concatenate(
        [position.values[0][times], np.array([position.at(time) for time in entries])]
    )
    if not len(distances):
        return verdict(
            trace, "the reed is clear of the rapier", f"{reed}.position", False, limit, math.nan, "mm",
            math.nan, "the head is never in the shed",
        )  # fmt: skip
    place = int(np.argmin(distances))
    worst = float(distances[place])
    return verdict(
        trace, "the reed is clear of the rapier", f"{reed}.position", worst >= limit, limit, worst, "mm",
        float(moments[place]),
    )  # fmt: skip


def locks_in_time(trace: Signals, lock: str = "lock") -> Verdict:
    """The pattern locks follow their law and let go within the time that they have, at every sample."""
    in_time = np.asarray(trace[f"{lock}.in_time"], dtype=bool)
    margin = np.asarray(trace[f"{lock}.torque_margin"])
    late = np.flatnonzero(~in_time)
    place = int(late[0]) if len(late) else int(np.argmin(margin))
    return verdict(
        trace, "the pattern locks are in time", f"{lock}.torque_margin", not len(late), 0.0,
        float(margin[place]), "1", float(trace.time[place]),
    )  # fmt: skip


def _in_shed(trace: Signals, weft: str, belt: str) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Samples at which the head is in the shed, and the times at which it enters or leaves it."""
    edge = trace.parameter(f"{belt}.idle_travel")
    travel = curves.Motion(trace, f"{weft}.travel")
    return np.flatnonzero(travel.values[0] > edge), np.array(travel.crossings(edge))
