"""Heald carrier on springs between stops: exact propagation of a driven linear oscillator.

Source: Korolev, thesis on rotary dobbies (Moscow), sections 5.2 and 5.3, equations (5.1) to (5.6). The
dynamics behind the design formula, per unit of carrier mass and relative to the outer frame, are
`z'' + c z' + k z = u(t)`; a stop adds its own spring and dashpot. Between changes of contact this is
linear, and the power series of its solution, which converges for every step, is summed to rounding.
"""

from math import atan2, exp, fabs, pi, sqrt


def design_stiffness(load: float, mass: float, acceleration: float, travel: float) -> float:
    """Stiffness of one of the four springs, `c = (T - m a) / (4 S)`, equation (5.6).

    Args:
        load: largest load T of the warp on the frame [N]
        mass: of the carrier m [kg]
        acceleration: of the frame a [m/s2]
        travel: of the carrier in the frame S [m]

    Returns:
        stiffness [N/m]; erratum: the source prints 59.6 N/mm for what is 5.96 N/mm

    >>> round(design_stiffness(957.6, 15.0, 40.0, 0.015))
    5960
    """
    return (load - mass * acceleration) / (4.0 * travel)


def stop_damping_ratio(restitution: float) -> float:
    """Damping ratio of a stop that returns a mass with a given share of its speed.

    A spring and dashpot that act only in compression let go when their force is zero, after the time
    `(pi - atan2(2 r s, 1 - 2 r^2)) / (s w)`, `s = sqrt(1 - r^2)`; the share of the speed left is
    `exp(-r w time)`. Solved for r by bisection. See Schwager and Poeschel, Granular Matter 9 (2007) 465.

    Args:
        restitution: speed after over speed before the contact, 0.15 to 1 [1]

    Returns:
        damping ratio r, 0 to 1 [1]

    >>> stop_damping_ratio(1.0) < 1e-12, round(stop_damping_ratio(0.5), 4)
    (True, 0.2553)
    """
    low = 0.0
    high = 1.0 - 1e-9
    for _ in range(60):
        ratio = 0.5 * (low + high)
        root = sqrt(1.0 - ratio * ratio)
        contact = pi - atan2(2.0 * ratio * root, 1.0 - 2.0 * ratio * ratio)
        if exp(-ratio / root * contact) > restitution:
            low = ratio
        else:
            high = ratio
    return 0.5 * (low + high)


def propagate(
    position: float,
    rate: float,
    stiffness: float,
    damping: float,
    drive: float,
    drive_1: float,
    drive_2: float,
    drive_3: float,
    duration: float,
) -> tuple[float, float]:
    """State of `z'' + c z' + k z = u0 + u1 t + u2 t^2 + u3 t^3` after a duration.

    The power series of the exact solution, summed until its terms are below rounding. Valid for `sqrt(k) t`
    and `c t` up to about 1, where nothing cancels; the caller splits longer steps.

    Args:
        position, rate: z [m] and z' [m/s] at the start
        stiffness, damping: k [1/s2] and c [1/s]
        drive, drive_1, drive_2, drive_3: u0 [m/s2] to u3 [m/s5]
        duration: t [s]

    Returns:
        z [m], z' [m/s]

    >>> from math import cos, sin
    >>> z, v = propagate(1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5)
    >>> abs(z - cos(0.5)) < 1e-16, abs(v + sin(0.5)) < 1e-16
    (True, True)
    """
    if duration == 0.0:
        return position, rate
    square = duration * duration
    elastic = stiffness * square
    viscous = damping * duration
    fourth_power = square * square
    following = rate * duration
    # the terms that the drive feeds
    second = (drive * square - viscous * following - elastic * position) / 2.0
    third = (drive_1 * duration * square - 2.0 * viscous * second - elastic * following) / 6.0
    fourth = (drive_2 * fourth_power - 3.0 * viscous * third - elastic * second) / 12.0
    fifth = (drive_3 * duration * fourth_power - 4.0 * viscous * fourth - elastic * third) / 20.0
    total = position + following + second + third + fourth + fifth
    slope = following + 2.0 * second + 3.0 * third + 4.0 * fourth + 5.0 * fifth
    term = fourth
    following = fifth
    n = 6
    while n < 103:
        if n * (fabs(term) + fabs(following)) <= 1e-18 * (fabs(total) + fabs(slope)):
            break
        new = -(viscous * (n - 1) * following + elastic * term) / ((n - 1) * n)
        total = total + new
        slope = slope + n * new
        term = following
        following = new
        n = n + 1
    return total, slope / duration


def power_of_frame(
    mass: float,
    stiffness: float,
    damping: float,
    preload: float,
    position: float,
    rate: float,
    drive: float,
    drive_1: float,
    velocity: float,
    acceleration: float,
    jerk: float,
) -> tuple[float, float, float]:
    """Power of the frame on its carrier, `-m (k z + c z' - p) v`, and its first and second rate.

    Args:
        mass: of the carrier m [kg]
        stiffness, damping: k [1/s2] and c [1/s]
        preload: p, what a stop pushes back at z = 0 [m/s2]
        position, rate: z [m] and z' [m/s]
        drive, drive_1: u of `propagate` and its rate [m/s2, m/s3]
        velocity, acceleration, jerk: of the frame [m/s, m/s2, m/s3]

    Returns:
        power [W], its rates [W/s, W/s2]

    >>> power_of_frame(2.0, 3.0, 0.0, 0.0, 0.5, 0.0, 1.5, 0.0, 4.0, 1.0, 0.0)  # at rest in the moving frame
    (-12.0, -3.0, -0.0)
    """
    second = drive - stiffness * position - damping * rate
    third = drive_1 - stiffness * rate - damping * second
    force = mass * (stiffness * position + damping * rate - preload)
    growth = mass * (stiffness * rate + damping * second)
    bend = mass * (stiffness * second + damping * third)
    return (
        -force * velocity,
        -growth * velocity - force * acceleration,
        -bend * velocity - 2.0 * growth * acceleration - force * jerk,
    )
