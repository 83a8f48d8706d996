"""Korolev, the cyclograms of the two dobbies, section 2.5."""

import math

from ..machines import table
from .sections import Row, Section, consistent, number

STROKE, GAP = 11.4, 3.0  # mm, of the needles, and their distance from the tape
PICKS = 720.0  # deg, of a cyclogram


def phase(dobby: str, part: str, name: str) -> tuple[float, float]:
    """Begin and end of a phase [deg over two picks], as printed."""
    row = next(r for r in table("cyclograms") if (r["dobby"], r["part"], r["phase"]) == (dobby, part, name))
    return float(row["from_deg"]), float(row["to_deg"])


def total(dobby: str, part: str) -> float:
    """Sum of all phases of a part [deg]."""
    rows = [r for r in table("cyclograms") if (r["dobby"], r["part"]) == (dobby, part)]
    return sum(float(row["to_deg"]) - float(row["from_deg"]) for row in rows)


def needle_place(share: float, begin: float, end: float) -> float:
    """Angle at which a harmonic motion has done a share of its stroke [deg]."""
    return begin + (end - begin) * math.acos(1.0 - 2.0 * share) / math.pi


def section() -> Section:
    """Section 2.5."""
    frames, kru = phase("prototype", "frames", "dwell"), phase("KRU-20", "frames", "dwell")
    to_a, to_b = (phase("prototype", "knives", f"move to track {track}") for track in "ab")
    down = needle_place(GAP / STROKE, *phase("prototype", "needles", "approach the tape"))
    up = needle_place(1.0 - GAP / STROKE, *phase("prototype", "needles", "withdraw from the tape"))
    return Section(
        "Section 2.5: cyclograms of the two dobbies, deg of the shaft",
        ("quantity", ""),
        (
            Row(("prototype: dwell of the frames, 135 to 225", consistent("90", frames[1] - frames[0], 0))),
            Row(("its middle", consistent("180", sum(frames) / 2.0, 0, place=True))),
            Row(("middle of the knives' way to track a", consistent("360", sum(to_a) / 2.0, 0, place=True))),
            Row(("middle of the knives' way to track b", consistent("720", sum(to_b) / 2.0, 0, place=True))),
            Row(("needles flush with the tape on their way down", number(down, 2)),
                "published 37; an inference, not counted"),
            Row(("needles flush with the tape on their way up, even pick", number(up - 360.0, 2)),
                "published 323; an inference, not counted"),
            Row(("KRU-20: dwell of the frames, 320 to 55", consistent("95", kru[1] - kru[0], 0))),
            Row(("phases of the tape, of two picks", number(total("KRU-20", "tape"), 0))),
            Row(("phases of the needles, of two picks", number(total("KRU-20", "needles"), 0))),
            Row(("phases of the knives, of two picks", number(total("KRU-20", "knives"), 0)),
                "6 deg short: see Errata"),
        ),
        remarks=(
            "The source does not name the law of the needles. A harmonic one over their 11.4 mm, 3 mm of them"
            " above the tape, gives both angles.",
            "The cyclograms are data: `machines/cyclograms.csv`. The curves of the pawls (section 3.6,"
            " Figures 3.26 to 3.28), engaged together within 20 deg, are in figures that are lost.",
        ),
    )  # fmt: skip


def misprints() -> tuple[Row, ...]:
    """Slips of the section."""
    begin, end = phase("prototype", "tape", "in contact with its pin")
    last = phase("prototype", "knives", "last 2 mm")
    return (
        Row(("section 2.5, prototype, pin and tape", "30 deg of the even pick to 30 deg of the odd one",
             "from 330 deg (inferred)",
             f"the middle would be at {number(0.5 * (begin + end) - 360.0, 0)} deg of the even pick; the"
             " source puts it at 0 deg")),
        Row(("section 2.5, prototype, last 2 mm of the knives", "151 to 109 deg", "251 to 109 deg (inferred)",
             f"they lie about the end position at 180 deg: 109 and 251 do, 109 and {number(last[0], 0)} are"
             f" centred on {number(sum(last) / 2.0, 0)}")),
        Row(("section 2.5, KRU-20, knives", "rest to 340 deg, motion from 346 deg", "one angle for both",
             f"the phases add up to {number(total('KRU-20', 'knives'), 0)} deg instead of"
             f" {number(PICKS, 0)}")),
    )  # fmt: skip
