"""Misprints of the papers on the reed and on the detaching rollers."""

import math

from ..design.reed import crank_rocker_without_quick_return, frame_angle_for
from ..physics.detaching_roller import top_roller_torque
from . import reed, roller
from .sections import Row, Section, number

HEADINGS = ("where", "printed", "corrected", "what is wrong with the printed form")


def sections() -> tuple[Section, ...]:
    """Both papers."""
    return (
        Section("Reed beat-up", HEADINGS, of_reed()),
        Section("Detaching rollers", HEADINGS, of_roller()),
    )


def of_reed() -> tuple[Row, ...]:
    """Section 3.3."""
    rows = []
    for printed, smallest in ((8.906, 40.0), (29.354, 76.0)):
        right = math.degrees(frame_angle_for(reed.SWING, math.radians(smallest)))
        swing = 2.0 * math.asin(math.sin(math.radians(printed)) * math.cos(math.radians(smallest)))
        found = crank_rocker_without_quick_return(reed.ROCKER, reed.SWING, math.radians(printed))[3]
        rows.append(
            Row(
                (
                    f"section 3.3, smallest transmission angle of {number(smallest, 0)} deg",
                    f"frame angle {number(printed, 3)} deg",
                    f"{number(right, 3)} deg",
                    f"by (13) the printed one requires a swing of {number(math.degrees(swing), 3)} deg, not"
                    f" the source's 13.610, with which it gives {number(math.degrees(found), 2)} deg",
                )
            )
        )
    return tuple(rows)


def of_roller() -> tuple[Row, ...]:
    """Tables 1 and 2, text."""
    j2 = top_roller_torque(1.18 / roller.ROLLER_INERTIA, roller.ROLLER, roller.TOP, roller.TOP_INERTIA)
    peak = number(1.18 / roller.ROLLER_INERTIA, 0)
    return (
        Row(("Table 1, valleys of M12, M13, M1, M2; Table 2, all valleys", "0.14, 0.53, 0.46, 0.61 N m, ..",
             "the same with a minus",
             "the rollers turn back, turn forward and stop in each nip: an inertia torque that is never below"
             " 0.53 N m would only speed them up")),
        Row(("section 4.1, inertias", "135.64e-6 and 33.98e-6 kg mm2", "kg m2",
             f"M13 = 1.18 N m is {peak} rad/s2 with kg m2; as printed it would be a million times that")),
        Row(("Table 1, M2", "peak 1.36, valley 0.61 N m",
             f"peak {number(1.18 + j2, 3)}, valley {number(-0.53 * (1.18 + j2) / 1.18, 3)} N m",
             f"by (13) 0.31 + 1.18 = {number(0.31 + 1.18, 2)} and 0.14 + 0.53 = {number(0.14 + 0.53, 2)}; M1,"
             " M and M0 repeat the slip")),
        Row(("Table 2, valley of M0 at 400 nips/min", "at division 18.4", "at 26.1",
             "its peak is at 18.4; M, an eighth of it, has its valley at 26.1")),
        Row(("section 4.3 against Table 2", "M0 rises to 60.65 N m", f"{number(8.0 * 7.57, 2)} N m",
             f"8 times 7.57; a growth of 177 % from 21.84 gives {number(21.84 * 2.77, 1)}")),
        Row(("section 4.2 (2)", "the peak of M is that of M11 and M12", "that of M1 and M2",
             f"0.68 + 0.31 = {number(0.68 + 0.31, 2)} N m, 1.36 + 1.36 = {number(1.36 + 1.36, 2)}; 2.73 is"
             " printed")),
    )  # fmt: skip
