"""The picture that a sweep file defines: over which axes, of which column, at which values of the others."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..cosim.scenes.settings import check_table
from ..errors import LoomfmuError, suggestion
from .axes import Axis, flattened
from .varied import Value

KEYS = ("x", "y", "value", "at")
ROUNDING = 1e-9  # of a value that is given once in the grid and once in `at`, perhaps in another unit


@dataclass(frozen=True)
class Map:
    """A column over one axis or two; `at` picks one value of each other axis of the grid."""

    x: str
    y: str | None
    value: str
    at: dict[str, Value] = field(default_factory=dict)


def requested(table: Any, axes: list[Axis], columns: list[str]) -> Map:
    """The picture of a `[map]` table. Raises LoomfmuError for what cannot be drawn."""
    check_table(table, "map", KEYS)
    for key in ("x", "value"):
        if key not in table:
            raise LoomfmuError(f"map has no {key!r}")
    known = {axis.key: axis for axis in axes}
    for key in ("x", "y"):
        if key in table and table[key] not in known:
            raise LoomfmuError(
                f"map.{key} = {table[key]!r} is not an axis{suggestion(str(table[key]), known)}"
            )
    if table["x"] == table.get("y"):
        raise LoomfmuError(f"map.x and map.y are both {table['x']}")
    if table["value"] not in columns:
        shown = f"map.value = {table['value']!r} is not a column of results"
        raise LoomfmuError(f"{shown}{suggestion(str(table['value']), columns)}")
    at = _picked(flattened(table.get("at", {}), "map.at"), known)
    found = Map(table["x"], table.get("y"), table["value"], at)
    _check_settled(found, axes)
    return found


def _picked(at: dict[str, Any], axes: dict[str, Axis]) -> dict[str, Value]:
    """One value of a grid's axis for each key."""
    picked: dict[str, Value] = {}
    for key, given in at.items():
        grid = [name for name, axis in axes.items() if not axis.sampled]
        if key not in grid:
            raise LoomfmuError(f"map.at.{key} is not an axis of the grid{suggestion(key, grid)}")
        axis = axes[key]
        value = axis.varied.read(given)
        same = [each for each in axis.values.tolist() if _same(each, value)]
        if not same:
            shown = ", ".join(axis.varied.show(each) for each in axis.values.tolist()[:16])
            raise LoomfmuError(f"map.at.{key} = {axis.varied.show(value)} is not on its axis: {shown}")
        picked[key] = same[0]
    return picked


def _same(one: Value, other: Value) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return bool(np.isclose(one, other, rtol=ROUNDING, atol=0.0))
    return one == other


def _check_settled(request: Map, axes: list[Axis]) -> None:
    """A point of the picture stands for one row; only a scatter of sampled points may leave axes open."""
    drawn = [axis for axis in axes if axis.key in (request.x, request.y)]
    for axis in drawn:
        if axis.key in request.at:
            raise LoomfmuError(f"map.at.{axis.key} is already drawn along x or y")
    if any(axis.sampled for axis in drawn):
        return
    left = [axis for axis in axes if axis not in drawn and axis.key not in request.at]
    sampled = [axis.key for axis in left if axis.sampled]
    if sampled:
        raise LoomfmuError(
            f"map: {sampled[0]} is sampled, so many rows share one point; draw it along x or y"
        )
    if len(left) > (1 if request.y is None else 0):
        raise LoomfmuError(f"map: {left[0].key} varies too; pick one of its values in [map.at]")
