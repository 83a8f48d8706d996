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
from .belt_end_forces import end_coupling
from .belt_ends import end_amplitudes, end_bending, end_motion, moment_forces, turning
from .belt_modes import bow_forces, carried_along, dot, first_modes, summed, weighed


def on_mode(
    twice: float,
    dragged: float,
    pushed: float,
    thrown: float,
    slowed: float,
    stiffness: float,
    y: float,
    x: float,
    w: float,
    z: float,
    v: float,
    bend: float,
    bow: float,
    end: float,
) -> float:
    """Force on a mode, without the compression; see `accelerations`."""
    return twice * y + dragged * x + pushed * w + thrown * z - slowed * v + stiffness * bend + bow + end


def accelerations(
    q1: float,
    q2: float,
    q3: float,
    q4: float,
    q5: float,
    q6: float,
    v1: float,
    v2: float,
    v3: float,
    v4: float,
    v5: float,
    v6: float,
    length: float,
    velocity: float,
    acceleration: float,
    tension: float,
    head_mass: float,
    belt_mass: float,
    damping: float,
    stiffness: float,
    offset: float,
    clamped: int,
    turn: float,
    turn_by_length: float,
    modes: int,
    b1: float,
    b2: float,
    b3: float,
    b4: float,
    b5: float,
    b6: float,
    e: float,
    h: float,
    e_by_length: float,
    h_by_length: float,
    e_second: float,
    h_second: float,
) -> tuple[float, float, float, float, float, float, float]:
    """Second rates of the modes, and the compression P0 of the belt at the head.

        M q'' = 2 rho V G q' + [rho A (G + J) + rho V^2/L H] q - c (L q'/2 - V G q) + B (f + b) + e
                + P0 g
        P0 = m (A - S'') + T,   M = rho L / 2

    G is `carried_along`, J and H are `weighed` by x and x^2, f and g are of `bent_belt`, b is of
    `bow_forces`, e is of `end_coupling` and the bending of the end shapes; S is the shortening, by which the
    head lags behind its drive.

    Args:
        q1 .. v6: modes and their rates [m, m/s]
        length, velocity, acceleration: L and its rates [m, m/s, m/s2]
        tension: T, compression of the belt by the weft [N]
        head_mass, belt_mass: m and rho [kg, kg/m]
        damping: c [N s/m2]
        stiffness: B [N m2]
        offset: see `tilt_forces` [m]
        clamped, turn, turn_by_length: see `end_motion`
        modes: number of modes that move; the others stay as they are
        b1 .. b6: moments of the bow on the modes, B b of `bow_forces` [N]
        e .. h_second: of `end_amplitudes` [m, 1, 1/m]

    Returns:
        second rates [m/s2], compression at the head [N]
    """
    x1, x2, x3, x4, x5, x6 = carried_along(q1, q2, q3, q4, q5, q6)
    y1, y2, y3, y4, y5, y6 = carried_along(v1, v2, v3, v4, v5, v6)
    w1, w2, w3, w4, w5, w6 = weighed(0.0, 0.0, 0.25 * pi * pi, q1, q2, q3, q4, q5, q6)
    z1, z2, z3, z4, z5, z6 = weighed(0.25, 1.0, pi * pi / 6.0, q1, q2, q3, q4, q5, q6)
    twice = 2.0 * belt_mass * velocity
    pushed = belt_mass * acceleration
    dragged = pushed + damping * velocity
    thrown = belt_mass * velocity * velocity / length
    slowed = 0.5 * damping * length
    half = 0.5 * belt_mass * length
    (d, k, guide, head, guide_rate, head_rate, guide_by_length, head_by_length, guide_second, head_second) = (
        end_motion(
            q1,
            q2,
            q3,
            q4,
            q5,
            q6,
            v1,
            v2,
            v3,
            v4,
            v5,
            v6,
            velocity,
            acceleration,
            clamped,
            turn,
            turn_by_length,
            e,
            h,
            e_by_length,
            h_by_length,
            e_second,
            h_second,
        )
    )
    (
        f1,
        f2,
        f3,
        f4,
        f5,
        f6,
        g1,
        g2,
        g3,
        g4,
        g5,
        g6,
        _short,
        _rate,
        second,
        _by_length,
        _energy,
        _growth,
        _turned_force,
        _turned_pull,
    ) = bent_belt(
        q1,
        q2,
        q3,
        q4,
        q5,
        q6,
        v1,
        v2,
        v3,
        v4,
        v5,
        v6,
        length,
        velocity,
        acceleration,
        clamped,
        guide,
        head,
        guide_rate,
        head_rate,
        guide_by_length,
        head_by_length,
        guide_second,
        head_second,
    )
    c1, c2, c3, c4, c5, c6 = end_coupling(
        q1,
        q2,
        q3,
        q4,
        q5,
        q6,
        v1,
        v2,
        v3,
        v4,
        v5,
        v6,
        velocity,
        acceleration,
        belt_mass,
        damping,
        thrown,
        offset,
        clamped,
        guide,
        head,
        guide_rate,
        head_rate,
    )
    moment = 6.0 * stiffness / (length * length * length)
    m1, m2, m3, m4, m5, m6 = moment_forces(moment * d, moment * k)
    e1, e2, e3, e4, e5, e6 = summed(1.0, m1, m2, m3, m4, m5, m6, c1, c2, c3, c4, c5, c6)
    u1 = on_mode(twice, dragged, pushed, thrown, slowed, stiffness, y1, x1, w1, z1, v1, f1, b1, e1) / half
    u2 = on_mode(twice, dragged, pushed, thrown, slowed, stiffness, y2, x2, w2, z2, v2, f2, b2, e2) / half
    u3 = on_mode(twice, dragged, pushed, thrown, slowed, stiffness, y3, x3, w3, z3, v3, f3, b3, e3) / half
    u4 = on_mode(twice, dragged, pushed, thrown, slowed, stiffness, y4, x4, w4, z4, v4, f4, b4, e4) / half
    u5 = on_mode(twice, dragged, pushed, thrown, slowed, stiffness, y5, x5, w5, z5, v5, f5, b5, e5) / half
    u6 = on_mode(twice, dragged, pushed, thrown, slowed, stiffness, y6, x6, w6, z6, v6, f6, b6, e6) / half
    u1, u2, u3, u4, u5, u6 = first_modes(modes, u1, u2, u3, u4, u5, u6)
    g1, g2, g3, g4, g5, g6 = first_modes(modes, g1, g2, g3, g4, g5, g6)
    along = dot(g1, g2, g3, g4, g5, g6, u1, u2, u3, u4, u5, u6)
    square = dot(g1, g2, g3, g4, g5, g6, g1, g2, g3, g4, g5, g6)
    load = (head_mass * (acceleration - second - along) + tension) / (1.0 + head_mass * square / half)
    lift = load / half
    return (
        u1 + lift * g1,
        u2 + lift * g2,
        u3 + lift * g3,
        u4 + lift * g4,
        u5 + lift * g5,
        u6 + lift * g6,
        load,
    )


def energy_and_powers(
    q1: float,
    q2: float,
    q3: float,
    q4: float,
    q5: float,
    q6: float,
    v1: float,
    v2: float,
    v3: float,
    v4: float,
    v5: float,
    v6: float,
    a1: float,
    a2: float,
    a3: float,
    a4: float,
    a5: float,
    a6: float,
    length: float,
    velocity: float,
    acceleration: float,
    tension: float,
    head_mass: float,
    belt_mass: float,
    damping: float,
    stiffness: float,
    bow_of: int,
    bow: float,
    bow_length: float,
    offset: float,
    may_clamp: bool,
    clamped: int,
    turn: float,
    turn_by_length: float,
    load: float,
) -> tuple[float, float, float, float]:
    """Energy of the motion across the belt, and the powers that change it.

    The energy is that of u_t, of bending against the straight belt, and of the lag of the head. It grows by
    the compression's work on the shortening, and by what the guide exit, an end that moves along the belt,
    puts in: `V [d/dt(dT/dV) - dT/dL + dU/dL - P0 dS/dL]`, and the inertia of the end shapes.

    Args:
        q1 .. a6: modes and their rates [m, m/s, m/s2]
        length .. stiffness, offset, clamped .. turn_by_length: as for `accelerations`
        bow_of, bow, bow_length: see `bow_at`
        may_clamp: see `end_amplitudes`
        load: compression at the head P0 [N]

    Returns:
        energy [J], power of the compression, power at the guide, power lost by damping [W]
    """
    x1, x2, x3, x4, x5, x6 = carried_along(q1, q2, q3, q4, q5, q6)
    w1, w2, w3, w4, w5, w6 = weighed(0.0, 0.0, 0.25 * pi * pi, q1, q2, q3, q4, q5, q6)
    z1, z2, z3, z4, z5, z6 = weighed(0.25, 1.0, pi * pi / 6.0, q1, q2, q3, q4, q5, q6)
    b1, b2, b3, b4, b5, b6, d1, d2, d3, d4, d5, d6 = bow_forces(bow_of, bow, bow_length, length)
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
    e, h, e_by_length, h_by_length, e_second, h_second = end_amplitudes(
        bow_of, bow, bow_length, length, may_clamp
    )
    (
        d,
        k,
        at_guide,
        at_head,
        guide_rate,
        head_rate,
        guide_by_length,
        head_by_length,
        guide_second,
        head_second,
    ) = end_motion(
        q1,
        q2,
        q3,
        q4,
        q5,
        q6,
        v1,
        v2,
        v3,
        v4,
        v5,
        v6,
        velocity,
        acceleration,
        clamped,
        turn,
        turn_by_length,
        e,
        h,
        e_by_length,
        h_by_length,
        e_second,
        h_second,
    )
    (
        _f1,
        _f2,
        _f3,
        _f4,
        _f5,
        _f6,
        _g1,
        _g2,
        _g3,
        _g4,
        _g5,
        _g6,
        _short,
        rate,
        _second,
        by_length,
        bent,
        bent_by_length,
        _turned_force,
        _turned_pull,
    ) = bent_belt(
        q1,
        q2,
        q3,
        q4,
        q5,
        q6,
        v1,
        v2,
        v3,
        v4,
        v5,
        v6,
        length,
        velocity,
        acceleration,
        clamped,
        at_guide,
        at_head,
        guide_rate,
        head_rate,
        guide_by_length,
        head_by_length,
        guide_second,
        head_second,
    )
    c1, c2, c3, c4, c5, c6 = end_coupling(
        q1,
        q2,
        q3,
        q4,
        q5,
        q6,
        v1,
        v2,
        v3,
        v4,
        v5,
        v6,
        velocity,
        acceleration,
        belt_mass,
        damping,
        belt_mass * velocity * share,
        offset,
        clamped,
        at_guide,
        at_head,
        guide_rate,
        head_rate,
    )
    guide_growth, head_growth = turning(turn_by_length, e_by_length, h_by_length)
    end_energy, end_growth = end_bending(length, stiffness, guide_growth, head_growth, d, k)
    energy = belt_mass * moving + 0.5 * head_mass * rate * rate + stiffness * (bent - bowed) + end_energy
    push = (head_mass * acceleration + tension) * rate + belt_mass * acceleration * weight
    inertia = (acceleration / length - 0.5 * share * share) * spread + 2.0 * share * sweep - swing
    elastic = stiffness * (bent_by_length - bowed_by_length) + end_growth
    drag = damping * (share * spread - drift)
    guide = velocity * (belt_mass * inertia + elastic - load * by_length + drag)
    guide = guide + dot(v1, v2, v3, v4, v5, v6, c1, c2, c3, c4, c5, c6)
    return energy, push, guide, 2.0 * damping * moving
