"""The lowest and highest values of motions between their samples, and how sure they are."""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from . import bernstein
from .curves import BLOCK, ROUNDING, SAME, Doubt, Floats, Integers, Motion, Stretch, Survey

COARSE = 0.2  # of a signal's range beyond its samples: fewer than four samples in an oscillation
COARSE_NOTE = Doubt("the samples are too far apart to be sure; take more steps")


class Extreme(NamedTuple):
    """Lowest or highest value, its time, and whether the samples are too far apart to be sure of it.

    The motion certainly reaches `sure`, and nowhere goes beyond `possible`: the curve between the samples may
    be off by `Motion.doubt`. A sample is sure. Of a motion that is known only at the samples, `possible` is
    infinite.
    """

    value: float
    time: float
    coarse: bool = False
    sure: float = math.nan
    possible: float = math.nan

    @property
    def note(self) -> str:
        """The note of a verdict on it."""
        return COARSE_NOTE if self.coarse else ""


def lowest(motion: Motion, sign: float = 1.0, within: Sequence[Stretch] | None = None) -> Extreme:
    """Return the lowest point of `sign` times the motion, in the whole run or in some stretches of time."""
    if not motion.finite:
        return lowest_sample(motion, sign, within)
    survey = motion.survey if sign > 0.0 else motion.survey.reversed
    if within is None and len(motion.values) == 1:  # straight lines are lowest at a sample
        values = sign * motion.values[0]
        value = sure = float(np.min(values))
        time = float(motion.time[int(np.argmax(values <= value + SAME * survey.largest))])
        possible = value if motion.samples_hold else -math.inf
    elif found := _lowest_of_pieces(motion, sign, within, survey):
        value, time, sure, possible = found
    else:
        return Extreme(math.nan, math.nan)
    beyond = min(sign * float(motion.values[0][end]) for end in _ends(motion, time)) - value
    coarse = beyond > max(COARSE * (survey.highest - value), SAME * survey.largest)
    rounding = ROUNDING * survey.largest
    return Extreme(sign * value, time, coarse, sign * (sure + rounding), sign * (possible + rounding))


def _lowest_of_pieces(
    motion: Motion, sign: float, within: Sequence[Stretch] | None, survey: Survey
) -> tuple[float, float, float, float] | None:
    """The same as value, time, what is sure and what is possible; None where there is nothing within."""
    values, same = sign * motion.values[0], SAME * survey.largest
    if within is None:
        found, times = [values[:1]], [motion.time[:1]]
        best = sure = survey.lowest
        pieces = _pieces_below(motion, sign, best + same)
    else:
        edges = np.array([time for each in within for time in each[:2]])
        found, times = [sign * motion.along(edges)], [edges]
        best = float(np.min(found[0], initial=math.inf))
        sure = float(np.min(values[inside(motion.time, within)], initial=math.inf))
        pieces = _pieces(motion, within)
    possible = best
    for intervals, low, high in pieces:
        curves, doubt = sign * motion.points(intervals), motion.doubts[intervals]
        points = bernstein.clipped(curves, low, high)
        best = min(best, float(np.min(points[[0, -1]])))
        near = points.min(axis=0) <= max(best + same, sure) + doubt
        intervals, low, high = intervals[near], low[near], high[near]
        least, share = bernstein.lowest(points[:, near])
        share = np.where(share < 1.0, low + share * (high - low), high)
        before, after = motion.time[intervals], motion.time[intervals + 1]
        if len(motion.values) > 1:
            over, under = (
                _least(bernstein.clipped(bernstein.raised(curves[:, near], way * doubt[near]), low, high))
                for way in (1.0, -1.0)
            )
            sure, possible = min(sure, over), min(possible, under)
        else:  # part of an interval may reach either of its ends, or anything if they are not its extremes
            possible = min(possible, _least(np.minimum(values[intervals], values[intervals + 1])[np.newaxis]))
            possible = possible if motion.samples_hold else -math.inf
        found.append(least)
        times.append(np.where(share < 1.0, before + share * (after - before), after))
    extremes = np.concatenate(found)
    if not len(extremes):
        return None
    value, time = _first_lowest(extremes, np.concatenate(times), same)
    return value, time, sure, min(possible, value)


def _least(points: Floats) -> float:
    """Lowest value of some pieces."""
    return float(np.min(bernstein.lowest(points)[0], initial=math.inf))


def lowest_sample(motion: Motion, sign: float, within: Sequence[Stretch] | None) -> Extreme:
    """The sample at which `sign` times the motion is lowest, NaN where there is none within."""
    there = inside(motion.time, within)
    if not there.any():
        return Extreme(math.nan, math.nan)
    value, time = _first_lowest(sign * motion.values[0][there], motion.time[there])
    return Extreme(sign * value, time, sure=sign * value, possible=-sign * math.inf)


def inside(time: Floats, within: Sequence[Stretch] | None) -> NDArray[np.bool_]:
    """Return which samples lie in some stretches of time, or in the whole run."""
    if within is None:
        return np.ones(len(time), dtype=bool)
    starts, ends = (np.array([each[end] for each in within]) for end in (0, 1))
    return np.asarray(np.searchsorted(starts, time, "right") > np.searchsorted(ends, time, "left"))


def _ends(motion: Motion, time: float) -> list[int]:
    """The samples on both sides of a time."""
    if len(motion.time) == 1:
        return [0]
    interval = motion.interval_of(time)
    return [interval, interval + 1]


def _pieces_below(motion: Motion, sign: float, level: float) -> Iterator[tuple[Integers, Floats, Floats]]:
    """Whole intervals on which `sign` times the motion may be as low as a level, block by block."""
    lowest, highest = motion.reach
    pieces = np.flatnonzero((lowest if sign > 0.0 else -highest) <= level + motion.doubts)
    for begin in range(0, len(pieces), BLOCK):
        some = pieces[begin : begin + BLOCK]
        yield some, np.zeros(len(some)), np.ones(len(some))


def _pieces(motion: Motion, within: Sequence[Stretch]) -> Iterator[tuple[Integers, Floats, Floats]]:
    """Intervals in some stretches of time, and the shares of each that lie within, block by block."""
    starts, ends = (np.array([each[end] for each in within]) for end in (0, 1))
    cuts = np.unique(np.concatenate([motion.time, starts, ends]))
    middles = 0.5 * (cuts[1:] + cuts[:-1])
    inside = np.searchsorted(starts, middles, "right") > np.searchsorted(ends, middles, "left")
    pieces = np.flatnonzero(inside)
    for begin in range(0, len(pieces), BLOCK):
        some = pieces[begin : begin + BLOCK]
        intervals = motion.interval(cuts[some])
        start, h = motion.time[intervals], motion.length(intervals)
        yield intervals, (cuts[some] - start) / h, (cuts[some + 1] - start) / h


def nearest(motion: Motion, level: float, within: Sequence[Stretch]) -> Extreme:
    """Return the least distance of the motion from a level in some stretches of time, 0 if it passes it."""
    if not motion.finite:
        return Extreme(math.nan, math.nan)
    for time in motion.crossings(level):
        if any(each.start <= time <= each.end for each in within):
            return Extreme(0.0, time)
    above = motion.along(np.array([0.5 * (each.start + each.end) for each in within])) >= level
    found = []
    for sign in (1.0, -1.0):
        side = [each for each, over in zip(within, above, strict=True) if over == (sign > 0.0)]
        if side:
            extreme = lowest(motion, sign, side)
            found.append(Extreme(sign * (extreme.value - level), extreme.time, extreme.coarse))
    value, time = first_lowest([each.value for each in found], [each.time for each in found])
    return Extreme(value, time, any(each.coarse for each in found))


def first_lowest(values: Sequence[float], times: Sequence[float], same: float = SAME) -> tuple[float, float]:
    """The lowest of a few values, NaN if there is one, and the time of the first one that is equal to it."""
    if unknown := [time for value, time in zip(values, times, strict=True) if math.isnan(value)]:
        return math.nan, min(unknown)
    lowest = min(values)
    return lowest, min(time for value, time in zip(values, times, strict=True) if value <= lowest + same)


def _first_lowest(values: Floats, times: Floats, same: float = SAME) -> tuple[float, float]:
    """The same of many."""
    lowest = float(np.min(values))  # NaN if there is one
    equal = np.isnan(values) if math.isnan(lowest) else values <= lowest + same
    return lowest, float(np.min(times[equal]))
