"""Rotor laws of two drives without a modulator cam: eccentric slotted levers and non-circular gears.

Source: Korolev, thesis on rotary dobbies (Moscow), section 1, equations (1.12) to (1.15). Both laws are
symmetric about the slow point, `S(-x) = -S(x)`, and grow by `2 pi` in a turn.
"""

from math import asin, atan2, cos, fabs, sin, sqrt

SLOTTED_LEVERS = 5
NONCIRCULAR_GEARS = 6


def slotted_lever(x: float, radius: float, eccentricity: float) -> tuple[float, float, float, float]:
    """Angle of a slotted lever about its own axis [rad], its pin turning evenly about another, from (1.12).

    Returned with its first, second and third derivative.

    With q = radius, e = eccentricity and the slow point at x = 0:

        G = x - atan2(e sin x, q + e cos x)

    the angle about the eccentric of a pin at the radius q about the shaft, both measured from the side away
    from the eccentric. With `1 + cos x = 2 cos(x/2)^2` nothing cancels where the pin comes close to it.

    Args:
        x: angle of the pin about its axis, from the slow point [rad]
        radius: of the pin [m]
        eccentricity: distance of the two axes, 0 to less than radius [m]

    >>> slotted_lever(0.0, 3.0, 1.0)[:2]
    (0.0, 0.75)
    """
    sine = sin(x)
    cosine = cos(x)
    cross = radius * eccentricity
    apart = radius - eccentricity
    half = cos(0.5 * x)
    reach = apart + 2.0 * eccentricity * half * half
    square = apart * apart + 4.0 * cross * half * half
    gain = apart * (radius + eccentricity) * cross / (square * square)
    return (
        x - atan2(eccentricity * sine, reach),
        radius * reach / square,
        gain * sine,
        gain * (cosine + 4.0 * cross * sine * sine / square),
    )


def slotted_levers(
    x: float, lever_radius: float, driven_radius: float, eccentricity: float
) -> tuple[float, float, float, float]:
    """Rotor angle of the drive with eccentric slotted levers, from (1.12): S [rad], S', S'', S''' [1].

    The source gives only the speed, with the slow point at alpha = pi. Its integral, with
    F(x; q, e) = x + atan2(e sin x, q - e cos x) and r, b, e the three arguments:

        S(x) = F(F(x + pi; r, e); b, e) - pi

    which is `slotted_lever` applied twice. Erratum: (1.12) prints the arc tangent of a ratio, which stays
    within a quarter turn to either side; the angle goes all the way round.

    Args:
        x: shaft angle from the slow point [rad]
        lever_radius: r, of the pin on the driving pulley about the shaft [m]
        driven_radius: b, of the pin on the lever about the eccentric [m]
        eccentricity: e, of the eccentric from the shaft, 0 to less than both radii [m]

    >>> [round(value, 6) for value in slotted_levers(0.0, 0.1, 0.1, 0.025)[:2]]
    [0.0, 0.64]
    """
    turn, g1, g2, g3 = slotted_lever(x, lever_radius, eccentricity)
    angle, h1, h2, h3 = slotted_lever(turn, driven_radius, eccentricity)
    return (angle, h1 * g1, h2 * g1 * g1 + h1 * g2, h3 * g1 * g1 * g1 + 3.0 * h2 * g1 * g2 + h1 * g3)


def slotted_levers_place(
    angle: float, lever_radius: float, driven_radius: float, eccentricity: float
) -> float:
    """Shaft angle [rad] at which the rotor of `slotted_levers` has a given angle [rad].

    By the law of sines each lever gives `x = G + asin((e/q) sin G)`.

    >>> round(slotted_levers_place(slotted_levers(1.0, 0.1, 0.12, 0.04)[0], 0.1, 0.12, 0.04), 12)
    1.0
    """
    turn = angle + asin(eccentricity / driven_radius * sin(angle))
    return turn + asin(eccentricity / lever_radius * sin(turn))


def noncircular_gears(
    x: float, a1: float, a2: float, a3: float, a4: float
) -> tuple[float, float, float, float]:
    """Rotor angle of a round and a non-circular gear, equations (1.13) to (1.15): S [rad], S', S'', S''' [1].

        S = x + sum over k = 1..4 of (a_k / k) sin k x

    with a_0 = 1, so that the rotor makes one turn per turn of the shaft. Erratum: (1.14) prints a factor 1/k
    in the speed; it is not the derivative of (1.13), and (1.15) is not its derivative.

    Args:
        x: shaft angle from the slow point [rad]
        a1, a2, a3, a4: relative amplitudes of the first four harmonics of the speed [1]

    >>> noncircular_gears(0.0, -0.25, -0.125, -0.0625, -0.0625)[:2]
    (0.0, 0.5)
    """
    s1 = sin(x)
    s2 = sin(2.0 * x)
    s3 = sin(3.0 * x)
    s4 = sin(4.0 * x)
    c1 = cos(x)
    c2 = cos(2.0 * x)
    c3 = cos(3.0 * x)
    c4 = cos(4.0 * x)
    return (
        x + (a1 * s1 + 0.5 * a2 * s2 + a3 * s3 / 3.0 + 0.25 * a4 * s4),
        1.0 + (a1 * c1 + a2 * c2 + a3 * c3 + a4 * c4),
        -(a1 * s1 + 2.0 * a2 * s2 + 3.0 * a3 * s3 + 4.0 * a4 * s4),
        -(a1 * c1 + 4.0 * a2 * c2 + 9.0 * a3 * c3 + 16.0 * a4 * c4),
    )


def gear_speed_extremes(a1: float, a2: float, a3: float, a4: float) -> tuple[float, float]:
    """Lowest and highest speed of `noncircular_gears` over a turn.

    In c = cos x the speed is a polynomial of fourth degree. The zeros of its derivative are searched between
    the extremes of that cubic, so no extreme of the speed is missed.

    >>> [round(speed, 12) for speed in gear_speed_extremes(0.0, 0.5, 0.0, 0.0)]
    [0.5, 1.5]
    """
    k1 = a1 - 3.0 * a3
    k2 = 2.0 * (a2 - 4.0 * a4)
    k3 = 4.0 * a3
    k4 = 8.0 * a4
    first, second = _turns(2.0 * k2, 6.0 * k3, 12.0 * k4)
    lowest = 1.0 - a1 + a2 - a3 + a4
    highest = lowest
    low = -1.0
    for part in range(3):
        high = 1.0
        if part == 0:
            high = first
        if part == 1:
            high = second
        place = _zero_between(low, high, k1, 2.0 * k2, 3.0 * k3, 4.0 * k4)
        for candidate in range(2):
            c = place if candidate == 0 else high
            speed = 1.0 - a2 + a4 + c * (k1 + c * (k2 + c * (k3 + c * k4)))
            if speed < lowest:
                lowest = speed
            if speed > highest:
                highest = speed
        low = high
    return lowest, highest


def _turns(q0: float, q1: float, q2: float) -> tuple[float, float]:
    """Zeros of `q0 + q1 c + q2 c^2` between -1 and 1, in order; a missing one is at an end."""
    first = -1.0
    second = 1.0
    inside = q1 * q1 - 4.0 * q0 * q2
    if inside > 0.0:
        q = -0.5 * (q1 + sqrt(inside)) if q1 > 0.0 else -0.5 * (q1 - sqrt(inside))
        one = q / q2 if fabs(q2) > 0.0 else 2.0
        other = q0 / q if fabs(q) > 0.0 else 2.0
        if -1.0 < one < 1.0:
            first = one
        if -1.0 < other < 1.0:
            second = other
        if first > second:
            first, second = second, first
    return first, second


def _zero_between(low: float, high: float, k0: float, k1: float, k2: float, k3: float) -> float:
    """Zero of the cubic, which is monotone from `low` to `high`; `high` if there is none."""
    at_low = k0 + low * (k1 + low * (k2 + low * k3))
    at_high = k0 + high * (k1 + high * (k2 + high * k3))
    if at_low * at_high >= 0.0:
        return high
    start = low
    end = high
    for _ in range(60):
        middle = 0.5 * (start + end)
        value = k0 + middle * (k1 + middle * (k2 + middle * k3))
        if (value > 0.0) == (at_low > 0.0):
            start = middle
        else:
            end = middle
    return 0.5 * (start + end)
