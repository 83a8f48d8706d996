"""A prepared scene as a function of what is varied."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from ..cosim.many import Rows
from ..cosim.prepared import Errors, Prepared
from ..errors import LoomfmuError
from ..traces import Verdict
from .cases import Case, evaluated, worst
from .span import Span

LOT = 25  # places that are run at once, and seen to be done
Judged = tuple[tuple[Verdict, ...], frozenset[int]]


class Evaluations:
    """The verdicts of a prepared scene at values of its `spans`, each place run once.

    `fixed` are values that stay, as `Prepared.evaluate` takes them; the worst of all `cases` counts, each
    of which takes a run. `warnings` are those of the first run.
    """

    def __init__(
        self,
        loom: Prepared,
        spans: Sequence[Span],
        fixed: Mapping[str, Any] | None = None,
        cases: Sequence[Case] = (Case(""),),
    ):
        self._loom, self._spans, self._fixed = loom, tuple(spans), dict(fixed or {})
        self._cases = tuple(cases)
        self._verdicts: dict[tuple[float, ...], tuple[Verdict, ...]] = {}
        self._near: dict[tuple[float, ...], frozenset[int]] = {}
        self._estimated: dict[tuple[float, ...], tuple[Verdict, ...]] = {}
        self.warnings: tuple[str, ...] = ()

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self._verdicts) * len(self._cases)

    def own(self) -> tuple[Verdict, ...]:
        """The verdicts with the scene's own values, with their numerical errors."""
        return self._judged(self._fixed, "all")[0]

    def at(self, *values: float) -> tuple[Verdict, ...]:
        """The verdicts at values in SI, one for each span. Raises LoomfmuError that names them."""
        if values not in self._verdicts:
            self._verdicts[values], self._near[values] = self._evaluated(values, "none")
        return self._verdicts[values]

    def run_at(self, places: Iterable[tuple[float, ...]]) -> None:
        """Run several places at once, as `at` runs each; it says of one that cannot be run why."""
        left = [values for values in dict.fromkeys(places) if values not in self._verdicts]
        if not left:
            return
        found = {case.name: self._many(left, case) for case in self._cases}
        for place, values in enumerate(left):
            if any(place in each.errors for each in found.values()):
                continue
            if not self._verdicts:
                self.warnings = next(iter(found.values())).warnings(place)
            self._verdicts[values] = worst({name: each.verdicts(place) for name, each in found.items()})
            self._near[values] = frozenset().union(*(each.near(place) for each in found.values()))

    def _many(self, places: Sequence[tuple[float, ...]], case: Case) -> Rows:
        settings = [{**self._settings(values), **case.settings} for values in places]
        columns = {key: [each[key] for each in settings] for key in settings[0]}
        return self._loom.evaluate_many(columns, errors="none")

    def near(self, *values: float) -> frozenset[int]:
        """The claims, counted from 0, that are so near their bounds that a numerical error may matter."""
        self.at(*values)
        return self._near[values]

    def estimated(self, *values: float) -> tuple[Verdict, ...]:
        """The same with their numerical errors, which takes further runs."""
        if values not in self._estimated:
            self._estimated[values] = self._evaluated(values, "all")[0]
        return self._estimated[values]

    def _evaluated(self, values: Sequence[float], errors: Errors) -> Judged:
        try:
            return self._judged(self._settings(values), errors)
        except LoomfmuError as error:
            raise self._named(values, str(error)) from None

    def _settings(self, values: Sequence[float]) -> dict[str, Any]:
        settings = dict(self._fixed)
        for span, value in zip(self._spans, values, strict=True):
            settings |= span.setting(value)
        return settings

    def _judged(self, settings: Mapping[str, Any], errors: Errors) -> Judged:
        """The worst verdicts with some settings, and the claims that are near their bounds in some case."""
        found = {case.name: evaluated(self._loom, case, errors, settings) for case in self._cases}
        if not self._verdicts:
            self.warnings = next(iter(found.values())).warnings
        claims = {name: each.claims for name, each in found.items()}
        return worst(claims), frozenset().union(*(each.near for each in found.values()))

    def _named(self, values: Sequence[float], error: str) -> LoomfmuError:
        shown = zip(self._spans, values, strict=True)
        where = ", ".join(f"{span.key} = {span.show(value)}" for span, value in shown)
        return LoomfmuError(error if error.startswith(where) else f"{where}: {error}")
