"""Curves between samples: their extremes and zeros beside those of numpy's polynomials."""

import numpy as np
import pytest
from numpy.polynomial import polynomial

from loomfmu.cosim.claims import bernstein
from loomfmu.cosim.claims.curves import Motion
from loomfmu.traces import Channel, Recording

RANDOM = np.random.default_rng(5)


def hermite(ends: list[tuple[float, float]]) -> np.ndarray:
    """Coefficients of the polynomial with given values and rates at 0 and 1, by solving for them."""
    rows, right = [], []
    for order, values in enumerate(ends):
        for place, value in zip((0.0, 1.0), values, strict=True):
            basis = np.eye(2 * len(ends))
            rows.append([polynomial.polyval(place, polynomial.polyder(each, order)) for each in basis])
            right.append(value)
    return np.linalg.solve(rows, right)


@pytest.mark.parametrize("rates", [0, 1, 2])
def test_values_extremes_and_zeros_are_those_of_the_joining_polynomial(rates: int) -> None:
    for _ in range(200):
        ends = [(RANDOM.normal(), RANDOM.normal()) for _ in range(rates + 1)]
        coefficients = hermite(ends)
        points = np.stack(bernstein.joining([(np.array([a]), np.array([b])) for a, b in ends]))
        share = RANDOM.uniform()
        # rounding of a handful of terms of order 10
        assert abs(bernstein.value(points, share)[0] - polynomial.polyval(share, coefficients)) < 1e-12
        turns = polynomial.polyroots(polynomial.polyder(coefficients))
        turns = turns[np.abs(turns.imag) < 1e-12].real
        places = np.array([0.0, 1.0, *turns[(turns > 0.0) & (turns < 1.0)]])
        lowest, at = bernstein.lowest(points)
        assert abs(lowest[0] - polynomial.polyval(places, coefficients).min()) < 1e-12
        assert abs(polynomial.polyval(at[0], coefficients) - lowest[0]) < 1e-12
        zeros = polynomial.polyroots(coefficients)
        zeros = np.sort(zeros[(np.abs(zeros.imag) < 1e-12) & (zeros.real > 0) & (zeros.real < 1)].real)
        found = bernstein.sign_changes(points[:, 0].tolist())
        assert len(found) == len(zeros)
        assert np.allclose(found, zeros, rtol=0.0, atol=1e-9)  # of zeros that lie close together


def test_a_piece_is_cut_exactly_or_left_as_it_is() -> None:
    points = RANDOM.normal(size=(6, 3))
    low, high = np.array([0.0, 0.25, 0.0]), np.array([1.0, 0.75, 0.5])
    parts = bernstein.clipped(points, low, high)
    assert np.array_equal(parts[:, 0], points[:, 0])
    for share in (0.0, 0.3, 1.0):
        inside = low + share * (high - low)
        assert np.allclose(bernstein.value(parts, share), bernstein.value(points, inside), rtol=0, atol=1e-14)


def test_a_zero_that_is_touched_is_not_passed() -> None:
    touching = bernstein.joining([(1.0, 1.0), (-4.0, 4.0)])
    assert bernstein.sign_changes(touching) == []  # (1 - 2 u)^2


def test_c_and_python_find_the_same_bits() -> None:
    compiled = bernstein._compiled()
    if compiled is None:
        pytest.skip("the compiled library is not available")
    for count in (2, 4, 6):
        for _ in range(300):
            points = RANDOM.normal(size=count) * 10.0 ** RANDOM.uniform(-9, 9)
            points[: RANDOM.integers(1, count)] *= -1.0
            points = np.abs(points) * np.sign(np.sort(RANDOM.normal(size=count)))
            if len({value < 0.0 for value in points.tolist()}) == 2:
                assert compiled(points.tolist()) == bernstein.python_sign_change(points.tolist())


@pytest.mark.parametrize("rates", [0, 1, 2])
def test_one_value_is_that_of_many_to_the_last_bit(rates: int) -> None:
    time = np.cumsum(RANDOM.uniform(0.01, 1.0, size=50))
    samples = {name: RANDOM.normal(size=50) for name in ("a.x", "a.v", "a.w")}
    channels = [
        Channel("a", name, "m", "m", "", column, rate=rate)
        for column, (name, rate) in enumerate((("x", "v"), ("v", "w"), ("w", None)))
    ]
    recording = Recording("samples", channels, lambda _instance, _name: None)
    recording.append(
        time, np.zeros(50), np.stack(list(samples.values()), axis=1), np.zeros((50, 0), np.int32)
    )
    motion = Motion(recording, "a.x", rates)
    times = np.concatenate([time, RANDOM.uniform(time[0], time[-1], size=200)])
    assert [motion.at(each) for each in times.tolist()] == motion.along(times).tolist()
