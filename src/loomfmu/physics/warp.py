"""Warp thread: extension from the shed's geometry and the viscoelastic law of its tension, exactly.

Source: Korolev, thesis on rotary dobbies (Moscow), sections 3.5 and 5.1, equations (3.28) and (3.29), with
the law after Kragelsky in the form that (3.29) solves: `F' + r F = b (x' + n x)`. Over a step the extension
is a polynomial in the share u of the step, and so is the right side. The force follows in closed form from
the moments of a fading memory, which are computed without cancellation for every rate and step.

Symbols: the eye is at the `height` y above the line from the fell of the cloth to the back rest [m], l1 and
l2 are its distances from these along the line, `front` and `back` [m]; b is the `stiffness` [N/m], n the
`creep` and r the `relaxation` [1/s] of the law.
"""

from math import exp, fabs, sqrt

from .numerics.brackets import at_root


def eye_pull(height: float, front: float, back: float) -> float:
    """Share of its tension [1] with which a thread pulls its heald eye back: sum of the sines of its parts.

    It is also the derivative of the extension by the height of the eye. It has the sign of the height.

    >>> round(eye_pull(0.3, 0.4, 0.4), 12)
    1.2
    """
    return height / sqrt(front * front + height * height) + height / sqrt(back * back + height * height)


def eye_bend(height: float, front: float, back: float) -> float:
    """Derivative of `eye_pull` by the height of the eye, `l1^2 / (l1^2 + y^2)^1.5 + l2^2 / (l2^2 + y^2)^1.5`.

    Arguments as for `eye_pull`; returns 1/m.

    >>> eye_bend(0.0, 0.5, 0.25)
    6.0
    """
    to_fell = sqrt(front * front + height * height)
    to_rest = sqrt(back * back + height * height)
    share_1 = front / to_fell
    share_2 = back / to_rest
    return share_1 * share_1 / to_fell + share_2 * share_2 / to_rest


def thread_extension(
    height: float, velocity: float, acceleration: float, front: float, back: float
) -> tuple[float, float, float]:
    """Extension of a thread [m], `x = sqrt(l1^2 + y^2) - l1 + sqrt(l2^2 + y^2) - l2`, and its two rates.

    Each part is computed as `y^2 / (sqrt(l^2 + y^2) + l)`, so nothing cancels in a nearly closed shed.

    >>> [round(each, 12) for each in thread_extension(0.3, 1.0, 0.0, 0.4, 0.4)]
    [0.2, 1.2, 2.56]
    """
    square = height * height
    to_fell = sqrt(front * front + square)
    to_rest = sqrt(back * back + square)
    slope = eye_pull(height, front, back)
    return (
        square / (to_fell + front) + square / (to_rest + back),
        slope * velocity,
        eye_bend(height, front, back) * velocity * velocity + slope * acceleration,
    )


def constant_rate_force(time: float, rate: float, stiffness: float, creep: float, relaxation: float) -> float:
    """Force of a thread stretched from rest at a constant rate [N], `x = v t`, by the corrected (3.28).

    `F = b v [n t / r + (1 - n/r) (1 - exp(-r t)) / r]`, the exact solution of the law. Equation (3.29) is its
    counterpart for a force that rises at a constant rate.

    Args:
        time: t since the start [s]
        rate: of the extension v [m/s]

    >>> constant_rate_force(2.0, 0.001, 67.0, 5.0, 5.0)  # n = r: a spring, b x
    0.134
    """
    faded = (1.0 - exp(-relaxation * time)) / relaxation
    share = creep / relaxation
    return stiffness * rate * (share * time + (1.0 - share) * faded)


def fading(decay: float) -> tuple[float, float, float, float, float, float, float, float]:
    """`exp(-z)` and the moments of a fading memory, `I_k = integral of exp(-z (1 - u)) u^k`, u from 0 to 1.

    `z I_k = 1 - k I_(k-1)`, upwards from I_0 for z >= 3, downwards from a series for I_6 below, so that the
    rounding of one moment does not grow in the next. z is at least -3.

    Returns:
        exp(-z), I_0 .. I_6

    >>> fading(0.0)[:4]
    (1.0, 1.0, 0.5, 0.3333333333333333)
    """
    kept = exp(-decay)
    if decay < 3.0:
        term = 1.0 / 7.0
        i6 = term
        k = 8
        while fabs(term) > 1e-18 and k < 60:
            term = -term * decay / k
            i6 = i6 + term
            k = k + 1
        i5 = (1.0 - decay * i6) / 6.0
        i4 = (1.0 - decay * i5) / 5.0
        i3 = (1.0 - decay * i4) / 4.0
        i2 = (1.0 - decay * i3) / 3.0
        i1 = (1.0 - decay * i2) / 2.0
        return kept, 1.0 - decay * i1, i1, i2, i3, i4, i5, i6
    i0 = (1.0 - kept) / decay
    i1 = (1.0 - i0) / decay
    i2 = (1.0 - 2.0 * i1) / decay
    i3 = (1.0 - 3.0 * i2) / decay
    i4 = (1.0 - 4.0 * i3) / decay
    i5 = (1.0 - 5.0 * i4) / decay
    return kept, i0, i1, i2, i3, i4, i5, (1.0 - 6.0 * i5) / decay


def thread_drive(
    stiffness: float, creep: float, start: float, end: float, a0: float, a1: float, a2: float, a3: float
) -> list[float]:
    """Right side of the law over a step [N], `b (x' + n x)`: its coefficients of 1, u .. u^5, u its share.

    The extension at both ends is exact, so rounding does not add up over many steps.

    Args:
        creep: n times the duration of the step [1]
        start, end: extension at both ends [m]
        a0 .. a3: its second derivative by u, as from `joined` [m]

    >>> thread_drive(1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 0.0, 0.0)
    [7.0, 2.0, 0.0, 0.0, 0.0, 0.0]
    """
    rate = end - start - (a0 / 2.0 + a1 / 6.0 + a2 / 12.0 + a3 / 20.0)
    return [
        stiffness * (rate + creep * start),
        stiffness * (a0 + creep * rate),
        stiffness * (a1 + creep * a0) / 2.0,
        stiffness * (a2 / 3.0 + creep * a1 / 6.0),
        stiffness * (a3 / 4.0 + creep * a2 / 12.0),
        stiffness * creep * a3 / 20.0,
    ]


def thread_force(force: float, decay: float, p: list[float], share: float) -> tuple[float, float]:
    """Force of the thread at a share u of the step, and its integral over u from 0 [N, N].

    Exact solution of `dF/du + z F = p0 + p1 u + .. + p5 u^5`:

        F = F0 exp(-z u) + sum of p_k u^(k+1) I_k(z u)
        integral = F0 u I_0(z u) + sum of p_k u^(k+2) I_(k+1)(z u) / (k + 1)

    Args:
        force: F0 at the start of the step [N]
        decay: z, the relaxation rate times the duration of the step [1]
        p: right side of the law, from `thread_drive` [N]
        share: u [1]

    >>> thread_force(1.0, 0.0, [2.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0)
    (3.0, 2.0)
    """
    u = share
    p0, p1, p2, p3, p4, p5 = p
    kept, i0, i1, i2, i3, i4, i5, i6 = fading(decay * u)
    gain = p0 * i0 + u * (p1 * i1 + u * (p2 * i2 + u * (p3 * i3 + u * (p4 * i4 + u * p5 * i5))))
    area = p2 * i3 / 3.0 + u * (p3 * i4 / 4.0 + u * (p4 * i5 / 5.0 + u * p5 * i6 / 6.0))
    area = p0 * i1 + u * (p1 * i2 / 2.0 + u * area)
    return force * kept + u * gain, u * (force * i0 + u * area)


def thread_growth(force: float, decay: float, p: list[float], share: float) -> float:
    """Derivative of the force by u, at a given force; see `thread_force`.

    >>> thread_growth(3.0, 2.0, [10.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.5)
    4.0
    """
    u = share
    return p[0] + u * (p[1] + u * (p[2] + u * (p[3] + u * (p[4] + u * p[5])))) - decay * force


def turns_once(p: list[float]) -> bool:
    """Return whether the force has at most one extreme in the step: its right side is monotonic.

    Between two extremes of the force `exp(z u) dF/du` has one too, and its derivative is `exp(z u)` times
    that of the right side. Sufficient, not necessary: the first coefficient outweighs all others.

    >>> turns_once([0.0, 1.0, 0.2, 0.0, 0.0, 0.0]), turns_once([0.0, 1.0, -1.0, 0.0, 0.0, 0.0])
    (True, False)
    """
    return fabs(p[1]) >= 2.0 * fabs(p[2]) + 3.0 * fabs(p[3]) + 4.0 * fabs(p[4]) + 5.0 * fabs(p[5])


def thread_gauge(turn: bool, level: float, force: float, decay: float, p: list[float], share: float) -> float:
    """Zero where `thread_locate` looks: the derivative of the force by u, or the force minus a level.

    >>> thread_gauge(False, 2.0, 1.0, 0.0, [2.0, 0.0, 0.0, 0.0, 0.0, 0.0], 1.0)
    1.0
    """
    value, _area = thread_force(force, decay, p, share)
    return thread_growth(value, decay, p, share) if turn else value - level


def thread_locate(
    turn: bool, level: float, force: float, decay: float, p: list[float], low: float, high: float
) -> float:
    """Share of the step [1] at which the force has an extreme, or at which it passes a level.

    Regula falsi (Illinois), with a bisection every third step, on the exact solution.

    Args:
        turn: True for the extreme, False for the level
        level: of the force [N]
        low, high: bracket of u; the derivative, or force minus level, changes sign between them

    >>> round(thread_locate(False, 2.0, 1.0, 0.0, [2.0, 0.0, 0.0, 0.0, 0.0, 0.0], 0.0, 1.0), 12)
    0.5
    """
    at_low = thread_gauge(turn, level, force, decay, p, low)
    at_high = thread_gauge(turn, level, force, decay, p, high)
    last = 0
    for count in range(100):
        if high - low <= 1e-15 or at_high == 0.0:
            break
        u = high - at_high * (high - low) / (at_high - at_low)
        if u <= low or u >= high or count % 3 == 2:
            u = 0.5 * (low + high)
        here = thread_gauge(turn, level, force, decay, p, u)
        if (here > 0.0) == (at_high > 0.0):
            high = u
            at_high = here
            if last == 1:
                at_low = 0.5 * at_low
            last = 1
        else:
            low = u
            at_low = here
            if last == -1:
                at_high = 0.5 * at_high
            last = -1
    if turn:
        return high
    value, _area = thread_force(force, decay, p, high)
    return at_root(high, value - level, thread_growth(value, decay, p, high))
