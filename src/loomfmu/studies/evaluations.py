"""A prepared scene as a function of what is varied."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from ..cosim.prepared import Errors, Prepared
from ..cosim.results import Evaluation
from ..errors import LoomfmuError
from ..traces import Verdict
from .span import Span


class Evaluations:
    """The verdicts of a prepared scene at values of its `spans`, each place run once.

    `fixed` are values that stay, as `Prepared.evaluate` takes them; `warnings` are those of the first run.
    """

    def __init__(self, loom: Prepared, spans: Sequence[Span], fixed: Mapping[str, Any] | None = None):
        self._loom, self._spans, self._fixed = loom, tuple(spans), dict(fixed or {})
        self._verdicts: dict[tuple[float, ...], tuple[Verdict, ...]] = {}
        self._near: dict[tuple[float, ...], frozenset[int]] = {}
        self._estimated: dict[tuple[float, ...], tuple[Verdict, ...]] = {}
        self.warnings: tuple[str, ...] = ()

    def __len__(self) -> int:
        """Return the number of runs."""
        return len(self._verdicts)

    def at(self, *values: float) -> tuple[Verdict, ...]:
        """The verdicts at values in SI, one for each span. Raises LoomfmuError that names them."""
        if values not in self._verdicts:
            found = self._evaluated(values, "none")
            self._verdicts[values], self._near[values] = found.claims, found.near
        return self._verdicts[values]

    def near(self, *values: float) -> frozenset[int]:
        """The claims, counted from 0, that are so near their bounds that a numerical error may matter."""
        self.at(*values)
        return self._near[values]

    def estimated(self, *values: float) -> tuple[Verdict, ...]:
        """The same with their numerical errors, which takes further runs."""
        if values not in self._estimated:
            self._estimated[values] = self._evaluated(values, "all").claims
        return self._estimated[values]

    def _evaluated(self, values: Sequence[float], errors: Errors) -> Evaluation:
        settings = dict(self._fixed)
        for span, value in zip(self._spans, values, strict=True):
            settings |= span.setting(value)
        try:
            found = self._loom.evaluate(settings, errors=errors)
            found.check_end()
        except LoomfmuError as error:
            raise self._named(values, str(error)) from None
        if not self._verdicts:
            self.warnings = found.warnings
        return found

    def _named(self, values: Sequence[float], error: str) -> LoomfmuError:
        shown = zip(self._spans, values, strict=True)
        where = ", ".join(f"{span.key} = {span.show(value)}" for span, value in shown)
        return LoomfmuError(error if error.startswith(where) else f"{where}: {error}")
