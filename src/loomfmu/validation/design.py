"""What the design functions make of numbers that the sources give or leave out: belt, reed, dobby."""

import math

from ..design import guidance, loom
from ..design.dobby import eccentric_chain
from . import shed
from .belt import fits, rpm, safe
from .reed import PRESSURE, SLOPE, SWING, identified
from .sections import Chapter, Row, Section, number

LOOM = "WL680-3600"


def chapter() -> Chapter:
    """All of them."""
    return Chapter(
        "Design",
        "What the design functions compute where the sources give a method but no numbers to compare. What"
        " we had to infer is marked as an inference.",
        (over_speed(), weft_direction(), own_tests(), chain(), shed.section(), rigid_body()),
    )


def over_speed() -> Section:
    """Zhu 4.2: the speed that a permitted deflection allows."""
    limit = rpm(safe(LOOM, "G6300 left", 0.8))
    rows = []
    for allowed in (1, 2, 4, 8, 16, 32):
        speed = rpm(loom.safe_speed(LOOM, length_factor=0.8, deflection=f"{allowed} mm"))
        rows.append(Row((str(allowed), number(speed, 3), number(100.0 * (speed / limit - 1.0), 4))))
    return Section(
        f"Section 4.2: speed allowed for a given deflection ({LOOM}, mu = 0.8, case I; computed)",
        ("deflection, mm", "speed, rev/min", "above the safe speed, %"),
        tuple(rows),
        intro="The source corrects the safe speed so that the belt bends by no more than 2 mm, but prints no"
        " speed. Computed: exact elastica of a belt at rest, the lowest speed over the window.",
        remarks=(
            "The source's conclusion is reproduced: 2 mm allow less than 0.1 rev/min more, 1 rev/min more"
            " bends the belt by 8 mm.",
        ),
    )


def weft_direction() -> Section:
    """Zhu 4.3: which head's belt the weft compresses."""
    rows = []
    for tension in (0.0, 5.0, 10.0, 20.0):
        giver = loom.safe_speed(LOOM, "G6300 left", length_factor=1.0, tension=tension)
        taker = loom.safe_speed(LOOM, "G6300 right", length_factor=1.0)
        back = loom.safe_speed(LOOM, "G6300 right", length_factor=1.0, tension=-tension)
        speeds = (number(rpm(each), 1) for each in (giver, taker, back))
        rows.append(Row((number(tension, 0), *speeds)))
    return Section(
        f"Section 4.3: safe speed of giver and taker, rev/min ({LOOM}, mu = 1; computed)",
        ("weft tension, N", "giver (left head), way in", "taker (right head), way in", "taker, way back"),
        tuple(rows),
        intro="Inference: section 1 of the source has the left head bring the weft to the middle and the"
        " right head draw it out. So the weft compresses the giver's belt on the way in, relieves the take"
        " the way back, and bears on neither belt while its head is empty.",
        remarks=(
            "Table 7 counts the tension as compression for all four heads. By the source's own description"
            " that holds for its left heads, I and III; the right heads, II and IV, go in empty.",
        ),
    )


def own_tests() -> Section:
    """Zhu 3.2: how well the tests determine the length factor."""
    rows = []
    for clearance, fit in fits().items():
        error = max(abs(each) for each in fit.residuals)
        cells = (number(fit.factor, 4), number(fit.standard_error, 4), number(error, 2))
        rows.append(Row((clearance, *cells)))
    return Section(
        "Section 3.2: how well the tests of Table 2 determine the length factor (computed)",
        ("clearance, mm", "length factor", "standard error", "largest residual, N"),
        tuple(rows),
        intro="Least squares as for Table 3, by `design.buckling`; the loads are printed in whole newtons.",
    )


def rigid_body() -> Section:
    """Yuan 2.1: the joint from two, three and five places of the rod."""
    reed = identified()
    middle = math.atan2(1.0, -SLOPE)
    rows = []
    for places, slope in ((2, -PRESSURE), (3, None), (5, None)):
        shares = [-0.5 + k / (places - 1) for k in range(places)]
        arms = [middle + share * SWING for share in shares]
        joints = [(reed.arm_length * math.cos(a), reed.arm_length * math.sin(a)) for a in arms]
        tilts = [math.asin((reed.reed_height - y) / reed.rod_length) for _x, y in joints]
        points = [
            (x + reed.rod_length * math.cos(tilt), reed.reed_height)
            for (x, _y), tilt in zip(joints, tilts, strict=True)
        ]
        joint = guidance.guided_joint(points, [tilt - tilts[0] for tilt in tilts], slope)
        lengths = [number(1e3 * length, 2) for length in (joint.arm, joint.rod)]
        swing = number(math.degrees(joint.swing), 3)
        rows.append(Row((f"{places} places", *lengths, swing)))
    return Section(
        "Section 2.1: rigid-body guidance of the reed's rod, (1) to (8) (computed)",
        ("from", "arm, mm", "rod, mm", "swing, deg"),
        tuple(rows),
        intro="The places are those of the identified machine, so this proves the method and not the machine."
        " Two places take the pressure angle of -1.235 deg with them; more do without.",
        remarks=(
            "Inference: (3) and the coefficients of (4) are lost; both were derived anew from the"
            " displacement of the rod. The source designs for two places (j = 2).",
        ),
    )  # fmt: skip


def chain() -> Section:
    """Korolev 1.2: what an eccentric chain can do."""
    rows = []
    for share in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6):
        drive = eccentric_chain("60 mm", "60 mm", 0.06 * share, "600 mm")
        low, high = drive.extremes()
        rows.append(Row((number(share, 1), number(low, 4), number(high, 4), number(1.0 - low, 4))))
    return Section(
        "Section 1.2: speed of a dobby's shaft by an eccentric chain, `w1 r1 = w2 h` (computed)",
        ("eccentricity over radius", "lowest speed ratio", "highest speed ratio", "slow-down zeta"),
        tuple(rows),
        intro="Two equal sprockets, ten radii apart; the source gives no dimensions, these are our own.",
        remarks=(
            "The source finds that an eccentric chain does not slow the shaft enough. At zeta = 0.3 it would"
            " have to run 1.75 times as fast elsewhere, where the sloped laws at zeta = 0.7 take 1.4.",
            "Inference: h is the distance of the driven shaft from the taut strand. The source calls it the"
            " eccentricity, with which the speed would be constant.",
            "The angle of knives and hooks, (1.4) to (1.11), is `design.dobby.hook_angle`. Of its dimensions"
            " only eta is published, so the largest angle of 1.5 deg cannot be recomputed. (1.11)"
            " contradicts (1.6) in the sign of its second arc cosine.",
        ),
    )
