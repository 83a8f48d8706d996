"""The length factor of Zhu and Zhou beside that of a guide with free play: a finding of our own."""

import math

import numpy as np
from scipy.optimize import brentq

from ..components.belt_dynamics import BeltDynamics
from ..machines import table
from ..physics.belt_ends import end_shape
from ..physics.belt_shape import shape_at
from .sections import Row, Section, number

GUIDES = (0.025, 0.05, 0.1)  # m: the length of the guide is not published
SHORTEST, LONGEST = 1e-3, 2.0  # m, of a guide that is looked for
LENGTHS = ("414", "665")  # mm, the shortest and the longest belt of Table 2
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


def length_factor(clearance: float, guide: float, length: float) -> float:
    """Length factor of the load at which the deflection is `ALLOWED`: pi over the turn.

    Up to Euler's load of pinned ends a straight belt stays straight within its free play.
    """
    if clearance == 0.0:
        return math.pi / CLAMPED
    if deflection(math.pi, clearance, guide, length) >= ALLOWED:
        return 1.0
    below = CLAMPED * (1.0 - 1e-12)
    turn: float = brentq(lambda u: deflection(u, clearance, guide, length) - ALLOWED, math.pi, below)
    return math.pi / turn


def bent(turn: float, clearance: float, guide: float, length: float) -> float:
    """As `deflection`, of `BeltDynamics` that has come to rest under that load [m].

    At rest neither its mass nor its damping matters; with these it needs few steps.
    """
    belt = BeltDynamics(bow=0.0, guide_end=2, guide_clearance=clearance, guide_length=guide, damping=600.0)
    belt.travel = belt.idle_travel + belt.head_length + length
    belt.belt_mass = belt.bending_stiffness * (math.pi / length) ** 4 / belt.damping**2
    belt.initialize(0.0)
    belt.mode = (0.5 * ALLOWED, 0.0, 0.0, 0.0, 0.0, 0.0)
    belt.yarn_tension = belt.bending_stiffness * (turn / length) ** 2
    for n in range(RELAXING):
        belt.step(n * 5e-4, 5e-4)
    at_guide, at_head = belt.ends(length, 0.0)[2:4]
    from_line = [
        shape_at(x, *end_shape(at_guide, at_head, *belt.mode), at_guide, at_head)[0] for x in PLACES.tolist()
    ]
    return float(np.abs(np.array(from_line) - 0.5 * clearance * belt.guide_contact * PLACES).max())


def length_factor_in_motion(clearance: float, guide: float, length: float) -> float:
    """As `length_factor`, of `BeltDynamics`: from the static one by one step of Newton's method."""
    case = (clearance, guide, length)
    turn = math.pi / length_factor(*case)
    slope = (deflection(turn + 1e-6, *case) - deflection(turn - 1e-6, *case)) / 2e-6
    return math.pi / (turn - (bent(turn, *case) - ALLOWED) / slope)


def measured(clearance: str, length: str) -> tuple[float, float]:
    """Lowest and highest length factor of a load of Table 2, printed in whole newtons; arguments in mm."""
    row = next(row for row in table("belt_buckling_experiment") if row["free_length_mm"] == length)
    load, stiffness = float(row[f"c_{clearance}"]), BeltDynamics().bending_stiffness
    low, high = (
        math.pi / (1e-3 * float(length)) * math.sqrt(stiffness / (load + half)) for half in (0.5, -0.5)
    )
    return low, high


def guide_for(factor: float, clearance: float, length: float) -> float:
    """Length of the guide that gives a length factor [m]: 0 if any gives less, infinite if any gives more."""

    def excess(guide: float) -> float:
        return length_factor(clearance, guide, length) - factor

    if excess(SHORTEST) <= 0.0:  # the factor falls with the length of the guide
        return 0.0
    return math.inf if excess(LONGEST) >= 0.0 else float(brentq(excess, SHORTEST, LONGEST))


def _guides(clearance: str, length: str) -> str:
    """Guides that give a measured length factor, in millimetres."""
    low, high = measured(clearance, length)
    longest, shortest = (
        1e3 * guide_for(mu, 1e-3 * float(clearance), 1e-3 * float(length)) for mu in (low, high)
    )
    if longest == 0.0:
        return "none"
    if math.isinf(longest):
        return "any"
    return f"{number(shortest, 0)} to {number(longest, 0)}" if shortest else f"up to {number(longest, 0)}"


def section() -> Section:
    """The published and the measured factors beside those of free play."""
    rows = []
    for row in table("length_factor"):
        clearance = row["clearance_mm"]
        for length in LENGTHS:
            range_ = " to ".join(number(each, 3) for each in measured(clearance, length))
            found = (
                number(length_factor(1e-3 * float(clearance), guide, 1e-3 * float(length)), 3)
                for guide in GUIDES
            )
            cells = (clearance, length, row["length_factor"], range_, *found, _guides(clearance, length))
            rows.append(Row(cells))
    return Section(
        "The length factor of a guide with free play: only the ends of the range come out",
        (
            "clearance, mm", "free length, mm", "published", "measured",
            *(f"computed, guide of {number(1e3 * guide, 0)} mm" for guide in GUIDES),
            "guides that give the measured one, mm",
        ),
        tuple(rows),
        intro="The belt lies across the clearance of a stiff guide: up to a slope of clearance over length of"
        " the guide it turns freely, then not at all. It counts as buckled where it is deflected by"
        f" {number(1e3 * ALLOWED, 0)} mm, which section 4.2 of the source allows. Head pinned. Published:"
        " Table 3. Measured: by (8) from the loads of Table 2, which are rounded to 1 N. The length of the"
        " guide is not published; nothing is chosen to fit.",
        remarks=(
            "Without clearance the belt is clamped in the guide, which gives"
            f" {number(math.pi / CLAMPED, 3)} for 0.70; with enough of it the belt buckles before it leans on"
            " both walls, as if it were pinned, which gives 1. Neither tests the length of the guide.",
            "In between no length of the guide fits. At 0.30 and 0.50 mm the shortest and the longest belt"
            " require guides of different lengths, and so does the shortest belt at 0.30, 0.50 and 0.75 mm:"
            " the computed factor grows with the length of the belt, the measured one does not. So a stiff"
            " guide with free play does not explain the published factors.",
        ),
    )  # fmt: skip


def in_motion() -> Section:
    """The factors of statics beside those that come out of `BeltDynamics`."""
    published = {float(row["clearance_mm"]): row["length_factor"] for row in table("length_factor")}
    rows = []
    for clearance in (0.3, 0.5):
        for guide in GUIDES:
            case = (1e-3 * clearance, guide, 1e-3 * float(LENGTHS[0]))
            factors = (length_factor(*case), length_factor_in_motion(*case))
            if factors[0] == 1.0:
                continue
            cells = (number(each, 4) for each in factors)
            rows.append(Row((f"{clearance}", number(1e3 * guide, 0), published[clearance], *cells)))
    return Section(
        "The same length factor out of the motion, under a slow load",
        ("clearance, mm", "guide, mm", "published", "statics", "`BeltDynamics` with `guide_end = play`"),
        tuple(rows),
        intro="The belt of 414 mm, given its load and left to come to rest. No length factor goes in:"
        " stiffness EI, free play, six modes and their end shapes. Where the pinned belt reaches 2 mm before"
        " it leans on both walls the factor is 1, and there is nothing to compare.",
    )  # fmt: skip
