"""Reed beat-up linkage: a crank-rocker without quick return and a dyad that moves the reed on a line.

Frame: the rocker's pivot is the origin, the reed moves along x at a fixed height y; front is towards +x.

Source: Yuan, Chen, Jiang and Zhou, "Kinematics analysis and dimension synthesis of beating-up mechanism
for carbon fiber multi-layer loom", Journal of Textile Research (2017), doi 10.13475/j.fzxb.20170102406,
sections 2 and 3, equations (1) to (13). Most of its equations are lost; the forms here were derived anew.
"""

from math import acos, asin, atan, atan2, cos, fabs, pi, sin, sqrt, tan


def dead_centre(
    crank: float,
    coupler: float,
    rocker: float,
    pivot_x: float,
    pivot_y: float,
    assembly: int,
    extended: bool,
) -> float:
    """Crank angle at which crank and coupler lie in line, so that the rocker is at an end of its swing.

    Args:
        crank, coupler, rocker: lengths [m]
        pivot_x, pivot_y: place of the rocker's pivot from the crank's centre [m]
        assembly: way of closing the four-bar, as for `four_bar`
        extended: whether the coupler goes on from the crank, or folds back over it

    Returns:
        crank angle [rad]

    >>> round(dead_centre(1.0, 4.0, 3.0, 4.0, 0.0, -1, True), 12) == round(acos(0.8), 12)  # a 3-4-5 triangle
    True
    """
    reach = coupler + crank if extended else coupler - crank
    frame = sqrt(pivot_x * pivot_x + pivot_y * pivot_y)
    ratio = (frame * frame + reach * reach - rocker * rocker) / (2.0 * frame * reach)
    if ratio > 1.0:
        ratio = 1.0  # rounding; a linkage that does not close is refused before
    if ratio < -1.0:
        ratio = -1.0
    angle = atan2(pivot_y, pivot_x) - assembly * acos(ratio)
    return angle if extended else angle + pi


def transmission_angle(distance: float, coupler: float, rocker: float) -> float:
    """Acute angle between coupler and rocker, from the cosine rule.

    Args:
        distance: from the crank pin to the rocker's pivot [m]
        coupler, rocker: lengths [m]

    Returns:
        angle [rad], 0 to pi/2

    >>> round(transmission_angle(5.0, 3.0, 4.0) / pi, 12)
    0.5
    """
    ratio = fabs(coupler * coupler + rocker * rocker - distance * distance) / (2.0 * coupler * rocker)
    return acos(ratio) if ratio < 1.0 else 0.0


def smallest_transmission_angle(crank: float, coupler: float, rocker: float, frame: float) -> float:
    """Smallest transmission angle of a crank-rocker: where crank and frame lie in line, (11) and (12).

    >>> from math import degrees, radians
    >>> crank, coupler, frame, smallest = crank_rocker_without_quick_return(0.55, radians(13.610), 0.2618)
    >>> round(degrees(smallest - smallest_transmission_angle(crank, coupler, 0.55, frame)), 9) + 0.0
    0.0
    """
    near = transmission_angle(frame - crank, coupler, rocker)
    far = transmission_angle(frame + crank, coupler, rocker)
    return near if near < far else far


def reed_motion(
    chi: float, chi_first: float, chi_second: float, arm: float, rod: float, height: float
) -> tuple[float, float, float, float]:
    """Reed coordinate with its derivatives, and the pressure angle of the rod that drives the reed.

    `x = q cos(chi) + sqrt(l^2 - (H - q sin(chi))^2)`, differentiated exactly.

    Args:
        chi, chi_first, chi_second: angle of the rocker's arm [rad] and its derivatives by the shaft angle [1]
        arm, rod: lengths q and l [m]
        height: H of the reed's line above the rocker's pivot [m]

    Returns:
        coordinate [m], first and second derivative by the shaft angle [m], slope of the rod [rad]

    Valid while `|H - q sin(chi)| < l`: see `rod_margin`.

    >>> [round(x, 12) for x in reed_motion(0.0, 1.0, 0.0, 1.0, 2.0, 0.0)]  # a slider-crank, stretched
    [3.0, 0.0, -1.5, 0.0]
    """
    across = arm * cos(chi)
    along = arm * sin(chi)
    drop = height - along
    reach = sqrt(rod * rod - drop * drop)
    by_chi = -along + drop * across / reach
    reach_first = drop * across / reach
    by_chi_chi = -across - (across * across + drop * along + reach_first * reach_first) / reach
    return (
        across + reach,
        by_chi * chi_first,
        by_chi_chi * chi_first * chi_first + by_chi * chi_second,
        atan2(drop, reach),
    )


def rod_margin(middle: float, half_swing: float, arm: float, rod: float, height: float) -> float:
    """By how much the rod reaches the reed's line over the whole swing of the arm [m]; negative if not.

    Args:
        middle, half_swing: angle of the arm in the middle of its swing, half the swing [rad]
        arm, rod, height: as for `reed_motion` [m]

    >>> rod_margin(0.5 * pi, 0.1, 1.0, 0.5, 1.2) > 0.0, rod_margin(0.5 * pi, 0.1, 1.0, 0.1, 1.2) > 0.0
    (True, False)
    """
    from_top = acos(sin(middle))  # between the arm's middle and the direction of +y
    from_bottom = pi - from_top
    highest = arm if from_top <= half_swing else arm * cos(from_top - half_swing)
    lowest = -arm if from_bottom <= half_swing else -arm * cos(from_bottom - half_swing)
    below = fabs(height - lowest)
    above = fabs(height - highest)
    return rod - (below if below > above else above)


def in_line_margin(middle: float, half_swing: float, arm: float, rod: float, height: float) -> float:
    """How far the swing stays clear of the angles at which arm and rod lie in line [rad]; negative if not.

    There the reed turns back while the rocker goes on: its limits would not be those of the rocker.

    Args: as for `rod_margin`

    >>> in_line_margin(1.0, 0.1, 1.0, 2.0, 0.0) > 0.0, in_line_margin(0.0, 0.1, 1.0, 2.0, 0.0) > 0.0
    (True, False)
    """
    clear = pi
    if fabs(height) <= arm + rod:
        clear = acos(cos(middle - asin(height / (arm + rod))))
    if fabs(height) <= fabs(arm - rod):
        # with arm and rod equal the reed stands still as long as the arm points away from it
        folded = 0.0 if cos(middle) < 0.0 else pi
        if arm != rod:
            folded = acos(cos(middle - pi + asin(height / (arm - rod))))
        if folded < clear:
            clear = folded
    return clear - half_swing


def crank_rocker_without_quick_return(
    rocker: float, swing: float, frame_angle: float
) -> tuple[float, float, float, float]:
    """Lengths of a crank-rocker whose rocker takes the same time to and fro, equations (9) and (13).

    `l1 = l3 sin(psi/2)`, `l2 = l3 cos(psi/2) tan(b)`, `l4 = l3 cos(psi/2) / cos(b)`,
    `cos(smallest) = sin(psi/2) / sin(b)`.

    Args:
        rocker: length l3 [m]
        swing: of the rocker, psi [rad]
        frame_angle: b between the frame and the middle of the swing, `swing / 2` to `pi / 2` [rad]

    Returns:
        crank l1, coupler l2, frame l4 [m], smallest transmission angle [rad]

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
    """Frame angle b that gives a smallest transmission angle, `sin(b) = sin(psi/2) / cos(smallest)`, (13).

    Args:
        swing: of the rocker, psi [rad]
        smallest: transmission angle, below `(pi - swing) / 2` [rad]

    Returns:
        b [rad]

    Erratum: the source prints 8.906 and 29.354 deg for 40 and 76 deg, which takes a swing of 13.622 deg;
    its own is 13.610 deg.

    >>> from math import degrees, radians
    >>> [round(degrees(frame_angle_for(radians(13.610), radians(smallest))), 2) for smallest in (40, 76)]
    [8.9, 29.33]
    """
    return asin(sin(0.5 * swing) / cos(smallest))


def crank_place(rocker: float, swing: float, slope: float, frame_angle: float) -> tuple[float, float]:
    """Centre of the crank from the rocker's pivot: on the line of the chord of the swing, equation (10).

    The crank stands behind the swing, away from the reed.

    Args:
        rocker, swing, frame_angle: as for `crank_rocker_without_quick_return`
        slope: of the chord, dy/dx [1]

    Returns:
        x, y [m]

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
    """Arm, rod and height that take the reed to two limits, with a given pressure angle at the front.

    The rod is to be equally long at both limits, equation (2); with the chord of the swing given that is
    one quadratic equation for the arm. The table of what the source prescribed is lost.

    Args:
        front, back: limits of the reed, from the rocker's pivot [m]
        swing: of the rocker [rad]
        slope: of the chord of the swing, dy/dx [1]
        pressure_angle: slope of the rod at the front limit, of either sign [rad]

    Returns:
        arm, rod, height [m]; zeros if there is none with the reed ahead of the arm at both limits

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
