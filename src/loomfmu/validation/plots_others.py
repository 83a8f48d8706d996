"""Figures of the reed, the detaching rollers and the numerical accuracy."""

import math
from typing import TYPE_CHECKING

import numpy as np

from ..components.detaching_roller import DetachingRoller
from . import accuracy, reed, roller
from .plot_style import BLACK, BLUE, GREEN, ORANGE, PURPLE, RED, Draw

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def reed_motion(figure: "Figure") -> None:
    """The reed over a revolution."""
    machine = reed.identified()
    turn = 2.0 * math.pi / reed.SPEED
    angles = np.linspace(-90.0, 270.0, 361)
    rows = []
    for angle in angles:
        machine.step(turn * angle / 360.0, 0.0)
        rows.append((1e3 * machine.position, 1e3 * machine.velocity, 1e3 * machine.acceleration))
    motion = np.array(rows).T
    panels = figure.subplots(3, 1, sharex=True)
    for panel, values, colour in zip(panels, motion, (BLUE, GREEN, ORANGE), strict=True):
        panel.plot(angles, values, color=colour)
    panels[0].plot([0.0, 180.0], [490.3, 330.2], "x", color=RED, ms=11, mew=2.5, label="published", zorder=5)
    panels[2].plot(0.0, -1159.7, "x", color=RED, ms=11, mew=2.5, zorder=5)
    panels[0].legend(loc="upper right")
    panels[0].set_ylabel("position, mm")
    panels[1].set_ylabel("velocity, mm/s")
    panels[2].set(
        ylabel="acceleration, mm/s²", xlabel="shaft angle from the beat-up, deg", xlim=(-90.0, 270.0),
        xticks=range(-90, 271, 45),
    )  # fmt: skip
    panels[0].set_title("Reed at 30 rev/min, identified geometry", fontsize=12)


def roller_torques(figure: "Figure") -> None:
    """Torques over a nip."""
    machine = DetachingRoller(speed=300.0 * roller.NIPS)
    machine.initialize(0.0)
    divisions = np.linspace(0.0, 39.999, 1200)
    period = 2.0 * math.pi / (300.0 * roller.NIPS)
    shown = {"M11": ORANGE, "M12": GREEN, "M13": BLUE, "M1": PURPLE, "M2": BLACK}
    rows = []
    for division in divisions:
        machine.step(period * division / 40.0, 0.0)
        rows.append([getattr(machine, roller.TORQUES[name]) for name in shown])
    axes = figure.subplots()
    for values, (name, colour) in zip(np.array(rows).T, shown.items(), strict=True):
        axes.plot(divisions, values, color=colour, ls="--" if name == "M2" else "-", label=name)
    published = ((23.8, 0.68), (18.4, 0.31), (18.4, 1.18), (18.4, 1.36), (25.0, -0.14), (25.0, -0.53),
                 (27.1, -0.46), (25.0, -0.61))  # fmt: skip
    axes.plot(
        *zip(*published, strict=True), "x", color=RED, ms=9, mew=2.0, label="published (Table 1)", zorder=5
    )
    axes.set(xlabel="division of the nip", ylabel="torque, N m", xlim=(0.0, 40.0), xticks=range(0, 41, 5))
    axes.legend(ncols=2, loc="upper right")
    axes.set_title("Detaching rollers at 300 nips/min; the motion is an assumption", fontsize=12)


def convergence(figure: "Figure") -> None:
    """Errors of the damper over the steps."""
    axes = figure.subplots()
    for (name, law, rpm, given), colour in zip(accuracy.CASES, (GREEN, BLUE, PURPLE, ORANGE), strict=True):
        errors = np.maximum(accuracy.damper_errors(law, rpm, **given), accuracy.DAMPER_FLOOR)
        axes.loglog(accuracy.DAMPER_STEPS, errors, "o-", color=colour, ms=5, label=name)
    steps = np.array([9.0, 72.0])
    axes.loglog(steps, 2e-2 * (steps / 9.0) ** -4, color=BLACK, ls=":", label="fourth order")
    axes.loglog(steps, 1e-6 * (steps / 9.0) ** -6, color=BLACK, ls="--", label="sixth order")
    axes.axhspan(1e-11, accuracy.DAMPER_FLOOR, color="#eeeeee", zorder=0)
    axes.text(1100.0, 3e-11, "rounding", ha="right", va="center", color="#555555")
    axes.set(
        xlabel="steps in a revolution", ylabel="largest error of the displacement, share of the peak",
        xticks=accuracy.DAMPER_STEPS, xticklabels=[str(n) for n in accuracy.DAMPER_STEPS], ylim=(1e-11, 1e-1),
    )  # fmt: skip
    axes.minorticks_off()
    axes.legend(loc="upper right")
    axes.set_title("HealdDamper against an independent integration", fontsize=12)


FIGURES: dict[str, tuple[float, Draw]] = {
    "reed.png": (8.0, reed_motion),
    "roller.png": (5.0, roller_torques),
    "accuracy.png": (5.0, convergence),
}
