"""Figures of the dobby, its frames and its cam."""

import math
from typing import TYPE_CHECKING

import numpy as np

from ..components.heald_damper import HealdDamper
from ..machines import table
from . import cam, loads, rotor
from .chain import HealdLine
from .plot_style import BLACK, BLUE, GREEN, GREY, LAW_COLOURS, ORANGE, RED, Draw

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ALL_LAWS = (*rotor.LAWS, *rotor.MECHANISMS, *rotor.INFERRED)


def rotor_laws(figure: "Figure") -> None:
    """Speed and acceleration of the rotor."""
    panels = figure.subplots(2, 1, sharex=True)
    angles = np.linspace(0.0, 2.0 * math.pi, 721)
    for law in ALL_LAWS:
        motion = np.array([rotor.rotor(law, 0.7, angle) for angle in angles])
        style = "-" if law in rotor.LAWS else "--"
        for panel, column in zip(panels, (1, 2), strict=True):
            panel.plot(np.degrees(angles), motion[:, column], style, color=LAW_COLOURS[law], label=law)
    panels[0].axhline(1.4, color=BLACK, lw=1.0, ls=":")
    panels[0].text(358.0, 1.43, "published 1.4", ha="right", va="bottom", fontsize=10)
    panels[1].plot(22.5, 1.6, "x", color=RED, ms=11, mew=2.5, label="published 1.6, harmonic ends", zorder=5)
    panels[0].set(ylabel="S' = rotor speed / shaft speed", ylim=(0.0, 3.0))
    panels[1].set(
        ylabel="S'' = acceleration at 1 rad/s", xlabel="shaft angle from the slow point, deg",
        xlim=(0.0, 360.0), xticks=range(0, 361, 45),
    )  # fmt: skip
    handles, labels = panels[1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4, fontsize=10)
    panels[0].set_title("Rotor laws at zeta = 0.7 (dashed: assumed or inferred dimensions)", fontsize=12)


def dwell(figure: "Figure") -> None:
    """Dwell over the speed reduction."""
    axes = figure.subplots()
    reductions = np.linspace(0.0, 0.8, 81)
    for law in (*rotor.LAWS, *rotor.INFERRED):
        values = [math.degrees(rotor.new_drive(law, float(z)).dwell_angle) for z in reductions]
        style = "-" if law in rotor.LAWS else "--"
        axes.plot(reductions, values, style, color=LAW_COLOURS[law], label=law)
    rows = table("heald_dwell_experiment")
    axes.plot(
        [float(row["speed_reduction"]) for row in rows], [float(row["upper_dwell_deg"]) for row in rows], "o",
        color=BLACK, ms=8, label="measured (Table 3.1)",
    )  # fmt: skip
    axes.set(
        xlabel="speed reduction zeta", ylabel="conditional dwell, deg of shaft angle", xlim=(0.0, 0.8),
        ylim=(40.0, 150.0),
    )  # fmt: skip
    axes.legend(loc="upper left")
    axes.set_title(
        "Dwell within 1.5 % of the stroke: measured and by the laws (dashed: inferred)", fontsize=12
    )


def dobby_loads(figure: "Figure") -> None:
    """Peaks of the loads of a frame over the speed reduction."""
    panels = figure.subplots(2, 1, sharex=True)
    reductions = np.linspace(0.0, 0.8, 17)
    cases: tuple[tuple[str, str, dict[str, float]], ...] = (
        ("-", "15 kg, inertia alone", {}),
        ("--", "6.5 kg, inertia and warp", {"mass": 6.5, "warp": loads.WARP}),
    )
    for law in loads.LAWS:
        for style, case, given in cases:
            peaks = [loads.peaks(law, float(z), **given) for z in reductions]
            for panel, values in zip(
                panels,
                ([each.frame_force.value for each in peaks], [each.rotor_torque.value for each in peaks]),
                strict=True,
            ):
                panel.plot(reductions, np.abs(values), style, color=LAW_COLOURS[law], label=f"{law}, {case}")
    for panel in panels:
        panel.axvspan(0.4, 0.5, color=GREY, alpha=0.3, lw=0.0)
    panels[0].set(ylabel="force on a frame, N", ylim=(0.0, None))
    panels[1].set(
        ylabel="torque on the rotor, N m", xlabel="speed reduction zeta", xlim=(0.0, 0.8), ylim=(0.0, None)
    )
    handles, labels = panels[1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=2, fontsize=10)
    panels[0].set_title("Peaks at 280 picks/min (grey: least loads by the source)", fontsize=12)


def heald(figure: "Figure") -> None:
    """A frame and its carrier."""
    steps, picks = 720, 4
    line = HealdLine(250.0, steps)
    damper = HealdDamper(inputs_at_step_end=True)
    line.feed(damper)
    damper.initialize(0.0)
    rows = []
    for _ in range(picks * steps):
        before = line.time
        line.advance()
        line.feed(damper)
        damper.step(before, line.step_size)
        frame = line.heald
        rows.append(
            (
                1e3 * frame.lift, 1e3 * (frame.lift + damper.displacement), frame.velocity,
                frame.velocity + damper.rate, frame.acceleration, damper.carrier_acceleration,
            )
        )  # fmt: skip
    angles = 360.0 * np.arange(1, picks * steps + 1) / steps
    motion = np.array(rows).T
    panels = figure.subplots(3, 1, sharex=True)
    for panel, of_frame, of_carrier in zip(panels, motion[::2], motion[1::2], strict=True):
        panel.plot(angles, of_carrier, color=ORANGE, lw=1.3, label="carrier on its springs")
        panel.plot(angles, of_frame, color=BLUE, label="frame")
    for panel, label in zip(panels, ("lift, mm", "velocity, m/s", "acceleration, m/s²"), strict=True):
        panel.set_ylabel(label)
    panels[0].legend(loc="upper right", ncols=2, bbox_to_anchor=(1.0, 1.22))
    panels[2].set(xlabel="shaft angle, deg", xlim=(0.0, 360.0 * picks), xticks=range(0, 360 * picks + 1, 180))
    panels[0].set_title("Plain weave, 250 rev/min, sloped sine", fontsize=12, loc="left")


def spline_cam(figure: "Figure") -> None:
    """Frame on the spline cam."""
    panels = figure.subplots(3, 1, sharex=True)
    angles = np.linspace(0.0, 4.0 * math.pi, 1441)
    drive, span = cam.drive(), 1e3 * cam.frame_span()
    motion = span * np.array([drive.cam(min(x, 4.0 * math.pi - 1e-12)) for x in angles])
    for panel, column, colour in zip(panels, motion.T, (BLUE, GREEN, ORANGE), strict=True):
        panel.plot(np.degrees(angles), column, color=colour)
    rows = table("shed_control_points")
    panels[0].plot(
        [float(row["shaft_angle_deg"]) for row in rows],
        [cam.FRAME * float(row["warp_height_mm"]) for row in rows], "x", color=RED, ms=10, mew=2.5,
        label="control points (Table 4.2) times 6",
    )  # fmt: skip
    panels[0].axhline(1e3 * cam.FRAME * cam.HEIGHT, color=GREY, lw=1.0, ls=":")
    panels[0].text(5.0, 92.0, "warp at 15 mm", fontsize=10, color="#555555")
    panels[0].legend(loc="lower center")
    panels[0].set(ylabel="travel, mm", ylim=(-5.0, 105.0))
    panels[1].set_ylabel("speed, mm/s")
    panels[2].set(
        ylabel="acceleration, mm/s²", xlabel="shaft angle from the start of the rise, deg", xlim=(0.0, 720.0),
        xticks=range(0, 721, 90),
    )  # fmt: skip
    panels[0].set_title("Frame on the spline cam at a shaft speed of 1 rad/s", fontsize=12)


def cam_profile(figure: "Figure") -> None:
    """The cam."""
    axes = figure.subplots()
    of = cam.cam()
    profile, path = 1e3 * of.profile, 1e3 * of.path
    turn = np.linspace(0.0, 2.0 * math.pi, 361)
    axes.plot(84.0 * np.cos(turn), 84.0 * np.sin(turn), color=GREY, lw=1.0, ls=":", label="circle of 84 mm")
    axes.plot(*profile.T, color=BLUE, label="working profile")
    axes.plot(*path.T, color=ORANGE, ls="--", label="equidistant, 19 mm: path of the cutter")
    place = len(profile) // 8
    axes.plot(
        path[place, 0] + 19.0 * np.cos(turn), path[place, 1] + 19.0 * np.sin(turn), color=GREEN, lw=1.2,
        label="cutter",
    )  # fmt: skip
    axes.plot(0.0, 0.0, "+", color=BLACK, ms=12)
    axes.set(xlabel="x, mm", ylabel="y, mm", aspect="equal", xlim=(-140.0, 140.0), ylim=(-140.0, 140.0))
    figure.legend(loc="outside lower center", ncols=2)
    axes.set_title("Cam of Appendix 2, one turn for two picks", fontsize=12)


FIGURES: dict[str, tuple[float, Draw]] = {
    "dobby_loads.png": (7.0, dobby_loads),
    "rotor_laws.png": (8.0, rotor_laws),
    "dwell.png": (5.0, dwell),
    "heald.png": (8.0, heald),
    "spline_cam.png": (8.0, spline_cam),
    "cam_profile.png": (8.6, cam_profile),
}
