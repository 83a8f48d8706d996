"""Recorded signals between their samples."""

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...traces import Signals
from . import bernstein
from .compiled import compiled

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
BLOCK = 1 << 16  # intervals that are searched together
SAME = 1e-11  # of the largest value: extremes that close are equal, and the first one is named
COARSE = 0.2  # of a signal's range beyond its samples: fewer than four samples in an oscillation
DOUBT = 0.1  # of the difference between second rates over an interval, see `Motion.doubt`
ROUNDING = 1e-12  # of the largest value: what rounding may add
COARSE_NOTE = "the samples are too far apart to be sure: take more steps"


class Stretch(NamedTuple):
    """A stretch of time, and whether it begins and ends within the run."""

    start: float
    end: float
    whole: bool = True


class Extreme(NamedTuple):
    """Lowest or highest value, its time, and whether the samples are too far apart to be sure of it.

    `sure` is what the motion reaches in any case: less extreme by what the curve between the samples may be
    off (see `Motion.doubt`), but not less than a sample.
    """

    value: float
    time: float
    coarse: bool = False
    sure: float = math.nan

    @property
    def note(self) -> str:
        """What a verdict says about it."""
        return COARSE_NOTE if self.coarse else ""


class Survey(NamedTuple):
    """What the samples of a motion show: whether all are `finite`, whether their values go one way alone.

    `longest` is the longest step from one value to the next; the others are NaN if a value is.
    """

    finite: float
    steady: float
    lowest: float
    highest: float
    longest: float

    @property
    def largest(self) -> float:
        """The largest magnitude."""
        return max(abs(self.lowest), abs(self.highest))

    @property
    def reversed(self) -> "Survey":
        """That of the same values with the other sign."""
        return self._replace(lowest=-self.highest, highest=-self.lowest)


def motion_of(trace: Signals, signal: str, rates: int = 2) -> "Motion":
    """A signal between its samples, the same for several claims where the trace keeps it."""
    kept, key = trace.shared, (signal, rates)
    if key not in kept:
        kept[key] = Motion(trace, signal, rates)
    found: Motion = kept[key]
    return found


class Motion:
    """A signal between its samples: on each interval the polynomial that it and its recorded rates give."""

    def __init__(self, trace: Signals, signal: str, rates: int = 2):
        self.signal = signal
        names: list[str] = []
        name: str | None = signal
        while name is not None and len(names) <= rates:
            names.append(name)
            name = trace.rate(name)
        columns = trace.columns(names)
        self.time, *self.values = (column.values for column in columns)
        self._compiled = compiled(columns)

    @cached_property
    def survey(self) -> Survey:
        """What the samples show."""
        if self._compiled:
            return Survey(*self._compiled.survey())
        finite = all(bool(np.isfinite(values).all()) for values in self.values)
        values = self.values[0]
        with np.errstate(invalid="ignore"):
            steps = np.diff(values)
        steady = bool(np.all(steps <= 0.0) or np.all(steps >= 0.0))
        longest = float(np.fmax.reduce(np.abs(steps), initial=0.0))
        return Survey(finite, steady, float(np.min(values)), float(np.max(values)), longest)

    @property
    def finite(self) -> bool:
        """Whether all values and rates are finite."""
        return bool(self.survey.finite)

    @property
    def longest(self) -> float:
        """How far the samples are apart at most."""
        return self.survey.longest

    @property
    def note(self) -> str:
        """What a verdict says if the values between the samples are not known."""
        if not self.finite:
            return f"{self.signal} or its rate is not finite everywhere"
        if len(self.values) > 1 or self.survey.steady:
            return ""
        return f"{self.signal} is known only at the samples: its rate is not recorded"

    def points(self, intervals: Integers) -> Floats:
        """Bernstein points of the polynomials on some intervals."""
        return self._points(intervals, intervals + 1)

    def _points(self, before: Integers | slice, after: Integers | slice) -> Floats:
        """The same for samples before and after each."""
        h = self.time[after] - self.time[before]
        ends = [(self.values[0][before], self.values[0][after])]
        for values, factor in zip(self.values[1:], (h, h * h), strict=False):
            ends.append((values[before] * factor, values[after] * factor))
        return np.stack(bernstein.joining(ends))

    def _piece(self, interval: int) -> list[float]:
        """Bernstein points of the polynomial on one interval: those of `points`, to the last bit."""
        h = float(self.time[interval + 1] - self.time[interval])
        factors = (1.0, h, h * h)
        return bernstein.joining(
            [
                (float(values[interval]) * factor, float(values[interval + 1]) * factor)
                for values, factor in zip(self.values, factors, strict=False)
            ]
        )

    def doubt(self, intervals: Integers) -> Floats:
        """How far the polynomials on some intervals may be off.

        Values and rates give a cubic. Its second rates at the ends of an interval are compared with the
        recorded ones, or with those that the rates of the neighbouring samples give. A quintic with these is
        away from the cubic by up to 1/29 of the difference; 1/10 covers also a jump of the second rate within
        the interval. On a smooth motion the cubic is off by a tenth of that, the quintic by far less.
        """
        if len(self.values) == 1:
            return np.zeros(len(intervals))
        h, ends = self._length(intervals), (intervals, intervals + 1)
        y0, y1 = (self.values[0][end] for end in ends)
        v0, v1 = (self.values[1][end] * h for end in ends)
        a0, a1 = (self._bends[end] * h**2 for end in ends)
        before = np.abs(a0 - (6.0 * (y1 - y0) - 4.0 * v0 - 2.0 * v1))
        after = np.abs(a1 - (2.0 * v0 + 4.0 * v1 - 6.0 * (y1 - y0)))
        return DOUBT * np.maximum(before, after)

    def doubt_at(self, time: float) -> float:
        """How far the motion may be off about a time, rounding included."""
        rounding = ROUNDING * self.survey.largest
        if len(self.time) == 1:
            return rounding
        return rounding + float(self.doubt(self.interval(np.array([time])))[0])

    def gap_at(self, time: float) -> float:
        """How far a motion that is known only at the samples may go on beyond one of them.

        A parabola through three samples has its vertex beyond the middle one by up to an eighth of their
        second difference, the corner of two straight lines by up to a half.
        """
        if not self.finite or not self.note or len(self.time) < 3:
            return 0.0
        place = min(max(int(self.time.searchsorted(time)), 1), len(self.time) - 2)
        before, here, after = self.values[0][place - 1 : place + 2].tolist()
        return 0.5 * float(abs(before - 2.0 * here + after))

    @cached_property
    def _bends(self) -> Floats:
        """Second rates at the samples."""
        if len(self.values) > 2:
            return self.values[2]
        return np.asarray(np.gradient(self.values[1], self.time, edge_order=2 if len(self.time) > 2 else 1))

    def _length(self, intervals: Integers) -> Floats:
        return np.asarray(self.time[intervals + 1] - self.time[intervals])

    def interval(self, times: Floats) -> Integers:
        """The intervals that some times lie in."""
        found = np.searchsorted(self.time, times, side="right") - 1
        return np.asarray(np.maximum(np.minimum(found, len(self.time) - 2), 0))

    def _interval(self, time: float) -> int:
        """The same of one time."""
        return min(max(int(self.time.searchsorted(time, "right")) - 1, 0), len(self.time) - 2)

    def along(self, times: Floats) -> Floats:
        """Values at some times."""
        if len(self.time) == 1:
            return np.full(len(times), self.values[0][0])
        intervals = self.interval(times)
        return bernstein.value(
            self.points(intervals), (times - self.time[intervals]) / self._length(intervals)
        )

    def at(self, time: float) -> float:
        """Value at a time."""
        if len(self.time) == 1:
            return float(self.values[0][0])
        if self._compiled:
            return self._compiled.at(time)
        interval = self._interval(time)
        before, after = float(self.time[interval]), float(self.time[interval + 1])
        return bernstein.value_of_piece(self._piece(interval), (time - before) / (after - before))

    @cached_property
    def _reach(self) -> tuple[Floats, Floats]:
        """Lowest and highest of the points of each interval: the motion stays between them."""
        if self._compiled:
            return self._compiled.reach
        parts = [(np.empty(0), np.empty(0))]
        for begin in range(0, len(self.time) - 1, BLOCK):
            end = min(begin + BLOCK, len(self.time) - 1)
            points = self._points(slice(begin, end), slice(begin + 1, end + 1))
            parts.append((points.min(axis=0), points.max(axis=0)))
        lowest, highest = (np.concatenate(each) for each in zip(*parts, strict=True))
        return lowest, highest

    def crossings(self, level: float) -> list[float]:
        """Times at which the motion passes a level, to rounding."""
        if self._compiled:
            return self._compiled.crossings(level)
        lowest, highest = self._reach
        passed = np.flatnonzero((lowest - level < 0.0) & (highest - level >= 0.0))
        return [time for interval in passed.tolist() for time in self._crossed(interval, level)]

    def _crossed(self, interval: int, level: float) -> list[float]:
        """Those in one interval."""
        shares = bernstein.sign_changes([point - level for point in self._piece(interval)])
        return [self.moment(interval, share) for share in shares]

    def passes(self, level: float, turn: float) -> list[float]:
        """Times at which the motion passes a level or one that is whole turns from it.

        To rounding a sample itself may be such a level.
        """
        if self._compiled:
            return self._compiled.passes(level, turn)
        whole = np.floor((self.values[0] - level) / turn)
        found = []
        known = np.isfinite(whole[1:]) & np.isfinite(whole[:-1])
        for interval in np.flatnonzero(known & (whole[1:] != whole[:-1])).tolist():
            low, high = sorted((int(whole[interval]), int(whole[interval + 1])))
            for there in (level + turn * turns for turns in range(low + 1, high + 1)):
                before, after = (abs(end - there) for end in self.values[0][interval : interval + 2].tolist())
                nearest = self.moment(interval, float(after < before))
                found += self._crossed(interval, there) or [nearest]
        return found

    def moment(self, interval: int, share: float) -> float:
        """The time at a share of an interval."""
        return float(self.time[interval] + share * (self.time[interval + 1] - self.time[interval]))

    def beyond(self, level: float, sign: float) -> list[Stretch]:
        """Stretches of time above a level, or with a negative sign below it; none if it is not finite."""
        if not self.finite:
            return []
        inside = bool(self.values[0][0] >= level) == (sign > 0.0)
        begin, whole = float(self.time[0]), False
        stretches = []
        for time in self.crossings(level):
            if inside:
                stretches.append(Stretch(begin, time, whole))
            inside, begin, whole = not inside, time, True
        if inside:
            stretches.append(Stretch(begin, float(self.time[-1]), False))
        return stretches

    def lowest(self, sign: float = 1.0, within: Sequence[Stretch] | None = None) -> Extreme:
        """Where `sign` times the motion is lowest, in the whole run or in some stretches of time."""
        if not self.finite:
            return self._lowest_sample(sign, within)
        survey = self.survey if sign > 0.0 else self.survey.reversed
        if within is None and len(self.values) == 1:  # straight lines are lowest at a sample
            values = sign * self.values[0]
            value = sure = float(np.min(values))
            time = float(self.time[int(np.argmax(values <= value + SAME * survey.largest))])
        elif found := self._lowest_of_pieces(sign, within, survey):
            value, time, sure = found
        else:
            return Extreme(math.nan, math.nan)
        beyond = min(sign * float(self.values[0][end]) for end in self._ends(time)) - value
        coarse = beyond > max(COARSE * (survey.highest - value), SAME * survey.largest)
        return Extreme(sign * value, time, coarse, sign * (sure + ROUNDING * survey.largest))

    def _lowest_of_pieces(
        self, sign: float, within: Sequence[Stretch] | None, survey: Survey
    ) -> tuple[float, float, float] | None:
        """The same as value, time, and what is sure but for rounding; None where there is nothing within."""
        values, same = sign * self.values[0], SAME * survey.largest
        if within is None:
            found, times = [values[:1]], [self.time[:1]]
            best = sure = survey.lowest
            pieces = self._pieces_below(sign, best + same)
        else:
            edges = np.array([time for each in within for time in each[:2]])
            found, times = [sign * self.along(edges)], [edges]
            best = float(np.min(found[0], initial=math.inf))
            sure = float(np.min(values[self._inside(within)], initial=math.inf))
            pieces = self._pieces(within)
        for intervals, low, high in pieces:
            points = bernstein.clipped(sign * self.points(intervals), low, high)
            best = min(best, float(np.min(points[[0, -1]])))
            near = points.min(axis=0) <= max(best + same, sure)
            lowest, share = bernstein.lowest(points[:, near])
            sure = min(sure, float(np.min(lowest + self.doubt(intervals[near]), initial=math.inf)))
            share = np.where(share < 1.0, low[near] + share * (high[near] - low[near]), high[near])
            before, after = self.time[intervals[near]], self.time[intervals[near] + 1]
            found.append(lowest)
            times.append(np.where(share < 1.0, before + share * (after - before), after))
        extremes = np.concatenate(found)
        if not len(extremes):
            return None
        value, time = _first_lowest(extremes, np.concatenate(times), same)
        return value, time, sure if math.isfinite(sure) else value

    def _lowest_sample(self, sign: float, within: Sequence[Stretch] | None) -> Extreme:
        inside = self._inside(within)
        if not inside.any():
            return Extreme(math.nan, math.nan)
        value, time = _first_lowest(sign * self.values[0][inside], self.time[inside])
        return Extreme(sign * value, time, sure=sign * value)

    def _inside(self, within: Sequence[Stretch] | None) -> NDArray[np.bool_]:
        """Which samples are in some stretches of time, or in the whole run."""
        if within is None:
            return np.ones(len(self.time), dtype=bool)
        starts, ends = (np.array([each[end] for each in within]) for end in (0, 1))
        return np.asarray(
            np.searchsorted(starts, self.time, "right") > np.searchsorted(ends, self.time, "left")
        )

    def _ends(self, time: float) -> list[int]:
        """The samples on both sides of a time."""
        if len(self.time) == 1:
            return [0]
        interval = self._interval(time)
        return [interval, interval + 1]

    def _pieces_below(self, sign: float, level: float) -> Iterator[tuple[Integers, Floats, Floats]]:
        """Whole intervals on which `sign` times the motion may be as low as a level, block by block."""
        lowest, highest = self._reach
        pieces = np.flatnonzero((lowest if sign > 0.0 else -highest) <= level)
        for begin in range(0, len(pieces), BLOCK):
            some = pieces[begin : begin + BLOCK]
            yield some, np.zeros(len(some)), np.ones(len(some))

    def _pieces(self, within: Sequence[Stretch]) -> Iterator[tuple[Integers, Floats, Floats]]:
        """Intervals in some stretches of time, and the shares of each that lie within, block by block."""
        starts, ends = (np.array([each[end] for each in within]) for end in (0, 1))
        cuts = np.unique(np.concatenate([self.time, starts, ends]))
        middles = 0.5 * (cuts[1:] + cuts[:-1])
        inside = np.searchsorted(starts, middles, "right") > np.searchsorted(ends, middles, "left")
        pieces = np.flatnonzero(inside)
        for begin in range(0, len(pieces), BLOCK):
            some = pieces[begin : begin + BLOCK]
            intervals = self.interval(cuts[some])
            start, h = self.time[intervals], self._length(intervals)
            yield intervals, (cuts[some] - start) / h, (cuts[some + 1] - start) / h

    def nearest(self, level: float, within: Sequence[Stretch]) -> Extreme:
        """How near the motion comes to a level in some stretches of time: 0 where it passes it."""
        if not self.finite:
            return Extreme(math.nan, math.nan)
        for time in self.crossings(level):
            if any(each.start <= time <= each.end for each in within):
                return Extreme(0.0, time)
        above = self.along(np.array([0.5 * (each.start + each.end) for each in within])) >= level
        found = []
        for sign in (1.0, -1.0):
            side = [each for each, over in zip(within, above, strict=True) if over == (sign > 0.0)]
            if side:
                extreme = self.lowest(sign, side)
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
