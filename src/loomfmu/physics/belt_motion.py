"""Transverse motion of the rapier belt between its guide and the head: six modes on a growing length.

The source, Zhu and Zhou, J. Zhejiang Sci-Tech Univ. 45 (2021) 497, compares compression with Euler's load
at each instant; the motion is our own. X counts along the belt from the head, so that a value of X is a point
of the belt; the free part is 0 <= X <= L(t), L' = V, V' = A. With its deflection u(X, t)

    rho u_tt + c u_t + (P u_X)_X + B u_XXXX = B bow_XXXX,   P = P0 + rho A X
    u = sum q_n(t) sin(n pi X / L(t)),   n = 1 .. 6

Lagrange's equations of these modes hold without a term for the mass that comes in, since neither u nor the
axial displacement can vary at the guide. Bending and shortening are those of an inextensible belt,
for rotations up to 77 degrees; the belt's own axial inertia counts to the second order of the slope.
"""

from math import pi

from .belt_bending import bent_belt
from .belt_board import board_forces
from .belt_end_forces import end_coupling
from .belt_ends import Ends, end_bending, end_motion, moment_forces, turning
from .belt_modes import carried_along, dot, first_modes, summed, weighed
from .belt_moving import Belt, Instant


def free_turn(belt: Belt, length: float) -> float:
    """Slope up to which the belt turns freely in its guide, counted from its line, times its length [m]."""
    return (length / belt.guide_length + 0.5) * belt.clearance


def ends_at(belt: Belt, at: Instant, contact: int, q: list[float], v: list[float]) -> Ends:
    """The end shapes at an instant."""
    clamped = (1 if contact != 0 else 0) + (2 if belt.guided else 0)
    turn = contact * free_turn(belt, at.length)
    by_length = contact * belt.clearance / belt.guide_length
    return end_motion(at.ends, at.velocity, at.acceleration, clamped, turn, by_length, q, v)


def accelerations(
    belt: Belt, at: Instant, contact: int, q: list[float], v: list[float]
) -> tuple[list[float], float]:
    """Second rates of the modes [m/s2], and the compression P0 of the belt at the head [N].

        M q'' = 2 rho V G q' + [rho A (G + J) + rho V^2/L H] q - c (L q'/2 - V G q) + B (f + b) + e
                + P0 g
        P0 = m (A - S'') + T,   M = rho L / 2

    G is `carried_along`, J and H are `weighed` by x and x^2, f and g are of `bent_belt`, b is of
    `bow_forces`, e is of `end_coupling` and the bending of the end shapes; S is the shortening, by which the
    head lags behind its drive.
    """
    length = at.length
    stiffness = belt.stiffness
    x = carried_along(q)
    y = carried_along(v)
    w = weighed(0.0, 0.0, 0.25 * pi * pi, q)
    z = weighed(0.25, 1.0, pi * pi / 6.0, q)
    b = list(at.moments)
    twice = 2.0 * belt.mass * at.velocity
    pushed = belt.mass * at.acceleration
    dragged = pushed + belt.damping * at.velocity
    thrown = belt.mass * at.velocity * at.velocity / length
    slowed = 0.5 * belt.damping * length
    half = 0.5 * belt.mass * length
    ends = ends_at(belt, at, contact, q, v)
    bending = bent_belt(at, ends, q, v)
    f = list(bending.moments)
    moment = 6.0 * stiffness / (length * length * length)
    coupled = end_coupling(belt, at, ends, thrown, q, v)
    held = moment_forces(moment * ends.guide_excess, moment * ends.head_excess)
    e = summed(1.0, held, coupled)
    if belt.board.side != 0.0:
        pressed, _energy = board_forces(belt, length, q)
        e = summed(1.0, pressed, e)
    u = [
        (
            twice * y[n]
            + dragged * x[n]
            + pushed * w[n]
            + thrown * z[n]
            - slowed * v[n]
            + stiffness * f[n]
            + stiffness * b[n]
            + e[n]
        )
        / half
        for n in range(6)
    ]
    u = first_modes(belt.modes, u)
    g = first_modes(belt.modes, bending.pulls)
    along = dot(g, u)
    square = dot(g, g)
    load = (belt.head_mass * (at.acceleration - bending.second - along) + at.tension) / (
        1.0 + belt.head_mass * square / half
    )
    return summed(load / half, g, u), load


def energy_and_powers(
    belt: Belt, at: Instant, contact: int, q: list[float], v: list[float], a: list[float], load: float
) -> tuple[float, float, float, float]:
    """Energy of the motion across the belt [J], and powers of the compression, at the guide, and lost [W].

    The energy is that of u_t, of bending against the straight belt, and of the lag of the head. It grows by
    the compression's work on the shortening, and by what the guide exit, an end that moves along the belt,
    puts in: `V [d/dt(dT/dV) - dT/dL + dU/dL - P0 dS/dL]`, and the inertia of the end shapes.

    Args:
        a: second rates of the modes [m/s2]
        load: compression at the head P0 [N]
    """
    velocity = at.velocity
    x = carried_along(q)
    w = weighed(0.0, 0.0, 0.25 * pi * pi, q)
    z = weighed(0.25, 1.0, pi * pi / 6.0, q)
    bowed = dot(at.moments, q)
    bowed_by_length = dot(at.by_length, q)
    drift = dot(v, x)
    spread = dot(q, z)
    share = velocity / at.length
    moving = 0.5 * at.length * (0.5 * dot(v, v) - 2.0 * share * drift + share * share * spread)
    ends = ends_at(belt, at, contact, q, v)
    bending = bent_belt(at, ends, q, v)
    coupled = end_coupling(belt, at, ends, belt.mass * velocity * share, q, v)
    guide_growth, head_growth = turning(contact * belt.clearance / belt.guide_length, at.ends)
    end_energy, end_growth = end_bending(
        at.length, belt.stiffness, guide_growth, head_growth, ends.guide_excess, ends.head_excess
    )
    rate = bending.rate
    energy = belt.mass * moving + 0.5 * belt.head_mass * rate * rate
    energy = energy + belt.stiffness * (bending.energy - bowed) + end_energy
    push = (belt.head_mass * at.acceleration + at.tension) * rate + belt.mass * at.acceleration * dot(v, w)
    inertia = (at.acceleration / at.length - 0.5 * share * share) * spread + 2.0 * share * dot(v, z)
    inertia = inertia - dot(a, x)
    elastic = belt.stiffness * (bending.energy_by_length - bowed_by_length) + end_growth
    drag = belt.damping * (share * spread - drift)
    guide = velocity * (belt.mass * inertia + elastic - load * bending.by_length + drag)
    guide = guide + dot(v, coupled)
    if belt.board.side != 0.0:
        _forces, pressed = board_forces(belt, at.length, q)
        energy = energy + pressed
        guide = guide + share * pressed
    return energy, push, guide, 2.0 * belt.damping * moving


def energy_at(belt: Belt, at: Instant, contact: int, q: list[float], v: list[float]) -> float:
    """Energy of the motion across the belt [J], see `energy_and_powers`."""
    energy, _push, _guide, _loss = energy_and_powers(belt, at, contact, q, v, [0.0] * 6, 0.0)
    return energy
