"""Contact of the belt with its guide, in which it turns freely up to a slope, and the changes of it."""

from math import fabs

from .belt_bending import bent_belt
from .belt_ends import OTHER, OWN, end_slopes, turning
from .belt_modes import dot, first_modes, size, summed
from .belt_motion import ends_at, free_turn
from .belt_moving import Belt, Instant
from .numerics.absent import absent
from .numerics.brackets import at_root
from .numerics.motion import met

TOUCHING = 1e-6  # of the modes: a turn that close to the free one is at the stop
HALVINGS = 50  # of an integration step: then the place is known to rounding


def has_play(belt: Belt) -> bool:
    """Return whether the belt turns freely in its guide, up to a slope."""
    return belt.leaning and belt.clearance > 0.0


def free_slope(belt: Belt, at: Instant, q: list[float], v: list[float]) -> tuple[float, float]:
    """Slope at the guide times the length, as if the belt turned freely there, and its rate."""
    guide, head = end_slopes(q)
    guide_rate, head_rate = end_slopes(v)
    guide_growth, head_growth = turning(0.0, at.ends)
    turn = guide + OWN * at.ends.guide + OTHER * at.ends.head
    rate = guide_rate - guide_growth * at.velocity
    if belt.guided:
        turn = turn - OTHER / OWN * (head + OTHER * at.ends.guide + OWN * at.ends.head)
        rate = rate - OTHER / OWN * (head_rate - head_growth * at.velocity)
    return turn, rate


def leans_on(belt: Belt, at: Instant, q: list[float], v: list[float]) -> int:
    """Side of its guide on which the belt leans, 1 or -1; 0 if it does not."""
    turn, _rate = free_slope(belt, at, q, v)
    if belt.leaning and fabs(turn) >= free_turn(belt, at.length):
        return -1 if turn < 0.0 and not absent(belt.clearance) else 1
    return 0


def gap(belt: Belt, at: Instant, contact: int, side: int, turn: float, rate: float) -> tuple[float, float]:
    """By how much contact on a side, or its absence, fits a `free_slope`, negative if not; its rate."""
    beyond = side * turn - free_turn(belt, at.length)
    growth = side * rate - belt.clearance / belt.guide_length * at.velocity
    if contact != 0:
        return beyond, growth
    return -beyond, -growth


def side_of(contact: int, turn: float) -> int:
    """Side of the guide on which the belt leans, or to which it is turned by its `free_slope`."""
    if contact != 0:
        return contact
    return 1 if turn >= 0.0 else -1


def next_contact(belt: Belt, at: Instant, contact: int, q: list[float], v: list[float]) -> int:
    """The contact in the guide that follows, where it is about to change; else as it is."""
    turn, rate = free_slope(belt, at, q, v)
    side = side_of(contact, turn)
    fits, growth = gap(belt, at, contact, side, turn, rate)
    near = TOUCHING * size(q)
    if fits < -near or (fits <= near and growth < 0.0):
        return side if contact == 0 else 0
    return contact


def lag(belt: Belt, at: Instant, contact: int, q: list[float], v: list[float]) -> tuple[list[float], float]:
    """Rates of the shortening, by the modes that move and in time."""
    ends = ends_at(belt, at, contact, q, v)
    bending = bent_belt(at, ends, q, v)
    return first_modes(belt.modes, bending.pulls), bending.rate


def switched(belt: Belt, at: Instant, contact: int, then: int, q: list[float], v: list[float]) -> list[float]:
    """Rates of the modes where contact begins or ends: the end of the belt, without mass, changes its speed.

    So does the head, which lags by the shortening; its momentum goes to the modes.
    """
    _pulls, before = lag(belt, at, contact, q, v)
    pulls, rate = lag(belt, at, then, q, v)
    heavy = 2.0 * belt.head_mass / (belt.mass * at.length)
    push = heavy * (before - rate) / (1.0 + heavy * dot(pulls, pulls))
    return summed(push, pulls, v)


def before_switch(
    belt: Belt,
    contact: int,
    step: float,
    at: Instant,
    q: list[float],
    v: list[float],
    after: Instant,
    after_q: list[float],
    after_v: list[float],
) -> float:
    """Share of an integration step after which contact in the guide changes, 1 if it does not.

    Args:
        step: duration [s]
        at, q, v: start of the step, with modes and rates
        after, after_q, after_v: its end
    """
    if not has_play(belt):
        return 1.0
    turn, rate = free_slope(belt, after, after_q, after_v)
    side = side_of(contact, turn)
    end, end_rate = gap(belt, after, contact, side, turn, rate)
    if end >= -TOUCHING * size(q):
        return 1.0
    turn, rate = free_slope(belt, at, q, v)
    start, start_rate = gap(belt, at, contact, side, turn, rate)
    start = start if start > 0.0 else 0.0  # it stands at the stop, to rounding
    low = 0.0
    high = 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        value, _slope = met(middle, step, start, start_rate, end, end_rate)
        if value > 0.0:
            low = middle
        else:
            high = middle
    value, slope = met(high, step, start, start_rate, end, end_rate)
    return at_root(high, value, slope)
