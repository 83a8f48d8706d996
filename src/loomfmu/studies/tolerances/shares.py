"""The shares of looms in which claims hold: as data, and in words."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from ...display import notebook, printed
from ...display.printed import say
from ..fitting.measured import Floats
from .distributions import Distribution

CONFIDENCE = 0.95
HEADINGS = ("claim", "holds in", "95 % interval", "undecided in")
ALL = "all claims"


@dataclass(frozen=True)
class Share:
    """The share of looms in which a claim, or all of them, hold: so many, and so many undecided, `of` all.

    The looms are drawn independently, so the true share lies from `low` to `high` with a probability of 95 %
    at least: the interval of Clopper and Pearson. Undecided looms count as failing for its lower end, and as
    holding for its upper one.
    """

    claim: str
    holding: int
    undecided: int
    of: int

    @property
    def share(self) -> float:
        """The share of the looms that were drawn."""
        return self.holding / self.of

    @property
    def low(self) -> float:
        """Lower end of the interval."""
        return _interval(self.holding, self.of)[0]

    @property
    def high(self) -> float:
        """Upper end of the interval."""
        return _interval(self.holding + self.undecided, self.of)[1]


def _interval(count: int, of: int) -> tuple[float, float]:
    from scipy.stats import binomtest

    found = binomtest(count, of).proportion_ci(CONFIDENCE, "exact")
    return float(found.low), float(found.high)


@dataclass(frozen=True, repr=False)
class Shares:
    """The shares of looms in which claims hold; true if that of all claims is at least the one asked for.

    It is so for certain at 95 %: the lower end of its interval counts. Without one it is true if all claims
    hold in all looms that were drawn. `values` are those that were drawn (SI), by their keys, `words` the
    verdicts: a row for each loom, a column for each claim.
    """

    title: str
    distributions: tuple[Distribution, ...]
    all: Share
    claims: tuple[Share, ...]
    seed: int
    asked: float | None
    values: dict[str, Floats]
    words: Any
    warnings: tuple[str, ...] = field(default=())

    def __bool__(self) -> bool:
        return self.all.holding == self.all.of if self.asked is None else self.all.low >= self.asked

    def __repr__(self) -> str:
        return notebook.warned(f"<Shares of {self.title}: {_sentence(self)}>", self.warnings)

    def _repr_html_(self) -> str:
        parts = notebook.table(HEADINGS, rows(self)), notebook.line(_sentence(self))
        return notebook.block(self.title, *parts, warnings=self.warnings)


def show(found: Shares) -> None:
    """Print the shares."""
    say(f"{found.title}: {found.all.of} looms with")
    say(*(f"  {each.key} {each.text}" for each in found.distributions))
    table = rows(found)
    entries = [
        (
            f"{claim}:",
            f"{holds} of the looms hold,",
            f"{interval}",
            *([f"({open_} undecided)"] if open_ != "-" else []),
        )
        for claim, holds, interval, open_ in table
    ]
    printed.show(HEADINGS, table, entries)
    say(_sentence(found), f"drawn with seed {found.seed}; the interval is that of the drawing alone")


def rows(found: Shares) -> list[tuple[str, ...]]:
    """A row of the table for all claims, and for each."""
    return [
        (
            each.claim,
            _percent(each.share),
            _interval_text(each),
            _percent(each.undecided / each.of) if each.undecided else "-",
        )
        for each in (found.all, *found.claims)
    ]


def _percent(share: float) -> str:
    return f"{100.0 * share:.4g} %"


def _interval_text(share: Share) -> str:
    """The interval as text, rounded outwards."""
    low, high = math.floor(1e4 * share.low) / 1e4, math.ceil(1e4 * share.high) / 1e4
    return f"{_percent(low)} to {_percent(high)}"


def _sentence(found: Shares) -> str:
    """The outcome in a sentence."""
    whole = found.all
    said = f"All claims hold in {_percent(whole.share)} of {whole.of} looms"
    said += f", with 95 % confidence in {_interval_text(whole)} of all"
    if found.asked is None:
        return f"{said}."
    return f"{said}; at least {_percent(found.asked)} {'is' if found else 'is not'} shown."
