"""Korolev, section 4.1: the shed that an air stream needs, by the functions of `design.shed`."""

import math

from ..design.shed import TABLE_4_2, greatest_height, shed_angle, stream_shed_height
from .sections import Row, Section, number

CONFUSER = "10 mm"
ABOVE, BELOW = "5 mm", "1.5 mm"  # Table 4.1
FRAME = 6.0  # Appendix 2: frame over warp


def section() -> Section:
    """What (4.1) and (4.3) make of the scale of Appendix 2, and the angles of Table 4.2."""
    height = stream_shed_height(CONFUSER, ABOVE, BELOW)
    entry = [float(TABLE_4_2[1].split()[0]), float(TABLE_4_2[3].split()[0]) - 360.0]
    leave = [float(TABLE_4_2[0].split()[0]), float(TABLE_4_2[2].split()[0]) - 360.0]
    return Section(
        "Section 4.1: angle and greatest height of the shed, (4.1) and (4.3) (computed)",
        ("quantity", ""),
        (
            *(
                Row((f"angle of the shed with the stream {near} mm from the fell, deg, (4.1)",
                     number(math.degrees(shed_angle(height, f"{near} mm")), 3)))
                for near in (60, 80, 100)
            ),
            *(
                Row((f"greatest height at the healds, six times as far, mm, (4.3), {near} mm",
                     number(1e3 * greatest_height(shed_angle(height, f"{near} mm"), 6e-3 * near), 2)))
                for near in (60, 80, 100)
            ),
            Row(("six times the height on the axis, mm, Appendix 2", number(FRAME * 1e3 * height, 2))),
            Row(("pick's angle of the entry, raised and lowered warp, deg",
                 " and ".join(number(each, 0) for each in entry))),
            Row(("pick's angle of the exit, raised and lowered warp, deg",
                 " and ".join(number(each, 0) for each in reversed(leave)))),
        ),
        remarks=(
            "Inference: the source publishes neither l_c nor l_1. The scale of 6 from the warp to the frame"
            " in Appendix 2 is l_1 / l_c by (4.1) and (4.3), to the 1 % by which they differ.",
            "Inference: (4.1) takes the whole height over the distance, (4.3) halves the angle as if the shed"
            " were symmetric; so (4.3) falls short of the ratio of the distances by the square of the slope.",
            "Inference: (4.4) to (4.7) set the confuser in the middle of the shed, while (4.2) leaves 5 mm"
            " above it and 1.5 mm below.",
            "Table 4.2 has the weft enter and leave at other angles in the pick with the warp raised than in"
            " the pick with it lowered. The source allows for that with different gaps, but does not explain"
            " it.",
        ),
    )  # fmt: skip
