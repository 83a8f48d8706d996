"""Extremes between samples: against dense samples of the same polynomial, and against a known curve."""

import random

import numpy as np
import pytest

from loomfmu.physics.numerics.extremes import (
    highest_by_two_rates,
    highest_so_far,
    lowest_by_two_rates,
    lowest_so_far,
)
from loomfmu.physics.numerics.motion import turns_of_cubic

DENSE = np.linspace(0.0, 1.0, 20001)


@pytest.mark.parametrize("seed", range(200))
def test_the_cubic_and_the_quintic_are_lowest_where_dense_samples_say(seed: int) -> None:
    rng = random.Random(seed)
    step = 10.0 ** rng.uniform(-6.0, 2.0)
    cubic = np.polynomial.Polynomial([rng.uniform(-1.0, 1.0) for _ in range(4)])
    quintic = np.polynomial.Polynomial([rng.uniform(-1.0, 1.0) for _ in range(6)])
    # turns just beyond the end, where it does not count
    turned = (np.polynomial.Polynomial([-1.05, 1.0]) * quintic.cutdeg(3)).integ()
    for curve, orders, low, high in (
        (cubic, 2, lowest_so_far, highest_so_far),
        (quintic, 3, lowest_by_two_rates, highest_by_two_rates),
        (turned, 3, lowest_by_two_rates, highest_by_two_rates),
    ):
        rates = [curve.deriv(order) if order else curve for order in range(orders)]
        start, end = ([float(r(u)) / step**n for n, r in enumerate(rates)] for u in (0.0, 1.0))
        values = curve(DENSE)
        # second derivatives are 40 at most: a dense sample misses an extreme by 40 * (5e-5)^2 / 8 = 1.3e-8
        assert low(1e9, step, *start, *end) == pytest.approx(values.min(), abs=2e-8)
        assert high(-1e9, step, *start, *end) == pytest.approx(values.max(), abs=2e-8)


def test_what_was_more_extreme_before_stays() -> None:
    assert lowest_so_far(-5.0, 2.0, 0.0, -2.0, 0.0, 2.0) == -5.0
    assert highest_so_far(5.0, 2.0, 0.0, 2.0, 0.0, -2.0) == 5.0
    assert lowest_by_two_rates(-5.0, 2.0, 1.0, -4.0, 12.0, 1.0, 4.0, 12.0) == -5.0


def test_a_step_of_no_length_has_the_lower_end() -> None:
    assert lowest_so_far(9.0, 0.0, 3.0, -1.0, 2.0, 1.0) == 2.0
    assert lowest_by_two_rates(9.0, 0.0, 3.0, -1.0, 0.0, 2.0, 1.0, 0.0) == 2.0


def test_a_cubic_turns_where_its_derivative_is_zero() -> None:
    assert turns_of_cubic(-1.0, 0.0, 1.0 / 3.0) == pytest.approx((-1.0, 1.0))
    assert turns_of_cubic(0.0, 0.0, 0.0) == (-1.0, -1.0)
