"""Detaching rollers of a cotton comber: the torques that drive them over a nip, and the drafting force.

A nip is one revolution of the comb cylinder, counted in 40 divisions: a `division` d is 0 to 40. Each unit
has a back and a front roller, each with a top roller that it drives through the web.

Source: study of the driving torque of the detaching rollers of the comber JSFA588, Cotton Textile
Technology (2020) no. 4, article 5, sections 2 to 4, equations (1) to (20), Tables 1 and 2.
"""

from math import floor, pi

DIVISIONS = 40.0
# the fibres are drafted between these divisions, equation (12)
DRAFT_START = 18.0
DRAFT_END = 30.0


def division_of(shaft_angle: float) -> float:
    """Division of the nip at a shaft angle [rad]: from 0 to below 40.

    >>> [division_of(angle) for angle in (0.0, 0.9 * pi, -0.5 * pi)]
    [0.0, 18.0, 30.0]
    """
    turns = shaft_angle / (2.0 * pi)
    division = DIVISIONS * (turns - floor(turns))
    return division if division < DIVISIONS else 0.0


def top_roller_torque(
    acceleration: float, roller_radius: float, top_radius: float, top_inertia: float
) -> float:
    """Torque M12 on the roller from the top roller's inertia [N m], `J2 (r1 / r2)^2 e`, equation (11).

    Args:
        acceleration: of the detaching roller e [rad/s2]
        roller_radius, top_radius: r1 and r2 [m]
        top_inertia: J2 [kg m2]

    Erratum: the source gives its inertias in kg mm2; the numbers are in kg m2.

    >>> peak = 1.18 / 135.64e-6  # from the largest inertia torque, Table 1; there the next is 0.31
    >>> round(top_roller_torque(peak, 12.5e-3, 12.25e-3, 33.98e-6), 3)
    0.308
    """
    ratio = roller_radius / top_radius
    return top_inertia * ratio * ratio * acceleration


def drafting_force(fibre_share: float, friction: float, nip_load: float, resistance: float) -> float:
    """Force that drafts the fibres out of the fringe [N], `F = n / (2 n_max) (mu P - f1)`, equation (19).

    With the largest number of fibres it is half of what the nip can hold.

    Args:
        fibre_share: fibres in the nip over their largest number, n / n_max [1]
        friction: static, between fibres and roller, mu [1]
        nip_load: load of the top roller P [N]
        resistance: f1 of the top roller on the web, its torque M12 over r1 [N]

    Valid while `mu P > f1`: beyond that the nip holds nothing.

    >>> round(drafting_force(1.0, 0.33, 300.0, -0.14 / 12.5e-3) * 12.5e-3, 3)  # published: 0.68 N m
    0.689
    """
    return 0.5 * fibre_share * (friction * nip_load - resistance)


# knots of the assumed motion: divisions, torques of the roller's inertia [N m], their integrals
KNOTS = (1.5, 6.0, 11.0, 18.4, 25.0, 38.0)
TORQUES = (0.0, -0.28, -0.28, 1.18, -0.53, 0.0)
INTEGRALS = (0.0, -0.63, -2.03, 1.30, 3.445, 0.0)
# torque per angular acceleration by shaft angle: the roller's inertia times the square of the shaft speed
_MOTION_UNIT = 135.64e-6 * (10.0 * 3.141592653589793) ** 2


def assumed_motion(division: float) -> tuple[float, float]:
    """Motion of the detaching roller over a nip, an assumption: the published curve is in a lost figure.

    Between the knots of a table the acceleration follows cubics with level ends. The source publishes the
    knots at 18.4 (1.18 N m at 300 nips/min) and 25 (-0.53 N m) and the order of the phases: back, forward,
    rest. The other knots are chosen so that the roller is at rest again at the end of the nip.

    Returns:
        first and second derivative of the roller's angle by the shaft angle [1]

    >>> round(assumed_motion(18.4)[1] * (10.0 * pi) ** 2 * 135.64e-6, 12)
    1.18
    """
    if division <= 1.5 or division >= 38.0:
        return 0.0, 0.0
    index = 0
    for inner in range(1, 5):
        if division >= KNOTS[inner]:
            index = inner
    low = TORQUES[index]
    high = TORQUES[index + 1]
    width = KNOTS[index + 1] - KNOTS[index]
    u = (division - KNOTS[index]) / width
    torque = low + (high - low) * u * u * (3.0 - 2.0 * u)
    integral = INTEGRALS[index] + width * u * (low + (high - low) * u * u * (1.0 - 0.5 * u))
    return integral * (2.0 * pi / DIVISIONS) / _MOTION_UNIT, torque / _MOTION_UNIT


def assumed_fibre_share(division: float) -> float:
    """Fibres in the nip over their largest number [1], an assumption: the measured curve is in a lost figure.

    The source publishes 0 up to 18 and from 30, and the largest number at 23.8. The rise is a cubic with
    level ends. The fall is `((30 - d) / 6.2)^3`: 0.249 at 26.1, where the valleys of Table 2 at three speeds
    require 0.254.

    >>> [round(assumed_fibre_share(division), 12) for division in (18.0, 20.9, 23.8, 30.0)]
    [0.0, 0.5, 1.0, 0.0]
    """
    if division <= DRAFT_START or division >= DRAFT_END:
        return 0.0
    if division < 23.8:
        u = (division - 18.0) / 5.8
        return u * u * (3.0 - 2.0 * u)
    left = (30.0 - division) / 6.2
    return left * left * left
