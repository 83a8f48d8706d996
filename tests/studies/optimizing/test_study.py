"""Study files: what they may say, and what is refused in one line that names the file."""

from pathlib import Path

import pytest
from study_files import DEMO, FAST, GOAL, SPEED, searched, study

from loomfmu import LoomfmuError
from loomfmu.studies.optimizing.study import load


def test_what_varies_and_what_is_wanted() -> None:
    path = study(
        'maximise = ["shaft.speed", "the belt keeps a margin of 10 %"]\nminimise = "damper_1.peak_load"\n'
        f"safety = '2 %'\n{SPEED}[choices]\n"
        '"dobby.law" = ["sloped_line", "sloped_sine"]\nhead = ["G6300 left", "GS900 left"]\n',
    )
    found = load(path)
    assert [each.key for each in found.variables] == ["shaft.speed", "dobby.law", "head"]
    assert [each.last for each in found.variables] == [1.0, 1.0, 1.0] and found.combinations == 4
    assert [(each.kind, each.sign) for each in found.goals] == [
        ("signal", 1.0), ("variable", -1.0), ("claim", -1.0)
    ]  # fmt: skip
    assert found.measures == ("damper_1.peak_load",)
    assert found.shares == (0.02,) * len(found.scene.claims)
    speed = found.variables[0]
    assert speed.value(0.0) == pytest.approx(41.887902) and speed.value(1.0) == pytest.approx(94.247780)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (GOAL, "nothing may vary: give ranges in [ranges], such as"),
        (f"{GOAL}[ranges]\n'shaft.speed' = ['700 rpm', '600 rpm']",
         "ranges.shaft.speed: 700 rev/min is not below 600"),
        (f"{GOAL}[ranges]\n'shaft.sped' = ['400 rpm', '600 rpm']", "did you mean 'speed'?"),
        (f"{GOAL}[ranges]\n'shaft.speed' = ['400 rpm', '6 m']", "'6 m' is in m, which does not fit rad/s"),
        (f"{GOAL}[ranges]\n'dobby.law' = [0, 3]",
         "ranges.dobby.law is not a number: list its values in [choices]"),
        (f"{GOAL}{SPEED}'heald.stroke' = ['90 mm', '98 mm']\n'heald_1.stroke' = ['90 mm', '98 mm']",
         "ranges.heald_1.stroke sets heald_1.stroke, which ranges.heald.stroke already sets"),
        (f"{GOAL}{SPEED}duration = ['1 s', '2 s']", "belongs to the run, not to the design; fix it in [set]"),
        (f"{GOAL}{SPEED}[choices]\n'dobby.law' = ['sloped-sin']", "did you mean"),
        (f"{GOAL}{SPEED}[choices]\nhead = ['G6300 left', 'G7000']", "there is no head 'G7000'"),
        (f"{GOAL}{SPEED}[choices]\nmachine = ['WL680-3600', 'WL680-3600']",
         "choices.machine: WL680-3600 appears twice"),
        (SPEED, "there is no goal: write maximise ="),
        (f"maximise = ''\n{SPEED}", "maximise = '' is not a name such as maximise = 'shaft.speed'"),
        (f"{GOAL}[ranges]\n'heald.stroke' = ['90 mm', '98 mm']",
         "maximise: shaft.speed is a parameter; put it into [ranges]"),
        (f"{GOAL}{SPEED}[choices]\nhead = []", "choices.head must name at least one value"),
        (f"maximise = 3\n{SPEED}", "maximise = 3 is not a name"),
        (f"maximise = 'belt.magrin'\n{SPEED}",
         "maximise: belt has no output 'magrin'; did you mean 'margin'?"),
        (f"minimise = 'heald_1.acceleration'\n{SPEED}",
         "heald_1.acceleration rises and falls in the run, so that its final value says little; write"
         " 'highest heald_1.acceleration', 'lowest heald_1.acceleration', 'mean heald_1.acceleration' or"
         " 'heald_1.acceleration at 90 deg'"),
        (f"minimise = 'highest heald_1.aceleration'\n{SPEED}",
         "minimise: heald_1 has no output 'aceleration'; did you mean 'acceleration'?"),
        (f"minimise = 'highst heald_1.acceleration'\n{SPEED}",
         "minimise: 'highst heald_1.acceleration' is not one of 'highest SIGNAL', 'lowest SIGNAL'"),
        (f"minimise = 'heald_1.acceleration at 90 mm'\n{SPEED}", "'90 mm' is in mm, which does not fit rad"),
        (f"minimise = 'mean 2 * heald_1.lift'\n{SPEED}",
         "minimise: 'mean 2 * heald_1.lift': of an expression, write 'highest ...' or 'lowest ...'"),
        (f"minimise = 'highest heald_1.lift + 1'\n{SPEED}",
         "minimise = 'heald_1.lift + 1' has heald_1.lift in m beside 1 in a number without a unit"),
        (f"minimise = 'highest heald_1.lit - heald_2.lift'\n{SPEED}",
         "minimise: heald_1 has no output 'lit'; did you mean 'lift'?"),
        ("minimise = 'highest shaft.speed'\n[ranges]\n'heald.stroke' = ['90 mm', '98 mm']",
         "shaft.speed is a parameter; put it into [ranges]"),
        (f"maximise = ['shaft.speed', 'shaft.speed']\n{SPEED}", "maximise: shaft.speed is already a goal"),
        (f"maximise = 'dobby.law'\n{SPEED}[choices]\n'dobby.law' = ['uniform', 'sloped_sine']",
         "is a choice; a goal must be a number"),
        (f"maximize = 'shaft.speed'\n{SPEED}", "maximize is unknown; did you mean 'maximise'?"),
        (f"{GOAL}safety = '2 mm'\n{SPEED}", "safety: '2 mm' is in mm, which does not fit"),
        (f"{GOAL}safety = -1\n{SPEED}", "safety = -1 is outside [0, 1000]"),
        (f"{GOAL}safety = 2\n{SPEED}", 'safety = 2 is 200% of the bound; write "2 %"'),
        (f"{GOAL}{SPEED}[safety]\n'the belt' = 0.1", "safety: the scene has no claim 'the belt'"),
        (f"{GOAL}{SPEED}[safety]\n'the stops withstand the carrier' = '3 mm'", "which does not fit N"),
        (f"{GOAL}except = 'the belt'\n{SPEED}", "except = 'the belt' must be a list of claims"),
        (f"{GOAL}except = ['the stops withstand']\n{SPEED}",
         "except: the scene has no claim 'the stops withstand'; did you mean 'the stops withstand the"),
        (f"{GOAL}except = ['the shed stays clear']\n{SPEED}[safety]\n'the shed stays clear' = 0.1",
         "safety.'the shed stays clear': except says that this claim may fail; leave out one of them"),
        (f"{GOAL}{SPEED}[search]\nruns = 3", "search.runs = 3 is outside [50, "),
        (f"{GOAL}{SPEED}[search]\nevaluations = 3", "search.evaluations is unknown"),
    ],
)  # fmt: skip
def test_what_is_refused(text: str, said: str) -> None:
    with pytest.raises(LoomfmuError) as caught:
        searched(text, head=FAST)
    assert said in str(caught.value) and str(caught.value).startswith("study.toml: ")
    assert not Path("results").exists()


def test_a_share_of_a_bound_of_0_is_refused() -> None:
    text = f"{GOAL}safety = 0.1\n[ranges]\n'shaft.speed' = ['150 rpm', '250 rpm']"
    with pytest.raises(LoomfmuError, match=r"safety = 0\.1 is a share of the bound, and that of .* is 0"):
        searched(text, DEMO.with_name("damper.toml"), FAST)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        # used by another law alone
        ("'dobby.plateau_angle' = ['80 deg', '90 deg']",
         "ranges.dobby.plateau_angle changes neither a goal nor a claim"),
        ("[choices]\n'dobby.lever_radius' = ['80 mm', '90 mm']",
         "choices.dobby.lever_radius changes neither a goal nor a claim (80 mm | 90 mm); leave it out"),
        ("[choices]\n'heald.stroke' = ['10 mm', '98 mm']",
         "choices.heald.stroke: no design with 10 mm can be run (claim 'clear_shed' of heald_1: "),
        ("[choices]\n'dobby.law' = ['table', 'sloped_sine']",
         "choices.dobby.law: no design with table can be run (dobby: law = table has no table: "),
        ("'weft.coupler_length' = ['10 mm', '20 mm']",
         "none of 39 designs that were tried can be run (weft: "),
        ("[choices]\n'dobby.law' = ['uniform']", "choices.dobby.law has one value; fix it in [set]"),
    ],
)  # fmt: skip
def test_what_changes_nothing_or_cannot_be_run_is_refused(text: str, said: str) -> None:
    with pytest.raises(LoomfmuError) as caught:
        searched(f"{GOAL}{SPEED}{text}")
    assert said in str(caught.value) and str(caught.value).startswith("study.toml: ")
    assert not Path("results").exists(), "the next study would be refused as another one"


def test_the_scene_is_named_as_the_study_is() -> None:
    """Relative to the current folder, as in the rest of the line."""
    Path("studies").mkdir()
    path = study(GOAL + SPEED, Path("../none.toml")).rename("studies/study.toml")
    with pytest.raises(LoomfmuError, match=r"^studies/study\.toml: none\.toml: cannot be read"):
        load(path)
