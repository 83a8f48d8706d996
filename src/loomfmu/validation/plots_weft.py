"""Figures of the rapier and its belt."""

import math
from typing import TYPE_CHECKING

import numpy as np

from ..design import loom
from ..machines import HEADS, MACHINES, table
from ..physics.belt import critical_force, length_factor
from . import belt, wrap
from .plot_style import BLACK, BLUE, GREEN, GREY, ORANGE, RED, SERIES, Draw
from .sections import number

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SPEED = 400.0 * loom.RPM
SHOWN = ("WL680-3600", "WL800-3800", "WL450-4600")  # the machines of Figure 3
MASS = float(HEADS["G6300 left"]["mass_g"]) / 1e3


def _width(machine: str) -> float:
    return float(MACHINES[machine]["width_m"])


def travel(figure: "Figure") -> None:
    """Travel, velocity and acceleration of the heads."""
    panels = figure.subplots(3, 1, sharex=True)
    angles = np.linspace(0.0, 2.0 * math.pi, 361)
    scale = (1.0, SPEED, SPEED**2)
    for name in (*(other for other in MACHINES if other not in SHOWN), *SHOWN):
        motion = np.array([belt.travel(name, angle) for angle in angles])
        colour, shown = SERIES[name[:5]], name in SHOWN
        for panel, column, factor in zip(panels, motion.T, scale, strict=True):
            panel.plot(
                np.degrees(angles), factor * column, color=colour, lw=2.0 if shown else 0.8,
                alpha=1.0 if shown else 0.45, label=name if shown else None,
            )  # fmt: skip
    for panel, label in zip(panels, ("travel, m", "velocity, m/s", "acceleration, m/s²"), strict=True):
        panel.set_ylabel(label)
        panel.margins(x=0.0)
    panels[0].legend(loc="upper right", title="of Figure 3")
    panels[2].set_xlabel("shaft angle, deg")
    panels[2].set_xticks(range(0, 361, 45))
    panels[0].set_title("Rapier head at 400 rev/min (thin: the other seven machines)", fontsize=12)


def belt_load(figure: "Figure") -> None:
    """Inertia force and critical load of the WL680 machines over their windows."""
    axes = figure.subplots()
    for name, colour in zip(("WL680-3400", "WL680-3600", "WL680-3800"), (BLUE, ORANGE, GREEN), strict=True):
        found = belt.safe(name, "G6300 left", 0.8)
        start, end = found.window
        angles = np.linspace(start + 1e-3, end, 300)
        load = [MASS * belt.travel(name, angle)[2] * found.speed**2 for angle in angles]
        critical = [critical_force(belt.free_length(name, angle), 0.8, 0.25) for angle in angles]
        label = f"{name} at {number(belt.rpm(found), 0)} rev/min"
        axes.plot(np.degrees(angles), load, color=colour, label=label)
        axes.plot(np.degrees(angles), critical, color=colour, ls="--")
        axes.plot(math.degrees(found.angle), found.critical_force, "o", color=colour, ms=8)
    axes.plot([], [], color=BLACK, label="inertia force of the head")
    axes.plot([], [], color=BLACK, ls="--", label="critical load, mu = 0.8")
    axes.plot([], [], "o", color=BLACK, ms=8, label="where they touch")
    axes.plot(101.27, 177.0, "x", color=RED, ms=11, mew=2.5, label="published for WL680-3400", zorder=5)
    axes.set(xlabel="shaft angle, deg", ylabel="load on the belt, N", ylim=(0.0, 700.0), xlim=(91.0, 105.0))
    axes.legend(loc="upper right")
    axes.set_title("Belt load and critical load at the safe speed (case I)", fontsize=12)


def speed_over_width(figure: "Figure") -> None:
    """Safe speed of all machines, published and computed."""
    axes = figure.subplots()
    published = {row["machine"]: float(row["n_mu_0.8"]) for row in table("safe_speed_by_length_factor")}
    for series, colour in SERIES.items():
        names = [name for name in MACHINES if name.startswith(series)]
        widths = [_width(name) for name in names]
        speeds = [belt.rpm(belt.safe(name, "G6300 left", 0.8)) for name in names]
        axes.plot(widths, speeds, "o-", color=colour, ms=7, label=f"{series}, computed")
        axes.plot(
            widths, [published[name] for name in names], "x", color=colour, ms=11, mew=2.5,
            label=f"{series}, published",
        )  # fmt: skip
    odd = published["WL450-4000"]
    own = number(belt.rpm(belt.safe("WL450-4000", "G6300 left", 0.8)), 1)
    axes.annotate(
        f"WL450-4000: not reproduced\n{odd:.0f} published, {own} computed", (4.0, odd), (4.2, 580.0),
        arrowprops={"arrowstyle": "-", "color": GREY}, va="center",
    )  # fmt: skip
    axes.set(xlabel="width of the loom, m", ylabel="safe speed, rev/min", ylim=(0.0, 920.0))
    axes.legend(ncols=3, loc="upper right")
    axes.set_title("Safe speed of the belt, mu = 0.8, case I (Table 5)", fontsize=12)


def speed_over_clearance(figure: "Figure") -> None:
    """Safe speed over the clearance of the guide."""
    axes = figure.subplots()
    clearances = np.linspace(0.0, 1.2e-3, 121)
    speeds = {row["machine"]: row for row in table("safe_speed_by_length_factor")}
    for name in ("WL680-3400", *SHOWN):
        base = belt.rpm(belt.safe(name, "G6300 left", 1.0))
        style = "--" if name == "WL680-3400" else "-"
        values = [base / length_factor(float(clearance)) for clearance in clearances]
        axes.plot(1e3 * clearances, values, color=SERIES[name[:5]], ls=style, label=name)
        for clearance, mu in ((0.3, "0.8"), (0.5, "0.9"), (0.8, "1.0")):
            axes.plot(
                clearance, float(speeds[name][f"n_mu_{mu}"]), "x", color=SERIES[name[:5]], ms=10, mew=2.5
            )
    axes.plot([], [], "x", color=BLACK, ms=10, mew=2.5, label="published (Table 5)")
    axes.axvspan(1.0, 1.2, color="#eeeeee", zorder=0)
    axes.text(1.1, 880.0, "belt to be\nreplaced", ha="center", va="center", color="#555555")
    axes.set(
        xlabel="clearance of the belt in its guide, mm", ylabel="safe speed, rev/min", ylim=(0.0, 1050.0),
        xlim=(0.0, 1.2),
    )  # fmt: skip
    axes.legend(loc="upper right", bbox_to_anchor=(0.82, 1.0), ncols=2)
    axes.set_title("Safe speed as the guide wears (case I)", fontsize=12)


def wrapped(figure: "Figure") -> None:
    """Restraint load over the clearance."""
    axes = figure.subplots()
    clearances = np.linspace(0.08, 0.52, 100)
    rows = table("belt_wrap_experiment")
    for diameter, colour in zip(("367.8", "395.5", "430.0"), (BLUE, ORANGE, GREEN), strict=True):
        axes.plot(
            clearances, [wrap.load(diameter, str(c)) for c in clearances], color=colour,
            label=f"wheel {diameter} mm, equation (8)",
        )  # fmt: skip
        for row in rows:
            if row["D_mm"] == diameter:
                loads = [float(row[f"c_{c}"]) for c in wrap.CLEARANCES]
                places = [float(c) for c in wrap.CLEARANCES]
                axes.plot(places, loads, "o", color=colour, ms=5, mfc="none")
    axes.plot(0.1, 54.81, "x", color=RED, ms=11, mew=2.5, label="misprint: 54.81 N for 430.0 mm")
    axes.plot([], [], "o", color=BLACK, ms=5, mfc="none", label="measured, three wrap angles")
    axes.set(xlabel="clearance of the block, mm", ylabel="restraint load, N", ylim=(0.0, 90.0))
    axes.legend(loc="upper right")
    axes.set_title("Load that holds the belt on its wheel (Tables 2 and 3)", fontsize=12)


FIGURES: dict[str, tuple[float, Draw]] = {
    "travel.png": (8.0, travel),
    "belt_load.png": (5.0, belt_load),
    "speed_over_width.png": (5.0, speed_over_width),
    "speed_over_clearance.png": (5.0, speed_over_clearance),
    "wrap.png": (5.0, wrapped),
}
