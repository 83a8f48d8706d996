"""How the figures look: their colours and their style."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Draw = Callable[["Figure"], None]

# colours that the colour-blind tell apart too (Okabe and Ito)
BLUE, ORANGE, GREEN, PURPLE, SKY, RED, GREY, BLACK = (
    "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#808080", "#000000",
)  # fmt: skip
SERIES = {"WL680": BLUE, "WL800": ORANGE, "WL450": GREEN}
LAW_COLOURS = {
    "uniform": GREY,
    "harmonic ends": BLUE,
    "sloped line": ORANGE,
    "sloped sine": GREEN,
    "slotted levers": PURPLE,
    "non-circular gears": SKY,
    "plateau": RED,
}

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
