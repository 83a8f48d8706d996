"""Dimensions of a reed's linkage: a crank-rocker without quick return, and a dyad that reaches two limits.

Source: as for `physics.reed`, sections 2 and 3, equations (1) to (13).
"""

from math import acos, asin, atan, cos, pi, sin, sqrt, tan


def crank_rocker_without_quick_return(
    rocker: float, swing: float, frame_angle: float
) -> tuple[float, float, float, float]:
    """Crank, coupler and frame [m] of a crank-rocker that takes as long to as fro, equations (9) and (13).

    `l1 = l3 sin(psi/2)`, `l2 = l3 cos(psi/2) tan(b)`, `l4 = l3 cos(psi/2) / cos(b)`,
    `cos(smallest) = sin(psi/2) / sin(b)`. The fourth number is its smallest transmission angle [rad].

    Args:
        rocker: length l3 [m]
        swing: of the rocker, psi [rad]
        frame_angle: b between the frame and the middle of the swing, `swing / 2` to `pi / 2` [rad]

    >>> from math import radians
    >>> round(1000 * crank_rocker_without_quick_return(0.55, radians(13.610), radians(15))[0], 2)  # 65.168
    65.17
    """
    return (
        rocker * sin(0.5 * swing),
        rocker * cos(0.5 * swing) * tan(frame_angle),
        rocker * cos(0.5 * swing) / cos(frame_angle),
        acos(sin(0.5 * swing) / sin(frame_angle)),
    )


def frame_angle_for(swing: float, smallest: float) -> float:
    """Frame angle b [rad] of a smallest transmission angle, `sin(b) = sin(psi/2) / cos(smallest)`, (13).

    Args:
        swing: of the rocker, psi [rad]
        smallest: transmission angle, below `(pi - swing) / 2` [rad]

    Erratum: the source prints 8.906 and 29.354 deg for 40 and 76 deg, which takes a swing of 13.622 deg;
    its own is 13.610 deg.

    >>> from math import degrees, radians
    >>> [round(degrees(frame_angle_for(radians(13.610), radians(smallest))), 2) for smallest in (40, 76)]
    [8.9, 29.33]
    """
    return asin(sin(0.5 * swing) / cos(smallest))


def crank_place(rocker: float, swing: float, slope: float, frame_angle: float) -> tuple[float, float]:
    """Position x, y of the crank's centre from the rocker's pivot [m]: on the chord's line, equation (10).

    The crank stands behind the swing, away from the reed.

    Args:
        rocker, swing, frame_angle: as for `crank_rocker_without_quick_return`
        slope: of the chord, dy/dx [1]

    >>> x, y = crank_place(0.55, 0.23754, 0.1154, 0.2618)
    >>> round(1000 * (y - 0.1154 * x), 2)  # the chord's line, y = 0.1154 x + 549.75 mm
    549.75
    """
    direction = atan(slope)
    distance = rocker * cos(0.5 * swing)
    back = distance * tan(frame_angle)
    return (
        -distance * sin(direction) - back * cos(direction),
        distance * cos(direction) - back * sin(direction),
    )


def reed_dyad(
    front: float, back: float, swing: float, slope: float, pressure_angle: float
) -> tuple[float, float, float]:
    """Arm, rod and height [m] that take the reed to two limits, with a given pressure angle at the front.

    The rod is equally long at both limits, equation (2); with the chord of the swing given, that is one
    quadratic equation for the arm. The source's table of given values is lost. They are zeros if none has the
    reed ahead of the arm at both limits.

    Args:
        front, back: limits of the reed, from the rocker's pivot [m]
        swing: of the rocker [rad]
        slope: of the chord of the swing, dy/dx [1]
        pressure_angle: slope of the rod at the front limit, of either sign [rad]

    >>> from math import radians
    >>> dyad = reed_dyad(0.490, 0.330, radians(13.610), 0.1154, radians(-1.235))
    >>> [round(1000 * length, 1) for length in dyad]
    [679.8, 487.5, 669.3]
    """
    middle = atan(slope) + 0.5 * pi
    front_x = cos(middle - 0.5 * swing)
    back_x = cos(middle + 0.5 * swing)
    rise = sin(middle - 0.5 * swing) - sin(middle + 0.5 * swing)
    fall = tan(pressure_angle)
    # (back - q back_x)^2 + (q rise + fall (front - q front_x))^2 = (1 + fall^2) (front - q front_x)^2
    tilt = rise - fall * front_x
    stretch = 1.0 + fall * fall
    a = back_x * back_x + tilt * tilt - stretch * front_x * front_x
    b = 2.0 * (stretch * front * front_x + fall * front * tilt - back * back_x)
    c = back * back - front * front
    inside = b * b - 4.0 * a * c
    if front <= back or inside < 0.0 or b + sqrt(inside) <= 0.0:
        return 0.0, 0.0, 0.0
    arm = -2.0 * c / (b + sqrt(inside))
    ahead = front - arm * front_x
    if ahead <= 0.0 or back <= arm * back_x:
        return 0.0, 0.0, 0.0
    return arm, ahead * sqrt(stretch), arm * sin(middle - 0.5 * swing) + fall * ahead
