"""A belt that leans on both walls of its guide, in closed form, and the length factor that follows."""

import math
from functools import cache

import numpy as np
from belt_loom import ends
from compiled import quick_belt
from scipy.optimize import brentq

from loomfmu.components.belt_dynamics import BeltDynamics
from loomfmu.machines import table
from loomfmu.physics.belt_ends import end_shape
from loomfmu.physics.belt_shape import shape_at

SHORTEST, LONGEST = 1e-3, 2.0  # m, of a guide that is looked for
ALLOWED = 2e-3  # m, section 4.2 of the source: at this deflection the belt counts as buckled
RELAXING = 160  # steps until a belt has come to rest
CLAMPED: float = brentq(lambda turn: math.sin(turn) - turn * math.cos(turn), 4.0, 4.7)  # one end, one pinned
PLACES = np.linspace(0.0, 1.0, 1001)


def deflection(turn: float, clearance: float, guide: float, length: float) -> float:
    """Largest deflection of a belt that leans on both walls of its guide [m].

    In the guide it lies across the clearance, so that it leaves it at half the clearance, with the slope
    `clearance / guide`; the head is pinned. `EI w'' + P w` is linear along the belt. So with x from the head
    and `k = sqrt(P / EI)`, `w = a sin(k x) + b x`, from place and slope at the guide.

    Args:
        turn: k times the free length, above pi [1]
        clearance, guide: free play, and the length over which the guide holds the belt [m]
        length: free length [m]
    """
    offset = 0.5 * clearance
    a = (offset + clearance / guide * length) / (math.sin(turn) - turn * math.cos(turn))
    return float(np.abs(a * np.sin(turn * PLACES) + (offset - a * math.sin(turn)) * PLACES).max())


def length_factor(clearance: float, guide: float, length: float, allowed: float = ALLOWED) -> float:
    """Length factor of the load at which the deflection is that large: pi over the turn.

    Up to Euler's load of pinned ends a straight belt stays straight within its free play.
    """
    if clearance == 0.0:
        return math.pi / CLAMPED
    if deflection(math.pi, clearance, guide, length) >= allowed:
        return 1.0
    below = CLAMPED * (1.0 - 1e-12)
    turn: float = brentq(lambda u: deflection(u, clearance, guide, length) - allowed, math.pi, below)
    return math.pi / turn


def sprung_factor(stiffness: float, length: float) -> float:
    """Length factor of a belt that a spring in its guide keeps from turning [N.m], pinned at its head."""
    share = stiffness * length / BeltDynamics().bending_stiffness
    pinned, clamped = math.pi * (1.0 + 1e-12), CLAMPED * (1.0 - 1e-12)
    turn: float = brentq(
        lambda u: u * u * math.sin(u) + share * (math.sin(u) - u * math.cos(u)), pinned, clamped
    )
    return math.pi / turn


def bent(turn: float, clearance: float, guide: float, length: float) -> float:
    """As `deflection`, of `BeltDynamics` that has come to rest under that load [m].

    At rest neither its mass nor its damping matters; with these it needs few steps.
    """
    belt = quick_belt()(bow=0.0, guide_end=2, guide_clearance=clearance, guide_length=guide, damping=600.0)
    belt.travel = belt.idle_travel + belt.head_length + length
    belt.belt_mass = belt.bending_stiffness * (math.pi / length) ** 4 / belt.damping**2
    belt.initialize(0.0)
    belt.mode = (0.5 * ALLOWED, 0.0, 0.0, 0.0, 0.0, 0.0)
    belt.yarn_tension = belt.bending_stiffness * (turn / length) ** 2
    for n in range(RELAXING):
        belt.step(n * 5e-4, 5e-4)
    (at_guide, at_head), _rates = ends(belt, length)
    shape = end_shape(at_guide, at_head, list(belt.mode))
    from_line = [shape_at(x, shape, at_guide, at_head)[0] for x in PLACES.tolist()]
    return float(np.abs(np.array(from_line) - 0.5 * clearance * belt.guide_contact * PLACES).max())


def length_factor_in_motion(clearance: float, guide: float, length: float) -> float:
    """As `length_factor`, of `BeltDynamics`: from the static one by one step of Newton's method."""
    case = (clearance, guide, length)
    turn = math.pi / length_factor(*case)
    slope = (deflection(turn + 1e-6, *case) - deflection(turn - 1e-6, *case)) / 2e-6
    return math.pi / (turn - (bent(turn, *case) - ALLOWED) / slope)


def measured_load(clearance: str, length: float) -> float:
    """A load of Table 2, printed in whole newtons: by a column, such as `c_0.30`, and a free length [m]."""
    rows = table("belt_buckling_experiment")
    return next(float(row[clearance]) for row in rows if float(row["free_length_mm"]) == round(1e3 * length))


@cache
def measured(clearance: str, length: float) -> tuple[float, float]:
    """Lowest and highest length factor of a `measured_load`, which is rounded."""
    load, stiffness = measured_load(clearance, length), BeltDynamics().bending_stiffness
    low, high = (math.pi / length * math.sqrt(stiffness / (load + half)) for half in (0.5, -0.5))
    return low, high


def guide_for(factor: float, clearance: float, length: float) -> float:
    """Length of the guide that gives a length factor [m]: 0 if any gives less, infinite if any gives more."""

    def excess(guide: float) -> float:
        return length_factor(clearance, guide, length) - factor

    if excess(SHORTEST) <= 0.0:  # the factor falls with the length of the guide
        return 0.0
    return math.inf if excess(LONGEST) >= 0.0 else float(brentq(excess, SHORTEST, LONGEST))
