"""Misprints in Korolev's rotor laws, each with the calculation that shows it (at zeta = 0.7)."""

import math

from ..physics.rotor_laws.mechanisms import noncircular_gears, slotted_levers
from ..physics.rotor_laws.rotor import harmonic_ends, rotor_law, sloped_line, sloped_sine
from .sections import Row, Section, number

ZETA = 0.7
KNOT = math.pi / 8.0
LINE = math.pi * ZETA / (math.pi - 0.25 + 49.0 * math.pi**2 / 48.0)  # eta of the sloped line
SINE = math.pi * ZETA / (math.pi - 0.25 + 49.0 * math.pi**2 / 48.0 - 49.0 / 16.0)  # of the sloped sine
RADIUS, ECCENTRICITY = 0.100, 0.040  # m, the assumed slotted levers
GEARS = (-0.27, -0.13, -0.05, -0.025)  # the assumed non-circular gears


def section() -> Section:
    """All of them."""
    return Section(
        "Dobby: rotor laws (Korolev, sections 1.2, 3.1 and 3.4)",
        ("where", "printed", "corrected", "what is wrong with the printed form"),
        (
            levers(), gears(), third_piece(), largest_speed(), line_acceleration(), *line_constant(),
            line_angle(), last_acceleration(), sine_acceleration(), sine_angle(), *table_3_1(),
        ),
        intro="Values at zeta = 0.7; the levers and gears with the assumed dimensions.",
    )  # fmt: skip


def levers() -> Row:
    """(1.12)."""

    def printed(x: float) -> float:
        r, e = RADIUS, ECCENTRICITY
        first = (r * r - r * e * math.cos(x)) / (r * r - 2.0 * r * e * math.cos(x) + e * e)
        p = math.atan(r * math.sin(x) / (r * math.cos(x) - e))
        return first * (r * r - r * e * math.cos(p)) / (r * r + e * e - 2.0 * r * e * math.cos(p))

    _angle, right, _second, _third = slotted_levers(0.0, RADIUS, RADIUS, ECCENTRICITY)
    n = 20000
    turned = sum(printed(2.0 * math.pi * (k + 0.5) / n) for k in range(n)) * 360.0 / n
    return Row(
        (
            "(1.12)",
            "the arc tangent of a ratio, which stays within a quarter turn to either side",
            "the angle, which goes all the way round",
            f"at the slow point S' = {number(printed(math.pi), 3)} instead of {number(right, 3)}; per turn"
            f" of the shaft the rotor turns by {number(turned, 0)} deg instead of 360",
        )
    )


def gears() -> Row:
    """(1.14)."""
    printed = 1.0 + sum(a / (k + 1) for k, a in enumerate(GEARS))
    h = 1e-4
    quotient = (noncircular_gears(h, *GEARS)[0] - noncircular_gears(-h, *GEARS)[0]) / (2.0 * h)
    return Row(
        (
            "(1.14)",
            "a_k / k in the speed",
            "a_k",
            f"at the slow point S' = {number(printed, 4)}; the difference quotient of (1.13) is"
            f" {number(quotient, 4)}",
        )
    )


def third_piece() -> Row:
    """(3.7)."""
    before = harmonic_ends(math.pi, ZETA)[1]
    printed = before + 16.0 * ZETA / 7.0 * 0.5  # the sine from 0 to pi has the integral 2, over 4
    return Row(
        (
            "(3.7)",
            "+ sin 4 (theta - 7 pi/4)",
            "- sin 4 (theta - 7 pi/4)",
            f"the turn ends with S' = {number(printed, 2)} where the next begins with"
            f" {number(harmonic_ends(0.0, ZETA)[1], 2)}",
        )
    )


def largest_speed() -> Row:
    """After (3.9)."""
    speed = number(harmonic_ends(math.pi, ZETA)[1], 1)
    fails = "by (3.2) and (3.5) the speed rises to 1 + zeta/7; 0.7 is zeta, the most that is taken off"
    return Row(("after (3.9)", "largest speed 0.7 1/s", f"{speed} 1/s", fails))


def line_acceleration() -> Row:
    """(3.13)."""
    printed = 7.0 * math.pi / 8.0 * 4.0 * LINE * (KNOT - math.pi)
    return Row(
        (
            "(3.13)",
            "(7 pi/8) a0 (theta - pi)",
            "-(8/(7 pi)) a0 (theta - pi)",
            f"at pi/8 S'' = {number(printed, 3)}, where (3.10) ends with"
            f" {number(sloped_line(KNOT, ZETA)[2], 3)}",
        )
    )


def line_constant() -> tuple[Row, Row]:
    """The two constants after (3.12)."""
    speed = 400.0 * math.pi / 30.0
    fastest = 1.0 - ZETA + (sloped_line(math.pi, ZETA)[1] - (1.0 - ZETA)) * speed
    rounded = math.pi * ZETA / (math.pi - 0.25 + 1.02 * math.pi**2)
    gap = 360.0 * ZETA * (rounded / LINE - 1.0)
    return (
        Row(
            (
                "after (3.12)",
                "eta = a0 / (4 w0)",
                "eta = a0 / (4 w0^2)",
                f"a0 is proportional to w0^2: at 400 rev/min eta would be {number(LINE * speed, 2)} instead"
                f" of {number(LINE, 4)}, and the highest S' {number(fastest, 1)}",
            )
        ),
        Row(
            (
                "after (3.12), (3.21)",
                "1.02 pi^2",
                "(49/48) pi^2",
                f"with 1.02 the sloped line ends its turn {number(abs(gap), 3)} deg"
                f" {'short' if gap < 0.0 else 'ahead'}",
            )
        ),
    )


def _cubic(x: float, third: float) -> float:
    """The bracket that (3.15) and (3.24) share, with its third term given."""
    return x**3 / 6.0 - math.pi * x * x / 2.0 + third - 11.0 * math.pi**3 / (3.0 * 512.0)


def line_angle() -> Row:
    """(3.15)."""
    printed = -32.0 * LINE / (7.0 * math.pi) * _cubic(KNOT, 15.0 * math.pi * KNOT**2 / 128.0)
    right = -32.0 * LINE / (7.0 * math.pi) * _cubic(KNOT, 15.0 * math.pi**2 * KNOT / 128.0)
    return Row(
        (
            "(3.15), (3.24)",
            "15 pi theta^2 / 128",
            "15 pi^2 theta / 128",
            f"at pi/8 the sloped line jumps by {number(printed, 3)} rad; with the corrected term by"
            f" {number(right, 3)}",
        )
    )


def last_acceleration() -> Row:
    """(3.16) and (3.25)."""
    return Row(
        (
            "(3.16), (3.25)",
            "+ a0 cos 4 (theta - 15 pi/8)",
            "- a0 cos 4 (theta - 15 pi/8)",
            f"the turn of the sloped line ends with S' = {number(1.0 - ZETA + 2.0 * LINE, 3)} where the"
            f" next begins with {number(rotor_law(3, 0.0, ZETA)[1], 3)}",
        )
    )


def sine_acceleration() -> Row:
    """(3.22)."""
    printed = 4.0 * SINE / math.pi * (8.0 / 7.0 * (KNOT - math.pi))
    return Row(
        (
            "(3.22)",
            "+ (a0/pi) [..]",
            "- (a0/pi) [..]",
            f"at pi/8 S'' = {number(printed, 3)}, where (3.19) ends with"
            f" {number(sloped_sine(KNOT, ZETA)[2], 3)}",
        )
    )


def sine_angle() -> Row:
    """(3.24)."""

    def angle(sign: float, wave: float) -> float:
        y = math.pi - KNOT
        line = 32.0 * SINE / (7.0 * math.pi) * _cubic(math.pi, 15.0 * math.pi**3 / 128.0)
        sine = 7.0 * SINE / (2.0 * math.pi) * (y - 7.0 / 8.0 * math.sin(wave * y))
        found = sloped_sine(KNOT, ZETA)[0] + y - (ZETA - SINE) * y + sign * (line + sine)
        return math.degrees(found)

    return Row(
        (
            "(3.24)",
            "plus signs, sin(theta - pi/8)",
            "minus signs, sin((8/7)(theta - pi/8))",
            f"after half a turn of the shaft the rotor is at {number(angle(1.0, 1.0), 1)} deg; with the signs"
            f" corrected at {number(angle(-1.0, 1.0), 1)}, with the sine too at"
            f" {number(angle(-1.0, 8.0 / 7.0), 1)}",
        )
    )


def table_3_1() -> tuple[Row, Row]:
    """Table 3.1."""
    return (
        Row(
            (
                "Table 3.1, zeta = 0.3",
                "upper dwell of 80 deg from 150 to 235 deg",
                "from 155 deg",
                f"150 to 235 is {number(235.0 - 150.0, 0)} deg; the other three columns have 155",
            )
        ),
        Row(
            (
                "Table 3.1, zeta = 0.6",
                "rise from 257 to 132 deg",
                "from 257.5 to 132.5 deg",
                f"centred on {number(0.5 * (257.0 + 132.0), 1)} deg; all others are centred on 195",
            )
        ),
    )
