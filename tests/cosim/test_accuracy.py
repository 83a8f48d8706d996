"""Steps that are chosen for an accuracy: reached, the fewest of those tried, refused where it cannot be."""

import re
from itertools import pairwise
from pathlib import Path

import pytest
from scene_texts import LOOM, claim, parsed

from loomfmu import LoomfmuError, Trace, evaluate, limit, prepare
from loomfmu.cli import main
from loomfmu.cosim.accuracy import GROWTH, tried_steps

DEMO = Path(__file__).parents[2] / "sims" / "wl680_3600.toml"
REPEAT = {"revolutions": 2}  # of the weave
EXACT = 0.22556868  # the demonstration's lowest margin in closed form, see results/validation.md
LIGHT = DEMO.with_name("light_shaft.toml")


@pytest.mark.parametrize("accuracy", [1e-3, 1e-5, 1e-7])
def test_the_accuracy_is_reached_with_the_fewest_steps_tried(accuracy: float) -> None:
    found = evaluate(DEMO, set=REPEAT | {"accuracy": accuracy})
    assert all(each.error <= accuracy * abs(each.bound) for each in found.claims)
    assert abs(found.claims[0].worst - EXACT) <= accuracy * 0.1 + 1e-8  # digits of the exact value
    steps = found.scene.steps_per_period
    assert re.fullmatch(
        rf"chose {steps} steps in a revolution: estimated error \S+, accuracy {accuracy:g}", found.chosen
    )
    fewer = evaluate(DEMO, set=REPEAT | {"steps_per_revolution": round(steps / GROWTH)})
    if steps > 63:  # the fewest that have three coarser runs
        assert any(each.error > accuracy * abs(each.bound) for each in fewer.claims)


def test_the_run_says_and_stores_what_it_chose(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "chosen.h5"
    command = ["run", str(DEMO), "--set", "accuracy=1e-4", "--set", "revolutions=2", "--output", str(path)]
    assert main(command) == 0
    printed = capsys.readouterr().out
    assert "chose 63 steps in a revolution: estimated error" in printed
    trace = Trace(path)
    assert trace.attributes["accuracy"] == 0.0001 and trace.attributes["steps_per_revolution"] == 63
    assert trace.verdicts == list(evaluate(DEMO, set=REPEAT | {"accuracy": 1e-4}).claims)


def test_each_row_chooses_its_own_steps_and_a_search_keeps_them() -> None:
    with prepare(DEMO, set=REPEAT | {"accuracy": 1e-5}) as loom:
        slow, fast = (loom.evaluate({"shaft.speed": f"{speed} rpm"}) for speed in (200, 600))
        assert slow.chosen and fast.chosen
        searched = loom.evaluate({"shaft.speed": "200 rpm"}, errors="none")
        assert searched.scene.steps_per_period == fast.scene.steps_per_period
    found = limit(DEMO, vary="shaft.speed=600rpm..700rpm", set=REPEAT | {"accuracy": 1e-6})
    speed = found.claims[0].limits[0].value / found.span.value * 600.0
    assert speed == pytest.approx(681.80440 * 0.9**0.5, rel=1e-6)


def test_a_loop_is_iterated_unless_the_scene_says_otherwise() -> None:
    text = LIGHT.read_text()
    assert parsed(text.replace('coupling = "iterated"', ""), accuracy=1e-3).coupling == "iterated"
    assert parsed(text, accuracy=1e-3, coupling="lagged").coupling == "lagged"
    assert parsed(DEMO.read_text(), accuracy=1e-3).coupling == "lagged"  # it has no loop


def test_setting_one_replaces_the_other() -> None:
    text = DEMO.read_text().replace("steps_per_revolution = 1440", "accuracy = 1e-3")
    assert parsed(text).accuracy == 1e-3
    assert parsed(text, steps_per_revolution=90).accuracy is None


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"accuracy": 1e-6, "steps_per_revolution": 90}, "accuracy and steps_per_revolution are both given"),
        ({"accuracy": 2.0}, r"accuracy = 2 is outside \[1e-12, 1\]"),
        ({"accuracy": "good"}, "accuracy = 'good' is not a number"),
        (
            {"accuracy": 1e-12, "revolutions": 1},
            "accuracy = 1e-12 is not reached: with 12543 steps in a revol",
        ),
    ],
)
def test_what_cannot_be_chosen_is_refused_in_one_line(given: dict[str, object], message: str) -> None:
    with pytest.raises(LoomfmuError, match=message) as refused:
        evaluate(DEMO, set=given)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("parts", "said"),
    [
        ((LOOM,), "the scene has none: add"),
        (
            ('duration = "1 s"\nstep = "1 ms"\n', LOOM, claim("lowest_margin", bound=0)),
            "the scene runs by seconds",
        ),
    ],
)
def test_an_accuracy_needs_claims_and_revolutions(parts: tuple[str, ...], said: str) -> None:
    with pytest.raises(LoomfmuError, match=said):
        parsed(*parts, accuracy=1e-6)


@pytest.mark.parametrize("revolutions", [1, 2.5, 2.025, 2.0625, 91 / 45, 1 + 1 / 1440])
def test_steps_that_are_tried_grow_and_are_no_multiples_of_those_before(revolutions: float) -> None:
    """With 2.025 revolutions 40 steps were compared with 40 steps."""
    tried = list(tried_steps(revolutions))
    assert all((steps * revolutions) % 1 == pytest.approx(0.0, abs=1e-6) for steps in tried)
    assert all(1.45 <= more / fewer <= 1.7 and more % fewer for fewer, more in pairwise(tried))
    assert len(tried) > 3
