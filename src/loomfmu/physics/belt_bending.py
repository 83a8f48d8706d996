"""Bending and shortening of an inextensible belt that is given by its modes and end shapes.

What is of second order in the slope is exact; the rest is summed over equal panels: exactly up to the fourth
order for products of the modes up to the 23rd.
"""

from math import cos, pi, sin, sqrt

from .belt_ends import CROSS, SQUARE, end_shape, moment_forces, turned_by
from .belt_modes import dot, harmonics

PANELS = 12  # of the belt, between the places where its bending is summed
COSINE = cos(pi / 12.0)
SINE = sin(pi / 12.0)
LEAST_SQUARE = 0.05  # of the cosine of the slope: beyond 77 degrees the belt counts as folded


def bent_belt(
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
    clamped: int,
    guide: float,
    head: float,
    guide_rate: float,
    head_rate: float,
    guide_by_length: float,
    head_by_length: float,
    guide_second: float,
    head_second: float,
) -> tuple[
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
]:
    """Bending and shortening of an inextensible belt with the sine of its slope `u_X`.

    With s = u_X and c = sqrt(1 - s^2): curvature u_XX / c, shortening 1 - c. What is of second order in s is
    exact, in bending that of the modes alone: see `end_bending`. The rest is summed over places.

    Args:
        q1 .. q6: modes [m]
        v1 .. v6: their rates [m/s]
        length, velocity, acceleration: L and its rates [m, m/s, m/s2]
        clamped: which ends are clamped
        guide .. head_second: amplitudes of the end shapes E and H, and their rates, of `end_motion`

    Returns:
        1 to 6: bending moment on each mode over the stiffness, negative rate of the energy by q_n [1/m2]
        7 to 12: rate of the shortening by q_n [1]
        13 to 15: shortening [m], its rate [m/s], its second rate without that by q_n'' [m/s2]
        16: rate of the shortening by L [1]
        17, 18: bending energy over the stiffness [1/m], its rate by L [1/m2]
        19, 20: as 1 and 7, by the slope at a clamped guide times L
    """
    over = 1.0 / length
    wave = pi * over
    a1, a2, a3, a4, a5, a6 = end_shape(guide, head, q1, q2, q3, q4, q5, q6)
    a1, a2, a3, a4, a5, a6 = numbered(wave, a1, a2, a3, a4, a5, a6)
    k1, k2, k3, k4, k5, k6 = numbered(-wave, a1, a2, a3, a4, a5, a6)
    b1, b2, b3, b4, b5, b6 = end_shape(guide_rate, head_rate, v1, v2, v3, v4, v5, v6)
    b1, b2, b3, b4, b5, b6 = numbered(wave, b1, b2, b3, b4, b5, b6)
    drift = velocity * over
    growth = acceleration * over
    c1 = 1.0
    s1 = 0.0
    f1 = 0.0
    f2 = 0.0
    f3 = 0.0
    f4 = 0.0
    f5 = 0.0
    f6 = 0.0
    g1 = 0.0
    g2 = 0.0
    g3 = 0.0
    g4 = 0.0
    g5 = 0.0
    g6 = 0.0
    guide_force = 0.0
    head_force = 0.0
    guide_pull = 0.0
    head_pull = 0.0
    shortening = 0.0
    rate = 0.0
    second = 0.0
    by_length = 0.0
    energy = 0.0
    energy_by_length = 0.0
    for pair in range(PANELS // 2 + 1):
        x = pair * (1.0 / PANELS)
        y = 1.0 - x
        by_x = 3.0 * x * x - 1.0
        by_y = 3.0 * y * y - 1.0
        # x and its mirror image y have the same harmonics but for the signs of the even ones
        c2, c3, c4, c5, c6, s2, s3, s4, s5, s6 = harmonics(c1, s1)
        odd = a1 * c1 + a3 * c3 + a5 * c5
        even = a2 * c2 + a4 * c4 + a6 * c6
        slope = even + odd + over * (guide * by_x - head * by_y)
        slope_2 = even - odd + over * (guide * by_y - head * by_x)
        odd = b1 * c1 + b3 * c3 + b5 * c5
        even = b2 * c2 + b4 * c4 + b6 * c6
        turning = even + odd + over * (guide_rate * by_x - head_rate * by_y) - drift * slope
        turning_2 = even - odd + over * (guide_rate * by_y - head_rate * by_x) - drift * slope_2
        odd = k1 * s1 + k3 * s3 + k5 * s5
        even = k2 * s2 + k4 * s4 + k6 * s6
        bend = odd + even + 6.0 * over * over * (guide * x + head * y)
        bend_2 = odd - even + 6.0 * over * over * (guide * y + head * x)
        weight = 0.5 if pair == 0 or 2 * pair == PANELS else 1.0
        tilt, moment, twist, short, spin = bent_place(weight, slope, turning, bend)
        tilt_2, moment_2, twist_2, short_2, spin_2 = bent_place(weight, slope_2, turning_2, bend_2)
        shortening = shortening + short + short_2
        rate = rate + tilt * turning + tilt_2 * turning_2
        second = second + spin - tilt * (2.0 * drift * turning + growth * slope)
        second = second + spin_2 - tilt_2 * (2.0 * drift * turning_2 + growth * slope_2)
        by_length = by_length + short - tilt * slope + short_2 - tilt_2 * slope_2
        energy = energy + 0.5 * (moment * bend + moment_2 * bend_2)
        energy_by_length = energy_by_length - 1.5 * moment * bend - twist * slope
        energy_by_length = energy_by_length - 1.5 * moment_2 * bend_2 - twist_2 * slope_2
        guide_force = guide_force + twist * by_x + twist_2 * by_y + 6.0 * over * (moment * x + moment_2 * y)
        head_force = head_force - twist * by_y - twist_2 * by_x + 6.0 * over * (moment * y + moment_2 * x)
        guide_pull = guide_pull + tilt * by_x + tilt_2 * by_y
        head_pull = head_pull - tilt * by_y - tilt_2 * by_x
        odd = twist - twist_2
        even = twist + twist_2
        both = wave * (moment + moment_2)
        less = wave * (moment - moment_2)
        f1 = f1 + odd * c1 - both * s1
        f2 = f2 + even * c2 - 2.0 * less * s2
        f3 = f3 + odd * c3 - 3.0 * both * s3
        f4 = f4 + even * c4 - 4.0 * less * s4
        f5 = f5 + odd * c5 - 5.0 * both * s5
        f6 = f6 + even * c6 - 6.0 * less * s6
        odd = tilt - tilt_2
        even = tilt + tilt_2
        g1 = g1 + odd * c1
        g2 = g2 + even * c2
        g3 = g3 + odd * c3
        g4 = g4 + even * c4
        g5 = g5 + odd * c5
        g6 = g6 + even * c6
        c1, s1 = c1 * COSINE - s1 * SINE, s1 * COSINE + c1 * SINE
    share = 1.0 / PANELS
    guide_pull = share * guide_pull + over * (SQUARE * guide + CROSS * head)
    head_pull = share * head_pull + over * (SQUARE * head + CROSS * guide)
    f1, f2, f3, f4, f5, f6, guide_force, head_force, turned_force = by_modes(
        clamped, -share, -share * guide_force, -share * head_force, f1, f2, f3, f4, f5, f6
    )
    g1, g2, g3, g4, g5, g6, guide_pull, head_pull, turned_pull = by_modes(
        clamped, share, guide_pull, head_pull, g1, g2, g3, g4, g5, g6
    )
    r1, r2, r3, r4, r5, r6, p1, p2, p3, p4, p5, p6, stretch, working, spinning, bent = slightly_bent(
        wave, q1, q2, q3, q4, q5, q6, v1, v2, v3, v4, v5, v6, guide, head, guide_rate, head_rate
    )
    return (
        r1 + f1,
        r2 + f2,
        r3 + f3,
        r4 + f4,
        r5 + f5,
        r6 + f6,
        p1 + g1,
        p2 + g2,
        p3 + g3,
        p4 + g4,
        p5 + g5,
        p6 + g6,
        stretch + length * share * shortening,
        working - drift * stretch + share * (length * rate + velocity * shortening),
        spinning
        - 2.0 * drift * working
        + (2.0 * drift * drift - growth) * stretch
        + share * (length * second + 2.0 * velocity * rate + acceleration * shortening)
        + guide_pull * guide_second
        + head_pull * head_second,
        share * by_length - over * stretch + guide_pull * guide_by_length + head_pull * head_by_length,
        bent + length * share * energy,
        share * energy_by_length
        - 3.0 * over * bent
        - guide_force * guide_by_length
        - head_force * head_by_length,
        turned_force,
        turned_pull,
    )


def slightly_bent(
    wave: float,
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
    guide: float,
    head: float,
    guide_rate: float,
    head_rate: float,
) -> tuple[
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
    float,
]:
    """Bending by the modes and shortening to the second order of the slope, and rates while L stays.

    Args:
        wave: pi / L [1/m]
        q1 .. head_rate: as for `bent_belt`

    Returns:
        1 to 12: as of `bent_belt`, but for what the end shapes add to the shortening
        13 to 15: shortening [m], its rate [m/s], its second rate without those of the modes' rates [m/s2]
        16: bending energy over the stiffness [1/m]
    """
    n1, n2, n3, n4, n5, n6 = numbered(wave, q1, q2, q3, q4, q5, q6)
    p1, p2, p3, p4, p5, p6 = numbered(0.5 * pi, n1, n2, n3, n4, n5, n6)
    r1, r2, r3, r4, r5, r6 = numbered(-wave, p1, p2, p3, p4, p5, p6)
    r1, r2, r3, r4, r5, r6 = numbered(wave, r1, r2, r3, r4, r5, r6)
    w1, w2, w3, w4, w5, w6 = numbered(pi, v1, v2, v3, v4, v5, v6)
    stretch, working, spinning = end_shortening(wave / pi, guide, head, guide_rate, head_rate)
    return (
        r1,
        r2,
        r3,
        r4,
        r5,
        r6,
        p1,
        p2,
        p3,
        p4,
        p5,
        p6,
        stretch + 0.5 * dot(p1, p2, p3, p4, p5, p6, q1, q2, q3, q4, q5, q6),
        working + dot(p1, p2, p3, p4, p5, p6, v1, v2, v3, v4, v5, v6),
        spinning + 0.5 * wave / pi * dot(w1, w2, w3, w4, w5, w6, w1, w2, w3, w4, w5, w6),
        -0.5 * dot(r1, r2, r3, r4, r5, r6, q1, q2, q3, q4, q5, q6),
    )


def bent_place(
    weight: float, slope: float, turning: float, bend: float
) -> tuple[float, float, float, float, float]:
    """What a place of the belt adds to bending and shortening beyond the second order of its slope s.

    Args:
        weight: factor
        slope, turning, bend: s [1], its rate [1/s], `u_XX` [1/m]

    Returns:
        rate of the shortening by s, that of half the square of the curvature by `u_XX` and by s, the
        shortening, and its second rate by the square of the rate of s

    >>> [round(1e6 * each, 3) for each in bent_place(1.0, 0.1, 1.0, 1.0)]
    [503.782, 10101.01, 102030.405, 12.563, 15189.712]
    """
    square = 1.0 - slope * slope
    if square < LEAST_SQUARE:
        square = LEAST_SQUARE
    cosine = sqrt(square)
    inverse = 1.0 / cosine
    steep = inverse * inverse
    share = slope * slope / (1.0 + cosine)
    tilt = weight * share * inverse
    moment = weight * bend * steep
    return (
        tilt * slope,
        moment * slope * slope,
        moment * bend * slope * steep,
        0.5 * weight * share * share,
        tilt * turning * turning * (1.0 + cosine + square) * steep,
    )


def numbered(
    share: float, a1: float, a2: float, a3: float, a4: float, a5: float, a6: float
) -> tuple[float, float, float, float, float, float]:
    """Modes times a factor and their numbers.

    >>> numbered(1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0)
    (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    """
    return (
        share * a1,
        2.0 * share * a2,
        3.0 * share * a3,
        4.0 * share * a4,
        5.0 * share * a5,
        6.0 * share * a6,
    )


def by_modes(
    clamped: int,
    share: float,
    guide: float,
    head: float,
    f1: float,
    f2: float,
    f3: float,
    f4: float,
    f5: float,
    f6: float,
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Rates by the modes and by the end shapes of what has known rates by the parts of the slope.

    Args:
        clamped: which ends are clamped, whose end shapes follow the modes
        share: factor of f1 to f6
        guide, head: rates by `3 x^2 - 1` and by `1 - 3 y^2`
        f1 .. f6: rates by `cos(n pi x)`

    Returns:
        rates by q1 to q6, by the end shapes at guide and head, by the slope at a clamped guide times L

    >>> [round(each, 12) for each in by_modes(0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)][5:]
    [0.0, 1.215854203708, 1.215854203708, 0.0]
    """
    odd = 12.0 / (pi * pi) * (f1 + f3 / 9.0 + f5 / 25.0)
    even = 12.0 / (pi * pi) * (f2 / 4.0 + f4 / 16.0 + f6 / 36.0)
    guide = guide + share * (odd - even)
    head = head + share * (odd + even)
    by_guide, by_head = turned_by(clamped, guide, head)
    m1, m2, m3, m4, m5, m6 = moment_forces(-by_guide, -by_head)
    scale = share * pi
    return (
        m1 + scale * f1,
        m2 + 2.0 * scale * f2,
        m3 + 3.0 * scale * f3,
        m4 + 4.0 * scale * f4,
        m5 + 5.0 * scale * f5,
        m6 + 6.0 * scale * f6,
        guide,
        head,
        by_guide,
    )


def end_shortening(
    over: float, guide: float, head: float, guide_rate: float, head_rate: float
) -> tuple[float, float, float]:
    """Shortening by the end shapes to the second order, and its rates while L and their own rates stay.

    Args:
        over: 1 / L [1/m]
        guide, head, guide_rate, head_rate: amplitudes and their rates [m, m/s]

    Returns:
        shortening [m], rate [m/s], second rate [m/s2]
    """
    by_guide = over * (SQUARE * guide + CROSS * head)
    by_head = over * (SQUARE * head + CROSS * guide)
    second = SQUARE * (guide_rate * guide_rate + head_rate * head_rate) + 2.0 * CROSS * guide_rate * head_rate
    return (
        0.5 * (by_guide * guide + by_head * head),
        by_guide * guide_rate + by_head * head_rate,
        over * second,
    )
