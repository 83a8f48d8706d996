"""Korolev, printed numbers that follow from other printed ones: factors, cyclograms, tables of looms."""

import math
from statistics import fmean

from loomfmu.design.loom import productivity_coefficient
from loomfmu.machines import table

RULES = {"sum": math.fsum, "mean": fmean, "product": math.prod, "quotient": lambda of: of[0] / of[1]}
REQUIREMENTS = {row["requirement"]: row for row in table("factor_correlations")}


def by_rule(rule: str, *operands: float) -> float:
    """Return the result of a rule of `thesis_arithmetic` on its operands."""
    return RULES[rule](operands)


def load(requirement: str, factor: str) -> float:
    """Load of a factor on a requirement: mean of its correlations with the factor's requirements."""
    own = REQUIREMENTS[requirement]
    return fmean(float(own[name]) for name, row in REQUIREMENTS.items() if row["group"] == factor)


def variance(factors: str) -> float:
    """Sum of the squared loads of some factors."""
    return math.fsum(load(name, factor) ** 2 for name in REQUIREMENTS for factor in factors)


def phases(dobby: str, part: str, name: str = "") -> list[tuple[float, float]]:
    """Begin and end of each phase of a part [deg over two picks], as printed."""
    rows = [row for row in table("cyclograms") if (row["dobby"], row["part"]) == (dobby, part)]
    return [(float(row["from_deg"]), float(row["to_deg"])) for row in rows if name in ("", row["phase"])]


def duration(dobby: str, part: str, name: str = "") -> float:
    """Length of a phase, or of all phases of a part [deg]."""
    return sum(end - begin for begin, end in phases(dobby, part, name))


def middle(dobby: str, part: str, name: str) -> float:
    """Middle of a phase [deg]."""
    return fmean(phases(dobby, part, name)[0])


def needle_place(share: float, name: str) -> float:
    """Angle at which a harmonic motion over a phase of the needles has done a share of its stroke [deg]."""
    ((begin, end),) = phases("prototype", "needles", name)
    return begin + (end - begin) * math.acos(1.0 - 2.0 * share) / math.pi


def coefficient(width: float, rate: float) -> float:
    """Productivity coefficient of a weft insertion rate, both in SI."""
    return productivity_coefficient(width, 2.0 * math.pi * rate / width)


def woven(webs: float, width: float) -> str:
    """Width of one web, times their number."""
    return f"{width:g}" if webs == 1.0 else f"{webs:g} x {width:g}"
