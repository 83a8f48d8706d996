"""Draws `demo.svg`, the picture in the README: one pick of the demo below and above its safe speed."""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path.append(str(Path(__file__).parents[1] / "tests"))  # the figures of all documents look alike

import matplotlib

matplotlib.use("Agg")  # before pyplot: no window
import matplotlib.pyplot as plt
import numpy as np
from figure_style import BLUE, GREEN, GREY, ORANGE, RED, STYLE

import loomfmu

HERE = Path(__file__).parent
SCENE = HERE.parent / "sims" / "wl680_3600.toml"
SPEEDS = {600: BLUE, 700: RED}  # rev/min: below and above the limit of 681.8
FACTORS = {"weft.travel": 1.0, "belt.margin": 1.0, "heald_1.lift": 1e3, "heald_2.lift": 1e3}  # m, 1, mm, mm


def pick(speed: int) -> dict[str, np.ndarray]:
    """Shaft angle [deg] and the signals of the first pick at a shaft speed [rev/min]."""
    with TemporaryDirectory() as folder:
        result = loomfmu.run(SCENE, set={"shaft.speed": f"{speed} rpm"}, output=Path(folder) / "demo.h5")
        angle = np.degrees(result.trace.shaft_angle)
        first = angle <= 360
        signals = {name: factor * result.trace[name][first] for name, factor in FACTORS.items()}
    return {"angle": angle[first], **signals}


def main() -> None:
    """Draw three panels over the shaft angle: rapier head, margin of its belt, two heald frames."""
    runs = {speed: pick(speed) for speed in SPEEDS}
    slow = runs[600]
    angle = slow["angle"]
    with plt.rc_context({**STYLE, "svg.hashsalt": "loomfmu"}):
        figure, panels = plt.subplots(
            3, sharex=True, figsize=(9, 6.6), layout="constrained", height_ratios=(3, 4, 3)
        )
        head, belt, frames = panels
        for axes in panels:  # where the belt is outside its guide and in compression
            axes.fill_between(
                angle, 0, 1, where=slow["belt.margin"] < 1, transform=axes.get_xaxis_transform(),
                color="#f3e3c3", linewidth=0,
            )  # fmt: skip
        head.plot(angle, slow["weft.travel"], color=GREY)
        head.set_title("Travel of the rapier head, m")
        for speed, colour in SPEEDS.items():
            margin = runs[speed]["belt.margin"]
            name = f"{speed} rev/min: lowest {margin.min():.2f}".replace("-", "\N{MINUS SIGN}")
            belt.plot(angle, margin, color=colour, label=name)
        belt.axhline(0, color="black", linewidth=1)
        belt.text(180, -0.04, "below 0 the belt buckles", va="top", ha="center", fontsize=10)
        belt.set_ylim(-0.25, 1.15)
        belt.set_title(
            "Margin of the rapier belt against buckling (shaded: outside its guide and in compression)"
        )
        belt.legend(loc="center")
        for number, colour in ((1, GREEN), (2, ORANGE)):
            frames.plot(angle, slow[f"heald_{number}.lift"], color=colour, label=f"frame {number}")
        frames.set_title("Lift of two heald frames in plain weave, mm")
        frames.legend(loc="center")
        frames.set(xlim=(0, 360), xticks=np.arange(0, 361, 45), xlabel="shaft angle, deg")
        for axes in panels:
            axes.title.set(fontsize=11, ha="left", position=(0, 1))
        figure.savefig(HERE / "demo.svg", metadata={"Date": None})


if __name__ == "__main__":
    main()
