"""A driven shaft with dry friction, between whose stops, holds and releases the motion is exact.

Dry friction `R` opposes motion, and at rest holds against any torque up to `R`. While the shaft turns one way
it is a constant load, for which `driven_motion` is exact. A load on a straight line makes the net torque
`a + b exp(-z u)` between two such events, which is zero once at most: the velocity turns at most once there,
so no stop is missed, and after its release the shaft does not stop again in the same step.
"""

from math import fabs

from .driven_shaft import driven_motion
from .numerics.brackets import at_root

HALVINGS = 52  # of a part of the step: then its share is known to rounding
MOST_PARTS = 3  # of a step: turning, held and turning on, and what rounding may leave


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
    gained, _more, _second, _third = driven_motion(velocity, net, rise, 0.0, duration, inertia, slope)
    high = 1.0
    if sense * (velocity + gained) > 0.0:
        if not (sense * net < 0.0 and sense * (net - rise - slope * gained) > 0.0):
            return 1.0
        low = 0.0
        for _ in range(HALVINGS):  # where the velocity turns
            u = 0.5 * (low + high)
            gained, _more, _second, _third = driven_motion(
                velocity, net, rise * u, 0.0, duration * u, inertia, slope
            )
            if sense * (net - rise * u - slope * gained) < 0.0:
                low = u
            else:
                high = u
        gained, _more, _second, _third = driven_motion(
            velocity, net, rise * high, 0.0, duration * high, inertia, slope
        )
        if sense * (velocity + gained) > 0.0:
            return 1.0
    low = 0.0
    for _ in range(HALVINGS):
        u = 0.5 * (low + high)
        gained, _more, _second, _third = driven_motion(
            velocity, net, rise * u, 0.0, duration * u, inertia, slope
        )
        if sense * (velocity + gained) > 0.0:
            low = u
        else:
            high = u
    gained, _more, _second, _third = driven_motion(
        velocity, net, rise * high, 0.0, duration * high, inertia, slope
    )
    rate = duration * (net - rise * high - slope * gained) / inertia
    return at_root(high, velocity + gained, rate)


def opposed_motion(
    velocity: float,
    free: float,
    rise: float,
    duration: float,
    inertia: float,
    slope: float,
    friction: float,
) -> tuple[float, float, float, float]:
    """Motion over a step with dry friction, through stops and releases.

    Args:
        free: net torque without dry friction at the start [N m]
        rise: of the load over the step, on a straight line [N m]
        slope: of motor and viscous friction together [N m s/rad], not negative

    Returns:
        velocity at the end, means of the velocity, of (1 - u) times it and of its amount [rad/s]

    >>> opposed_motion(3.0, 0.0, 0.0, 3.0, 2.0, 0.0, 4.0)  # stops after 1.5 s, and stays
    (0.0, 0.75, 0.625, 0.75)
    """
    now = velocity
    sense = sense_of(now, free, friction)
    low = 0.0
    mean = 0.0
    second = 0.0
    path = 0.0
    for count in range(MOST_PARTS):
        left = 1.0 - low
        here = free - rise * low - slope * (now - velocity)
        net = here - sense * friction
        if sense == 0.0:
            if rise == 0.0:
                break
            sense = -1.0 if rise > 0.0 else 1.0
            low = low + (friction - sense * here) / fabs(rise)
            if low >= 1.0:
                break
            left = 1.0 - low
            net = 0.0  # to the bit: what rounding leaves would hold the shaft again
        share = 1.0
        if count < MOST_PARTS - 1:
            share = stopping_share(now, net, rise * left, duration * left, inertia, slope, sense)
        part = left * share
        gained, more, by_second, _third = driven_motion(
            now, net, rise * part, 0.0, duration * part, inertia, slope
        )
        low = low + part
        mean = mean + part * (now + more)
        second = second + part * ((1.0 - low) * (now + more) + part * by_second)
        path = path + part * fabs(now + more)
        now = now + gained
        if share >= 1.0:
            break
        now = 0.0
        sense = sense_of(now, free - rise * low + slope * velocity, friction)
    return now, mean, second, path
