"""Korolev, the spline cam: Tables 4.1 and 4.2, sections 4.1 and 4.2, Appendices 2 and 3."""

import math
from functools import cache

import numpy as np

from ..components.dobby.drive import DobbyDrive
from ..design.cam import Cam, design_cam, published_path
from ..machines import table
from ..physics.rotor_laws.shed_cam import SPLINE_CAM
from . import rotor
from .sections import Pair, Row, Section, consistent, number

FRAME = 6.0  # travel of the frame over the height of the warp, Appendix 2
HEIGHT = 0.015  # m, of the warp above the lowest: what has to be clear of the air stream
CONFUSER = 10.0  # mm, diameter D_k
GAPS = {"1+3": 5.0, "2": 1.5, "4": 1.75, "5": 1.75, "6": 1.25, "7": 1.25}  # mm, Table 4.1


@cache
def drive() -> DobbyDrive:
    """The drive with the spline cam, which begins to rise at shaft angle 0, at 1 rad/s."""
    found = DobbyDrive(law=SPLINE_CAM, slow_point=0.0, speed=1.0)
    found.initialize(0.0)
    return found


def frame_span() -> float:
    """Largest travel of the frame [m]."""
    return FRAME * drive().cam_span


@cache
def cam() -> Cam:
    """The cam of Appendix 2."""
    return design_cam()


def sections() -> tuple[Section, ...]:
    """Everything on the cam."""
    return table_4_2(), extremes(), other_drives(), profile(), program()


def table_4_2() -> Section:
    """Heights of the warp from the gaps of Table 4.1."""
    h = CONFUSER + GAPS["1+3"] + GAPS["2"]
    low, high = 0.5 * (h - CONFUSER), 0.5 * (h + CONFUSER)
    printed = {row["shaft_angle_deg"]: row["warp_height_mm"] for row in table("shed_control_points")}
    return Section(
        "Tables 4.1 and 4.2: heights of the warp at the control points, mm",
        ("quantity", ""),
        (
            Row(("height of the shed on the axis of the air stream, (4.2)", consistent("16.5", h, 2))),
            Row(("entry, lower warp, 657 deg, (4.4)", consistent(printed["657"], low - GAPS["5"], 2)),
                "Table 4.2 prints 657: see Errata"),
            Row(("entry, upper warp, 295 deg, (4.5)", consistent(printed["295"], high + GAPS["4"], 2))),
            Row(("exit, lower warp, 80 deg, (4.6)", consistent(printed["80"], low - GAPS["7"], 2))),
            Row(("exit, upper warp, 450 deg, (4.7)", consistent(printed["450"], high + GAPS["6"], 2))),
        ),
    )  # fmt: skip


def extremes() -> Section:
    """Peaks of the spline."""
    of, span, w = drive(), frame_span(), 500.0 * math.pi / 30.0
    speed, acceleration = span * of.highest_speed, span * of.highest_acceleration
    above = math.degrees(of.angle_above(of.cam_height[0] + HEIGHT))
    return Section(
        "Section 4.2, Figures 4.5 to 4.8: the spline through the control points",
        ("quantity", ""),
        (
            Row(("warp above 15 mm, deg of shaft angle (conclusion 5 of section 4)",
                 Pair("140", above, 1, sense=">="))),
            Row(("largest travel of the frame, mm", number(1e3 * span, 2))),
            Row(("lowest position of the frame, relative to its start, mm", number(1e3 * _lowest(), 3))),
            Row(("highest speed of the frame at a shaft speed of 1 rad/s, mm/s", number(1e3 * speed, 2))),
            Row(("highest acceleration of the frame at 1 rad/s, mm/s2", number(1e3 * acceleration, 2))),
            Row(("highest jerk of the frame at 1 rad/s, mm/s3", number(1e3 * span * of.highest_jerk, 2))),
            Row(("highest speed at 500 rev/min, m/s", number(speed * w, 3))),
            Row(("highest acceleration at 500 rev/min, m/s2", number(acceleration * w * w, 2))),
            Row(("dwell within 1.5 % of the travel, deg", number(math.degrees(of.dwell_angle), 2))),
            Row(("jump of the acceleration where two picks join, at 1 rad/s, mm/s2",
                 number(1e3 * FRAME * abs(of.cam_bend[5] - of.cam_bend[0]), 2))),
        ),
        remarks=(
            "The figures that show these curves are lost; only the 140 deg are given in the text.",
        ),
        figures=(("spline_cam.png", "Travel, speed and acceleration of a frame on the spline cam (Figures"
                                    " 4.6 to 4.8)"),),
    )  # fmt: skip


def other_drives() -> Section:
    """How much faster frames move under the laws of the modulator."""
    faster = {
        law: rotor.largest_lift_rate(law, 0.7, order=1) / drive().highest_speed
        for law in ("uniform", *rotor.MODULATED)
    }
    most = max(faster.values())
    by_law = ", ".join(f"{law} {number(found, 2)}" for law, found in faster.items())
    return Section(
        "Section 4.2: largest speed of a frame over that with the spline cam, at equal stroke",
        ("drive", ""),
        (
            Row(("slotted levers and differential, the modulator", Pair("2.1", most, 2))),
            Row(("cam drive of the STB", Pair("2.4", most, 2))),
            Row(("knife dobby SKN-14", Pair("3.2", most, 2))),
        ),
        intro="Computed: the most that a published law gives, zeta = 0.7. Laws of the other two drives, and"
        " all strokes, are not published.",
        remarks=(f"By law: {by_law}. Larger strokes of the other drives would make up the difference.",),
    )


def _lowest() -> float:
    """Lowest position of the frame [m]: the spline dips below its start."""
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        lambda x: drive().cam(x)[0], bounds=(0.0, 0.3), method="bounded", options={"xatol": 1e-10}
    )
    return frame_span() * float(found.fun)


def profile() -> Section:
    """The cam of Appendix 2."""
    of = cam()
    radii = 1e3 * np.hypot(*of.profile.T)
    path = 1e3 * np.hypot(*of.path.T)
    pressure = np.degrees(of.pressure_angle)
    hollow = 1e3 * of.curvature_radius[of.curvature_radius < 0.0]
    return Section(
        "Appendix 2: the cam",
        ("quantity", ""),
        (
            Row(("scale from travel to radius, 23 mm over 0.108 m", consistent("212.963", 23.0 / 0.108, 3)),
                "the travel is not 108 mm: see Errata"),
            Row(("lowest radius of the working profile, mm",
                 Pair("84", float(radii.min()), 2, used=True)), "put in"),
            Row(("highest radius of the working profile, mm",
                 Pair("107", float(radii.max()), 2, used=True)), "put in"),
            Row(("highest radius with the printed scale, mm", number(84.0 + 212.963 * frame_span(), 2)),
                "less than 107: see Errata"),
            Row(("path of the cutter: lowest radius, mm", number(float(path.min()), 2))),
            Row(("path of the cutter: highest radius, mm", number(float(path.max()), 2))),
            Row(("largest pressure angle while it rises, deg", number(float(pressure.max()), 2))),
            Row(("largest pressure angle while it falls, deg", number(-float(pressure.min()), 2))),
            Row(("smallest radius of curvature, crests, mm",
                 number(1e3 * float(of.curvature_radius[of.curvature_radius > 0.0].min()), 2))),
            Row(("smallest radius of curvature, hollows, mm",
                 number(-float(hollow.max()), 2) if hollow.size else "none")),
            Row(("largest distance of the source's radial offset of 19 mm inside the true one, mm",
                 number(-1e3 * float(of.radial_excess().min()), 3))),
        ),
        figures=(("cam_profile.png", "Working and equidistant profile of the cam (Figure 4.9)"),),
    )  # fmt: skip


def program() -> Section:
    """The program of Appendix 3."""
    radii = 1e3 * np.hypot(*published_path().T) - 19.0
    return Section(
        "Appendix 3: the cutter's path minus the cutter's radius of 19 mm",
        ("quantity", ""),
        (
            Row(("lowest radius, mm", Pair("84", float(radii.min()), 2, misprint=True))),
            Row(("highest radius, mm", Pair("107", float(radii.max()), 2, misprint=True))),
            Row(("lift, mm", Pair("23", float(np.ptp(radii)), 2, misprint=True))),
        ),
        intro="Published: the radii of Appendix 2. Computed: the radii of the points in the program of"
              " Appendix 3.",
    )  # fmt: skip
