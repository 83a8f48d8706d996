"""Rotor law given by a table: a periodic cubic spline through evenly spaced points of one turn.

The spline interpolates the deviation `S - x`, which is equal at both ends of a turn. As the knots are evenly
spaced, its second derivatives have a closed form and need not be stored.
"""

from math import pi, sqrt

TABLE = 8


def bend_weight(distance: int, points: int) -> float:
    """Weight [1/rad2] of a second difference in the spline's second derivative, some knots away.

    With h = 2 pi / n between the knots the second derivatives M solve

        M(k-1) + 4 M(k) + M(k+1) = (6 / h^2) D(k),    D(k) = y(k-1) - 2 y(k) + y(k+1)

    The system is the same at every knot, and so is its solution, with z = sqrt(3) - 2:

        M(k) = (6 / h^2) sum over m = 0..n-1 of D(k+m) (z^m + z^(n-m)) / (2 sqrt(3) (1 - z^n))

    Args:
        distance: m, 0 to points - 1
        points: n, knots in a turn, at least 3

    >>> even = sum(bend_weight(m, 36) for m in range(36))  # all D alike: M = D / h^2
    >>> round(even * (2 * pi / 36) ** 2, 12)
    1.0
    """
    root = sqrt(3.0) - 2.0
    step = 2.0 * pi / points
    decay = root**distance + root ** (points - distance)
    return 3.0 * decay / (step * step * sqrt(3.0) * (1.0 - root**points))
