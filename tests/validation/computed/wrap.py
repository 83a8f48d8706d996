"""Zhu and Zhou 2021, the belt wrapped on the rapier wheel."""

from functools import cache
from statistics import fmean

from scipy.optimize import brentq

from loomfmu.machines import table
from loomfmu.physics.belt_wrap import cantilever_stiffness, restraint_load

CLEARANCES = ("0.1", "0.2", "0.3", "0.4", "0.5")  # mm
STIFFNESS = 0.25  # N m2, what the source makes of its Table 1


def load(diameter: float, clearance: float) -> float:
    """Restraint load [N] of a wheel diameter and a clearance [m]."""
    return restraint_load(STIFFNESS, diameter, clearance)


def stiffness(length: float, force: float, deflection: float) -> float:
    """Bending stiffness from a test of Table 1, whose deflections are negative [N m2]."""
    return cantilever_stiffness(force, length, -deflection)


def mean_stiffness() -> float:
    """Mean of all tests [N m2]."""
    rows = table("belt_stiffness_experiment")
    return fmean(
        stiffness(1e-3 * float(row["length_mm"]), float(row["force_N"]), 1e-3 * float(row["deflection_mm"]))
        for row in rows
    )


def measured() -> dict[tuple[float, float], list[float]]:
    """Loads of the three wrap angles [N], by wheel and clearance [mm]."""
    found: dict[tuple[float, float], list[float]] = {}
    for row in table("belt_wrap_experiment"):
        for c in CLEARANCES:
            found.setdefault((float(row["D_mm"]), float(c)), []).append(float(row[f"c_{c}"]))
    return found


def scatter() -> float:
    """Largest spread of the loads at the three wrap angles, as a share."""
    return max((max(loads) - min(loads)) / min(loads) for loads in measured().values())


@cache
def clearance_error(wheel: float, clearance: float) -> float:
    """By how much a clearance would have to be larger to give its measured loads, as a mean; all in mm."""
    loads = measured()[wheel, clearance]
    found = [brentq(lambda c, f=force: load(1e-3 * wheel, 1e-3 * c) - f, 1e-3, 2.0) for force in loads]
    return fmean(found) - clearance


def other_errors() -> tuple[float, float]:
    """Least and largest of these of the two other wheels [mm]."""
    found = [clearance_error(*case) for case in measured() if case[0] != 430.0]
    return min(found), max(found)
