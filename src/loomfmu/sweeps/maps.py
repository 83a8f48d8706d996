"""The picture of a sweep: a column over one axis or two, and where a claim's verdict flips."""

from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter
from numpy.typing import NDArray

from .. import units
from ..files import PICTURE, write_file
from ..traces.plotting import COLOURS, DOTS, fixed_style
from .axes import Axis
from .plan import SweepPlan
from .ranking import distance
from .tables import column_of, labels_of
from .varied import labelled

Floats = NDArray[np.float64]

LINES, HATCH = "#ffffff", "///"  # over the side where a claim fails
STYLE: Any = {"font.size": 11, "axes.grid": False, "hatch.color": LINES, "hatch.linewidth": 0.7}
NO_RESULT = "#d0d0d0"
ORANGE = COLOURS[1]
# of limits: a later one is thinner, so that both are seen where they coincide
LIMITS: Any = (
    {"color": "black", "linestyle": "-", "linewidth": 5.0},
    {"color": ORANGE, "linestyle": "--", "linewidth": 2.5},
    {"color": COLOURS[4], "linestyle": ":", "linewidth": 2.5},
    {"color": COLOURS[3], "linestyle": "-.", "linewidth": 1.5},
)
LEVELS = 14
TITLE, LEGEND = 80, 95  # letters in a line that is as wide as the picture


@dataclass(frozen=True)
class _Scale:
    """An axis of the picture: the place of each row on it, its ticks and its words.

    `places` are the places that there are, in order; names stand at 0, 1, 2, ...
    """

    label: str
    at: Floats
    places: Floats
    names: list[str] | None
    logarithmic: bool

    @property
    def index(self) -> NDArray[np.int64]:
        """The number of each row's place."""
        return np.asarray(np.searchsorted(self.places, self.at), np.int64)

    @property
    def edges(self) -> Floats:
        """The edges of the cells around the places: half-way, in the logarithm if that is the scale."""
        places = np.log(self.places) if self.logarithmic else self.places
        if len(places) == 1:
            return np.array([self.places[0] - 0.5, self.places[0] + 0.5])
        middles = (places[1:] + places[:-1]) / 2.0
        ends = [2.0 * places[0] - middles[0]], [2.0 * places[-1] - middles[-1]]
        edges = np.concatenate((ends[0], middles, ends[1]))
        return np.exp(edges) if self.logarithmic else edges


@fixed_style(**STYLE)
def draw(plan: SweepPlan, table: Any, path: Path) -> Path | None:
    """Draw the map of a plan; nothing if no row has a value there."""
    assert plan.map is not None
    request = plan.map
    chosen = np.ones(table.num_rows, dtype=bool)
    for key, value in request.at.items():
        chosen &= np.array([each == value for each in table[key].to_pylist()])
    words, unit, values = column_of(table, request.value)
    claims = [each.claim for each in labels_of(table)]
    distances = [(claim, distance(table, number)[chosen]) for number, claim in enumerate(claims)]
    picture = _Picture(plan, values[chosen], labelled(words, unit), distances)
    if not np.isfinite(picture.values).any():
        return None
    x = _scale(plan, table, request.x, chosen)
    y = _scale(plan, table, request.y, chosen) if request.y is not None else None
    drawn = [axis for axis in plan.axes if axis.key in (request.x, request.y)]
    if any(axis.sampled for axis in drawn):
        picture.scatter(x, y)
    elif y is not None:
        picture.field(x, y)
    else:
        rest = [axis for axis in plan.axes if axis not in drawn and axis.key not in request.at]
        picture.lines(x, _scale(plan, table, rest[0].key, chosen) if rest else None)
    picture.save(path)
    return path


def _scale(plan: SweepPlan, table: Any, key: str, chosen: NDArray[np.bool_]) -> _Scale:
    axis: Axis = next(axis for axis in plan.axes if axis.key == key)
    column = [value for value, wanted in zip(table[key].to_pylist(), chosen, strict=True) if wanted]
    if axis.numeric:
        factor = units.unit(axis.varied.display).factor if axis.varied.kind == "Real" else 1.0
        at = np.array(column, dtype=np.float64) / factor
        label = labelled(key, axis.varied.shown_unit)
        return _Scale(label, at, np.unique(at), None, axis.logarithmic)
    names = list(dict.fromkeys(axis.values.tolist()))
    at = np.array([names.index(value) for value in column], dtype=np.float64)
    return _Scale(key, at, np.arange(len(names), dtype=np.float64), [str(name) for name in names], False)


class _Picture:
    """A figure of some rows: their values, and how far each is beyond the bounds of the claims."""

    def __init__(self, plan: SweepPlan, values: Floats, label: str, distances: list[tuple[str, Floats]]):
        self.values = values
        self.label = label
        self.distances = distances
        self.failing = np.any([each > 0.0 for _claim, each in distances] or [values != values], axis=0)
        self.figure = Figure(figsize=(8.0, 5.5), layout="constrained")
        self.axes = self.figure.subplots()
        self.handles: list[Line2D | Patch] = []
        picked = [
            f"{axis.key} = {axis.varied.show(plan.map.at[axis.key])}"
            for axis in plan.axes
            if plan.map is not None and axis.key in plan.map.at
        ]
        words = [plan.title, *([", ".join(picked)] if picked else [])]
        self.axes.set_title("\n".join(fill(each, TITLE) for each in words), fontsize=11)

    def save(self, path: Path) -> None:
        """Write it: whole, or not under that name."""
        if self.handles:
            self.figure.legend(handles=self.handles, loc="outside lower center", fontsize=9)
        drawn = BytesIO()
        self.figure.savefig(drawn, format="png", dpi=DOTS, metadata={"Software": None})
        write_file(path, drawn.getvalue(), PICTURE)

    # ---- two axes of a grid

    def field(self, x: _Scale, y: _Scale) -> None:
        """Contours if both axes are numbers, cells if one has names."""
        grid = self._on_grid(self.values, x, y)
        shades = np.unique(grid[np.isfinite(grid)])
        smooth = x.names is None and y.names is None and min(grid.shape) > 1 and len(shades) > 1
        self.axes.set_facecolor(NO_RESULT)
        masked = np.ma.masked_invalid(grid)
        if smooth:
            drawn: Any = self.axes.contourf(x.places, y.places, masked, levels=LEVELS)
        else:
            drawn = self.axes.pcolormesh(x.edges, y.edges, masked)
        self.figure.colorbar(drawn, ax=self.axes, label=self.label)
        for number, (claim, distances) in enumerate(self.distances):
            beyond = self._on_grid(distances, x, y)
            if np.any(beyond > 0.0) and np.any(beyond <= 0.0):
                style = LIMITS[number % len(LIMITS)]
                (self._boundary if smooth else self._edges)(x, y, beyond, style)
                self._legend(f"{claim}: limit", **style)
        self._hatch(x, y, smooth)
        if np.isnan(grid).any():
            self._legend("could not be run", color=NO_RESULT, linewidth=8)
        self._ticks(x, y)

    def _hatch(self, x: _Scale, y: _Scale, smooth: bool) -> None:
        """Hatch the side where a claim fails."""
        if not self.failing.any():
            return
        grids = [self._on_grid(_crossing(distances), x, y) for _claim, distances in self.distances]
        most = [np.max(np.abs(grid), initial=0.0, where=np.isfinite(grid)) or 1.0 for grid in grids]
        worst = np.fmax.reduce([grid / scale for grid, scale in zip(grids, most, strict=True)])
        if smooth:
            beyond = np.ma.masked_invalid(worst)
            self.axes.contourf(x.places, y.places, beyond, levels=[0.0, 2.0], colors="none", hatches=[HATCH])
        else:
            fails = np.ma.masked_where(~(worst > 0.0), worst)
            self.axes.pcolor(
                x.edges, y.edges, fails, facecolor="none", edgecolor=LINES, hatch=HATCH, linewidth=0
            )
        self.handles.append(Patch(facecolor="#8c8c8c", edgecolor=LINES, hatch=HATCH, label="a claim fails"))

    def _on_grid(self, values: Floats, x: _Scale, y: _Scale) -> Floats:
        grid = np.full((len(y.places), len(x.places)), np.nan)
        grid[y.index, x.index] = values
        return grid

    def _boundary(self, x: _Scale, y: _Scale, beyond: Floats, style: dict[str, Any]) -> None:
        """The line along which a claim's worst value is its bound."""
        level = np.ma.masked_invalid(_crossing(beyond))
        self.axes.contour(
            x.places, y.places, level, levels=[0.0], **{f"{name}s": of for name, of in style.items()}
        )

    def _edges(self, x: _Scale, y: _Scale, beyond: Floats, style: dict[str, Any]) -> None:
        """The edges between cells where a claim holds and cells where it fails."""
        fails, known = beyond > 0.0, ~np.isnan(beyond)
        flips = (fails[:, 1:] != fails[:, :-1]) & known[:, 1:] & known[:, :-1]
        for row, column in np.argwhere(flips):
            self.axes.vlines(x.edges[column + 1], y.edges[row], y.edges[row + 1], **style)
        flips = (fails[1:] != fails[:-1]) & known[1:] & known[:-1]
        for row, column in np.argwhere(flips):
            self.axes.hlines(y.edges[row + 1], x.edges[column], x.edges[column + 1], **style)

    # ---- one axis of a grid

    def lines(self, x: _Scale, series: _Scale | None) -> None:
        """A line for each value of another axis, if there is one."""
        kinds = series.index if series is not None else np.zeros(len(self.values), np.int64)
        for kind in np.unique(kinds):
            rows = np.flatnonzero(kinds == kind)
            rows = rows[np.argsort(x.at[rows])]
            (line,) = self.axes.plot(x.at[rows], self.values[rows], marker="o", markersize=4)
            if series is not None:
                place = series.places[kind]
                name = series.names[kind] if series.names is not None else f"{series.label} {place:.6g}"
                self._legend(name, color=line.get_color())
            elif x.names is None:
                self._limits(x.at[rows], rows)
        self._mark(x.at, self.values)
        self.axes.set_ylabel(self.label)
        self.axes.grid(color="#dddddd")
        self._ticks(x, None)

    def _limits(self, at: Floats, rows: NDArray[np.int64]) -> None:
        """Lines where a claim's verdict flips between two points."""
        for number, (claim, distances) in enumerate(self.distances):
            beyond = _crossing(distances[rows])
            style = LIMITS[number % len(LIMITS)]
            places = np.flatnonzero((beyond[1:] > 0.0) != (beyond[:-1] > 0.0))
            places = places[~np.isnan(beyond[places]) & ~np.isnan(beyond[places + 1])]
            for place in places:
                share = beyond[place] / (beyond[place] - beyond[place + 1])
                where = at[place] + share * (at[place + 1] - at[place])
                self.axes.axvline(where, **style)
            if len(places):
                self._legend(f"{claim}: limit", **style)

    def _mark(self, x: Floats, y: Floats) -> None:
        """Crosses where a claim fails."""
        if self.failing.any():
            self.axes.plot(x[self.failing], y[self.failing], "x", color=ORANGE, markersize=7, zorder=3)
            self._legend("a claim fails", color=ORANGE, marker="x", linestyle="none")

    # ---- a sample

    def scatter(self, x: _Scale, y: _Scale | None) -> None:
        """A point for each row."""
        if y is None:
            self.axes.plot(x.at, self.values, "o", markersize=4)
            self._mark(x.at, self.values)
            self.axes.set_ylabel(self.label)
        else:
            drawn = self.axes.scatter(x.at, y.at, c=self.values, s=36, plotnonfinite=False)
            self.figure.colorbar(drawn, ax=self.axes, label=self.label)
            self._mark(x.at, y.at)
            lost = np.isnan(self.values)
            if lost.any():
                self.axes.plot(x.at[lost], y.at[lost], "s", color=NO_RESULT, markersize=5)
                self._legend("could not be run", color=NO_RESULT, marker="s", linestyle="none")
        self._ticks(x, y)

    # ---- what they share

    def _legend(self, label: str, **style: Any) -> None:
        self.handles.append(Line2D([], [], label=fill(label, LEGEND), **style))

    def _ticks(self, x: _Scale, y: _Scale | None) -> None:
        for scale, axis, rescale in (
            (x, self.axes.xaxis, self.axes.set_xscale),
            (y, self.axes.yaxis, self.axes.set_yscale),
        ):
            if scale is None:
                continue
            axis.set_label_text(scale.label)
            if scale.logarithmic:
                rescale("log")
                axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
                axis.set_major_formatter(StrMethodFormatter("{x:g}"))
                axis.set_minor_formatter(NullFormatter())
            if scale.names is not None:
                axis.set_ticks(scale.places, scale.names)
        if x.names is not None and sum(map(len, x.names)) > 60:
            self.axes.tick_params(axis="x", labelrotation=30)


def _crossing(beyond: Floats) -> Floats:
    """Distances that cross 0 where the verdict flips.

    A claim that counts, or that fails without a value, has no such distances: it flips half-way.
    """
    holding = beyond[beyond <= 0.0]
    if np.isinf(beyond).any() or (len(holding) and not holding.any()):
        return np.where(np.isnan(beyond), np.nan, np.where(beyond > 0.0, 0.5, -0.5))
    return beyond
