"""The search near a good design: linear programs within a region that shrinks around the best one.

Claims and goals are worst values, so they have kinks: each is modelled by tangents at the designs of the last
steps, which bend where it does. At a corner of claims that bind, a step is one of Newton's method.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

WIDEST, FIRST, LAST = 0.5, 0.1, 1e-9  # of the region, as shares of the ranges
DIFFERENCES = (1e-5, 1e-6, 1e-7)  # steps to either side
BEND = 0.03  # of the steepest slope: if those of both sides differ more, there is a kink between them
INSIDE = 1e-9  # how far inside its limit a claim is put, as a share of its scale: rounding must not fail it
STEEPER, STEEPEST = 10.0, 1e7  # penalty of what claims lack
GAIN = 1e-12  # of the goal: a step that promises less is none
CLOSE = 8.0  # times the region: tangents from farther away are forgotten
STEPS = 80


class Measured(NamedTuple):
    """The measures of a design: the largest of `heights` to minimise, `room` to keep non-negative."""

    heights: Floats
    room: Floats


Function = Callable[[Sequence[Floats]], list[Measured | None]]  # at several points at once


@dataclass(frozen=True)
class Tangent:
    """A point with its values and slopes."""

    x: Floats
    heights: Floats
    room: Floats
    slopes: Floats  # of heights
    changes: Floats  # of room

    def height(self, penalty: float) -> float:
        """The goal, with a penalty for what claims lack."""
        return float(np.max(self.heights) + penalty * max(0.0, -np.min(self.room, initial=0.0)))

    @classmethod
    def of(cls, x: Floats, here: Measured, slopes: Floats, changes: Floats) -> Self:
        """The tangent that keeps claims a little inside their limits."""
        return cls(x, here.heights, here.room - INSIDE, slopes, changes)


def polished(tangent: Callable[[Floats], Tangent | None], start: Floats, last: float = LAST) -> Floats:
    """A point near `start` from which no step is better, `last` or more of the ranges, within 0 and 1."""
    centre = tangent(start)
    if centre is None:
        return start
    near, reach, penalty = [centre], FIRST, STEEPER
    for _step in range(STEPS):
        if reach < last:
            break
        near = [each for each in near if np.max(np.abs(each.x - centre.x)) <= CLOSE * reach]
        x, promised, penalty = _step_to(centre, near, reach, penalty)
        now = centre.height(penalty)
        moved = float(np.max(np.abs(x - centre.x)))
        if now - promised <= GAIN * max(1.0, abs(now)) or moved == 0.0:
            reach *= 0.1
            continue
        found = tangent(x)
        if found is None:
            reach = 0.5 * moved
            continue
        gained = (now - found.height(penalty)) / (now - promised)
        near.append(found)
        if gained > 0.0:
            centre = found
        if gained < 0.1:
            reach = 0.5 * min(moved, reach)
        elif gained > 0.7 and moved > 0.9 * reach:
            reach = min(2.0 * reach, WIDEST)
    return centre.x


def differences(function: Function, x: Floats) -> Tangent | None:
    """Values and slopes at a point, by central differences; None where there are none.

    Where both sides disagree there is a kink between them, and the differences are made smaller.
    """
    found = None
    for difference in DIFFERENCES:
        here, *around = function([x, *_around(x, difference)])
        if here is None:
            return None
        values = np.concatenate([here.heights, here.room])
        ends = [
            (np.concatenate([*(side or here)]) - values, at - x if side else 0.0 * x)
            for side, at in zip(around, _around(x, difference), strict=True)
        ]
        slopes, bend = np.zeros((len(values), len(x))), 0.0
        for place in range(len(x)):
            (less, down), (more, up) = ((rest, step[place]) for rest, step in ends[2 * place :][:2])
            if up > down:
                slopes[:, place] = (more - less) / (up - down)
            if down < 0.0 < up:
                bend = max(bend, float(np.max(np.abs(more / up - less / down))))
        split = len(here.heights)
        found = Tangent.of(x, here, slopes[:split], slopes[split:])
        if bend <= BEND * float(np.max(np.abs(slopes))):
            break
    return found


def _around(x: Floats, difference: float) -> list[Floats]:
    """The points on both sides of a point along each variable, within 0 and 1."""
    steps = difference * np.repeat(np.eye(len(x)), 2, axis=0) * np.tile([-1.0, 1.0], len(x))[:, np.newaxis]
    return list(np.clip(x + steps, 0.0, 1.0))


def _step_to(
    centre: Tangent, near: Sequence[Tangent], reach: float, penalty: float
) -> tuple[Floats, float, float]:
    """Return the model's best point within reach, its prediction, and the penalty that makes claims count."""
    matrix, limits = _model(centre, near)
    size = len(centre.x)
    bounds = [
        *((max(-reach, -each), min(reach, 1.0 - each)) for each in centre.x.tolist()),
        (None, None),
        (0.0, None),
    ]
    least = program(np.array([*np.zeros(size + 1), 1.0]), matrix, limits, bounds)
    if least is None:
        return centre.x, centre.height(penalty), penalty
    while True:
        found = program(np.array([*np.zeros(size), 1.0, penalty]), matrix, limits, bounds)
        if found is None:
            return centre.x, centre.height(penalty), penalty
        if found.x[-1] <= least.x[-1] + 1e-12 or penalty >= STEEPEST:
            break
        penalty *= STEEPER
    x = np.clip(centre.x + found.x[:size], 0.0, 1.0)
    return x, float(found.x[-2] + penalty * found.x[-1]), penalty


def _model(centre: Tangent, near: Sequence[Tangent]) -> tuple[Floats, Floats]:
    """The tangents as rows of a linear program in the step, the goal and what claims lack.

    A tangent that contradicts what is known at the centre belongs to a part that bends the other way, and is
    left out.
    """
    rows, limits = [], []
    for each in near:
        back = centre.x - each.x
        tops, rooms = each.heights + each.slopes @ back, each.room + each.changes @ back
        for top, slope in zip(tops, each.slopes, strict=True):
            if each is centre or top <= np.max(centre.heights):
                rows.append(np.array([*slope, -1.0, 0.0]))
                limits.append(-top)
        for room, change, known in zip(rooms, each.changes, centre.room, strict=True):
            if each is centre or room >= known:
                rows.append(np.array([*-change, 0.0, -1.0]))
                limits.append(room)
    return np.array(rows), np.array(limits)


def program(costs: Floats, matrix: Floats, limits: Floats, bounds: Sequence[Any]) -> Any:
    """Return scipy's result for the least costs of a linear program; None where it has no solution."""
    from scipy.optimize import linprog

    found = linprog(costs, A_ub=matrix, b_ub=limits, bounds=bounds, method="highs")
    return found if found.status == 0 else None
