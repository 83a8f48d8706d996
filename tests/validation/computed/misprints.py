"""Printed forms of equations that are misprints, evaluated to show it."""

import math

from validation.computed.belt import MASS

from loomfmu.components.warp_tension import WarpTension
from loomfmu.machines import table
from loomfmu.physics.rotor_laws.mechanisms import noncircular_gears, slotted_levers
from loomfmu.physics.rotor_laws.rotor import harmonic_ends, sloped_line, sloped_sine
from loomfmu.physics.warp import constant_rate_force

# Korolev's rotor laws, at zeta = 0.7
ZETA = 0.7
KNOT = math.pi / 8.0
LINE = math.pi * ZETA / (math.pi - 0.25 + 49.0 * math.pi**2 / 48.0)  # eta of the sloped line
SINE = math.pi * ZETA / (math.pi - 0.25 + 49.0 * math.pi**2 / 48.0 - 49.0 / 16.0)  # of the sloped sine
RADIUS, ECCENTRICITY = 0.100, 0.040  # m, the assumed slotted levers
GEARS = (-0.27, -0.13, -0.05, -0.025)  # the assumed non-circular gears
# The thread of (3.28) and (3.29): b [N/m], n [1], r [1/s] and time [s]
B, N, R, T = 67.0, 5.0, 10.0, 0.1


def levers(x: float = math.pi) -> float:
    """Speed of the rotor by (1.12) as printed."""
    r, e = RADIUS, ECCENTRICITY
    first = (r * r - r * e * math.cos(x)) / (r * r - 2.0 * r * e * math.cos(x) + e * e)
    p = math.atan(r * math.sin(x) / (r * math.cos(x) - e))
    return first * (r * r - r * e * math.cos(p)) / (r * r + e * e - 2.0 * r * e * math.cos(p))


def levers_turn() -> float:
    """Turn of the rotor in a turn of the shaft by that [deg]."""
    n = 20000
    return sum(levers(2.0 * math.pi * (k + 0.5) / n) for k in range(n)) * 360.0 / n


def corrected_levers() -> float:
    """Speed of the rotor at the slow point."""
    return slotted_levers(0.0, RADIUS, RADIUS, ECCENTRICITY)[1]


def gears() -> float:
    """Speed of the rotor at the slow point by (1.14) as printed."""
    return 1.0 + sum(a / (k + 1) for k, a in enumerate(GEARS))


def gears_quotient() -> float:
    """Difference quotient of (1.13) there."""
    h = 1e-4
    return (noncircular_gears(h, *GEARS)[0] - noncircular_gears(-h, *GEARS)[0]) / (2.0 * h)


def third_piece() -> float:
    """Speed at the end of the turn by (3.7) as printed."""
    return (
        harmonic_ends(math.pi, ZETA)[1] + 16.0 * ZETA / 7.0 * 0.5
    )  # the sine from 0 to pi has the integral 2, over 4


def harmonic(x: float) -> float:
    """Speed of the harmonic ends at a shaft angle."""
    return harmonic_ends(x, ZETA)[1]


def line_acceleration() -> float:
    """Acceleration at pi/8 by (3.13) as printed."""
    return 7.0 * math.pi / 8.0 * 4.0 * LINE * (KNOT - math.pi)


def knot_acceleration(law: str) -> float:
    """Acceleration with which the first piece of a law ends there."""
    return (sloped_line if law == "line" else sloped_sine)(KNOT, ZETA)[2]


def fastest(speed: float) -> float:
    """Highest speed over the shaft's with eta as it is printed after (3.12)."""
    return 1.0 - ZETA + (sloped_line(math.pi, ZETA)[1] - (1.0 - ZETA)) * speed


def rounded_gap() -> float:
    """By how much the sloped line's turn is too long with 1.02 for 49/48 [rad]."""
    rounded = math.pi * ZETA / (math.pi - 0.25 + 1.02 * math.pi**2)
    return 2.0 * math.pi * ZETA * (rounded / LINE - 1.0)


def _cubic(x: float, third: float) -> float:
    """The bracket that (3.15) and (3.24) share, with its third term given."""
    return x**3 / 6.0 - math.pi * x * x / 2.0 + third - 11.0 * math.pi**3 / (3.0 * 512.0)


def line_jump(form: str) -> float:
    """Jump of the sloped line at pi/8 by (3.15), printed or corrected [rad]."""
    third = math.pi * KNOT**2 if form == "printed" else math.pi**2 * KNOT
    return -32.0 * LINE / (7.0 * math.pi) * _cubic(KNOT, 15.0 * third / 128.0)


def line_end() -> float:
    """Speed at the end of the sloped line's turn by (3.16) as printed."""
    return 1.0 - ZETA + 2.0 * LINE


def line_start() -> float:
    """Speed at the start of its turn."""
    return sloped_line(0.0, ZETA)[1]


def sine_acceleration() -> float:
    """Acceleration at pi/8 by (3.22) as printed."""
    return 4.0 * SINE / math.pi * (8.0 / 7.0 * (KNOT - math.pi))


def sine_angle(sign: float, wave: float) -> float:
    """Angle of the rotor after half a turn by (3.24), with a sign and a wave number [rad]."""
    y = math.pi - KNOT
    line = 32.0 * SINE / (7.0 * math.pi) * _cubic(math.pi, 15.0 * math.pi**3 / 128.0)
    sine = 7.0 * SINE / (2.0 * math.pi) * (y - 7.0 / 8.0 * math.sin(wave * y))
    return sloped_sine(KNOT, ZETA)[0] + y - (ZETA - SINE) * y + sign * (line + sine)


def thread_remainder(form: str) -> float:
    """Residual of (3.29) in (3.28), printed or corrected, over the largest of the terms."""
    grown = math.exp(-N * T)
    x = (R * T + (1.0 - R / N) * (1.0 - grown)) / (B * N)  # for F = t
    rate = (R + (N - R) * grown) / (B * N)
    if form == "printed":
        return abs((T + R) - (B * N * x + B * rate)) / R
    return abs((1.0 + R * T) - B * (rate + N * x))


def thread_error() -> float:
    """How far (3.29) is off for an extension at a constant rate, as a share."""
    by_solution = T / (R / (B * N) + (1.0 - R / N) * (1.0 - math.exp(-N * T)) / (B * N * T))
    return by_solution / constant_rate_force(T, 1.0, B, N, R) - 1.0


def warp_load() -> float:
    """Pull of a frame's threads with the shed open [N]."""
    warp = WarpTension(lift=0.098, pretension=0.76, thread_stiffness=0.0, shed_offset=0.0)
    warp.initialize(0.0)
    return -warp.frame_load


def by_mass(case: str) -> float:
    """`n sqrt(m)` of the first machine of Table 6 as printed, m in g."""
    return float(table("safe_speed_by_case")[0][f"n_{case}"]) * math.sqrt(1e3 * MASS[case])


def load_spread() -> float:
    """By how much the loads of the first machine of Table 6 differ, as a share."""
    printed = [float(table("safe_speed_by_case")[0][f"load_{case}"]) for case in MASS]
    return max(printed) / min(printed) - 1.0


def by_factor(row: dict[str, str]) -> tuple[float, ...]:
    """`n mu` of a row of Table 5 as printed."""
    return tuple(float(row[f"n_mu_{mu}"]) * float(mu) for mu in ("0.8", "0.9", "1.0"))


def most_spread(result: str) -> object:
    """The row of Table 5 whose products `n mu` vary most: its `machine`, `products` or their `spread`."""
    rows = table("safe_speed_by_length_factor")
    worst = max(rows, key=lambda row: max(by_factor(row)) / min(by_factor(row)))
    products = by_factor(worst)
    spread = max(products) / min(products) - 1.0
    return {"machine": worst["machine"], "products": products, "spread": spread}[result]


def by_clearance(clearance: str) -> float:
    """`F sqrt(c)` of the wheel of 430 mm as printed, c in mm."""
    row = next(row for row in table("belt_wrap_theory") if row["D_mm"] == "430.0")
    return float(row[f"c_{clearance:g}"]) * math.sqrt(float(clearance))
