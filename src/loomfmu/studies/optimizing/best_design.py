"""The best design as people read it in a terminal, and the picture of all designs that were tried."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ... import units
from ...display import printed
from ...display.printed import say
from ...sweeps.varied import labelled
from ...traces.plotting import COLOURS, figure, fixed_style
from ..polished import Floats
from .optimum import Optimum, best_tables, conclusion, front_table
from .runs import Design
from .study import Goal


def show(found: Optimum) -> None:
    """Print the best design, or the front, and where it is."""
    study = found.study
    before = found.runs - found.ran
    again = f" ({before} of them run before)" if before > 0 else ""
    met = f"{found.allowed} of which meet {study.wanted} (numerical errors aside)"
    say(f"{study.title}: {found.runs} designs{again}, {met}")
    if found.front and len(study.goals) == 1:
        (best,) = found.front
        (headings, values), (verdicts, claims) = best_tables(found, best)
        entries = [(f"{name}: {value}", _bracketed(text, note)) for name, value, text, note in values]
        printed.show(headings, values, entries)
        by_claim = [
            (f"{word}  {claim}", f"{worst}, bound {bound}", _bracketed(distance, note))
            for word, claim, worst, bound, distance, note in claims
        ]
        printed.show(verdicts, claims, by_claim, further=True)
    elif found.front:
        headings, rows = front_table(found)
        designs = [[f"{head}: {cell};" for head, cell in zip(headings, row, strict=True)] for row in rows]
        printed.show(headings, rows, designs)
    say(*conclusion(found))
    if found.study.enumerable:
        say(f"All {found.study.combinations} combinations were run.")
    else:
        say("This is a search, not a proof that there is no better design.")
    if found.front:
        first, last = found.front[0].scene, found.front[-1].scene
        say(f"scene: {first}" if first == last else f"scenes: {first} to {last.name}")
    say(f"table: {found.path / 'designs.csv'}")
    if found.picture is not None:
        say(f"picture: {found.picture}")


def _bracketed(*parts: str) -> str:
    found = "; ".join(filter(None, parts))
    return f"({found})" if found else ""


PANEL, HEIGHT, MOST = 3.0, 3.4, 4  # [in], panels in a row
GREY = "#c4c4c4"


@fixed_style()
def draw(found: Optimum, designs: Sequence[Design]) -> Any:
    """A figure of matplotlib: the goal over each range, or two goals over one another."""
    study = found.study
    run = [each for each in designs if not each.error and np.all(np.isfinite(each.heights))]
    heights = np.array([each.heights for each in run]).reshape(len(run), len(study.goals))
    allowed = np.array([each.allowed for each in run], dtype=bool)
    columns = [_column(goal, heights[:, place]) for place, goal in enumerate(study.goals)]
    best = [
        _column(g, np.array([g.sign * each.goals[p] for each in found.front]))
        for p, g in enumerate(study.goals)
    ]
    if len(study.goals) > 1:
        pairs = [(place, place + 1) for place in range(len(study.goals) - 1)]
        drawn, all_axes = _panels(len(pairs))
        for axes, (x, y) in zip(all_axes, pairs, strict=True):
            _points(axes, columns[x], columns[y], allowed)
            axes.plot(best[x], best[y], "o-", color=COLOURS[1], markersize=5, label="front")
            _labels(axes, _named(study.goals[x]), _named(study.goals[y]))
    else:
        others = [
            (place, each) for place, each in enumerate(study.variables) if each.key != study.goals[0].name
        ]
        ranges = [(place, each) for place, each in others if each.range] or others
        ranges = ranges or list(enumerate(study.variables))
        drawn, all_axes = _panels(len(ranges))
        for axes, (place, each) in zip(all_axes, ranges, strict=True):
            factor = units.unit(each.varied.display).factor
            values = np.array([_plain(design.values[place], factor) for design in run])
            _points(axes, values, columns[0], allowed)
            at = [_plain(one.values[each.key], factor) for one in found.front]
            axes.plot(at, best[0], "*", color=COLOURS[1], markersize=14, label="best")
            if each.range and each.range.logarithmic:
                axes.set_xscale("log")
            _labels(axes, labelled(each.key, each.varied.shown_unit), _named(study.goals[0]))
    if len(found.study.goals) == 1 and allowed.any():
        _focus(all_axes, columns[0][allowed])
    drawn.suptitle(study.title, fontsize=11)
    handles, names = all_axes[0].get_legend_handles_labels()
    drawn.legend(handles, names, loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    return drawn


def _plain(value: Any, factor: float) -> Any:
    return value / factor if isinstance(value, float) else value


def _panels(count: int) -> tuple[Any, list[Any]]:
    across = min(count, MOST)
    down = -(-count // across)
    drawn = figure((max(6.0, PANEL * across), HEIGHT * down + 0.4))
    panels = list(drawn.subplots(down, across, squeeze=False).flat)
    for axes in panels[count:]:
        axes.set_axis_off()
    return drawn, panels[:count]


def _points(axes: Any, x: Floats, y: Floats, allowed: Any) -> None:
    axes.plot(x[~allowed], y[~allowed], ".", color=GREY, markersize=3, label="not all claims hold")
    axes.plot(
        x[allowed],
        y[allowed],
        ".",
        color=COLOURS[0],
        markersize=4,
        label="all claims hold, numerical errors aside",
    )


def _focus(panels: Sequence[Any], goal: Floats) -> None:
    """Show where designs are allowed: others may be far away."""
    low, high = float(np.min(goal)), float(np.max(goal))
    margin = 0.1 * (high - low) or 0.05 * abs(high) or 1.0
    for axes in panels:
        axes.set_ylim(low - margin, high + margin)


def _column(goal: Goal, heights: Floats) -> Floats:
    return np.asarray(goal.sign * heights / units.unit(goal.display).factor)


def _named(goal: Goal) -> str:
    name = f"distance of {goal.name}" if goal.kind == "claim" else goal.name
    return labelled(name, goal.shown_unit)


def _labels(axes: Any, x: str, y: str) -> None:
    axes.set_xlabel(x, fontsize=9)
    axes.set_ylabel(y, fontsize=9)
    axes.tick_params(labelsize=8)
    axes.grid(color="#e8e8e8")
