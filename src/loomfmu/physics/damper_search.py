"""Changes of contact of the heald carrier along a piece of its motion, and turns of its load.

A piece is short against the carrier's own motion, `sqrt(k) t + c t` up to 0.5, but not against that of its
frame: within it a load may turn round four times, a contact begin and end again. See `damper.propagate`.
"""

from dataclasses import dataclass
from math import fabs, sqrt

from .damper import Swing, drive_at, propagate
from .numerics.brackets import at_root

# Followed along a piece: a gauge, linear in position and rate, or the first derivative of one
LEVEL = 0
SLOPE = 1
# Share of a piece by which a search for a change of sign moves on at least. Between two changes that close
# a gauge moves by less than its rounding.
LEAST_STRIDE = 1e-8
MOST_STRIDES = 1000


@dataclass(frozen=True)
class Gauge:
    """A gauge `q (z - p) + r z'` (LEVEL), or a slope, `q z' + r z'' - p - p1 t - p2 t^2` (SLOPE).

    p, p1, p2 are the levels, q and r by what position and rate count.
    """

    order: int
    level: float
    level_1: float
    level_2: float
    by_position: float
    by_rate: float


def rate_bounds(swing: Swing, duration: float) -> tuple[float, float, float]:
    """Bounds of acceleration, jerk and the jerk's rate over a piece of a motion.

    With a the acceleration and j the jerk, `j' = u'' - c j - k a`, where a and j are bounded by their start
    values and by the bound S of j' itself: `S (1 - c t - k t^2 / 2) <= max |u''| + (c + k t) |j0| + k |a0|`.

    Args:
        swing: with `sqrt(k) t + c t` up to 0.5
        duration: t [s]

    >>> rate_bounds(Swing(0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 3.0, 0.0), 2.0)  # z'' = 1 + 3 t^2
    (13.0, 12.0, 6.0)
    """
    stiffness = swing.stiffness
    damping = swing.damping
    acceleration = swing.drive - stiffness * swing.position - damping * swing.rate
    jerk = swing.drive_1 - stiffness * swing.rate - damping * acceleration
    bend = 2.0 * fabs(swing.drive_2) + 6.0 * duration * fabs(swing.drive_3)
    fed = (damping + stiffness * duration) * fabs(jerk) + stiffness * fabs(acceleration)
    snap = (bend + fed) / (1.0 - duration * (damping + 0.5 * stiffness * duration))
    largest_jerk = fabs(jerk) + duration * snap
    return fabs(acceleration) + duration * (fabs(jerk) + 0.5 * duration * snap), largest_jerk, snap


def gauge_at(gauge: Gauge, swing: Swing, time: float) -> tuple[float, float]:
    """Value and derivative of a gauge at a time since the start [s].

    >>> still = Swing(1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    >>> gauge_at(Gauge(LEVEL, 0.25, 0.0, 0.0, 2.0, 0.0), still, 0.0)
    (1.5, 1.0)
    """
    z, v = propagate(swing, time)
    by_position = gauge.by_position
    by_rate = gauge.by_rate
    a = drive_at(swing, time) - swing.stiffness * z - swing.damping * v
    if gauge.order == LEVEL:
        return by_position * (z - gauge.level) + by_rate * v, by_position * v + by_rate * a
    jerk = swing.drive_1 + time * (2.0 * swing.drive_2 + 3.0 * time * swing.drive_3)
    jerk = jerk - swing.stiffness * v - swing.damping * a
    return (
        by_position * v + by_rate * a - (gauge.level + time * (gauge.level_1 + time * gauge.level_2)),
        by_position * a + by_rate * jerk - (gauge.level_1 + 2.0 * time * gauge.level_2),
    )


def larger(one: float, other: float) -> float:
    """The larger size of two.

    >>> larger(1.0, -2.0)
    2.0
    """
    return fabs(one) if fabs(one) > fabs(other) else fabs(other)


def safe_stride(value: float, slope: float, bend: float) -> float:
    """The longest time for which `value + slope t + bend t^2 / 2` stays below 0, however it bends within.

    It is 1e300 if that never gets there.

    Args:
        value: up to 0
        slope: its first derivative
        bend: bound of its second one, not negative

    >>> safe_stride(-2.0, 0.0, 1.0), safe_stride(0.0, -1.0, 1.0), safe_stride(-1.0, 0.0, 0.0)
    (2.0, 2.0, 1e+300)
    """
    root = sqrt(slope * slope - 2.0 * bend * value)
    if slope > 0.0:
        return -2.0 * value / (slope + root)
    if root - slope >= 1e300 * bend:
        return 1e300
    return (root - slope) / bend


def first_change(
    gauge: Gauge, swing: Swing, sign: float, bend: float, start: float, duration: float
) -> float:
    """Time [s] at which a gauge first leaves a sign, beyond the zero, to rounding; -1 if it keeps its sign.

    Goes from stride to stride, each so short that no zero can lie within it, whatever the motion: so two
    changes close together are not missed as they are where the ends of a piece alone are compared.

    Args:
        gauge, swing: what is followed, and the motion
        sign: -1 or 1, what it leaves
        bend: bound of the second derivative of what is followed, up to the end
        start, duration: from and to these times [s]

    >>> # the lower of two zeros of 0.02 - t (0.3 - t), where both ends are positive
    >>> motion = Swing(0.02, -0.3, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0)
    >>> t = first_change(Gauge(LEVEL, 0.0, 0.0, 0.0, 1.0, 0.0), motion, 1.0, 2.0, 0.0, 1.0)
    >>> round(t, 12)
    0.1
    """
    low = start
    at_low, slope = gauge_at(gauge, swing, low)
    if sign * at_low < 0.0:
        return low
    for n in range(MOST_STRIDES):
        rest = duration - low
        stride = safe_stride(-sign * at_low, -sign * slope, bend)
        if rest <= 0.0 or stride >= rest:
            return -1.0
        if stride < LEAST_STRIDE * duration:
            stride = LEAST_STRIDE * duration
        high = low + stride
        # on the way to its zero all along, or noise that no stride gets away from
        if -sign * slope >= bend * rest or high > duration or n == MOST_STRIDES - 1:
            high = duration
        at_high, slope = gauge_at(gauge, swing, high)
        if sign * at_high < 0.0:
            return locate(gauge, swing, low, high, at_low, at_high)
        low = high
        at_low = at_high
    return -1.0


def locate(gauge: Gauge, swing: Swing, low: float, high: float, at_low: float, at_high: float) -> float:
    """Time at which a gauge changes its sign in a bracket [s].

    Illinois regula falsi on the exact solution; returns the end of the bracket on the far side of the
    zero, so that a caller that goes there has the change behind it.

    Args:
        gauge, swing: what is followed, and the motion
        low, high, at_low, at_high: the bracket [s] and the values at its ends, of different signs
    """
    width = 1e-15 * high
    last = 0
    for _ in range(100):
        if high - low <= width or at_high == 0.0:
            break
        t = high - at_high * (high - low) / (at_high - at_low)
        if t <= low or t >= high:
            t = 0.5 * (low + high)
        value, _slope = gauge_at(gauge, swing, t)
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
    value, slope = gauge_at(gauge, swing, high)
    return at_root(high, value, slope)


@dataclass(frozen=True)
class Stop:
    """The stops of a carrier: free way to either side [m], stiffness [N/m] and damping [N s/m] of one."""

    travel: float
    stiffness: float
    damping: float


def contact_change(
    contact: int, stop: Stop, swing: Swing, most_acceleration: float, most_jerk: float, duration: float
) -> tuple[float, int]:
    """Time at which the carrier's contact with a stop first changes, and the contact that follows.

    Args:
        contact: 0 free; 1 or -1 pressing on the upper or lower stop; 2 or -2 let go by a stop that it
            has not left yet (the stop's dashpot would have to pull)
        stop, swing: the stops, and the motion of the carrier
        most_acceleration, most_jerk: from `rate_bounds`
        duration: how far to look [s]

    Returns:
        time [s] and next contact, or the duration and the same contact if nothing changes
    """
    side = -1.0 if contact < 0 else 1.0
    # two gauges, negative until the contact changes; of a free carrier its ways beyond either stop
    level = side * stop.travel
    by_position = side
    by_rate = 0.0
    then = 1
    other_level = -stop.travel
    other_then = -1
    if contact != 0:
        # one let go is pressed again, or leaves
        by_position = side * stop.stiffness
        by_rate = side * stop.damping
        then = 1 if contact > 0 else -1
        other_level = level
        other_then = 0
    if contact == then:
        by_position = -by_position
        by_rate = -by_rate
        then = 2 * contact
    gauge = Gauge(LEVEL, level, 0.0, 0.0, by_position, by_rate)
    bend = fabs(by_position) * most_acceleration + fabs(by_rate) * most_jerk
    time = first_change(gauge, swing, -1.0, bend, 0.0, duration)
    if time < 0.0:
        time = duration
        then = contact
    if contact == 1 or contact == -1:
        return time, then
    gauge = Gauge(LEVEL, other_level, 0.0, 0.0, -side, 0.0)
    other = first_change(gauge, swing, -1.0, most_acceleration, 0.0, time)
    if other < 0.0:
        return time, then
    return other, other_then


def next_turn(gauge: Gauge, swing: Swing, bend: float, start: float, duration: float) -> float:
    """Time at which a slope next passes zero; -1 if it does not.

    Args:
        gauge, swing: the slope, and the motion
        bend: bound of its second derivative up to the end
        start, duration: from and to these times [s]

    >>> falls = Swing(0.0, 0.3, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0)
    >>> round(next_turn(Gauge(SLOPE, 0.0, 0.0, 0.0, 1.0, 0.0), falls, 1.0, 0.0, 1.0), 12)
    0.3
    """
    value, slope = gauge_at(gauge, swing, start)
    sign = 1.0 if value > 0.0 or (value == 0.0 and slope > 0.0) else -1.0
    return first_change(gauge, swing, sign, bend, start, duration)
