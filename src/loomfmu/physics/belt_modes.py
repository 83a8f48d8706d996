"""Modes of a belt of growing length: what they integrate to, and the moment of its bow on them.

With x from 0 at the head to 1 at the guide the deflection is the sum of `q_n sin(n pi x)`, n = 1 to 6: modes
are lists of six numbers. The sums below are exact. What the belt is at its ends, where a sine is straight,
`belt_ends` has.
"""

from dataclasses import dataclass
from math import cos, fabs, pi, sin


@dataclass(frozen=True)
class Bow:
    """Bow of the belt itself (1) or of the span (2): its height and half a wave [m, m]."""

    of: int
    height: float
    half_wave: float


def carried_along(a: list[float]) -> list[float]:
    """Modes of `x a'(x)`, half of them: the sum over n of `a_n n pi int x sin(m pi x) cos(n pi x) dx`.

    Its terms are `-(-1)^(m + n) m n / (m^2 - n^2)`, and -1/4 for m = n.

    >>> carried_along([0.0, 3.0, 0.0, 0.0, 0.0, 0.0])[:2]
    [-2.0, -0.75]
    """
    a1, a2, a3, a4, a5, a6 = a
    return [
        -a1 / 4.0 - a2 * 2.0 / 3.0 + a3 * 3.0 / 8.0 - a4 * 4.0 / 15.0 + a5 * 5.0 / 24.0 - a6 * 6.0 / 35.0,
        a1 * 2.0 / 3.0 - a2 / 4.0 - a3 * 6.0 / 5.0 + a4 * 2.0 / 3.0 - a5 * 10.0 / 21.0 + a6 * 3.0 / 8.0,
        -a1 * 3.0 / 8.0 + a2 * 6.0 / 5.0 - a3 / 4.0 - a4 * 12.0 / 7.0 + a5 * 15.0 / 16.0 - a6 * 2.0 / 3.0,
        a1 * 4.0 / 15.0 - a2 * 2.0 / 3.0 + a3 * 12.0 / 7.0 - a4 / 4.0 - a5 * 20.0 / 9.0 + a6 * 6.0 / 5.0,
        -a1 * 5.0 / 24.0
        + a2 * 10.0 / 21.0
        - a3 * 15.0 / 16.0
        + a4 * 20.0 / 9.0
        - a5 / 4.0
        - a6 * 30.0 / 11.0,
        a1 * 6.0 / 35.0 - a2 * 3.0 / 8.0 + a3 * 2.0 / 3.0 - a4 * 6.0 / 5.0 + a5 * 30.0 / 11.0 - a6 / 4.0,
    ]


def weighed(first: float, even: float, square: float, a: list[float]) -> list[float]:
    """Sum over n of `a_n m n pi^2 int g cos(m pi x) cos(n pi x) dx` for a weight g = x or x^2.

    Its terms are `(-1)^(m + n) 2 m n (m^2 + n^2) / (m^2 - n^2)^2`; for x those of even m + n are absent.

    Args:
        first: constant of the diagonal: 0 for x, 1/4 for x^2
        even: share of the terms with even m + n: 0 for x, 1 for x^2
        square: share of `m^2` in the diagonal: pi^2/4 for x, pi^2/6 for x^2

    >>> weighed(0.25, 1.0, 0.0, [0.0, 9.0, 0.0, 0.0, 0.0, 0.0])[:2]
    [-20.0, 2.25]
    """
    a1, a2, a3, a4, a5, a6 = a
    return [
        a1 * (first + square)
        - a2 * 20.0 / 9.0
        + even * (a3 * 15.0 / 16.0 + a5 * 65.0 / 144.0)
        - a4 * 136.0 / 225.0
        - a6 * 444.0 / 1225.0,
        a2 * (first + 4.0 * square)
        - a1 * 20.0 / 9.0
        - a3 * 156.0 / 25.0
        - a5 * 580.0 / 441.0
        + even * (a4 * 20.0 / 9.0 + a6 * 15.0 / 16.0),
        a3 * (first + 9.0 * square)
        - a2 * 156.0 / 25.0
        - a4 * 600.0 / 49.0
        - a6 * 20.0 / 9.0
        + even * (a1 * 15.0 / 16.0 + a5 * 255.0 / 64.0),
        a4 * (first + 16.0 * square)
        - a1 * 136.0 / 225.0
        - a3 * 600.0 / 49.0
        - a5 * 1640.0 / 81.0
        + even * (a2 * 20.0 / 9.0 + a6 * 156.0 / 25.0),
        a5 * (first + 25.0 * square)
        - a2 * 580.0 / 441.0
        - a4 * 1640.0 / 81.0
        - a6 * 3660.0 / 121.0
        + even * (a1 * 65.0 / 144.0 + a3 * 255.0 / 64.0),
        a6 * (first + 36.0 * square)
        - a1 * 444.0 / 1225.0
        - a3 * 20.0 / 9.0
        - a5 * 3660.0 / 121.0
        + even * (a2 * 15.0 / 16.0 + a4 * 156.0 / 25.0),
    ]


def dot(a: list[float], b: list[float]) -> float:
    """Sum of the products of two sets of modes.

    >>> dot([1.0, 2.0, 3.0, 4.0, 5.0, 6.0], [1.0] * 6)
    21.0
    """
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5]


def summed(by_a: float, a: list[float], b: list[float]) -> list[float]:
    """`by_a` times modes a, and modes b.

    >>> summed(-1.0, [1.0] * 6, [1.0, 1.0, 2.0, 3.0, 4.0, 5.0])
    [0.0, 0.0, 1.0, 2.0, 3.0, 4.0]
    """
    return [b[n] + by_a * a[n] for n in range(6)]


def size(a: list[float]) -> float:
    """Sum of the sizes of all modes.

    >>> size([1.0, -2.0, 3.0, -4.0, 5.0, -6.0])
    21.0
    """
    return fabs(a[0]) + fabs(a[1]) + fabs(a[2]) + fabs(a[3]) + fabs(a[4]) + fabs(a[5])


def first_modes(number: int, a: list[float]) -> list[float]:
    """The first modes up to a number, 0 for the others.

    >>> first_modes(2, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    [1.0, 2.0, 0.0, 0.0, 0.0, 0.0]
    """
    return [a[n] if n < number else 0.0 for n in range(6)]


def harmonics(
    c1: float, s1: float
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """Cosine and sine of 2 to 6 times an angle, from its own: cosines first.

    >>> [round(each, 12) for each in harmonics(0.0, 1.0)][:5]
    [-1.0, -0.0, 1.0, 0.0, -1.0]
    """
    c2 = c1 * c1 - s1 * s1
    s2 = 2.0 * c1 * s1
    c3 = c2 * c1 - s2 * s1
    s3 = s2 * c1 + c2 * s1
    c4 = c2 * c2 - s2 * s2
    s4 = 2.0 * c2 * s2
    return (c2, c3, c4, c3 * c2 - s3 * s2, c3 * c3 - s3 * s3, s2, s3, s4, s3 * c2 + c3 * s2, 2.0 * c3 * s3)


def weight_forces(weight: float) -> list[float]:
    """Force of a weight along the belt on all modes, over the free length: `weight int sin(n pi x) dx`.

    >>> [round(pi * each, 12) for each in weight_forces(1.0)]
    [2.0, 0.0, 0.666666666667, 0.0, 0.4, 0.0]
    """
    share = 2.0 * weight / pi
    return [share, 0.0, share / 3.0, 0.0, share / 5.0, 0.0]


def bow_mode(number: int, bow: Bow, length: float, cosine: float, sine: float) -> tuple[float, float, float]:
    """Moment of the belt's own bow on a mode, over its stiffness [1/m2], and two rates by the free length.

    `int bow'' (sin(n pi X / L))'' dX` for a belt that is crooked as `height sin(pi X / half_wave)` from the
    head on, and takes its bow along.

    Args:
        length: L of the free part [m]
        cosine, sine: of `pi L / half_wave`

    >>> from math import pi
    >>> round(bow_mode(1, Bow(1, 1.0, 1.0), 1.0, -1.0, 0.0)[0] - pi**4 / 2, 12)
    0.0
    """
    angle = number * pi
    wave = pi / bow.half_wave
    turned = wave * length
    beyond = turned - angle
    sign = 1.0 if number % 2 == 0 else -1.0
    if fabs(beyond) < 0.01:
        square = beyond * beyond
        sinc = 1.0 - square / 6.0 * (1.0 - square / 20.0)
        slope = -beyond / 3.0 * (1.0 - square / 10.0 * (1.0 - square / 28.0))
        curve = -1.0 / 3.0 + square / 10.0 * (1.0 - square * 5.0 / 84.0)
    else:
        sinc = sign * sine / beyond
        slope = (sign * cosine - sinc) / beyond
        curve = -sinc - 2.0 * slope / beyond
    share = angle / (turned + angle)
    part = share * sinc
    by_turn = share * slope - part / (turned + angle)
    twice = share * curve - 2.0 * by_turn / (turned + angle)
    scale = bow.height * wave * wave * angle * angle / length
    return (
        scale * part,
        scale * (wave * by_turn - part / length),
        scale * (wave * wave * twice + 2.0 / length * (part / length - wave * by_turn)),
    )


def bow_forces(bow: Bow, length: float) -> tuple[list[float], list[float]]:
    """Moments of the bow on all modes, and their rates by the free length; see `bow_mode`.

    A bow of the span (2), `height sin(pi x / L)`, has one on the first mode alone.

    >>> [[round(each[n] / pi**4, 12) for n in (0, 1)] for each in bow_forces(Bow(2, 1.0, 1.0), 1.0)]
    [[0.5, 0.0], [-1.5, 0.0]]
    """
    moments = [0.0] * 6
    rates = [0.0] * 6
    if bow.of != 1:
        square = pi * pi / length
        moments[0] = 0.5 * bow.height * square * square / length
        rates[0] = -3.0 * moments[0] / length
        return moments, rates
    cosine = cos(pi * length / bow.half_wave)
    sine = sin(pi * length / bow.half_wave)
    for n in range(6):
        moments[n], rates[n], _second = bow_mode(n + 1, bow, length, cosine, sine)
    return moments, rates
