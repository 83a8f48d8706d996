"""Printed forms of equations that are misprints, evaluated to show it."""

import math

from loomfmu.components.warp_tension import WarpTension
from loomfmu.machines import table
from loomfmu.physics.rotor_laws.mechanisms import noncircular_gears, slotted_levers
from loomfmu.physics.rotor_laws.rotor import harmonic_ends, sloped_line, sloped_sine
from loomfmu.physics.warp import constant_rate_force
from validation.computed.belt import MASS

# Korolev's rotor laws, at zeta = 0.7
ZETA = 0.7
KNOT = math.pi / 8.0
LINE = math.pi * ZETA / (math.pi - 0.25 + 49.0 * math.pi**2 / 48.0)  # eta of the sloped line
SINE = math.pi * ZETA / (math.pi - 0.25 + 49.0 * math.pi**2 / 48.0 - 49.0 / 16.0)  # of the sloped sine
ROUNDED = math.pi * ZETA / (math.pi - 0.25 + 1.02 * math.pi**2)  # LINE with 1.02 for 49/48
R, E = 0.100, 0.040  # m, radius and eccentricity of the assumed slotted levers
GEARS = (-0.27, -0.13, -0.05, -0.025)  # the assumed non-circular gears
STEP = 1e-4  # of the difference quotient

LEVERS = slotted_levers(0.0, R, R, E)[1]  # S' at the slow point
GEARS_PRINTED = 1.0 + sum(a / (k + 1) for k, a in enumerate(GEARS))  # S' at the slow point by (1.14)
GEARS_QUOTIENT = (noncircular_gears(STEP, *GEARS)[0] - noncircular_gears(-STEP, *GEARS)[0]) / (2.0 * STEP)
HARMONIC_START, HARMONIC_PEAK = (harmonic_ends(x, ZETA)[1] for x in (0.0, math.pi))
# by (3.7): the sine from 0 to pi has the integral 2, over 4
HARMONIC_END = HARMONIC_PEAK + 16.0 * ZETA / 7.0 * 0.5
LINE_KNOT, SINE_KNOT = (law(KNOT, ZETA)[2] for law in (sloped_line, sloped_sine))  # S'' of the first piece
LINE_PRINTED = 7.0 * math.pi / 8.0 * 4.0 * LINE * (KNOT - math.pi)  # S'' there by (3.13)
SINE_PRINTED = 4.0 * SINE / math.pi * (8.0 / 7.0 * (KNOT - math.pi))  # S'' there by (3.22)
LINE_START, LINE_RISE = 1.0 - ZETA, sloped_line(math.pi, ZETA)[1] - (1.0 - ZETA)
LINE_END = 1.0 - ZETA + 2.0 * LINE  # by (3.16)
GAP = 2.0 * math.pi * ZETA * (ROUNDED / LINE - 1.0)  # of the sloped line's turn with 1.02 [rad]


def levers(x: float = math.pi) -> float:
    """Speed of the rotor by (1.12) as printed."""
    first = (R * R - R * E * math.cos(x)) / (R * R - 2.0 * R * E * math.cos(x) + E * E)
    p = math.atan(R * math.sin(x) / (R * math.cos(x) - E))
    return first * (R * R - R * E * math.cos(p)) / (R * R + E * E - 2.0 * R * E * math.cos(p))


def levers_turn(n: int = 20000) -> float:
    """Turn of the rotor in a turn of the shaft by that [deg]."""
    return sum(levers(2.0 * math.pi * (k + 0.5) / n) for k in range(n)) * 360.0 / n


def _cubic(x: float, third: float) -> float:
    """The bracket that (3.15) and (3.24) share, with its third term given."""
    return x**3 / 6.0 - math.pi * x * x / 2.0 + 15.0 * third / 128.0 - 11.0 * math.pi**3 / (3.0 * 512.0)


def line_jump(form: str) -> float:
    """Jump of the sloped line at pi/8 by (3.15), printed or corrected [rad]."""
    third = math.pi * KNOT**2 if form == "printed" else math.pi**2 * KNOT
    return -32.0 * LINE / (7.0 * math.pi) * _cubic(KNOT, third)


def sine_angle(sign: float, wave: float) -> float:
    """Angle of the rotor after half a turn by (3.24), with a sign and a wave number [rad]."""
    y = math.pi - KNOT
    line = 32.0 * SINE / (7.0 * math.pi) * _cubic(math.pi, math.pi**3)
    sine = 7.0 * SINE / (2.0 * math.pi) * (y - 7.0 / 8.0 * math.sin(wave * y))
    return sloped_sine(KNOT, ZETA)[0] + y - (ZETA - SINE) * y + sign * (line + sine)


def thread(b: float = 67.0, n: float = 5.0, r: float = 10.0, t: float = 0.1) -> tuple[float, float, float]:
    """Residuals of (3.29) in (3.28) as printed and as corrected, and its error at a constant rate; shares."""
    grown = math.exp(-n * t)
    x = (r * t + (1.0 - r / n) * (1.0 - grown)) / (b * n)  # for F = t
    rate = (r + (n - r) * grown) / (b * n)
    by_solution = t / (r / (b * n) + (1.0 - r / n) * (1.0 - grown) / (b * n * t))
    printed = abs((t + r) - (b * n * x + b * rate)) / r
    return (
        printed,
        abs((1.0 + r * t) - b * (rate + n * x)),
        by_solution / constant_rate_force(t, 1.0, b, n, r) - 1.0,
    )


def warp_load() -> float:
    """Pull of a frame's threads with the shed open [N]."""
    warp = WarpTension(lift=0.098, pretension=0.76, thread_stiffness=0.0, shed_offset=0.0)
    warp.initialize(0.0)
    return -warp.frame_load


def by_mass(case: str) -> float:
    """`n sqrt(m)` of the first machine of Table 6 as printed, m in g."""
    return float(table("safe_speed_by_case")[0][f"n_{case}"]) * math.sqrt(1e3 * MASS[case])


def load_spread() -> float:
    """Share by which the loads of the first machine of Table 6 differ."""
    printed = [float(table("safe_speed_by_case")[0][f"load_{case}"]) for case in MASS]
    return max(printed) / min(printed) - 1.0


def most_spread() -> tuple[float, str, float, float, float]:
    """The row of Table 5 whose products `n mu` vary most: by what share, its machine, and these."""
    found = []
    for row in table("safe_speed_by_length_factor"):
        products = [float(row[f"n_mu_{mu}"]) * float(mu) for mu in ("0.8", "0.9", "1.0")]
        found.append((max(products) / min(products) - 1.0, row["machine"], *products))
    return max(found)
