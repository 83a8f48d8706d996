"""Roots and extremes: against functions whose roots are known, jumps and missing values included."""

import math
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from loomfmu.studies.limits.search import WIDTH, holds, near_zero, root, touching


class Counted:
    """A function that keeps count of its calls, each value computed once."""

    def __init__(self, function: Callable[[float], float]):
        self.function = function
        self.known: dict[float, float] = {}

    def __call__(self, x: float) -> float:
        if x not in self.known:
            self.known[x] = self.function(x)
        return self.known[x]


SMOOTH: list[tuple[Callable[[float], float], float, float, float]] = [
    (lambda x: 1.0 - x, 0.0, 3.0, 1.0),
    (lambda x: 0.9 - (x / 681.804) ** 2, 645.0, 660.0, 681.804 * math.sqrt(0.9)),
    (lambda x: math.cos(x), 0.0, 3.0, math.pi / 2.0),
    (lambda x: x**3 - 2.0, -1.0, 2.0, 2.0 ** (1.0 / 3.0)),
    (lambda x: math.copysign(math.sqrt(abs(x - 0.3)), x - 0.3), 0.0, 1.0, 0.3),
    (lambda x: math.exp(30.0 * x) - 7.0, -1.0, 1.0, math.log(7.0) / 30.0),
    (lambda x: x, -1.0, 2.0, 0.0),
]


@pytest.mark.parametrize(("function", "low", "high", "expected"), SMOOTH)
def test_a_root_of_a_continuous_function_is_found(
    function: Callable[[float], float], low: float, high: float, expected: float
) -> None:
    counted = Counted(function)
    found = root(counted, low, high)
    assert abs(found.value - expected) <= WIDTH * max(abs(expected), 1e-6 * (high - low))
    assert found.low <= found.value <= found.high and not found.jumps
    assert len(counted.known) < 50  # bisection alone takes 33 on a bracket of the size of the root


def test_a_smooth_root_takes_few_calls() -> None:
    function, low, high, _expected = SMOOTH[1]
    counted = Counted(function)
    root(counted, low, high)
    assert len(counted.known) <= 9


@pytest.mark.parametrize(
    "function",
    [
        lambda x: 0.0 if x < 0.7 else -1.0,  # a count that is at its bound
        lambda x: 2.0 - x if x < 0.7 else -5.0 - x,
        lambda x: math.nan if x < 0.7 else x,
        lambda x: 1.0 if x < 0.7 else math.nan,
        lambda x: math.inf if x < 0.7 else -x,
    ],
)
def test_a_jump_is_bracketed_and_named(function: Callable[[float], float]) -> None:
    found = root(function, 0.0, 2.0)
    assert found.jumps and found.low <= 0.7 <= found.high and found.high - found.low <= 1.1 * WIDTH
    assert holds(function(found.low)) != holds(function(found.high))


def test_a_root_beside_a_region_without_values_is_none_of_its_edges() -> None:
    found = root(lambda x: 0.5 - x if x < 0.8 else math.nan, 0.0, 1.0)
    assert found.value == pytest.approx(0.5, rel=WIDTH) and not found.jumps


@given(st.floats(0.05, 0.95), st.floats(-12.0, -1.0), st.sampled_from([1.0, -1.0]))
def test_an_extreme_that_just_passes_0_is_found(place: float, depth: float, side: float) -> None:
    dip = 10.0**depth  # the function is beyond 0 for 2 sqrt(dip) of the range

    def function(x: float) -> float:
        return side * ((x - place) ** 2 - dip)

    low, middle, high = place - 0.7, place + 0.1, place + 0.9
    if not near_zero(function(low), function(middle), function(high)):
        assert dip > 0.01 * (1.0 - 1e-12)  # the middle one is beyond 0 itself, but for rounding
        return
    found = touching(Counted(function), low, middle, high)
    assert found is not None and holds(function(found)) != holds(function(middle))


def test_a_narrow_kink_is_found() -> None:
    found = touching(lambda x: abs(x - 0.4321) - 1e-5, 0.0, 0.5, 1.0)
    assert found is not None and abs(found - 0.4321) < 1e-5


def test_extremes_that_stay_away_from_0_cost_next_to_nothing() -> None:
    for function in (
        lambda x: 1.0 + (x - 0.45) ** 2,  # too far for how it changes
        lambda x: 0.01 + (x - 0.45) ** 2,
        lambda x: -1.0 if 0.3 < x < 0.9 else -3.0,  # a count: flat
    ):
        counted = Counted(function)
        assert touching(counted, 0.0, 0.5, 1.0) is None
        assert len(counted.known) <= 7
    touched = Counted(lambda x: (x - 0.45) ** 2)  # it touches 0 and never passes it
    assert touching(touched, 0.0, 0.5, 1.0) is None
    assert len(touched.known) <= 60


def test_what_is_near_0_goes_on_as_steeply_as_it_came() -> None:
    assert near_zero(2.0, 1.0, 1.0) and near_zero(-2.0, -1.0, -1.5)
    assert not near_zero(1.9, 1.0, 1.0)  # it would need a steeper slope
    assert not near_zero(3.0, 2.0, 1.0) and not near_zero(1.0, 1.0, 1.0)  # no extreme, no change
    assert not near_zero(2.0, -1.0, 2.0)  # found by the scan itself
    assert not near_zero(math.nan, 1.0, 2.0)
