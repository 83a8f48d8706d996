"""Warp thread: what it stores, and the power that stretches it, by the law of `warp`."""

from .numerics.motion import moved_on
from .warp import thread_growth


def thread_energy(
    force: float, extension: float, stiffness: float, creep: float, relaxation: float
) -> tuple[float, float]:
    """Energy that a thread stores [J], and power that creep and relaxation take from it [W], by (3.28).

    With `E = F^2 / (2 b)` the law gives `F x' = E' + F (r F / b - n x)`, for every b, n and r. The power is
    negative where creep gives back; over a closed cycle it is what the thread dissipates. Both are 0 without
    stiffness, as the force is.

    Args:
        force: F above the pretension [N]
        extension: x [m]

    >>> thread_energy(2.0, 0.5, 4.0, 3.0, 3.0)  # n = r: a spring with F = b x takes nothing
    (0.5, 0.0)
    """
    if stiffness <= 0.0:
        return 0.0, 0.0
    elastic = force / stiffness
    return 0.5 * force * elastic, force * (relaxation * elastic - creep * extension)


def thread_power(
    pretension: float,
    force: float,
    decay: float,
    p: list[float],
    rate: float,
    second: list[float],
    share: float,
) -> tuple[float, float, float]:
    """Power that stretches a thread, tension times rate of the extension, and its first and second rate by u.

    A slack thread takes none.

    Args:
        pretension, force: T0 and F there [N]
        rate, second: rate of the extension by u at the start, and its second rate as from `joined` [m]
        share: u [1]

    Returns:
        power and rates [J]

    >>> thread_power(1.0, 2.0, 0.0, [4.0] + [0.0] * 5, 5.0, [0.0] * 4, 0.5)
    (15.0, 20.0, 0.0)
    >>> thread_power(1.0, -2.0, 0.0, [4.0] + [0.0] * 5, 5.0, [0.0] * 4, 0.5)  # slack
    (0.0, 0.0, 0.0)
    """
    tension = pretension + force
    if tension < 0.0:
        return 0.0, 0.0, 0.0
    u = share
    growth = thread_growth(force, decay, p, u)
    bend = p[1] + u * (2.0 * p[2] + u * (3.0 * p[3] + u * (4.0 * p[4] + u * 5.0 * p[5]))) - decay * growth
    a0, a1, a2, a3 = second
    _x, slope, bent = moved_on(0.0, rate, a0, a1, a2, a3, u)
    third = a1 + u * (2.0 * a2 + u * 3.0 * a3)
    return (
        tension * slope,
        growth * slope + tension * bent,
        bend * slope + 2.0 * growth * bent + tension * third,
    )
