"""Ranges in which a best design is as good: the goal stays the same and no claim fails."""

import numpy as np

from .runs import Design, Runs
from .search import ALIKE

PLACES = 17  # of a range that are tried at first; the ends of what is as good are then halved
HALVINGS = 12
NARROW = 0.01  # of a range: as little says nothing


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
