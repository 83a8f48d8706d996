"""A few verdicts on random scenes of each family beside the truth; `make verdicts` judges many."""

import pytest
from verdicts.drawing import FAMILIES, MANY, drawn
from verdicts.judging import confirmed, judged

SEED = 5
SETTINGS = [
    {"steps_per_revolution": 90},
    {"steps_per_revolution": MANY},
    {"steps_per_revolution": MANY, "grid": "windows"},
]


@pytest.mark.parametrize("family", FAMILIES)
def test_no_verdict_is_wrong_with_usual_steps(family: str) -> None:
    scene = drawn(SEED, family, 0)._replace(settings=SETTINGS, fine=[5760, 11520])
    found = confirmed(list(judged(scene)))
    assert len(found) > 100
    wrong = [each for each in found if each.wrong and each.steps >= MANY]
    assert not wrong, [(each.claim.label, each.setting, each.stated.bound) for each in wrong]


def test_the_same_seed_draws_the_same_scenes() -> None:
    assert drawn(1, "ramps", 3) == drawn(1, "ramps", 3) != drawn(2, "ramps", 3)
