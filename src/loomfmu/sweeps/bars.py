"""The picture of sensitivities: how much each output depends on each range, as bars."""

from textwrap import fill
from typing import Any

import numpy as np

from ..traces.plotting import COLOURS, figure, fixed_style
from .sensitivity import INDICES, WORDS, Influences

WIDTH, LINE, REST = 8.0, 0.27, 0.9  # [in]
LONGEST = 48  # letters of a line of a title
ACROSS = 2  # panels


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
