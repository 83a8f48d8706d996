"""The figures of the report, as `figures.toml` describes them: one file each, 800 pixels wide.

A curve runs over a `range` of x (first, last, count) or over the rows that its `points` name, or is what
`arrays` computes. `x` and each of `y`, one for each panel from `panel` on, are numbers or calls with a unit.
"""

import math
import tomllib
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from figure_style import COLOURS, STYLE
from matplotlib.figure import Figure
from PIL import Image

from loomfmu.traces.plotting import fixed_style
from validation.calls import HERE, argument, combined, factor, filled, rows, value

GREYS = (0x55, 0xDD, 0xEE)  # of texts, grids and spans


def described() -> dict[str, dict[str, Any]]:
    """The figures by the names of their files."""
    given = tomllib.loads((HERE / "figures.toml").read_text(encoding="utf-8"))
    return {figure["name"]: figure for figure in given["figure"]}


def write(directory: Path) -> list[Path]:
    """Draw all figures into a directory."""
    directory.mkdir(exist_ok=True)
    paths = []
    for name, given in described().items():
        with fixed_style(**STYLE):
            paths.append(directory / name)
            paths[-1].write_bytes(_png(drawn(given)))
    return paths


def drawn(given: dict[str, Any]) -> Figure:
    """A figure: its panels one above the other, curves, marks and legend."""
    figure = Figure(figsize=(8.0, given["height"]), dpi=100, layout="constrained")
    axes = given["axes"]
    panels = figure.subplots(len(axes), 1, sharex=True, squeeze=False)[:, 0]
    for curve in given["curve"]:
        for row in combined(curve.get("each", {})):
            _draw(panels, curve, row)
    for mark in given.get("mark", ()):
        given_to = [filled(each) if isinstance(each, str) else each for each in mark["given"]]
        getattr(panels[mark.get("panel", 0)], mark["call"])(*given_to, **mark.get("options", {}))
    for panel, settings in zip(panels, axes, strict=True):
        panel.set(**settings)
    panels[0].set_title(given["title"], fontsize=12)
    below, legend = given.get("below"), given.get("legend", {})
    if below:
        handles, labels = panels[-1].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=below, fontsize=10)
    elif legend:
        panels[0].legend(**legend)
    return figure


def _draw(panels: Any, curve: dict[str, Any], row: dict[str, str]) -> None:
    """A curve of a row, in one panel or in each from the first."""
    x, *lines = value(filled(curve["arrays"], row)) if "arrays" in curve else _computed(curve, row)
    style, options = filled(curve.get("style", "-"), row), {}
    for name, given in curve.get("options", {}).items():
        options[name] = argument(filled(given, row))
    options |= {"color": COLOURS[filled(curve["colour"], row)], "label": filled(curve.get("label", ""), row)}
    first = int(filled(str(curve.get("panel", 0)), row))
    for panel, y in zip(panels[first:], lines, strict=False):
        panel.plot(x, np.maximum(y, curve.get("floor", -np.inf)), style, **options)


def _computed(curve: dict[str, Any], row: dict[str, str]) -> list[list[float]]:
    """Values of x and of each y at every point of a curve."""
    if "range" in curve:
        first, last, count = (float(filled(str(of), row)) for of in curve["range"])
        points = [{"x": repr(x)} for x in np.linspace(first, last, int(count)).tolist()]
    else:
        points = rows(curve.get("points", {}), row)
    return [[_number(text, point | row) for point in points] for text in (curve.get("x", "{x}"), *curve["y"])]


def _number(text: str, row: dict[str, str]) -> float:
    call, _, unit = (part.strip() for part in filled(text, row).partition("|"))
    return (math.nan if call == "nan" else value(call)) / factor(unit or "1")


def _png(figure: Figure) -> bytes:
    """A figure with a palette, which makes it a third as large, and without a date."""
    drawing = BytesIO()
    figure.savefig(drawing, format="png")
    palette = Image.new("P", (1, 1))
    palette.putpalette(_palette())
    packed = BytesIO()
    image = Image.open(drawing).convert("RGB").quantize(palette=palette, dither=Image.Dither.NONE)
    image.save(packed, format="png", optimize=True)
    return packed.getvalue()


def _palette() -> list[int]:
    """White, the greys in use, the colours in use and six shades of each towards white."""
    values = [255, 255, 255, *(grey for grey in GREYS for _ in range(3))]
    for colour in COLOURS.values():
        parts = [int(colour[place : place + 2], 16) for place in (1, 3, 5)]
        values += [round(p + (255 - p) * shade / 7.5) for shade in range(7) for p in parts]
    return values
