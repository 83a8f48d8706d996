"""Misprints of the two papers on the rapier belt, each with the calculation that shows it."""

import math

from ..machines import HEADS, table
from ..physics.belt import elastica_deflection
from ..units import STANDARD_GRAVITY
from . import belt, wrap
from .sections import Row, Section, number

HEADINGS = ("where", "printed", "corrected", "what is wrong with the printed form")


def sections() -> tuple[Section, ...]:
    """Both papers."""
    of_belt = (deflection(), *columns(), loads(), factors(), wl450_4000(), proportion(), *references())
    return (
        Section("Rapier belt outside its guide", HEADINGS, of_belt),
        Section("Rapier belt on its wheel", HEADINGS, (wrapped(),)),
    )


def deflection() -> Row:
    """Equation (11)."""
    ratio = (686.0 / 685.0) ** 2
    length = belt.free_length("WL680-3600", belt.safe("WL680-3600", "G6300 left", 0.8).angle)
    printed = 1e3 * belt.printed_deflection(ratio, length)
    exact = 1e3 * elastica_deflection(ratio, length)
    return Row(
        (
            "(11), deflection of the buckled belt",
            f"{number(printed, 1)} mm at 686 against 685 rev/min",
            f"{number(exact, 1)} mm by the exact elastica",
            "text and Figure 11 of the source say 8 mm; the printed form gives"
            f" {number(printed / exact, 2)} of the exact deflection",
        )
    )


def columns() -> tuple[Row, Row]:
    """Columns III and IV of Tables 6 and 7."""
    row = table("safe_speed_by_case")[0]
    mass = {case: float(HEADS[head]["mass_g"]) for case, head in belt.CASE_HEADS.items()}
    own = {c: number(belt.rpm(belt.safe(row["machine"], belt.CASE_HEADS[c], 0.8)), 1) for c in belt.CASES}
    product = {c: number(float(row[f"n_{c}"]) * math.sqrt(mass[c]), 0) for c in belt.CASES}
    first = Row(
        (
            "Table 6, columns III and IV (WL680-3400)",
            f"III {row['n_III']}, IV {row['n_IV']} rev/min",
            f"III {own['III']}, IV {own['IV']} rev/min: interchanged",
            "by (9) n sqrt(m) is constant along a row; as printed it is "
            + ", ".join(f"{c} {product[c]}" for c in belt.CASES),
        )
    )
    row = table("safe_speed_by_yarn_tension")[0]
    tension = 0.2 * STANDARD_GRAVITY
    own = {
        c: number(belt.rpm(belt.safe("WL680-3600", belt.CASE_HEADS[c], 1.0, tension)), 1) for c in belt.CASES
    }
    second = Row(
        (
            "Table 7, columns III and IV (200 gf)",
            f"III {row['n_III']}, IV {row['n_IV']} rev/min",
            f"III {own['III']}, IV {own['IV']} rev/min: interchanged",
            "as printed the heaviest head (III, 122.2 g) is faster than a lighter one (IV, 113.4 g)",
        )
    )
    return first, second


def loads() -> Row:
    """Critical loads of Table 6."""
    row = table("safe_speed_by_case")[0]
    printed = [float(row[f"load_{c}"]) for c in belt.CASES]
    found = belt.safe(row["machine"], "G6300 left", 0.8).critical_force
    spread = 100.0 * (max(printed) - min(printed)) / min(printed)
    return Row(
        (
            "Table 6, critical loads (WL680-3400)",
            ", ".join(f"{c} {row[f'load_{c}']}" for c in belt.CASES) + " N",
            f"{number(found, 1)} N for all four",
            "by (8) to (10) the angle of the lowest limit does not depend on the mass, so neither does the"
            f" load there; the printed ones differ by {number(spread, 1)} %",
        )
    )


def factors() -> Row:
    """Rows of Table 5."""
    worst, products = "", [0.0]
    for row in table("safe_speed_by_length_factor"):
        found = [float(row[f"n_mu_{mu}"]) * float(mu) for mu in belt.FACTORS]
        if not worst or max(found) / min(found) > max(products) / min(products):
            worst, products = row["machine"], found
    spread = 100.0 * (max(products) / min(products) - 1.0)
    return Row(
        (
            f"Table 5, rows ({worst})",
            "n mu = " + ", ".join(number(product, 1) for product in products) + " rev/min",
            "one value for each row",
            f"by (9) n is proportional to 1/mu; the printed rows vary by up to {number(spread, 1)} %",
        )
    )


def wl450_4000() -> Row:
    """The loom whose speeds do not follow from its own row of Table 1."""
    row = next(r for r in table("safe_speed_by_length_factor") if r["machine"] == "WL450-4000")
    found = [belt.rpm(belt.safe("WL450-4000", "G6300 left", float(mu))) for mu in belt.FACTORS]
    margin = 1.0 - (float(row["n_mu_0.8"]) / found[0]) ** 2
    return Row(
        (
            "Tables 5 and 6, WL450-4000",
            ", ".join(row[f"n_mu_{mu}"] for mu in belt.FACTORS) + " rev/min",
            ", ".join(number(speed, 1) for speed in found) + " rev/min by Table 1",
            "its window and its free length follow from Table 1, its speeds do not: at the printed 475"
            f" rev/min the lowest margin is {number(margin, 3)}; which of the tables is wrong cannot be"
            " settled",
        )
    )


def proportion() -> Row:
    """The first conclusion of section 4.1."""
    rows = {row["clearance_mm"]: float(row["length_factor"]) for row in table("length_factor")}
    return Row(
        (
            "section 4.1, conclusion a",
            "the safe speed is inversely proportional to the clearance",
            "to the length factor",
            f"from 0.30 to 0.80 mm the clearance grows {number(0.80 / 0.30, 2)} times, the length factor"
            f" {number(rows['0.80'] / rows['0.30'], 2)} times",
        )
    )


def references() -> tuple[Row, Row]:
    """Wrong references."""
    return (
        Row(
            (
                "section 4.2",
                "Table 7 and Figure 13 for the limit of 685 rev/min and the deflection",
                "Tables 5 and 6, Figure 11",
                "Table 7 does not contain 685, and there is no Figure 13",
            )
        ),
        Row(
            (
                "note under Table 5",
                "mu = 0.8",
                "mu = 0.8, 0.9 and 1.0",
                "the columns of the table are for these three values of mu",
            )
        ),
    )


def wrapped() -> Row:
    """The one entry of Table 3."""
    row = next(r for r in table("belt_wrap_theory") if r["D_mm"] == "430.0")
    products = [float(row[f"c_{c}"]) * math.sqrt(float(c)) for c in wrap.CLEARANCES]
    return Row(
        (
            "Table 3, 430.0 mm and 0.1 mm",
            f"{row['c_0.1']} N",
            f"{number(wrap.load('430.0', '0.1'), 2)} N",
            "by (8) F sqrt(c) is constant along a row, apart from c/D; as printed it is "
            + ", ".join(number(product, 2) for product in products),
        )
    )
