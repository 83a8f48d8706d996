"""Two traces, compared signal by signal: at equal shaft angles, or at equal times.

The samples of the trace that has fewer of them are the places. Where the other one has a sample at the same
place, as with equal steps or half the step, the two values are compared as they are. Elsewhere its value is
interpolated; how far a sample is from the line between its neighbours tells what that is worth, and a
difference below that is not reported as one. One column of either trace is in memory at a time.
"""

import fnmatch
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from .. import units
from ..errors import LoomfmuError, shown
from .comparison import Change, Comparison, Difference, Place
from .reader import Trace
from .signals import SHARED, Floats
from .verdict import Verdict

TOLERANCE = 1e-9  # far above what compilers and C libraries round differently, far below what a loom feels
SAME_PLACE = 1e-9  # share of a step
ROUNDINGS = 8  # units in the last place of an angle or time, beside that share
TURN = 2.0 * math.pi
WHOLE = 1e-9  # of a revolution: so near to its end, the next one has begun
ANGLE, TIME = AXES = ("angle", "time")
PROVENANCE = ("software", "flavour", "grid", "steps_per_revolution", "step")


@dataclass(frozen=True)
class Tolerance:
    """What counts as equal: a share of each signal's largest magnitude, or an amount for names like these."""

    share: float
    absolute: Mapping[str, str | float]

    def __post_init__(self) -> None:
        if not 0.0 <= self.share < math.inf:
            raise LoomfmuError(f"tolerance = {shown(self.share)} must be a number, 0 or more")

    def of(self, name: str, unit: str, scale: float, exact: bool = False) -> float:
        """What two values of that name may differ by, in its unit; whole numbers and texts are exact."""
        for pattern, amount in self.absolute.items():
            if name == pattern or fnmatch.fnmatchcase(name, pattern):
                try:
                    return units.parse(amount, unit)
                except LoomfmuError as error:
                    raise LoomfmuError(f"tolerance of {name}: {error}") from None
        return 0.0 if exact else self.share * scale

    def check(self, names: Sequence[str]) -> None:
        """Raise LoomfmuError for an amount that no name takes."""
        for pattern in self.absolute:
            if pattern not in names and not fnmatch.filter(names, pattern):
                raise LoomfmuError(
                    f"tolerance of {pattern}: neither trace has a signal or value of that name"
                )


def compare(
    first: str | Path | Trace,
    second: str | Path | Trace,
    *,
    tolerance: float = TOLERANCE,
    absolute: Mapping[str, str | float] | None = None,
    ignore: Sequence[str] = (),
    over: Literal["angle", "time"] | None = None,
) -> Comparison:
    """What differs between two traces, where first and by how much; true if nothing does.

    Args:
        first, second: traces or their files
        tolerance: what values may differ by, as a share of their signal's largest magnitude;
            with 0 they must be equal
        absolute: amounts for some signals and values instead, such as {"belt.free_length": "0.1 mm"}; * and ?
            stand for parts of names
        ignore: names of signals and values that are left out, such as ["motor.*"]
        over: compare at equal shaft angles ("angle", the default where the shafts turn) or at equal "time"

    Raises:
        LoomfmuError: a trace cannot be read, has no samples, or its grid does not tell whether they differ
    """
    one, two = traces = _opened(first), _opened(second)
    allowed = Tolerance(float(tolerance), dict(absolute or {}))
    kept = [_kept(trace, ignore) for trace in traces]
    values = [_kept(trace.parameters, ignore) for trace in traces]
    allowed.check([*SHARED, *(name for names in (*kept, *values) for name in names)])
    meeting = _meeting(one, two, over)
    common = [name for name in kept[0] if name in traces[1] and name in kept[1]]
    found = [_difference(meeting, name, allowed) for name in (*SHARED, *common)]
    differences = sorted(
        (each for each in found if isinstance(each, Difference)), key=lambda each: each.first.time
    )
    changes = (
        *meeting.extent(), *(each for each in found if isinstance(each, Change)),
        *(Change("signal", name, "recorded", "missing") for name in kept[0] if name not in kept[1]),
        *(Change("signal", name, "missing", "recorded") for name in kept[1] if name not in kept[0]),
        *_claims(one, two, allowed), *_values(one, two, values[0], values[1], allowed), *_status(one, two),
    )  # fmt: skip
    notes = [*_notes(one, two)]
    if unclear := [each for each in found if isinstance(each, _Unclear)]:
        worst = max(unclear, key=lambda each: each.share)
        share = f"{1.5 * worst.share:.0e}"
        reason = (
            f"their samples are not at the same places, and interpolation between them is off by up to"
            f" {share} of {worst.signal}'s largest magnitude"
        )
        if not differences and not changes:
            raise LoomfmuError(
                f"{one.given} and {two.given} cannot be compared that closely: {reason}; run both"
                f" with the same steps, or allow a tolerance of {share}"
            )
        notes.append(f"{len(unclear)} more signals may differ by less than can be seen: {reason}")
    names = (str(one.given), str(two.given))
    return Comparison(
        names, len(common), meeting.how, allowed.share, tuple(differences), changes, tuple(notes)
    )


def _opened(given: str | Path | Trace) -> Trace:
    return given if isinstance(given, Trace) else Trace(given)


def _kept(names: Any, ignore: Sequence[str]) -> list[str]:
    if isinstance(ignore, str):
        raise LoomfmuError(f'ignore = {shown(ignore)} must be a list such as ["motor.*"]')
    return [name for name in names if not any(fnmatch.fnmatchcase(name, pattern) for pattern in ignore)]


@dataclass(frozen=True)
class _Unclear:
    """A signal of which the grids do not tell whether it differs, and the share that they are good to."""

    signal: str
    share: float


@dataclass(frozen=True)
class _Meeting:
    """Where two traces are compared: samples `rows` of the `base`, with the other's samples before them.

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
        """Whether both have their samples at the same places."""
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

    def columns(self, signal: str) -> tuple[Floats, Floats, Floats]:
        """The values of the first and the second trace at the places, and what interpolation is worth."""
        base, other = (_column(self.traces[each], signal) for each in (self.base, 1 - self.base))
        there, last = base[self.rows].astype(np.float64), len(other) - 1
        after = np.minimum(self.before + 1, last)
        near, doubt = other[self.before].astype(np.float64), np.zeros(len(self.before))
        if other.dtype.kind != "f":
            for beside in () if self.same else (np.maximum(self.before - 1, 0), after):
                near = np.where(other[beside] == there, there, near)  # it jumps in one step or the next
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
    """How far each value is from the line between its neighbours; the first and the last as those beside."""
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


def _meeting(first: Trace, second: Trace, over: str | None) -> _Meeting:
    """Where two traces are compared. Raises LoomfmuError if they have no place in common."""
    traces = (first, second)
    for trace in traces:
        if not trace.rows:
            raise LoomfmuError(f"{trace.given}: there is nothing to compare: the trace has no samples")
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
    return _Meeting(traces, (axes[0], axes[1]), over, base, rows, before, between)


def _slack(axis: Floats) -> float:
    """What two places may differ by and still be the same."""
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


def _difference(
    meeting: _Meeting, signal: str, tolerance: Tolerance
) -> Difference | Change | _Unclear | None:
    """What differs of a signal, if anything does."""
    trace, other = meeting.traces
    unit, theirs = trace.unit(signal), other.unit(signal)
    factor = 1.0
    if unit != theirs:
        known = [units.UNITS.get(units.canonical(each)) for each in (unit, theirs)]
        if known[0] is None or known[1] is None or known[0].dimension != known[1].dimension:
            return Change("unit", signal, unit, theirs)
        factor = known[1].factor / known[0].factor
    a, b, doubt = meeting.columns(signal)
    b = factor * b if factor != 1.0 else b
    with np.errstate(invalid="ignore"):
        gap = np.abs(a - b)
    gap[(a == b) | (np.isnan(a) & np.isnan(b))] = 0.0
    gap[np.isnan(gap)] = np.inf
    finite = np.abs(np.concatenate([a[np.isfinite(a)], b[np.isfinite(b)]]))
    scale = float(np.max(finite, initial=0.0))
    allowed = tolerance.of(signal, unit, scale, exact=not _is_real(trace, signal))
    doubt = np.where(np.isfinite(doubt), doubt, np.inf) * factor
    beyond = np.flatnonzero(gap > allowed + doubt)
    if not len(beyond):
        unclear = gap > allowed
        return _Unclear(signal, float(np.max(gap[unclear])) / (scale or 1.0)) if np.any(unclear) else None
    row, worst = int(beyond[0]), int(beyond[np.argmax(gap[beyond])])
    return Difference(
        signal, unit, trace.display(signal), meeting.place(row), (float(a[row]), float(b[row])),
        float(gap[worst]), scale, meeting.place(worst),
    )  # fmt: skip


def _is_real(trace: Trace, signal: str) -> bool:
    return signal in SHARED or trace.is_real(signal)


def _claims(first: Trace, second: Trace, tolerance: Tolerance) -> Iterator[Change]:
    """Claims that only one run has or judged, and those with another outcome."""
    found = [_by_name(trace.verdicts) for trace in (first, second)]
    for name in dict.fromkeys([*found[0], *found[1]]):
        a, b = (each.get(name) for each in found)
        if a is None or b is None or not _alike(a, b, tolerance):
            yield Change(
                "claim", name[0], *("missing" if each is None else _outcome(each) for each in (a, b))
            )


def _by_name(verdicts: Sequence[Verdict]) -> dict[tuple[str, str, int], Verdict]:
    """Verdicts by their claim and signal; equal ones are counted."""
    found: dict[tuple[str, str, int], Verdict] = {}
    for verdict in verdicts:
        number = sum((verdict.claim, verdict.signal) == name[:2] for name in found)
        found[verdict.claim, verdict.signal, number] = verdict
    return found


def _alike(a: Verdict, b: Verdict, tolerance: Tolerance) -> bool:
    scale = max(
        (abs(each) for v in (a, b) for each in (v.worst, v.bound) if math.isfinite(each)), default=0.0
    )
    allowed = tolerance.of(a.signal, a.unit, scale)
    pairs = ((a.worst, b.worst), (a.bound, b.bound))
    near = all(x == y or abs(x - y) <= allowed or (math.isnan(x) and math.isnan(y)) for x, y in pairs)
    return near and (a.holds, a.unit) == (b.holds, b.unit)


def _outcome(verdict: Verdict) -> str:
    return f"{verdict.word}, {verdict.shown(verdict.worst)}, bound {verdict.shown(verdict.bound)}"


def _values(
    first: Trace, second: Trace, mine: Sequence[str], others: Sequence[str], tolerance: Tolerance
) -> Iterator[Change]:
    """Values of instances that differ, or that only one run has."""
    for name in dict.fromkeys([*mine, *others]):
        a, b = (trace.parameters.get(name) for trace in (first, second))
        if isinstance(a, float) and isinstance(b, float):
            unit = first.parameter_unit(name)
            if a == b or abs(a - b) <= tolerance.of(name, unit, max(abs(a), abs(b))):
                continue
        elif a == b:
            continue
        yield Change("value", name, *(_set(trace, name) for trace in (first, second)))


def _set(trace: Trace, name: str) -> str:
    value = trace.parameters.get(name)
    if not isinstance(value, float):
        return "missing" if value is None else str(value)
    unit = trace.parameter_unit(name)
    return f"{value:.9g}" + ("" if unit == "1" else f" {unit}")


def _status(first: Trace, second: Trace) -> Iterator[Change]:
    for name in ("status", "ended_by"):
        a, b = (str(trace.attributes.get(name, "")) or "-" for trace in (first, second))
        if a != b:
            yield Change("run", name.replace("_", " "), a, b)


def _notes(first: Trace, second: Trace) -> Iterator[str]:
    """What else is not the same, and may explain a difference."""
    mine, others = (trace.attributes for trace in (first, second))
    versions = sorted(
        name for name in {*mine, *others} if name.startswith("fmu_") and name.endswith("_version")
    )
    for name in (*PROVENANCE, *versions):
        a, b = (str(each.get(name, "none")) for each in (mine, others))
        if a != b:
            yield f"{name.replace('_', ' ')}: {a} and {b}"
    hashes = [name for name in mine if name.startswith("fmu_") and name.endswith("_sha256")]
    changed = [name[4:-7] for name in hashes if name in others and mine[name] != others[name]]
    if changed:
        yield f"the files of these FMUs differ: {', '.join(sorted(changed))}"
