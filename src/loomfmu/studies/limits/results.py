"""The limits found: as data, and in words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from ...display import notebook
from ...display.printed import rounded
from ...errors import listed
from ...traces import Verdict
from ..span import Span

HEADINGS = ("claim", "holds", "limits", "distance at the scene's value")
SAME_EVERYWHERE = "does not depend on"  # the variable


@dataclass(frozen=True)
class Limit:
    """A value of the variable at which a claim begins to fail, or to hold, as the variable rises (SI).

    The claim changes between `low` and `high`. If it `jumps`, its distance does not pass 0 there: it counts,
    or has no value on one side. `error` is what the numerical error of the claim makes of the value:
    infinite where that is unknown, and `doubt` says why; NaN for a jump. `unsettled` says what a longer run
    gives there if it comes beyond the bound.
    """

    value: float
    low: float
    high: float
    begins: str
    jumps: bool
    error: float = math.nan
    doubt: str = ""
    unsettled: str = ""


@dataclass(frozen=True)
class Stretch:
    """A range in which claims hold (SI), and the claims that fail first beyond its ends.

    Empty texts where it ends with the range that was searched.
    """

    low: float
    high: float
    below: str = ""
    above: str = ""


@dataclass(frozen=True)
class ProvenRange:
    """A range in which a claim is proven (SI), and the nearest values beyond it at which a run failed.

    These are NaN where the range ends with the one that was searched, or none was found.
    """

    low: float
    high: float
    fails_below: float = math.nan
    fails_above: float = math.nan


@dataclass(frozen=True)
class ClaimLimits:
    """The limits of one claim, ascending, and the ranges in which it holds.

    `points` are the values that were tried and the distances there, NaN where the claim fails without one.
    `depends` is false if the distance is the same everywhere. `verdict` is the one at the scene's own value.
    `doubts` are values about which a range is left out, since numerical errors leave the claim undecided
    there, and why. `proven` are the ranges that are proven for all shaft angles, if that was asked for, and
    `unproven` says why one is not.
    """

    claim: str
    limits: tuple[Limit, ...]
    ranges: tuple[Stretch, ...]
    depends: bool
    verdict: Verdict
    points: tuple[tuple[float, float], ...] = field(repr=False)
    doubts: tuple[tuple[float, str], ...] = ()
    proven: tuple[ProvenRange, ...] = ()
    unproven: str = ""


@dataclass(frozen=True, repr=False)
class Limits:
    """The range of a variable for each claim and for all; true if all claims hold in some range.

    `ranges` are those in which all claims hold. An interval narrower than `resolution` in which a claim fails
    or holds may be missed, unless its distance shows an extreme near 0. Values are in SI.
    """

    title: str
    span: Span
    resolution: float
    claims: tuple[ClaimLimits, ...]
    ranges: tuple[Stretch, ...]
    runs: int
    warnings: tuple[str, ...] = ()
    proved: bool = False
    """True if proofs were asked for."""

    def __bool__(self) -> bool:
        return bool(self.ranges)

    @property
    def depends(self) -> bool:
        """Return whether any claim depends on the variable."""
        return any(each.depends for each in self.claims)

    def __str__(self) -> str:
        return " ".join(conclusion(self))

    def __repr__(self) -> str:
        return notebook.warned(f"<Limits {self.span.key} of {self.title}: {self}>", self.warnings)

    def _repr_html_(self) -> str:
        table = notebook.table(HEADINGS, rows(self))
        lines = (*conclusion(self), *(proofs(self) if self.proved else ()))
        return notebook.block(self.title, table, *map(notebook.line, lines), warnings=self.warnings)


@dataclass(frozen=True, repr=False)
class Boundary:
    """The limits of one variable for each value of another; true if all claims hold somewhere.

    `values` are those of the second variable, `second`, in SI; `rows` are the limits there.
    """

    title: str
    first: Span
    second: Span
    values: tuple[float, ...]
    rows: tuple[Limits, ...]

    def __bool__(self) -> bool:
        return any(self.rows)

    @property
    def warnings(self) -> tuple[str, ...]:
        """The warnings of the scene and of the ranges."""
        found = (*self.second.doubts, *(each for row in self.rows for each in row.warnings))
        return tuple(dict.fromkeys(found))

    def __repr__(self) -> str:
        varied = f"{self.first.key} at {len(self.rows)} values of {self.second.key}"
        return notebook.warned(f"<Boundary of {self.title}: {varied}>", self.warnings)

    def _repr_html_(self) -> str:
        table = notebook.table(boundary_headings(self), boundary_rows(self))
        return notebook.block(self.title, table, warnings=self.warnings)


# ---- in words


def rows(found: Limits) -> list[tuple[str, str, str, str]]:
    """A row of the table for each claim, below `HEADINGS`."""
    return [
        (each.claim, _holds(each, found.span), _limits(each, found.span), _own(each)) for each in found.claims
    ]


def _own(each: ClaimLimits) -> str:
    """Return the distance of a claim from its bound at the scene's own value, in words."""
    distance = each.verdict.shown_distance
    word = "fails" if each.verdict.decided else each.verdict.word
    return f"{word}: {each.verdict.note or 'no value'}" if distance == "-" else distance


def _holds(each: ClaimLimits, span: Span) -> str:
    """Return the ranges in which a claim holds, in words."""
    if not each.ranges:
        return "nowhere for sure" if each.doubts else "nowhere"
    if not (each.limits or each.doubts):
        return "everywhere"
    return ", ".join(_range(stretch, span) for stretch in each.ranges)


def _range(stretch: Stretch, span: Span) -> str:
    """A range in short: open where it ends with what was searched."""
    if stretch.low == span.low:
        return f"up to {span.show(stretch.high, -1.0)}"
    if stretch.high == span.high:
        return f"from {span.show(stretch.low, 1.0)}"
    return f"{span.number(stretch.low, 1.0)} to {span.show(stretch.high, -1.0)}"


def _limits(each: ClaimLimits, span: Span) -> str:
    """The limits of a claim."""
    if not each.depends:
        return f"{SAME_EVERYWHERE} {span.key}"
    return (
        ", ".join(
            f"jumps at {span.number(limit.value)}" if limit.jumps else span.number(limit.value)
            for limit in each.limits
        )
        or "-"
    )


def conclusion(found: Limits) -> Iterator[str]:
    """Yield the conclusion, in sentences."""
    span = found.span
    if not found.depends:
        yield f"No claim depends on {span.key} between {span.number(span.low)} and {span.show(span.high)}."
    for stretch in found.ranges:
        yield _sentence(stretch, found)
    if not found.ranges:
        never = [each for each in found.claims if not each.ranges]
        sure = " for sure" if any(each.doubts for each in never) else ""
        verb = f"hold{'s' * (len(never) == 1)} nowhere{sure}"
        why = f": {_names([each.claim for each in never])} {verb}" if never else ""
        yield f"There is no value from {span.text} at which all claims hold{why}."
    if any(limit.jumps for each in found.claims for limit in each.limits):
        yield 'Where a claim "jumps", it counts something, or is undecided or without a value on one side.'
    yield from unsettled(found)
    for each in found.claims:
        yield from (
            f"At {span.show(value)} '{each.claim}' is undecided: {why}." for value, why in each.doubts
        )
    own = [
        f"{_names(names)} {one if len(names) == 1 else several}"
        for decided, one, several in ((True, "fails", "fail"), (False, "is undecided", "are undecided"))
        if (names := [e.claim for e in found.claims if not e.verdict and e.verdict.decided == decided])
    ]
    if own:
        yield f"At the scene's own value, {span.show(span.value)}, {' and '.join(own)}."
    if not span.low <= span.value <= span.high:
        yield f"The scene's own value, {span.show(span.value)}, is outside the range that was searched."


def unsettled(found: Limits) -> Iterator[str]:
    """Yield a sentence for each claim whose limits are those of a run that is too short."""
    for each in found.claims:
        known = [
            *((limit.value, limit.unsettled) for limit in each.limits),
            (found.span.value, each.verdict.unsettled),
        ]
        if first := next(((value, why) for value, why in known if why), None):
            value, why = first
            yield f"At {found.span.show(value)} '{each.claim}' is {why}; its limits are of the shorter one."


def proofs(found: Limits) -> Iterator[str]:
    """Yield a sentence for each claim: where it is proven for all shaft angles, and what fails beyond."""
    for each in found.claims:
        for part in each.proven:
            yield f"proven: {each.claim}, {_proven(part, found.span)}"
        if each.unproven or not each.proven:
            yield f"not proven: {each.claim} ({each.unproven or 'it holds nowhere'})"


def _proven(part: ProvenRange, span: Span) -> str:
    """A proven range, rounded inwards unless it ends with what was searched, and where runs fail."""
    low, high = map(span.exact_number, (part.low, part.high))
    if part.low != span.low:
        low = rounded(part.low / span.factor, up=True)
    if part.high != span.high:
        high = rounded(part.high / span.factor, up=False)
    beyond = ((part.fails_below, False), (part.fails_above, True))
    fails = [rounded(value / span.factor, up) for value, up in beyond if math.isfinite(value)]
    unit = "" if span.unit == "1" else f" {span.unit}"
    return f"from {low} to {high}{unit}" + (f"; it fails at {listed(fails)}{unit}" if fails else "")


def _sentence(stretch: Stretch, found: Limits) -> str:
    """Return what holds in a range, and which claims end it: by failing, or by being undecided."""
    span, limits = found.span, {limit.value for each in found.claims for limit in each.limits}
    text = f"All claims hold from {span.number(stretch.low, 1.0)} to {span.show(stretch.high, -1.0)}"
    ends = [
        f"'{claim}' {way} this range"
        for way, claim in (("below", stretch.below), ("above", stretch.above))
        if claim
    ]
    edges = [edge for edge, claim in ((stretch.low, stretch.below), (stretch.high, stretch.above)) if claim]
    first = "to fail" if limits.issuperset(edges) else "that is not sure to hold"
    return f"{text}. The first {first} is {' and '.join(ends)}." if ends else f"{text}, the whole range."


def _names(claims: Sequence[str]) -> str:
    return listed(f"'{each}'" for each in claims)


def boundary_headings(found: Boundary) -> tuple[str, ...]:
    """The headings of the table of a boundary."""
    return f"{found.second.key} [{found.second.unit}]", f"all claims hold, {found.first.key}", "binding"


def boundary_rows(found: Boundary) -> list[tuple[str, str, str]]:
    """A row for each range in which all claims hold, and one where none does."""
    listed = []
    for value, limits in zip(found.values, found.rows, strict=True):
        place = found.second.number(value)
        for stretch in limits.ranges:
            whole = f"{found.first.number(stretch.low, 1.0)} to {found.first.show(stretch.high, -1.0)}"
            binding = " / ".join(filter(None, dict.fromkeys((stretch.below, stretch.above))))
            listed.append((place, whole, binding or "-"))
        if not limits.ranges:
            listed.append(
                (place, "nowhere", _names([each.claim for each in limits.claims if not each.ranges]) or "-")
            )
    return listed
