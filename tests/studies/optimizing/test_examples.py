"""The studies that come with the project: they can be read, and dense sweeps find nothing better."""

from collections.abc import Sequence
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from study_files import SIMS

from loomfmu import Optimum, optimize
from loomfmu.cosim.run import prepare
from loomfmu.studies.optimizing.study import load

STUDIES = sorted((SIMS / "studies").glob("*.toml"))


def test_the_examples_are_those_of_the_docs() -> None:
    assert [path.name for path in STUDIES] == ["damper_load.toml", "fastest.toml"]
    for path in STUDIES:
        assert len(load(path).goals) == 1


def best_of_grid(found: Optimum, grid: Sequence[Sequence[object]]) -> tuple[float, int]:
    """The best goal of the designs of a grid in which all claims hold, and how many designs there are."""
    study, count, heights = found.study, 0, []
    (goal,) = study.goals
    with prepare(study.scene, values=study.measures) as loom:
        for values in product(*grid):
            count += 1
            run = loom.evaluate(study.setting(values))  # type: ignore[arg-type]
            if run.holds:
                value = run.trace[goal.name][-1] if goal.kind == "signal" else values[goal.place]
                heights.append(goal.sign * float(value))  # type: ignore[arg-type]
    return goal.sign * min(heights), count


@pytest.mark.slow
def test_no_row_of_a_dense_sweep_is_better(tmp_path: Path) -> None:
    damper, fastest = (optimize(path, output=tmp_path / path.stem, processes=1) for path in STUDIES)
    best, count = best_of_grid(damper, [np.geomspace(1e3, 1e4, 200), np.linspace(1e-3, 25e-3, 20)])
    # the kink is as wide as a step of the grid: 1.2 % of the stiffness
    assert count == 4000 and damper.goal <= best < 1.01 * damper.goal
    rpm = np.pi / 30.0
    choices = [each.options for each in fastest.study.variables if not each.range]
    grid = [np.arange(400.0, 901.0, 10.0) * rpm, np.linspace(0.2, 0.8, 7), np.linspace(0.2e-3, 0.5e-3, 4)]
    best, count = best_of_grid(fastest, [*grid, *choices])
    assert count == 17136 and best <= fastest.goal < best + 10.0 * rpm
