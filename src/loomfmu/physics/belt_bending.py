"""Bending and shortening of an inextensible belt that is given by its modes and end shapes.

What is of second order in the slope is exact; the rest is summed over equal panels: exactly up to the fourth
order for products of the modes up to the 23rd.
"""

from dataclasses import dataclass
from math import cos, pi, sin, sqrt

from .belt_ends import CROSS, SQUARE, Ends, end_shape, moment_forces, turned_by
from .belt_modes import dot, harmonics, summed
from .belt_moving import Instant

PANELS = 12  # of the belt, between the places where its bending is summed
LEAST_SQUARE = 0.05  # of the cosine of the slope: beyond 77 degrees the belt counts as folded


def _harmonics() -> tuple[float, ...]:
    """Cosines, then sines, of 1 to 6 times the angle of each place from the head to the middle."""
    cosine, sine = cos(pi / PANELS), sin(pi / PANELS)
    c1, s1 = 1.0, 0.0
    found: tuple[float, ...] = ()
    for _ in range(PANELS // 2 + 1):
        several = harmonics(c1, s1)
        found += (c1, *several[:5], s1, *several[5:])
        c1, s1 = c1 * cosine - s1 * sine, s1 * cosine + c1 * sine
    return found


HARMONICS = _harmonics()


@dataclass(frozen=True)
class Bending:
    """Bending and shortening of a belt.

    Bending moment on each mode over the stiffness, negative rate of the energy by q_n [1/m2]; rate of the
    shortening by q_n [1]; the shortening [m], its rate [m/s], its second rate without that by q_n'' [m/s2],
    its rate by L [1]; bending energy over the stiffness [1/m], its rate by L [1/m2]; force and pull as the
    first two, by the slope at a clamped guide times L.
    """

    moments: list[float]
    pulls: list[float]
    shortening: float
    rate: float
    second: float
    by_length: float
    energy: float
    energy_by_length: float
    force: float
    pull: float


@dataclass(frozen=True)
class Places:
    """Sums over the places of a belt of what its bending and shortening have beyond the second order.

    By the parts of the slope: by `cos(n pi x)`, and by the end shapes at guide and head.
    """

    forces: list[float]
    guide_force: float
    head_force: float
    pulls: list[float]
    guide_pull: float
    head_pull: float
    shortening: float
    rate: float
    second: float
    by_length: float
    energy: float
    energy_by_length: float


def bent_belt(at: Instant, ends: Ends, q: list[float], v: list[float]) -> Bending:
    """Bending and shortening of an inextensible belt with the sine of its slope `u_X`.

    With s = u_X and c = sqrt(1 - s^2): curvature u_XX / c, shortening 1 - c. What is of second order in s is
    exact, in bending that of the modes alone: see `end_bending`. The rest is summed over places.
    """
    length = at.length
    over = 1.0 / length
    wave = pi * over
    drift = at.velocity * over
    growth = at.acceleration * over
    share = 1.0 / PANELS
    places = bent_places(over, drift, growth, ends, q, v)
    guide_pull = share * places.guide_pull + over * (SQUARE * ends.guide + CROSS * ends.head)
    head_pull = share * places.head_pull + over * (SQUARE * ends.head + CROSS * ends.guide)
    f, guide_force, head_force, force = by_modes(
        ends.clamped, -share, -share * places.guide_force, -share * places.head_force, places.forces
    )
    g, guide_pull, head_pull, pull = by_modes(ends.clamped, share, guide_pull, head_pull, places.pulls)
    # what is of second order in the slope
    stretch, working, spinning = end_shortening(wave / pi, ends)
    p = [0.5 * pi * (n + 1) * ((n + 1) * wave * q[n]) for n in range(6)]
    r = [(n + 1) * wave * ((n + 1) * -wave * p[n]) for n in range(6)]
    w = [(n + 1) * pi * v[n] for n in range(6)]
    stretch = stretch + 0.5 * dot(p, q)
    working = working + dot(p, v)
    spinning = spinning + 0.5 * wave / pi * dot(w, w)
    bent = -0.5 * dot(r, q)
    return Bending(
        summed(1.0, r, f),
        summed(1.0, p, g),
        stretch + length * share * places.shortening,
        working - drift * stretch + share * (length * places.rate + at.velocity * places.shortening),
        spinning
        - 2.0 * drift * working
        + (2.0 * drift * drift - growth) * stretch
        + share
        * (length * places.second + 2.0 * at.velocity * places.rate + at.acceleration * places.shortening)
        + guide_pull * ends.guide_second
        + head_pull * ends.head_second,
        share * places.by_length
        - over * stretch
        + guide_pull * ends.guide_by_length
        + head_pull * ends.head_by_length,
        bent + length * share * places.energy,
        share * places.energy_by_length
        - 3.0 * over * bent
        - guide_force * ends.guide_by_length
        - head_force * ends.head_by_length,
        force,
        pull,
    )


def bent_places(
    over: float, drift: float, growth: float, ends: Ends, q: list[float], v: list[float]
) -> Places:
    """Sum over the places of the belt, see `bent_belt`, with 1 / L, V / L and A / L."""
    wave = pi * over
    guide = ends.guide
    head = ends.head
    guide_rate = ends.guide_rate
    head_rate = ends.head_rate
    shape = end_shape(guide, head, q)
    a1, a2, a3, a4, a5, a6 = numbered(wave, shape)
    k1, k2, k3, k4, k5, k6 = numbered(-wave, [a1, a2, a3, a4, a5, a6])
    shape = end_shape(guide_rate, head_rate, v)
    b1, b2, b3, b4, b5, b6 = numbered(wave, shape)
    f1, f2, f3, f4, f5, f6 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    g1, g2, g3, g4, g5, g6 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    guide_force, head_force, guide_pull, head_pull = 0.0, 0.0, 0.0, 0.0
    shortening, rate, second, by_length, energy, energy_by_length = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for pair in range(PANELS // 2 + 1):
        x = pair * (1.0 / PANELS)
        y = 1.0 - x
        by_x = 3.0 * x * x - 1.0
        by_y = 3.0 * y * y - 1.0
        # x and its mirror image y have the same harmonics but for the signs of the even ones
        c1, c2, c3 = HARMONICS[12 * pair], HARMONICS[12 * pair + 1], HARMONICS[12 * pair + 2]
        c4, c5, c6 = HARMONICS[12 * pair + 3], HARMONICS[12 * pair + 4], HARMONICS[12 * pair + 5]
        s1, s2, s3 = HARMONICS[12 * pair + 6], HARMONICS[12 * pair + 7], HARMONICS[12 * pair + 8]
        s4, s5, s6 = HARMONICS[12 * pair + 9], HARMONICS[12 * pair + 10], HARMONICS[12 * pair + 11]
        odd = a1 * c1 + a3 * c3 + a5 * c5
        even = a2 * c2 + a4 * c4 + a6 * c6
        slope = even + odd + over * (guide * by_x - head * by_y)
        slope_2 = even - odd + over * (guide * by_y - head * by_x)
        odd = b1 * c1 + b3 * c3 + b5 * c5
        even = b2 * c2 + b4 * c4 + b6 * c6
        turning = even + odd + over * (guide_rate * by_x - head_rate * by_y) - drift * slope
        turning_2 = even - odd + over * (guide_rate * by_y - head_rate * by_x) - drift * slope_2
        odd = k1 * s1 + k3 * s3 + k5 * s5
        even = k2 * s2 + k4 * s4 + k6 * s6
        bend = odd + even + 6.0 * over * over * (guide * x + head * y)
        bend_2 = odd - even + 6.0 * over * over * (guide * y + head * x)
        weight = 0.5 if pair == 0 or 2 * pair == PANELS else 1.0
        tilt, moment, twist, short, spin = bent_place(weight, slope, turning, bend)
        tilt_2, moment_2, twist_2, short_2, spin_2 = bent_place(weight, slope_2, turning_2, bend_2)
        shortening = shortening + short + short_2
        rate = rate + tilt * turning + tilt_2 * turning_2
        second = second + spin - tilt * (2.0 * drift * turning + growth * slope)
        second = second + spin_2 - tilt_2 * (2.0 * drift * turning_2 + growth * slope_2)
        by_length = by_length + short - tilt * slope + short_2 - tilt_2 * slope_2
        energy = energy + 0.5 * (moment * bend + moment_2 * bend_2)
        energy_by_length = energy_by_length - 1.5 * moment * bend - twist * slope
        energy_by_length = energy_by_length - 1.5 * moment_2 * bend_2 - twist_2 * slope_2
        guide_force = guide_force + twist * by_x + twist_2 * by_y + 6.0 * over * (moment * x + moment_2 * y)
        head_force = head_force - twist * by_y - twist_2 * by_x + 6.0 * over * (moment * y + moment_2 * x)
        guide_pull = guide_pull + tilt * by_x + tilt_2 * by_y
        head_pull = head_pull - tilt * by_y - tilt_2 * by_x
        odd = twist - twist_2
        even = twist + twist_2
        both = wave * (moment + moment_2)
        less = wave * (moment - moment_2)
        f1 = f1 + odd * c1 - both * s1
        f2 = f2 + even * c2 - 2.0 * less * s2
        f3 = f3 + odd * c3 - 3.0 * both * s3
        f4 = f4 + even * c4 - 4.0 * less * s4
        f5 = f5 + odd * c5 - 5.0 * both * s5
        f6 = f6 + even * c6 - 6.0 * less * s6
        odd = tilt - tilt_2
        even = tilt + tilt_2
        g1 = g1 + odd * c1
        g2 = g2 + even * c2
        g3 = g3 + odd * c3
        g4 = g4 + even * c4
        g5 = g5 + odd * c5
        g6 = g6 + even * c6
    return Places(
        [f1, f2, f3, f4, f5, f6],
        guide_force,
        head_force,
        [g1, g2, g3, g4, g5, g6],
        guide_pull,
        head_pull,
        shortening,
        rate,
        second,
        by_length,
        energy,
        energy_by_length,
    )


def bent_place(
    weight: float, slope: float, turning: float, bend: float
) -> tuple[float, float, float, float, float]:
    """Return what a place of the belt adds to bending and shortening beyond the second order of its slope s.

    Args:
        weight: factor
        slope, turning, bend: s [1], its rate [1/s], `u_XX` [1/m]

    Returns:
        rate of the shortening by s, that of half the square of the curvature by `u_XX` and by s, the
        shortening, and its second rate by the square of the rate of s

    >>> [round(1e6 * each, 3) for each in bent_place(1.0, 0.1, 1.0, 1.0)]
    [503.782, 10101.01, 102030.405, 12.563, 15189.712]
    """
    square = 1.0 - slope * slope
    if square < LEAST_SQUARE:
        square = LEAST_SQUARE
    cosine = sqrt(square)
    inverse = 1.0 / cosine
    steep = inverse * inverse
    share = slope * slope / (1.0 + cosine)
    tilt = weight * share * inverse
    moment = weight * bend * steep
    return (
        tilt * slope,
        moment * slope * slope,
        moment * bend * slope * steep,
        0.5 * weight * share * share,
        tilt * turning * turning * (1.0 + cosine + square) * steep,
    )


def numbered(share: float, a: list[float]) -> list[float]:
    """Modes times a factor and their numbers.

    >>> numbered(1.0, [1.0] * 6)
    [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    """
    return [(n + 1) * share * a[n] for n in range(6)]


def by_modes(
    clamped: int, share: float, guide: float, head: float, f: list[float]
) -> tuple[list[float], float, float, float]:
    """Rates by the modes and by the end shapes of what has known rates by the parts of the slope.

    Args:
        clamped: which ends are clamped, whose end shapes follow the modes
        share: factor of f
        guide, head: rates by `3 x^2 - 1` and by `1 - 3 y^2`
        f: rates by `cos(n pi x)`

    Returns:
        rates by the modes, by the end shapes at guide and head, by the slope at a clamped guide times L

    >>> [round(each, 12) for each in by_modes(0, 1.0, 0.0, 0.0, [1.0, 0.0, 0.0, 0.0, 0.0, 0.0])[1:]]
    [1.215854203708, 1.215854203708, 0.0]
    """
    odd = 12.0 / (pi * pi) * (f[0] + f[2] / 9.0 + f[4] / 25.0)
    even = 12.0 / (pi * pi) * (f[1] / 4.0 + f[3] / 16.0 + f[5] / 36.0)
    guide = guide + share * (odd - even)
    head = head + share * (odd + even)
    by_guide, by_head = turned_by(clamped, guide, head)
    moments = moment_forces(-by_guide, -by_head)
    direct = numbered(share * pi, f)
    return summed(1.0, moments, direct), guide, head, by_guide


def end_shortening(over: float, ends: Ends) -> tuple[float, float, float]:
    """Shortening by the end shapes to the second order [m], and its rates while L and their own rates stay.

    Args:
        over: 1 / L [1/m]
        ends: amplitudes and their rates
    """
    by_guide = over * (SQUARE * ends.guide + CROSS * ends.head)
    by_head = over * (SQUARE * ends.head + CROSS * ends.guide)
    second = (
        SQUARE * (ends.guide_rate * ends.guide_rate + ends.head_rate * ends.head_rate)
        + 2.0 * CROSS * ends.guide_rate * ends.head_rate
    )
    return (
        0.5 * (by_guide * ends.guide + by_head * ends.head),
        by_guide * ends.guide_rate + by_head * ends.head_rate,
        over * second,
    )
