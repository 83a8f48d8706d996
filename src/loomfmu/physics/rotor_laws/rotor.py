"""Rotor laws of the dobby's speed modulator.

The rotor makes one turn per pick. It slows down to `1 - z` of the mean speed at the slow point `x = 0` and
speeds up in between. Source: Korolev, thesis on rotary dobbies (Moscow), section 3.1, equations (3.1) to
(3.27), in the corrected form: each law closes, `S(2 pi) = 2 pi`, with continuous velocity and acceleration,
which the printed (3.7), (3.13), (3.22) and (3.24) do not.

All four laws are symmetric, `S(2 pi - x) = 2 pi - S(x)`, so each is written for half a turn.

Arguments: x, the shaft angle from the slow point [rad], and the `reduction` z of the speed there, 0 to 1 [1].
"""

from math import asin, cos, pi, sin, sqrt

from ..numerics.brackets import at_root, nearer_root

UNIFORM = 1
HARMONIC_ENDS = 2
SLOPED_LINE = 3
SLOPED_SINE = 4


def harmonic_ends(x: float, reduction: float) -> tuple[float, float, float]:
    """S [rad], S', S'' [1] of harmonic ends with constant speed between, (3.1) to (3.6), `0 <= x <= pi`.

    >>> round(max(harmonic_ends(x / 100, 0.7)[2] for x in range(315)), 3)  # the source's figure
    1.6
    """
    end = 0.25 * pi
    gain = reduction / 7.0
    if x <= end:
        return (
            (1.0 - reduction) * x + gain * (4.0 * x - sin(4.0 * x)),
            1.0 - reduction + 4.0 * gain * (1.0 - cos(4.0 * x)),
            16.0 * gain * sin(4.0 * x),
        )
    return (1.0 - reduction + 4.0 * gain) * end + (1.0 + gain) * (x - end), 1.0 + gain, 0.0


def sloped_line(x: float, reduction: float) -> tuple[float, float, float]:
    """Law with harmonic ends and an acceleration that falls linearly, equations (3.10) to (3.15).

    As `harmonic_ends`, with ends over pi/8. Erratum: (3.13) prints `7 pi/8` for `-8/(7 pi)`.

    >>> round(sloped_line(pi, 0.7)[1], 3)  # the source's ratio of highest to mean speed: 1.4
    1.402
    """
    eta = pi * reduction / (pi - 0.25 + 49.0 * pi * pi / 48.0)
    end = 0.125 * pi
    if x <= end:
        return _harmonic_end(x, reduction, eta)
    reach = 0.875 * pi
    speed = 1.0 - reduction + eta
    y = x - end
    u = x - pi
    slope = 32.0 * eta / (7.0 * pi)
    return (
        (1.0 - reduction) * end
        + 0.25 * eta * (4.0 * end - 1.0)
        + speed * y
        - slope * ((u * u * u + reach * reach * reach) / 6.0 - 0.5 * reach * reach * y),
        speed - 0.5 * slope * (u * u - reach * reach),
        -slope * u,
    )


def sloped_sine(x: float, reduction: float) -> tuple[float, float, float]:
    """Law with harmonic ends and an acceleration on a sloped sine, equations (3.19) to (3.24).

    As `sloped_line`. Errata: (3.22) has the opposite sign, (3.24) a wrong sign and a sine that lacks 8/7.

    >>> round(sloped_sine(pi, 0.5)[0] / pi, 12)
    1.0
    """
    eta = pi * reduction / (pi - 0.25 + 49.0 * pi * pi / 48.0 - 49.0 / 16.0)
    end = 0.125 * pi
    if x <= end:
        return _harmonic_end(x, reduction, eta)
    reach = 0.875 * pi
    speed = 1.0 - reduction + eta
    y = x - end
    u = x - pi
    wave = 8.0 / 7.0
    gain = 4.0 * eta / pi
    return (
        (1.0 - reduction) * end
        + 0.25 * eta * (4.0 * end - 1.0)
        + speed * y
        - gain
        * (
            wave * ((u * u * u + reach * reach * reach) / 6.0 - 0.5 * reach * reach * y)
            + (y - sin(wave * y) / wave) / wave
        ),
        speed - gain * (0.5 * wave * (u * u - reach * reach) + (1.0 - cos(wave * y)) / wave),
        -gain * (wave * u + sin(wave * y)),
    )


def _harmonic_end(x: float, reduction: float, eta: float) -> tuple[float, float, float]:
    """The end piece that the sloped laws share, equations (3.10) to (3.12)."""
    return (
        (1.0 - reduction) * x + 0.25 * eta * (4.0 * x - sin(4.0 * x)),
        1.0 - reduction + eta * (1.0 - cos(4.0 * x)),
        4.0 * eta * sin(4.0 * x),
    )


def _half_turn(law: int, x: float, reduction: float) -> tuple[float, float, float]:
    """A law over its first half turn."""
    if law == HARMONIC_ENDS:
        return harmonic_ends(x, reduction)
    if law == SLOPED_LINE:
        return sloped_line(x, reduction)
    if law == SLOPED_SINE:
        return sloped_sine(x, reduction)
    return x, 1.0, 0.0


def rotor_law(law: int, x: float, reduction: float) -> tuple[float, float, float]:
    """Rotor angle S [rad] of a law over one turn, `0 <= x <= 2 pi`, and S' and S'' [1].

    Args:
        law: 1 uniform, 2 harmonic ends, 3 sloped line, 4 sloped sine

    >>> [round(rotor_law(law, 2 * pi, 0.7)[0] - 2 * pi, 12) for law in (1, 2, 3, 4)]
    [0.0, 0.0, 0.0, 0.0]
    """
    if x <= pi:
        return _half_turn(law, x, reduction)
    angle, first, second = _half_turn(law, 2.0 * pi - x, reduction)
    return 2.0 * pi - angle, first, -second


def dwell_angle(law: int, reduction: float, tolerance: float) -> float:
    """Shaft angle [rad] during which a changing frame stays within a share of its stroke, section 2.5.

    The frame is `(1 - cos(S/2)) / 2` of its stroke away from its end; the dwell is symmetric about the slow
    point, so it is twice the x at which `S = 4 asin(sqrt(tolerance))`, found to rounding by Newton steps
    kept inside a bracket. The tolerance is at most 1/2.

    >>> from math import degrees
    >>> round(degrees(dwell_angle(HARMONIC_ENDS, 0.7, 0.015)), 1)
    83.9
    """
    target = 4.0 * asin(sqrt(tolerance))
    low = 0.0
    high = pi
    x = 0.5 * pi
    for _ in range(200):
        angle, first, _second = _half_turn(law, x, reduction)
        if angle > target:
            high = x
        else:
            low = x
        nearer = nearer_root(low, high, x, angle - target, first)
        if nearer == x or high - low <= 1e-16 * high:
            break
        x = nearer
    angle, first, _second = _half_turn(law, x, reduction)
    return 2.0 * at_root(x, angle - target, first)


def highest_rates(law: int, reduction: float) -> tuple[float, float, float]:
    """Largest speed, acceleration and jerk of a law [1], from its pieces.

    The speed is highest at `x = pi`, the acceleration at the crest of an end piece, and the jerk at the slow
    point.

    >>> [round(rate, 3) for rate in highest_rates(HARMONIC_ENDS, 0.7)]
    [1.1, 1.6, 6.4]
    """
    _angle, speed, _second = _half_turn(law, pi, reduction)
    if law == HARMONIC_ENDS:
        return speed, 16.0 * reduction / 7.0, 64.0 * reduction / 7.0
    if law == UNIFORM:
        return speed, 0.0, 0.0
    _angle, _first, crest = _half_turn(law, 0.125 * pi, reduction)
    return speed, crest, 4.0 * crest
