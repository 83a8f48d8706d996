"""Extremes of a signal between its samples, so that no step decides what is seen of them."""

from .motion import joined, joined_rate, joined_value, turns_of_cubic

HALVINGS = 50  # of a share of a step: then it is known to rounding


def lowest_so_far(
    lowest: float, step: float, start: float, start_rate: float, end: float, end_rate: float
) -> float:
    """Lowest value of a signal so far: of those before, and of the cubic that joins its last two samples.

    With h the step the cubic is off by `h^4 s'''' / 384`; a sample misses the extreme by up to `h^2 s'' / 8`.

    Args:
        lowest: lowest value up to the last sample
        step: time, or whatever the rates are taken by, from the last sample to this one
        start, start_rate: value and rate at the last sample
        end, end_rate: the same at this one

    >>> lowest_so_far(0.0, 2.0, 0.0, -2.0, 0.0, 2.0)  # x^2 - 2 x between 0 and 2
    -1.0
    """
    rise = step * start_rate
    fall = step * end_rate
    if end < lowest:
        lowest = end
    if start < lowest:
        lowest = start
    # the curve lies within the hull of its Bernstein points
    if start + rise / 3.0 >= lowest and end - fall / 3.0 >= lowest:
        return lowest
    a2 = 3.0 * (end - start) - 2.0 * rise - fall
    a3 = 2.0 * (start - end) + rise + fall
    first, second = turns_of_cubic(rise, a2, a3)
    if 0.0 < first < 1.0:
        value = start + first * (rise + first * (a2 + first * a3))
        if value < lowest:
            lowest = value
    if 0.0 < second < 1.0:
        value = start + second * (rise + second * (a2 + second * a3))
        if value < lowest:
            lowest = value
    return lowest


def highest_so_far(
    highest: float, step: float, start: float, start_rate: float, end: float, end_rate: float
) -> float:
    """Highest value of a signal so far; see `lowest_so_far`.

    >>> highest_so_far(0.0, 2.0, 0.0, 2.0, 0.0, -2.0)
    1.0
    """
    return -lowest_so_far(-highest, step, -start, -start_rate, -end, -end_rate)


def lowest_by_two_rates(
    lowest: float,
    step: float,
    start: float,
    start_rate: float,
    start_second: float,
    end: float,
    end_rate: float,
    end_second: float,
) -> float:
    """Lowest value of a signal so far, on the quintic between samples: its second rate is known as well.

    The quintic is off by `h^6 s'''''' / 46080`. It is searched in eighths of the step, each for one turn.
    Arguments as for `lowest_so_far`, with second rates.

    (x - 1)^4 from 0 to 2:

    >>> round(lowest_by_two_rates(1.0, 2.0, 1.0, -4.0, 12.0, 1.0, 4.0, 12.0), 15) + 0.0
    0.0
    """
    rate = step * start_rate
    second = step * step * start_second
    end_slope = step * end_rate
    end_bend = step * step * end_second
    if end < lowest:
        lowest = end
    if start < lowest:
        lowest = start
    # the curve lies within the hull of its Bernstein points
    near = start + 0.2 * rate >= lowest and start + 0.4 * rate + 0.05 * second >= lowest
    far = end - 0.2 * end_slope >= lowest and end - 0.4 * end_slope + 0.05 * end_bend >= lowest
    if near and far:
        return lowest
    a0, a1, a2, a3 = joined(start, rate, second, end, end_slope, end_bend)
    low = 0.0
    for eighth in range(8):
        high = 0.125 * (eighth + 1)
        if joined_rate(rate, a0, a1, a2, a3, low) < 0.0 and joined_rate(rate, a0, a1, a2, a3, high) >= 0.0:
            left = low
            right = high
            for _ in range(HALVINGS):
                middle = 0.5 * (left + right)
                if joined_rate(rate, a0, a1, a2, a3, middle) < 0.0:
                    left = middle
                else:
                    right = middle
            value, _bend = joined_value(start, rate, a0, a1, a2, a3, right)
            if value < lowest:
                lowest = value
        low = high
    return lowest


def highest_by_two_rates(
    highest: float,
    step: float,
    start: float,
    start_rate: float,
    start_second: float,
    end: float,
    end_rate: float,
    end_second: float,
) -> float:
    """Highest value of a signal so far, where its second rate is known as well; see `lowest_by_two_rates`.

    >>> round(highest_by_two_rates(-1.0, 2.0, -1.0, 4.0, -12.0, -1.0, -4.0, -12.0), 15) + 0.0
    0.0
    """
    return -lowest_by_two_rates(
        -highest, step, -start, -start_rate, -start_second, -end, -end_rate, -end_second
    )
