"""Korolev, printed numbers that follow from other printed ones: factors, cyclograms, tables of looms."""

import math
from statistics import fmean

from loomfmu.design.loom import productivity_coefficient
from loomfmu.machines import table


def load(requirement: str, factor: str) -> float:
    """Load of a factor on a requirement: mean of its correlations with the factor's requirements."""
    rows = table("factor_correlations")
    own = next(row for row in rows if row["requirement"] == requirement)
    return fmean(float(own[row["requirement"]]) for row in rows if row["group"] == factor)


def variance(factor: str) -> float:
    """Sum of the squared loads of a factor, or of all."""
    names = [row["requirement"] for row in table("factor_correlations")]
    factors = "ABCD" if factor == "all" else factor
    return math.fsum(load(name, each) ** 2 for name in names for each in factors)


def factor_share(factor: str) -> float:
    """That variance as a share."""
    return variance(factor) / len(table("factor_matrix"))


def phase(dobby: str, part: str, name: str) -> tuple[float, float]:
    """Begin and end of a phase [deg over two picks], as printed."""
    row = next(r for r in table("cyclograms") if (r["dobby"], r["part"], r["phase"]) == (dobby, part, name))
    return float(row["from_deg"]), float(row["to_deg"])


def duration(dobby: str, part: str, name: str) -> float:
    """Length of a phase [deg]."""
    begin, end = phase(dobby, part, name)
    return end - begin


def middle(dobby: str, part: str, name: str) -> float:
    """Middle of a phase [deg]."""
    return 0.5 * sum(phase(dobby, part, name))


def total(dobby: str, part: str) -> float:
    """Sum of all phases of a part [deg]."""
    rows = [r for r in table("cyclograms") if (r["dobby"], r["part"]) == (dobby, part)]
    return sum(float(row["to_deg"]) - float(row["from_deg"]) for row in rows)


def needle_place(share: float, name: str) -> float:
    """Angle at which a harmonic motion over a phase of the needles has done a share of its stroke [deg]."""
    begin, end = phase("prototype", "needles", name)
    return begin + (end - begin) * math.acos(1.0 - 2.0 * share) / math.pi


def coefficient(width: float, rate: float) -> float:
    """Productivity coefficient of a weft insertion rate, both in SI."""
    return productivity_coefficient(width, 2.0 * math.pi * rate / width)


def woven(webs: float, width: float) -> str:
    """Width of one web, times their number."""
    return f"{width:g}" if webs == 1.0 else f"{webs:g} x {width:g}"
