"""The belt at rest, or as it only follows the growth of its length."""

from math import fabs, pi

from .belt_board import board_matrix
from .belt_ends import at_ends, end_slopes, moment_forces, reactions, turned_by
from .belt_guide import lag, leans_on
from .belt_modes import dot, first_modes, size, summed
from .belt_motion import accelerations
from .belt_moving import Belt, Instant, instant
from .numerics.elimination import eliminated

REPEATS = 200  # until the belt is in equilibrium
WHOLE = 20  # of them, on a board: then they go half as far
RESTED = 1e-9  # of the modes: what the last repeat may change
AT_REST = 1e-11  # of the accelerations by bending: what rounding leaves of them in equilibrium


def rest(
    belt: Belt,
    length: float,
    velocity: float,
    acceleration: float,
    tension: float,
    q: list[float],
    v: list[float],
) -> tuple[bool, int]:
    """Look for the shape that only follows the growth of the free length, from a straight belt on.

    Args:
        length, velocity, acceleration, tension: L, V, A and the weft's load [m, m/s, m/s2, N]
        q, v: get its modes and their rates; zero where it leaves the belt

    Returns:
        whether it was found, and the side of its guide on which the belt leans
    """
    at_rest = False
    contact = 0
    load = (belt.head_mass + 0.5 * belt.mass * length) * acceleration + tension
    thrown = belt.mass * velocity * velocity
    if load + thrown > 0.8 * pi * pi * belt.stiffness / (length * length):
        return at_rest, contact
    at = instant(belt, length, velocity, acceleration, tension)
    for repeat in range(REPEATS):
        if at_rest:
            return at_rest, contact
        contact = leans_on(belt, at, q, v)
        clamped = contact != 0 or belt.guided
        for n in range(6):
            v[n] = velocity * lengthened(at, clamped, n) * q[n]
        found, _load = accelerations(belt, at, contact, q, v)
        before = size(q)
        for n in range(6):  # beyond those of the growing length
            by_length = lengthened(at, clamped, n)
            wanted = velocity * velocity * (by_length - 1.0 / length) + acceleration
            found[n] = found[n] - wanted * by_length * q[n]
        # what the mass of the head, by its lag, takes from them
        pulls, _rate = lag(belt, at, contact, q, v)
        freed = 2.0 * belt.head_mass / (belt.mass * length) * dot(pulls, found)
        found = summed(freed, pulls, found)
        if belt.board.side != 0.0:
            change = yielded_on_board(belt, length, load, contact, q, found)
            part = 1.0 if repeat < WHOLE else 0.5  # places that touch by turns
            for n in range(6):
                q[n] = q[n] + part * change[n]
        else:
            if clamped:
                held = moments_of_ends(belt, length, load, contact, found)
                found = first_modes(belt.modes, held)
            for n in range(6):
                q[n] = q[n] + yielded(belt, length, load, n, found[n])
        if not size(q) < length:
            for n in range(6):
                q[n] = 0.0
                v[n] = 0.0
            return False, 0
        at_rest = fabs(size(q) - before) <= RESTED * before
    return at_rest, contact


def yielded(belt: Belt, length: float, load: float, place: int, acceleration: float) -> float:
    """Change of a mode by which its acceleration would vanish; modes count from 0."""
    wave = (place + 1) * pi / length
    stiff = wave * wave * (belt.stiffness * wave * wave - load)
    return belt.mass * acceleration / stiff


def yielded_on_board(
    belt: Belt, length: float, load: float, contact: int, q: list[float], found: list[float]
) -> list[float]:
    """As `yielded`, of all modes at once, which a board and clamped ends tie to each other."""
    clamped = (1 if contact != 0 else 0) + (2 if belt.guided else 0)
    moment = 6.0 * belt.stiffness / (length * length * length)
    half = 0.5 * belt.mass * length
    stiff = board_matrix(belt, length, q)
    for column in range(6):
        mode = [1.0 if n == column else 0.0 for n in range(6)]
        guide, head = end_slopes(mode)
        guide_excess, head_excess = turned_by(clamped, -guide, -head)
        ends = moment_forces(moment * guide_excess, moment * head_excess)
        for row in range(6):
            stiff[6 * row + column] = stiff[6 * row + column] - ends[row]
    for row in range(6):
        stiff[7 * row] = stiff[7 * row] + half / yielded(belt, length, load, row, 1.0)
        for column in range(6):
            if row != column and (row >= belt.modes or column >= belt.modes):
                stiff[6 * row + column] = 0.0
    forces = [half * found[n] for n in range(6)]
    return eliminated(stiff, forces)


def lengthened(at: Instant, clamped: bool, place: int) -> float:
    """Change of a mode at rest by the free length, over the mode; not counted if an end is clamped."""
    if clamped or at.moments[place] == 0.0:
        return 0.0
    return at.by_length[place] / at.moments[place] + 3.0 / at.length


def moments_of_ends(belt: Belt, length: float, load: float, contact: int, found: list[float]) -> list[float]:
    """Accelerations less the share of the moments at the clamped ends."""
    odd, odd_yield, even, even_yield = 0.0, 0.0, 0.0, 0.0
    for place in range(belt.modes):
        wave = (place + 1) * pi
        slope = wave * yielded(belt, length, load, place, found[place])
        share = wave / length
        stiff = share * share * (belt.stiffness * share * share - load)
        if place % 2 == 0:
            odd, odd_yield = odd + slope, odd_yield + belt.mass * wave * wave / stiff
        else:
            even, even_yield = even + slope, even_yield + belt.mass * wave * wave / stiff
    weight = 12.0 * belt.stiffness / (belt.mass * length * length * length * length)
    clamped = (1 if contact != 0 else 0) + (2 if belt.guided else 0)
    odd, even = reactions(clamped, weight, odd_yield, even_yield, odd, even)
    moments = at_ends(-odd, -even)
    return summed(1.0, moments, found)


def rests(belt: Belt, at: Instant, contact: int, q: list[float], v: list[float]) -> bool:
    """Return whether the belt is in equilibrium at an instant at which nothing moves."""
    if size(v) != 0.0:
        return False
    found, _load = accelerations(belt, at, contact, q, v)
    wave = pi / at.length
    bending = belt.stiffness / belt.mass * wave * wave * wave * wave
    return size(found) <= AT_REST * bending * size(q)
