"""Heald frame: motion from the rotor's angle, and the pattern of raised frames.

Source: Korolev, thesis on rotary dobbies (Moscow), sections 2.5, 3.1 and 3.6. S is the `angle` of
the rotor [rad].
"""

from math import cos, floor, pi, sin


def lift_fraction(angle: float, velocity: float, acceleration: float) -> tuple[float, float, float]:
    """Share of the stroke of a frame that changes at every pick [1], `(1 - cos(S/2)) / 2`, and its two rates.

    The frame's crank makes half a turn per turn of the rotor, section 3.1. Computed as `sin(S/4)^2`, so that
    nothing cancels near the rest position.

    >>> lift_fraction(0.0, 10.0, 0.0)
    (0.0, 0.0, 12.5)
    """
    sine = sin(0.5 * angle)
    cosine = cos(0.5 * angle)
    quarter = sin(0.25 * angle)
    return (
        quarter * quarter,
        0.25 * sine * velocity,
        0.125 * cosine * velocity * velocity + 0.25 * sine * acceleration,
    )


def crank_slope(angle: float) -> float:
    """Slope of `lift_fraction` by the rotor's angle [1/rad], `sin(S/2) / 4`: turns a force into a torque.

    >>> crank_slope(pi), crank_slope(0.0)
    (0.25, 0.0)
    """
    return 0.25 * sin(0.5 * angle)


def slow_points_passed(angle: float) -> int:
    """Number of slow points that the rotor has passed: whole turns of its angle.

    >>> slow_points_passed(-0.1), slow_points_passed(0.0), slow_points_passed(7.0)
    (-1, 0, 1)
    """
    return floor(angle / (2.0 * pi))


def peg(word: int, pick: int) -> int:
    """Bit of a pattern word of 16 picks for a pick: 1 for a raised frame.

    >>> [peg(0b0110, pick) for pick in range(4)]
    [0, 1, 1, 0]
    """
    return (word >> pick) & 1
