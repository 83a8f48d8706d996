"""Claims on the whole loom: its mechanisms keep out of each other's way."""

import math

import numpy as np
from numpy.typing import NDArray

from ... import units
from ...errors import LoomfmuError
from ...traces import Signals
from . import curves
from .verdict import LENGTH, ONE, SPEED, Verdict, verdict

NEVER = "the head is never in the shed"


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
    is twice the least distance of any frame, and 0 where its warp crosses the closed shed meanwhile.
    """
    limit = units.parse(head_height, "m")
    frames = healds or sorted({name.split(".")[0] for name in trace if name.startswith("heald_")})
    if not frames:
        raise LoomfmuError("rapier_in_open_shed: the run records no heald frame")
    claim = "the shed is open for the rapier head"
    travel = curves.Motion(trace, f"{weft}.travel")
    in_shed = travel.beyond(trace.parameter(f"{belt}.idle_travel"), 1.0)
    if not in_shed:
        signal = f"{frames[0]}.warp_height"
        return verdict(trace, claim, signal, False, limit, math.nan, LENGTH, math.nan, NEVER, travel.note)
    lifts = [curves.Motion(trace, f"{frame}.lift") for frame in frames]
    openings, notes = [], [travel.note, *(lift.note for lift in lifts)]
    for frame, lift in zip(frames, lifts, strict=True):
        stroke, ratio = trace.parameter(f"{frame}.stroke"), trace.parameter(f"{frame}.warp_ratio")
        nearest = lift.nearest(0.5 * stroke, in_shed)
        openings.append((2.0 * ratio * nearest.value, nearest.time, f"{frame}.warp_height"))
        notes.append(nearest.note)
    worst = float(np.min([opening for opening, _time, _name in openings]))  # NaN if there is one
    equal = [each for each in openings if not each[0] > worst + curves.SAME]
    _opening, time, signal = min(equal, key=lambda each: each[1])
    holds = worst >= limit and curves.COARSE_NOTE not in notes
    return verdict(trace, claim, signal, holds, limit, worst, LENGTH, time, *notes)


def reed_clear_of_rapier(
    trace: Signals, clearance: float | str, reed: str = "reed", weft: str = "weft", belt: str = "belt"
) -> Verdict:
    """While the rapier head is in the shed, the reed stays that far behind its front limit."""
    limit = units.parse(clearance, "m")
    claim, signal = "the reed is clear of the rapier", f"{reed}.position"
    travel, position = curves.Motion(trace, f"{weft}.travel"), curves.Motion(trace, signal)
    in_shed = travel.beyond(trace.parameter(f"{belt}.idle_travel"), 1.0)
    if not in_shed:
        return verdict(trace, claim, signal, False, limit, math.nan, LENGTH, math.nan, NEVER, travel.note)
    foremost = position.lowest(-1.0, in_shed)
    worst = float(trace[f"{reed}.front_limit"][-1]) - foremost.value
    holds = worst >= limit and not foremost.coarse
    notes = (travel.note, position.note, foremost.note)
    return verdict(trace, claim, signal, holds, limit, worst, LENGTH, foremost.time, *notes)


def locks_in_time(trace: Signals, lock: str = "lock") -> Verdict:
    """The pattern locks follow their law and let go within the time that they have.

    Both hold up to a speed of the shaft that the lock itself tells, so the shaft's highest speed is judged.
    """
    claim, limit = "the pattern locks are in time", float(trace[f"{lock}.speed_limit"][-1])
    in_time = np.asarray(trace[f"{lock}.in_time"], dtype=bool)
    speed = curves.Motion(trace, "shaft.velocity", rates=1) if "shaft.velocity" in trace else None
    if speed is None or not np.array_equal(np.abs(speed.values[0]) <= limit, in_time):
        return _at_samples(trace, claim, lock, in_time)
    fastest = min(speed.lowest(1.0), speed.lowest(-1.0), key=lambda found: -abs(found.value))
    highest = abs(fastest.value)
    holds = highest <= limit and not fastest.coarse
    notes = (speed.note, fastest.note)
    return verdict(trace, claim, "shaft.velocity", holds, limit, highest, SPEED, fastest.time, *notes)


def _at_samples(trace: Signals, claim: str, lock: str, in_time: NDArray[np.bool_]) -> Verdict:
    """The verdict on a lock that does not follow the main shaft: what it says at the samples."""
    margin = np.asarray(trace[f"{lock}.torque_margin"])
    late = np.flatnonzero(~in_time)
    place = int(late[0]) if len(late) else int(np.argmin(margin))
    note = f"{lock}.in_time is known at the samples only: the lock does not follow shaft.velocity"
    return verdict(
        trace, claim, f"{lock}.torque_margin", not len(late), 0.0, float(margin[place]), ONE,
        float(trace.time[place]), note,
    )  # fmt: skip
