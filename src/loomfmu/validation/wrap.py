"""Zhu and Zhou 2021, the belt wrapped on the rapier wheel: Tables 1 to 3."""

from ..machines import table
from ..physics.belt_wrap import cantilever_stiffness, restraint_load
from .sections import Chapter, Pair, Row, Section, consistent, number

CLEARANCES = ("0.1", "0.2", "0.3", "0.4", "0.5")
HEADS = tuple(f"c = {c} mm" for c in CLEARANCES)
STIFFNESS = 0.25  # N m2, what the source makes of its Table 1


def load(diameter: str, clearance: str) -> float:
    """Restraint load of a wheel diameter and a clearance, both in mm as they are printed [N]."""
    return restraint_load(STIFFNESS, 1e-3 * float(diameter), 1e-3 * float(clearance))


def chapter() -> Chapter:
    """All tables of the wrapped belt."""
    return Chapter(
        "Rapier belt on its wheel (Zhu and Zhou, Light Industry Machinery (2021) no. 5, 20)",
        "",
        (table_1(), table_2(), table_3()),
    )


def stiffnesses() -> list[float]:
    """Bending stiffness from each test of Table 1 [N m2]."""
    return [
        cantilever_stiffness(
            float(row["force_N"]), 1e-3 * float(row["length_mm"]), -1e-3 * float(row["deflection_mm"])
        )
        for row in table("belt_stiffness_experiment")
    ]


def table_1() -> Section:
    """Bending stiffness."""
    found = stiffnesses()
    rows = [
        Row(
            (
                row["length_mm"],
                row["force_N"],
                row["deflection_mm"],
                consistent(row["EI_Nm2"], stiffness, 4),
            )
        )
        for row, stiffness in zip(table("belt_stiffness_experiment"), found, strict=True)
    ]
    mean = sum(found) / len(found)
    return Section(
        "Table 1: bending stiffness from the cantilever test, N m2",
        ("length, mm", "force, N", "deflection, mm", ""),
        (*rows, Row(("mean", "", "", consistent("0.25", mean, 4)))),
        intro="Computed: equation (2).",
        labels=3,
    )


def table_2() -> Section:
    """Measured loads."""
    rows = []
    for row in table("belt_wrap_experiment"):
        pairs = (Pair(row[f"c_{c}"], load(row["D_mm"], c), 2, measured=True) for c in CLEARANCES)
        rows.append(Row((row["D_mm"], row["wrap_deg"], *pairs)))
    return Section(
        "Table 2: measured restraint load, N",
        ("diameter, mm", "wrap, deg", *HEADS),
        tuple(rows),
        intro="Computed: equation (8) with EI = 0.25 N m2, in which the wrap angle does not appear.",
        split=False,
        labels=2,
        remarks=(_scatter(), _clearance_errors()),
    )


def _scatter() -> str:
    """Spread of the loads measured at the three wrap angles."""
    groups: dict[tuple[str, str], list[float]] = {}
    for row in table("belt_wrap_experiment"):
        for clearance in CLEARANCES:
            groups.setdefault((row["D_mm"], clearance), []).append(float(row[f"c_{clearance}"]))
    most = max((max(loads) - min(loads)) / min(loads) for loads in groups.values())
    return (
        f"The loads measured at the three wrap angles differ by up to {number(100 * most, 1)} %. So"
        " they agree with (8), in which the wrap angle does not appear."
    )


def clearance_errors() -> dict[tuple[str, str], float]:
    """By how much a clearance would have to be larger to give its measured load, by wheel and clearance [mm].

    The means over the three wrap angles.
    """
    from scipy.optimize import brentq

    found: dict[tuple[str, str], list[float]] = {}
    for row in table("belt_wrap_experiment"):
        for clearance in CLEARANCES:
            diameter, measured = 1e-3 * float(row["D_mm"]), float(row[f"c_{clearance}"])
            actual = brentq(
                lambda c, d=diameter, f=measured: restraint_load(STIFFNESS, d, 1e-3 * c) - f, 1e-3, 2.0
            )
            found.setdefault((row["D_mm"], clearance), []).append(float(actual) - float(clearance))
    return {key: sum(errors) / len(errors) for key, errors in found.items()}


def _clearance_errors() -> str:
    """A possible explanation of the loads on the wheel of 430 mm."""
    errors = clearance_errors()
    first, second = (number(errors["430.0", c], 3, sign=True) for c in ("0.1", "0.2"))
    others = [error for (diameter, _c), error in errors.items() if diameter != "430.0"]
    return (
        "430.0 mm, possible explanation (an inference): the loads at 0.1 and 0.2 mm are those of clearances"
        f" that are off by {first} and {second} mm. On the other two wheels the clearances would have to be"
        f" off by {number(min(others), 3, sign=True)} to {number(max(others), 3, sign=True)} mm, so that is"
        " within the scatter of the test."
    )


def table_3() -> Section:
    """Computed loads."""
    rows = []
    for row in table("belt_wrap_theory"):
        diameter = row["D_mm"]
        pairs = (
            Pair(row[f"c_{c}"], load(diameter, c), 2, misprint=(diameter, c) == ("430.0", "0.1"))
            for c in CLEARANCES
        )
        rows.append(Row((diameter, *pairs)))
    return Section(
        "Table 3: restraint load by equation (8), N",
        ("diameter, mm", *HEADS),
        tuple(rows),
        split=False,
        figures=(("wrap.png", "Restraint load of the wrapped belt (Figure 11)"),),
    )
