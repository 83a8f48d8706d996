"""The weft yarn between two samples of its inputs, by the share u of the way: brake, motion and tension.

Head and shaft run on the quintics that join the samples. The way is divided where the shaft passes a point of
the brake's program, since its second derivative jumps there; on each part the limit at which the brake lets
yarn through runs on a cubic that has its value and rate at both ends.
"""

from dataclasses import dataclass
from math import fabs, floor, pi

from .hung_warp import cubic_between
from .numerics.brackets import at_root
from .shaft import FARTHEST
from .weft import along, drawing_limit, eased, moving_load, moving_load_rate, relaxed_force, stretch_force

PROGRAM_POINTS = 24  # of the brake, evenly spaced over a revolution
AT_POINT = 1e-9  # of the way between two points of the program: nearer to one the shaft is there
SHORTEST_YARN = 1e-3  # m: coarse steps of inputs that do not belong together may leave less
HALVINGS = 52  # of a part of the way: then a share is known to rounding
# what is looked for on the way: where the head turns round, where it takes or releases the weft, where the
# shaft passes a point of the brake's program
TURN = 0
PLACE = 1
POINT = 2
# and of the yarn: where the brake begins or ceases to let it through, where it is nearest to that, where the
# tension is zero, where it is highest or lowest
YIELD = 3
NEAREST = 4
SLACK = 5
PEAK = 6


@dataclass(frozen=True)
class Brake:
    """Brake and eyes: gain of all eyes, tension from the package [N], mass that it unwinds [kg/m].

    Mass of the yarn [kg/m], largest force of the brake [N], and its share of that at each point.
    """

    gain: float
    supply: float
    unwound: float
    density: float
    force: float
    program: list[float]


@dataclass(frozen=True)
class Way:
    """The way between two samples: travel and shaft angle by `quintic`, duration [s], angle at its end."""

    travel: list[float]
    angle: list[float]
    time: float
    end_angle: float


@dataclass(frozen=True)
class Part:
    """A part of the way: the share at which it starts, and the limit of the tension by the share from it."""

    start: float
    limit: list[float]


@dataclass(frozen=True)
class Yarn:
    """Yarn between brake and head: EA [N], mass [kg/m] and drag [kg/m2] per length, retardation time [s].

    On its way in or out, with the length [m] less the travel or with it, and its unstretched length [m].
    """

    stiffness: float
    density: float
    drag: float
    retardation: float
    inward: bool
    offset: float
    unstretched: float


@dataclass(frozen=True)
class Drawn:
    """Yarn on a part of the way, held by its brake or let through, with an elastic force [N] at a share."""

    yarn: Yarn
    way: Way
    part: Part
    passing: bool
    start: float
    force: float


def braking(brake: Brake, point: int, angle: float, speed: float) -> tuple[float, float]:
    """Force of the brake and its rate, between a point of the program and the next one."""
    share, slope = eased(
        brake.program[point % PROGRAM_POINTS],
        brake.program[(point + 1) % PROGRAM_POINTS],
        angle * PROGRAM_POINTS / (2.0 * pi) - point,
    )
    return brake.force * share, brake.force * slope * speed * PROGRAM_POINTS / (2.0 * pi)


def limit_for(
    brake: Brake, point: int, angle: float, speed: float, velocity: float, acceleration: float
) -> tuple[float, float]:
    """Limit of the tension behind the eyes and its rate, for a motion of shaft and head."""
    force, rate = braking(brake, point, angle, speed)
    return drawing_limit(
        brake.gain, brake.supply, brake.unwound, brake.density, force, rate, velocity, acceleration
    )


def place_at(way: Way, share: float) -> float:
    """Place of the shaft in the program at a share of the way, in points from 0 deg."""
    angle, _first, _second, _third = along(share, way.angle)
    if not fabs(angle) <= FARTHEST:  # inputs that do not belong together
        angle = way.end_angle
    return angle * PROGRAM_POINTS / (2.0 * pi)


def next_point(way: Way, low: float, high: float) -> tuple[bool, float]:
    """Return whether the shaft passes points of the program between two shares, and the first one."""
    start = place_at(way, low)
    end = place_at(way, high)
    sense = 1 if end > start else -1
    point = float(sense * (floor(sense * start + AT_POINT) + 1))
    return sense * (end - point) > AT_POINT, point


def part_of(brake: Brake, way: Way, low: float, high: float) -> Part:
    """The part between two shares of the way; no point of the program is between them."""
    point = floor(place_at(way, 0.5 * (low + high)))
    start, start_rate = limit_beside(brake, way, point, low)
    end, end_rate = limit_beside(brake, way, point, high)
    return Part(low, cubic_between(start, way.time * start_rate, end, way.time * end_rate, high - low))


def limit_beside(brake: Brake, way: Way, point: int, share: float) -> tuple[float, float]:
    """Limit and its rate at a share of the way, between a point of the program and the next one."""
    angle, turned, _second, _third = along(share, way.angle)
    _travel, first, second, _third = along(share, way.travel)
    h = way.time
    return limit_for(brake, point, angle, turned / h, first / h, second / (h * h))


def limit_at(part: Part, share: float) -> float:
    """Limit of the tension behind the eyes at a share of the way [N]."""
    u = share - part.start
    return part.limit[0] + u * (part.limit[1] + u * (part.limit[2] + u * part.limit[3]))


def limit_rate_at(part: Part, share: float) -> float:
    """Derivative of `limit_at` by the share."""
    u = share - part.start
    return part.limit[1] + u * (2.0 * part.limit[2] + 3.0 * u * part.limit[3])


def length_at(yarn: Yarn, travel: float) -> float:
    """Length of yarn with the head at a travel: the taker draws on while its travel shrinks [m]."""
    length = yarn.offset + travel if yarn.inward else yarn.offset - travel
    return length if length > SHORTEST_YARN else SHORTEST_YARN


def travel_at(way: Way, share: float) -> float:
    """Travel at a share of the way [m]."""
    value, _first, _second, _third = along(share, way.travel)
    return value


def velocity_at(way: Way, share: float) -> float:
    """Velocity of the head at a share of the way, times the duration of the way [m]."""
    _value, first, _second, _third = along(share, way.travel)
    return first


def motion_at(drawn: Drawn, share: float) -> tuple[float, float, float, float]:
    """Length of yarn at a share of the way, with the speed, acceleration and jerk of the yarn."""
    value, first, second, third = along(share, drawn.way.travel)
    h = drawn.way.time if drawn.yarn.inward else -drawn.way.time
    return length_at(drawn.yarn, value), first / h, second / (h * fabs(h)), third / (h * h * h)


def force_at(drawn: Drawn, share: float) -> float:
    """Elastic force at a share of the way [N]."""
    yarn = drawn.yarn
    part = drawn.part
    if drawn.passing:
        decay = drawn.way.time / yarn.retardation
        return relaxed_force(drawn.force, decay, drawn.start - part.start, share - part.start, part.limit)
    return stretch_force(yarn.stiffness, length_at(yarn, travel_at(drawn.way, share)), yarn.unstretched)


def surplus_at(drawn: Drawn, share: float) -> float:
    """By how much the tension of yarn that is held exceeds the limit: positive while the brake yields [N]."""
    yarn = drawn.yarn
    here = force_at(drawn, share)
    length, speed, _acceleration, _jerk = motion_at(drawn, share)
    viscous = yarn.retardation * (yarn.stiffness + here) * speed / length
    return here + viscous - limit_at(drawn.part, share)


def surplus_rate_at(drawn: Drawn, share: float) -> float:
    """Derivative of `surplus_at` by the share."""
    yarn = drawn.yarn
    here = force_at(drawn, share)
    length, speed, acceleration, _jerk = motion_at(drawn, share)
    tau = yarn.retardation
    stretched = (yarn.stiffness + here) * speed / length
    change = (limit_at(drawn.part, share) - here) / tau if drawn.passing else stretched
    viscous = (change * speed + (yarn.stiffness + here) * acceleration - stretched * speed) / length
    return drawn.way.time * (change + tau * viscous) - limit_rate_at(drawn.part, share)


def tension_at(drawn: Drawn, share: float) -> float:
    """Tension at the head at a share of the way, negative where the yarn runs ahead of it [N]."""
    yarn = drawn.yarn
    length, speed, acceleration, _jerk = motion_at(drawn, share)
    load = moving_load(length, speed, acceleration, yarn.density, yarn.drag)
    if drawn.passing:
        return limit_at(drawn.part, share) + load
    viscous = yarn.retardation * yarn.stiffness * speed / yarn.unstretched
    return stretch_force(yarn.stiffness, length, yarn.unstretched) + viscous + load


def tension_rate_at(drawn: Drawn, share: float) -> float:
    """Derivative of `tension_at` by the share."""
    yarn = drawn.yarn
    length, speed, acceleration, jerk = motion_at(drawn, share)
    h = drawn.way.time
    load = h * moving_load_rate(length, speed, acceleration, jerk, yarn.density, yarn.drag)
    if drawn.passing:
        return limit_rate_at(drawn.part, share) + load
    stretch = h * (speed + yarn.retardation * acceleration) / yarn.unstretched
    return yarn.stiffness * stretch + load


def passage(way: Way, kind: int, level: float, before: bool, low: float, high: float) -> float:
    """Share of the way between two others at which it passes a level; `before` it lies above."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if kind == POINT:
            value = place_at(way, middle)
        elif kind == PLACE:
            value = travel_at(way, middle)
        else:
            value = velocity_at(way, middle)
        if (value - level > 0.0) == before:
            low = middle
        else:
            high = middle
    _value, first, second, _third = along(high, way.travel)
    if kind == POINT:
        _angle, turning, _second, _third = along(high, way.angle)
        return at_root(high, place_at(way, high) - level, turning * PROGRAM_POINTS / (2.0 * pi))
    if kind == PLACE:
        return at_root(high, travel_at(way, high) - level, first)
    return at_root(high, first - level, second)


def crossing(drawn: Drawn, kind: int, before: bool, low: float, high: float) -> float:
    """Share of the way between two others at which something passes zero that is positive `before`."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if kind == YIELD:
            value = surplus_at(drawn, middle)
        elif kind == NEAREST:
            value = surplus_rate_at(drawn, middle)
        elif kind == SLACK:
            value = tension_at(drawn, middle)
        else:
            value = tension_rate_at(drawn, middle)
        if (value > 0.0) == before:
            low = middle
        else:
            high = middle
    if kind == YIELD:
        return at_root(high, surplus_at(drawn, high), surplus_rate_at(drawn, high))
    if kind == SLACK:
        return at_root(high, tension_at(drawn, high), tension_rate_at(drawn, high))
    return high


def change_over(drawn: Drawn, high: float) -> float:
    """Share at which the brake first changes between holding and letting through on a part, or its end."""
    start = drawn.start
    passing = drawn.passing
    if (surplus_at(drawn, high) > 0.0) != passing:
        return crossing(drawn, YIELD, passing, start, high)
    at_start = surplus_rate_at(drawn, start)
    at_high = surplus_rate_at(drawn, high)
    if (at_start < 0.0 and at_high > 0.0) if passing else (at_start > 0.0 and at_high < 0.0):
        nearest = crossing(drawn, NEAREST, not passing, start, high)
        if (surplus_at(drawn, nearest) > 0.0) != passing:
            return crossing(drawn, YIELD, passing, start, nearest)
    return high
