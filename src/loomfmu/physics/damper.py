"""Heald carrier on springs between stops: exact propagation of a driven linear oscillator.

Source: Korolev, thesis on rotary dobbies (Moscow), sections 5.2 and 5.3, equations (5.1) to (5.6). The
dynamics behind the design formula, per unit of carrier mass and relative to the outer frame, are
`z'' + c z' + k z = u(t)`; a stop adds its own spring and dashpot. Between changes of contact this is
linear and the power series of its solution converges for every step, so it is summed to rounding.
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
    """Damping ratio of a stop that throws a mass back with that share of its speed.

    A spring and dashpot that act only in compression and never pull let go when their force is zero,
    after the time `(pi - atan2(2 r s, 1 - 2 r^2)) / (s w)`, `s = sqrt(1 - r^2)`; the speed left is
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

    The power series of the exact solution, summed until its terms vanish in rounding. Meant for
    `sqrt(k) t` and `c t` up to about 1, where nothing cancels; longer steps are split by the caller.

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


# What is watched while the carrier moves
CONTACT_CHANGE = 0
RATE = 1
LOAD_RATE = 2


def contact_change(
    contact: int,
    position: float,
    rate: float,
    travel: float,
    stop_stiffness: float,
    stop_damping: float,
) -> float:
    """Positive once the carrier's contact with a stop has to change.

    Args:
        contact: 0 free; 1 or -1 pressing on the upper or lower stop; 2 or -2 let go by a stop that it
            has not left yet (the stop's dashpot would have to pull)
        position, rate: of the carrier in the frame [m, m/s]
        travel: free way to either side [m]
        stop_stiffness, stop_damping: of a stop [N/m, N s/m]
    """
    if contact == 0:
        return fabs(position) - travel
    side = 1.0 if contact > 0 else -1.0
    depth = side * position - travel
    press = stop_stiffness * depth + stop_damping * side * rate
    if contact == side:
        return -press
    return press if press > -depth else -depth


def next_contact(
    contact: int,
    position: float,
    rate: float,
    travel: float,
    stop_stiffness: float,
    stop_damping: float,
) -> int:
    """The contact that follows when `contact_change` has become positive; see there."""
    if contact == 0:
        return 1 if position > 0.0 else -1
    side = 1 if contact > 0 else -1
    depth = side * position - travel
    if depth <= 0.0:
        return 0
    if stop_stiffness * depth + stop_damping * side * rate > 0.0:
        return side
    return 2 * side


def watched(
    what: int,
    contact: int,
    position: float,
    rate: float,
    acceleration: float,
    stiffness: float,
    damping: float,
    travel: float,
    stop_stiffness: float,
    stop_damping: float,
) -> float:
    """The quantity whose zero is sought: contact change, rate, or rate of the transmitted load."""
    if what == CONTACT_CHANGE:
        return contact_change(contact, position, rate, travel, stop_stiffness, stop_damping)
    if what == RATE:
        return rate
    return stiffness * rate + damping * acceleration


def locate(
    what: int,
    contact: int,
    position: float,
    rate: float,
    stiffness: float,
    damping: float,
    drive: float,
    drive_1: float,
    drive_2: float,
    drive_3: float,
    travel: float,
    stop_stiffness: float,
    stop_damping: float,
    duration: float,
) -> float:
    """Time at which a watched quantity changes its sign between 0 and a duration.

    Illinois regula falsi on the exact solution; returns the end of the bracket on the far side of the
    zero, so that a caller that goes there has the change behind it.

    Args:
        what: CONTACT_CHANGE, RATE or LOAD_RATE; its signs at both ends differ
        contact, travel, stop_stiffness, stop_damping: as for `contact_change`
        position .. drive_3: as for `propagate`
        duration: end of the bracket [s]

    Returns:
        time [s]
    """
    low = 0.0
    high = duration
    acceleration = drive - stiffness * position - damping * rate
    at_low = watched(
        what, contact, position, rate, acceleration, stiffness, damping, travel, stop_stiffness, stop_damping
    )
    z, v = propagate(position, rate, stiffness, damping, drive, drive_1, drive_2, drive_3, high)
    force = drive + high * (drive_1 + high * (drive_2 + high * drive_3))
    at_high = watched(
        what, contact, z, v, force - stiffness * z - damping * v,
        stiffness, damping, travel, stop_stiffness, stop_damping,
    )  # fmt: skip
    last = 0
    for _ in range(100):
        if high - low <= 1e-15 * duration or at_high == 0.0:
            break
        t = high - at_high * (high - low) / (at_high - at_low)
        if t <= low or t >= high:
            t = 0.5 * (low + high)
        z, v = propagate(position, rate, stiffness, damping, drive, drive_1, drive_2, drive_3, t)
        force = drive + t * (drive_1 + t * (drive_2 + t * drive_3))
        value = watched(
            what, contact, z, v, force - stiffness * z - damping * v,
            stiffness, damping, travel, stop_stiffness, stop_damping,
        )  # fmt: skip
        if (value > 0.0) == (at_high > 0.0):
            high = t
            at_high = value
            if last == 1:
                at_low = 0.5 * at_low
            last = 1
        else:
            low = t
            at_low = value
            if last == -1:
                at_high = 0.5 * at_high
            last = -1
    return high
