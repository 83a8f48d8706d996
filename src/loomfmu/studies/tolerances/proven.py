"""Worst cases proven: for all shaft angles and all values within the tolerances."""

from collections.abc import Sequence

from ...cosim.prepared import Prepared
from ..proving.proofs import OPEN, PROVEN, REFUTED, Proof
from ..proving.prove import check_sides
from ..proving.search import Search
from ..span import Span
from .results import ProvenCase, WorstCase

WIDTH = 1e-6  # of the bound: so wide may the enclosure of a worst case be


def proven(loom: Prepared, spans: Sequence[Span], cases: Sequence[WorstCase]) -> tuple[ProvenCase, ...]:
    """Return what is proven of each worst case. Raises LoomfmuError for what cannot vary in a proof."""
    check_sides(loom.scene, spans)
    search = Search(loom, spans)
    return tuple(_proven(search, *each) for each in enumerate(cases))


def _proven(search: Search, number: int, case: WorstCase) -> ProvenCase:
    """The enclosure of a worst case, or, for a claim that has none, its proof."""
    worst = case.worst
    found = search.lowest_distance(number, WIDTH * (abs(worst.bound) or abs(worst.distance)))
    if found is None:
        proof: Proof = search.proof(number, case.claim)
        return ProvenCase(proof.status, proof.why)
    return ProvenCase(PROVEN if found[0] >= 0.0 else REFUTED if found[1] < 0.0 else OPEN, "", *found)
