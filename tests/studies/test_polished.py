"""The search near a good design, on functions whose best point is known."""

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import pytest

from loomfmu.studies.polished import LAST, Floats, Measured, differences, polished


def best(
    goal: Callable[[Floats], float], room: Callable[[Floats], Sequence[float]], start: list[float]
) -> float:
    """The best goal of an allowed point that was seen."""
    seen = []

    def function(points: Sequence[Floats]) -> list[Measured | None]:
        found: list[Measured | None] = []
        for x in points:
            each = Measured(np.array([goal(x)]), np.array(room(x), dtype=float))
            assert np.all(x >= 0.0) and np.all(x <= 1.0)
            if np.all(each.room >= 0.0):
                seen.append(each.heights[0])
            found.append(each)
        return found

    polished(partial(differences, function), np.array(start))
    return min(seen)


@pytest.mark.parametrize(
    ("goal", "room", "start", "expected"),
    [
        (lambda x: (x[0] - 0.37) ** 2 + 3.0 * (x[1] - 0.81) ** 2, lambda x: [], [0.1, 0.1], 0.0),
        # a corner of a claim and the end of a range
        (lambda x: -x[0], lambda x: [0.5 - x[0] * (1.0 + x[1] ** 2)], [0.2, 0.7], -0.5),
        # a curved claim alone
        (lambda x: -(x[0] + 2.0 * x[1]), lambda x: [0.25 - np.sum((x - 0.5) ** 2)], [0.5, 0.5],
         -1.5 - 0.5 * math.sqrt(5.0)),
        # kinks: in the goal, and in a claim, as worst values have them
        (lambda x: (x[0] - 0.3) ** 2 + max(x[1], 1.0 - x[1]), lambda x: [], [0.9, 0.1], 0.5),
        (lambda x: -x[0],
         lambda x: [min(0.9 - x[0] - 0.2 * abs(x[1] - 0.5), 1.0 - x[0] * (1.0 + abs(x[2] - 0.2)))],
         [0.1, 0.1, 0.9], -0.9),
        # a claim that jumps
        (lambda x: -x[0], lambda x: [-1.0 if x[0] > 0.618 else 0.0], [0.1, 0.1], -0.618),
    ],
)  # fmt: skip
def test_the_best_point_is_found(
    goal: Callable[[Floats], float],
    room: Callable[[Floats], Sequence[float]],
    start: list[float],
    expected: float,
) -> None:
    # differences of 1e-5 leave as much of the second order; claims are kept 1e-9 inside their bounds
    assert best(goal, room, start) == pytest.approx(expected, abs=1e-8)


def test_three_curves_that_meet() -> None:
    """CB2 of Charalambous and Conn: the largest of three curves is least where they meet."""

    def goal(x: Floats) -> float:
        a, b = 4.0 * x - 1.0
        return max(a**2 + b**4, (2.0 - a) ** 2 + (2.0 - b) ** 2, 2.0 * math.exp(b - a))

    # published as 1.9522245, to eight digits
    assert best(goal, lambda x: [], [0.5, 0.2]) == pytest.approx(1.9522245, abs=2e-7)


def test_points_that_cannot_be_run_are_walked_around() -> None:
    def function(points: Sequence[Floats]) -> list[Measured | None]:
        return [None if x[0] > 0.7 else Measured(np.array([-x[0]]), np.array([])) for x in points]

    tangent = partial(differences, function)
    assert polished(tangent, np.array([0.2]))[0] == pytest.approx(0.7, abs=1e-4)
    assert polished(tangent, np.array([0.9]))[0] == 0.9
    assert LAST < 1e-6
