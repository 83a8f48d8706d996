"""The surroundings of a best design: what limits it, the gain without that, ranges in which it is as good.

Claims that are as near to their bounds as they may be limit it, and ends of ranges.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np

from ..polished import Floats, Tangent, program
from .near import Near
from .runs import Design, Runs
from .search import ALIKE

NEAR = 1e-6  # of a claim's scale or of a range: what is as near to its end may bind
STEP = 1e-3  # of the ranges, within which a better design is looked for
FAR = 1e9  # of a claim's scale: room that no step takes
PRICE = 1e-9  # of the goal: what is gained by less room does not bind
RELAXED = 0.01  # of a bound, or of a range
PLACES = 17  # of a range that are tried at first; the ends of what is as good are then halved
HALVINGS = 12
NARROW = 0.01  # of a range: as little says nothing
STILL, NOISE = 0.1, 1e-6  # of a gain, and of the goal: what tangents may promise without it; more is a kink


@dataclass(frozen=True)
class Limit:
    """A claim, counted from 0, or a variable at an end of its range, that limits a design, by its name.

    `gain` is about the share of itself by which the goal improves if it alone is relaxed by 1 % of its bound
    or range; NaN where that is not known, as where a claim jumps, and with several goals.
    """

    name: str
    claim: int | None
    gain: float


def binding(runs: Runs, design: Design, names: Sequence[str], bounds: Floats) -> list[Limit]:
    """The claims, by their names and bounds, and the values at an end of their range that limit a design.

    A linear program asks for a step that is better in all goals; what has a price in it binds, and so does
    what a step that minds no claim would take below its bound: of several claims that bind together only one
    has a price. Where a claim jumps, it has no slope: it binds if it fails after that step.
    """
    places = runs.study.continuous
    ranges = [runs.study.variables[place].key for place in places]
    x = np.array([design.point[place] for place in places])
    scales = np.maximum(np.abs(design.heights), 1e-300)
    near_by = Near(runs, design, lambda heights: heights / scales)
    here = near_by.tangent(x) if places else None
    if here is None:
        return []
    step, claims, ends = _priced(here)
    near = design.room <= NEAR
    free = _solved(here, np.full(len(near), FAR), np.maximum(-STEP, -x), np.minimum(STEP, 1.0 - x))
    lost = here.changes @ free.x[: len(x)] < -PRICE if free is not None else np.zeros_like(near)
    binds = near & ((claims > PRICE) | lost)
    (after,) = near_by.at([np.clip(x + step, 0.0, 1.0)])
    jumps = near & ~binds & (after.room < 0.0) if after is not None else np.zeros_like(near)
    relaxed = RELAXED * np.where(bounds == 0.0, 1.0, np.abs(bounds) / runs.limits.scales)
    found = [
        Limit(names[number], number, _gain(here, np.eye(len(names))[number] * relaxed, 0.0 * x))
        for number in np.flatnonzero(binds).tolist()
    ]
    found += [Limit(names[number], number, nan) for number in np.flatnonzero(jumps).tolist()]
    at_end = (x <= NEAR) | (x >= 1.0 - NEAR)
    return found + [
        Limit(ranges[place], None, _gain(here, 0.0 * here.room, RELAXED * np.eye(len(x))[place]))
        for place in np.flatnonzero(at_end & (ends > PRICE)).tolist()
    ]


def _priced(here: Tangent) -> tuple[Floats, Floats, Floats]:
    """The best step, and what room at each claim and at the ends of each range would gain."""
    goals, size = len(here.heights), len(here.x)
    found = _solved(
        here, np.maximum(here.room, 0.0), np.maximum(-STEP, -here.x), np.minimum(STEP, 1.0 - here.x)
    )
    if found is None:
        return np.zeros(size), np.zeros(len(here.room)), np.zeros(size)
    ends = np.maximum(np.abs(found.lower.marginals[:size]), np.abs(found.upper.marginals[:size]))
    return np.asarray(found.x[:size]), np.abs(found.ineqlin.marginals[goals:]), ends


def _gain(here: Tangent, room: Floats, wider: Floats) -> float:
    """Return the gain from more room at claims or wider ranges, by the tangents: others may then bind."""
    if len(here.heights) > 1:
        return nan
    before, after = (
        _solved(
            here,
            np.maximum(here.room, 0.0) + share * room,
            -here.x - share * wider,
            1.0 - here.x + share * wider,
        )
        for share in (0.0, 1.0)
    )
    if before is None or after is None:
        return nan
    gain = before.fun - after.fun if before.fun - after.fun > PRICE else 0.0
    return float(gain) if -before.fun <= max(STILL * gain, NOISE) else nan


def _solved(here: Tangent, room: Floats, low: Floats, high: Floats) -> Any:
    """The linear program for the best step from here; None where it has no solution."""
    goals, claims = len(here.heights), len(here.room)
    matrix = np.block([[here.slopes, -np.ones((goals, 1))], [-here.changes, np.zeros((claims, 1))]])
    costs, limits = np.array([*np.zeros(len(here.x)), 1.0]), np.concatenate([np.zeros(goals), room])
    bounds = [*zip(low.tolist(), high.tolist(), strict=True), (None, None)]
    return program(costs, matrix, limits, bounds)


def indifferent(runs: Runs, best: Design) -> dict[str, tuple[float, float]]:
    """Of each variable with a range, the part about its best value in which the design is as good.

    All else stays. Those of less than 1 % of the range are left out, and those of goals.
    """
    found = {}
    goals = {goal.place for goal in runs.study.goals if goal.kind == "variable"}
    for place in (each for each in runs.study.continuous if each not in goals):
        low, high = (_reached(runs, best, place, end) for end in (0.0, 1.0))
        if high - low >= NARROW:
            variable = runs.study.variables[place]
            found[variable.key] = float(variable.value(low)), float(variable.value(high))
    return found


def _reached(runs: Runs, best: Design, place: int, end: float) -> float:
    """Return how far towards an end of its range a variable may go."""
    shares = np.linspace(best.point[place], end, PLACES).tolist()[1:]
    good = bad = best.point[place]
    for share, fine in zip(shares, _as_good(runs, best, place, shares), strict=True):
        bad = share
        if not fine:
            break
        good = share
    for _halving in range(HALVINGS if bad != good else 0):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if _as_good(runs, best, place, [middle])[0] else (good, middle)
    return float(good)


def _as_good(runs: Runs, best: Design, place: int, shares: list[float]) -> list[bool]:
    points = [(*best.point[:place], share, *best.point[place + 1 :]) for share in shares]
    near = ALIKE * np.abs(best.heights)
    return [
        each.allowed and bool(np.all(np.abs(each.heights - best.heights) <= near)) for each in runs.at(points)
    ]
