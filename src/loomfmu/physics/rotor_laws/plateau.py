"""Rotor law with a plateau: constant low speed about the slow point, a ramp, constant high speed.

No published law: an inference from the dwells that Korolev measured (thesis on rotary dobbies, Moscow, Table
3.1). They are longer than those of the laws of his section 3.1, whose speed is lowest at one point only.
"""

from math import cos, pi, sin

PLATEAU = 9


def rise(reduction: float, plateau: float, ramp: float) -> float:
    """Difference of the highest and the lowest speed, `D = pi z / (pi - p - r/2)`: the law closes.

    Arguments as for `plateau_law`.

    >>> round(rise(0.7, 0.25 * pi, 5 * pi / 22), 12)  # from 0.3 to the source's 1.4
    1.1
    """
    return pi * reduction / (pi - plateau - 0.5 * ramp)


def plateau_law(x: float, reduction: float, plateau: float, ramp: float) -> tuple[float, float, float]:
    """S [rad], S' and S'' [1] over one turn of the rotor, `0 <= x <= 2 pi`, with `S(2 pi - x) = 2 pi - S(x)`.

    With z = reduction, p = plateau, r = ramp, D from `rise` and u = (x - p) / r, for half a turn:

        S' = 1 - z                                     0 <= x <= p
        S' = 1 - z + D (u - sin(2 pi u) / (2 pi))      p <= x <= p + r
        S' = 1 - z + D                                 p + r <= x <= pi

    The ramp is a cycloid, so acceleration and jerk are continuous.

    Args:
        x: shaft angle from the slow point [rad]
        reduction: relative speed reduction on the plateau, 0 to 1 [1]
        plateau: shaft angle from the slow point to the end of the plateau, not negative [rad]
        ramp: shaft angle of the ramp, positive; `plateau + ramp <= pi` [rad]

    >>> [round(value, 12) for value in plateau_law(0.5, 0.7, 0.5, 1.0)]
    [0.15, 0.3, 0.0]
    """
    if x > pi:
        angle, first, second = plateau_law_half(2.0 * pi - x, reduction, plateau, ramp)
        return 2.0 * pi - angle, first, -second
    return plateau_law_half(x, reduction, plateau, ramp)


def plateau_law_half(x: float, reduction: float, plateau: float, ramp: float) -> tuple[float, float, float]:
    """As `plateau_law`, for `0 <= x <= pi`.

    >>> round(plateau_law_half(pi, 0.7, 0.5, 1.0)[0] - pi, 12)
    0.0
    """
    slow = 1.0 - reduction
    if x <= plateau:
        return slow * x, slow, 0.0
    gain = rise(reduction, plateau, ramp)
    if x >= plateau + ramp:
        return slow * x + gain * (x - plateau - 0.5 * ramp), slow + gain, 0.0
    u = (x - plateau) / ramp
    wave = sin(pi * u) / pi
    return (
        slow * x + 0.5 * gain * ramp * (u * u - wave * wave),
        slow + gain * (u - wave * cos(pi * u)),
        2.0 * gain / ramp * sin(pi * u) * sin(pi * u),
    )


def plateau_peaks(reduction: float, plateau: float, ramp: float) -> tuple[float, float, float]:
    """Largest speed `1 - z + D`, acceleration `2 D / r` and jerk `2 pi D / r^2` of the law [1].

    Arguments as for `plateau_law`.

    >>> [round(rate, 3) for rate in plateau_peaks(0.7, 0.25 * pi, 5 * pi / 22)]
    [1.4, 3.081, 13.557]
    """
    gain = rise(reduction, plateau, ramp)
    return 1.0 - reduction + gain, 2.0 * gain / ramp, 2.0 * pi * gain / (ramp * ramp)
