"""Korolev, printed numbers that follow from other printed ones: sections 1.1, 2.2 and 2.3."""

import math
from collections.abc import Callable
from statistics import fmean

from ..machines import table
from .sections import Row, Section, consistent, number

RULES: dict[str, Callable[[list[float]], float]] = {
    "sum": math.fsum,
    "mean": fmean,
    "product": math.prod,
    "quotient": lambda operands: operands[0] / operands[1],
}
# variance and share as printed, %
FACTORS = {"A": ("2.84", "25.85"), "B": ("2.63", "26.64"), "C": ("2.66", "24.17"), "D": ("2.35", "21.37")}


def sections() -> tuple[Section, ...]:
    """Single numbers, the factor matrix, and the weight of its factors."""
    return single(), matrix(), weights()


def single() -> Section:
    """Means, quotients, products and sums."""
    rows = []
    for row in table("thesis_arithmetic"):
        operands = [float(each) for each in row["operands"].split()]
        digits = len(row["printed"].partition(".")[2]) + 1
        pair = consistent(row["printed"], RULES[row["rule"]](operands), digits)
        computed = f"{row['rule']} of {', '.join(row['operands'].split())}"
        rows.append(Row((row["place"], row["quantity"], computed, pair)))
    return Section(
        "Sections 1.1, 2.2 and 2.3: numbers that follow from others",
        ("place", "quantity", "computed as", ""),
        tuple(rows),
        labels=2,
        remarks=(
            "The source prints two ratios of the best to the worst rate for the floor space: 4.4 where a"
            " loom of 2 m with rigid rapiers is the worst, and about 3 of Table 1.4, whose worst is the loom"
            " with two sheds.",
        ),
    )


def loads() -> dict[str, dict[str, float]]:
    """Load of each factor on each requirement: mean of its correlations with the factor's requirements."""
    correlations = table("factor_correlations")
    return {
        row["requirement"]: {
            factor: fmean(float(row[each["requirement"]]) for each in correlations if each["group"] == factor)
            for factor in FACTORS
        }
        for row in correlations
    }


def variances() -> dict[str, float]:
    """Sum of the squared loads of each factor."""
    found = loads().values()
    return {factor: math.fsum(each[factor] ** 2 for each in found) for factor in FACTORS}


def matrix() -> Section:
    """Table 2.2 from Table 2.1."""
    found = loads()
    rows = [
        Row((name, *(consistent(row[f], found[name][f], 3) for f in FACTORS)))
        for row in table("factor_matrix")
        for name in (row["requirement"],)
    ]
    return Section(
        "Table 2.2: loads of the factors, means of the correlations in Table 2.1",
        ("requirement", *FACTORS),
        tuple(rows),
        intro="The requirements of a factor are those of its group in section 2.2.",
        split=False,
    )


def weights() -> Section:
    """Variances and shares of section 2.2."""
    found, count = variances(), len(table("factor_matrix"))
    rows = [
        Row((
            factor, consistent(variance, found[factor], 3, misprint=factor == "B"),
            consistent(share, 100.0 * found[factor] / count, 2),
        ))
        for factor, (variance, share) in FACTORS.items()
    ]  # fmt: skip
    total = 100.0 * math.fsum(found.values()) / count
    return Section(
        "Section 2.2: variance of the factors and their share, %",
        ("factor", "variance", "share, %"),
        (*rows, Row(("all", "", consistent("98.03", total, 2)))),
        split=False,
        remarks=("From the loads before they are rounded to two decimals.",),
    )


def misprints() -> tuple[Row, ...]:
    """Slips of these sections."""
    found, count = variances()["B"], len(table("factor_matrix"))
    return (
        Row(("Table 1.3, unit", "kW/m2", "kWh/m2",
             "270,000 m2 by the difference of 0.391 is an energy, which the source gives in kWh")),
        Row(("section 2.2, variance of factor B", "2.63", number(found, 2),
             f"its printed share of 26.64 % of {count} is {number(0.2664 * count, 2)}; 2.63 would be"
             f" {number(100.0 * 2.63 / count, 2)} %")),
        Row(("Table 2.5, shares of the causes", "45, 30, 20 and 15 %", "not known",
             f"they add up to {number(45.0 + 30.0 + 20.0 + 15.0, 0)} %")),
    )  # fmt: skip
