"""Sensitivity: which of the values that vary matter, by the indices of Sobol or of Morris.

A sweep file with `[sensitivity]` runs the rows that the method needs; SALib chooses them and computes the
indices from the table.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import units
from ..display import notebook
from ..errors import LoomfmuError, shown, suggestion
from ..extras import need
from .axes import Axis, Range, whole

Floats = NDArray[np.float64]
METHODS = ("sobol", "morris")
OPTIONS = ("method", "samples", "seed", "outputs")
MOST = 100_000  # samples
LEVELS = 4  # of Morris's grid
LITTLE = 0.005  # of the largest index: less is not worth a line
SAME = 1e-9  # of the largest value: an output that varies less does not depend on what varies
IDLE = 1e-12  # of the largest index: a range with less changes nothing
# what the indices are called, the leading one first, each with its 95 % interval if it has one
INDICES = {
    "sobol": (("S1", "S1_conf"), ("ST", "ST_conf")),
    "morris": (("mu_star", "mu_star_conf"), ("sigma", ""), ("mu", "")),
}
WORDS = {
    "S1": "share of the variance by it alone",
    "ST": "share of the variance with its interactions",
    "mu_star": "mean change over its range",
    "sigma": "spread of that change",
    "mu": "signed mean",
}


@dataclass(frozen=True)
class Sensitivity:
    """A `[sensitivity]` table; `outputs` are columns of the table of results."""

    method: str
    samples: int
    seed: int
    ranges: tuple[Range, ...]
    outputs: tuple[str, ...]

    def axes(self) -> list[Axis]:
        """The rows that the method needs, as a sample."""
        sampler = _salib("sample", self.method)
        given: dict[str, Any] = {"seed": self.seed}
        given |= {"calc_second_order": False} if self.method == "sobol" else {"num_levels": LEVELS}
        shares = sampler.sample(self._problem, self.samples, **given)
        return [each.sampled(column) for each, column in zip(self.ranges, shares.T, strict=True)]

    def indices(self, values: Floats, shares: Floats) -> dict[str, Floats]:
        """The indices of an output: by name, a number for each range."""
        analysis = _salib("analyze", self.method)
        if self.method == "sobol":
            found = analysis.analyze(self._problem, values, calc_second_order=False, seed=self.seed)
        else:
            found = analysis.analyze(self._problem, shares, values, num_levels=LEVELS, seed=self.seed)
        names = [name for pair in INDICES[self.method] for name in pair if name]
        return {name: np.asarray(found[name], dtype=np.float64) for name in names}

    @property
    def _problem(self) -> dict[str, Any]:
        size = len(self.ranges)
        return {"num_vars": size, "names": [each.key for each in self.ranges], "bounds": [[0.0, 1.0]] * size}


def _salib(part: str, method: str) -> Any:
    need("[sensitivity]", "study")
    return import_module(f"SALib.{part}.{method}")


def sensitivity_of(options: dict[str, Any], ranges: Sequence[Range], columns: Sequence[str]) -> Sensitivity:
    """Return the `[sensitivity]` table, checked. Raises LoomfmuError."""
    method = options.get("method", METHODS[0])
    if method not in METHODS:
        raise LoomfmuError(
            f"sensitivity.method = {shown(method)} is unknown{suggestion(str(method), METHODS)}"
        )
    samples = whole(options.get("samples"), "sensitivity.samples", 4, MOST)
    if method == "sobol" and samples & (samples - 1):
        near = 2 ** math.ceil(math.log2(samples))
        raise LoomfmuError(f"sensitivity.samples = {samples} must be a power of 2 for sobol, such as {near}")
    if len(ranges) < 2:
        raise LoomfmuError(
            'sensitivity needs two ranges or more, such as "belt.guide_clearance" = ["0.2 mm", "1 mm"]'
        )
    usual = [name for name in columns if not name.endswith(".worst")]
    outputs = options.get("outputs", usual)
    if not isinstance(outputs, list) or not outputs:
        raise LoomfmuError(
            f'sensitivity.outputs = {shown(outputs)} is not a list such as ["claim_1.distance"]'
        )
    for name in outputs:
        if name not in columns:
            hint = suggestion(str(name), columns)
            raise LoomfmuError(f"sensitivity.outputs: {shown(name)} is not a column of results{hint}")
    seed = whole(options.get("seed", 1), "sensitivity.seed", 0, 2**32 - 1)
    return Sensitivity(method, samples, seed, tuple(ranges), tuple(outputs))


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
    field = table.schema.field(name)
    about = {key.decode(): text.decode() for key, text in (field.metadata or {}).items()}
    unit, display = about.get("unit", "1"), about.get("display_unit", "1")
    label = unit if display == "1" else display
    words = f"distance of {about.get('description', name)}" if name.endswith(".distance") else name
    values = np.array(table[name].cast("float64").to_numpy(zero_copy_only=False), dtype=np.float64)
    values = values / units.unit(display).factor
    keys = tuple(each.key for each in wanted.ranges)
    missing = int(np.sum(~np.isfinite(values)))
    note = ""
    if missing:
        note = f"no indices: no value in {missing} of {len(values)} rows"
    elif np.ptp(values) <= SAME * np.max(np.abs(values)):
        note = "depends on none of them"
    return Influence(name, words, label, keys, {} if note else wanted.indices(values, shares), note)
