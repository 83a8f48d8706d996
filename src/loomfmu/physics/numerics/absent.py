"""Terms that may be left out."""


def absent(factor: float) -> bool:
    """Return whether a term with this factor is nothing, and so may be left out.

    A derivative by a factor that is 0 is that of the term itself. For numbers that carry a derivative along
    (dual.h), a factor is therefore absent only if it also stays 0.

    >>> absent(0.0), absent(1e-300)
    (True, False)
    """
    return factor == 0.0
