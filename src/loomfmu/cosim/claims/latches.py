"""Extremes that a component finds on its continuous curve, and holds: what they say between the samples."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ...traces import Signals
from .curves import SAME, Floats, Stretch, motion_of
from .extremes import Extreme

ALIKE = 1e-8  # of the largest value: latched extremes that coarse steps alone tell apart; names places only


class _Held(NamedTuple):
    """The samples of a stretch of time, and the extremes so far that are held about it.

    They are those at its first and at its last sample, and after it.
    """

    last: int
    first: float
    inside: float
    after: float


def latched(
    trace: Signals, signal: str, sign: float, found: Extreme, within: Sequence[Stretch] | None
) -> tuple[Extreme, str]:
    """The lowest value of `sign` times a signal, and a note: as its component holds it, or as `found`.

    The held value changes where the signal is more extreme than ever before, and nowhere is the signal more
    extreme than that.
    """
    motion, latch = motion_of(trace, signal), trace.held(signal, sign)
    if motion.known or not latch:
        return found, motion.note
    held = list(_held(trace, latch, sign, within))
    possible = sign * min((each.after for each in held), default=sign * found.possible)
    lower = [each for each in held if each.inside < each.first]
    best = min(lower, key=lambda each: each.inside, default=None)
    if best is None or best.inside > sign * found.value:
        return found._replace(possible=possible), ""
    value, time = sign * best.inside, reached(trace, latch, sign * trace[signal], best.last)
    return Extreme(value, time, sure=value, possible=possible), f"between the samples by {latch}"


def _held(trace: Signals, latch: str, sign: float, within: Sequence[Stretch] | None) -> Iterator[_Held]:
    """Yield the extremes that a latch holds in some stretches of time, or in the whole run."""
    time, held = trace.time, sign * trace[latch]
    near, end = SAME * float(time[-1] - time[0]), len(time) - 1
    for start, stop, _ in [Stretch(float(time[0]), float(time[-1]))] if within is None else within:
        first, last = time.searchsorted(start - near), time.searchsorted(stop + near, "right") - 1
        after = time.searchsorted(stop - near)
        places = (min(max(int(place), 0), end) for place in (first, last, after))
        if start < stop or within is None:
            yield _Held(int(last), *(float(held[place]) for place in places))


def reached(trace: Signals, latch: str, followed: Floats, last: int = -1) -> float:
    """Return the time of the extreme that is held at the end, or at the `last` sample that counts.

    It is known as well as the samples show it.

    The latch gives the step. Within it, the time is the vertex of the parabola through the lowest samples of
    what the latch follows.

    Args:
        latch: the signal that keeps the extreme
        followed: samples of what it follows, with a sign by which the extreme is the lowest
    """
    time, latched = trace.time, trace[latch]
    largest = max(float(followed.max()), -float(followed.min()))
    step = int(np.argmax(np.abs(latched - latched[last]) <= ALIKE * largest))
    if step == 0:
        return float(time[0])
    lowest = step if followed[step] <= followed[step - 1] else step - 1
    if not 0 < lowest < len(time) - 1:
        return float(time[lowest])
    (t0, t1, t2), (y0, y1, y2) = (each[lowest - 1 : lowest + 2].tolist() for each in (time, followed))
    before, after = (y1 - y0) / (t1 - t0), (y2 - y1) / (t2 - t1)
    if after <= before:
        return float(t1)
    turn = 0.5 * (t0 + t1) - 0.5 * before * (t2 - t0) / (after - before)
    return float(min(max(turn, time[step - 1]), time[step]))
