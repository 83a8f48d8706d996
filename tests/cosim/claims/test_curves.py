"""Curves between samples: their extremes and zeros beside those of numpy's polynomials."""

import numpy as np
import pytest
from drawn_runs import drawn, turning
from numpy.polynomial import polynomial

from loomfmu import judge
from loomfmu.cosim.claims.judging import ROOM, Run
from loomfmu.traces import Recording

RANDOM = np.random.default_rng(5)
TURN = 2.0 * np.pi


def recorded(time: np.ndarray, samples: np.ndarray, rates: int = 2) -> Recording:
    """A recording of `a.x`, of so many of its rates, and of a shaft that turns once in 1 s."""
    named = dict(zip("xvw", [*("v", "w")[:rates], *[None] * 3], strict=False))
    motion = {
        f"a.{name}": ("m", samples[:, column], {"rate": rate})
        for column, (name, rate) in enumerate(named.items())
    }
    return drawn(time, {**motion, **turning(TURN * time, TURN)})


def noise(size: int, rates: int) -> Recording:
    """A motion whose values and rates have nothing to do with each other."""
    return recorded(np.cumsum(RANDOM.uniform(0.01, 1.0, size=size)), RANDOM.normal(size=(size, 3)), rates)


def hermite(ends: np.ndarray) -> np.ndarray:
    """Coefficients of the polynomial with given values and rates at 0 and 1, by solving for them."""
    rows, right = [], []
    for order, values in enumerate(ends):
        for place, value in zip((0.0, 1.0), values, strict=True):
            basis = np.eye(2 * len(ends))
            rows.append([polynomial.polyval(place, polynomial.polyder(each, order)) for each in basis])
            right.append(value)
    return np.linalg.solve(rows, right)


def within(roots: np.ndarray, low: float = 0.0, high: float = 1.0) -> np.ndarray:
    """The real ones of some roots that lie between two places, in order."""
    real = roots[np.abs(roots.imag) < 1e-12].real
    return np.sort(real[(real > low) & (real < high)])


def crossings(trace: Recording) -> list[float]:
    """The times at which `a.x` passes 0."""
    return Run(trace).passages(trace, "a.x", 0.0)


@pytest.mark.parametrize("rates", [0, 1, 2])
def test_values_extremes_and_zeros_are_those_of_the_joining_polynomial(rates: int) -> None:
    for _ in range(200):
        trace = recorded(np.array([0.0, 1.0]), RANDOM.normal(size=(2, 3)), rates)
        run, ends = Run(trace), np.stack([trace[f"a.{name}"] for name in "xvw"[: rates + 1]])
        coefficients, share = hermite(ends), RANDOM.uniform()
        # rounding of a handful of terms of order 10
        assert abs(run.at(trace, "a.x", share) - polynomial.polyval(share, coefficients)) < 1e-12
        turns = within(polynomial.polyroots(polynomial.polyder(coefficients)))
        values = polynomial.polyval(np.array([0.0, 1.0, *turns]), coefficients)
        for sign in (1.0, -1.0):
            found = judge(trace, kind="above" if sign > 0.0 else "below", signal="a.x", bound=0.0)
            assert abs(found.worst - sign * (sign * values).min()) < 1e-12
            # times that are equal
            assert abs(polynomial.polyval(found.time, coefficients) - found.worst) < 1e-11
        zeros, passed = within(polynomial.polyroots(coefficients)), crossings(trace)
        assert len(passed) == len(zeros)
        assert np.allclose(passed, zeros, rtol=0.0, atol=1e-9)  # of zeros that lie close together
        points = run.points(trace, "a.x")[0]
        assert points[[0, -1]].tolist() == ends[0].tolist()
        assert points.mean() == pytest.approx(
            np.diff(polynomial.polyval([0, 1], polynomial.polyint(coefficients)))[0]
        )


@pytest.mark.parametrize("rates", [1, 2])
def test_the_lowest_in_a_window_is_that_of_the_polynomials_there(rates: int) -> None:
    time = np.linspace(0.0, 1.0, 25)
    for _ in range(20):
        trace = recorded(time, RANDOM.normal(size=(25, 3)) * (1.0, 10.0, 100.0), rates)
        low, high = np.sort(RANDOM.uniform(0.0, 1.0, size=2))
        lowest = np.inf
        for k in range(24):
            h, (start, end) = time[k + 1] - time[k], np.clip((np.array([low, high]) - time[k]) * 24, 0.0, 1.0)
            if start < end:
                rows = [
                    trace[f"a.{name}"][k : k + 2] * h**order for order, name in enumerate("xvw"[: rates + 1])
                ]
                polynom = hermite(np.stack(rows))
                turns = within(polynomial.polyroots(polynomial.polyder(polynom)), start, end)
                lowest = min(lowest, polynomial.polyval(np.array([start, end, *turns]), polynom).min())
        window = [f"{360.0 * each:.17g} deg" for each in (low, high)]
        found = judge(trace, kind="above", signal="a.x", bound=0.0, window=window)
        assert found.worst == pytest.approx(lowest, abs=1e-10)  # edges of the window to 1e-12 turns


def test_a_zero_that_is_touched_is_not_passed() -> None:
    touching = np.array([[1.0, -4.0, 0.0], [1.0, 4.0, 0.0]])  # (1 - 2 u)^2
    trace = recorded(np.array([0.0, 1.0]), touching, rates=1)
    assert crossings(trace) == []


def test_all_passages_are_found_however_many() -> None:
    trace = noise(500, 1)
    assert len(crossings(trace)) > 10 * ROOM


def test_where_a_value_is_not_finite_nothing_is_crossed() -> None:
    trace = noise(50, 2)
    whole, time = crossings(trace), trace.time
    trace["a.v"][20] = np.nan
    kept = [each for each in whole if not time[19] < each <= time[21]]
    assert crossings(trace) == kept
