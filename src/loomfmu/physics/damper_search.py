"""Where along a piece of its motion the heald carrier changes contact, and where its load turns round.

A piece is short against the carrier's own motion, `sqrt(k) t + c t` up to 0.5, but not against that of its
frame: within it a load may turn round four times, a contact begin and end again. See `damper.propagate`.
"""

from math import fabs, sqrt

from .damper import propagate

# Followed along a piece: a gauge, linear in position and rate, or the first derivative of one
LEVEL = 0
SLOPE = 1
# Share of a piece by which a search for a change of sign moves on at least. Between two changes that close
# a gauge moves by less than its rounding.
LEAST_STRIDE = 1e-8
MOST_STRIDES = 1000


def rate_bounds(
    acceleration: float,
    jerk: float,
    stiffness: float,
    damping: float,
    drive_2: float,
    drive_3: float,
    duration: float,
) -> tuple[float, float, float]:
    """Bounds of acceleration, jerk and the jerk's rate over a piece of the motion that `propagate` gives.

    With a the acceleration and j the jerk, `j' = u'' - c j - k a`, where a and j are bounded by their start
    values and by the bound S of j' itself: `S (1 - c t - k t^2 / 2) <= max |u''| + (c + k t) |j0| + k |a0|`.

    Args:
        acceleration, jerk: a0 [m/s2] and j0 [m/s3]
        stiffness, damping: k [1/s2] and c [1/s]; `sqrt(k) t + c t` up to 0.5
        drive_2, drive_3: u2 [m/s4] and u3 [m/s5]
        duration: t [s]

    >>> rate_bounds(1.0, 0.0, 0.0, 0.0, 3.0, 0.0, 2.0)  # z'' = 1 + 3 t^2
    (13.0, 12.0, 6.0)
    """
    bend = 2.0 * fabs(drive_2) + 6.0 * duration * fabs(drive_3)
    fed = (damping + stiffness * duration) * fabs(jerk) + stiffness * fabs(acceleration)
    snap = (bend + fed) / (1.0 - duration * (damping + 0.5 * stiffness * duration))
    largest_jerk = fabs(jerk) + duration * snap
    return fabs(acceleration) + duration * (fabs(jerk) + 0.5 * duration * snap), largest_jerk, snap


def gauge_at(
    order: int,
    level: float,
    level_1: float,
    level_2: float,
    by_position: float,
    by_rate: float,
    position: float,
    rate: float,
    stiffness: float,
    damping: float,
    drive: float,
    drive_1: float,
    drive_2: float,
    drive_3: float,
    time: float,
) -> tuple[float, float]:
    """Value and derivative at a time of the gauge `q (z - p) + r z'`, or of its slope `q z' + r z'' - p`.

    Args:
        order: LEVEL for the gauge, SLOPE for its slope
        level, level_1, level_2: p; of a slope it is `p + p1 t + p2 t^2`
        by_position, by_rate: q and r
        position .. drive_3: as for `propagate`
        time: since the start [s]

    >>> gauge_at(LEVEL, 0.25, 0.0, 0.0, 2.0, 0.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    (1.5, 1.0)
    """
    z, v = propagate(position, rate, stiffness, damping, drive, drive_1, drive_2, drive_3, time)
    a = drive + time * (drive_1 + time * (drive_2 + time * drive_3)) - stiffness * z - damping * v
    if order == LEVEL:
        return by_position * (z - level) + by_rate * v, by_position * v + by_rate * a
    jerk = drive_1 + time * (2.0 * drive_2 + 3.0 * time * drive_3) - stiffness * v - damping * a
    return (
        by_position * v + by_rate * a - (level + time * (level_1 + time * level_2)),
        by_position * a + by_rate * jerk - (level_1 + 2.0 * time * level_2),
    )


def larger(one: float, other: float) -> float:
    """The larger size of two.

    >>> larger(1.0, -2.0)
    2.0
    """
    return fabs(one) if fabs(one) > fabs(other) else fabs(other)


def safe_stride(value: float, slope: float, bend: float) -> float:
    """The longest time for which `value + slope t + bend t^2 / 2` stays below 0, however it bends within.

    Args:
        value: up to 0
        slope: its first derivative
        bend: bound of its second one, not negative

    Returns:
        time, 1e300 if it never gets there

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
    order: int,
    level: float,
    level_1: float,
    level_2: float,
    by_position: float,
    by_rate: float,
    sign: float,
    bend: float,
    position: float,
    rate: float,
    stiffness: float,
    damping: float,
    drive: float,
    drive_1: float,
    drive_2: float,
    drive_3: float,
    start: float,
    duration: float,
) -> float:
    """Time at which a gauge, or its slope, first leaves a sign; on the far side of the zero, to rounding.

    Goes from stride to stride, each so short that no zero can lie within it, whatever the motion: so two
    changes close together are not missed as they are where the ends of a piece alone are compared.

    Args:
        order .. by_rate: as for `gauge_at`
        sign: -1 or 1, what it leaves
        bend: bound of the second derivative of what is followed, up to the end
        position .. drive_3: as for `propagate`
        start, duration: from and to these times [s]

    Returns:
        time [s], or -1 if it keeps its sign

    >>> # the lower of two zeros of 0.02 - t (0.3 - t), where both ends are positive
    >>> motion = (0.02, -0.3, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0)
    >>> t = first_change(LEVEL, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 2.0, *motion, 0.0, 1.0)
    >>> round(t, 12)
    0.1
    """
    low = start
    at_low, slope = gauge_at(
        order,
        level,
        level_1,
        level_2,
        by_position,
        by_rate,
        position,
        rate,
        stiffness,
        damping,
        drive,
        drive_1,
        drive_2,
        drive_3,
        low,
    )
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
        at_high, slope = gauge_at(
            order,
            level,
            level_1,
            level_2,
            by_position,
            by_rate,
            position,
            rate,
            stiffness,
            damping,
            drive,
            drive_1,
            drive_2,
            drive_3,
            high,
        )
        if sign * at_high < 0.0:
            return locate(
                order,
                level,
                level_1,
                level_2,
                by_position,
                by_rate,
                position,
                rate,
                stiffness,
                damping,
                drive,
                drive_1,
                drive_2,
                drive_3,
                low,
                high,
                at_low,
                at_high,
            )
        low = high
        at_low = at_high
    return -1.0


def locate(
    order: int,
    level: float,
    level_1: float,
    level_2: float,
    by_position: float,
    by_rate: float,
    position: float,
    rate: float,
    stiffness: float,
    damping: float,
    drive: float,
    drive_1: float,
    drive_2: float,
    drive_3: float,
    low: float,
    high: float,
    at_low: float,
    at_high: float,
) -> float:
    """Time at which a gauge, or its slope, changes its sign in a bracket.

    Illinois regula falsi on the exact solution; returns the end of the bracket on the far side of the
    zero, so that a caller that goes there has the change behind it.

    Args:
        order .. drive_3: as for `gauge_at`
        low, high, at_low, at_high: the bracket [s] and the values at its ends, of different signs

    Returns:
        time [s]
    """
    width = 1e-15 * high
    last = 0
    for _ in range(100):
        if high - low <= width or at_high == 0.0:
            break
        t = high - at_high * (high - low) / (at_high - at_low)
        if t <= low or t >= high:
            t = 0.5 * (low + high)
        value, _slope = gauge_at(
            order,
            level,
            level_1,
            level_2,
            by_position,
            by_rate,
            position,
            rate,
            stiffness,
            damping,
            drive,
            drive_1,
            drive_2,
            drive_3,
            t,
        )
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


def contact_change(
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
    most_acceleration: float,
    most_jerk: float,
    duration: float,
) -> tuple[float, int]:
    """When the carrier's contact with a stop first changes, and the contact that follows.

    Args:
        contact: 0 free; 1 or -1 pressing on the upper or lower stop; 2 or -2 let go by a stop that it
            has not left yet (the stop's dashpot would have to pull)
        position .. drive_3: as for `propagate`
        travel: free way to either side [m]
        stop_stiffness, stop_damping: of a stop [N/m, N s/m]
        most_acceleration, most_jerk: from `rate_bounds`
        duration: how far to look [s]

    Returns:
        time [s] and next contact, or the duration and the same contact if nothing changes
    """
    side = -1.0 if contact < 0 else 1.0
    # two gauges, negative until the contact changes; of a free carrier its ways beyond either stop
    level = side * travel
    by_position = side
    by_rate = 0.0
    then = 1
    other_level = -travel
    other_then = -1
    if contact != 0:
        # one let go is pressed again, or leaves
        by_position = side * stop_stiffness
        by_rate = side * stop_damping
        then = 1 if contact > 0 else -1
        other_level = level
        other_then = 0
    if contact == then:
        by_position = -by_position
        by_rate = -by_rate
        then = 2 * contact
    time = first_change(
        LEVEL,
        level,
        0.0,
        0.0,
        by_position,
        by_rate,
        -1.0,
        fabs(by_position) * most_acceleration + fabs(by_rate) * most_jerk,
        position,
        rate,
        stiffness,
        damping,
        drive,
        drive_1,
        drive_2,
        drive_3,
        0.0,
        duration,
    )
    if time < 0.0:
        time = duration
        then = contact
    if contact == 1 or contact == -1:
        return time, then
    other = first_change(
        LEVEL,
        other_level,
        0.0,
        0.0,
        -side,
        0.0,
        -1.0,
        most_acceleration,
        position,
        rate,
        stiffness,
        damping,
        drive,
        drive_1,
        drive_2,
        drive_3,
        0.0,
        time,
    )
    if other < 0.0:
        return time, then
    return other, other_then


def next_turn(
    offset: float,
    offset_1: float,
    offset_2: float,
    by_position: float,
    by_rate: float,
    bend: float,
    position: float,
    rate: float,
    stiffness: float,
    damping: float,
    drive: float,
    drive_1: float,
    drive_2: float,
    drive_3: float,
    start: float,
    duration: float,
) -> float:
    """Time at which the gauge `q z + r z' - p t - p1 t^2 / 2 - p2 t^3 / 3` next turns; -1 if it does not.

    Args:
        offset, offset_1, offset_2, by_position, by_rate: p, p1, p2, q and r
        bend: bound of the third derivative of the gauge up to the end
        position .. drive_3: as for `propagate`
        start, duration: from and to these times [s]

    >>> round(next_turn(0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.3, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0), 12)
    0.3
    """
    value, slope = gauge_at(
        SLOPE,
        offset,
        offset_1,
        offset_2,
        by_position,
        by_rate,
        position,
        rate,
        stiffness,
        damping,
        drive,
        drive_1,
        drive_2,
        drive_3,
        start,
    )
    sign = 1.0 if value > 0.0 or (value == 0.0 and slope > 0.0) else -1.0
    return first_change(
        SLOPE,
        offset,
        offset_1,
        offset_2,
        by_position,
        by_rate,
        sign,
        bend,
        position,
        rate,
        stiffness,
        damping,
        drive,
        drive_1,
        drive_2,
        drive_3,
        start,
        duration,
    )
