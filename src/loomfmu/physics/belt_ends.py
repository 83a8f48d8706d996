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

from math import cos, pi, sin

from .belt_modes import bow_mode

# slope of psi at its own end; the opposite of that at the other one: 12 / pi^2 times sums over n up to 6
OWN = 2.0 - 12.0 / (pi * pi) * (1.0 + 1.0 / 4.0 + 1.0 / 9.0 + 1.0 / 16.0 + 1.0 / 25.0 + 1.0 / 36.0)
OTHER = 1.0 - 12.0 / (pi * pi) * (1.0 - 1.0 / 4.0 + 1.0 / 9.0 - 1.0 / 16.0 + 1.0 / 25.0 - 1.0 / 36.0)
# integrals of the square of the slope of psi and of its product with that of the other end
SQUARE = 8.8675894457757e-4
CROSS = 1.9587894996076e-4


def end_amplitudes(
    bow_of: int, bow: float, bow_length: float, length: float, may_clamp: bool
) -> tuple[float, float, float, float, float, float]:
    """Amplitudes of the end shapes at guide and head where both turn freely, and two rates by the length.

    By the belt's own bow (1): 0 for a bow of the span (2). At the guide `bow''(L) L^2 / 6`, by which it is
    bent there as the belt is without load. Where an end may be clamped, the amplitudes of least bending
    energy, which differ from this by 1 % and are close to 0 at the head: with `t = pi L / bow_length`

        OWN e + OTHER h = -bow (sin t - t cos t) - 2 L^3 sum (-1)^n b_n / (n pi)^3
        OTHER e + OWN h = -bow (t - sin t) + 2 L^3 sum b_n / (n pi)^3

    with b_n of `bow_mode`: what the modes leave of the slopes that the bow gives the ends.

    >>> round(end_amplitudes(1, 1.0, 2.0, 1.0, False)[0], 12)
    -0.411233516712
    """
    if bow_of != 1:
        return 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    cosine = cos(pi * length / bow_length)
    sine = sin(pi * length / bow_length)
    wave = pi / bow_length
    turn = wave * length
    if not may_clamp:
        bend = -bow * wave * wave / 6.0
        return (
            bend * length * length * sine,
            0.0,
            bend * length * (2.0 * sine + turn * cosine),
            0.0,
            bend * ((2.0 - turn * turn) * sine + 4.0 * turn * cosine),
            0.0,
        )
    odd, odd_rate, odd_second = by_cubes(1, bow, bow_length, length, cosine, sine)
    even, even_rate, even_second = by_cubes(2, bow, bow_length, length, cosine, sine)
    cube = length * length * length
    odd_second = cube * odd_second + 6.0 * length * (length * odd_rate + odd)
    even_second = cube * even_second + 6.0 * length * (length * even_rate + even)
    odd_rate = cube * odd_rate + 3.0 * length * length * odd
    even_rate = cube * even_rate + 3.0 * length * length * even
    guide = bow * (turn * cosine - sine) + cube * (odd - even)
    head = bow * (sine - turn) + cube * (odd + even)
    guide_rate = odd_rate - even_rate - bow * wave * turn * sine
    head_rate = odd_rate + even_rate - bow * wave * (1.0 - cosine)
    guide_second = odd_second - even_second - bow * wave * wave * (sine + turn * cosine)
    head_second = odd_second + even_second - bow * wave * wave * sine
    e, h = turned_by(3, guide, head)
    e_rate, h_rate = turned_by(3, guide_rate, head_rate)
    e_second, h_second = turned_by(3, guide_second, head_second)
    return e, h, e_rate, h_rate, e_second, h_second


def by_cubes(
    first: int, bow: float, bow_length: float, length: float, cosine: float, sine: float
) -> tuple[float, float, float]:
    """Sum of `2 b_n / (n pi)^3` over odd n (first 1) or even n (2), and its two rates by the length.

    >>> [round(each / pi, 12) for each in by_cubes(1, 1.0, 1.0, 1.0, -1.0, 0.0)][:1]
    [1.0]
    """
    moments = 0.0
    rates = 0.0
    seconds = 0.0
    for number in range(first, 7, 2):
        moment, rate, second = bow_mode(number, bow, bow_length, length, cosine, sine)
        cube = number * number * number
        moments = moments + moment / cube
        rates = rates + rate / cube
        seconds = seconds + second / cube
    share = 2.0 / (pi * pi * pi)
    return share * moments, share * rates, share * seconds


def end_shape(
    guide: float, head: float, a1: float, a2: float, a3: float, a4: float, a5: float, a6: float
) -> tuple[float, float, float, float, float, float]:
    """Modes that together with `guide (x^3 - x) + head (y^3 - y)`, y = 1 - x, make modes and end shapes.

    The sines of `x^3 - x` are `12 (-1)^n / (n pi)^3`.

    >>> round(end_shape(1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)[0], 12)
    0.387018413198
    """
    share = 12.0 * guide / (pi * pi * pi)
    more = 12.0 * head / (pi * pi * pi)
    return (
        a1 + share + more,
        a2 - share / 8.0 + more / 8.0,
        a3 + share / 27.0 + more / 27.0,
        a4 - share / 64.0 + more / 64.0,
        a5 + share / 125.0 + more / 125.0,
        a6 - share / 216.0 + more / 216.0,
    )


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


def end_slopes(a1: float, a2: float, a3: float, a4: float, a5: float, a6: float) -> tuple[float, float]:
    """Slopes of the modes by x at the guide, and at the head against x.

    >>> end_slopes(1.0, 1.0, 0.0, 0.0, 0.0, 0.0) == (pi, -3.0 * pi)
    True
    """
    odd = pi * (a1 + 3.0 * a3 + 5.0 * a5)
    even = pi * (2.0 * a2 + 4.0 * a4 + 6.0 * a6)
    return even - odd, -even - odd


def moment_forces(guide: float, head: float) -> tuple[float, float, float, float, float, float]:
    """Work of moments at both ends on the slopes of each mode there, see `end_slopes`.

    >>> moment_forces(1.0, 0.0)[:2] == (-pi, 2.0 * pi)
    True
    """
    return at_ends(-guide - head, guide - head)


def at_ends(odd: float, even: float) -> tuple[float, float, float, float, float, float]:
    """Slopes of all modes by x at their ends, `n pi`, times a factor for the odd ones and one for the even.

    >>> at_ends(1.0, -1.0)[:2] == (pi, -2.0 * pi)
    True
    """
    return pi * odd, 2.0 * pi * even, 3.0 * pi * odd, 4.0 * pi * even, 5.0 * pi * odd, 6.0 * pi * even


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
    q1: float,
    q2: float,
    q3: float,
    q4: float,
    q5: float,
    q6: float,
    v1: float,
    v2: float,
    v3: float,
    v4: float,
    v5: float,
    v6: float,
    velocity: float,
    acceleration: float,
    clamped: int,
    turn: float,
    turn_by_length: float,
    e: float,
    h: float,
    e_by_length: float,
    h_by_length: float,
    e_second: float,
    h_second: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """Amplitudes of the end shapes at guide and head, and how they follow the modes and the length.

    The slope at a clamped guide is `turn / L`, at a clamped head 0. With e and h of the bow, and what the
    amplitudes E = e + d and H = h + k exceed it by:

        sum n pi (-1)^n q_n + OWN E + OTHER H = turn
        -sum n pi q_n + OTHER E + OWN H = 0

    Args:
        q1 .. v6: modes and their rates [m, m/s]
        velocity, acceleration: rates V and A of the length [m/s, m/s2]
        clamped: which ends are clamped
        turn, turn_by_length: slope at the guide times L [m], and its rate by L [1]
        e .. h_second: of `end_amplitudes` [m, 1, 1/m]

    Returns:
        1, 2: d, k [m]
        3 to 6: E, H [m], their rates [m/s]
        7, 8: rates of E and H by L [1]
        9, 10: second rates of E and H without those by q_n'' [m/s2]
    """
    square = velocity * velocity
    if clamped == 0:
        return (
            0.0,
            0.0,
            e,
            h,
            e_by_length * velocity,
            h_by_length * velocity,
            e_by_length,
            h_by_length,
            e_second * square + e_by_length * acceleration,
            h_second * square + h_by_length * acceleration,
        )
    guide, head = end_slopes(q1, q2, q3, q4, q5, q6)
    guide_rate, head_rate = end_slopes(v1, v2, v3, v4, v5, v6)
    d, k = turned_by(clamped, turn - guide - OWN * e - OTHER * h, -head - OTHER * e - OWN * h)
    guide_growth, head_growth = turning(turn_by_length, e_by_length, h_by_length)
    d_rate, k_rate = turned_by(
        clamped, guide_growth * velocity - guide_rate, head_growth * velocity - head_rate
    )
    d_by_length, k_by_length = turned_by(clamped, guide_growth, head_growth)
    d_second, k_second = turned_by(
        clamped, -OWN * e_second - OTHER * h_second, -OTHER * e_second - OWN * h_second
    )
    d_by_length = d_by_length + e_by_length
    k_by_length = k_by_length + h_by_length
    return (
        d,
        k,
        e + d,
        h + k,
        e_by_length * velocity + d_rate,
        h_by_length * velocity + k_rate,
        d_by_length,
        k_by_length,
        (e_second + d_second) * square + d_by_length * acceleration,
        (h_second + k_second) * square + k_by_length * acceleration,
    )


def turning(turn_by_length: float, e_by_length: float, h_by_length: float) -> tuple[float, float]:
    """Rates by L of the slopes that the modes and what exceeds the bow make up for, see `end_motion`.

    >>> turning(1.0, 0.0, 0.0)
    (1.0, 0.0)
    """
    return (
        turn_by_length - OWN * e_by_length - OTHER * h_by_length,
        0.0 - OTHER * e_by_length - OWN * h_by_length,
    )


def end_bending(
    length: float, stiffness: float, guide_growth: float, head_growth: float, d: float, k: float
) -> tuple[float, float]:
    """Bending energy of the end shapes beyond those of the bow, and its rate by L.

    Args:
        length, stiffness: L [m], B [N m2]
        guide_growth, head_growth: of `turning` [1]
        d, k: of `end_motion` [m]

    Returns:
        energy `3 B / L^3 [OWN (d^2 + k^2) + 2 OTHER d k]` [J], its rate [N]
    """
    moment = 6.0 * stiffness / (length * length * length)
    energy = 0.5 * moment * (OWN * (d * d + k * k) + 2.0 * OTHER * d * k)
    return energy, moment * (d * guide_growth + k * head_growth) - 3.0 * energy / length
