"""Shape of a belt that is given by its modes: bending, shortening, largest deflection.

Bending and shortening of an inextensible belt are summed over equal panels: exactly up to the second order,
up to the fourth for the first three modes.
"""

from math import cos, fabs, pi, sin, sqrt

from .belt_modes import dot, harmonics

PANELS = 8  # of the belt, between the places where its bending is summed: exact for products up to the 15th
COSINE = cos(pi / 8.0)
SINE = sin(pi / 8.0)
LEAST_SQUARE = 0.05  # of the cosine of the slope: beyond 77 degrees the belt counts as folded


def bent_belt(
    q1: float, q2: float, q3: float, q4: float, q5: float, q6: float,
    v1: float, v2: float, v3: float, v4: float, v5: float, v6: float,
    length: float, velocity: float, acceleration: float,
) -> tuple[
    float, float, float, float, float, float, float, float, float, float, float, float,
    float, float, float, float, float, float,
]:  # fmt: skip
    """Bending and shortening of an inextensible belt with the sine of its slope `u_X`, summed over places.

    With s = u_X and c = sqrt(1 - s^2): curvature u_XX / c, shortening 1 - c.

    Args:
        q1 .. q6: modes [m]
        v1 .. v6: their rates [m/s]
        length, velocity, acceleration: L and its rates [m, m/s, m/s2]

    Returns:
        1 to 6: bending moment on each mode over the stiffness, negative rate of the energy by q_n [1/m2]
        7 to 12: rate of the shortening by q_n [1]
        13 to 15: shortening [m], its rate [m/s], its second rate without that by q_n'' [m/s2]
        16: rate of the shortening by L [1]
        17, 18: bending energy over the stiffness [1/m], its rate by L [1/m2]
    """
    over = 1.0 / length
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
    shortening = 0.0
    rate = 0.0
    second = 0.0
    by_length = 0.0
    energy = 0.0
    energy_by_length = 0.0
    for place in range(PANELS + 1):
        c2, c3, c4, c5, c6, s2, s3, s4, s5, s6 = harmonics(c1, s1)
        slope = (
            pi
            * over
            * (q1 * c1 + 2.0 * q2 * c2 + 3.0 * q3 * c3 + 4.0 * q4 * c4 + 5.0 * q5 * c5 + 6.0 * q6 * c6)
        )
        turning = (
            pi
            * over
            * (v1 * c1 + 2.0 * v2 * c2 + 3.0 * v3 * c3 + 4.0 * v4 * c4 + 5.0 * v5 * c5 + 6.0 * v6 * c6)
            - velocity * over * slope
        )
        bend = (
            -pi
            * pi
            * over
            * over
            * (q1 * s1 + 4.0 * q2 * s2 + 9.0 * q3 * s3 + 16.0 * q4 * s4 + 25.0 * q5 * s5 + 36.0 * q6 * s6)
        )
        weight = 0.5 if place == 0 or place == PANELS else 1.0
        square = 1.0 - slope * slope
        if square < LEAST_SQUARE:
            square = LEAST_SQUARE
        cosine = sqrt(square)
        tilt = weight * slope / cosine
        curvature = bend / cosine
        moment = weight * curvature / cosine
        twist = moment * curvature * slope / cosine
        short = weight * slope * slope / (1.0 + cosine)
        shortening = shortening + short
        rate = rate + tilt * turning
        second = (
            second
            + weight * turning * turning / (square * cosine)
            - tilt * (2.0 * velocity * turning + acceleration * slope) * over
        )
        by_length = by_length + short - tilt * slope
        energy = energy + 0.5 * weight * curvature * curvature
        energy_by_length = energy_by_length - weight * curvature * curvature * (1.5 + slope * slope / square)
        f1 = f1 + twist * c1 - pi * over * moment * s1
        g1 = g1 + tilt * c1
        f2 = f2 + twist * c2 - 2.0 * pi * over * moment * s2
        g2 = g2 + tilt * c2
        f3 = f3 + twist * c3 - 3.0 * pi * over * moment * s3
        g3 = g3 + tilt * c3
        f4 = f4 + twist * c4 - 4.0 * pi * over * moment * s4
        g4 = g4 + tilt * c4
        f5 = f5 + twist * c5 - 5.0 * pi * over * moment * s5
        g5 = g5 + tilt * c5
        f6 = f6 + twist * c6 - 6.0 * pi * over * moment * s6
        g6 = g6 + tilt * c6
        c1, s1 = c1 * COSINE - s1 * SINE, s1 * COSINE + c1 * SINE
    share = 1.0 / PANELS
    force = -pi * share
    pull = pi * share
    return (
        force * f1, 2.0 * force * f2, 3.0 * force * f3, 4.0 * force * f4, 5.0 * force * f5, 6.0 * force * f6,
        pull * g1, 2.0 * pull * g2, 3.0 * pull * g3, 4.0 * pull * g4, 5.0 * pull * g5, 6.0 * pull * g6,
        length * share * shortening,
        share * (length * rate + velocity * shortening),
        share * (length * second + 2.0 * velocity * rate + acceleration * shortening),
        share * by_length, length * share * energy, share * energy_by_length,
    )  # fmt: skip


def shape_at(
    x: float, a1: float, a2: float, a3: float, a4: float, a5: float, a6: float, end: float, head: float
) -> tuple[float, float, float]:
    """Sum of modes and of `end (x^3 - x) + head (y^3 - y)`, y = 1 - x, at x, and its derivatives by x.

    >>> [round(each, 12) for each in shape_at(0.5, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)]
    [1.0, 0.0, -9.869604401089]
    """
    c1 = cos(pi * x)
    s1 = sin(pi * x)
    c2, c3, c4, c5, c6, s2, s3, s4, s5, s6 = harmonics(c1, s1)
    first = a1 * c1 + 2.0 * a2 * c2 + 3.0 * a3 * c3 + 4.0 * a4 * c4 + 5.0 * a5 * c5 + 6.0 * a6 * c6
    second = a1 * s1 + 4.0 * a2 * s2 + 9.0 * a3 * s3 + 16.0 * a4 * s4 + 25.0 * a5 * s5 + 36.0 * a6 * s6
    y = 1.0 - x
    return (
        dot(a1, a2, a3, a4, a5, a6, s1, s2, s3, s4, s5, s6) + end * x * (x * x - 1.0)
        + head * y * (y * y - 1.0),
        pi * first + end * (3.0 * x * x - 1.0) - head * (3.0 * y * y - 1.0),
        6.0 * end * x - pi * pi * second + 6.0 * head * y,
    )  # fmt: skip


def shape_extremes(
    length: float, a1: float, a2: float, a3: float, a4: float, a5: float, a6: float, end: float, head: float
) -> tuple[float, float, float, float]:
    """Where the belt is farthest from its line, how far, how steep it is and how much it is bent at most.

    The place is found to rounding; slope and curvature are the largest of 25 places.

    Returns:
        x [1], deflection there, signed [m], sine of the slope [1], curvature [1/m]

    >>> [round(each, 12) for each in shape_extremes(1.0, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)][:3]
    [0.25, 0.1, 0.628318530718]
    """
    place = 0.5
    farthest = 0.0
    steepest = 0.0
    most_bent = 0.0
    for panel in range(25):
        x = panel / 24.0
        value, first, second = shape_at(x, a1, a2, a3, a4, a5, a6, end, head)
        if fabs(value) > fabs(farthest):
            farthest = value
            place = x
        slope = fabs(first) / length
        if slope > steepest:
            steepest = slope
        square = 1.0 - slope * slope
        if square < LEAST_SQUARE:
            square = LEAST_SQUARE
        bend = fabs(second) / (length * length * sqrt(square))
        if bend > most_bent:
            most_bent = bend
    x = place
    for _ in range(6):
        _value, first, second = shape_at(x, a1, a2, a3, a4, a5, a6, end, head)
        if first * second != 0.0 and fabs(first) < fabs(second) / 24.0:
            x = x - first / second
    value, _first, _second = shape_at(x, a1, a2, a3, a4, a5, a6, end, head)
    if 0.0 <= x <= 1.0 and fabs(value) > fabs(farthest):
        farthest = value
        place = x
    return place, farthest, steepest, most_bent


def shortening(length: float, a1: float, a2: float, a3: float, a4: float, a5: float, a6: float) -> float:
    """Length of the belt less that of its projection on its line [m].

    >>> round(shortening(1.0, 0.01, 0.0, 0.0, 0.0, 0.0, 0.0) / (0.000025 * 3.141592653589793**2), 4)
    1.0002
    """
    sum_ = 0.0
    for panel in range(PANELS + 1):
        _value, first, _second = shape_at(panel / PANELS, a1, a2, a3, a4, a5, a6, 0.0, 0.0)
        square = first * first / (length * length)
        rest = 1.0 - square
        if rest < LEAST_SQUARE:
            rest = LEAST_SQUARE
        weight = 0.5 if panel == 0 or panel == PANELS else 1.0
        sum_ = sum_ + weight * square / (1.0 + sqrt(rest))
    return length * sum_ / PANELS
