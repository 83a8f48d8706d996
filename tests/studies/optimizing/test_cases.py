"""Load cases: a design counts as it is in the worst of them; corners of tolerances are cases, too."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest
from study_files import DEMO, FAST, GOAL, QUICK, SPEED, searched, study

import loomfmu
from loomfmu import LoomfmuError
from loomfmu.design import loom as design
from loomfmu.studies.optimizing.optimum import _claim_rows
from loomfmu.studies.optimizing.runs import Design
from loomfmu.studies.optimizing.study import load

SAFE = "the loom runs below its safe speed"
WIDEST = 'maximise = "belt.guide_clearance"\n'
CLEARANCE = '[ranges]\n"belt.guide_clearance" = ["0.1 mm", "0.8 mm"]\n'
SLOW_AND_FAST = """
[[cases]]
name = "slow"
"shaft.speed" = "450 rpm"
[[cases]]
name = "fast"
"shaft.speed" = "650 rpm"
"""


def alone(more: str = "") -> Path:
    """The demo with the claim on its safe speed alone, and with more tables."""
    head, *claims = DEMO.read_text().split("[[claims]]")
    (kept,) = (each for each in claims if SAFE in each)
    path = Path("alone.toml")
    path.write_text(f"{head}[[claims]]{kept}\n{more}")
    return path


def test_the_worst_case_decides_as_the_closed_form_says() -> None:
    found = searched(WIDEST + CLEARANCE + SLOW_AND_FAST, alone(), "[set]\nrevolutions = 2\n" + QUICK)
    # that claims are kept 1e-9 inside, and 1e-9 of the extreme between samples
    assert found.goal == pytest.approx(design.clearance_for("650 rpm", "WL680-3600"), rel=1e-8)
    assert found.binding == (SAFE,)
    assert found.verdicts[0].note.startswith("case fast")
    assert "case fast; binds" in _claim_rows(found, found.front[0])[0][-1]
    assert "in the worst of 2 cases" in str(found)
    assert "in the worst of 2 cases" in Path("results/study/best.toml").read_text()
    with Path("results/study/designs.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == found.runs  # designs, each of which was run twice
    again = loomfmu.optimize("study.toml", processes=1)
    assert again.ran == 0 and again.goal == found.goal  # both cases of each are known


def test_a_signal_counts_where_it_is_worst() -> None:
    wanted = 'minimise = "highest weft.velocity"\n[ranges]\n"weft.gear_ratio" = [2.9, 3.3]\n'
    found = searched(wanted + SLOW_AND_FAST, alone(), FAST + QUICK)
    assert found.scene is not None
    with loomfmu.prepare(found.scene, values=["weft.velocity"]) as loom:
        slow, fast = (
            loom.evaluate({"shaft.speed": speed}).trace["weft.velocity"].max()
            for speed in ("450 rpm", "650 rpm")
        )
    # the samples, 4 deg apart, are up to 0.1 % below the highest value between them
    assert found.goal == pytest.approx(max(slow, fast), rel=2e-3) and fast > slow
    assert found.binding == ("weft.gear_ratio",)


def test_the_corners_of_tolerances_are_cases() -> None:
    stated = '[tolerances]\n"shaft.speed" = ["580 rpm", "650 rpm"]\n'
    found = searched(
        f'tolerances = "corners"\n{WIDEST}safety = "0.01 %"\n{CLEARANCE}', alone(stated), FAST + QUICK
    )
    assert [each.name for each in found.study.cases] == [
        "own values", "shaft.speed = 580 rev/min", "shaft.speed = 650 rev/min"
    ]  # fmt: skip
    # the safety distance of 1e-4 in speed takes a few times as much of the clearance
    assert found.goal == pytest.approx(design.clearance_for("650 rpm", "WL680-3600"), rel=1e-3)
    assert loomfmu.tolerances(found.scene or "")  # the worst case within them holds


def test_corners_and_stated_cases_are_combined(tmp_path: Path) -> None:
    stated = '[tolerances]\n"belt.head_mass" = ["105 g", "116 g"]\n'
    found = load(study(f'tolerances = "corners"\n{WIDEST}{CLEARANCE}{SLOW_AND_FAST}', alone(stated)))
    assert len(found.cases) == 6 and found.cases[-1].name == "fast, belt.head_mass = 116 g"
    assert found.cases[-1].settings["belt.head_mass"] == pytest.approx(0.116)


def made(heights: list[float], room: list[float], holds: bool = True, error: str = "") -> Design:
    distances = np.array(room) * 10.0
    return Design((0.0,), (1.0,), np.array(heights), np.array(room), distances, holds, error, ("", ""))


def test_a_design_is_as_bad_as_its_worst_case_in_each_respect() -> None:
    one, other = made([1.0, 5.0], [0.1, -0.2], holds=False), made([2.0, 4.0], [math.nan, 0.3])
    worst = Design.worst({"one": one, "other": other})
    np.testing.assert_array_equal(worst.heights, [2.0, 5.0])
    np.testing.assert_array_equal(worst.room, [math.nan, -0.2])
    np.testing.assert_array_equal(worst.distances, [math.nan, -2.0])
    assert not worst.holds and not worst.allowed and worst.error == ""
    broken = Design.worst({"one": one, "other": made([math.nan, 1.0], [0.1, 0.1], error="it jams")})
    assert broken.error == "in other: it jams" and np.isnan(broken.heights[0])
    assert Design.worst({"": one}) is one


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("cases = 3", "cases are written as [[cases]] tables"),
        ("[[cases]]\nname = 3", "cases: name = 3 is not a name in quotes"),
        ("[[cases]]\nname = 'slow'", "case 'slow' sets nothing; give it values, such as"),
        ("[[cases]]\n'shaft.sped' = '450 rpm'", "case 'case 1': shaft.sped is unknown; did you mean"),
        ("[[cases]]\n'shaft.speed' = '450 m'", "'450 m' is in m, which does not fit rad/s"),
        ("[[cases]]\n'belt.guide_clearance' = '0.3 mm'",
         "case 'case 1' sets belt.guide_clearance, which the study varies or fixes already"),
        ("[[cases]]\n'revolutions' = 3", "case 'case 1' sets revolutions, which the study varies or fixes"),
        (f"{SLOW_AND_FAST}[[cases]]\nname = 'fast'\n'shaft.speed' = '600 rpm'",
         "two cases are called 'fast'"),
        (SLOW_AND_FAST + "".join(f"[[cases]]\n'shaft.speed' = '{500 + n} rpm'\n" for n in range(63)),
         "65 cases; the limit is 64"),
    ],
)  # fmt: skip
def test_cases_that_cannot_be_are_refused(text: str, said: str) -> None:
    at_top = text if text.startswith("cases") else ""
    with pytest.raises(LoomfmuError) as error:
        load(study(f"{at_top}\n{WIDEST}{CLEARANCE}" + ("" if at_top else text)))
    assert said in str(error.value) and str(error.value).startswith("study.toml: ")


@pytest.mark.parametrize(
    ("tolerances", "said"),
    [
        ("", 'corners: the scene states no [tolerances]'),
        ('[tolerances]\n"belt.head_mass" = { normal = ["110 g", "2 g"] }',
         "belt.head_mass is normal without ends; add within"),
        ('[tolerances]\n"belt.guide_clearance" = ["0.2 mm", "0.5 mm"]',
         "sets belt.guide_clearance, which the study varies or fixes already"),
    ],
)  # fmt: skip
def test_corners_that_cannot_be_are_refused(tolerances: str, said: str) -> None:
    with pytest.raises(LoomfmuError) as error:
        load(study(f'tolerances = "corners"\n{WIDEST}{CLEARANCE}', alone(tolerances)))
    assert said in str(error.value)
    with pytest.raises(LoomfmuError, match='tolerances = True must be "corners"'):
        load(study(f"tolerances = true\n{GOAL}{SPEED}", alone(tolerances)))


def test_a_case_that_cannot_be_run_is_refused_before_the_search() -> None:
    jams = "[[cases]]\nname = 'long'\n'weft.coupler_length' = '500 mm'\n"
    with pytest.raises(LoomfmuError, match=r"study.toml: case 'long': "):
        searched(WIDEST + CLEARANCE + jams, alone())


def test_corners_of_other_measured_values_are_another_study() -> None:
    heads = Path("heads.csv")
    heads.write_text("belt.head_mass [g]\n105\n116\n")
    measured = '[tolerances]\n"belt.head_mass" = { measured = "heads.csv" }'
    found = searched(f'tolerances = "corners"\n{WIDEST}{CLEARANCE}', alone(measured), FAST + QUICK)
    heads.write_text("belt.head_mass [g]\n105\n130\n")
    with pytest.raises(LoomfmuError, match="changed since"):
        loomfmu.optimize("study.toml", processes=1)
    heavier = searched(
        f'tolerances = "corners"\n{WIDEST}{CLEARANCE}', alone(measured), FAST + QUICK, restart=True
    )
    assert heavier.goal < found.goal


def test_the_best_scene_finds_the_file_of_a_claim_of_ones_own() -> None:
    Path("own.py").write_text(
        "from loomfmu.claim import OwnClaim, Quantity, argument\n\n\n"
        "class Longest(OwnClaim):\n"
        '    at_most: float = argument(Quantity("m"))\n\n'
        '    def signals(self, run):\n        return ["belt.free_length"]\n\n'
        '    def value(self, run):\n        return run["belt.free_length"].max()\n'
    )
    own = '[[claims]]\nname = "own"\nkind = "own.py:Longest"\nat_most = "9 m"\n'
    found = searched(WIDEST + CLEARANCE, alone(own), FAST + QUICK)
    assert found.verdicts[1].signal == "own.py:Longest" and found.verdicts[1].holds
    assert 'kind = "../../own.py:Longest"' in Path("results/study/best.toml").read_text()
