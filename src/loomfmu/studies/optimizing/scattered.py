"""The search everywhere: differential evolution over all variables, options among them."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from .runs import Design, Floats, Point, Runs
from .study import Study

Height = Callable[[Design], float]  # what is to be made small
EACH = 10  # designs of a generation for each variable
FEWEST, MOST = 24, 100  # designs of a generation
TIGHT = 1e-3  # spread of the goal in a generation at which the search ends


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
