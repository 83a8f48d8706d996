"""A motion between two samples that carry position, velocity and acceleration."""

from math import fabs, sqrt

# Relative rounding error of a sample of a mechanism's motion: sixteen roundings for the chain of its
# trigonometric functions (on the published machines the travel is off by 1 to 8 as a rule and by at most 27,
# the velocity by 2 and by at most 10), and four for its time or angle; a rounding is 1.1e-16.
SAMPLE_ROUNDING = 1.8e-15
PLACE_ROUNDING = 4.5e-16


def bumps(
    start: float, start_rate: float, start_second: float, end: float, end_rate: float, end_second: float
) -> tuple[float, float]:
    """Two bumps of the second derivative between two samples, above the line between its ends.

    For the quintic that joins the samples. With u the share of the step the second derivative is

        (1 - u) A0 + u A1 + a u (1 - u) + b u (1 - u) (1 - 2 u)
        a = 6 [V1 - V0 - (A0 + A1)/2],  b = 60 [S1 - S0 - (V0 + V1)/2 + (A1 - A0)/12]

    where a makes the change of the rate right and b that of the value. For a step h that is short compared
    with the motion they are `-h^4 s''''/2` and `h^5 s'''''/12`.

    Args:
        start, start_rate, start_second: value, rate and second rate by u at u = 0 (rates multiplied by
            the step, second rates by its square)
        end, end_rate, end_second: the same at u = 1

    Returns:
        bump a of the rate and b of the value

    >>> [round(bump, 12) for bump in bumps(0.0, 0.0, 0.0, 1.0, 5.0, 20.0)]  # u^5
    [-30.0, 10.0]
    """
    return (
        6.0 * (end_rate - start_rate - 0.5 * (start_second + end_second)),
        60.0 * (end - start - 0.5 * (start_rate + end_rate) + (end_second - start_second) / 12.0),
    )


def bent(
    start_second: float, end_second: float, by_rate: float, by_value: float
) -> tuple[float, float, float, float]:
    """Second derivative with its two bumps as a cubic in u: coefficients of 1, u, u^2, u^3; see `bumps`.

    >>> bent(0.0, 20.0, -30.0, 10.0)  # of u^5
    (0.0, 0.0, 0.0, 20.0)
    """
    return (
        start_second,
        end_second - start_second + by_rate + by_value,
        -by_rate - 3.0 * by_value,
        2.0 * by_value,
    )


def joined(
    start: float, start_rate: float, start_second: float, end: float, end_rate: float, end_second: float
) -> tuple[float, float, float, float]:
    """Second derivative of the quintic that joins two samples, as a cubic in the share u of the step.

    Integrated twice it meets both samples to rounding. Its own error at a step h is 60 roundings of the
    value over h^2: where the second derivative itself is used, see `above_noise`.

    Arguments as for `bumps`; returns the coefficients of 1, u, u^2, u^3.

    >>> [round(c, 12) + 0.0 for c in joined(0.0, 0.0, 0.0, 1.0, 5.0, 20.0)]  # u^5
    [0.0, 0.0, 0.0, 20.0]
    """
    by_rate, by_value = bumps(start, start_rate, start_second, end, end_rate, end_second)
    return bent(start_second, end_second, by_rate, by_value)


def sample_noise(size: float, rate: float, place: float) -> float:
    """Largest rounding error in the difference of two samples.

    Args:
        size: sum of the sizes of both samples
        rate: sum of the sizes of their rates by u
        place: time or angle at which they were taken, in steps [1]

    >>> sample_noise(2.0, 0.0, 1e6)
    3.6e-15
    """
    return SAMPLE_ROUNDING * size + PLACE_ROUNDING * fabs(place) * rate


def bump_noise(value_noise: float, rate_noise: float) -> tuple[float, float]:
    """Rounding errors of the two bumps, of the rate and of the value, from those of the samples; see `bumps`.

    >>> bump_noise(1e-15, 1e-17)
    (6e-17, 6.03e-14)
    """
    return 6.0 * rate_noise, 60.0 * value_noise + 30.0 * rate_noise


def above_noise(bump: float, expected: float, noise: float) -> float:
    """A bump, or its expected value if the two differ by no more than the rounding error (noise).

    Without the bump of the value a second derivative s'' is off by up to `0.096 b / h^2 = 0.008 h^3 s'''''`;
    with it, by the noise of the samples, `0.096 * 60 e s / h^2`, e their rounding. Both are equal where b is
    as large as its noise, at `h^5 = 720 e s / s'''''`: for e = 1e-15 and s''''' = 40 s at 3000 steps per
    turn. With ten times as many steps the noise is 100,000 times the bump. So a bump within its noise is
    replaced by `expected_bump`, or by 0. The same holds for the bump of the rate: `h^2 s'''' / 8` against a
    noise of `1.5 e s' / h`, equal at 300,000 steps per turn.

    Args:
        bump: from `bumps`
        expected: from `expected_bump`, or 0
        noise: from `bump_noise`

    >>> above_noise(3e-14, 1e-14, 6e-14), above_noise(3e-12, 1e-14, 6e-14)
    (1e-14, 3e-12)
    """
    return expected if fabs(bump - expected) <= noise else bump


def expected_bump(before: float, step_before: float, by_rate: float, step: float) -> float:
    """Bump of the value, estimated from the change of the bumps of the rate from one step to the next.

    Each gives the fourth derivative in the middle of its step, `-2 a / h^4`; their difference over the
    distance of the middles is the fifth. The noise is that of the rates, so the estimate is good where the
    bump from the values is lost in noise; at coarse steps it is less accurate, by one order. It is 0 if the
    steps differ too much.

    Args:
        before, step_before: bump of the rate over the step before, and that step [s or rad]; 0 for none
        by_rate, step: the same of the present step

    >>> round(expected_bump(-60.0 * 0.5, 1.0, -60.0 * 1.5, 1.0), 12)  # u^5 from 0 to 1 and on to 2
    10.0
    """
    if step_before * step <= 0.0 or fabs(step) > 4.0 * fabs(step_before):
        return 0.0
    ratio = step / step_before
    change = by_rate - before * ratio * ratio * ratio * ratio
    return -change * step / (3.0 * (step + step_before))


def joined_value(
    start: float, start_rate: float, a0: float, a1: float, a2: float, a3: float, share: float
) -> tuple[float, float]:
    """Value and second derivative at a share of the step, from the coefficients of `joined`.

    >>> joined_value(0.0, 0.0, 0.0, 0.0, 0.0, 20.0, 0.5)
    (0.03125, 2.5)
    """
    u = share
    value = start + u * (start_rate + u * (a0 / 2.0 + u * (a1 / 6.0 + u * (a2 / 12.0 + u * a3 / 20.0))))
    return value, a0 + u * (a1 + u * (a2 + u * a3))


def joined_rate(start_rate: float, a0: float, a1: float, a2: float, a3: float, share: float) -> float:
    """First derivative by u at a share of the way, from the coefficients of `joined`.

    >>> joined_rate(0.0, 0.0, 0.0, 0.0, 20.0, 0.5)
    0.3125
    """
    u = share
    return start_rate + u * (a0 + u * (a1 / 2.0 + u * (a2 / 3.0 + u * a3 / 4.0)))


def moved_on(
    value: float, rate: float, a0: float, a1: float, a2: float, a3: float, time: float
) -> tuple[float, float, float]:
    """Value, rate and second rate after a time, the second rate a cubic in time.

    >>> moved_on(1.0, 2.0, 6.0, 0.0, 0.0, 0.0, 0.5)
    (2.75, 5.0, 6.0)
    """
    t = time
    return (
        value + t * (rate + t * (a0 / 2.0 + t * (a1 / 6.0 + t * (a2 / 12.0 + t * a3 / 20.0)))),
        rate + t * (a0 + t * (a1 / 2.0 + t * (a2 / 3.0 + t * a3 / 4.0))),
        a0 + t * (a1 + t * (a2 + t * a3)),
    )


def joined_area(
    duration: float,
    start: float,
    start_rate: float,
    start_second: float,
    end: float,
    end_rate: float,
    end_second: float,
) -> float:
    """Integral of the quintic that joins values, rates and second rates: `h^6 / 100,800` of the sixth off.

    >>> round(joined_area(2.0, 0.0, 0.0, 0.0, 32.0, 80.0, 160.0), 12)  # t^5
    10.666666666667
    """
    rates = 0.1 * (start_rate - end_rate) + duration * (start_second + end_second) / 120.0
    return duration * (0.5 * (start + end) + duration * rates)


def turns_of_cubic(a1: float, a2: float, a3: float) -> tuple[float, float]:
    """Return both places where a cubic `a0 + a1 u + a2 u^2 + a3 u^3` has an extreme, or -1 for none.

    >>> turns_of_cubic(4.0, -4.0, 0.0), turns_of_cubic(1.0, 0.0, 1.0)
    ((-1.0, 0.5), (-1.0, -1.0))
    """
    first = -1.0
    second = -1.0
    inside = a2 * a2 - 3.0 * a1 * a3
    if inside >= 0.0:
        # both roots of the derivative without cancellation
        q = a2 + sqrt(inside) if a2 >= 0.0 else a2 - sqrt(inside)
        if a3 != 0.0:
            first = -q / (3.0 * a3)
        if q != 0.0:
            second = -a1 / q
    return first, second


def largest_between(a0: float, a1: float, a2: float, a3: float) -> float:
    """Largest absolute value of `a0 + a1 u + a2 u^2 + a3 u^3` for u from 0 to 1.

    >>> largest_between(0.0, 4.0, -4.0, 0.0)
    1.0
    """
    largest = fabs(a0)
    end = fabs(a0 + a1 + a2 + a3)
    if end > largest:
        largest = end
    first, second = turns_of_cubic(a1, a2, a3)
    if 0.0 < first < 1.0:
        value = fabs(a0 + first * (a1 + first * (a2 + first * a3)))
        if value > largest:
            largest = value
    if 0.0 < second < 1.0:
        value = fabs(a0 + second * (a1 + second * (a2 + second * a3)))
        if value > largest:
            largest = value
    return largest


def met(
    share: float, step: float, start: float, start_rate: float, end: float, end_rate: float
) -> tuple[float, float]:
    """Value and rate at a share of the step, on the cubic that joins two samples with their rates.

    >>> met(0.5, 2.0, 0.0, 0.0, 8.0, 12.0)  # t^3
    (1.0, 3.0)
    """
    rise = step * start_rate
    fall = step * end_rate
    a2 = 3.0 * (end - start) - 2.0 * rise - fall
    a3 = 2.0 * (start - end) + rise + fall
    value = start + share * (rise + share * (a2 + share * a3))
    slope = rise + share * (2.0 * a2 + 3.0 * share * a3)
    return value, slope / step if step > 0.0 else end_rate
