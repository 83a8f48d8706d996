"""Sensitivity: which of the values that vary matter, by the indices of Sobol or of Morris.

A sweep file with `[sensitivity]` runs the rows that the method needs. SALib chooses them, and computes the
indices that `indices` reads from the table.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import LoomfmuError, shown, suggestion
from ..extras import need
from .axes import Axis, Range, whole

Floats = NDArray[np.float64]
METHODS = ("sobol", "morris")
OPTIONS = ("method", "samples", "seed", "outputs")
MOST = 100_000  # samples
LEVELS = 4  # of Morris's grid
# what the indices are called, the leading one first, each with its 95 % interval if it has one
INDICES = {
    "sobol": (("S1", "S1_conf"), ("ST", "ST_conf")),
    "morris": (("mu_star", "mu_star_conf"), ("sigma", ""), ("mu", "")),
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
