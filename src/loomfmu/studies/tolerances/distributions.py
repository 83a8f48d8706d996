"""Distributions of values: normal, uniform, or as they were measured, from a CSV file."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ... import units
from ...cosim.scenes.notes import check_effect
from ...cosim.scenes.scene import Scene
from ...cosim.scenes.tolerances import ends_of
from ...errors import LoomfmuError, listed, within
from ...sweeps.varied import Keyed, Varied, varied
from ..fitting.measured import Floats, factor_to, named_column, rows_of, values_of
from ..span import port_of

MEASURED = "name the column such as: belt.guide_clearance [mm]"


@dataclass(frozen=True)
class Distribution(Keyed):
    """The distribution of a value: `quantiles` gives the values at shares of all looms, in SI.

    Values `measured` in one file are drawn together, row by row: the shares of these are the same. `ends` are
    the least and the largest value (SI), infinite where there are none; `doubts` warn of their units.
    """

    text: str
    quantiles: Callable[[Floats], Floats]
    ends: tuple[float, float]
    measured: Path | None = None
    doubts: tuple[str, ...] = ()


def distribution_of(scene: Scene, key: str, given: Any) -> Distribution:
    """Read the distribution that a scene states for a value, two ends being a uniform one.

    Raises LoomfmuError for what cannot be varied, or is not such a distribution.
    """
    variable = varied(scene, key)
    port_of(scene, variable)
    check_effect(scene.instances, variable.targets)
    table: Mapping[str, Any] = {"uniform": given} if isinstance(given, tuple) else given
    where = f"tolerances: {key}"
    if "measured" in table:
        return _measured(variable, scene.directory / table["measured"], where)
    numbers = [each for key in ("normal", "uniform", "within") for each in table.get(key, ())]
    doubts = tuple(filter(None, map(variable.doubt, numbers)))
    if "uniform" in table:
        low, high = _ends(variable, table["uniform"], where)
        text = f"uniform, {_range(variable, low, high)}"
        return Distribution(
            variable, text, lambda share: low + share * (high - low), (low, high), None, doubts
        )
    return _normal(variable, table, where, doubts)


def ends_within(scene: Scene, key: str) -> tuple[Any, Any] | None:
    """Return the ends of a tolerance of a scene, as they are stated or else in SI; None if it has none."""
    if (stated := ends_of(scene.tolerances[key])) is not None:
        return stated
    low, high = distribution_of(scene, key, scene.tolerances[key]).ends
    return None if math.isinf(high - low) else (units.Si(low), units.Si(high))


def _ends(variable: Varied, given: Sequence[Any], where: str) -> tuple[float, float]:
    low, high = (float(variable.read(each)) for each in given)
    if not low < high:
        raise LoomfmuError(f"{where}: the range from {given[0]} to {given[1]} is empty")
    return low, high


def _normal(variable: Varied, table: Mapping[str, Any], where: str, doubts: tuple[str, ...]) -> Distribution:
    """A normal distribution, or the part of it within two ends."""
    from scipy.special import ndtr, ndtri

    mean = float(variable.read(table["normal"][0]))
    with within(where):
        deviation = units.parse(table["normal"][1], variable.unit)
    if not 0.0 < deviation < math.inf:
        raise LoomfmuError(f"{where}: the standard deviation {variable.show(deviation)} must be positive")
    text = f"normal, mean {variable.show(mean)}, standard deviation {variable.show(deviation)}"
    low, high = -math.inf, math.inf
    if "within" in table:
        low, high = _ends(variable, table["within"], where)
        if not low <= mean <= high:
            raise LoomfmuError(
                f"{where}: the mean {variable.show(mean)} is not within {_range(variable, low, high)}"
            )
        text += f", within {_range(variable, low, high)}"
    below, above = (float(ndtr((end - mean) / deviation)) for end in (low, high))

    def quantiles(share: Floats) -> Floats:
        found: Floats = np.clip(mean + deviation * ndtri(below + share * (above - below)), low, high)
        return found

    return Distribution(variable, text, quantiles, (low, high), None, doubts)


def _range(variable: Varied, low: float, high: float) -> str:
    return f"{variable.show(low)} to {variable.show(high)}"


def _measured(variable: Varied, path: Path, where: str) -> Distribution:
    """The values of a column of a CSV file, each as likely as any other."""
    heading, *rows = rows_of(path, MEASURED)
    own = {variable.key: variable.shown_unit}
    names = [named_column(heading[0], each, own.get(each.strip(), "")) for each in heading[1]]
    places = [place for place, (name, _unit) in enumerate(names) if name == variable.key]
    if len(places) != 1:
        many = "several columns are" if places else f"it has {listed(name for name, _ in names)}, but none is"
        raise LoomfmuError(f"{where}: {path}: {many} called {variable.key}")
    factor = factor_to(heading[0], variable.key, names[places[0]][1], variable.unit)
    found = values_of(heading[1], rows)[:, places[0]]
    if not len(found) or np.isnan(found).any():
        raise LoomfmuError(f"{where}: {path}: {variable.key} has no value in some row, or there is no row")
    values = np.array([float(variable.read(units.Si(each))) for each in factor * found])
    text = f"as {len(values)} values measured in {path.name}, {_range(variable, values.min(), values.max())}"
    ends = float(values.min()), float(values.max())
    return Distribution(variable, text, lambda share: values[_rows(share, len(values))], ends, path)


def _rows(share: Floats, count: int) -> Any:
    return np.minimum((share * count).astype(int), count - 1)
