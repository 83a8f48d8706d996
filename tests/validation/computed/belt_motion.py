"""The belt in motion beside the static criterion of Zhu and Zhou: findings of our own."""

import math
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

from scipy.optimize import brentq

from loomfmu.components import BeltDynamics
from loomfmu.cosim.prepared import Prepared
from loomfmu.cosim.run import prepare
from loomfmu.cosim.scenes.scene import parse
from validation.calls import arguments, table
from validation.computed import belt

MACHINES = ("WL680-3600", "WL800-3600", "WL450-4600")
BOWS = ("belt", "span")  # what has the bow
USUAL = (0.05, 0.3e-3)  # belt mass [kg/m] and bow [m]
MASSES = (0.04, 0.065)  # kg/m, a third of the published section punched out, and all of it there
CORNERS = tuple((mass, bow) for mass in MASSES for bow in (0.05e-3, 0.5e-3))
SHARES = tuple(0.1 * tenth for tenth in range(5, 21))  # of the static limit
STEPS = 360
GRAVITY = 9.80665  # m/s2
ALLOWED = 2e-3  # m, section 4.2 of the source
LOOM = """
steps_per_revolution = {steps}
[loom]
machine = "{machine}"
head = "{head}"
belt_motion = true
[shaft]
speed = "600 rev/min"
"""
KEPT = ("belt_motion.largest_deflection", "belt_motion.largest_at_risk")


class Moved(NamedTuple):
    """Largest deflection of a belt, and that while the head was pushed [m]."""

    largest: float
    at_risk: float


@cache
def prepared(machine: str) -> Prepared:
    """The belt of a machine in motion behind its rapier."""
    text = LOOM.format(machine=machine, head=belt.HEAD, steps=STEPS)
    return prepare(parse(text, "the belt in motion"), values=KEPT)


@cache
def moved(
    machine: str,
    speed: float,
    bow_of: str,
    last: float,
    mass: float = USUAL[0],
    bow: float = USUAL[1],
    **ends: float | str,
) -> Moved:
    """How far the belt of a machine is deflected up to a shaft angle."""
    given: dict[str, Any] = {"belt_mass": mass, "bow": bow, "bow_of": bow_of, **ends}
    turns = math.ceil(last * STEPS / (2.0 * math.pi) - 1e-9) / STEPS
    values = {"shaft.speed": speed, "revolutions": turns}
    values |= {f"belt_motion.{name}": value for name, value in given.items()}
    found = prepared(machine).evaluate(values, errors="none")
    return Moved(*(float(found.trace[name][-1]) for name in KEPT))


def pushed(machine: str, share: float, bow_of: str, *belt_and_bow: float, **ends: float | str) -> float:
    """Largest deflection while the head is pushed in, at a share of the static safe speed [m]."""
    speed, end = share * belt.safe(machine).speed, belt.window(machine)[1]
    return moved(machine, speed, bow_of, end, *belt_and_bow, **ends).at_risk


def growth(machine: str, bow_of: str, slow: float, fast: float, **ends: float | str) -> float:
    """Factor by which it grows from one share of that speed to another."""
    return pushed(machine, fast, bow_of, **ends) / pushed(machine, slow, bow_of, **ends)


def growths() -> tuple[float, float]:
    """Smallest and largest factor from a fifth below the static limit to a fifth above, by other ends."""
    ends = [arguments(row["arguments"])[1] for row in table("belt_ends") if row["arguments"]]
    found = [growth(machine, of, 0.8, 1.2, **given) for machine in MACHINES for of in BOWS for given in ends]
    return min(found), max(found)


def beyond() -> tuple[float, float]:
    """Least and most that a guided head lets a bow of the span be deflected, far above the limit [m]."""
    found = [pushed(machine, 1.5, "span", head_end="guided") for machine in MACHINES]
    return min(found), max(found)


def tilt(bow_of: str, offset: float) -> float:
    """Share by which a guide out of line changes the deflection at the static limit."""
    usual, tilted = (pushed(MACHINES[0], 1.0, bow_of, **ends) for ends in ({}, {"guide_offset": offset}))
    return tilted / usual - 1.0


def sagging() -> float:
    """Free length at which a straight belt at rest sags by as much as is allowed, by its weight alone [m]."""
    stiffness = BeltDynamics().bending_stiffness / BeltDynamics().length_factor ** 2
    weight = USUAL[0] * GRAVITY
    return float((384.0 * stiffness * ALLOWED / (5.0 * weight)) ** 0.25)


def allowed(machine: str, bow_of: str, **ends: float | str) -> str:
    """Say at which shares of the static limit the deflection under the push is what is allowed or less."""

    def excess(share: float) -> float:
        return pushed(machine, share, bow_of, **ends) - ALLOWED

    parts: list[str] = []
    start = SHARES[0] if excess(SHARES[0]) <= 0.0 else None
    for low, high in pairwise(SHARES):
        if (excess(low) <= 0.0) == (excess(high) <= 0.0):
            continue
        edge = float(brentq(excess, low, high, xtol=2e-3))
        if start is None:
            start = edge
            continue
        parts.append(f"to {edge:.2f}" if start == SHARES[0] else f"{start:.2f} to {edge:.2f}")
        start = None
    if start is not None:
        parts.append("all" if start == SHARES[0] else f"from {start:.2f}")
    return ", ".join(parts) or "none"


def worth(machine: str, bow_of: str, share: float) -> str:
    """Say what the static criterion is worth at the corners of the assumed ranges."""
    beyond = sum(pushed(machine, share, bow_of, *corner) > ALLOWED for corner in CORNERS)
    if share < 1.0:
        return "safe" if beyond == 0 else f"misses {beyond} of 4"
    return "right" if beyond == 4 else f"cautious in {4 - beyond} of 4"
