"""The main shaft in a recorded run: its angle over time, and the times at which it passes an angle."""

import math

import numpy as np

from ...errors import LoomfmuError
from ...traces import Signals
from .arguments import TURN, Window
from .curves import SAME, Motion, Stretch, motion_of

# Between samples farther apart a window of risk may be lost whole. With 20 samples in a revolution the lowest
# margin of the published looms is known to 2e-3, with 16 to 5e-3, with 8 to 0.05, and with 6 not at all.
FARTHEST = TURN / 20.0
UNPASSED = "the run never passes through the whole window"
STANDS = 1e-9  # of a revolution: angles that are closer are one where a run begins or ends


def angle(trace: Signals) -> Motion | None:
    """The main shaft's angle, if the run has a shaft."""
    return motion_of(trace, "shaft.angle") if "shaft.angle" in trace else None


def too_coarse(turning: Motion) -> bool:
    """Return whether the shaft turns too far between two samples for them to show how a loom moves."""
    return turning.longest > FARTHEST * (1.0 + SAME)


def short(trace: Signals) -> str:
    """A note on a run in which the shaft turns less than a revolution; empty for others."""
    return _turns_less(trace, 1, "and the claim takes a whole one")


def unwoven(trace: Signals, picks: int) -> str:
    """Return a note on a run that is shorter than the repeat of a weave; an empty text for others.

    For a weave that repeats in each revolution, `short` says what a claim takes.
    """
    if picks == 1:
        return ""
    why = f"and the weave repeats after {picks}; set revolutions = {picks} or more"
    return _turns_less(trace, picks, why)


def _turns_less(trace: Signals, wanted: int, why: str) -> str:
    """Return a note on a run of less than so many revolutions of the shaft; an empty text for others."""
    turning = angle(trace)
    turned = math.inf if turning is None else float(np.ptp(turning.values[0])) / TURN
    if turned >= wanted - STANDS:
        return ""
    number = f"{turned:.4g}"
    return f"the shaft turns by only {number} revolution{'s' * (number != '1')}, {why}"


def place(turning: Motion, time: float) -> tuple[float, int]:
    """Return the shaft's angle in its revolution [rad], and the number of the revolution, from 1."""
    at, first, last = turning.at(time), float(turning.values[0][0]), float(turning.values[0][-1])
    way = -1.0 if last < first else 1.0
    revolution = math.floor(way * at / TURN) - math.floor(way * first / TURN) + 1
    return at - TURN * math.floor(at / TURN), revolution


def needed_angle(trace: Signals) -> Motion:
    """The main shaft's angle. Raises LoomfmuError where the run has none."""
    found = angle(trace)
    if found is None:
        raise LoomfmuError(f"{trace.name}: the claim needs shaft angles, but shaft.angle is not recorded")
    return found


def times_at(trace: Signals, wanted: float) -> list[float]:
    """All times at which the shaft stands at an angle of its revolution, each once.

    Where the run begins or ends there, to rounding, the shaft may pass the angle as well: that is one time.
    """
    turning = needed_angle(trace)
    times = np.array(turning.passes(wanted, TURN))
    for end in (0, -1):
        angle, time = float(turning.values[0][end]), float(turning.time[end])
        turned = (angle - wanted) / TURN
        if abs(turned - round(turned)) < STANDS:
            away = [np.abs(turning.along(each) - angle) for each in (times, 0.5 * (times + time))]
            times = np.append(times[np.maximum(*away) > 2.0 * STANDS * TURN], time)
    return sorted(set(times.tolist()))


def passes(trace: Signals, window: Window) -> list[Stretch]:
    """The passes of the shaft through a window of its revolution, without those that the run cuts off."""
    within = times_within(trace, window)
    edges = {each.start for each in within if each.start == each.end}
    return [each for each in within if each.start < each.end and {each.start, each.end} <= edges]


def unpassed(trace: Signals, window: Window) -> str:
    """A note on a run that shows a window of the revolution only in part; empty for others."""
    return "" if not short(trace) or passes(trace, window) else UNPASSED


def times_within(trace: Signals, window: Window) -> list[Stretch]:
    """Stretches of time in which the shaft is in a window of its revolution, the edges included."""
    start, width = window.start, window.width
    turning = needed_angle(trace)
    edges = times_at(trace, start)
    if width < TURN:
        edges = sorted({*edges, *times_at(trace, start + width)})
    marks = np.unique([turning.time[0], *edges, turning.time[-1]])
    away = (turning.along(0.5 * (marks[1:] + marks[:-1])) - start) % TURN
    inside = [
        Stretch(float(marks[place]), float(marks[place + 1])) for place in np.flatnonzero(away <= width)
    ]
    return sorted([*inside, *(Stretch(edge, edge) for edge in edges)])
