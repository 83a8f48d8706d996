"""Weft-insertion linkage: spherical crank-rocker and planar four-bar, with exact derivatives.

Source: Zhu and Zhou, "Conditions of the instability of rapier belt in the rapier loom and avoidance
measures", J. Zhejiang Sci-Tech Univ. 45 (2021) 497, section 2, equations (1) to (6).
"""

from math import acos, atan2, cos, fabs, pi, sin, sqrt


def closed_acos(ratio: float) -> float:
    """`acos(ratio)`, where a linkage that closes may exceed 1 or -1 by rounding at a dead point.

    A linkage that does not close must be rejected before, see `spherical_margin` and `four_bar_margin`.

    >>> closed_acos(0.5) == acos(0.5), closed_acos(1.0000000000000002)
    (True, 0.0)
    """
    if ratio > 1.0:
        return 0.0
    if ratio < -1.0:
        return pi
    return acos(ratio)


def spherical_rocker(theta: float, rocker: float, cone: float) -> tuple[float, float, float]:
    """Rocker angle a [rad] of a spherical crank-rocker, and da/dt and d2a/dt2 [1], equation (1).

    `cos g - cos b cos a + sin b sin a cos t = 0`, solved for `a` in closed form and differentiated
    implicitly, so that the derivatives are exact.

    Args:
        theta: crank angle t [rad]
        rocker: arc g between the axes AC and BC [rad]
        cone: half-angle b of the crank's cone, AC to OC [rad]

    Valid where `|cos g| <= sqrt(cos(b)^2 + sin(b)^2 cos(t)^2)`: see `spherical_margin`.

    >>> from math import degrees, pi, radians
    >>> round(degrees(spherical_rocker(0.0, radians(60), radians(28))[0]), 9)
    32.0
    """
    a = cos(cone)
    b = sin(cone) * cos(theta)
    alpha = closed_acos(cos(rocker) / sqrt(a * a + b * b)) - atan2(b, a)
    sin_alpha = sin(alpha)
    cos_alpha = cos(alpha)
    by_theta = -sin(cone) * sin_alpha * sin(theta)
    by_alpha = a * sin_alpha + b * cos_alpha
    first = -by_theta / by_alpha
    by_theta_theta = -b * sin_alpha
    by_theta_alpha = -sin(cone) * cos_alpha * sin(theta)
    by_alpha_alpha = a * cos_alpha - b * sin_alpha
    second = -(by_theta_theta + first * (2.0 * by_theta_alpha + first * by_alpha_alpha)) / by_alpha
    return alpha, first, second


def spherical_margin(rocker: float, cone: float) -> float:
    """Margin by which the spherical linkage closes over a whole turn: `|cos b| - |cos g|`, negative if not.

    Arguments as for `spherical_rocker`.

    >>> from math import radians
    >>> spherical_margin(radians(60), radians(28)) > 0, spherical_margin(radians(60), radians(61)) > 0
    (True, False)
    """
    return fabs(cos(cone)) - fabs(cos(rocker))


def four_bar(
    psi: float,
    psi_first: float,
    psi_second: float,
    crank: float,
    coupler: float,
    output: float,
    pivot_x: float,
    pivot_y: float,
    assembly: int,
) -> tuple[float, float, float]:
    """Output angle of a planar four-bar C-D-K-G [rad], its derivatives by the shaft angle [1], equation (3).

    D turns about the origin, K about the pivot G; the coupler DK joins them. The angle follows from the
    triangle D-K-G, its derivatives from `|D - K|^2 = const`.

    Args:
        psi, psi_first, psi_second: crank angle [rad] and its derivatives by the shaft angle [1]
        crank, coupler, output: lengths DC, DK, KG [m]
        pivot_x, pivot_y: position of G [m]
        assembly: +1 or -1, which of the two triangles

    >>> from math import pi
    >>> x, x1, x2 = four_bar(pi / 2, 1.0, 0.0, 0.1, 0.2, 0.1, 0.2, 0.0, -1)  # a parallelogram
    >>> round(x - pi / 2, 12), round(x1, 12), round(x2, 12)
    (0.0, 1.0, 0.0)
    """
    cos_psi = cos(psi)
    sin_psi = sin(psi)
    x = crank * cos_psi - pivot_x
    y = crank * sin_psi - pivot_y
    length = sqrt(x * x + y * y)
    ratio = (length * length + output * output - coupler * coupler) / (2.0 * length * output)
    chi = atan2(y, x) + assembly * closed_acos(ratio)
    cos_chi = cos(chi)
    sin_chi = sin(chi)
    rod_x = x - output * cos_chi
    rod_y = y - output * sin_chi
    along_output = output * (rod_y * cos_chi - rod_x * sin_chi)
    along_crank = crank * (rod_y * cos_psi - rod_x * sin_psi)
    first = psi_first * along_crank / along_output
    slide_x = -crank * sin_psi * psi_first + output * sin_chi * first
    slide_y = crank * cos_psi * psi_first - output * cos_chi * first
    bend_x = -crank * cos_psi * psi_first * psi_first + output * cos_chi * first * first
    bend_y = -crank * sin_psi * psi_first * psi_first + output * sin_chi * first * first
    second = (
        slide_x * slide_x + slide_y * slide_y + rod_x * bend_x + rod_y * bend_y + along_crank * psi_second
    ) / along_output
    return chi, first, second


def four_bar_margin(
    psi_low: float,
    psi_high: float,
    crank: float,
    coupler: float,
    output: float,
    pivot_x: float,
    pivot_y: float,
) -> float:
    """Margin by which a four-bar closes while its crank swings from `psi_low` to `psi_high` [m].

    The distance D-G must stay between `|coupler - output|` and `coupler + output`; it is extreme at the ends
    of the swing and where the crank points to G or away from it. Negative if the four-bar does not close.

    >>> four_bar_margin(0.0, 3.0, 0.1, 0.2, 0.1, 0.2, 0.0) >= 0.0
    True
    >>> four_bar_margin(0.0, 3.0, 0.1, 0.1, 0.1, 0.4, 0.0) >= 0.0
    False
    """
    frame = sqrt(pivot_x * pivot_x + pivot_y * pivot_y)
    towards = atan2(pivot_y, pivot_x)
    nearest = frame + crank
    farthest = fabs(frame - crank)
    for end in range(2):
        angle = psi_low if end == 0 else psi_high
        distance = sqrt(frame * frame + crank * crank - 2.0 * frame * crank * cos(angle - towards))
        if distance < nearest:
            nearest = distance
        if distance > farthest:
            farthest = distance
    if _within(towards, psi_low, psi_high):
        nearest = fabs(frame - crank)
    if _within(towards + pi, psi_low, psi_high):
        farthest = frame + crank
    inner = nearest - fabs(coupler - output)
    outer = coupler + output - farthest
    return inner if inner < outer else outer


def _within(angle: float, low: float, high: float) -> bool:
    """Return whether the angle, plus or minus whole turns, lies between low and high."""
    turned = (angle - low) % (2.0 * pi)
    return turned <= high - low


def weft_motion(
    theta: float,
    rocker: float,
    cone: float,
    offset: float,
    planar: bool,
    crank: float,
    coupler: float,
    output: float,
    pivot_x: float,
    pivot_y: float,
    assembly: int,
) -> tuple[float, float, float]:
    """Angle of the sector gear [rad] and its derivatives by the crank angle [1], equations (1) to (4).

    Args:
        theta: crank angle, shaft angle plus phase [rad]
        offset: angle between the rocker's arms BC and DC [rad]
        planar: whether a four-bar follows; otherwise the rocker itself is the sector gear
    """
    alpha, first, second = spherical_rocker(theta, rocker, cone)
    if not planar:
        return alpha, first, second
    return four_bar(alpha + offset, first, second, crank, coupler, output, pivot_x, pivot_y, assembly)


def wrapped(angle: float) -> float:
    """The same angle between -pi and pi, for angles from -3 pi to 3 pi [rad].

    >>> wrapped(3.0), round(wrapped(4.0) + 2 * 3.141592653589793 - 4.0, 12)
    (3.0, 0.0)
    """
    if angle > pi:
        return angle - 2.0 * pi
    if angle < -pi:
        return angle + 2.0 * pi
    return angle
