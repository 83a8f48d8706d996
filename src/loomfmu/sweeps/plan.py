"""A sweep file, read and checked against its scene: a misspelt name is found before anything runs."""

import math
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cosim.importing.fmus import Port
from ..cosim.planning.requested import output_port
from ..cosim.scenes.scene import Scene
from ..cosim.scenes.settings import check_table, read_table
from ..errors import LoomfmuError, suggestion
from ..extras import need
from .axes import MOST, Axis, flattened, grid_axis, range_of, sample_axes, whole
from .header import HEAD, Header, check_by_scene, read, variables
from .sensitivity import OPTIONS, Sensitivity, sensitivity_of
from .varied import Value

KEYS = (*HEAD, "values", "grid", "sample", "sensitivity", "traces", "map")
EXTRAS = {"map": "plot", "sensitivity": "study"}  # that tables need beside the extra `sweep`
TRACES = dict.fromkeys(("failures", "sample"), partial(whole, low=0))
NO_TRACES = {"failures": 0, "sample": 0}  # by default of rows that only indices need
OF_MAP = ("x", "y", "value", "at")  # keys of `[map]`
ROUNDING = 1e-9  # of a value that is given once in the grid and once in `at`, perhaps in another unit


@dataclass(frozen=True)
class Map:
    """A column over one axis or two; `at` picks one value of each other axis of the grid."""

    x: str
    y: str | None
    value: str
    at: dict[str, Value] = field(default_factory=dict)


@dataclass(frozen=True)
class Traces:
    """The numbers of rows that are run again with a full trace: of those that fail, and of the others."""

    failures: int = 20
    sample: int = 5


@dataclass(frozen=True)
class SweepPlan(Header):
    """A sweep. Row numbers count the grid, its last axis fastest, then the points of the sample."""

    grid: tuple[Axis, ...]
    sample: tuple[Axis, ...]
    values: tuple[str, ...]
    traces: Traces
    map: Map | None
    sensitivity: Sensitivity | None = None

    @property
    def axes(self) -> tuple[Axis, ...]:
        """All axes, in the order of their columns."""
        return self.grid + self.sample

    @cached_property
    def points(self) -> int:
        """Number of points of the sample, 1 without one."""
        return len(self.sample[0].values) if self.sample else 1

    @cached_property
    def rows(self) -> int:
        """Number of combinations."""
        return math.prod(len(axis.values) for axis in self.grid) * self.points

    def columns(self, rows: NDArray[np.int64]) -> dict[str, NDArray[Any]]:
        """The values of each axis in rows of these numbers."""
        number, point = np.divmod(rows, self.points)
        found: dict[str, NDArray[Any]] = {axis.key: axis.values[point] for axis in self.sample}
        for axis in reversed(self.grid):
            number, place = np.divmod(number, len(axis.values))
            found[axis.key] = axis.values[place]
        return {axis.key: found[axis.key] for axis in self.axes}

    def settings(self, rows: range) -> list[dict[str, Any]]:
        """Return the settings of the scene for each of these rows."""
        columns = self.columns(np.arange(rows.start, rows.stop))
        sets = [dict(self.fixed) for _ in rows]
        for axis in self.axes:
            for each, value in zip(sets, columns[axis.key].tolist(), strict=True):
                each.update(dict.fromkeys(axis.varied.targets, axis.varied.setting(value)))
        return sets

    @property
    def notes(self) -> tuple[str, ...]:
        """The warnings for the user before anything runs."""
        return (*self.scene.notes, *(doubt for axis in self.axes for doubt in axis.doubts))

    def port(self, signal: str) -> Port:
        """The variable of an output among the values."""
        return output_port(self.scene, signal, "values")


def load(path: str | Path) -> SweepPlan:
    """Read a sweep file. Raises LoomfmuError naming the file and what is wrong, before anything runs."""
    return read(Path(path), "sweep", KEYS, _parse)


def _parse(head: Header, tables: dict[str, Any]) -> SweepPlan:
    need("a sweep", "sweep", *(extra for table, extra in EXTRAS.items() if table in tables))
    columns = _results(head.scene, tables.get("values", []))
    wanted = _sensitivity(head, tables, columns) if "sensitivity" in tables else None
    grid, sample = ([], wanted.axes()) if wanted else _axes(head, tables)
    check_by_scene(head, [*grid, *sample])
    values = _values(head.scene, tables.get("values", []), [*grid, *sample])
    request = requested(tables["map"], [*grid, *sample], columns) if "map" in tables else None
    plan = SweepPlan(
        **vars(head),
        grid=tuple(grid),
        sample=tuple(sample),
        values=tuple(values),
        traces=Traces(**read_table(tables.get("traces", NO_TRACES if wanted else {}), "traces", TRACES)),
        map=request,
        sensitivity=wanted,
    )
    if plan.rows > MOST:
        raise LoomfmuError(f"{plan.rows} combinations; the limit is {MOST}")
    return plan


def _axes(head: Header, tables: dict[str, Any]) -> tuple[list[Axis], list[Axis]]:
    """The axes of the grid and those of the sample."""
    gridded = flattened(tables.get("grid", {}), "grid")
    ranges = flattened(tables.get("sample", {}), "sample")
    count, seed = ranges.pop("count", None), ranges.pop("seed", None)
    found = variables(head, {"grid": gridded, "sample": ranges})
    if not found:
        raise LoomfmuError('nothing varies: list values in [grid], such as "shaft.speed" = ["500 rpm"]')
    if ranges:
        count, seed = whole(count, "sample.count", 1), whole(seed, "sample.seed", 0, 2**63 - 1)
    elif (count, seed) != (None, None):
        raise LoomfmuError('sample needs a range, such as "belt.guide_clearance" = ["0.2 mm", "1 mm"]')
    return (
        [grid_axis(found[f"grid.{key}"], given) for key, given in gridded.items()],
        sample_axes([(found[f"sample.{key}"], given) for key, given in ranges.items()], count, seed),
    )


def _sensitivity(head: Header, tables: dict[str, Any], columns: list[str]) -> Sensitivity:
    """Return the `[sensitivity]` table, which has its own rows."""
    for other in ("grid", "sample"):
        if other in tables:
            raise LoomfmuError(f"[sensitivity] chooses the rows itself; leave out [{other}]")
    given = flattened(tables["sensitivity"], "sensitivity")
    options = {key: given.pop(key) for key in OPTIONS if key in given}
    found = variables(head, {"sensitivity": given})
    ranges = [range_of(found[f"sensitivity.{key}"], each, "sensitivity") for key, each in given.items()]
    return sensitivity_of(options, ranges, columns)


def _results(scene: Scene, values: Any) -> list[str]:
    """The columns of results that a picture or indices can be of."""
    claims = range(len(scene.claims))
    listed = [value for value in values if isinstance(value, str)] if isinstance(values, list) else []
    return [*listed, *(f"claim_{number + 1}.{part}" for part in ("worst", "distance") for number in claims)]


def _values(scene: Scene, given: Any, axes: list[Axis]) -> list[str]:
    """The signals whose final values the table has."""
    if not isinstance(given, list) or not all(isinstance(signal, str) for signal in given):
        raise LoomfmuError(f'values = {given!r} is not a list such as ["belt.lowest_speed_limit"]')
    taken = [axis.key for axis in axes]
    for signal in given:
        output_port(scene, signal, "values")
        if signal in taken:
            raise LoomfmuError(f"values: {signal} is already a column")
        taken.append(signal)
    return given


def requested(table: Any, axes: list[Axis], columns: list[str]) -> Map:
    """The picture of a `[map]` table. Raises LoomfmuError for what cannot be drawn."""
    check_table(table, "map", OF_MAP)
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
