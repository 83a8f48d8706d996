"""A piece of a cubic spline between two knots, given by the values and second derivatives there."""

from math import sqrt

from .brackets import at_root


def cubic_piece(
    distance: float, length: float, left: float, right: float, left_bend: float, right_bend: float
) -> tuple[float, float, float, float]:
    """Value of the piece and its three derivatives.

    With d the distance, h the length and r = h - d:

        [r y0 + d y1 + (r^3 - h^2 r) M0/6 + (d^3 - h^2 d) M1/6] / h

    Args:
        distance: from the left knot, 0 to length
        length: between the knots, above 0
        left, right: values y0 and y1 at the knots
        left_bend, right_bend: second derivatives M0 and M1 there

    Returns:
        value, first, second and third derivative

    >>> cubic_piece(0.5, 1.0, 0.0, 1.0, 0.0, 6.0)  # the third power
    (0.125, 0.75, 3.0, 6.0)
    """
    rest = length - distance
    square = length * length
    bulge = rest * (rest * rest - square) * left_bend + distance * (distance * distance - square) * right_bend
    tilt = (square - 3.0 * rest * rest) * left_bend + (3.0 * distance * distance - square) * right_bend
    return (
        (rest * left + distance * right + bulge / 6.0) / length,
        (right - left + tilt / 6.0) / length,
        (rest * left_bend + distance * right_bend) / length,
        (right_bend - left_bend) / length,
    )


def slope_extremes(
    length: float, left: float, right: float, left_bend: float, right_bend: float
) -> tuple[float, float]:
    """Lowest and highest slope of the piece, at its ends or where the second derivative is 0.

    Arguments as for `cubic_piece`.

    >>> slope_extremes(2.0, 0.0, 0.0, -3.0, 3.0)  # x (1 - x) (2 - x) / 2
    (-0.5, 1.0)
    """
    _value, lowest, _second, _third = cubic_piece(0.0, length, left, right, left_bend, right_bend)
    _value, highest, _second, _third = cubic_piece(length, length, left, right, left_bend, right_bend)
    if lowest > highest:
        lowest, highest = highest, lowest
    if left_bend * right_bend < 0.0:
        place = length * left_bend / (left_bend - right_bend)
        _value, inside, _second, _third = cubic_piece(place, length, left, right, left_bend, right_bend)
        if inside < lowest:
            lowest = inside
        if inside > highest:
            highest = inside
    return lowest, highest


def turning_points(
    length: float, left: float, right: float, left_bend: float, right_bend: float
) -> tuple[float, float]:
    """The two distances at which the slope of the piece is 0, in order; a missing one is at an end.

    Between these and the ends the piece is monotone. Arguments as for `cubic_piece`.

    >>> turning_points(2.0, 0.0, 4.0, 6.0, -6.0)  # 3 x^2 - x^3
    (0.0, 2.0)
    """
    _value, slope, _second, third = cubic_piece(0.0, length, left, right, left_bend, right_bend)
    first = 0.0
    second = length
    inside = left_bend * left_bend - 2.0 * third * slope
    if inside > 0.0:
        # both roots of slope + M0 d + third d^2 / 2 without cancellation
        q = -left_bend - sqrt(inside) if left_bend > 0.0 else -left_bend + sqrt(inside)
        one = q / third if third != 0.0 else 0.0
        other = 2.0 * slope / q if q != 0.0 else 0.0
        if 0.0 < one < length:
            first = one
        if 0.0 < other < length:
            second = other
        if first > second:
            first, second = second, first
    return first, second


def stretch_above(
    level: float, length: float, left: float, right: float, left_bend: float, right_bend: float
) -> float:
    """Length over which the piece is at or above a level, found to rounding.

    Arguments as for `cubic_piece`.

    >>> round(stretch_above(0.125, 1.0, 0.0, 1.0, 0.0, 6.0), 15)  # of the third power
    0.5
    """
    first, second = turning_points(length, left, right, left_bend, right_bend)
    total = 0.0
    low = 0.0
    for part in range(3):
        high = length
        if part == 0:
            high = first
        if part == 1:
            high = second
        total = total + _part_above(level, low, high, length, left, right, left_bend, right_bend)
        low = high
    return total


def _part_above(
    level: float,
    low: float,
    high: float,
    length: float,
    left: float,
    right: float,
    left_bend: float,
    right_bend: float,
) -> float:
    """As `stretch_above`, for a part from `low` to `high` in which the piece is monotone."""
    at_low, _first, _second, _third = cubic_piece(low, length, left, right, left_bend, right_bend)
    at_high, _first, _second, _third = cubic_piece(high, length, left, right, left_bend, right_bend)
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
        value, _first, _second, _third = cubic_piece(middle, length, left, right, left_bend, right_bend)
        if (value >= level) == (at_low >= level):
            start = middle
        else:
            end = middle
    value, slope, _second, _third = cubic_piece(start, length, left, right, left_bend, right_bend)
    start = at_root(start, value - level, slope)
    return start - low if at_low >= level else high - start
