"""The worst cases found: as data, and in words."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from ...display import notebook
from ...display.printed import rounded
from ...errors import listed
from ...traces import Verdict
from ..proving.proofs import IMPOSSIBLE, OPEN
from ..span import Span

SAME = 1e-9  # of the bound: distances that differ less are the same
HEADINGS = ("verdict", "claim", "in the scene", "worst case", "where", "what it costs")


@dataclass(frozen=True)
class Cost:
    """The cost of a tolerance for a claim: the distance from the bound that it takes, at the scene's own
    value.
    """

    key: str
    distance: float


@dataclass(frozen=True)
class WorstCase:
    """The worst that was found of a claim: its verdict there, and the values (SI) by their keys.

    `own` is the verdict with the scene's values; `costs` are the tolerances that cost something, the most
    expensive first. `depends` is false if the distance is the same everywhere.
    """

    claim: str
    own: Verdict
    worst: Verdict
    place: dict[str, float]
    costs: tuple[Cost, ...]
    depends: bool

    @property
    def shared(self) -> bool:
        """Return whether it is worse than the scene even with any one value as in the scene."""
        lost = self.own.distance - self.worst.distance
        return not self.costs and lost > SAME * abs(self.worst.bound)


@dataclass(frozen=True)
class ProvenCase:
    """The proof of a worst case: its `status`, and why.

    The distance from the bound is from `low` to `high` in the worst case; NaN where only the status is known.
    """

    status: str
    why: str = ""
    low: float = math.nan
    high: float = math.nan


@dataclass(frozen=True, repr=False)
class Tolerances:
    """The worst cases of a scene's claims; true if each claim holds in its own. A search, not a proof.

    `proofs` are what is proven of each, if that was asked for.
    """

    title: str
    spans: tuple[Span, ...]
    claims: tuple[WorstCase, ...]
    runs: int
    warnings: tuple[str, ...] = ()
    proofs: tuple[ProvenCase, ...] = ()

    def __bool__(self) -> bool:
        return all(each.worst for each in self.claims)

    def __repr__(self) -> str:
        failing = sum(not each.worst for each in self.claims)
        outcome = f"{failing} of {len(self.claims)} claims fail in their worst case"
        return notebook.warned(f"<Tolerances of {self.title}: {outcome}>", self.warnings)

    def _repr_html_(self) -> str:
        table = notebook.table(HEADINGS, rows(self))
        lines = map(notebook.line, (*unsettled(self), *proofs(self)))
        return notebook.block(self.title, table, *lines, warnings=self.warnings)


def rows(found: Tolerances) -> list[tuple[str, ...]]:
    """A row of the table for each claim, below `HEADINGS`: distances from the bound."""
    return [
        (
            each.worst.word,
            each.claim,
            each.own.shown_distance,
            each.worst.shown_distance,
            _where(each, found),
            _costs(each),
        )
        for each in found.claims
    ]


def unsettled(found: Tolerances) -> Iterator[str]:
    """Yield a sentence for each claim whose worst case a longer run would make worse."""
    for each in found.claims:
        if each.worst.unsettled:
            yield f"In its worst case '{each.claim}' is {each.worst.unsettled}."


def proofs(found: Tolerances) -> Iterator[str]:
    """Yield a sentence for each claim of which something is proven, or why nothing is."""
    for case, proof in zip(found.claims, found.proofs, strict=bool(found.proofs)):
        status = "not proven" if proof.status in (OPEN, IMPOSSIBLE) else proof.status
        worst = case.worst
        unit = "" if worst.label == "1" else f" {worst.label}"
        low, high = (
            rounded(worst.displayed(end), up) for end, up in ((proof.low, False), (proof.high, True))
        )
        known = f", in the worst case {low} to {high}{unit} from its bound" * math.isfinite(proof.low)
        yield f"{status}: {case.claim}{known}" + (f" ({proof.why})" if proof.why else "")


def _where(each: WorstCase, found: Tolerances) -> str:
    """The values that make it the worst case."""
    if not each.depends:
        return "the same everywhere"
    matter = {cost.key for cost in each.costs} or (each.place if each.shared else ())
    places = [f"{span.key} = {span.show(each.place[span.key])}" for span in found.spans if span.key in matter]
    return ", ".join(places) or f"worst at the scene's own value{'s' * (len(found.spans) > 1)}"


def _costs(each: WorstCase) -> str:
    """Return the cost of each tolerance in words, the most expensive first."""
    if each.shared:
        return "cost: none alone; it is as bad without any one of them"
    if not each.costs:
        return "cost: none"
    bound = abs(each.worst.bound)
    parts = []
    for cost in each.costs:
        share = f"{100.0 * cost.distance / bound:.3g} %" if bound else each.worst.shown(cost.distance)
        parts.append(f"{share} from {cost.key}")
    return f"cost: {listed(parts)}"
