"""The search: everywhere, then near the best design of each combination of options, for each kind of best."""

from collections.abc import Callable, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from ..polished import LAST, Floats, polished
from .near import Near, Pieces
from .runs import Design, Point, Runs
from .start import check_effects, check_options
from .study import Study

Height = Callable[[Design], float]  # what is to be made small
EACH = 10  # designs of a generation for each variable
FEWEST, MOST = 24, 100  # designs of a generation
TIGHT = 1e-3  # spread of the goal in a generation at which the search ends
POLISHED = 6  # combinations of options that are searched near their best design
FEW = 24  # combinations of options, each of which is searched with derivatives
SAVED = 300  # designs of a search everywhere in place of which derivatives start from one more
APART = 0.2  # of the ranges: how far such starts lie from each other
ROUGH = 1e-2  # of the ranges: how near to an end of its way each start is led; the best goes to that end
SPREAD = 4  # designs of each combination of options from which the best one starts
CLIMBED = 10  # runs from a start with derivatives, as a progress bar expects them
EXPECTED = 60  # runs of that for each variable, as a progress bar expects them
BETWEEN = 4  # a design within a front has that part of the runs of one at its ends
ALIKE = 1e-7  # of a goal: what the search near a design leaves open
TIE = 1e-4  # weight of the sum of all goals beside the largest: none is worse than it must be


def expected(study: Study, derived: bool) -> int:
    """Return roughly how many designs a search will run, with derivatives or without."""
    if study.enumerable:
        return study.combinations
    if _climbs(study, derived):
        kinds, starts = len(_weights(study)), max(study.combinations, study.search["runs"] // SAVED)
        return generation(study) + SPREAD * study.combinations + CLIMBED * starts * kinds
    near = EXPECTED * len(study.continuous) * min(study.combinations, POLISHED)
    inside = len(_weights(study)) - len(study.goals) if len(study.goals) > 1 else 0
    ends = (study.search["runs"] + near) * len(study.goals)
    return ends + inside * (study.search["runs"] // BETWEEN + near)


def searched(runs: Runs, own: Point, path: Path) -> list[Design]:
    """The best designs: one for a single goal, else a front in the order of the first goal; none if no design
    meets all claims. Raises LoomfmuError for a variable that changes nothing."""
    study, seed = runs.study, runs.study.search["seed"]
    first = first_points(study, own, generation(study), seed)
    check_options(runs, first, path)
    check_effects(runs, first, path)
    if study.enumerable:
        runs.at(list(product(*(map(float, range(len(each.options))) for each in study.variables))))
    if _climbs(study, runs.derived):
        runs.at(_spread_over(study, first[:SPREAD]))
    known = np.array([each.heights for each in runs.at(first)])
    scales = _spread(known)
    count = len(study.goals)
    budget = study.search["runs"]
    if count == 1:
        return _best(runs, lambda heights: heights / scales, first, budget)
    ends = [_best(runs, _end(place, scales), first, budget) for place in range(count)]
    if not all(ends):
        return []
    corner = np.array([each.heights for (each,) in ends])
    ideal, far = corner.min(axis=0), np.maximum(_spread(corner), 1e-9 * scales)
    found = [each for (each,) in ends]
    for weights in _weights(study):
        if np.count_nonzero(weights) > 1:
            found += _best(runs, _towards(weights, ideal, far), first, budget // BETWEEN)
    return _front(found)


def _spread_over(study: Study, points: Sequence[Point]) -> list[Point]:
    """The points with each combination of options."""
    numbers = [[None] if each.range else map(float, range(len(each.options))) for each in study.variables]
    return [
        tuple(own if number is None else number for own, number in zip(point, numbers, strict=True))
        for numbers in product(*numbers)
        for point in points
    ]


def _spread(heights: Floats) -> Floats:
    """Return the range of each goal's values, 1 if they are all equal."""
    known = np.where(np.isfinite(heights), heights, np.nan)
    with np.errstate(invalid="ignore"):
        spread = np.nan_to_num(
            np.nanmax(known, axis=0, initial=-np.inf) - np.nanmin(known, axis=0, initial=np.inf)
        )
    return np.where((spread > 0.0) & np.isfinite(spread), spread, 1.0)


def _end(place: int, scales: Floats) -> Pieces:
    """One goal alone; the others decide between designs that are alike in it."""
    return lambda heights: np.array([heights[place] / scales[place] + TIE * float(np.sum(heights / scales))])


def _towards(weights: Floats, ideal: Floats, far: Floats) -> Pieces:
    """The weighted distance from the best of each goal, of the goal that is the farthest."""

    def pieces(heights: Floats) -> Floats:
        shares = (heights - ideal) / far
        return np.asarray(weights * shares + TIE * float(np.sum(shares)))

    return pieces


def _weights(study: Study) -> list[Floats]:
    """Weights of the goals, spread evenly."""
    count, steps = len(study.goals), study.search["points"] - 1
    return [np.array(each) / steps for each in product(range(steps + 1), repeat=count) if sum(each) == steps]


def _best(runs: Runs, pieces: Pieces, first: Sequence[Point], budget: int) -> list[Design]:
    """The best design by these pieces, if any meets all claims."""

    def height(design: Design) -> float:
        return float(np.max(pieces(design.heights)))

    if not runs.study.enumerable:
        _search(runs, pieces, height, first, budget)
    allowed = [each for each in runs.designs.values() if each.allowed]
    return [min(allowed, key=height)] if allowed else []


def _search(
    runs: Runs, pieces: Pieces, height: Callable[[Design], float], first: Sequence[Point], budget: int
) -> None:
    """Search everywhere, then near the best designs; the designs are kept in `runs`."""

    def rank(design: Design) -> tuple[float, float]:
        return design.shortfall, height(design) if np.all(np.isfinite(design.heights)) else np.inf

    if _climbs(runs.study, runs.derived):
        leaders = _leaders(runs, rank, max(1, budget // SAVED // runs.study.combinations))
    else:
        known = sorted(runs.designs.values(), key=rank)[: len(first) // 2]
        start = list(dict.fromkeys([*(each.point for each in known), *first]))[: len(first)]
        scattered(runs, height, start, budget, runs.study.search["seed"])
        leaders = [_stepped(runs, each, rank) for each in _leaders(runs, rank)[:POLISHED]]
    for last in (ROUGH, LAST) if runs.study.continuous else ():
        for design in leaders:
            shares = np.array([design.point[place] for place in runs.study.continuous])
            polished(Near(runs, design, pieces).tangent, shares, last)
        leaders = _leaders(runs, rank)[:1]


def _climbs(study: Study, derived: bool) -> bool:
    """Return whether derivatives lead to the best design of each combination of options."""
    return derived and bool(study.continuous) and study.combinations <= FEW


def _leaders(runs: Runs, rank: Callable[[Design], tuple[float, float]], each_has: int = 1) -> list[Design]:
    """The best designs of each combination of options, so many of each that lie apart."""
    ranges = runs.study.continuous
    found: dict[tuple[float, ...], list[Floats]] = {}
    leaders = []
    for design in sorted(runs.designs.values(), key=rank):
        shares = np.array([design.point[place] for place in ranges])
        options = tuple(round(n) for place, n in enumerate(design.point) if place not in ranges)
        alike = found.setdefault(options, [])
        apart = all(np.max(np.abs(shares - each)) > APART for each in alike)
        if len(alike) < each_has and apart and not design.error:
            alike.append(shares)
            leaders.append(design)
    return leaders


def _stepped(runs: Runs, design: Design, rank: Callable[[Design], tuple[float, float]]) -> Design:
    """A design with better whole numbers, if there is one: by steps to either side, the next half as long."""
    variables = runs.study.variables
    places = [place for place, each in enumerate(variables) if isinstance(each.options, range)]
    step = 2.0 ** max((int(variables[place].last).bit_length() for place in places), default=0)
    while places and step >= 1.0:
        points = [
            (*design.point[:place], number, *design.point[place + 1 :])
            for place in places
            for number in (round(design.point[place]) - step, round(design.point[place]) + step)
            if 0.0 <= number <= variables[place].last
        ]
        best = min([design, *runs.at(points)], key=rank)
        step = step if best is not design else step / 2.0
        design = best
    return design


def _front(designs: Sequence[Design]) -> list[Design]:
    """Those that no other one is better than in one goal and as good in all, each once.

    What differs by less than a search finds counts as equal.
    """
    ordered = sorted(designs, key=lambda each: tuple(each.heights.tolist()))
    heights = np.array([each.heights for each in ordered])
    same = ALIKE * np.max(np.abs(heights), axis=0)
    best: list[int] = []
    for number, here in enumerate(heights):
        no_worse = np.all(heights <= here + same, axis=1)
        better = no_worse & np.any(heights < here - same, axis=1)
        if not np.any(better) and not np.any(no_worse[best]):
            best.append(number)
    return [ordered[number] for number in best]


# ---- everywhere: differential evolution over all variables, options among them


def first_points(study: Study, own: Point, count: int, seed: int) -> list[Point]:
    """The scene's own design, and others spread evenly over ranges and options."""
    from scipy.stats import qmc

    spread = qmc.Halton(len(study.variables), rng=seed).random(count - 1).tolist()
    places = [tuple(map(_number, study.variables, each)) for each in spread]
    return [own, *places]


def _number(variable: Any, share: float) -> float:
    """The number of a variable at a share of all its numbers."""
    return share if variable.range else float(min(int(share * (variable.last + 1.0)), int(variable.last)))


def generation(study: Study) -> int:
    """Return the number of designs in a generation."""
    return min(max(EACH * len(study.variables), FEWEST), MOST)


def scattered(runs: Runs, height: Height, start: Sequence[Point], budget: int, seed: int) -> None:
    """Search from a first generation, as far as `budget` runs go; the designs are kept in `runs`.

    A design that is not allowed ranks by how much it lacks, below all that are.
    """
    from scipy.optimize import NonlinearConstraint, differential_evolution

    def designs(numbers: Floats) -> list[Design]:
        return runs.at([tuple(each) for each in np.atleast_2d(numbers.T).tolist()])

    def shortfall(numbers: Floats) -> Floats:
        found = np.array([each.shortfall for each in designs(numbers)])
        return found[np.newaxis] if numbers.ndim > 1 else found

    def goal(numbers: Floats) -> Floats:
        return np.array([height(each) if each.allowed else np.inf for each in designs(numbers)])

    variables = runs.study.variables
    differential_evolution(
        goal,
        [(0.0, each.last) for each in variables],
        init=np.array(start),
        rng=seed,
        polish=False,
        constraints=NonlinearConstraint(shortfall, -np.inf, 0.0),
        vectorized=True,
        updating="deferred",
        integrality=[each.range is None for each in variables],
        tol=TIGHT,
        maxiter=max(1, budget // len(start) - 1),
    )
