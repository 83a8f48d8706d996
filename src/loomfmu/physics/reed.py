"""Reed beat-up linkage: a crank-rocker without quick return and a dyad that moves the reed on a line.

Frame: the rocker's pivot is the origin, the reed moves along x at a fixed height y; front is towards +x.

Source: Yuan, Chen, Jiang and Zhou, "Kinematics analysis and dimension synthesis of beating-up mechanism
for carbon fiber multi-layer loom", Journal of Textile Research (2017), doi 10.13475/j.fzxb.20170102406,
sections 2 and 3, equations (1) to (13). Most of its equations are lost; those here were derived again.
"""

from math import acos, asin, atan2, cos, fabs, floor, pi, sin, sqrt

from .linkage import closed_acos


def dead_centre(
    crank: float, coupler: float, rocker: float, pivot_x: float, pivot_y: float, assembly: int, extended: bool
) -> float:
    """Crank angle [rad] at which crank and coupler are in line, so that the rocker is at an end of its swing.

    Args:
        crank, coupler, rocker: lengths [m]
        pivot_x, pivot_y: position of the rocker's pivot relative to the crank's centre [m]
        assembly: of the four-bar, as for `four_bar`
        extended: whether the coupler extends the crank or folds back over it

    >>> round(dead_centre(1.0, 4.0, 3.0, 4.0, 0.0, -1, True), 12) == round(acos(0.8), 12)  # a 3-4-5 triangle
    True
    """
    reach = coupler + crank if extended else coupler - crank
    frame = sqrt(pivot_x * pivot_x + pivot_y * pivot_y)
    ratio = (frame * frame + reach * reach - rocker * rocker) / (2.0 * frame * reach)
    angle = atan2(pivot_y, pivot_x) - assembly * closed_acos(ratio)
    return angle if extended else angle + pi


def transmission_angle(distance: float, coupler: float, rocker: float) -> float:
    """Acute angle between coupler and rocker [rad], from the cosine rule.

    Args:
        distance: from the crank pin to the rocker's pivot [m]
        coupler, rocker: lengths [m]

    >>> round(transmission_angle(5.0, 3.0, 4.0) / pi, 12)
    0.5
    """
    ratio = fabs(coupler * coupler + rocker * rocker - distance * distance) / (2.0 * coupler * rocker)
    return acos(ratio) if ratio < 1.0 else 0.0


def smallest_transmission_angle(crank: float, coupler: float, rocker: float, frame: float) -> float:
    """Smallest transmission angle of a crank-rocker, with crank and frame in line, (11) and (12).

    If the rocker takes the same time in both directions it is `acos(sin(psi/2) / sin(b))`, equation (13):
    62.754 deg for a swing psi of 13.610 deg and a frame angle b of 15 deg.

    >>> from math import degrees
    >>> round(degrees(smallest_transmission_angle(0.06516984, 0.14633384, 0.55, 0.56539056)), 3)
    62.754
    """
    near = transmission_angle(frame - crank, coupler, rocker)
    far = transmission_angle(frame + crank, coupler, rocker)
    return near if near < far else far


def reed_motion(
    chi: float, chi_first: float, chi_second: float, arm: float, rod: float, height: float
) -> tuple[float, float, float, float]:
    """Reed coordinate and its derivatives by the shaft angle [m], and the slope of the rod to it [rad].

    `x = q cos(chi) + sqrt(l^2 - (H - q sin(chi))^2)`, differentiated exactly.

    Args:
        chi, chi_first, chi_second: angle of the rocker's arm [rad] and its derivatives by the shaft angle [1]
        arm, rod: lengths q and l [m]
        height: H of the reed's line above the rocker's pivot [m]

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
    """Margin by which the rod reaches the reed's line over the whole swing of the arm [m]; negative if not.

    Args:
        middle, half_swing: angle of the arm in the middle of its swing, half the swing [rad]

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
    """Distance of the swing from the angles at which arm and rod are in line [rad]; negative if not clear.

    At such an angle the reed reverses while the rocker goes on, so the reed's limits would not be at the
    rocker's.

    Args: as for `rod_margin`

    >>> in_line_margin(1.0, 0.1, 1.0, 2.0, 0.0) > 0.0, in_line_margin(0.0, 0.1, 1.0, 2.0, 0.0) > 0.0
    (True, False)
    """
    clear = pi
    if fabs(height) <= arm + rod:
        clear = acos(cos(middle - asin(height / (arm + rod))))
    if fabs(height) <= fabs(arm - rod):
        # with arm and rod equal the reed stands still while the arm points away from it
        folded = 0.0 if cos(middle) < 0.0 else pi
        if arm != rod:
            folded = acos(cos(middle - pi + asin(height / (arm - rod))))
        if folded < clear:
            clear = folded
    return clear - half_swing


def servo_turn(x: float, run: float, ramp: float) -> tuple[float, float, float]:
    """Turn of a crank that a servo drives once a revolution [rad], its derivatives by the shaft angle [1].

    The source says that a servo runs intermittently once the weft is inserted, and turns the crank evenly
    while it runs; how it starts and stops is our assumption. The crank turns at
    v = 2 pi / (run - ramp) and over each ramp, w away from its standing end, at

        v (w / r - sin(2 pi w / r) / (2 pi))

    so that its acceleration is continuous and at most 2 v / r.

    Args:
        x: shaft angle from the beat-up, which is the middle of the run [rad]
        run: shaft angle in which the crank turns once, up to 2 pi [rad]
        ramp: shaft angle r in which it speeds up, and in which it slows down, up to run / 2 [rad]

    >>> servo_turn(0.0, pi, 0.5 * pi)
    (0.0, 4.0, 0.0)
    >>> [turn / pi for turn in servo_turn(3.0, pi, 0.5 * pi)]
    [1.0, 0.0, 0.0]
    """
    turns = floor((x + pi) / (2.0 * pi))
    past = x - 2.0 * pi * turns
    side = 1.0 if past >= 0.0 else -1.0
    left = 0.5 * run - fabs(past)
    speed = 2.0 * pi / (run - ramp)
    if left >= ramp:
        return 2.0 * pi * turns + speed * past, speed, 0.0
    if left <= 0.0:
        return 2.0 * pi * turns + side * pi, 0.0, 0.0
    u = 2.0 * pi * left / ramp
    half = sin(0.5 * u)
    rest = speed * ramp * (u * u - 4.0 * half * half) / (8.0 * pi * pi)
    return (
        2.0 * pi * turns + side * (pi - rest),
        speed * (u - sin(u)) / (2.0 * pi),
        -side * speed / ramp * 2.0 * half * half,
    )
