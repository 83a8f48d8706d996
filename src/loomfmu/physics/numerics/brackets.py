"""Roots that are known to lie in a bracket."""


def nearer_root(low: float, high: float, x: float, beyond: float, slope: float) -> float:
    """Next guess at the root of a rising function: Newton's step, or the middle if that leaves the bracket.

    Args:
        low, high: bracket, already narrowed by the guess `x`
        beyond: by how much the function at `x` exceeds what is sought
        slope: of the function at `x`

    >>> nearer_root(0.0, 2.0, 1.0, 0.5, 1.0), nearer_root(0.0, 2.0, 1.0, 5.0, 1.0)
    (0.5, 1.0)
    """
    nearer = 0.5 * (low + high)
    if slope > 0.0:
        newton = x - beyond / slope
        if low < newton < high:
            nearer = newton
    return nearer


def at_root(root: float, value: float, slope: float) -> float:
    """Return the root of a function that a search has found: the number itself.

    A search decides by comparisons, through which no derivative leads. Numbers that carry one along (dual.h)
    take here the derivative of the root from its equation: `-(df/dp) / (df/dx)`.

    Args:
        root: x, as it was found
        value: f(x, p) of the function at the root
        slope: df/dx of the function at the root

    >>> at_root(2.0, 1e-16, 3.0)
    2.0
    """
    return root
