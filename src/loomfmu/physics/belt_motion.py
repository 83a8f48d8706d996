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

from math import cos, pi, sin

from .belt_modes import bow_at, carried_along, dot, end_amplitude, end_forces, weighed
from .belt_shape import bent_belt


def accelerations(
    q1: float, q2: float, q3: float, q4: float, q5: float, q6: float,
    v1: float, v2: float, v3: float, v4: float, v5: float, v6: float,
    length: float, velocity: float, acceleration: float, tension: float, head_mass: float, belt_mass: float,
    damping: float, stiffness: float, bow_of: int, bow: float, bow_length: float,
) -> tuple[float, float, float, float, float, float, float]:  # fmt: skip
    """Second rates of the modes, and the compression P0 of the belt at the head.

        M q'' = 2 rho V G q' + [rho A (G + J) + rho V^2/L H] q - c (L q'/2 - V G q) + B (f + b) + e + P0 g
        P0 = m (A - S'') + T,   M = rho L / 2

    G is `carried_along`, J and H are `weighed` by x and x^2, f and g are of `bent_belt`, b is of `bow_at`,
    e is of `end_forces`; S is the shortening, by which the head lags behind its drive.

    Args:
        q1 .. v6: modes and their rates [m, m/s]
        length, velocity, acceleration: L and its rates [m, m/s, m/s2]
        tension: T, compression of the belt by the weft [N]
        head_mass, belt_mass: m and rho [kg, kg/m]
        damping: c [N s/m2]
        stiffness: B = EI / mu^2 [N m2]
        bow_of, bow, bow_length: see `bow_at`

    Returns:
        second rates [m/s2], compression at the head [N]
    """
    x1, x2, x3, x4, x5, x6 = carried_along(q1, q2, q3, q4, q5, q6)
    y1, y2, y3, y4, y5, y6 = carried_along(v1, v2, v3, v4, v5, v6)
    w1, w2, w3, w4, w5, w6 = weighed(0.0, 0.0, 0.25 * pi * pi, q1, q2, q3, q4, q5, q6)
    z1, z2, z3, z4, z5, z6 = weighed(0.25, 1.0, pi * pi / 6.0, q1, q2, q3, q4, q5, q6)
    (
        f1, f2, f3, f4, f5, f6, g1, g2, g3, g4, g5, g6, _short, _rate, second, _by_length, _energy, _growth
    ) = bent_belt(
        q1, q2, q3, q4, q5, q6, v1, v2, v3, v4, v5, v6, length, velocity, acceleration
    )  # fmt: skip
    twice = 2.0 * belt_mass * velocity
    pushed = belt_mass * acceleration
    dragged = pushed + damping * velocity
    thrown = belt_mass * velocity * velocity / length
    slowed = 0.5 * damping * length
    half = 0.5 * belt_mass * length
    cosine = cos(pi * length / bow_length)
    sine = sin(pi * length / bow_length)
    end, end_by_length = end_amplitude(bow_of, bow, bow_length, length, cosine, sine)
    e1, e2, e3, e4, e5, e6 = end_forces(
        twice * velocity * end_by_length + dragged * end, pushed * end, thrown * end
    )
    b1, _slope = bow_at(1, bow_of, bow, bow_length, length, cosine, sine)
    b2, _slope = bow_at(2, bow_of, bow, bow_length, length, cosine, sine)
    b3, _slope = bow_at(3, bow_of, bow, bow_length, length, cosine, sine)
    b4, _slope = bow_at(4, bow_of, bow, bow_length, length, cosine, sine)
    b5, _slope = bow_at(5, bow_of, bow, bow_length, length, cosine, sine)
    b6, _slope = bow_at(6, bow_of, bow, bow_length, length, cosine, sine)
    u1 = (
        twice * y1 + dragged * x1 + pushed * w1 + thrown * z1 - slowed * v1 + stiffness * (f1 + b1) + e1
    ) / half
    u2 = (
        twice * y2 + dragged * x2 + pushed * w2 + thrown * z2 - slowed * v2 + stiffness * (f2 + b2) + e2
    ) / half
    u3 = (
        twice * y3 + dragged * x3 + pushed * w3 + thrown * z3 - slowed * v3 + stiffness * (f3 + b3) + e3
    ) / half
    u4 = (
        twice * y4 + dragged * x4 + pushed * w4 + thrown * z4 - slowed * v4 + stiffness * (f4 + b4) + e4
    ) / half
    u5 = (
        twice * y5 + dragged * x5 + pushed * w5 + thrown * z5 - slowed * v5 + stiffness * (f5 + b5) + e5
    ) / half
    u6 = (
        twice * y6 + dragged * x6 + pushed * w6 + thrown * z6 - slowed * v6 + stiffness * (f6 + b6) + e6
    ) / half
    along = dot(g1, g2, g3, g4, g5, g6, u1, u2, u3, u4, u5, u6)
    square = dot(g1, g2, g3, g4, g5, g6, g1, g2, g3, g4, g5, g6)
    load = (head_mass * (acceleration - second - along) + tension) / (1.0 + head_mass * square / half)
    lift = load / half
    return (
        u1 + lift * g1, u2 + lift * g2, u3 + lift * g3, u4 + lift * g4, u5 + lift * g5, u6 + lift * g6, load,
    )  # fmt: skip


def energy_and_powers(
    q1: float, q2: float, q3: float, q4: float, q5: float, q6: float,
    v1: float, v2: float, v3: float, v4: float, v5: float, v6: float,
    a1: float, a2: float, a3: float, a4: float, a5: float, a6: float,
    length: float, velocity: float, acceleration: float, tension: float, head_mass: float, belt_mass: float,
    damping: float, stiffness: float, bow_of: int, bow: float, bow_length: float, load: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Energy of the motion across the belt, and the powers that change it.

    The energy is that of u_t, of bending against the straight belt, and of the lag of the head. It grows by
    the compression's work on the shortening, and by what the guide exit, an end that moves along the belt,
    puts in: `V [d/dt(dT/dV) - dT/dL + dU/dL - P0 dS/dL]`, and the forces of the end shape on the modes.

    Args:
        q1 .. a6: modes and their rates [m, m/s, m/s2]
        length .. bow_length: as for `accelerations`
        load: compression at the head P0 [N]

    Returns:
        energy [J], power of the compression, power at the guide, power lost by damping [W]
    """
    x1, x2, x3, x4, x5, x6 = carried_along(q1, q2, q3, q4, q5, q6)
    w1, w2, w3, w4, w5, w6 = weighed(0.0, 0.0, 0.25 * pi * pi, q1, q2, q3, q4, q5, q6)
    z1, z2, z3, z4, z5, z6 = weighed(0.25, 1.0, pi * pi / 6.0, q1, q2, q3, q4, q5, q6)
    (
        _f1, _f2, _f3, _f4, _f5, _f6, _g1, _g2, _g3, _g4, _g5, _g6, _shortening, rate, _second, by_length,
        bent, bent_by_length,
    ) = bent_belt(
        q1, q2, q3, q4, q5, q6, v1, v2, v3, v4, v5, v6, length, velocity, acceleration
    )  # fmt: skip
    cosine = cos(pi * length / bow_length)
    sine = sin(pi * length / bow_length)
    b1, d1 = bow_at(1, bow_of, bow, bow_length, length, cosine, sine)
    b2, d2 = bow_at(2, bow_of, bow, bow_length, length, cosine, sine)
    b3, d3 = bow_at(3, bow_of, bow, bow_length, length, cosine, sine)
    b4, d4 = bow_at(4, bow_of, bow, bow_length, length, cosine, sine)
    b5, d5 = bow_at(5, bow_of, bow, bow_length, length, cosine, sine)
    b6, d6 = bow_at(6, bow_of, bow, bow_length, length, cosine, sine)
    bowed = dot(b1, b2, b3, b4, b5, b6, q1, q2, q3, q4, q5, q6)
    bowed_by_length = dot(d1, d2, d3, d4, d5, d6, q1, q2, q3, q4, q5, q6)
    speeds = dot(v1, v2, v3, v4, v5, v6, v1, v2, v3, v4, v5, v6)
    drift = dot(v1, v2, v3, v4, v5, v6, x1, x2, x3, x4, x5, x6)
    spread = dot(q1, q2, q3, q4, q5, q6, z1, z2, z3, z4, z5, z6)
    sweep = dot(v1, v2, v3, v4, v5, v6, z1, z2, z3, z4, z5, z6)
    swing = dot(a1, a2, a3, a4, a5, a6, x1, x2, x3, x4, x5, x6)
    weight = dot(v1, v2, v3, v4, v5, v6, w1, w2, w3, w4, w5, w6)
    share = velocity / length
    moving = 0.5 * length * (0.5 * speeds - 2.0 * share * drift + share * share * spread)
    energy = belt_mass * moving + 0.5 * head_mass * rate * rate + stiffness * (bent - bowed)
    push = (head_mass * acceleration + tension) * rate + belt_mass * acceleration * weight
    inertia = (acceleration / length - 0.5 * share * share) * spread + 2.0 * share * sweep - swing
    elastic = stiffness * (bent_by_length - bowed_by_length)
    drag = damping * (share * spread - drift)
    pushed = belt_mass * acceleration
    end, end_by_length = end_amplitude(bow_of, bow, bow_length, length, cosine, sine)
    e1, e2, e3, e4, e5, e6 = end_forces(
        2.0 * belt_mass * velocity * velocity * end_by_length + (pushed + damping * velocity) * end,
        pushed * end, belt_mass * velocity * share * end,
    )  # fmt: skip
    guide = velocity * (belt_mass * inertia + elastic - load * by_length + drag)
    guide = guide + dot(v1, v2, v3, v4, v5, v6, e1, e2, e3, e4, e5, e6)
    return energy, push, guide, 2.0 * damping * moving
