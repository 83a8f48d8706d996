"""Ends of the belt: the shape that its modes lack there, and what it costs to keep an end from turning.

With x from 0 at the head to 1 at the guide no sine is bent at its ends, but a belt with a bow of its own is,
and so is one that a moment holds there. The end shape has this bend: `psi(x) = x^3 - x` less its first six
sines at the guide, `psi(1 - x)` at the head. It is the part of the shape under such a moment that the six
modes leave (a residual attachment mode), orthogonal to them in mass, bending and constant compression. Its
own mass, 1e-6 of the belt's, is neglected.

Its amplitude e is that of the unloaded belt's bow where an end turns freely. Where an end is clamped
(`clamped`: 0 none, 1 at the guide, 2 at the head, 3 both) the amplitudes follow from the slopes at the ends,
whatever the load; the bending energy of what they exceed the bow by holds the modes.
"""

from dataclasses import dataclass
from math import cos, pi, sin

from .belt_modes import Bow, bow_mode

# slope of psi at its own end; the opposite of that at the other one: 12 / pi^2 times sums over n up to 6
OWN = 2.0 - 12.0 / (pi * pi) * (1.0 + 1.0 / 4.0 + 1.0 / 9.0 + 1.0 / 16.0 + 1.0 / 25.0 + 1.0 / 36.0)
OTHER = 1.0 - 12.0 / (pi * pi) * (1.0 - 1.0 / 4.0 + 1.0 / 9.0 - 1.0 / 16.0 + 1.0 / 25.0 - 1.0 / 36.0)
# integrals of the square of the slope of psi and of its product with that of the other end
SQUARE = 8.8675894457757e-4
CROSS = 1.9587894996076e-4


@dataclass(frozen=True)
class FreeEnds:
    """Amplitudes of the end shapes at guide and head where both turn freely, and two rates by the length."""

    guide: float
    head: float
    guide_rate: float
    head_rate: float
    guide_second: float
    head_second: float


@dataclass(frozen=True)
class Ends:
    """The end shapes E at the guide and H at the head, and how they follow the modes and the length.

    Which ends are `clamped`; what E and H exceed those of the bow by [m]; E and H [m], their rates [m/s], by
    the length [1], and their second rates without those by the modes' [m/s2].
    """

    clamped: int
    guide_excess: float
    head_excess: float
    guide: float
    head: float
    guide_rate: float
    head_rate: float
    guide_by_length: float
    head_by_length: float
    guide_second: float
    head_second: float


def end_amplitudes(bow: Bow, length: float, may_clamp: bool) -> FreeEnds:
    """The end shapes of an unloaded belt, by its own bow (1): none for a bow of the span (2).

    At the guide `bow''(L) L^2 / 6`, by which it is bent there as the belt is without load. Where an end may
    be clamped, the amplitudes of least bending energy, which differ from this by 1 % and are close to 0 at
    the head: with `t = pi L / half_wave`

        OWN e + OTHER h = -height (sin t - t cos t) - 2 L^3 sum (-1)^n b_n / (n pi)^3
        OTHER e + OWN h = -height (t - sin t) + 2 L^3 sum b_n / (n pi)^3

    with b_n of `bow_mode`: what the modes leave of the slopes that the bow gives the ends.

    >>> round(end_amplitudes(Bow(1, 1.0, 2.0), 1.0, False).guide, 12)
    -0.411233516712
    """
    if bow.of != 1:
        return FreeEnds(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    cosine = cos(pi * length / bow.half_wave)
    sine = sin(pi * length / bow.half_wave)
    wave = pi / bow.half_wave
    turn = wave * length
    if not may_clamp:
        bend = -bow.height * wave * wave / 6.0
        return FreeEnds(
            bend * length * length * sine,
            0.0,
            bend * length * (2.0 * sine + turn * cosine),
            0.0,
            bend * ((2.0 - turn * turn) * sine + 4.0 * turn * cosine),
            0.0,
        )
    odd, odd_rate, odd_second = by_cubes(1, bow, length, cosine, sine)
    even, even_rate, even_second = by_cubes(2, bow, length, cosine, sine)
    cube = length * length * length
    odd_second = cube * odd_second + 6.0 * length * (length * odd_rate + odd)
    even_second = cube * even_second + 6.0 * length * (length * even_rate + even)
    odd_rate = cube * odd_rate + 3.0 * length * length * odd
    even_rate = cube * even_rate + 3.0 * length * length * even
    guide = bow.height * (turn * cosine - sine) + cube * (odd - even)
    head = bow.height * (sine - turn) + cube * (odd + even)
    guide_rate = odd_rate - even_rate - bow.height * wave * turn * sine
    head_rate = odd_rate + even_rate - bow.height * wave * (1.0 - cosine)
    guide_second = odd_second - even_second - bow.height * wave * wave * (sine + turn * cosine)
    head_second = odd_second + even_second - bow.height * wave * wave * sine
    e, h = turned_by(3, guide, head)
    e_rate, h_rate = turned_by(3, guide_rate, head_rate)
    e_second, h_second = turned_by(3, guide_second, head_second)
    return FreeEnds(e, h, e_rate, h_rate, e_second, h_second)


def by_cubes(first: int, bow: Bow, length: float, cosine: float, sine: float) -> tuple[float, float, float]:
    """Sum of `2 b_n / (n pi)^3` over odd n (first 1) or even n (2), and its two rates by the length.

    >>> [round(each / pi, 12) for each in by_cubes(1, Bow(1, 1.0, 1.0), 1.0, -1.0, 0.0)][:1]
    [1.0]
    """
    moments = 0.0
    rates = 0.0
    seconds = 0.0
    for number in range(first, 7, 2):
        moment, rate, second = bow_mode(number, bow, length, cosine, sine)
        cube = number * number * number
        moments = moments + moment / cube
        rates = rates + rate / cube
        seconds = seconds + second / cube
    share = 2.0 / (pi * pi * pi)
    return share * moments, share * rates, share * seconds


def end_shape(guide: float, head: float, a: list[float]) -> list[float]:
    """Modes that together with `guide (x^3 - x) + head (y^3 - y)`, y = 1 - x, make modes and end shapes.

    The sines of `x^3 - x` are `12 (-1)^n / (n pi)^3`.

    >>> round(end_shape(1.0, 0.0, [0.0] * 6)[0], 12)
    0.387018413198
    """
    share = 12.0 * guide / (pi * pi * pi)
    more = 12.0 * head / (pi * pi * pi)
    return [
        a[0] + share + more,
        a[1] - share / 8.0 + more / 8.0,
        a[2] + share / 27.0 + more / 27.0,
        a[3] - share / 64.0 + more / 64.0,
        a[4] + share / 125.0 + more / 125.0,
        a[5] - share / 216.0 + more / 216.0,
    ]


def buckling(clamped: int) -> tuple[float, float]:
    """Turn `k L` of Euler's load `B k^2`, and wave w of the growth beyond it.

    The belt grows as `(w / L) sqrt((P - B k^2) / rho)` in the shape in which it buckles, of which the square
    of w is `int u'^2 dx / int u^2 dx`.

    >>> buckling(3)[0] == 2.0 * pi
    True
    """
    if clamped == 0:
        return pi, pi
    if clamped == 3:
        return 2.0 * pi, 3.6275987284684357
    return 4.493409457909064, 3.480579999634551


def end_slopes(a: list[float]) -> tuple[float, float]:
    """Slopes of the modes by x at the guide, and at the head against x.

    >>> end_slopes([1.0, 1.0, 0.0, 0.0, 0.0, 0.0]) == (pi, -3.0 * pi)
    True
    """
    odd = pi * (a[0] + 3.0 * a[2] + 5.0 * a[4])
    even = pi * (2.0 * a[1] + 4.0 * a[3] + 6.0 * a[5])
    return even - odd, -even - odd


def moment_forces(guide: float, head: float) -> list[float]:
    """Work of moments at both ends on the slopes of each mode there, see `end_slopes`.

    >>> moment_forces(1.0, 0.0)[:2] == [-pi, 2.0 * pi]
    True
    """
    return at_ends(-guide - head, guide - head)


def at_ends(odd: float, even: float) -> list[float]:
    """Slopes of all modes by x at their ends, `n pi`, times a factor for the odd ones and one for the even.

    >>> at_ends(1.0, -1.0)[:2] == [pi, -2.0 * pi]
    True
    """
    return [pi * odd, 2.0 * pi * even, 3.0 * pi * odd, 4.0 * pi * even, 5.0 * pi * odd, 6.0 * pi * even]


def reactions(
    clamped: int, weight: float, odd_yield: float, even_yield: float, odd: float, even: float
) -> tuple[float, float]:
    """Moments of the clamped ends on the odd and on the even modes, each yielding to them: see `at_ends`.

    Args:
        clamped: which ends are clamped, not 0
        weight: stiffness against turning that the end shapes leave, times OWN
        odd_yield, even_yield: how far end slopes of the odd and the even modes yield to a moment
        odd, even: their slopes without the moments

    >>> reactions(1, OWN, 0.0, 0.0, 0.0, 1.0), reactions(2, OWN, 0.5, 0.5, 1.0, 1.0)
    ((-1.0, 1.0), (1.0, 1.0))
    """
    if clamped == 3:
        by_odd = 2.0 * weight / (OWN + OTHER)
        by_even = 2.0 * weight / (OWN - OTHER)
        return by_odd * odd / (1.0 + by_odd * odd_yield), by_even * even / (1.0 + by_even * even_yield)
    sign = -1.0 if clamped == 1 else 1.0
    by_both = weight / OWN
    moment = by_both * (even + sign * odd) / (1.0 + by_both * (odd_yield + even_yield))
    return sign * moment, moment


def turned_by(clamped: int, guide: float, head: float) -> tuple[float, float]:
    """Amplitudes of the end shapes that turn the clamped ends by given slopes.

    >>> turned_by(1, OWN, OTHER), turned_by(2, OTHER, OWN), turned_by(0, 1.0, 1.0)
    ((1.0, 0.0), (0.0, 1.0), (0.0, 0.0))
    >>> [round(each, 12) for each in turned_by(3, OWN + 2.0 * OTHER, OTHER + 2.0 * OWN)]
    [1.0, 2.0]
    """
    if clamped == 1:
        return guide / OWN, 0.0
    if clamped == 2:
        return 0.0, head / OWN
    if clamped == 0:
        return 0.0, 0.0
    whole = OWN * OWN - OTHER * OTHER
    return (OWN * guide - OTHER * head) / whole, (OWN * head - OTHER * guide) / whole


def end_motion(
    free: FreeEnds,
    velocity: float,
    acceleration: float,
    clamped: int,
    turn: float,
    turn_by_length: float,
    q: list[float],
    v: list[float],
) -> Ends:
    """Amplitudes of the end shapes at guide and head, and how they follow the modes and the length.

    The slope at a clamped guide is `turn / L`, at a clamped head 0. With e and h of the bow, and what the
    amplitudes E = e + d and H = h + k exceed it by:

        sum n pi (-1)^n q_n + OWN E + OTHER H = turn
        -sum n pi q_n + OTHER E + OWN H = 0

    Args:
        free: of `end_amplitudes`
        velocity, acceleration: rates V and A of the length [m/s, m/s2]
        turn, turn_by_length: slope at the guide times L [m], and its rate by L [1]
    """
    square = velocity * velocity
    if clamped == 0:
        return Ends(
            0,
            0.0,
            0.0,
            free.guide,
            free.head,
            free.guide_rate * velocity,
            free.head_rate * velocity,
            free.guide_rate,
            free.head_rate,
            free.guide_second * square + free.guide_rate * acceleration,
            free.head_second * square + free.head_rate * acceleration,
        )
    guide, head = end_slopes(q)
    guide_rate, head_rate = end_slopes(v)
    d, k = turned_by(
        clamped,
        turn - guide - OWN * free.guide - OTHER * free.head,
        -head - OTHER * free.guide - OWN * free.head,
    )
    guide_growth, head_growth = turning(turn_by_length, free)
    d_rate, k_rate = turned_by(
        clamped, guide_growth * velocity - guide_rate, head_growth * velocity - head_rate
    )
    d_by_length, k_by_length = turned_by(clamped, guide_growth, head_growth)
    d_second, k_second = turned_by(
        clamped,
        -OWN * free.guide_second - OTHER * free.head_second,
        -OTHER * free.guide_second - OWN * free.head_second,
    )
    d_by_length = d_by_length + free.guide_rate
    k_by_length = k_by_length + free.head_rate
    return Ends(
        clamped,
        d,
        k,
        free.guide + d,
        free.head + k,
        free.guide_rate * velocity + d_rate,
        free.head_rate * velocity + k_rate,
        d_by_length,
        k_by_length,
        (free.guide_second + d_second) * square + d_by_length * acceleration,
        (free.head_second + k_second) * square + k_by_length * acceleration,
    )


def turning(turn_by_length: float, free: FreeEnds) -> tuple[float, float]:
    """Rates by L of the slopes that the modes and what exceeds the bow make up for, see `end_motion`.

    >>> turning(1.0, FreeEnds(0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    (1.0, 0.0)
    """
    return (
        turn_by_length - OWN * free.guide_rate - OTHER * free.head_rate,
        0.0 - OTHER * free.guide_rate - OWN * free.head_rate,
    )


def end_bending(
    length: float, stiffness: float, guide_growth: float, head_growth: float, d: float, k: float
) -> tuple[float, float]:
    """Bending energy of the end shapes beyond those of the bow [J], and its rate by L [N].

    The energy is `3 B / L^3 [OWN (d^2 + k^2) + 2 OTHER d k]`.

    Args:
        length, stiffness: L [m], B [N m2]
        guide_growth, head_growth: of `turning` [1]
        d, k: of `end_motion` [m]
    """
    moment = 6.0 * stiffness / (length * length * length)
    energy = 0.5 * moment * (OWN * (d * d + k * k) + 2.0 * OTHER * d * k)
    return energy, moment * (d * guide_growth + k * head_growth) - 3.0 * energy / length
