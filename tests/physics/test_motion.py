"""Motion between two samples: any quintic comes back, and noise does not grow."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from loomfmu.physics.motion import joined, joined_value, largest_between

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


@given(quintic)
def test_both_ends_are_met(c):
    start, end = derivatives(c, 0.0), derivatives(c, 1.0)
    cubic = joined(*start, *end)
    scale = max(map(abs, (*start, *end, 1.0)))
    assert joined_value(start[0], start[1], *cubic, 0.0) == (start[0], start[2])
    value, second = joined_value(start[0], start[1], *cubic, 1.0)
    # as above: rounding of the samples, 60 times
    assert value == pytest.approx(end[0], abs=60 * 4e-16 * scale)
    assert second == pytest.approx(end[2], abs=60 * 4e-16 * 4 * scale)


@pytest.mark.parametrize("step", [1e-2, 1e-4, 1e-6, 1e-8, 1e-10])
def test_close_samples_bring_no_noise(step):
    # a motion of 1 m, sampled ever closer: without leaving out noise, 60 * 1e-16 / step^2 would appear
    def sample(t):
        return np.sin(t), step * np.cos(t), -step * step * np.sin(t)

    cubic = joined(*sample(1.0), *sample(1.0 + step))
    _value, second = joined_value(np.sin(1.0), step * np.cos(1.0), *cubic, 0.5)
    # worst where the bump of the value is just kept: that is at steps of (60 * 1e-16)^(1/5) = 1e-3
    assert second / step**2 == pytest.approx(-np.sin(1.0 + 0.5 * step), abs=1e-6)


@given(st.tuples(*[coefficient] * 4))
def test_largest_between_agrees_with_a_search(cubic):
    u = np.linspace(0.0, 1.0, 2001)
    searched = np.max(np.abs(np.polyval(cubic[::-1], u)))
    found = largest_between(*cubic)
    # a grid of 1/2000 misses at most f''/8 of its square: (2 * 10 + 6 * 10) / 8 / 4e6
    assert searched - 1e-13 <= found <= searched + 2.5e-6


@pytest.mark.parametrize(
    ("cubic", "largest"),
    [
        ((-3.0, 0.0, 0.0, 0.0), 3.0),
        ((0.0, 2.0, 0.0, 0.0), 2.0),
        ((0.0, -4.0, 4.0, 0.0), 1.0),
        ((0.0, 27.0, -54.0, 27.0), 4.0),  # 27 u (1 - u)^2, largest at 1/3
        ((0.0, 0.0, 27.0, -27.0), 4.0),  # its mirror, largest at 2/3
        ((0.0, 0.0, 0.0, 0.0), 0.0),
    ],
)
def test_largest_between_of_known_cubics(cubic, largest):
    assert largest_between(*cubic) == pytest.approx(largest, rel=1e-15)  # a few roundings
