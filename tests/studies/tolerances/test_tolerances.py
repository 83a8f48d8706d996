"""Worst cases: closed forms, extremes inside the box, what each tolerance costs, what is refused."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from loomfmu import LoomfmuError, limit, prepare, tolerances
from loomfmu.cli import main
from loomfmu.cosim.scenes.scene import parse
from loomfmu.design import loom as design
from loomfmu.studies.tolerances import results
from loomfmu.studies.tolerances.worst_cases import show

DEMO = Path(__file__).parents[3] / "sims" / "wl680_3600.toml"
FAST = {"revolutions": 2, "steps_per_revolution": 90}
MARGIN = "the belt keeps a margin of 10 %"


def test_the_worst_case_is_that_of_the_closed_form() -> None:
    vary = ["shaft.speed=580rpm..620rpm", "belt.guide_clearance=0.2mm..0.5mm"]
    found = tolerances(DEMO, vary=vary, set=FAST)
    (margin,) = (each for each in found.claims if each.claim == MARGIN)
    assert margin.place == {"belt.guide_clearance": 0.5e-3, "shaft.speed": 620.0 * math.pi / 30.0}

    def closed(clearance: float, speed: float) -> float:
        return (
            1.0 - (speed * math.pi / 30.0 / design.safe_speed("WL680-3600", clearance=clearance).speed) ** 2
        )

    worst = closed(0.5e-3, 620.0)
    # the lowest margin between samples 4 deg apart is off by 3e-6
    assert margin.worst.worst == pytest.approx(worst, abs=1e-5) and not margin.worst and not found
    assert [each.key for each in margin.costs] == ["belt.guide_clearance", "shaft.speed"]
    given_back = [closed(0.3e-3, 620.0) - worst, closed(0.5e-3, 600.0) - worst]
    assert [each.distance for each in margin.costs] == pytest.approx(given_back, abs=1e-5)
    # where each of two tolerances alone makes it as bad, none has a cost: all of them are named
    *_rest, where, costs = results.rows(replace(found, claims=(replace(margin, costs=()),)))[0]
    assert where == "shaft.speed = 620 rev/min, belt.guide_clearance = 0.5 mm"
    assert costs == "cost: none alone; it is as bad without any one of them"
    (dwell,) = (each for each in found.claims if each.claim == "the frames dwell long enough")
    assert dwell.costs == () and dwell.worst.worst == dwell.own.worst


SETTLING = """
revolutions = 2
steps_per_revolution = 180
[loom]
machine = "WL680-3600"
head = "G6300 left"
weave = "10/01"
dampers = true
[shaft]
speed = "600 rev/min"
[[claims]]
kind = "peak_load"
damper = "damper_1"
at_most = "5.4 kN"
"""


def test_studies_say_what_a_longer_run_would_change(capsys: pytest.CaptureFixture[str]) -> None:
    """From rest the carrier takes more than the two revolutions of the weave to its highest load."""
    scene = parse(SETTLING)
    show(tolerances(scene, vary="shaft.speed=590rpm..602rpm"))
    said = " ".join(capsys.readouterr().out.split())
    assert re.search(
        r"In its worst case '[^']*' is not settled: about \d+ N in a run of 4 revolutions\.", said
    )
    found = str(limit(scene, vary="shaft.speed=590rpm..602rpm", points=3))
    assert (
        "is not settled: about 5597 N in a run of 4 revolutions; its limits are of the shorter one" in found
    )


def test_a_worst_case_inside_the_box_is_found() -> None:
    """Springs between soft and stiff ones make the load of a carrier the highest."""
    found = tolerances(DEMO.with_name("damper.toml"), vary="damper.spring_stiffness=4N/mm..6.5N/mm", set=FAST)
    load = found.claims[1]
    stiffness = np.linspace(4e3, 6.5e3, 251)
    with prepare(DEMO.with_name("damper.toml"), set=FAST) as loom:
        rows = loom.evaluate_many({"damper.spring_stiffness": stiffness.tolist()}, errors="none")
        distances = [rows.verdicts(row)[1].distance for row in range(len(stiffness))]
    assert 4.5e3 < load.place["damper.spring_stiffness"] < 6e3
    assert load.worst.distance <= min(distances)  # rows 10 N/m apart come no nearer
    assert load.worst.distance == pytest.approx(min(distances), abs=0.05)
    assert found.runs < 60  # 19 points, and a few along the derivatives of each claim


def test_the_table_of_a_scene_is_what_the_command_searches(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene = tmp_path / "loom.toml"
    short = "revolutions = 2\nsteps_per_revolution = 90"
    text = DEMO.read_text().replace("revolutions = 3\nsteps_per_revolution = 1440", short)
    scene.write_text(f'{text}\n[tolerances]\n"belt.guide_clearance" = ["0.2 mm", "0.35 mm"]\n')
    assert prepare(scene).scene.tolerances == {"belt.guide_clearance": ("0.2 mm", "0.35 mm")}
    picture = tmp_path / "worst.svg"
    assert main(["tolerances", str(scene), "--picture", str(picture)]) == 0
    said = capsys.readouterr().out
    assert "belt.guide_clearance 0.2 to 0.35 mm (0.3 mm in the scene)" in said
    assert "belt.guide_clearance = 0.35 mm" in said and "not a proof" in said
    assert picture.read_text().startswith("<?xml")
    assert main(["tolerances", str(scene), "--vary", "belt.guide_clearance=0.2mm..0.9mm"]) == 1


@pytest.mark.parametrize(
    ("vary", "said"),
    [
        ([], "there are no tolerances; write"),
        (["belt.guide_clearance=0.4mm..0.5mm"], "0.3 mm in the scene is outside its tolerance, 0.4 to"),
        (["belt.guide_clearance=0.2mm..0.5mm", "belt.guide_clearance=0.2mm..0.4mm"], "has two tolerances"),
        (["belt.guide_clearance=0.5mm..0.2mm"], "is empty"),
        (["heald.stroke=10mm..98mm"], r"heald\.stroke = 10 mm: .*clear_shed"),
    ],
)
def test_what_cannot_be_searched_is_refused(vary: list[str], said: str) -> None:
    with pytest.raises(LoomfmuError, match=said):
        tolerances(DEMO, vary=vary, set=FAST)


@pytest.mark.parametrize(
    ("table", "said"),
    [
        (
            '"belt.guide_clearence" = ["0.2 mm", "0.5 mm"]',
            "guide_clearence is unknown; did you mean 'guide_clearance'",
        ),
        ('"belt.guide_clearance" = ["0.2 mm", "0.5 kg"]', "'0.5 kg' is in kg, which does not fit m"),
        ('"belt.guide_clearance" = ["0.2 mm", "0.5 m"]', "belt.guide_clearance = 500 mm is outside"),
        ('"belt.travel" = [0, 1]', "belt.travel cannot be set, it is wired to weft.travel"),
        ('"bolt.guide_clearance" = [0, 1]', "the scene has no instance 'bolt'; did you mean 'belt'?"),
        ('"revolutions" = [1, 2]', "revolutions cannot have a tolerance"),
        ('"belt.guide_clearance" = "0.2 mm"', r'such as .*\["0.2 mm", "0.5 mm"\]'),
        ("tolerances = 3", r'such as .*\["0.2 mm", "0.5 mm"\]'),
    ],
)
def test_a_scene_is_read_with_tolerances_that_can_be_set(table: str, said: str, tmp_path: Path) -> None:
    scene = tmp_path / "loom.toml"
    text = DEMO.read_text()
    whole = f"{table}\n{text}" if table.startswith("tolerances") else f"{text}\n[tolerances]\n{table}\n"
    scene.write_text(whole)
    with pytest.raises(LoomfmuError, match=f"loom.toml: tolerances.*{said}"):
        prepare(scene)


def test_warnings_of_the_scene_are_those_of_a_run(capsys: pytest.CaptureFixture[str]) -> None:
    options = ["--set", "revolutions=2", "--set", "weft.speed=400rpm"]
    assert main(["tolerances", str(DEMO), "--vary", "belt.guide_clearance=0.2mm..0.35mm", *options]) == 0
    assert (
        capsys.readouterr().err.strip() == "warning: weft.speed has no effect: set weft.follow_shaft = false"
    )


def test_the_scene_may_be_its_own_worst_case() -> None:
    found = tolerances(DEMO, vary="shaft.speed=300rpm..600rpm", set=FAST)
    where = {claim: place for _word, claim, _own, _worst, place, _cost in results.rows(found)}
    assert where[MARGIN] == "worst at the scene's own value"
    assert where["the frames dwell long enough"] == "the same everywhere"
