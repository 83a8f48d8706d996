"""Error bars by tolerances beside drawn looms and searched worst cases, and where there are none."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import loomfmu
from loomfmu import LoomfmuError, Result, Trace
from loomfmu.cosim.scenes.scene import parse
from loomfmu.studies.tolerances.distributions import distribution_of
from loomfmu.studies.tolerances.error_bars import SHARES, _bar

SIMS = Path(__file__).parents[3] / "sims"
DEMO = "wl680_3600"
FEW = {"revolutions": 2, "steps_per_revolution": 180}
NARROW = """
"belt.guide_clearance" = ["0.29 mm", "0.31 mm"]
"belt.head_mass" = { normal = ["110.5 g", "0.5 g"], within = ["109 g", "112 g"] }
"shaft.speed" = ["590 rev/min", "610 rev/min"]
"""
LOOMS = 200
SAMPLES = """
[[claims]] # undecided, as nothing is known of its signal between the samples
kind = "below"
signal = "damper_1.spring_force"
bound = "50 kN"
"""
BETWEEN = """
[[claims]] # judged by the mechanism's own function, as its signal has no rate
kind = "below"
signal = "heald_1.acceleration"
bound = "300 m/s2"
"""


def ran(folder: Path, tolerances: str, scene: str = DEMO, **given: Any) -> Result:
    path = folder / f"{scene}.toml"
    path.write_text((SIMS / path.name).read_text() + f"\n[tolerances]\n{tolerances}")
    return loomfmu.run(path, set=FEW | given, output=path.with_suffix(".h5"), overwrite=True)


def test_they_are_those_of_drawn_looms_and_of_the_searched_worst_case(tmp_path: Path) -> None:
    result = ran(tmp_path, NARROW)
    path = tmp_path / f"{DEMO}.toml"
    drawn = loomfmu.draw_looms(path, looms=LOOMS, set=FEW)
    with loomfmu.prepare(path, set=FEW) as loom:
        many = loom.evaluate_many({key: each.tolist() for key, each in drawn.values.items()}, errors="none")
    distances = np.array([[each.distance for each in many.verdicts(row)] for row in range(LOOMS)])
    searched = loomfmu.tolerances(path, set=FEW)
    moved = [0, 1, 5]  # the dwells and the shed depend on none of the three
    for number, (verdict, case) in enumerate(zip(result.claims, searched.claims, strict=True)):
        worst = case.own.distance - case.worst.distance
        if number in moved:
            # the deviation of a sample of 200 has a standard error of 5 %
            assert verdict.deviation == pytest.approx(np.std(distances[:, number]), rel=0.15)
            # what is of second order: shares of 3 % of the values, squared, times the slopes
            assert verdict.loss == pytest.approx(worst, rel=0.05)
            assert "by tolerances (first order), standard deviation" in verdict.note
        else:
            assert verdict.loss == pytest.approx(0.0, abs=1e-9) and worst == 0.0
            assert verdict.note == "tolerances do not move it (first order)"


def test_the_trace_keeps_them_and_scenes_without_tolerances_have_none(tmp_path: Path) -> None:
    result = ran(tmp_path, NARROW)
    (first, *_), (stored, *_) = result.claims, Trace(result.path).verdicts
    assert (stored.loss, stored.deviation) == (first.loss, first.deviation)
    assert f"{100.0 * first.loss / first.bound:.2g} %" in stored.note
    assert {"loss", "deviation"} <= json.loads(json.dumps(first.as_dict())).keys()
    plain = loomfmu.run(SIMS / f"{DEMO}.toml", set=FEW, output=tmp_path / "plain.h5").claims[0]
    assert not {"loss", "deviation"} & plain.as_dict().keys() and plain.note == ""


def test_a_normal_distribution_without_ends_has_no_worst_case(tmp_path: Path) -> None:
    margin = ran(tmp_path, '"belt.head_mass" = { normal = ["110.5 g", "0.5 g"] }').claims[0]
    slope = loomfmu.gradient(
        tmp_path / f"{DEMO}.toml", of="belt.lowest_margin", by="belt.head_mass", set=FEW
    ).si
    assert margin.deviation == pytest.approx(abs(slope[0, 0]) * 0.5e-3, rel=1e-3)  # shares of 1e-4
    assert np.isnan(margin.loss) and margin.note.startswith("standard deviation ")


def test_a_claim_on_a_signal_without_a_rate_has_the_slope_of_its_samples(tmp_path: Path) -> None:
    verdict = ran(tmp_path, f'"shaft.speed" = ["580 rpm", "620 rpm"]\n{BETWEEN}').claims[-1]
    # accelerations go with the square of the speed, of which 20 of 600 rev/min are a thirtieth
    assert verdict.loss == pytest.approx(2.0 / 30.0 * verdict.worst, rel=1e-3)
    assert verdict.deviation == pytest.approx(verdict.loss / np.sqrt(3.0), rel=1e-3)


@pytest.mark.parametrize(
    ("scene", "tolerances", "number", "why"),
    [
        ("damper", '"damper.damping_ratio" = [0, 0.2]', 0, "it counts or decides, so it has no derivative"),
        ("light_shaft", '"weft.belt_length" = ["2.9 m", "3.1 m"]', 0,
         "closes a loop, which has no derivatives"),
        (DEMO, f'"shaft.speed" = ["580 rpm", "620 rpm"]\n{SAMPLES}', -1, "it has no distance from its bound"),
        (DEMO, '"shaft.speed" = ["580 rpm", "590 rpm"]', 1, "600 rev/min is outside its tolerance"),
    ],
)  # fmt: skip
def test_a_claim_without_a_bar_says_why(
    tmp_path: Path, scene: str, tolerances: str, number: int, why: str
) -> None:
    verdict = ran(tmp_path, tolerances, scene).claims[number]
    assert np.isnan(verdict.loss) and np.isnan(verdict.deviation)
    assert "no error bar by tolerances: " in verdict.note and why in verdict.note


def test_tolerances_that_cannot_be_read_are_refused_before_the_run(tmp_path: Path) -> None:
    with pytest.raises(LoomfmuError, match=r"belt\.guide_clearance: the range from 1 mm to 0\.2 mm is empty"):
        ran(tmp_path, '"belt.guide_clearance" = ["1 mm", "0.2 mm"]')
    assert not (tmp_path / f"{DEMO}.h5").exists()


def test_values_measured_together_vary_together(tmp_path: Path) -> None:
    rows = "\n".join(f"{100 + n},{0.5 - 0.01 * n}" for n in range(10))
    (tmp_path / "heads.csv").write_text(f"belt.head_mass [g],belt.guide_clearance [mm]\n{rows}\n")
    text = (SIMS / f"{DEMO}.toml").read_text()
    scene = parse(text, "loom", {}, tmp_path)
    found = [
        distribution_of(scene, key, {"measured": "heads.csv"})
        for key in ("belt.head_mass", "belt.guide_clearance")
    ]
    values, drawn = [0.1, 0.5e-3], [each.quantiles(SHARES) for each in found]
    steady = _bar(
        found, values, drawn, np.array([[1.0, 100.0], [1.0, 100.0]])
    )  # 1 g for -0.01 mm: the sum stays
    assert steady.deviation == pytest.approx(0.0, abs=1e-12)
    moved = _bar(found, values, drawn, np.array([[1.0, 0.0], [1.0, 0.0]]))
    assert moved.deviation == pytest.approx(1e-3 * np.std(np.arange(10)), rel=1e-6)


def test_at_a_kink_each_end_has_the_slope_of_its_side(tmp_path: Path) -> None:
    claims = """
[[claims]]
kind = "below"
signal = "abs(heald_1.lift + heald_2.lift - 98 mm)"
bound = "1 mm"
[[claims]]
kind = "rapier_in_open_shed"
head_height = "9.4 mm"
"""
    path, tolerances = tmp_path / "tie.toml", '"heald_2.stroke" = ["96.5 mm", "99 mm"]\n'
    text = (SIMS / f"{DEMO}.toml").read_text()
    path.write_text(text + f"\n[tolerances]\n{tolerances}{claims}")
    bars = loomfmu.run(path, set=FEW, output=tmp_path / "tie.h5").claims[-2:]
    with loomfmu.prepare(path, set=FEW) as loom:
        ends = [loom.evaluate({"heald_2.stroke": each}).claims[-2:] for each in ("96.5 mm", "99 mm")]
    for bar, *others in zip(bars, *ends, strict=True):
        # both frames are alike: what makes one of them worse takes from the distance, to either side
        loss = bar.distance - min(each.distance for each in others)
        assert loss > 0.0
        assert bar.loss == pytest.approx(loss, rel=0.1)  # what is of second order: 6 % of the room
