"""The places at which two traces are compared: equal shaft angles, or equal times.

The samples of the trace that has fewer of them are the places. Where the other one has a sample at the same
place, as with equal steps or half the step, the two values are compared as they are. Elsewhere its value is
interpolated; how far a sample is from the line between its neighbours tells what that is worth, and a
difference below that is not reported as one. One column of either trace is in memory at a time.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import units
from ..declaring.variables import SHARED
from ..errors import LoomfmuError, shown
from .comparison import Change, Place
from .reader import Trace
from .signals import Floats

SAME_PLACE = 1e-9  # share of a step
ROUNDINGS = 8  # units in the last place of an angle or time, beside that share
TURN = 2.0 * math.pi
WHOLE = 1e-9  # of a revolution: so near to its end, the next one has begun
ANGLE, TIME = AXES = ("angle", "time")


@dataclass(frozen=True)
class Meeting:
    """The places at which two traces are compared: samples `rows` of the `base`, with the other's before
    them.

    `between` is how far each place is from the sample before to the one after it, 0 at a sample.
    """

    traces: tuple[Trace, Trace]
    axes: tuple[Floats, Floats]
    over: str
    base: int
    rows: slice
    before: NDArray[np.int64]
    between: Floats

    @property
    def same(self) -> bool:
        """Return whether both have their samples at the same places."""
        return len(self.axes[0]) == len(self.axes[1]) == len(self.before) and not np.any(self.between)

    @property
    def how(self) -> str:
        """At which samples the traces are compared."""
        places = len(self.before)
        interpolated = int(np.count_nonzero(self.between))
        equal = "shaft angles" if self.over == ANGLE else "times"
        whose = f"the {places} samples of {self.traces[self.base].given}"
        if self.same:
            whose = f"{places} samples"
        text = f"compared at equal {equal}, at {whose}"
        if interpolated:
            text += f"; {self.traces[1 - self.base].given} is interpolated at {interpolated} of them"
        return text

    def extent(self) -> Iterator[Change]:
        """The part of the run that one of the traces does not have."""
        scale = max(abs(axis[end]) for axis in self.axes for end in (0, -1))
        if any(abs(self.axes[0][end] - self.axes[1][end]) > 1e-6 * scale for end in (0, -1)):
            unit = "deg" if self.over == ANGLE else "s"
            factor = units.unit(unit).factor
            ends = (f"{axis[0] / factor:.7g} to {axis[-1] / factor:.7g} {unit}" for axis in self.axes)
            yield Change("run", "shaft angle" if self.over == ANGLE else "time", *ends)

    def place(self, row: int) -> Place:
        """The place of a row, counted among those that are compared."""
        trace, row = self.traces[self.base], row + self.rows.start
        angle = trace.shaft_angle
        if not _way(angle):
            return Place(float(trace.time[row]), math.nan, None)
        turned, begun = (math.floor(_way(angle) * each / TURN + WHOLE) for each in (angle[row], angle[0]))
        within = float(angle[row]) / TURN
        within = max(within - math.floor(within + WHOLE), 0.0)
        return Place(float(trace.time[row]), TURN * within, turned - begun + 1)

    def columns(self, signal: str, exact: bool = False) -> tuple[Floats, Floats, Floats]:
        """The values of the first and the second trace at the places, and what interpolation is worth.

        A whole number that jumps at a sample may do so one sample earlier in one of the traces, by rounding;
        not where `exact` is wanted and both have the same samples.
        """
        base, other = (_column(self.traces[each], signal) for each in (self.base, 1 - self.base))
        there, last = base[self.rows].astype(np.float64), len(other) - 1
        after = np.minimum(self.before + 1, last)
        near, doubt = other[self.before].astype(np.float64), np.zeros(len(self.before))
        if other.dtype.kind != "f":
            if not (exact and self.same):
                sides = np.maximum(self.before - 1, 0), after
                jumps = (other[sides[0]] == there) | (other[sides[1]] == there)
                if self.same:  # what is there for one sample alone is no jump
                    jumps &= (there[sides[0]] == near) | (there[sides[1]] == near)
                near = np.where(jumps, there, near)
        else:
            inside = self.between > 0.0
            with np.errstate(invalid="ignore", over="ignore"):
                near[inside] += (self.between * (other[after] - near))[inside]
                bend = _bend(self.axes[1 - self.base], other)
                doubt[inside] = 2.0 * np.maximum(bend[self.before], bend[after])[inside]
        return (there, near, doubt) if self.base == 0 else (near, there, doubt)


def _column(trace: Trace, signal: str) -> NDArray[Any]:
    return getattr(trace, signal) if signal in SHARED else trace.read(signal)


def _bend(axis: Floats, values: Floats) -> Floats:
    """Return the distance of each value from the line between its neighbours; the ends repeat theirs."""
    if len(values) < 3:
        return np.full(len(values), np.ptp(values))
    share = (axis[1:-1] - axis[:-2]) / (axis[2:] - axis[:-2])
    inner = np.abs(values[1:-1] - values[:-2] - share * (values[2:] - values[:-2]))
    return np.concatenate([inner[:1], inner, inner[-1:]])


def _way(angle: Floats) -> int:
    """The way that a shaft turns: 1 forward, -1 backward, 0 if it does not turn one way throughout."""
    steps = np.diff(angle)
    if not len(steps) or not np.all(np.isfinite(angle)):
        return 0
    return int(np.all(steps > 0.0)) - int(np.all(steps < 0.0))


def meet(first: Trace, second: Trace, over: str | None) -> Meeting:
    """Return the places at which to compare two traces. Raises LoomfmuError if they share no range."""
    traces = (first, second)
    for trace in traces:
        if not trace.rows:
            raise LoomfmuError(f"{trace.given}: the trace has no samples, so there is nothing to compare")
    ways = [_way(trace.shaft_angle) for trace in traces]
    turn = ways[0] != 0 and ways[0] == ways[1]
    if over not in (None, *AXES):
        raise LoomfmuError(f'over = {shown(over)} must be "angle" or "time"')
    if over == ANGLE and not turn:
        raise LoomfmuError('the shafts do not both turn one way throughout: compare with over = "time"')
    over = over or (ANGLE if turn else TIME)
    axes = tuple(ways[0] * trace.shaft_angle if over == ANGLE else trace.time for trace in traces)
    start, end = max(axis[0] for axis in axes), min(axis[-1] for axis in axes)
    slack = _slack(axes[0])
    inside = [np.flatnonzero((axis >= start - slack) & (axis <= end + slack)) for axis in axes]
    base = int(len(inside[1]) < len(inside[0]))
    if not len(inside[base]):
        raise LoomfmuError(f"{first.given} and {second.given} have no {over} in common")
    rows = slice(int(inside[base][0]), int(inside[base][-1]) + 1)
    before, between = _beside(axes[base][rows], axes[1 - base])
    return Meeting(traces, (axes[0], axes[1]), over, base, rows, before, between)


def _slack(axis: Floats) -> float:
    """Return the difference below which two places count as the same."""
    step = float(np.min(np.diff(axis))) if len(axis) > 1 else 0.0
    return SAME_PLACE * step + ROUNDINGS * float(np.spacing(np.max(np.abs(axis))))


def _beside(places: Floats, axis: Floats) -> tuple[NDArray[np.int64], Floats]:
    """The sample before each place, and how far the place is from it to the next one; 0 at a sample."""
    last = len(axis) - 1
    before = np.clip(np.searchsorted(axis, places, side="right") - 1, 0, last)
    after = np.minimum(before + 1, last)
    nearest = np.where(np.abs(axis[after] - places) < np.abs(places - axis[before]), after, before)
    same = np.abs(axis[nearest] - places) <= _slack(axis)
    width = np.where(after > before, axis[after] - axis[before], 1.0)
    between = np.where(same, 0.0, (places - axis[before]) / width)
    return np.where(same, nearest, before), between
