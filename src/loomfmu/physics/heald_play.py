"""Heald in the play between its loops and the bars: flights between blows, rests on a bar.

Source: Korolev, thesis on rotary dobbies (Moscow), section 5.1, which describes the blows and counts them,
but gives no equation: the model is our own. A heald of mass m is free over `play` between the lower and the
upper bar of its carrier; w is its displacement there, a the acceleration of the bars, f the pull of its
thread:

    w'' = f / m - g - a,   |w| <= play / 2;   a blow returns it with `restitution` of its speed

Between two samples a is a cubic and f a straight line, so w is a quintic in time, and no contact is missed.
"""

from math import fabs

from .damper_search import safe_stride
from .numerics.brackets import at_root
from .numerics.motion import moved_on

MOST_STRIDES = 1000
LEAST_STRIDE = 1e-12  # of the time to look: from a bar at rest no bound shows how far is safe
REACHED = 1e-12  # of the play: as far from a bar as that, the heald is there


def clear_stride(beyond: float, rate: float, acceleration: float, most: float, most_jerk: float) -> float:
    """A time for which a heald stays clear of a bar that it is on, or short of.

    Either by the largest acceleration, or by the time for which it still accelerates away from the bar: a
    heald leaves a bar from rest, at first with no acceleration at all.

    Args:
        beyond: of the heald beyond the bar, not positive [m]
        rate, acceleration: towards the bar [m/s, m/s2]
        most, most_jerk: bounds of the acceleration and of its rate

    >>> clear_stride(0.0, 0.0, -2.0, 8.0, 4.0), clear_stride(-4.0, 0.0, 8.0, 8.0, 4.0)
    (0.5, 1.0)
    """
    stride = safe_stride(beyond, rate, most)
    if acceleration < 0.0:
        straight = safe_stride(beyond, rate, 0.0)
        if straight * most_jerk > -acceleration:
            straight = -acceleration / most_jerk
        if straight > stride:
            return straight
    return stride


def until_bar(
    position: float, rate: float, q0: float, q1: float, q2: float, q3: float, reach: float, duration: float
) -> tuple[float, int]:
    """Return the time [s] at which a heald in flight first meets a bar, and which: 1 upper, -1 lower, 0 none.

    Goes from stride to stride, each so short that no bar can be met within it, however it moves.

    Args:
        position, rate: w and w' at the start [m, m/s]
        q0 .. q3: w'' as a cubic in time
        reach: of w to either side [m]
        duration: how far to look [s]

    >>> until_bar(-1.0, 2.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0), until_bar(0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0)
    ((1.0, 1), (2.0, 0))
    """
    most = fabs(q0) + duration * (fabs(q1) + duration * (fabs(q2) + duration * fabs(q3)))
    most_jerk = fabs(q1) + duration * (2.0 * fabs(q2) + duration * 3.0 * fabs(q3))
    time = 0.0
    for _ in range(MOST_STRIDES):
        w, v, acceleration = moved_on(position, rate, q0, q1, q2, q3, time)
        above = w - reach
        below = -w - reach
        if above >= -REACHED * reach and v > 0.0:
            return at_root(time, above, v) if time > 0.0 else time, 1
        if below >= -REACHED * reach and v < 0.0:
            return at_root(time, below, -v) if time > 0.0 else time, -1
        up = clear_stride(above if above < 0.0 else 0.0, v, acceleration, most, most_jerk)
        down = clear_stride(below if below < 0.0 else 0.0, -v, -acceleration, most, most_jerk)
        stride = up if up < down else down
        if stride >= duration - time:
            return duration, 0
        time = time + (stride if stride > LEAST_STRIDE * duration else LEAST_STRIDE * duration)
    return time, 0


def until_free(side: int, q0: float, q1: float, q2: float, q3: float, duration: float) -> float:
    """Return the time at which a heald on a bar leaves it, as `side w''` turns negative, or the duration.

    >>> round(until_free(1, 1.0, -2.0, 0.0, 0.0, 3.0), 12), until_free(-1, -1.0, 0.0, 0.0, 0.0, 3.0)
    (0.5, 3.0)
    """
    most = 2.0 * fabs(q2) + 6.0 * duration * fabs(q3)
    time = 0.0
    for _ in range(MOST_STRIDES):
        press = side * (q0 + time * (q1 + time * (q2 + time * q3)))
        slope = side * (q1 + time * (2.0 * q2 + time * 3.0 * q3))
        if (press <= 0.0 and slope < 0.0) or press < 0.0:
            return at_root(time, press, slope) if time > 0.0 else time
        stride = safe_stride(-press, -slope, most)
        if stride >= duration - time:
            return duration
        time = time + (stride if stride > LEAST_STRIDE * duration else LEAST_STRIDE * duration)
    return duration


def distance(
    position: float, rate: float, q0: float, q1: float, q2: float, q3: float, duration: float
) -> float:
    """Way that a heald covers in a flight, back and forth; one turn at most in it is seen [m].

    >>> distance(0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 2.0)
    1.0
    """
    end, end_rate, _q = moved_on(position, rate, q0, q1, q2, q3, duration)
    if rate * end_rate >= 0.0:
        return fabs(end - position)
    low = 0.0
    high = duration
    for _ in range(60):
        middle = 0.5 * (low + high)
        _w, v, _q = moved_on(position, rate, q0, q1, q2, q3, middle)
        if v * rate > 0.0:
            low = middle
        else:
            high = middle
    turn, _v, _q = moved_on(position, rate, q0, q1, q2, q3, high)
    return fabs(turn - position) + fabs(end - turn)
