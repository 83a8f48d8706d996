"""A step of the belt's modes by Gauss's method of order 6, whose stages are found by repetition."""

from dataclasses import dataclass
from math import fabs, pi

from .belt_ends import OTHER, OWN, FreeEnds, at_ends
from .belt_modes import size
from .belt_motion import accelerations, energy_and_powers
from .belt_moving import Belt, Instant, Path, instant_at, length_at, pushed
from .numerics.gauss import FIRST, LAST, RATES, VALUES, at_stage, corrected, foreseen, held

MOST_REPEATS = 30  # of the sweep over the stages, until the accelerations of an integration step are settled
SETTLED = 1e-11  # of the modes: what a sweep may still change
SETTLED_ON_BOARD = 1e-8  # against a board, by which no step is balanced to more than 1e-6
GROWTH = 0.05  # of the free length in a step of the integration
MOST_STEPS = 50  # of the integration in one step, before they are halved
LARGEST_STEP = 5e-4  # s, of the integration


@dataclass(frozen=True)
class Stages:
    """The three stages of a step of the integration, and its duration [s]."""

    first: Instant
    second: Instant
    third: Instant
    duration: float


def pieces(duration: float) -> int:
    """Number of equal steps of the integration over a time."""
    if not duration > LARGEST_STEP:
        return 1
    if duration < MOST_STEPS * LARGEST_STEP:
        return 1 + int(duration / LARGEST_STEP * (1.0 - 1e-9))
    return MOST_STEPS


def suited(path: Path, share: float, end: float, size: float) -> float:
    """Share of the step over which the free length changes by a twentieth, or a given smaller one."""
    length = length_at(path, share)
    ahead = length_at(path, share + size if share + size < end else end)
    change = fabs(ahead - length)
    if ahead < length:
        length = ahead
    if change <= GROWTH * length:
        return size
    return size * GROWTH * length / change


def fits(path: Path, share: float, taken: float) -> bool:
    """Return whether the belt is longer than the shortest one at all stages of a step, and at its end."""
    near = length_at(path, share + FIRST * taken) > path.shortest
    near = near and length_at(path, share + 0.5 * taken) > path.shortest
    near = near and length_at(path, share + LAST * taken) > path.shortest
    return near and length_at(path, share + taken) > path.shortest


def stages_of(belt: Belt, path: Path, share: float, taken: float) -> Stages:
    """The stages of a step of the integration from a share of the step on."""
    return Stages(
        instant_at(belt, path, share + FIRST * taken),
        instant_at(belt, path, share + 0.5 * taken),
        instant_at(belt, path, share + LAST * taken),
        taken * path.duration,
    )


def foresee(
    belt: Belt, at: Instant, contact: int, longer: float, q: list[float], v: list[float], a: list[float]
) -> list[float]:
    """First accelerations of the stages: by those of the last step, so much shorter, or those now if 0."""
    if longer > 0.0:
        return foreseen(longer, a)
    now, _load = accelerations(belt, at, contact, q, v)
    return [now[n % 6] for n in range(18)]


def advance(
    belt: Belt,
    stages: Stages,
    contact: int,
    q: list[float],
    v: list[float],
    a: list[float],
    loads: list[float],
) -> tuple[bool, int]:
    """Find the accelerations of a step, and the compression at its stages.

    Args:
        a: accelerations at all stages, first as foreseen, then as found [m/s2]
        loads: get the compression at the stages [N]

    Returns:
        whether they settled, and the number of sweeps over the stages
    """
    step = stages.duration
    share = SETTLED if belt.board.side == 0.0 else SETTLED_ON_BOARD
    settled = share * (size(q) + step * size(v)) + 1e-30
    first = swept(stages.first)
    second = swept(stages.second)
    third = swept(stages.third)
    square = step * step
    load = pushed(belt, second.length, second.acceleration, second.tension)
    odd_yield = [0.0] * 9
    even_yield = [0.0] * 9
    if contact != 0 or belt.guided:
        odd_yield = yielding(belt, second, 1, load, square)
        even_yield = yielding(belt, second, 2, load, square)
    before = 1e300
    off = [0.0] * 18
    for repeat in range(MOST_REPEATS):
        loads[0] = miss(belt, first, contact, 0, step, q, v, a, off)
        loads[1] = miss(belt, second, contact, 1, step, q, v, a, off)
        loads[2] = miss(belt, third, contact, 2, step, q, v, a, off)
        change = correct(belt, second, contact, square, odd_yield, even_yield, off, a)
        if change <= settled:
            return True, repeat + 1
        if not change < 1e200 or (repeat > 4 and change > 0.8 * before):
            return False, repeat + 1
        before = change
    return False, MOST_REPEATS


def swept(at: Instant) -> Instant:
    """An instant as the sweeps take it: rates of its end shapes go through the relative length and back."""
    length = at.length
    square = length * length
    free = FreeEnds(
        at.ends.guide,
        at.ends.head,
        length * at.ends.guide_rate / length,
        length * at.ends.head_rate / length,
        square * at.ends.guide_second / square,
        square * at.ends.head_second / square,
    )
    return Instant(
        length, at.velocity, at.acceleration, at.tension, list(at.moments), list(at.by_length), free
    )


def miss(
    belt: Belt,
    at: Instant,
    contact: int,
    stage: int,
    step: float,
    q: list[float],
    v: list[float],
    a: list[float],
    off: list[float],
) -> float:
    """Put into `off` what the accelerations at a stage are off by; the compression at the head there [N]."""
    there, rates = at_stage(stage, step, q, v, a)
    found, load = accelerations(belt, at, contact, there, rates)
    for n in range(6):
        off[6 * stage + n] = found[n] - a[6 * stage + n]
    return load


def correct(
    belt: Belt,
    at: Instant,
    contact: int,
    square: float,
    odd_yield: list[float],
    even_yield: list[float],
    off: list[float],
    a: list[float],
) -> float:
    """Correct the accelerations of all stages for what they are off by; how far that moves the modes [m].

    Args:
        at, square: middle of the step, square of its duration [s2]
        odd_yield, even_yield: of `yielding`, where an end is clamped
        off: what the accelerations are off by, less then the share of the moments at the clamped ends [m/s2]
        a: accelerations [m/s2]
    """
    load = pushed(belt, at.length, at.acceleration, at.tension)
    if contact != 0 or belt.guided:
        hold_ends(belt, at, contact, square, odd_yield, even_yield, off)
    first, second, third = 0.0, 0.0, 0.0
    for n in range(6):
        c1, c2, c3 = corrected(square * stiff(belt, at, load, n + 1), [off[n], off[n + 6], off[n + 12]])
        a[n] = a[n] + c1
        a[n + 6] = a[n + 6] + c2
        a[n + 12] = a[n + 12] + c3
        first, second, third = first + fabs(c1), second + fabs(c2), third + fabs(c3)
    return square * (first + second + third)


def stiff(belt: Belt, at: Instant, load: float, number: int) -> float:
    """Square of the frequency of a mode, 0 for one that grows."""
    wave = number * pi / at.length
    square = wave * wave * (belt.stiffness * wave * wave - load) / belt.mass
    return square if square > 0.0 else 0.0


def hold_ends(
    belt: Belt,
    at: Instant,
    contact: int,
    square: float,
    odd_yield: list[float],
    even_yield: list[float],
    off: list[float],
) -> None:
    """Take from what the accelerations are off by the share of the moments at the clamped ends.

    They act on all modes at once: on odd and on even ones alike if one end is clamped, on either kind by
    itself if both are. Arguments as of `correct`.
    """
    load = pushed(belt, at.length, at.acceleration, at.tension)
    weight = 12.0 * square * belt.stiffness / (belt.mass * at.length * at.length * at.length * at.length)
    odd = slopes(belt, at, 1, load, square, off)
    even = slopes(belt, at, 2, load, square, off)
    if contact != 0 and belt.guided:
        odd = held(2.0 * weight / (OWN + OTHER), odd_yield, odd)
        even = held(2.0 * weight / (OWN - OTHER), even_yield, even)
    else:
        sign = -1.0 if contact != 0 else 1.0
        both_yield = [odd_yield[n] + even_yield[n] for n in range(9)]
        both = [even[n] + sign * odd[n] for n in range(3)]
        even = held(weight / OWN, both_yield, both)
        odd = [sign * even[n] for n in range(3)]
    for stage in range(3):
        moments = at_ends(-odd[stage], -even[stage])
        for n in range(6):
            off[6 * stage + n] = off[6 * stage + n] + moments[n] if n < belt.modes else 0.0


def yielding(belt: Belt, at: Instant, kind: int, load: float, square: float) -> list[float]:
    """Yield of the end slopes of odd modes (kind 1) or even ones (2) to moments at the stages."""
    y = [0.0] * 9
    for number in range(kind, belt.modes + 1, 2):
        wave = number * pi
        z = square * stiff(belt, at, load, number)
        for column in range(3):
            c1, c2, c3 = corrected(z, [VALUES[column], VALUES[column + 3], VALUES[column + 6]])
            y[column] = y[column] + wave * wave * c1
            y[column + 3] = y[column + 3] + wave * wave * c2
            y[column + 6] = y[column + 6] + wave * wave * c3
    return y


def slopes(belt: Belt, at: Instant, kind: int, load: float, square: float, off: list[float]) -> list[float]:
    """Yield of the end slopes of the modes of a kind to what accelerations are off by, see `yielding`."""
    s1, s2, s3 = 0.0, 0.0, 0.0
    for number in range(kind, belt.modes + 1, 2):
        wave = number * pi
        z = square * stiff(belt, at, load, number)
        c1, c2, c3 = corrected(z, [off[number - 1], off[number + 5], off[number + 11]])
        s1, s2, s3 = s1 + wave * c1, s2 + wave * c2, s3 + wave * c3
    return [VALUES[3 * n] * s1 + VALUES[3 * n + 1] * s2 + VALUES[3 * n + 2] * s3 for n in range(3)]


def worked(
    belt: Belt,
    stages: Stages,
    contact: int,
    q: list[float],
    v: list[float],
    a: list[float],
    loads: list[float],
) -> list[float]:
    """Work of an integration step by Gauss's quadrature at its stages [J].

    Of the compression, at the guide, lost by damping, and the sum of all, each positive.
    """
    work = [0.0] * 4
    add_work(belt, stages.first, contact, 0, stages.duration, q, v, a, loads, work)
    add_work(belt, stages.second, contact, 1, stages.duration, q, v, a, loads, work)
    add_work(belt, stages.third, contact, 2, stages.duration, q, v, a, loads, work)
    return work


def add_work(
    belt: Belt,
    at: Instant,
    contact: int,
    stage: int,
    step: float,
    q: list[float],
    v: list[float],
    a: list[float],
    loads: list[float],
    work: list[float],
) -> None:
    """Add the work of all powers at a stage, by its weight in the step."""
    there, rates = at_stage(stage, step, q, v, a)
    second = [a[6 * stage + n] for n in range(6)]
    _energy, push, guide, loss = energy_and_powers(belt, at, contact, there, rates, second, loads[stage])
    time = RATES[9 + stage] * step
    work[0] = work[0] + time * push
    work[1] = work[1] + time * guide
    work[2] = work[2] + time * loss
    work[3] = work[3] + time * (fabs(push) + fabs(guide) + fabs(loss))
