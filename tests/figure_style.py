"""Colours and style of the figures in the report on published numbers, the benchmarks and the README."""

from typing import Any

# colours that the colour-blind tell apart too (Okabe and Ito)
COLOURS = {
    "blue": "#0072B2",
    "orange": "#E69F00",
    "green": "#009E73",
    "purple": "#CC79A7",
    "sky": "#56B4E9",
    "red": "#D55E00",
    "grey": "#808080",
    "black": "#000000",
}
BLUE, ORANGE, GREEN, PURPLE, SKY, RED, GREY, BLACK = COLOURS.values()

STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 11,
    "axes.grid": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.8,
    "lines.linewidth": 1.8,
    "legend.frameon": False,
    "legend.fontsize": 10,
}
