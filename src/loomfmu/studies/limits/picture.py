"""Pictures of limits: distances of claims over one variable, and the boundary over two."""

from typing import Any

import numpy as np

from ...sweeps.varied import labelled
from ...traces.plotting import COLOURS, DASHES, figure, fixed_style
from .results import Boundary, ClaimLimits, Limits

SIZE = (8.0, 4.6)  # [in]
FARTHEST = 1.5  # times the bound: distances beyond that are cut off, so that all claims can be seen near 0
HOLDS = "#dcefe3"


@fixed_style()
def draw(found: Limits | Boundary) -> Any:
    """A figure of matplotlib. Raises LoomfmuError if that is not installed."""
    drawn = figure(SIZE)
    axes = drawn.subplots()
    if isinstance(found, Boundary):
        _boundary(axes, found)
    else:
        _distances(axes, found)
    axes.set_title(found.title, fontsize=11)
    drawn.legend(loc="outside lower center", fontsize=8, ncols=2)
    return drawn


def _distances(axes: Any, found: Limits) -> None:
    span = found.span
    for stretch in found.ranges:
        axes.axvspan(stretch.low / span.factor, stretch.high / span.factor, color=HOLDS, zorder=0)
    lowest, highest = 0.0, 0.0
    for number, each in enumerate(found.claims):
        scale = _scale(each)
        x, y = (np.array(column) for column in zip(*each.points, strict=True))
        colour, dash = COLOURS[number % len(COLOURS)], DASHES[number // len(COLOURS) % len(DASHES)]
        axes.plot(x / span.factor, y / scale, dash, color=colour, label=each.claim)
        known = y[np.isfinite(y)] / scale
        lowest, highest = min([lowest, *known]), max([highest, *known])
        places = [limit.value / span.factor for limit in each.limits]
        axes.plot(places, np.zeros(len(places)), "o", color=colour, markersize=5)
    axes.axhline(0.0, color="black", linewidth=1)
    margin = 0.05 * (highest - lowest) or 1.0
    axes.set_ylim(max(lowest - margin, -FARTHEST), min(highest + margin, FARTHEST))
    axes.set_xlim(span.low / span.factor, span.high / span.factor)
    axes.axvline(span.value / span.factor, color="grey", linewidth=1, linestyle=":")
    axes.set_xlabel(labelled(span.key, span.unit))
    axes.set_ylabel("distance to the bound, as a share of it")
    axes.grid(color="#e8e8e8")


def _scale(each: ClaimLimits) -> float:
    """Return the scale of a distance: the bound, or the farthest distance if the bound is 0."""
    known = [abs(distance) for _value, distance in each.points if np.isfinite(distance)]
    return abs(each.verdict.bound) or max(known, default=0.0) or 1.0


def _boundary(axes: Any, found: Boundary) -> None:
    first, second = found.first, found.second
    at = np.array(found.values) / second.factor
    for number, each in enumerate(found.rows[0].claims):
        places = [
            (place, limit.value / first.factor)
            for place, limits in zip(at.tolist(), found.rows, strict=True)
            for limit in limits.claims[number].limits
        ]
        alone = all(len(limits.claims[number].limits) <= 1 for limits in found.rows)
        if places:
            axes.plot(
                *zip(*places, strict=True),
                "-o" if alone else "o",
                markersize=4,
                color=COLOURS[number % len(COLOURS)],
                label=f"limit: {each.claim}",
            )
    for place, limits in zip(at.tolist(), found.rows, strict=True):
        for stretch in limits.ranges:
            axes.vlines(
                place,
                stretch.low / first.factor,
                stretch.high / first.factor,
                color="#8fc7a3",
                linewidth=5,
                zorder=0,
            )
    axes.plot([], [], color="#8fc7a3", linewidth=5, label="all claims hold")
    axes.set_xlim(second.low / second.factor, second.high / second.factor)
    axes.set_ylim(first.low / first.factor, first.high / first.factor)
    axes.set_xlabel(labelled(second.key, second.unit))
    axes.set_ylabel(labelled(first.key, first.unit))
    axes.grid(color="#e8e8e8")
