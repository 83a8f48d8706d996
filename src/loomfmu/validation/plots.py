"""Figures of the report: one file each, 800 pixels wide. The only place that needs matplotlib."""

from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

from ..files import PICTURE, check_target, write_file
from ..traces.plotting import fixed_style
from . import plots_dobby, plots_others, plots_weft
from .plot_style import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, RED, SKY, STYLE, Draw

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def figures() -> dict[str, tuple[float, Draw]]:
    """File name of every figure, with its height in inches and what draws it."""
    return plots_weft.FIGURES | plots_dobby.FIGURES | plots_others.FIGURES


def write(directory: Path, overwrite: bool = False) -> list[Path]:
    """Draw all figures into a directory; `overwrite` replaces files that are not pictures."""
    from matplotlib.figure import Figure

    for name in figures():
        check_target(directory / name, PICTURE, overwrite=overwrite)
    paths = []
    for name, (height, draw) in figures().items():
        with fixed_style(**STYLE):
            figure = Figure(figsize=(8.0, height), dpi=100, layout="constrained")
            draw(figure)
            paths.append(directory / name)
            write_file(paths[-1], _png(figure), PICTURE, overwrite=overwrite)
    return paths


def _palette() -> list[int]:
    """White, the greys in use, the colours in use and six shades of each towards white."""
    values = [255, 255, 255, *(value for grey in (0x55, 0xDD, 0xEE) for value in (grey, grey, grey))]
    for colour in (BLUE, ORANGE, GREEN, PURPLE, SKY, RED, GREY, BLACK):
        parts = [int(colour[place : place + 2], 16) for place in (1, 3, 5)]
        for shade in range(7):
            values += [round(part + (255 - part) * shade / 7.5) for part in parts]
    return values


def _png(figure: "Figure") -> bytes:
    """A figure with a palette, which makes it a third as large, and without a date."""
    from PIL import Image

    drawn = BytesIO()
    figure.savefig(drawn, format="png")
    palette = Image.new("P", (1, 1))
    palette.putpalette(_palette())
    image = Image.open(drawn).convert("RGB")
    packed = BytesIO()
    image.quantize(palette=palette, dither=Image.Dither.NONE).save(packed, format="png", optimize=True)
    return packed.getvalue()
