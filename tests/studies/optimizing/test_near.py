"""Tangents by derivatives beside those by differences, with several cases and on every kind of range."""

from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from study_files import DEMO, SIMS, study

from loomfmu.cosim.prepared import Prepared
from loomfmu.studies.cases import evaluated
from loomfmu.studies.optimizing import study as studies
from loomfmu.studies.optimizing.near import Near
from loomfmu.studies.optimizing.runs import Runs
from loomfmu.studies.optimizing.start import limits_of, own_point
from loomfmu.studies.polished import Tangent, differences
from loomfmu.sweeps.schedule import local
from loomfmu.sweeps.worker import job_of

FEW = "[set]\nrevolutions = 2\nsteps_per_revolution = 180\n"
CASES = """
[[cases]]
"shaft.speed" = "600 rpm"
[[cases]]
"shaft.speed" = "450 rpm"
"belt.yarn_tension" = "2 N"
"""
CLEARANCE = '"belt.guide_clearance" = { from = "0.2 mm", to = "0.6 mm", logarithmic = true }\n'
MARGIN = "the belt keeps a margin of 10 %"


@contextmanager
def runs_of(path: Path) -> Iterator[Runs]:
    found = studies.load(path)
    loom = Prepared(found.scene, None, found.flavour, (), found.measures)
    own = evaluated(loom, found.situations[0], "none").claims
    job = replace(job_of(found), errors="none", measures=found.measures)
    limits = limits_of(found, own, path)
    with closing(local(found.scene, 1, 1)) as pool:
        runs = Runs(found, job, pool, Path("runs.jsonl"), limits, lambda _count: None, loom)
        with closing(runs):
            yield runs


def both(runs: Runs, x: list[float]) -> tuple[Tangent | None, Tangent | None]:
    (design,) = runs.at([own_point(runs.study)])
    near = Near(runs, design, lambda heights: 3.0 * heights + 1.0)
    return near.tangent(np.array(x)), differences(near.at, np.array(x))


@pytest.mark.parametrize(
    ("text", "scene", "points"),
    [
        (f"maximise = ['belt.guide_clearance', '{MARGIN}']\n[ranges]\n{CLEARANCE}{FEW}{CASES}", DEMO, 3),
        (
            'minimise = "damper_1.peak_load"\n[ranges]\n"damper.free_travel" = ["1 mm", "25 mm"]\n'
            f'"damper.spring_stiffness" = {{ from = "1 N/mm", to = "10 N/mm", logarithmic = true }}\n{FEW}',
            SIMS / "damper.toml",
            4,
        ),
    ],
    ids=["cases", "logarithmic"],
)
def test_derivatives_are_what_differences_approach(text: str, scene: Path, points: int) -> None:
    rng = np.random.default_rng(3)
    with runs_of(study(text, scene, "")) as runs:
        assert runs.derived
        for x in rng.uniform(0.05, 0.95, (points, len(runs.study.continuous))).tolist():
            exact, rough = both(runs, x)
            assert exact is not None and rough is not None
            before = runs.ran
            assert both(runs, x)[0] is not None and runs.ran == before  # of the same runs
            np.testing.assert_array_equal(exact.heights, rough.heights)
            # differences of 1e-5 of a range: the square times the third derivative, and rounding
            for one, other in ((exact.slopes, rough.slopes), (exact.changes, rough.changes)):
                np.testing.assert_allclose(one, other, rtol=1e-4, atol=1e-5 * np.max(np.abs(other)))


def test_a_claim_without_a_derivative_has_differences_and_none_is_taken_for_0() -> None:
    claim = (
        '[[claims]]\nname = "gentle"\nkind = "below"\nsignal = "heald_1.acceleration"\nbound = "300 m/s2"\n'
    )
    scene = Path("gentle.toml")
    scene.write_text(f"{DEMO.read_text()}{claim}")
    text = 'maximise = "shaft.speed"\n[ranges]\n"shaft.speed" = ["400 rpm", "600 rpm"]\n'
    with runs_of(study(text, scene, FEW)) as runs:
        assert runs.derived and runs.slopes((0.5,)) is None
        exact, _rough = both(runs, [0.5])
        assert exact is not None and exact.changes[-1, 0] < -0.1  # it goes with the square of the speed


def test_a_loop_has_differences() -> None:
    text = 'maximise = "shaft.speed"\n[ranges]\n"shaft.speed" = ["200 rpm", "300 rpm"]\n'
    with runs_of(study(text, SIMS / "light_shaft.toml", "[set]\nsteps_per_revolution = 90\n")) as runs:
        assert not runs.derived and runs.slopes((0.5,)) is None
        exact, rough = both(runs, [0.5])
        assert exact is not None and rough is not None
        np.testing.assert_array_equal(exact.changes, rough.changes)
