"""Limits proven: each range in which a claim holds, proven up to its ends, and runs that fail beyond."""

import math
from dataclasses import dataclass, replace

from ...cosim.prepared import Prepared
from ..proving.proofs import Proof
from ..proving.prove import check_sides
from ..proving.search import MOST, Search
from ..span import Span
from .results import ClaimLimits, Limit, Limits, ProvenRange, Stretch

AWAY = 1 / 128  # of the range: so far from its limits it is proven at once
CLOSER = 1 / 4  # of the rest up to a limit that a further proof leaves
CLOSEST = 1e-10  # of the limit
FEW = MOST // 20  # boxes for one of these proofs


def proven(loom: Prepared, found: Limits) -> Limits:
    """Return limits with what is proven of each claim. Raises LoomfmuError if the variable is none for it."""
    check_sides(loom.scene, [found.span])
    claims = []
    for number, claim in enumerate(found.claims):
        prover = _Prover(loom, found.span, number)
        parts = [prover.part(stretch, claim) for stretch in claim.ranges]
        ranges = tuple(each for each in parts if isinstance(each, ProvenRange))
        reason = next((each for each in parts if isinstance(each, str)), "")
        claims.append(replace(claim, proven=ranges, unproven=reason))
    return replace(found, claims=tuple(claims), proved=True)


@dataclass(frozen=True)
class _Prover:
    """Proves one claim, counted from 0, between values of the variable."""

    loom: Prepared
    span: Span
    number: int

    def part(self, stretch: Stretch, claim: ClaimLimits) -> ProvenRange | str:
        """Return what is proven of a range, or why nothing is."""
        limits = {each.value: each for each in claim.limits}
        below, above = limits.get(stretch.low), limits.get(stretch.high)
        away = AWAY * (stretch.high - stretch.low)
        inside = stretch.low + away * bool(below), stretch.high - away * bool(above)
        proof = self._proof(*inside, MOST)
        if not proof:
            return proof.why or proof.status
        low, high = (
            end if limit is None else self._extended(end, limit.value)
            for end, limit in zip(inside, (below, above), strict=True)
        )
        return ProvenRange(low, high, self._failing(below, -1.0), self._failing(above, 1.0))

    def _proof(self, low: float, high: float, boxes: int) -> Proof:
        return Search(self.loom, [replace(self.span, low=low, high=high)], boxes).proof(self.number, "")

    def _extended(self, end: float, limit: float) -> float:
        """Return the value up to which it is proven, from an end of the proven range towards a limit."""
        while abs(limit - end) > CLOSEST * abs(limit):
            further = limit + CLOSER * (end - limit)
            if not self._proof(min(end, further), max(end, further), FEW):
                break
            end = further
        return end

    def _failing(self, limit: Limit | None, direction: float) -> float:
        """Return a value near beyond a limit at which a run fails, NaN where there is none."""
        if limit is None:
            return math.nan
        search = Search(self.loom, [self.span])
        ends = (limit.low, limit.high)
        value = max(ends) if direction > 0.0 else min(ends)
        step = direction * max(limit.error if limit.error < math.inf else 0.0, 1e-10 * abs(limit.value))
        while self.span.low <= value <= self.span.high:
            if search.fails(self.number, {self.span.key: value}):
                return value
            value, step = value + step, 2.0 * step
        return math.nan
