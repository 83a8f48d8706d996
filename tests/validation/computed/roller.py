"""Study of the detaching rollers of the comber JSFA588."""

import math
from functools import cache

from loomfmu.components.detaching_roller import DetachingRoller
from loomfmu.physics import detaching_roller as physics
from validation.calls import table

ROLLER, TOP = 12.5e-3, 12.25e-3
ROLLER_INERTIA, TOP_INERTIA = 135.64e-6, 33.98e-6
POINTS = 4000  # in a nip
TORQUES = {
    "M11": "drafting_torque",
    "M12": "top_roller_torque",
    "M13": "inertia_torque",
    "M1": "back_torque",
    "M2": "front_torque",
    "M": "unit_torque",
    "M0": "machine_torque",
}


@cache
def built_in(speed: float) -> dict[str, list[float]]:
    """Every torque over a nip with the built-in motion [N m]."""
    machine = DetachingRoller(speed=speed)
    machine.initialize(0.0)
    step = 2.0 * math.pi / speed / POINTS
    found: dict[str, list[float]] = {name: [] for name in TORQUES}
    for n in range(POINTS):
        machine.step(n * step, 0.0)
        for name, variable in TORQUES.items():
            found[name].append(getattr(machine, variable))
    return found


def peak(speed: float, torque: str) -> float:
    """Highest value of a torque over a nip [N m]."""
    return max(built_in(speed)[torque])


def valley(speed: float, torque: str) -> float:
    """Lowest value of a torque over a nip [N m]."""
    return min(built_in(speed)[torque])


def top_roller_torque(inertia_torque: float) -> float:
    """M12 of the acceleration that has this M13 [N m]."""
    return physics.top_roller_torque(inertia_torque / ROLLER_INERTIA, ROLLER, TOP, TOP_INERTIA)


def drafting_torque() -> float:
    """M11 with the largest number of fibres and the valley of M12 [N m]."""
    return ROLLER * physics.drafting_force(1.0, 0.33, 300.0, top_roller_torque(-0.53) / ROLLER)


def law() -> tuple[float, float]:
    """`friction` and `inertia (nips / 300)^2` through the valleys of M at 300 and 500 nips/min [N m]."""
    low = {row["nips"]: float(row["valley"]) for row in table("roller_speeds") if row["torque"] == "M"}
    inertia = (low["300"] - low["500"]) / ((500.0 / 300.0) ** 2 - 1.0)
    return low["300"] + inertia, inertia


def curve(torque: str) -> tuple[list[float], list[float]]:
    """Divisions of the nip, 40 in all, and a torque at 300 nips/min [N m]."""
    return [40.0 * n / POINTS for n in range(POINTS)], built_in(10.0 * math.pi)[torque]
