"""A few verdicts on random scenes of each family beside the truth; `make verdicts` judges many."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
from verdicts.drawing import FAMILIES, MANY, drawn
from verdicts.figures import HEADS, statistics
from verdicts.judging import Found, Truth, confirmed, fine_runs, judged, with_samples
from verdicts.listing import listed

from loomfmu import evaluate

SEED = 5
SETTINGS = [
    {"steps_per_revolution": 90},
    {"steps_per_revolution": MANY},
    {"steps_per_revolution": 24},
]


@pytest.mark.few(2)
@pytest.mark.parametrize("family", FAMILIES)
def test_no_verdict_is_wrong(family: str) -> None:
    scene = drawn(SEED, family, 0)._replace(settings=SETTINGS, fine=[5760, 11520])
    found = confirmed(list(judged(scene)))
    assert len(found) > 60
    wrong = [each for each in found if each.wrong]
    assert not wrong, [(each.claim.label, each.setting, each.stated.bound) for each in wrong]


def test_the_same_seed_draws_the_same_scenes() -> None:
    assert drawn(1, "ramps", 3) == drawn(1, "ramps", 3) != drawn(2, "ramps", 3)


@pytest.mark.parametrize("family", ["belt", "tables"])  # one of them drives inputs itself
def test_a_truth_may_have_samples_where_a_verdict_says_the_worst_value_is(family: str) -> None:
    scene = drawn(SEED, family, 0)
    (trace,) = fine_runs(with_samples(scene, [0.012345, 0.0, math.nan]), [90])
    assert abs(trace.time - 0.012345).min() < 1e-15  # a rounding of revolutions


def one_of_a_belt() -> Found:
    """A verdict that holds, by far."""
    scene = drawn(SEED, "belt", 0)
    found = judged(scene._replace(settings=SETTINGS[1:2], fine=[720, MANY]))
    return next(each for each in found if each.verdict.holds and each.verdict.error < 0.01 * each.truth.scale)


def test_a_verdict_on_the_wrong_side_counts_and_is_listed_as_a_scene(tmp_path: Path) -> None:
    right = replace(one_of_a_belt(), first=True)
    counts = dict(zip(HEADS[2:], statistics([right]), strict=True))
    assert (counts["verdicts"], counts["false_holds"], counts["too_small"]) == ("1", "0", "0")
    away, size = 0.1 * right.truth.scale, right.truth.scale
    wrong = replace(right, truth=Truth(right.verdict.worst + 2.0 * away, 0.0, -away, size))
    counts = dict(zip(HEADS[2:], statistics([wrong]), strict=True))
    assert (counts["false_holds"], counts["wrong_from_1440"], counts["too_small"]) == ("1", "1", "1")
    unsure = replace(wrong, truth=replace(wrong.truth, uncertainty=3.0 * away))
    assert unsure.holds is None and not unsure.wrong and not unsure.too_small
    assert not replace(wrong, verdict=replace(wrong.verdict, decided=False, holds=False)).wrong
    assert replace(right, verdict=replace(right.verdict, holds=False, worst=math.nan)).wrong == "FAILS"
    (text,) = listed([wrong], tmp_path)
    (file,) = tmp_path.iterdir()
    assert f"loomfmu run {file}" in text and "wrong: holds" in text
    assert evaluate(file).claims == (wrong.verdict,)
