"""Yuan and others, the reed beat-up mechanism."""

import math

from ..components.reed_beat_up import ReedBeatUp
from ..design.reed import crank_place, crank_rocker_without_quick_return, frame_angle_for, reed_dyad
from .sections import Chapter, Pair, Row, Section, number

ROCKER = 0.550
SWING = math.radians(13.610)
SLOPE = 0.1154
PRESSURE = math.radians(1.235)
SPEED = math.pi  # 30 rev/min, identified
FRAME_ANGLE = 15.0  # deg, identified


def identified(frame_angle: float = FRAME_ANGLE, pressure: float = -PRESSURE) -> ReedBeatUp:
    """The machine for a frame angle [deg]: crank-rocker and dyad by the source's synthesis, not rounded."""
    crank, coupler, _frame, _smallest = crank_rocker_without_quick_return(
        ROCKER, SWING, math.radians(frame_angle)
    )
    x, y = crank_place(ROCKER, SWING, SLOPE, math.radians(frame_angle))
    arm, rod, height = reed_dyad(0.490, 0.330, SWING, SLOPE, pressure)
    found = ReedBeatUp(
        crank_length=crank, coupler_length=coupler, rocker_length=ROCKER, crank_x=x, crank_y=y,
        arm_length=arm, rod_length=rod, reed_height=height, speed=SPEED,
    )  # fmt: skip
    found.initialize(0.0)
    return found


def chapter() -> Chapter:
    """All of the reed."""
    return Chapter(
        "Reed beat-up (Yuan and others, Journal of Textile Research (2017), 10.13475/j.fzxb.20170102406)",
        "The source's tables and most of its equations are lost. The frame angle of 15 deg, the speed of 30"
        " rev/min, the side of the reed's line and the position of the crank were identified from the"
        " published acceleration. Arm, rod and height follow from the reed's limits and"
        " its transmission angle at the front by the source's synthesis.",
        (synthesis(), motion(), over_frame_angle()),
    )


def synthesis() -> Section:
    """Crank-rocker."""
    crank, *_rest, limit = crank_rocker_without_quick_return(ROCKER, SWING, math.pi / 2.0)
    pairs = {b: math.degrees(frame_angle_for(SWING, math.radians(b))) for b in (40.0, 76.0)}
    smallest = {
        b: math.degrees(crank_rocker_without_quick_return(ROCKER, SWING, math.radians(b))[3])
        for b in (8.906, 29.354)
    }
    offset = 1e3 * ROCKER * math.cos(0.5 * SWING) * math.hypot(1.0, SLOPE)
    ratio = {b: math.tan(math.radians(b)) / math.tan(0.5 * SWING) for b in (9.0, 19.0, 20.0, 30.0)}
    return Section(
        "Section 3.3, Figure 4, Tables 3 and 4: crank-rocker for a rocker of 550 mm and a swing of 13.610"
        " deg",
        ("quantity", ""),
        (
            Row(("crank l1, mm", Pair("65.168", 1e3 * crank, 3))),
            Row(("crank over rocker", Pair("0.119", crank / ROCKER, 4))),
            Row(("frame angle for a smallest transmission angle of 40 deg, deg",
                 Pair("8.906", pairs[40.0], 3, place=True, misprint=True))),
            Row(("frame angle for 76 deg, deg", Pair("29.354", pairs[76.0], 3, place=True, misprint=True))),
            Row(("smallest transmission angle at 8.906 deg, deg", Pair("40", smallest[8.906], 2))),
            Row(("smallest transmission angle at 29.354 deg, deg", Pair("76", smallest[29.354], 2))),
            Row(("its limit for a frame angle of 90 deg, deg", Pair("83.195", math.degrees(limit), 3))),
            Row(("line of the crank's centres, y at x = 0, mm", Pair("549.75", offset, 2))),
            Row(("coupler over crank at 19 deg", Pair("3", ratio[19.0], 3, sense="<="))),
            Row(("coupler over crank at 20 deg", Pair("3", ratio[20.0], 3, sense=">="))),
            Row(("coupler over crank at 30 deg", Pair("6", ratio[30.0], 3, sense="<="))),
        ),
    )  # fmt: skip


def _lengths(of: ReedBeatUp) -> str:
    """Arm, rod and height in mm."""
    return " / ".join(number(1e3 * length, 2) for length in (of.arm_length, of.rod_length, of.reed_height))


def motion() -> Section:
    """Motion of the machine."""
    reed = identified()
    above = identified(pressure=PRESSURE)
    return Section(
        "Sections 3.2 and 3.4, Figures 5 and 6: motion of the reed",
        ("quantity", ""),
        (
            Row(("transmission angle of rod and reed at the front dead centre, deg",
                 Pair("88.765", 90.0 - abs(math.degrees(reed.pressure_angle)), 3, used=True)),
                "put in as 90 deg - 1.235 deg"),
            Row(("front limit, mm", Pair("490.3", 1e3 * reed.front_limit, 2, used=True)), "490 put in"),
            Row(("back limit, mm", Pair("330.2", 1e3 * reed.back_limit, 2, used=True)), "330 put in"),
            Row(("stroke, mm", Pair("160.1", 1e3 * reed.stroke, 2, used=True)), "follows from the limits"),
            Row(("acceleration at the front dead centre, mm/s2",
                 Pair("-1159.7", 1e3 * reed.acceleration, 1, used=True)),
                "the geometry was identified from it"),
            Row(("the same with the reed's line above the arm, mm/s2", number(1e3 * above.acceleration, 1))),
            Row(("arm, rod, height, mm", _lengths(reed))),
            Row(("the same with the reed's line above the arm, mm", _lengths(above))),
        ),
        remarks=(
            "The design specifies 490, 330 and 160 mm; the source states that its machine deviates from"
            " each by 0.06 %.",
        ),
        figures=(("reed.png", "Position, velocity and acceleration of the reed at 30 rev/min (Figure 6)"),),
    )  # fmt: skip


def over_frame_angle() -> Section:
    """Figure 5: the smaller the angle, the larger the acceleration at the front."""
    rows = []
    for angle in (10.0, 15.0, 20.0, 30.0):
        reed = identified(angle)
        smallest = number(math.degrees(reed.smallest_transmission_angle), 2)
        rows.append(Row((number(angle, 0), number(1e3 * reed.acceleration, 1), smallest)))
    return Section(
        "Figure 5: acceleration at the front dead centre over the frame angle (computed)",
        ("frame angle, deg", "acceleration, mm/s2", "smallest transmission angle, deg"),
        tuple(rows),
        remarks=("Its magnitude grows as the frame angle decreases, as the source says.",),
    )
