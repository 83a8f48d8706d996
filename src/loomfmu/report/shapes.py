"""Flat pictures made of few shapes: as SVG for pages, by matplotlib for files that are not SVG."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from html import escape
from textwrap import wrap
from typing import Any, Literal

import numpy as np

from ..traces import plotting
from .pictures import MAKER, content

MARGIN, LINE, CHARACTER = 10.0, 18.0, 7.0  # px

Point = tuple[float, float]
Anchor = Literal["start", "middle", "end"]
# for files, in which no style sheet chooses: the colours of Okabe and Ito on white, and a violet
COLOURS = {
    "weft": "#0072b2",
    "transfer": "#f0e442",
    "brake": "#9966ff",
    "belt": "#e69f00",
    "risk": "#d55e00",
    "buckled": "#1a1a1a",
    "shed": "#56b4e9",
    "dwell": "#009e73",
    "change": "#d4d4d4",
    "reed": "#a8578a",
    "lock": "#5c5c5c",
    "curve": "#1a1a1a",
    "line": "#d4d4d4",
    "holds": "#006d4f",
    "fails": "#b34700",
    "text": "#1a1a1a",
    "faint": "#5c5c5c",
}


@dataclass(frozen=True)
class Shape:
    """A filled polygon, or a line: its points [px], what gives it a colour, and what it is."""

    points: Sequence[Point]
    role: str
    filled: bool = True
    title: str = ""


@dataclass(frozen=True)
class Text:
    """A line of text at a place [px]."""

    place: Point
    text: str
    role: str = "text"
    anchor: Anchor = "start"


Drawing = Sequence[Shape | Text]


def svg(drawing: Drawing) -> str:
    """The elements of a drawing, with classes for their roles."""
    return "\n".join(_element(each) for each in drawing)


def _element(each: Shape | Text) -> str:
    if isinstance(each, Text):
        x, y = map(_short, each.place)
        text = escape(each.text)
        return f'<text x="{x}" y="{y}" class="{each.role}" text-anchor="{each.anchor}">{text}</text>'
    points = " ".join(f"{_short(x)},{_short(y)}" for x, y in each.points)
    title = f"<title>{escape(each.title)}</title>" if each.title else ""
    name = "polygon" if each.filled else "polyline"
    return f'<{name} class="{each.role}" points="{points}">{title}</{name}>'


def _short(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")


def headed(
    title: str, legend: Mapping[str, str], drawing: Drawing, size: tuple[float, float]
) -> tuple[Drawing, tuple[float, float]]:
    """A drawing below its title and what its roles mean, by their labels, and its new size."""
    x, y = MARGIN, 1.5 * LINE
    above: list[Shape | Text] = []
    for line in wrap(title, int((size[0] - 2.0 * MARGIN) / CHARACTER)):
        above.append(Text((x, y), line))
        y += LINE
    for label, role in legend.items():
        width = 24.0 + CHARACTER * len(label)
        if x + width > size[0]:
            x, y = MARGIN, y + LINE
        above += [Shape(_swatch(role, x, y), role), Text((x + 17.0, y), label)]
        x += width + 10.0
    moved = [
        replace(each, place=(each.place[0], each.place[1] + y))
        if isinstance(each, Text)
        else replace(each, points=[(px, py + y) for px, py in each.points])
        for each in drawing
    ]
    return [*above, *moved], (size[0], size[1] + y)


def _swatch(role: str, x: float, y: float) -> Sequence[Point]:
    """Return the swatch of a role in the legend at a place: a triangle for claims, or a box."""
    if role in ("holds", "fails"):
        return triangle(x + 6.0, y - 10.0, y, role == "holds")
    return [(x, y - 10.0), (x + 12.0, y - 10.0), (x + 12.0, y), (x, y)]


def triangle(x: float, top: float, bottom: float, upright: bool) -> Sequence[Point]:
    """A mark 12 px wide; that it is upright or upside down tells it in any colour vision."""
    tip, base = (top, bottom) if upright else (bottom, top)
    return [(x, tip), (x + 6.0, base), (x - 6.0, base)]


@plotting.fixed_style()
def _figure(drawing: Drawing, size: tuple[float, float]) -> Any:
    """A drawing as a figure of matplotlib. Raises LoomfmuError if that is not installed."""
    figure = plotting.figure((size[0] / 100.0, size[1] / 100.0), layout=None)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, size[0]), ylim=(size[1], 0.0))
    axes.axis("off")
    for order, each in enumerate(drawing):
        _plot(axes, each, order)
    return figure


def file(drawing: Drawing, size: tuple[float, float], suffix: str, title: str) -> bytes:
    """A drawing as the content of a file of its own: `.svg`, `.png` or `.pdf`.

    Raises LoomfmuError where matplotlib is needed and not installed.
    """
    if suffix == ".svg":
        return _svg_file(drawing, size, title).encode()
    return content(_figure(drawing, size), suffix, title)


def _plot(axes: Any, each: Shape | Text, order: int) -> None:
    from matplotlib import patheffects  # optional, and slow to import

    colour = COLOURS[each.role]
    if isinstance(each, Text):
        align = {"start": "left", "middle": "center", "end": "right"}[each.anchor]
        halo = [patheffects.withStroke(linewidth=4.0, foreground="#ffffff")]
        axes.text(
            *each.place,
            each.text,
            color=colour,
            ha=align,
            va="baseline",
            fontsize=9,
            zorder=order,
            path_effects=halo,
        )
        return
    points = np.array(each.points)
    if each.filled:
        axes.fill(points[:, 0], points[:, 1], color=colour, linewidth=0, zorder=order)
    else:
        axes.plot(points[:, 0], points[:, 1], color=colour, linewidth=1.0, zorder=order)


def _svg_file(drawing: Drawing, size: tuple[float, float], title: str) -> str:
    rules = "".join(f".{role}{{fill:{colour}}}" for role, colour in COLOURS.items())
    lines = "".join(f"polyline.{role}{{fill:none;stroke:{COLOURS[role]}}}" for role in ("curve", "line"))
    lines += "text{paint-order:stroke;stroke:#ffffff;stroke-width:7px;stroke-linejoin:round}"
    width, height = (_short(length) for length in size)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}"'
        f' height="{height}" font-family="sans-serif" font-size="12" role="img">\n'
        f"<title>{escape(title)}</title>\n<metadata>{MAKER}</metadata>\n<style>{rules}{lines}</style>\n"
        f'<rect width="100%" height="100%" fill="#ffffff"/>\n{svg(drawing)}\n</svg>\n'
    )


def ring(centre: Point, inner: float, outer: float, start: float, end: float) -> list[Point]:
    """A sector of a ring, as a polygon; angles [rad] run clockwise from the top.

    >>> points = ring((0.0, 0.0), 1.0, 2.0, 0.0, math.pi / 2)
    >>> [(round(x), round(y)) for x, y in (points[0], points[45], points[46], points[-1])]
    [(0, -2), (2, 0), (1, 0), (0, -1)]
    """
    steps = max(2, math.ceil((end - start) / math.radians(2.0)) + 1)
    angles = np.linspace(start, end, steps)
    out = [on_circle(centre, outer, angle) for angle in angles]
    return out + [on_circle(centre, inner, angle) for angle in angles[::-1]]


def on_circle(centre: Point, radius: float, angle: float) -> Point:
    """A point on a circle; the angle [rad] runs clockwise from the top."""
    return centre[0] + radius * math.sin(angle), centre[1] - radius * math.cos(angle)
