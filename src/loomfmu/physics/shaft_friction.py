"""A driven shaft with dry friction and a motor of several lines, exact from event to event within a step.

Dry friction `R` opposes motion, and at rest holds against any torque up to `R`. While the shaft turns one way
it is a constant load, and `driven_motion` is exact on each line of the motor. A load on a straight line makes
the net torque `a + b exp(-z u)` between two such events, which is zero once at most: the velocity turns once
at most, so no event is missed.
"""

from math import fabs, inf

from .driven_shaft import driven_motion, response
from .motor import Motor, line_at
from .numerics.brackets import at_root

HALVINGS = 52  # of a part of the step: then its share is known to rounding
MOST_PARTS = 6000  # of a step: what grows from the smallest number to the largest takes fewer
MOST_GROWTH = 0.25  # of a part, in time constants, where the motor's torque rises with the velocity
# Gauss's quadrature over 0 .. 1
NODES = (0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263)
WEIGHTS = (0.17392742256872692, 0.3260725774312731, 0.3260725774312731, 0.17392742256872692)


def sense_of(velocity: float, free: float, friction: float) -> float:
    """Return the sense in which a shaft turns or starts to turn, 1 or -1; 0 if friction holds it.

    Args:
        velocity: of the shaft [rad/s]
        free: net torque without dry friction [N m]
        friction: dry friction R [N m]

    >>> sense_of(0.0, -5.0, 4.0), sense_of(0.0, 4.0, 4.0), sense_of(3.0, -5.0, 4.0)
    (-1.0, 0.0, 1.0)
    """
    if velocity == 0.0 and fabs(free) <= friction:
        return 0.0
    towards = free if velocity == 0.0 else velocity
    return 1.0 if towards > 0.0 else -1.0


def stopping_share(
    velocity: float, net: float, rise: float, duration: float, inertia: float, slope: float, sense: float
) -> float:
    """Share of a part of the step at which a shaft that turns in a sense, 1 or -1, stops; 1 if it does not.

    >>> stopping_share(3.0, -4.0, 0.0, 3.0, 2.0, 0.0, 1.0)  # after 1.5 s
    0.5
    """
    by = response(duration, inertia, slope)
    gained, _more, _second, _third = driven_motion(velocity, net, rise, 0.0, by)
    high = 1.0
    if sense * (velocity + gained) > 0.0:
        if not (sense * net < 0.0 and sense * (net - rise - slope * gained) > 0.0):
            return 1.0
        low = 0.0
        for _ in range(HALVINGS):  # where the velocity turns
            u = 0.5 * (low + high)
            by = response(duration * u, inertia, slope)
            gained, _more, _second, _third = driven_motion(velocity, net, rise * u, 0.0, by)
            if sense * (net - rise * u - slope * gained) < 0.0:
                low = u
            else:
                high = u
        by = response(duration * high, inertia, slope)
        gained, _more, _second, _third = driven_motion(velocity, net, rise * high, 0.0, by)
        if sense * (velocity + gained) > 0.0:
            return 1.0
    low = 0.0
    for _ in range(HALVINGS):
        u = 0.5 * (low + high)
        by = response(duration * u, inertia, slope)
        gained, _more, _second, _third = driven_motion(velocity, net, rise * u, 0.0, by)
        if sense * (velocity + gained) > 0.0:
            low = u
        else:
            high = u
    by = response(duration * high, inertia, slope)
    gained, _more, _second, _third = driven_motion(velocity, net, rise * high, 0.0, by)
    rate = duration * (net - rise * high - slope * gained) / inertia
    return at_root(high, velocity + gained, rate)


def mean_square(
    velocity: float, net: float, rise: float, duration: float, inertia: float, slope: float, falls: bool
) -> float:
    """Mean of the squared velocity over a part of the step, on one line of the motor [rad2/s2].

    From the energy balance, with viscous friction in `slope`, where the motor's torque falls; Gauss's four
    nodes where it rises, on parts of at most `MOST_GROWTH`: their error is below rounding.

    >>> mean_square(3.0, -2.0, 0.0, 3.0, 2.0, 0.0, False)  # from 3 to 0 rad/s, evenly
    3.0
    """
    if duration == 0.0:
        return velocity * velocity
    if not falls:
        total = 0.0
        for number in range(4):
            u = NODES[number]
            by = response(duration * u, inertia, slope)
            gained, _more, _second, _third = driven_motion(velocity, net, rise * u, 0.0, by)
            total = total + WEIGHTS[number] * (velocity + gained) * (velocity + gained)
        return total
    by = response(duration, inertia, slope)
    gained, more, second, _third = driven_motion(velocity, net, rise, 0.0, by)
    mean = velocity + more
    kept = inertia * gained * (velocity + 0.5 * gained) / duration
    return ((net + slope * velocity) * mean - rise * (mean - second) - kept) / slope


def parted_motion(
    motor: Motor,
    velocity: float,
    load: float,
    rise: float,
    duration: float,
    inertia: float,
    viscous: float,
    friction: float,
) -> tuple[float, float, float, float, float]:
    """Motion over a step, through stops and releases and from line to line of the motor.

    Args:
        load, rise: load at the start of the step, and its rise on a straight line [N m]
        viscous: friction for each rad/s [N m s/rad]
        friction: dry friction R [N m]

    Returns:
        velocity at the end, means of the velocity, of (1 - u) times it and of its amount [rad/s], and with
        viscous friction the mean of its square [rad2/s2]

    >>> parted_motion(Motor(0.0, 0.0, 0, [], []), 3.0, 0.0, 0.0, 3.0, 2.0, 0.0, 4.0)[:4]  # stops after 1.5 s
    (0.0, 0.75, 0.625, 0.75)
    """
    now = velocity
    low = 0.0
    mean = 0.0
    second = 0.0
    path = 0.0
    square = 0.0
    for count in range(MOST_PARTS):
        torque, _fall, _below, _above = line_at(motor, now, 0.0, True)
        here = torque - viscous * now - load - rise * low
        sense = sense_of(now, here, friction)
        net = here - sense * friction
        if sense == 0.0:
            if rise == 0.0:
                break
            sense = -1.0 if rise > 0.0 else 1.0
            low = low + (friction - sense * here) / fabs(rise)
            if low >= 1.0:
                break
            net = 0.0  # to the bit: what rounding leaves would hold the shaft again
        _torque, fall, below, above = line_at(motor, now, 0.0, net > 0.0 or (net == 0.0 and rise < 0.0))
        if friction > 0.0 and sense > 0.0 and below < 0.0:
            below = 0.0
        if friction > 0.0 and sense < 0.0 and above > 0.0:
            above = 0.0
        steady = net == 0.0 and rise == 0.0
        slope = 0.0 if steady else fall + viscous
        part = 1.0 - low
        if fall < 0.0 and fabs(slope) * duration * part > MOST_GROWTH * inertia:
            part = MOST_GROWTH * inertia / (fabs(slope) * duration)
        share = 1.0
        end = now
        if count < MOST_PARTS - 1 and below > -inf:
            share = stopping_share(now - below, net, rise * part, duration * part, inertia, slope, 1.0)
            end = below
        if count < MOST_PARTS - 1 and above < inf:
            sooner = stopping_share(now - above, net, rise * part, duration * part, inertia, slope, -1.0)
            if sooner < share:
                share = sooner
                end = above
        part = part * share
        by = response(duration * part, inertia, slope)
        gained, more, by_second, _third = driven_motion(now, net, rise * part, 0.0, by)
        low = low + part
        mean = mean + part * (now + more)
        second = second + part * ((1.0 - low) * (now + more) + part * by_second)
        path = path + part * fabs(now + more)
        if viscous > 0.0:
            square = square + part * mean_square(
                now, net, rise * part, duration * part, inertia, slope, fall >= 0.0 and not steady
            )
        now = end if share < 1.0 else now + gained
        if low >= 1.0:
            break
    return now, mean, second, path, square
