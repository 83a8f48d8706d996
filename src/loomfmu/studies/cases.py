"""Cases: values under which a scene is run, beside those that a study varies; the worst of them counts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from ..cosim.prepared import Errors, Prepared
from ..cosim.results import Evaluation
from ..errors import LoomfmuError, shown
from ..traces import Verdict
from ..traces.verdict import FAILS, HOLDS, UNDECIDED

MOST = 64  # cases
FROM_BEST = (HOLDS, UNDECIDED, FAILS)


@dataclass(frozen=True)
class Case:
    """A load case: its name, and its settings of the scene; `doubts` warn of their units."""

    name: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    doubts: tuple[str, ...] = ()

    def and_(self, other: Case) -> Case:
        """Both at once."""
        name = ", ".join(filter(None, (self.name, other.name)))
        return Case(name, {**self.settings, **other.settings}, (*self.doubts, *other.doubts))


def evaluated(
    loom: Prepared, case: Case, errors: Errors, settings: Mapping[str, Any] | None = None
) -> Evaluation:
    """Return the evaluation of a scene in a case, with more settings.

    Raises LoomfmuError that names the case.
    """
    try:
        found = loom.evaluate({**(settings or {}), **case.settings}, errors=errors)
        found.check_end()
    except LoomfmuError as error:
        raise LoomfmuError(f"case {shown(case.name)}: {error}" if case.name else str(error)) from None
    return found


def worst(found: Mapping[str, Sequence[Verdict]]) -> tuple[Verdict, ...]:
    """Return the worst verdict on each claim in some cases, by their names, with which its note begins.

    That is one that fails, else an undecided one; of several the nearest to its bound, or farthest beyond.
    """
    named = ([_of_case(name, verdict) for verdict in verdicts] for name, verdicts in found.items())
    return tuple(max(each, key=_badness) for each in zip(*named, strict=True))


def _of_case(name: str, verdict: Verdict) -> Verdict:
    return replace(verdict, note="; ".join(filter(None, (f"case {name}", verdict.note)))) if name else verdict


def _badness(verdict: Verdict) -> tuple[int, float]:
    return FROM_BEST.index(verdict.word), math.inf if math.isnan(verdict.away) else -verdict.away
