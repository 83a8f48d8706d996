"""Extremes that a component finds on its continuous curve, and holds: what they say between the samples."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ...traces import Signals
from .curves import SAME, Floats, Stretch, motion_of
from .extremes import Extreme, gap_beyond

ALIKE = 1e-8  # of the largest value: latched extremes that coarse steps alone tell apart; names places only


class _Held(NamedTuple):
    """The samples of a stretch of time, and the extremes so far that are held about it.

    They are those at the samples before it, at its first and at its last one, and after it.
    """

    last: int
    before: float
    first: float
    inside: float
    after: float


def latched(
    trace: Signals, signal: str, sign: float, found: Extreme, within: Sequence[Stretch] | None
) -> tuple[Extreme, str]:
    """The lowest value of `sign` times a signal, and a note: as its component holds it, or as `found`.

    What is held changes where the signal is more extreme than ever before.
    """
    latch = _latch(trace, signal, sign)
    if latch:
        lowest = [each for each in _held(trace, latch, sign, within) if each.inside < each.first]
        best = min(lowest, key=lambda each: each.inside, default=None)
        sampled, known = sign * found.value, not motion_of(trace, signal).note
        if best and (best.inside < sampled or (best.inside == sampled and not known)):
            value, time = sign * best.inside, reached(trace, latch, sign * trace[signal], best.last)
            return Extreme(value, time, sure=value), f"between the samples by {latch}"
    return found, motion_of(trace, signal).note


def beyond_found(
    trace: Signals, signal: str, sign: float, found: Extreme, within: Sequence[Stretch] | None
) -> float:
    """How far the lowest value of `sign` times a signal may be below the one found.

    Where an extreme is held it is not below that, and may be there if that changes at an edge of a stretch.
    """
    latch, worst = _latch(trace, signal, sign), sign * found.value
    gap = gap_beyond(motion_of(trace, signal), sign, found, within)
    if not latch:
        return gap
    beyond = []
    for each in _held(trace, latch, sign, within):
        changes = each.first < each.before or each.after < each.inside
        beyond.append(worst - (each.after if changes else max(each.after, worst - gap)))
    return max(0.0, *beyond) if beyond else gap


def _latch(trace: Signals, signal: str, sign: float) -> str | None:
    """What holds the extreme of a signal whose rate is unknown: samples that only rise may pass it, too."""
    motion = motion_of(trace, signal)
    return trace.held(signal, sign) if len(motion.values) == 1 or motion.note else None


def _held(trace: Signals, latch: str, sign: float, within: Sequence[Stretch] | None) -> Iterator[_Held]:
    """What a latch holds about each of some stretches of time, or in the whole run."""
    time, held = trace.time, sign * trace[latch]
    near, end = SAME * float(time[-1] - time[0]), len(time) - 1
    for start, stop, _ in [Stretch(float(time[0]), float(time[-1]))] if within is None else within:
        first, last = time.searchsorted(start - near), time.searchsorted(stop + near, "right") - 1
        before, after = time.searchsorted(start + near, "right") - 1, time.searchsorted(stop - near)
        places = (min(max(int(place), 0), end) for place in (before, first, last, after))
        if start < stop or within is None:
            yield _Held(int(last), *(float(held[place]) for place in places))


def reached(trace: Signals, latch: str, followed: Floats, last: int = -1) -> float:
    """When the extreme that is held at the end, or at the `last` sample that counts, was reached.

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
