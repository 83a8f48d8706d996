"""A motion between two samples that carry position, velocity and acceleration."""

from math import fabs, sqrt


def joined(
    start: float,
    start_rate: float,
    start_second: float,
    end: float,
    end_rate: float,
    end_second: float,
) -> tuple[float, float, float, float]:
    """Second derivative of the quintic that joins two samples, as a cubic in the share u of the way.

    Written as the line between the second derivatives plus two bumps, one that gives the right change
    of the rate and one that gives the right change of the value:

        (1 - u) A0 + u A1 + a u (1 - u) + b u (1 - u) (1 - 2 u)
        a = 6 [V1 - V0 - (A0 + A1)/2],  b = 60 [S1 - S0 - (V0 + V1)/2 + (A1 - A0)/12]

    A bump that is smaller than the rounding of its own terms is noise, and left out: so the result gets
    no worse when the samples come ever closer.

    Args:
        start, start_rate, start_second: value, rate and second rate by u at u = 0 (rates multiplied by
            the step, second rates by its square)
        end, end_rate, end_second: the same at u = 1

    Returns:
        coefficients of 1, u, u^2, u^3

    >>> [round(c, 12) + 0.0 for c in joined(0.0, 0.0, 0.0, 1.0, 5.0, 20.0)]  # u^5
    [0.0, 0.0, 0.0, 20.0]
    """
    rounding = 4.5e-16
    by_rate = 6.0 * (end_rate - start_rate - 0.5 * (start_second + end_second))
    if fabs(by_rate) < 6.0 * rounding * (fabs(start_rate) + fabs(end_rate)):
        by_rate = 0.0
    by_value = 60.0 * (end - start - 0.5 * (start_rate + end_rate) + (end_second - start_second) / 12.0)
    if fabs(by_value) < 60.0 * rounding * (fabs(start) + fabs(end)):
        by_value = 0.0
    return (
        start_second,
        end_second - start_second + by_rate + by_value,
        -by_rate - 3.0 * by_value,
        2.0 * by_value,
    )


def joined_value(
    start: float,
    start_rate: float,
    a0: float,
    a1: float,
    a2: float,
    a3: float,
    share: float,
) -> tuple[float, float]:
    """Value and second derivative at a share of the way, from the coefficients of `joined`.

    >>> joined_value(0.0, 0.0, 0.0, 0.0, 0.0, 20.0, 0.5)
    (0.03125, 2.5)
    """
    u = share
    value = start + u * (start_rate + u * (a0 / 2.0 + u * (a1 / 6.0 + u * (a2 / 12.0 + u * a3 / 20.0))))
    return value, a0 + u * (a1 + u * (a2 + u * a3))


def largest_between(a0: float, a1: float, a2: float, a3: float) -> float:
    """Largest absolute value of `a0 + a1 u + a2 u^2 + a3 u^3` for u from 0 to 1.

    >>> largest_between(0.0, 4.0, -4.0, 0.0)
    1.0
    """
    largest = fabs(a0)
    end = fabs(a0 + a1 + a2 + a3)
    if end > largest:
        largest = end
    inside = a2 * a2 - 3.0 * a1 * a3
    if inside < 0.0:
        return largest
    # both roots of the derivative without cancellation
    q = a2 + sqrt(inside) if a2 >= 0.0 else a2 - sqrt(inside)
    for root in range(2):
        u = -1.0
        if root == 0 and a3 != 0.0:
            u = -q / (3.0 * a3)
        if root == 1 and q != 0.0:
            u = -a1 / q
        if 0.0 < u < 1.0:
            value = fabs(a0 + u * (a1 + u * (a2 + u * a3)))
            if value > largest:
                largest = value
    return largest
