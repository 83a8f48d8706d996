"""Zhu and Zhou 2021, the rapier belt outside its guide."""

import math
from functools import cache

from scipy.optimize import brentq, minimize_scalar

from loomfmu.components.weft_insertion import WeftInsertion
from loomfmu.design import loom
from loomfmu.design.buckling import LengthFactor, fit_length_factor
from loomfmu.machines import HEADS, MACHINES, parameters, table
from loomfmu.physics import belt as physics

LOOM = "WL680-3600"
HEAD = "G6300 left"
CASE_HEADS = dict(zip(("I", "II", "III", "IV"), HEADS, strict=True))
MASS = {case: float(HEADS[head]["mass_g"]) * 1e-3 for case, head in CASE_HEADS.items()}


@cache
def _weft(machine: str) -> WeftInsertion:
    weft = WeftInsertion(**parameters("WeftInsertion", machine=machine))
    weft.speed = 1.0
    weft.initialize(0.0)
    return weft


def travel(machine: str, angle: float, speed: float = 1.0) -> tuple[float, float, float]:
    """Travel, velocity and acceleration of a machine's rapier head at a shaft speed [SI]."""
    weft = _weft(machine)
    weft.step(angle, 0.0)
    return weft.travel, weft.velocity * speed, weft.acceleration * speed**2


def free_length(machine: str, angle: float) -> float:
    """Length of the belt outside guide and head [m]; negative inside the guide."""
    where = parameters("BeltMonitor", machine=machine)
    return travel(machine, angle)[0] - float(where["head_length"]) - float(where["idle_travel"])


@cache
def safe(machine: str = LOOM, factor: float = 0.8, case: str = "I", tension: float = 0.0) -> loom.SafeSpeed:
    """Safe speed of a machine with the head of one of the source's cases."""
    return loom.safe_speed(machine, CASE_HEADS[case], length_factor=factor, tension=tension)


@cache
def window(machine: str) -> tuple[float, float]:
    """Shaft angles at which the belt leaves its guide and at which the positive acceleration ends [rad]."""
    return loom.window(machine)


def longest(machine: str) -> float:
    """Free length at the end of the window [m]."""
    return free_length(machine, window(machine)[1])


def slopes() -> tuple[float, float]:
    """Least and most that the free length grows in a degree at the end of the windows [m]."""
    found = [math.radians(travel(name, window(name)[1])[1]) for name in MACHINES]
    return min(found), max(found)


@cache
def fit(clearance: str) -> LengthFactor:
    """Length factor of a column of Table 2, fitted to its loads by least squares."""
    rows = table("belt_buckling_experiment")
    lengths = [1e-3 * float(row["free_length_mm"]) for row in rows]
    return fit_length_factor(lengths, [float(row[clearance]) for row in rows])


def largest_residual(clearance: str) -> float:
    """Largest residual of that fit [N]."""
    return max(abs(each) for each in fit(clearance).residuals)


def fitted_load(clearance: str, length: float) -> float:
    """Critical load with that fit [N]."""
    return physics.critical_force(length, fit(clearance).factor, loom.BENDING_STIFFNESS)


@cache
def with_idle_travel(idle_travel: float, factor: float, machine: str) -> tuple[float, float, float]:
    """Safe speed [rad/s], critical load [N] and start of the window [rad] for another idle travel."""
    mass = float(parameters("BeltMonitor", head=HEAD)["head_mass"])
    guide = idle_travel + float(parameters("BeltMonitor", machine=machine)["head_length"])

    def limit(angle: float) -> float:
        position, _first, second = travel(machine, angle)
        return physics.speed_limit(position - guide, second, factor, loom.BENDING_STIFFNESS, mass, 0.0)

    start = float(brentq(lambda angle: travel(machine, angle)[0] - guide, 0.0, math.pi, xtol=1e-14))
    found = minimize_scalar(
        limit, bounds=(start, window(machine)[1]), method="bounded", options={"xatol": 1e-12}
    )
    load = physics.critical_force(travel(machine, float(found.x))[0] - guide, factor, loom.BENDING_STIFFNESS)
    return float(found.fun), load, start


def length_at_limit(machine: str = LOOM) -> float:
    """Free length where the limit is lowest [m]."""
    return free_length(machine, safe(machine).angle)


def over_speed(speed: float, limit: float = 0.0) -> float:
    """Deflection of the belt above a limit, or above its own, both in rad/s: exact elastica [m]."""
    return physics.elastica_deflection((speed / (limit or safe().speed)) ** 2, length_at_limit())


def excess_for(deflection: float) -> float:
    """Share of the limit above it at which the belt is deflected that far [1]."""
    return float(brentq(lambda x: over_speed((1.0 + x) * safe().speed) - deflection, 1e-9, 0.01, xtol=1e-14))


def printed_deflection(speed: float, limit: float) -> float:
    """Deflection by (11) as it is printed [m]."""
    root = speed / limit  # sqrt(F / F_cr)
    below = 2.0 * root * root + root / math.pi * math.sin(2.0 * math.pi * root)
    return 2.0 * math.sqrt(2.0) * length_at_limit() / math.pi * math.sqrt((1.0 - 1.0 / root) / below)


def allowed_speed(deflection: float) -> float:
    """Speed that a deflection allows [rad/s]."""
    return loom.safe_speed(LOOM, length_factor=0.8, deflection=deflection).speed


@cache
def with_head(head: str, tension: float) -> float:
    """Safe speed with a head and a weft tension, mu = 1 [rad/s]."""
    return loom.safe_speed(LOOM, head, length_factor=1.0, tension=tension).speed


def entry(machine: str) -> float:
    """Shaft angle at which the rapier head enters the shed, its idle travel done [rad]."""
    idle = float(parameters("BeltMonitor", machine=machine)["idle_travel"])
    return float(brentq(lambda x: travel(machine, x)[0] - idle, 1e-6, math.pi, xtol=1e-14))


def by_mass(speed: float, case: str, other: str) -> float:
    """Speed with the head of another case, by `n sqrt(m)`."""
    return speed * math.sqrt(MASS[case] / MASS[other])


def width(machine: str) -> float:
    """Width of a machine [m]."""
    return float(MACHINES[machine]["width_m"])


def loads(machine: str, angle: float) -> tuple[float, float]:
    """Inertia force of the head at the safe speed, and the critical load for mu = 0.8 [N]."""
    critical = physics.critical_force(free_length(machine, angle), 0.8, loom.BENDING_STIFFNESS)
    return MASS["I"] * travel(machine, angle, safe(machine).speed)[2], critical


def worn(machine: str, clearance: float) -> float:
    """Safe speed with a clearance of the belt in its guide [rad/s]."""
    return safe(machine, 1.0).speed / physics.length_factor(clearance)
