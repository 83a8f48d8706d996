"""Limits proven: each range in which a claim holds, proven up to its ends, and runs that fail beyond."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

from ...cosim.prepared import Prepared
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
        ranges = tuple(each for stretch in claim.ranges for each in prover.ranges(stretch, claim))
        claims.append(replace(claim, proven=ranges, unproven=prover.reason))
    return replace(found, claims=tuple(claims), proved=True)


@dataclass
class _Prover:
    """Proves one claim, counted from 0, between values of the variable."""

    loom: Prepared
    span: Span
    number: int
    reason: str = ""
    """Why a range is not proven."""

    def ranges(self, stretch: Stretch, claim: ClaimLimits) -> Iterator[ProvenRange]:
        """Yield what is proven of a range: no more than one."""
        limits = {each.value: each for each in claim.limits}
        below, above = limits.get(stretch.low), limits.get(stretch.high)
        away = AWAY * (stretch.high - stretch.low)
        inside = stretch.low + away * bool(below), stretch.high - away * bool(above)
        if not self._proven(*inside, MOST):
            return
        low, high = (
            end if limit is None else self._extended(end, limit.value)
            for end, limit in zip(inside, (below, above), strict=True)
        )
        yield ProvenRange(low, high, self._failing(below, -1.0), self._failing(above, 1.0))

    def _proven(self, low: float, high: float, boxes: int) -> bool:
        search = Search(self.loom, [replace(self.span, low=low, high=high)], boxes)
        proof = search.proof(self.number, "")
        if not proof:
            self.reason = self.reason or (proof.why if proof.why else proof.status)
        return bool(proof)

    def _extended(self, end: float, limit: float) -> float:
        """Return the value up to which it is proven, from an end of the proven range towards a limit."""
        reason = self.reason
        while abs(limit - end) > CLOSEST * abs(limit):
            further = limit + CLOSER * (end - limit)
            if not self._proven(min(end, further), max(end, further), FEW):
                break
            end = further
        self.reason = reason
        return end

    def _failing(self, limit: Limit | None, direction: float) -> float:
        """Return a value near beyond a limit at which a run fails, NaN where there is none."""
        if limit is None:
            return math.nan
        search = Search(self.loom, [self.span], FEW)
        ends = (limit.low, limit.high)
        value = max(ends) if direction > 0.0 else min(ends)
        step = direction * max(limit.error if limit.error < math.inf else 0.0, 1e-10 * abs(limit.value))
        while self.span.low <= value <= self.span.high:
            if search.fails(self.number, {self.span.key: value}):
                return value
            value, step = value + step, 2.0 * step
        return math.nan
