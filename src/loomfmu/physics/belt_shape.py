"""Shape of a belt that is given by its modes and end shapes: its largest deflection, slope and curvature."""

from math import cos, fabs, pi, sin, sqrt

from .belt_bending import LEAST_SQUARE
from .belt_modes import dot, harmonics


def shape_at(x: float, a: list[float], end: float, head: float) -> tuple[float, float, float]:
    """Sum of modes and of `end (x^3 - x) + head (y^3 - y)`, y = 1 - x, at x, and its derivatives by x.

    >>> [round(each, 12) for each in shape_at(0.5, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0, 0.0)]
    [1.0, 0.0, -9.869604401089]
    """
    a1, a2, a3, a4, a5, a6 = a
    c1 = cos(pi * x)
    s1 = sin(pi * x)
    c2, c3, c4, c5, c6, s2, s3, s4, s5, s6 = harmonics(c1, s1)
    first = a1 * c1 + 2.0 * a2 * c2 + 3.0 * a3 * c3 + 4.0 * a4 * c4 + 5.0 * a5 * c5 + 6.0 * a6 * c6
    second = a1 * s1 + 4.0 * a2 * s2 + 9.0 * a3 * s3 + 16.0 * a4 * s4 + 25.0 * a5 * s5 + 36.0 * a6 * s6
    y = 1.0 - x
    return (
        dot(a, [s1, s2, s3, s4, s5, s6]) + end * x * (x * x - 1.0) + head * y * (y * y - 1.0),
        pi * first + end * (3.0 * x * x - 1.0) - head * (3.0 * y * y - 1.0),
        6.0 * end * x - pi * pi * second + 6.0 * head * y,
    )


def shape_extremes(
    length: float, a: list[float], end: float, head: float
) -> tuple[float, float, float, float]:
    """Place where the belt is farthest [1], how far [m], sine of its largest slope, curvature [1/m].

    The place is found to rounding; slope and curvature are the largest of 25 places.

    >>> [round(each, 12) for each in shape_extremes(1.0, [0.0, 0.1, 0.0, 0.0, 0.0, 0.0], 0.0, 0.0)][:3]
    [0.25, 0.1, 0.628318530718]
    """
    place = 0.5
    farthest = 0.0
    steepest = 0.0
    most_bent = 0.0
    for panel in range(25):
        x = panel / 24.0
        value, first, second = shape_at(x, a, end, head)
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
        _value, first, second = shape_at(x, a, end, head)
        if first * second != 0.0 and fabs(first) < fabs(second) / 24.0:
            x = x - first / second
    value, _first, _second = shape_at(x, a, end, head)
    if 0.0 <= x <= 1.0 and fabs(value) > fabs(farthest):
        farthest = value
        place = x
    return place, farthest, steepest, most_bent
