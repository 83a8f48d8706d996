"""The result of a run: verdicts, warnings and trace."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ..display import notebook
from ..errors import LoomfmuError
from ..traces import Early, Recording, Signals, Trace, Verdict
from ..traces.verdict import HEADINGS, outcome
from .scenes.headings import heading
from .scenes.scene import Scene


@dataclass(frozen=True, repr=False)
class Judged:
    """A finished run: its verdicts, its warnings, and what it skipped. It is true if all claims hold.

    No run holds that an FMU cut short, though the scene does not allow that with `may_end`.

    `skipped` lists what was not run or not read, and why; `steps` is the number of communication steps.
    `early` says how an FMU ended the run early. `chosen` says which steps were chosen for the scene's
    `accuracy`; it is empty if it has none.
    """

    scene: Scene
    claims: tuple[Verdict, ...]
    warnings: tuple[str, ...]
    skipped: tuple[str, ...]
    steps: int
    early: Early = field(default=Early(), kw_only=True)
    chosen: str = field(default="", kw_only=True)

    @property
    def holds(self) -> bool:
        """Return whether the run was not cut short and every claim holds."""
        return all(self.claims) and not self.early.cut_short

    @property
    def ended(self) -> str:
        """The FMU that ended the run early, and when; empty if none did."""
        return self.early.ended_by

    def check_end(self) -> None:
        """Raise LoomfmuError if an FMU cut the run short: what is left has no value."""
        if self.early.cut_short:
            raise LoomfmuError(f"{self.scene.name}: {self.early.cut_short}")

    def __bool__(self) -> bool:
        return self.holds

    def __repr__(self) -> str:
        failing = [verdict for verdict in self.claims if not verdict]
        summary = f"{outcome(self.claims)}:" if failing else "all claims hold"
        if not self.claims:
            summary = "no claims"
        listed = "".join(f"\n  {verdict}" for verdict in failing)
        return notebook.warned(f"<{type(self).__name__} {self.scene.name}: {summary}{listed}>", self.warnings)

    def _repr_html_(self) -> str:
        summary = (outcome(self.claims) or "all claims hold") if self.claims else "no claims"
        notes = [f"ended by {self.ended}"] * bool(self.ended) + [self.chosen] * bool(self.chosen)
        return notebook.block(
            f"{heading(self.scene)}: {summary}",
            *([notebook.table(HEADINGS, [claim.row for claim in self.claims])] if self.claims else []),
            *map(notebook.line, notes),
            warnings=self.warnings,
        )


class Traced:
    """A run with its trace."""

    trace: Signals

    def to_xarray(self, *signals: str, fold: bool | int = False) -> Any:
        """The signals of the trace, or these alone, as `Trace.to_xarray`."""
        return self.trace.to_xarray(*signals, fold=fold)

    def to_pandas(self, *signals: str) -> Any:
        """The signals of the trace, or these alone, as `Trace.to_pandas`."""
        return self.trace.to_pandas(*signals)


@dataclass(frozen=True, repr=False)
class Result(Judged, Traced):
    """A finished run with its trace on disk: `trace["belt.margin"]` are the signal's values in SI.

    `path` is where the trace was written. `trace` stays that of this run even if another is written there.
    `seconds` is the time that the steps took, the writing of their samples included. `replaced` says when the
    trace that had its name was written; it is empty if there was none.
    """

    path: Path
    trace: Trace = field(repr=False, compare=False)

    def report(self, output: str | Path | None = None, overwrite: bool = False) -> Path:
        """Write a page to look at, beside the trace unless `output` names it, and return its path.

        Raises LoomfmuError as `loomfmu.report.write`, such as for a missing extra `report`.
        """
        from ..report import write

        return write([self.trace], output, overwrite)

    seconds: float = field(default=0.0, kw_only=True, compare=False)
    replaced: str = field(default="", kw_only=True, compare=False)


@dataclass(frozen=True, repr=False)
class Evaluation(Judged, Traced):
    """A finished run with its trace in memory: `trace["belt.margin"]` are the signal's values in SI.

    `measured` has what was to be measured: its number as the worst value, and its error. `near` are the
    claims, counted from 0, that are so near their bounds that a numerical error may matter.
    """

    trace: Recording
    measured: tuple[Verdict, ...] = ()
    near: frozenset[int] = frozenset()
