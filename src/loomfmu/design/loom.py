"""Figures of a whole loom: safe speed, what a given speed requires, productivity.

The same physics as in the FMUs, solved for a design. Results are in SI; quantities are given as numbers in SI
or as texts with a unit, such as "0.5 mm", within the limits that they have in a scene.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..components.weft_insertion import WeftInsertion
from ..errors import LoomfmuError, suggestion
from ..machines import named, parameters
from ..physics import belt
from .quantities import Quantity, read, show

BENDING_STIFFNESS = 0.25  # N m2, the carbon belt of Zhu and Zhou
RPM = 2.0 * math.pi / 60.0
NEW_BELT = 0.3e-3  # m, its clearance in the guide
QUANTITIES = (
    "head",
    "length_factor",
    "clearance",
    "tension",
    "mass",
    "stiffness",
    "deflection",
)  # besides the machine


@dataclass(frozen=True)
class SafeSpeed:
    """Highest shaft speed at which the belt never buckles [rad/s], and what decides it.

    `angle` of the shaft [rad], `critical_force` there [N], the `window` of shaft angles in which the
    belt is outside its guide and pushed [rad], the longest `free_length` in it [m].
    """

    speed: float
    angle: float
    critical_force: float
    window: tuple[float, float]
    free_length: float


def safe_speed(
    machine: str,
    head: str = "G6300 left",
    *,
    length_factor: Quantity | None = None,
    clearance: Quantity | None = None,
    tension: Quantity = 0.0,
    mass: Quantity | None = None,
    stiffness: Quantity = BENDING_STIFFNESS,
    deflection: Quantity = 0.0,
) -> SafeSpeed:
    """Safe speed of a published machine, equations (9), (10) and (12) of Zhu and Zhou.

    Args:
        machine, head: names of a published machine and head
        length_factor: column length factor [1]; from the clearance if not given
        clearance: of the belt in its guide [m]; 0.3 mm, that of a new belt, if not given
        tension: of the weft that a giver brings in [N]; 0 for a taker, whose belt it never compresses
        mass: of the head [kg]; that of `head` if not given
        stiffness: bending stiffness of the belt [N m2]
        deflection: that the belt is allowed once it has buckled, at rest [m], section 4.2

    Raises:
        LoomfmuError: an unknown name, a quantity outside its limits, or a weft tension that alone buckles
            the belt, or a deflection that it never reaches

    >>> round(safe_speed("WL680-3600").speed / RPM, 1)
    681.8
    """
    if clearance is not None and length_factor is not None:
        raise LoomfmuError(
            "give either clearance or length_factor, not both: the factor follows from the clearance"
        )
    gap = read("clearance", NEW_BELT if clearance is None else clearance)
    tension = read("tension", tension)
    stiffness = read("stiffness", stiffness)

    guide, travel = _travel(machine)
    named("head", head)
    weight = read("mass", parameters("BeltMonitor", head=head)["head_mass"] if mass is None else mass)
    factor = belt.length_factor(gap) if length_factor is None else read("length_factor", length_factor)
    bow = read("deflection", deflection)
    start, end = window(machine)

    def limit(angle: float) -> float:
        position, _first, second = travel(angle)
        free = position - guide
        bent = stiffness * belt.bent_load_ratio(bow / free) if free > 0.0 else stiffness
        return belt.speed_limit(free, second, factor, bent, weight, tension)

    angle, speed = _lowest(limit, _bent_from(machine, bow) if bow > 0.0 else start, end)
    if speed <= 0.0:
        raise LoomfmuError(f"{machine}: a weft tension of {tension:.6g} N buckles the belt at any speed")
    force = belt.critical_force(travel(angle)[0] - guide, factor, stiffness)
    return SafeSpeed(speed, angle, force, (start, end), travel(end)[0] - guide)


def _bent_from(machine: str, deflection: float) -> float:
    """Shaft angle from which the free belt is long enough for a deflection [rad]. Raises LoomfmuError."""
    from scipy.optimize import brentq

    guide, travel = _travel(machine)
    start, end = window(machine)
    needed = guide + deflection / belt.LARGEST_BEND
    if travel(end)[0] <= needed:
        raise LoomfmuError(
            f"deflection = {show('deflection', deflection)}: the belt of {machine} is too short to bend more"
            f" than {show('deflection', belt.LARGEST_BEND * (travel(end)[0] - guide))}"
        )
    return float(brentq(lambda angle: travel(angle)[0] - needed, start, end, xtol=1e-14))


def _lowest(limit: Callable[[float], float], start: float, end: float) -> tuple[float, float]:
    """Position and value of the only minimum between two poles, bracketed by a grid first."""
    from scipy.optimize import minimize_scalar

    step = (end - start) / 64
    best = min((start + (k + 0.5) * step for k in range(64)), key=limit)
    near = (best - step, best + step)
    found = minimize_scalar(limit, bounds=near, method="bounded", options={"xatol": 1e-12})
    return float(found.x), float(found.fun)


def window(machine: str) -> tuple[float, float]:
    """Shaft angles at which the belt leaves its guide and at which its head is no longer pushed [rad]."""
    from scipy.optimize import brentq

    guide, travel = _travel(machine)
    start = brentq(lambda angle: travel(angle)[0] - guide, 0.0, math.pi, xtol=1e-14)
    end = brentq(lambda angle: travel(angle)[2], 0.25 * math.pi, math.pi, xtol=1e-14)
    return start, end


def _travel(machine: str) -> tuple[float, Callable[[float], tuple[float, float, float]]]:
    """Travel at which the belt leaves its guide, and travel with derivatives by shaft angle."""
    named("machine", machine)
    where = parameters("BeltMonitor", machine=machine)
    weft = WeftInsertion(**parameters("WeftInsertion", machine=machine))  # type: ignore[arg-type]
    weft.speed = 1.0
    weft.initialize(0.0)

    def travel(angle: float) -> tuple[float, float, float]:
        weft.step(angle, 0.0)
        return weft.travel, weft.velocity, weft.acceleration

    return float(where["head_length"]) + float(where["idle_travel"]), travel


# ---- what a given speed requires


def clearance_for(speed: Quantity, machine: str, head: str = "G6300 left", **others: Any) -> float:
    """Largest guide clearance with which the belt is safe at a speed [m].

    Raises LoomfmuError if no clearance is small enough, with the speeds in reach, or if every one is.
    """
    _refuse(others, "clearance", "length_factor")
    return _solve("clearance", speed, machine, head=head, **others)


def mass_for(speed: Quantity, machine: str, **others: Any) -> float:
    """Largest mass of the rapier head with which the belt is safe at a speed [kg]; see `clearance_for`."""
    _refuse(others, "mass")
    return _solve("mass", speed, machine, **others)


def stiffness_for(speed: Quantity, machine: str, head: str = "G6300 left", **others: Any) -> float:
    """Smallest bending stiffness with which the belt is safe at a speed [N m2]; see `clearance_for`."""
    _refuse(others, "stiffness")
    return _solve("stiffness", speed, machine, head=head, **others)


def _refuse(given: dict[str, Any], sought: str, instead: str = "") -> None:
    """Reject a value for the quantity solved for, and an argument that `safe_speed` does not have."""
    for name in given:
        if name in (sought, instead):
            raise LoomfmuError(f"{name} cannot be set: the function solves for the {sought}")
        if name not in QUANTITIES:
            raise LoomfmuError(f"{name} is unknown{suggestion(name, QUANTITIES)}")


# what is sought for a speed: how messages call it, and between which values
SOUGHT = {
    "clearance": ("guide clearance", 0.0, 0.8e-3),
    "mass": ("head mass", 1e-3, 10.0),
    "stiffness": ("bending stiffness", 1e-3, 100.0),
}


def _solve(name: str, wanted: Quantity, machine: str, **others: Any) -> float:
    from scipy.optimize import brentq

    def reached(value: float) -> float:
        given: dict[str, Any] = {name: value, **others}
        return safe_speed(machine, **given).speed

    speed, (what, low, high) = read("speed", wanted), SOUGHT[name]
    ends = reached(low), reached(high)
    if speed < min(ends):
        raise LoomfmuError(
            f"the belt is safe at {show('speed', speed)} with any {what} from {show(name, low)} to"
            f" {show(name, high)}"
        )
    if speed > max(ends):
        raise LoomfmuError(
            f"no {what} gives {show('speed', speed)}: between {show(name, low)} and {show(name, high)} the"
            f" safe speed ranges from {ends[0] / RPM:.6g} to {ends[1] / RPM:.6g} rev/min"
        )
    return float(brentq(lambda value: reached(value) - speed, low, high, xtol=1e-12 * high, rtol=1e-12))


# ---- productivity, Korolev section 1.1


def weft_insertion_rate(width: Quantity, speed: Quantity) -> float:
    """Weft insertion rate: length of weft per time, `width * picks per time` [m/s].

    Args:
        width: in which weft is inserted [m]
        speed: of the main shaft, one pick per revolution [rad/s]

    >>> round(weft_insertion_rate(3.6, 345 * RPM) * 60)  # m/min
    1242
    """
    return read("width", width) * read("speed", speed) / (2.0 * math.pi)


def productivity_coefficient(width: Quantity, speed: Quantity) -> float:
    """Productivity coefficient: weft insertion rate over the square root of the width [m^0.5/s]."""
    return weft_insertion_rate(width, speed) / math.sqrt(read("width", width))


def spare_part_cost(years: float, fixed: float = 59.8, yearly: float = 3.3, exponent: float = 1.22) -> float:
    """Cost of spare parts for 100,000 picks, `C = x + p n^y`, equation (1.1).

    Args:
        years: of service of the loom, n, not negative
        fixed, yearly, exponent: x, p and y; by default those of air-jet looms, for US dollars

    Raises:
        LoomfmuError: a number of years below 0

    >>> round(spare_part_cost(10.0), 2)
    114.57
    """
    if not years >= 0.0:
        raise LoomfmuError(f"years = {years:.7g} must be 0 or more")
    return float(fixed + yearly * years**exponent)
