"""Recorded signals between their samples."""

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
DOUBT = 0.25  # of the difference between second rates over an interval, see `Motion.doubt`
ONLY_SAMPLES = "is known only at the samples"
ROUNDING = 1e-12  # of the largest value: what rounding may add


class Stretch(NamedTuple):
    """A stretch of time, and whether it begins and ends within the run."""

    start: float
    end: float
    whole: bool = True


class Doubt(str):
    """A note that leaves a claim undecided which would hold otherwise."""


class Unknown(Doubt):
    """A note that a signal is not known between the samples: only a sample may fail a claim."""


def advised(note: str) -> str:
    """Return a note, with the remedy if it is on a signal that is known only at the samples."""
    if not note.endswith(ONLY_SAMPLES):
        return note
    return Unknown(f"{note}; set at_samples = true in the claim to judge these alone")


class Survey(NamedTuple):
    """Facts about the samples of a motion: whether all are `finite`, their range.

    `longest` is the longest step from one value to the next; the others are NaN if a value is.
    """

    finite: float
    lowest: float
    highest: float
    longest: float

    @property
    def largest(self) -> float:
        """The largest magnitude."""
        return max(abs(self.lowest), abs(self.highest))

    @property
    def reversed(self) -> "Survey":
        """Return the survey of the same values with the other sign."""
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
        self.samples_hold = trace.held(signal, 1.0) == signal  # it goes one way between two samples
        self._compiled = compiled(columns)

    @cached_property
    def survey(self) -> Survey:
        """The survey of the samples."""
        if self._compiled:
            return Survey(*self._compiled.survey())
        finite = all(bool(np.isfinite(values).all()) for values in self.values)
        values = self.values[0]
        with np.errstate(invalid="ignore"):
            steps = np.diff(values)
        longest = float(np.fmax.reduce(np.abs(steps), initial=0.0))
        return Survey(finite, float(np.min(values)), float(np.max(values)), longest)

    @property
    def finite(self) -> bool:
        """Return whether all values and rates are finite."""
        return bool(self.survey.finite)

    @property
    def longest(self) -> float:
        """The largest difference of two neighbouring samples."""
        return self.survey.longest

    @property
    def known(self) -> bool:
        """True if the values between the samples are known: by rates, or because samples are the extremes."""
        return len(self.values) > 1 or self.samples_hold

    @property
    def note(self) -> str:
        """The reason why the values between the samples are not known, if so."""
        if not self.finite:
            return Unknown(f"{self.signal} or its rate is not finite everywhere")
        return "" if self.known else Unknown(f"{self.signal} {ONLY_SAMPLES}")

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
        """Return the largest error of the polynomials on some intervals, reached in the middle of each.

        Values and rates give a cubic. Its second rates at the ends of an interval are compared with the
        recorded ones, or with those that the rates of the neighbouring samples give. A quintic with these is
        away from the cubic by up to 1/29 of the difference, a line with a corner in the interval by 1/4. On a
        smooth motion the cubic is off by 1/25 of that, the quintic by far less.
        """
        if len(self.values) == 1:
            return np.full(len(intervals), 0.0 if self.samples_hold else np.inf)
        h, ends = self.length(intervals), (intervals, intervals + 1)
        y0, y1 = (self.values[0][end] for end in ends)
        v0, v1 = (self.values[1][end] * h for end in ends)
        a0, a1 = (self._bends[end] * h**2 for end in ends)
        before = np.abs(a0 - (6.0 * (y1 - y0) - 4.0 * v0 - 2.0 * v1))
        after = np.abs(a1 - (2.0 * v0 + 4.0 * v1 - 6.0 * (y1 - y0)))
        return DOUBT * np.maximum(before, after)

    @cached_property
    def doubts(self) -> Floats:
        """The same for all intervals."""
        return self.doubt(np.arange(len(self.time) - 1))

    @cached_property
    def _bends(self) -> Floats:
        """Second rates at the samples."""
        if len(self.values) > 2:
            return self.values[2]
        if len(self.time) < 2:
            return np.zeros(len(self.time))
        return np.asarray(np.gradient(self.values[1], self.time, edge_order=2 if len(self.time) > 2 else 1))

    def length(self, intervals: Integers) -> Floats:
        return np.asarray(self.time[intervals + 1] - self.time[intervals])

    def interval(self, times: Floats) -> Integers:
        """The intervals that some times lie in."""
        found = np.searchsorted(self.time, times, side="right") - 1
        return np.asarray(np.maximum(np.minimum(found, len(self.time) - 2), 0))

    def interval_of(self, time: float) -> int:
        """The same of one time."""
        return min(max(int(self.time.searchsorted(time, "right")) - 1, 0), len(self.time) - 2)

    def along(self, times: Floats) -> Floats:
        """Values at some times."""
        if len(self.time) == 1:
            return np.full(len(times), self.values[0][0])
        intervals = self.interval(times)
        return bernstein.value(
            self.points(intervals), (times - self.time[intervals]) / self.length(intervals)
        )

    def at(self, time: float) -> float:
        """Value at a time."""
        if len(self.time) == 1:
            return float(self.values[0][0])
        if self._compiled:
            return self._compiled.at(time)
        interval = self.interval_of(time)
        before, after = float(self.time[interval]), float(self.time[interval + 1])
        return bernstein.value_of_piece(self._piece(interval), (time - before) / (after - before))

    @cached_property
    def reach(self) -> tuple[Floats, Floats]:
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
        lowest, highest = self.reach
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
