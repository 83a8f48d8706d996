"""Indices of a sweep with `[sensitivity]`: how an output depends on each range, as data and bars."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import fill
from typing import Any

import numpy as np

from ..display import notebook
from ..traces.plotting import COLOURS, figure, fixed_style
from .axes import Axis, Range
from .sensitivity import INDICES, Floats, Sensitivity
from .tables import column_of

LITTLE = 0.005  # of the largest index: less is not worth a line
SAME = 1e-9  # of the largest value: an output that varies less does not depend on what varies
IDLE = 1e-12  # of the largest index: a range with less changes nothing
WORDS = {
    "S1": "share of the variance by it alone",
    "ST": "share of the variance with its interactions",
    "mu_star": "mean change over its range",
    "sigma": "spread of that change",
    "mu": "signed mean",
}
WIDTH, LINE, REST = 8.0, 0.27, 0.9  # [in]
LONGEST = 48  # letters of a line of a title
ACROSS = 2  # panels


@dataclass(frozen=True)
class Influence:
    """The influence of each range on an output: `indices` by name, a number for each of `keys`.

    `note` says why there are none. Values of Morris's method are in the unit `label` of the output.
    """

    output: str
    words: str
    label: str
    keys: tuple[str, ...]
    indices: dict[str, Floats]
    note: str = ""


@dataclass(frozen=True, repr=False)
class Influences:
    """The indices of a sweep with `[sensitivity]`, one `Influence` for each output."""

    method: str
    title: str
    outputs: tuple[Influence, ...]

    @property
    def lead(self) -> str:
        """The index that ranks: the total one of Sobol, the mean change of Morris."""
        return "ST" if self.method == "sobol" else "mu_star"

    @property
    def idle(self) -> list[str]:
        """The ranges that change no output at all."""
        known = [each.indices[self.lead] for each in self.outputs if each.indices]
        most = np.max([each / np.max(each) for each in known], axis=0) if known else ()
        return [key for key, share in zip(self.outputs[0].keys, most, strict=bool(known)) if share < IDLE]

    @property
    def brief(self) -> list[tuple[str, str]]:
        """Each output with the leading index of the ranges that matter, the most important one first."""
        return [(each.words, each.note or self._ranked(each)) for each in self.outputs]

    def _ranked(self, each: Influence) -> str:
        values, errors = each.indices[self.lead], each.indices[f"{self.lead}_conf"]
        ranked = [
            place
            for place in np.argsort(-values, kind="stable").tolist()
            if values[place] >= LITTLE * max(values)
        ]
        unit = "" if self.method == "sobol" or each.label == "1" else f" {each.label}"
        return ", ".join(
            f"{each.keys[place]} {values[place]:.3g} ± {errors[place]:.1g}{unit}" for place in ranked
        )

    def __repr__(self) -> str:
        return f"<Influences of {self.title}: {self.method}, {len(self.outputs)} outputs>"

    def _repr_html_(self) -> str:
        return notebook.block(self.title, notebook.table(("output", self.lead), self.brief))


def influences(wanted: Sensitivity, table: Any, axes: Sequence[Axis], title: str) -> Influences:
    """The indices of a sweep's table."""
    shares = np.array([_shares(each, axis) for each, axis in zip(wanted.ranges, axes, strict=True)]).T
    return Influences(
        wanted.method, title, tuple(_influence(wanted, name, table, shares) for name in wanted.outputs)
    )


def csv_rows(found: Influences) -> list[list[str]]:
    """All indices as a table, its headings first."""
    names = [name for pair in INDICES[found.method] for name in pair if name]
    rows = [["output", "unit", "range", *names, "note"]]
    for each in found.outputs:
        for number, key in enumerate(each.keys):
            numbers = [f"{each.indices[name][number]:.9g}" if each.indices else "" for name in names]
            rows.append([each.words, each.label, key, *numbers, each.note])
    return rows


def _shares(span: Range, axis: Axis) -> Floats:
    if axis.varied.kind == "Integer":
        return np.asarray((axis.values - span.low) / (span.high - span.low))
    return np.array([span.share(float(value)) for value in axis.values])


def _influence(wanted: Sensitivity, name: str, table: Any, shares: Floats) -> Influence:
    words, label, values = column_of(table, name)
    words = f"distance of {words}" if re.fullmatch(r"claim_\d+\.distance", name) else name
    keys = tuple(each.key for each in wanted.ranges)
    missing = int(np.sum(~np.isfinite(values)))
    note = ""
    if missing:
        note = f"no indices: no value in {missing} of {len(values)} rows"
    elif np.ptp(values) <= SAME * np.max(np.abs(values)):
        note = "depends on none of them"
    return Influence(name, words, label, keys, {} if note else wanted.indices(values, shares), note)


@fixed_style()
def draw(found: Influences) -> Any:
    """A figure of matplotlib with a panel for each output that has indices."""
    shown = [each for each in found.outputs if each.indices]
    across = min(ACROSS, max(1, len(shown)))
    down = max(1, -(-len(shown) // across))
    height = down * (LINE * len(found.outputs[0].keys) + REST) + 0.6
    drawn = figure((WIDTH, height))
    panels = list(drawn.subplots(down, across, squeeze=False, sharey=True).flat)
    bars = INDICES[found.method][:2]
    for axes, each in zip(panels, shown, strict=False):
        places = np.arange(len(each.keys))
        for number, (name, error) in enumerate(bars):
            axes.barh(
                places + (number - 0.5) * 0.38,
                each.indices[name],
                0.36,
                color=COLOURS[number],
                xerr=each.indices[error] if error else None,
                ecolor="#444444",
                capsize=2,
                label=f"{name}: {WORDS[name]}",
            )
        axes.set_yticks(places, each.keys, fontsize=8)
        axes.set_title(fill(each.words, LONGEST), fontsize=8)
        axes.tick_params(axis="x", labelsize=8)
        axes.grid(axis="x", color="#e0e0e0")
        axes.set_axisbelow(True)
        if found.method == "morris" and each.label != "1":
            axes.set_xlabel(f"[{each.label}]", fontsize=8)
    if shown:
        panels[0].invert_yaxis()
        handles, labels = panels[0].get_legend_handles_labels()
        drawn.legend(handles, labels, loc="outside lower center", ncols=2, frameon=False, fontsize=8)
    for axes in panels[len(shown) :]:
        axes.set_axis_off()
    drawn.suptitle(found.title, fontsize=11)
    return drawn
