"""What keeps a design from being better: claims that are as near to their bounds as they may be, and ends of
ranges."""

from collections.abc import Sequence

import numpy as np

from .polished import Tangent, tangent
from .runs import Design, Floats, Runs, about

NEAR = 1e-6  # of a claim's scale or of a range: what is as near to its end may bind
STEP = 1e-3  # of the ranges, within which a better design is looked for
PRICE = 1e-9  # of the goal: what is gained by less room does not bind


def binding(runs: Runs, design: Design, names: Sequence[str]) -> list[str]:
    """The claims, by their names, and the values at an end of their range that limit a design.

    A linear program asks for a step that is better in all goals; what has a price in it binds. Where a claim
    jumps, it has no slope: it binds if it fails after that step.
    """
    places = runs.study.continuous
    ranges = [runs.study.variables[place].key for place in places]
    x = np.array([design.point[place] for place in places])
    scales = np.maximum(np.abs(design.heights), 1e-300)
    function = about(runs, design, lambda heights: heights / scales)
    here = tangent(function, x) if places else None
    if here is None:
        return []
    step, claims, ends = _priced(here)
    near = design.room <= NEAR
    found = [name for name, price, close in zip(names, claims, near, strict=True) if close and price > PRICE]
    (after,) = function([np.clip(x + step, 0.0, 1.0)])
    if after is not None:
        fails = near & (after.room < 0.0)
        found += [name for name, fail in zip(names, fails, strict=True) if fail and name not in found]
    at_end = (x <= NEAR) | (x >= 1.0 - NEAR)
    return found + [
        key for key, price, end in zip(ranges, ends, at_end, strict=True) if end and price > PRICE
    ]


def _priced(here: Tangent) -> tuple[Floats, Floats, Floats]:
    """The best step, and what room at each claim and at the ends of each range would gain."""
    from scipy.optimize import linprog

    goals, claims, size = len(here.heights), len(here.room), len(here.x)
    matrix = np.block([[here.slopes, -np.ones((goals, 1))], [-here.changes, np.zeros((claims, 1))]])
    room = np.concatenate([np.zeros(goals), np.maximum(here.room, 0.0)])
    bounds = [*((max(-STEP, -each), min(STEP, 1.0 - each)) for each in here.x.tolist()), (None, None)]
    found = linprog(np.array([*np.zeros(size), 1.0]), A_ub=matrix, b_ub=room, bounds=bounds, method="highs")
    if found.status != 0:
        return np.zeros(size), np.zeros(claims), np.zeros(size)
    ends = np.maximum(np.abs(found.lower.marginals[:size]), np.abs(found.upper.marginals[:size]))
    return np.asarray(found.x[:size]), np.abs(found.ineqlin.marginals[goals:]), ends
