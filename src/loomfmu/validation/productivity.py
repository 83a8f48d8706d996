"""Korolev, data of whole looms: Table 1.1, Table 1.4, Appendix 1."""

import math

from ..design.loom import productivity_coefficient, weft_insertion_rate
from ..machines import table
from .sections import Row, Section, consistent

RPM = math.pi / 30.0


def sections() -> tuple[Section, ...]:
    """Coefficient, floor space, weft."""
    return coefficient(), floor_space(), consumption()


def coefficient() -> Section:
    """Table 1.1."""
    rows = []
    for row in table("productivity"):
        width, rate = float(row["width_m"]), float(row["rate_m_min"])
        speed = 2.0 * math.pi * rate / 60.0 / width
        slip = row["machine"].startswith(("TM", "Jurgens"))
        found = 60.0 * productivity_coefficient(width, speed)
        pair = consistent(row["coefficient"], found, 1, misprint=slip)
        rows.append(Row((row["machine"], row["width_m"], row["rate_m_min"], pair)))
    return Section(
        "Table 1.1: productivity coefficient, m/min over the square root of m",
        ("loom", "width, m", "weft insertion rate, m/min", ""),
        tuple(rows),
        intro="Computed: rate over the square root of the width. Of a range, both ends are shown.",
    )


def floor_space() -> Section:
    """Table 1.4."""
    rows = []
    for row in table("floor_space"):
        rate = 60.0 * weft_insertion_rate(float(row["width_m"]), float(row["speed_rpm"]) * RPM)
        area = float(row["machine_width_m"]) * float(row["machine_depth_m"])
        share = float(row["rate_m_min"]) / float(row["needed_m2"])
        pairs = (
            consistent(row["area_m2"], area, 2, misprint=row["machine"].startswith("Gunne")),
            consistent(row["rate_m_min"], rate, 0, misprint=row["machine"].endswith("L5200")),
            consistent(row["rate_per_m2"], share, 2),
        )
        rows.append(Row((row["machine"], *pairs)))
    return Section(
        "Table 1.4: weft insertion rate and floor space",
        ("loom", "area, m2", "rate, m/min", "rate over the area needed, m/min/m2"),
        tuple(rows),
        intro="Computed: width times depth; width in the reed times speed; printed rate over printed area.",
        split=False,
        remarks=("The printed rate of the Somet is for its woven width, 2 x 170 cm: see the next table.",),
    )


def consumption() -> Section:
    """Appendix 1."""
    rows = []
    for row in table("weft_consumption"):
        width = 0.01 * float(row["woven_cm"]) * int(row["webs"])
        rate = 60.0 * weft_insertion_rate(width, float(row["speed_rpm"]) * RPM)
        woven = f"{row['webs']} x {row['woven_cm']}" if row["webs"] != "1" else row["woven_cm"]
        slip = row["machine"] == "Sulzer P7100 dress"
        pair = consistent(row["weft_m_min"], rate, 0, misprint=slip)
        rows.append(Row((row["machine"], row["speed_rpm"], woven, pair)))
    return Section(
        "Appendix 1: weft used, m/min",
        ("loom", "rev/min", "woven, cm", ""),
        tuple(rows),
        intro="Computed: woven width times speed.",
    )
