"""Curves between samples: their extremes and zeros beside those of numpy's polynomials."""

import numpy as np
import pytest
from numpy.polynomial import polynomial

from loomfmu.cosim.claims import bernstein
from loomfmu.cosim.claims.compiled import ROOM
from loomfmu.cosim.claims.curves import Motion
from loomfmu.traces import Channel, Recording

RANDOM = np.random.default_rng(5)


def motion_of_noise(size: int, rates: int) -> Motion:
    """A motion whose values and rates have nothing to do with each other; the same for a size."""
    random = np.random.default_rng(size)
    samples = random.normal(size=(size, 3))
    channels = [
        Channel("a", name, "m", "m", "", column, rate=rate)
        for column, (name, rate) in enumerate((("x", "v"), ("v", "w"), ("w", None)))
    ]
    recording = Recording("samples", channels, lambda _instance, _name: None)
    time = np.cumsum(random.uniform(0.01, 1.0, size=size))
    recording.append(time, np.zeros(size), samples, np.zeros((size, 0), np.int32))
    return Motion(recording, "a.x", rates)


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


@pytest.mark.no_cover
@pytest.mark.parametrize("rates", [0, 1, 2])
def test_c_and_python_find_the_same_bits(rates: int) -> None:
    for size in (2, 3, 50):
        motion, reference = (motion_of_noise(size, rates) for _ in range(2))
        reference._compiled = None
        if motion._compiled is None:
            pytest.skip("the compiled library is not available")
        assert motion.survey == reference.survey
        # samples as levels, where a sign is that of rounding; between them pieces with several changes
        levels = [*motion.values[0].tolist(), *RANDOM.normal(size=300).tolist()]
        found = [motion.crossings(level) for level in levels]
        assert found == [reference.crossings(level) for level in levels]
        assert size < 50 or max(map(len, found)) > ROOM
        for level in levels:  # which are samples, too
            assert motion.passes(level, 0.7) == reference.passes(level, 0.7)
        times = [-1.0, *motion.time.tolist(), *RANDOM.uniform(0.0, 60.0, size=200).tolist()]
        assert [motion.at(time) for time in times] == [reference.at(time) for time in times]


@pytest.mark.parametrize("compiled", [True, False])
def test_where_a_value_is_not_finite_nothing_is_crossed(compiled: bool) -> None:
    motion = motion_of_noise(50, 2)
    if not compiled:
        motion._compiled = None
    whole = motion.crossings(0.0)
    motion.values[1][20] = np.nan
    assert not motion.finite
    outside = (motion.time[19], motion.time[21])
    assert motion.crossings(0.0) == [time for time in whole if not outside[0] < time <= outside[1]]


@pytest.mark.parametrize("rates", [0, 1, 2])
def test_one_value_is_that_of_many_to_the_last_bit(rates: int) -> None:
    motion = motion_of_noise(50, rates)
    time = motion.time
    times = np.concatenate([time, RANDOM.uniform(time[0], time[-1], size=200)])
    assert [motion.at(each) for each in times.tolist()] == motion.along(times).tolist()
