"""Motion between two samples: any quintic comes back, and noise does not grow."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from loomfmu.physics.numerics.motion import (
    above_noise,
    bent,
    bump_noise,
    bumps,
    expected_bump,
    joined,
    joined_value,
    largest_between,
    sample_noise,
)

coefficient = st.floats(-10.0, 10.0)
quintic = st.tuples(*[coefficient] * 6)


def derivatives(c: tuple[float, ...], u: float) -> tuple[float, float, float]:
    """Value, first and second derivative of a polynomial in exact arithmetic."""
    terms = [Fraction(x) for x in c]
    at = Fraction(u)
    return (
        float(sum(x * at**n for n, x in enumerate(terms))),
        float(sum(n * x * at ** (n - 1) for n, x in enumerate(terms) if n)),
        float(sum(n * (n - 1) * x * at ** (n - 2) for n, x in enumerate(terms) if n > 1)),
    )


@given(quintic, st.floats(0.0, 1.0))
def test_any_quintic_comes_back(c, u):
    start, end = derivatives(c, 0.0), derivatives(c, 1.0)
    cubic = joined(*start, *end)
    value, second = joined_value(start[0], start[1], *cubic, u)
    exact, _rate, exact_second = derivatives(c, u)
    # samples of size 10..600 are rounded to 1e-16 of themselves and enter 60 times
    scale = max(map(abs, (*start, *end, 1.0)))
    assert second == pytest.approx(exact_second, abs=60 * 4e-16 * 4 * scale)
    assert value == pytest.approx(exact, abs=60 * 4e-16 * scale)


@given(quintic, st.floats(0.3, 3.0))
def test_the_change_of_one_bump_gives_the_other(c, ratio):
    # the fourth derivative of a quintic runs on a line, so its fifth is that line's slope, whatever the steps
    def sampled(begin, step):
        one, other = derivatives(c, begin), derivatives(c, begin + step)
        return (one[0], step * one[1], step**2 * one[2]), (other[0], step * other[1], step**2 * other[2])

    before, _ = bumps(*sampled(0.0, 1.0)[0], *sampled(0.0, 1.0)[1])
    here = sampled(1.0, ratio)
    by_rate, by_value = bumps(*here[0], *here[1])
    # rates of up to 1e5 rounded to 1e-16, six times, and carried over by the fourth power of the ratio
    scale = max(map(abs, (*here[0], *here[1], 600.0)))
    assert expected_bump(before, 1.0, by_rate, ratio) == pytest.approx(by_value, abs=60 * 4e-16 * 100 * scale)


@pytest.mark.parametrize("before", [0.0, -1.0, 0.2])
def test_unlike_steps_let_nothing_be_expected(before):
    assert expected_bump(5.0, before, 7.0, 1.0) == 0.0


@pytest.mark.parametrize("step", [1e-2, 3e-3, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10])
def test_close_samples_bring_no_noise(step):
    # a motion of 1 m, sampled ever closer: with all its noise, 0.096 * 60 * 1e-16 / step^2 would appear
    def sample(t):
        return np.sin(t), step * np.cos(t), -step * step * np.sin(t)

    def curve(start, before):
        one, other = sample(start), sample(start + step)
        by_rate, by_value = bumps(*one, *other)
        sizes = [abs(a) + abs(b) for a, b in zip(one, other, strict=True)]
        noise = [sample_noise(size, rate, start / step) for size, rate in itertools.pairwise(sizes)]
        rate_noise, value_noise = bump_noise(*noise)
        by_rate = above_noise(by_rate, 0.0, rate_noise)
        expected = 0.0 if before is None else expected_bump(before, step, by_rate, step)
        return by_rate, bent(one[2], other[2], by_rate, above_noise(by_value, expected, value_noise))

    at = 1.0 + step  # the time as it is rounded
    before, _ = curve(1.0, None)
    shares = np.linspace(0.0, 1.0, 33)
    exact = -np.sin(at + shares * step)
    for known, bound in ((None, 1e-9), (before, 1e-10)):
        _, (a0, a1, a2, a3) = curve(at, known)
        second = (a0 + shares * (a1 + shares * (a2 + shares * a3))) / step**2
        # worst where the bump of the value goes under, at a step of (720 * 1e-15)^(1/5) = 4e-3: without it
        # 0.008 h^3 are left, and with what is expected in its place 0.004 h^4. The rate: 1e-15 / h
        # down to (12 * 1e-15)^(1/3) = 2e-5, and h^2 / 8 from there
        assert np.max(np.abs(second - exact)) < bound


@given(st.tuples(*[coefficient] * 4))
def test_largest_between_agrees_with_a_search(cubic):
    u = np.linspace(0.0, 1.0, 2001)
    searched = np.max(np.abs(np.polyval(cubic[::-1], u)))
    found = largest_between(*cubic)
    # a grid of 1/2000 misses at most f''/8 of its square: (2 * 10 + 6 * 10) / 8 / 4e6
    assert searched - 1e-13 <= found <= searched + 2.5e-6
