"""A fit as people read it: a table, sentences, and a picture of the curves with what remains between them."""

from typing import Any

import numpy as np

from ...display import printed
from ...display.printed import say
from ...sweeps.varied import labelled
from ...traces.plotting import COLOURS, degrees, figure, fixed_style
from .curves import Compared
from .fit import HEADINGS, Fit, rows

WIDTH, PANEL, REST = 8.0, 3.4, 0.6  # [in]


def show(found: Fit) -> None:
    """Print a fit: the parameters, what they leave of the data, and what to be careful about."""
    say(f"{found.title}: fitted to {found.data.path}, {found.data.count} measured values")
    table = rows(found)
    entries = [
        (f"{key}:", value, f"interval {interval};", f"scene {own}") for key, value, interval, own in table
    ]
    printed.show(HEADINGS, table, entries)
    say(*remains(found), *found.notes, "", f"{found.runs} runs")


def remains(found: Fit) -> list[str]:
    """Return the residuals in words, a line for each signal."""
    lines = []
    for each in found.curves:
        unit = "" if each.unit == "1" else f" {each.unit}"
        share = f", {100.0 * each.share:.3g} % of the variation in the data" if each.share < 1.0 else ""
        count = len(each.measured)
        lines.append(
            f"{each.signal}: residual {each.rms / each.factor:.3g}{unit} rms over {count} values{share}"
        )
    return lines


@fixed_style()
def draw(found: Fit) -> Any:
    """A figure of matplotlib. Raises LoomfmuError if that is not installed."""
    drawn = figure((WIDTH, PANEL * len(found.curves) + REST))
    panels = drawn.subplots(
        2 * len(found.curves), sharex=True, squeeze=False, height_ratios=[2.0, 1.0] * len(found.curves)
    )[:, 0]
    angle = found.data.over == "shaft_angle"
    for number, each in enumerate(found.curves):
        _curve(panels[2 * number], panels[2 * number + 1], each, angle)
    panels[-1].set_xlabel("Shaft angle [deg]" if angle else "Time [s]")
    if angle:
        panels[-1].xaxis.set_major_locator(degrees())
    panels[0].legend(frameon=False, ncols=2)
    drawn.suptitle(found.title, fontsize=11)
    return drawn


def _curve(above: Any, below: Any, each: Compared, angle: bool) -> None:
    along = np.degrees(each.along) if angle else each.along
    above.plot(along, each.measured / each.factor, ".", color=COLOURS[1], markersize=4, label="measured")
    above.plot(along, each.computed / each.factor, color=COLOURS[0], label="computed")
    below.plot(along, (each.measured - each.computed) / each.factor, ".", color=COLOURS[1], markersize=4)
    below.axhline(0.0, color=COLOURS[0], linewidth=1.0)
    above.set_ylabel(labelled(each.signal, each.unit))
    below.set_ylabel(labelled("difference", each.unit))
    for axes in (above, below):
        axes.grid(color="#d4d4d4", linewidth=0.6)
        axes.margins(x=0.0)
