"""Two traces, compared: signals, claims and values, where they differ first and by how much."""

import fnmatch
import math
from collections import Counter, deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any, Literal

import numpy as np

from .. import units
from ..declaring.upstream import sources_of, upstream
from ..declaring.variables import SHARED
from ..errors import LoomfmuError, listed, path_of, shown, within
from .comparison import Change, Comparison, Difference
from .meeting import Meeting, meet
from .reader import Trace
from .verdict import Verdict

TOLERANCE = 1e-9  # far above what compilers and C libraries round differently, far below what a loom feels
PROVENANCE = ("software", "flavour", "steps_per_revolution", "step")


@dataclass(frozen=True)
class Tolerance:
    """The tolerance of a comparison: a share of each signal's largest magnitude, or an amount by name."""

    share: float
    absolute: Mapping[str, str | float]

    def __post_init__(self) -> None:
        if not 0.0 <= self.share < math.inf:
            raise LoomfmuError(f"tolerance = {shown(self.share)} must be a number, 0 or more")

    def of(self, name: str, unit: str, scale: float, exact: bool = False) -> float:
        """Return by how much two values of that name may differ; whole numbers and texts are exact."""
        for pattern, amount in self.absolute.items():
            if name == pattern or fnmatch.fnmatchcase(name, pattern):
                with within(f"tolerance of {name}"):
                    return units.parse(amount, unit)
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
    tolerance: str | float = TOLERANCE,
    absolute: Mapping[str, str | float] | None = None,
    ignore: Sequence[str] = (),
    over: Literal["angle", "time"] | None = None,
) -> Comparison:
    """Return the differences between two traces, the first and the largest; true if there are none.

    Args:
        first, second: traces or their files
        tolerance: what values may differ by, as a share of their signal's largest magnitude;
            such as "0.1 %"; with 0 they must be equal
        absolute: amounts for some signals and values instead, such as {"belt.free_length": "0.1 mm"}; * and ?
            stand for parts of names
        ignore: names of signals and values that are left out, such as ["motor.*"]
        over: compare at equal shaft angles ("angle", the default where the shafts turn) or at equal "time"

    Raises:
        LoomfmuError: a trace cannot be read, has no samples, or its grid does not tell whether they differ
    """
    one, two = traces = [
        each if isinstance(each, Trace) else Trace(path_of(each, "trace")) for each in (first, second)
    ]
    allowed = Tolerance(_share(tolerance), dict(absolute or {}))
    if isinstance(ignore, str):
        raise LoomfmuError(f'ignore = {shown(ignore)} must be a list such as ["motor.*"]')
    instances = [list(dict.fromkeys(map(_owner, (*trace.parameters, *trace)))) for trace in traces]
    alone = [_kept(here, (*ignore, *there)) for here, there in (instances, instances[::-1])]
    every = [*ignore, *(f"{name}.*" for names in alone for name in names)]
    kept = [_kept(trace, every) for trace in traces]
    if ignore and not any(kept):
        raise LoomfmuError(f"ignore = {shown(ignore)} leaves out all signals, so there is nothing to compare")
    values = [_kept(trace.parameters, every) for trace in traces]
    allowed.check([*SHARED, *(name for names in (*kept, *values) for name in names)])
    meeting = meet(one, two, over)
    common = [name for name in kept[0] if name in traces[1] and name in kept[1]]
    found = [_difference(meeting, name, allowed) for name in (*SHARED, *common)]
    differences = sorted(
        (each for each in found if isinstance(each, Difference)), key=lambda each: -each.relative
    )
    changes = (  # causes before effects
        *(Change("instance", name, "recorded", "missing") for name in alone[0]),
        *(Change("instance", name, "missing", "recorded") for name in alone[1]),
        *_values(one, two, values[0], values[1], allowed),
        *_claims(one, two, allowed),
        *_status(one, two),
        *meeting.extent(),
        *(each for each in found if isinstance(each, Change)),
        *(Change("signal", name, "recorded", "missing") for name in kept[0] if name not in kept[1]),
        *(Change("signal", name, "missing", "recorded") for name in kept[1] if name not in kept[0]),
    )
    notes = [*_notes(one, two)]
    if unclear := [each for each in found if isinstance(each, _Unclear)]:
        share, reason = _doubt(unclear)
        if not differences and not changes:
            raise LoomfmuError(
                f"{one.given} and {two.given} cannot be compared that closely: {reason}; run both"
                f" with the same steps, or allow a tolerance of {share}"
            )
        notes.append(f"{len(unclear)} more signals may differ by less than can be seen: {reason}")
    return Comparison(
        (str(one.given), str(two.given)),
        len(common),
        meeting.how,
        allowed.share,
        tuple(differences),
        changes,
        tuple(notes),
        _earliest(one, differences),
    )


def _earliest(trace: Trace, differences: Sequence[Difference]) -> Difference | None:
    """The signal that differs first; of several at the same sample, one that others follow from.

    That is one of the instance that depends on the fewest others by its wires, and feeds most of them: the
    shaft, if it is among them. Without wires it is the first instance of the file.
    """
    wires = ((source.partition(".")[0], sink.partition(".")[0]) for sink, source in trace.wires.items())
    sources = sources_of(wires)
    fed = Counter(source for found in sources.values() for source in found)
    places = list(dict.fromkeys(name.partition(".")[0] for name in (*trace, *SHARED)))

    def rank(each: Difference) -> tuple[float, int, int, int]:
        instance = each.signal.partition(".")[0]
        before = len(upstream(sources.get(instance, ()), sources))
        return each.first.time, before, -fed[instance], places.index(instance)

    return min(differences, key=rank, default=None)


def _share(tolerance: str | float) -> float:
    try:
        return units.parse(tolerance, "1")
    except units.UnitError as error:
        wanted = 'give a share such as "0.1 %", or an amount for a signal with absolute={"belt.margin": 0.1}'
        raise LoomfmuError(f"tolerance = {shown(tolerance)}: {error}; {wanted}") from None


def _owner(name: str) -> str:
    return name.partition(".")[0]


def _kept(names: Any, ignore: Sequence[str]) -> list[str]:
    return [name for name in names if not any(fnmatch.fnmatchcase(name, pattern) for pattern in ignore)]


@dataclass(frozen=True)
class _Unclear:
    """A signal of which the grids do not tell whether it differs, and the share that they are good to."""

    signal: str
    share: float


def _doubt(unclear: Sequence[_Unclear]) -> tuple[str, str]:
    """The share of a signal's largest magnitude that interpolation may be off by, and that in words."""
    worst = max(unclear, key=lambda each: each.share)
    share = f"{1.5 * worst.share:.0e}"  # rounded to a digit, and still above it
    return share, (
        "their samples are not at the same places, and interpolation between them is off by up to"
        f" {share} of {worst.signal}'s largest magnitude"
    )


def _difference(meeting: Meeting, signal: str, tolerance: Tolerance) -> Difference | Change | _Unclear | None:
    """Return the difference of a signal, if any."""
    trace, other = meeting.traces
    unit, theirs = trace.unit(signal), other.unit(signal)
    factor = 1.0
    if unit != theirs:
        known = [units.UNITS.get(units.canonical(each)) for each in (unit, theirs)]
        if known[0] is None or known[1] is None or known[0].dimension != known[1].dimension:
            return Change("unit", signal, unit, theirs)
        factor = known[1].factor / known[0].factor
    a, b, doubt = meeting.columns(signal, exact=tolerance.share == 0.0)
    b = factor * b if factor != 1.0 else b
    with np.errstate(invalid="ignore"):
        gap = np.abs(a - b)
    gap[(a == b) | (np.isnan(a) & np.isnan(b))] = 0.0
    gap[np.isnan(gap)] = np.inf
    finite = np.abs(np.concatenate([a[np.isfinite(a)], b[np.isfinite(b)]]))
    scale = float(np.max(finite, initial=0.0))
    allowed = tolerance.of(signal, unit, scale, exact=signal not in SHARED and not trace.is_real(signal))
    doubt = np.where(np.isfinite(doubt), doubt, np.inf) * (factor if meeting.base == 0 else 1.0)
    beyond = np.flatnonzero(gap > allowed + doubt)
    if not len(beyond):
        unclear = gap > allowed
        return _Unclear(signal, float(np.max(gap[unclear])) / (scale or 1.0)) if np.any(unclear) else None
    row, worst = int(beyond[0]), int(beyond[np.argmax(gap[beyond])])
    return Difference(
        signal,
        unit,
        trace.display(signal),
        meeting.place(row),
        (float(a[row]), float(b[row])),
        float(gap[worst]),
        scale,
        meeting.place(worst),
    )


def _claims(first: Trace, second: Trace, tolerance: Tolerance) -> Iterator[Change]:
    """Claims that only one run has or judged, and those with another outcome."""
    for pair in paired(first.verdicts, second.verdicts):
        known = [each for each in pair if each is not None]
        named = len({each.signal for each in known}) > 1
        # a worst frame of several is not a recorded signal, and may be another one in each run
        other = named and any(each.signal in trace for each in known for trace in (first, second))
        if len(known) < 2 or other or not _alike(known[0], known[-1], tolerance):
            outcomes = ("missing" if each is None else _outcome(each, named) for each in pair)
            yield Change("claim", known[0].claim, *outcomes)


def paired(
    first: Sequence[Verdict], second: Sequence[Verdict]
) -> Iterator[tuple[Verdict | None, Verdict | None]]:
    """Yield the verdicts on the same claim: those of one text and signal, of the others those of one text."""
    found: dict[int, Verdict] = {}
    left = dict(enumerate(second))
    for wanted in (("claim", "signal"), ("claim",)):
        same = attrgetter(*wanted)
        places: dict[Any, deque[int]] = {}
        for place, other in left.items():
            places.setdefault(same(other), deque()).append(place)
        for number, one in enumerate(first):
            if number not in found and (of_it := places.get(same(one))):
                found[number] = left.pop(of_it.popleft())
    yield from ((one, found.get(number)) for number, one in enumerate(first))
    yield from ((None, other) for other in left.values())


def _alike(a: Verdict, b: Verdict, tolerance: Tolerance) -> bool:
    scale = max(
        (abs(each) for v in (a, b) for each in (v.worst, v.bound) if math.isfinite(each)), default=0.0
    )
    allowed = tolerance.of(a.signal, a.unit, scale)
    pairs = ((a.worst, b.worst), (a.bound, b.bound))
    near = all(x == y or abs(x - y) <= allowed or (math.isnan(x) and math.isnan(y)) for x, y in pairs)
    return near and (a.word, a.unit) == (b.word, b.unit)


def _outcome(verdict: Verdict, named: bool) -> str:
    signal = f" ({verdict.signal})" if named else ""
    return f"{verdict.word}{signal}, {verdict.shown_worst}, bound {verdict.shown(verdict.bound)}"


def _values(
    first: Trace, second: Trace, mine: Sequence[str], others: Sequence[str], tolerance: Tolerance
) -> Iterator[Change]:
    """Values of instances that differ, or that only one run has."""
    given = {*first.overrides, *second.overrides}
    names = sorted(dict.fromkeys([*mine, *others]), key=lambda name: name not in given)  # causes first
    for name in names:
        a, b = (trace.parameters.get(name) for trace in (first, second))
        if isinstance(a, float) and isinstance(b, float):
            unit = first.parameter_unit(name)
            if a == b or abs(a - b) <= tolerance.of(name, unit, max(abs(a), abs(b))):
                continue
        elif a == b:
            continue
        yield Change("value", name, *(_value(trace, name) for trace in (first, second)))


def _value(trace: Trace, name: str) -> str:
    return trace.parameter_text(name) if name in trace.parameters else "missing"


def _status(first: Trace, second: Trace) -> Iterator[Change]:
    for name in ("status", "ended_by"):
        a, b = (str(trace.attributes.get(name, "")) or "-" for trace in (first, second))
        if a != b:
            yield Change("run", name.replace("_", " "), a, b)


def _notes(first: Trace, second: Trace) -> Iterator[str]:
    """Yield other differences, which may explain those of the signals."""
    mine, others = (trace.attributes for trace in (first, second))
    common = sorted(name for name in mine if name.startswith("fmu_") and name in others)
    for name in (*PROVENANCE, *(name for name in common if name.endswith("_version"))):
        a, b = (str(each.get(name, "none")) for each in (mine, others))
        if a != b:
            yield f"{name.replace('_', ' ')}: {a} and {b}"
    hashes = [name for name in common if name.endswith("_sha256")]
    if changed := [name[4:-7] for name in hashes if mine[name] != others[name]]:
        yield f"the files of these FMUs differ: {listed(changed)}"
