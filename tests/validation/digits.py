"""Numbers as the report shows them, alike on every machine.

A number has a fixed count of decimals. Before that it is cut to eight significant digits, and a tie is
rounded away from zero, so that the report does not depend on the last bits of a computation.
"""

import math
from decimal import ROUND_HALF_UP, Context, Decimal

_EIGHT_DIGITS = Context(prec=8, rounding=ROUND_HALF_UP)


def number(value: float, digits: int, sign: bool = False) -> str:
    """Return a number with a fixed count of decimals.

    >>> number(0.1 + 0.2, 1), number(2.5 - 1e-13, 0), number(-1e-12, 3), number(1.25, 1, sign=True)
    ('0.3', '3', '0.000', '+1.3')
    """
    if not math.isfinite(value):
        raise ValueError(f"{value} has no place in the report")
    shown = rounded(value, digits)
    return f"{shown:+f}" if sign and shown != 0 else f"{shown:f}"


def rounded(value: float, digits: int) -> Decimal:
    """Return the decimal that stands for a number, zero without a sign."""
    cut = _EIGHT_DIGITS.create_decimal_from_float(value)
    shown = cut.quantize(Decimal(1).scaleb(-digits), rounding=ROUND_HALF_UP)
    return shown if shown != 0 else abs(shown)


def small(value: float, floor: float) -> str:
    """Return a small error with one digit, or say that it is below a floor at which rounding shows.

    >>> small(3.21e-5, 1e-9), small(2e-13, 1e-9)
    ('3e-05', 'below 1e-09')
    """
    return f"{value:.0e}" if value >= floor else f"below {floor:.0e}"
