"""What the verdicts on random scenes come to: the figures that the validation report shows."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from verdicts.drawing import MANY
from verdicts.judging import Found

from loomfmu.display.printed import as_csv

HEADS = (
    *("family", "claim", "scenes", "verdicts", "false_holds", "false_fails", "wrong_from_1440", "undecided"),
    *("needless", "errors", "too_small", "compared", "median", "most"),
)
FAR = 1000.0  # times the true error: a bound so far away could be decided
HIDDEN = 1e-9  # of value or bound: true errors below it are those of iterations and noise


def table(found: Sequence[Found]) -> str:
    """The text of the file: a row for each family and kind of claim, then those of families, then all."""
    groups: dict[tuple[str, str], list[Found]] = {}
    for each in found:
        kind = each.claim.table["kind"]
        for group in ((each.scene.family, kind), (each.scene.family, ""), ("all", "")):
            groups.setdefault(group, []).append(each)
    order = sorted(groups, key=lambda group: (group[0] == "all", not group[1]))
    return as_csv([HEADS, *([*group, *statistics(groups[group])] for group in order)])


def statistics(group: Sequence[Found]) -> list[str]:
    """Counts of one group, and how large the errors stated are."""
    counted = [each for each in group if each.holds is not None]
    wrong = [each for each in counted if each.wrong]
    first = [each for each in group if each.first and math.isfinite(each.verdict.error)]
    compared = [each for each in first if each.off > each.floor + HIDDEN * abs(each.truth.value)]
    ratios = np.array([each.verdict.error / each.off for each in compared])
    shown = [f"{value:.2g}" for value in np.percentile(ratios, [50, 95])] if len(ratios) else ["-", "-"]
    undecided = [each for each in counted if not each.verdict.decided]
    counts = [
        len({(each.scene.family, each.scene.number) for each in group}),
        len(counted),
        sum(each.wrong == "holds" for each in wrong),
        sum(each.wrong == "FAILS" for each in wrong),
        sum(each.steps >= MANY for each in wrong),
        len(undecided),
        sum(map(needless, undecided)),
        len(first),
        sum(each.too_small for each in first),
        len(compared),
    ]
    return [*map(str, counts), *shown]


def needless(found: Found) -> bool:
    """Whether an undecided verdict is far from its bound, by its true error."""
    away = abs(found.truth.value - found.verdict.bound)
    rounding = HIDDEN * max(abs(found.truth.value), abs(found.verdict.bound))
    return not away <= FAR * max(found.off, found.floor, rounding)


def summary(found: Iterable[Found]) -> str:
    """One line on all of them."""
    values = dict(zip(HEADS[2:], statistics(list(found)), strict=True))
    return ", ".join(f"{count} {name}" for name, count in values.items())
