"""A piece of a cubic spline between two knots."""

from dataclasses import dataclass
from math import sqrt

from .brackets import at_root


@dataclass(frozen=True)
class Cubic:
    """A piece: length h, above 0, values y0 and y1 at its knots, and second derivatives M0 and M1 there."""

    length: float
    left: float
    right: float
    left_bend: float
    right_bend: float


def cubic_piece(piece: Cubic, distance: float) -> tuple[float, float, float, float]:
    """Value of a piece and its three derivatives.

    With d the distance from the left knot, 0 to h, and r = h - d:

        [r y0 + d y1 + (r^3 - h^2 r) M0/6 + (d^3 - h^2 d) M1/6] / h

    >>> cubic_piece(Cubic(1.0, 0.0, 1.0, 0.0, 6.0), 0.5)  # the third power
    (0.125, 0.75, 3.0, 6.0)
    """
    length = piece.length
    left_bend = piece.left_bend
    right_bend = piece.right_bend
    rest = length - distance
    square = length * length
    bulge = rest * (rest * rest - square) * left_bend + distance * (distance * distance - square) * right_bend
    tilt = (square - 3.0 * rest * rest) * left_bend + (3.0 * distance * distance - square) * right_bend
    return (
        (rest * piece.left + distance * piece.right + bulge / 6.0) / length,
        (piece.right - piece.left + tilt / 6.0) / length,
        (rest * left_bend + distance * right_bend) / length,
        (right_bend - left_bend) / length,
    )


def slope_extremes(piece: Cubic) -> tuple[float, float]:
    """Lowest and highest slope of a piece, at its ends or where the second derivative is 0.

    >>> slope_extremes(Cubic(2.0, 0.0, 0.0, -3.0, 3.0))  # x (1 - x) (2 - x) / 2
    (-0.5, 1.0)
    """
    _value, lowest, _second, _third = cubic_piece(piece, 0.0)
    _value, highest, _second, _third = cubic_piece(piece, piece.length)
    if lowest > highest:
        lowest, highest = highest, lowest
    if piece.left_bend * piece.right_bend < 0.0:
        place = piece.length * piece.left_bend / (piece.left_bend - piece.right_bend)
        _value, inside, _second, _third = cubic_piece(piece, place)
        if inside < lowest:
            lowest = inside
        if inside > highest:
            highest = inside
    return lowest, highest


def turning_points(piece: Cubic) -> tuple[float, float]:
    """The two distances at which the slope of a piece is 0, in order; a missing one is at an end.

    Between these and the ends the piece is monotone.

    >>> turning_points(Cubic(2.0, 0.0, 4.0, 6.0, -6.0))  # 3 x^2 - x^3
    (0.0, 2.0)
    """
    _value, slope, _second, third = cubic_piece(piece, 0.0)
    first = 0.0
    second = piece.length
    inside = piece.left_bend * piece.left_bend - 2.0 * third * slope
    if inside > 0.0:
        # both roots of slope + M0 d + third d^2 / 2 without cancellation
        q = -piece.left_bend - sqrt(inside) if piece.left_bend > 0.0 else -piece.left_bend + sqrt(inside)
        one = q / third if third != 0.0 else 0.0
        other = 2.0 * slope / q if q != 0.0 else 0.0
        if 0.0 < one < piece.length:
            first = one
        if 0.0 < other < piece.length:
            second = other
        if first > second:
            first, second = second, first
    return first, second


def stretch_above(piece: Cubic, level: float) -> float:
    """Length over which a piece is at or above a level, found to rounding.

    >>> round(stretch_above(Cubic(1.0, 0.0, 1.0, 0.0, 6.0), 0.125), 15)  # of the third power
    0.5
    """
    first, second = turning_points(piece)
    total = 0.0
    low = 0.0
    for part in range(3):
        high = piece.length
        if part == 0:
            high = first
        if part == 1:
            high = second
        total = total + _part_above(piece, level, low, high)
        low = high
    return total


def _part_above(piece: Cubic, level: float, low: float, high: float) -> float:
    """As `stretch_above`, for a part from `low` to `high` in which the piece is monotone."""
    at_low, _first, _second, _third = cubic_piece(piece, low)
    at_high, _first, _second, _third = cubic_piece(piece, high)
    if at_low >= level and at_high >= level:
        return high - low
    if at_low < level and at_high < level:
        return 0.0
    start = low
    end = high
    for _ in range(200):
        middle = 0.5 * (start + end)
        if middle <= start or middle >= end:
            break
        value, _first, _second, _third = cubic_piece(piece, middle)
        if (value >= level) == (at_low >= level):
            start = middle
        else:
            end = middle
    value, slope, _second, _third = cubic_piece(piece, start)
    start = at_root(start, value - level, slope)
    return start - low if at_low >= level else high - start
