"""The best design: cases with a known solution, fronts, what limits it, resumption, what is written."""

import csv
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from study_files import DEMO, FAST, GOAL, QUICK, SIMS, SPEED, searched, study

from loomfmu import LoomfmuError, Optimum, evaluate, optimize
from loomfmu.cli import main
from loomfmu.design import loom as design
from loomfmu.studies.optimizing import optimum
from loomfmu.studies.optimizing import runs as runs_module
from loomfmu.studies.optimizing.runs import Design
from loomfmu.studies.optimizing.search import _front

RPM = math.pi / 30.0
SHORT = {"revolutions": 2, "steps_per_revolution": 90}
EXACT = "[set]\nrevolutions = 2\n"  # with the scene's own steps
MARGIN = "the belt keeps a margin of 10 %"
SAFE = "the loom runs below its safe speed"


def alone(claim: str) -> Path:
    """The demo with one of its claims."""
    head, *claims = DEMO.read_text().split("[[claims]]")
    (kept,) = (each for each in claims if claim in each)
    path = Path("alone.toml")
    path.write_text(f"{head}[[claims]]{kept}")
    return path


@pytest.mark.few(1)
@pytest.mark.parametrize(
    ("key", "low", "high", "expected"),
    [
        ("belt.guide_clearance", "0.1 mm", "0.8 mm", lambda: design.clearance_for("650 rpm", "WL680-3600")),
        ("belt.head_mass", "50 g", "300 g", lambda: design.mass_for("650 rpm", "WL680-3600")),
    ],
)
def test_the_best_value_for_a_wanted_speed_is_that_of_the_closed_form(
    key: str, low: str, high: str, expected: object
) -> None:
    text = f'maximise = "{key}"\n[ranges]\n"{key}" = ["{low}", "{high}"]'
    found = searched(text, alone(SAFE), f'{EXACT}"shaft.speed" = "650 rpm"\n{QUICK}')
    # that claims are kept 1e-9 inside, and 1e-9 of the extreme between samples
    assert found.values[key] == pytest.approx(expected(), rel=1e-8)  # type: ignore[operator]
    assert found.binding == (SAFE,) and found.holds  # 1e-9 inside, and exact to less


def test_the_fastest_loom_has_the_speed_of_the_closed_form() -> None:
    heads = ["GS900 right", "G6300 left", "G6300 right", "GS900 left"]
    text = f'{GOAL}{SPEED}"belt.guide_clearance" = ["0.2 mm", "0.5 mm"]\n[choices]\nhead = {heads}'
    found = searched(text, alone(MARGIN), EXACT + QUICK)
    speeds = {
        head: design.safe_speed("WL680-3600", head, clearance="0.2 mm").speed * math.sqrt(0.9)
        for head in heads
    }
    best = max(speeds, key=lambda head: speeds[head])
    assert found.values["head"] == best and found.values["belt.guide_clearance"] == 0.2e-3
    assert found.goal == pytest.approx(speeds[best], rel=1e-8)
    assert found.binding == (MARGIN, "belt.guide_clearance")
    margin, wider = (each.gain for each in found.front[0].limits)
    # the speed goes with the root of 1 - margin; tangents leave the second order
    assert margin == pytest.approx(math.sqrt(0.901 / 0.9) - 1.0, rel=1e-3)
    beyond = design.safe_speed("WL680-3600", best, clearance="0.197 mm").speed * math.sqrt(0.9)
    assert wider == pytest.approx(beyond / found.goal - 1.0, rel=2e-2)
    assert "Relaxed by 1 %, 'the belt keeps a margin of 10 %' is worth about +0.3" in str(found)
    assert found.scene is not None
    again = evaluate(found.scene)  # the scene that was written
    assert again.claims == found.verdicts
    assert found.holds


def test_a_claim_that_binds_is_undecided_where_its_error_is_larger_than_its_distance() -> None:
    text = 'minimise = "dobby.speed_reduction"\n[ranges]\n"dobby.speed_reduction" = [0.3, 0.5]'
    found = searched(
        text, alone("the frames dwell long enough"), f"{EXACT}steps_per_revolution = 24\n{QUICK}"
    )
    assert [each.decided for each in found.verdicts] == [False]
    assert "so undecided" in str(found) and "keeps off it" in str(found)


def test_of_two_claims_that_bind_together_neither_is_worth_anything_alone() -> None:
    scene = alone(SAFE)
    head, claim = scene.read_text().split("[[claims]]")
    scene.write_text(f"{head}[[claims]]{claim}\n[[claims]]{claim.replace(SAFE, 'again')}")
    found = searched(GOAL + SPEED, scene)
    assert found.binding == (SAFE, "again") and {each.gain for each in found.front[0].limits} == {0.0}
    assert "is worth nothing alone" in str(found)


@pytest.mark.parametrize(
    ("text", "share"),
    [
        (f"safety = '5 %'\n{GOAL}{SPEED}", 1.0 / 1.05),
        (
            f"{GOAL}{SPEED}[safety]\n'{SAFE}' = '30 rpm'",
            1.0 - 30.0 * RPM / design.safe_speed("WL680-3600").speed,
        ),
    ],
)
def test_a_safety_distance_is_kept(text: str, share: float) -> None:
    found = searched(text, alone(SAFE), EXACT + QUICK)
    assert found.holds and found.binding == (SAFE,)
    assert found.goal == pytest.approx(design.safe_speed("WL680-3600").speed * share, rel=1e-8)


def test_a_claim_that_may_fail_does_not_limit(capsys: pytest.CaptureFixture[str]) -> None:
    text = f'{GOAL}except = ["{MARGIN}"]\n{SPEED}'
    assert main(["optimize", str(study(text, head=EXACT + QUICK)), "--processes", "1"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert f"of which meet all claims but '{MARGIN}' (numerical errors aside)" in said and "may fail)" in said
    assert f"It is limited by '{SAFE}'." in said and "Largest shaft.speed: 681.8044 rev/min." in said
    found = evaluate("results/study/best.toml").claims  # the scene has all its claims
    assert not found[0].holds and found[0].decided and found[0].distance < 0.0


def test_the_best_scene_says_where_it_comes_from() -> None:
    """Sentences of the scene's own description may not hold with other values."""
    scene = alone(SAFE)
    assert "\ndescription = " in scene.read_text()
    found = searched(GOAL + SPEED, scene)
    assert found.scene is not None
    assert tomllib.loads(found.scene.read_text())["description"] == (
        "The best design of study.toml (largest shaft.speed): alone.toml with other values of revolutions,"
        " steps_per_revolution and shaft.speed."
    )


def test_a_front_lies_on_the_curve_of_the_closed_form() -> None:
    text = """maximise = ["shaft.speed", "belt.guide_clearance"]
[ranges]
"shaft.speed" = ["400 rpm", "900 rpm"]
"belt.guide_clearance" = ["0.2 mm", "0.6 mm"]"""
    found = searched(text, alone(SAFE), f"{EXACT}[search]\nruns = 60\npoints = 3\n")
    assert len(found.front) == 3 and found.front[0].scene.name == "best_01.toml"
    speeds = [best.values["shaft.speed"] for best in found.front]
    assert speeds == sorted(speeds, reverse=True)
    for best in found.front:
        clearance = best.values["belt.guide_clearance"]
        expected = design.safe_speed("WL680-3600", clearance=clearance).speed  # type: ignore[arg-type]
        # the design of a front need not be at a corner: it is as far from it as the last region is wide
        assert best.values["shaft.speed"] == pytest.approx(expected, rel=1e-7)
        assert all(each.distance >= 0.0 for each in best.verdicts)
    assert all(SAFE in best.binding for best in found.front[1:-1])
    assert found.front[0].values["belt.guide_clearance"] == pytest.approx(0.2e-3, rel=1e-6)
    assert found.front[-1].values["belt.guide_clearance"] == 0.6e-3
    assert len(Path("results/study/front.csv").read_text().splitlines()) == 4
    assert "<table" in found._repr_html_()
    Path("results/study/best_02.toml").write_text("mine")
    with pytest.raises(LoomfmuError, match=r"best_02\.toml was edited, or loomfmu did not write it"):
        optimize("study.toml", processes=1, restart=True)


SMALL = f"""title = "Small"
{GOAL}{SPEED}"dobby.speed_reduction" = [0.3, 0.7]
[choices]
"dobby.law" = ["sloped_line", "sloped_sine"]"""


def outcome(found: Optimum) -> tuple[object, ...]:
    return found.values, found.verdicts, found.binding, found.runs, found.allowed


@pytest.mark.slow
def test_the_result_is_the_same_on_any_number_of_processes_and_after_a_kill(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = study(SMALL, head=FAST + QUICK)
    whole = optimize(path, processes=1, output="whole")
    assert outcome(optimize(path, processes=2, output="two")) == outcome(whole)
    lines = Path("whole/runs.jsonl").read_bytes().splitlines(keepends=True)
    assert len(lines) == whole.runs

    calls = []
    run_batches = runs_module.run_batches

    def killed(*arguments: object) -> None:
        calls.append(arguments)
        if len(calls) == 4:
            raise KeyboardInterrupt
        run_batches(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(runs_module, "run_batches", killed)
    with pytest.raises(KeyboardInterrupt, match="finished runs are kept in part; run the same command"):
        optimize(path, processes=1, output="part")
    monkeypatch.undo()
    monkeypatch.chdir(tmp_path)
    kept = Path("part/runs.jsonl").read_bytes()
    assert lines[0] in kept and len(kept.splitlines()) < len(lines)
    Path("part/runs.jsonl").write_bytes(kept + lines[-1][:20])  # half a line, as a kill leaves it
    assert outcome(optimize(path, processes=1, output="part")) == outcome(whole)
    assert Path("part/runs.jsonl").read_bytes() == b"".join(lines)
    assert Path("part/best.toml").read_bytes() == Path("whole/best.toml").read_bytes()
    assert Path("part/designs.csv").read_bytes() == Path("whole/designs.csv").read_bytes()


@pytest.mark.slow
def test_a_directory_of_another_study_is_refused() -> None:
    path = study(SMALL, head=FAST + QUICK)
    optimize(path, processes=1, output="here")
    path.write_text(path.read_text().replace("0.7", "0.6"))
    with pytest.raises(LoomfmuError, match="here: contains another study, or the study, its scene"):
        optimize(path, processes=1, output="here")
    assert optimize(path, processes=1, output="here", restart=True)
    edited = Path("here/best.toml").read_text() + "# tried on loom 7\n"
    Path("here/best.toml").write_text(edited)
    with pytest.raises(LoomfmuError, match=r"here/best\.toml was edited, or loomfmu did not write it"):
        optimize(path, processes=1, output="here", restart=True)
    assert Path("here/best.toml").read_text() == edited
    Path("here/best.toml").unlink()
    foreign = Path("foreign")
    foreign.mkdir()
    (foreign / "designs.csv").write_text("mine")
    with pytest.raises(LoomfmuError, match="foreign: contains files that no loomfmu study wrote"):
        optimize(path, processes=1, output=foreign)
    Path("here/runs.jsonl").write_text("nonsense\n")
    with pytest.raises(LoomfmuError, match=r"runs\.jsonl: is damaged .*--restart runs all designs again"):
        optimize(path, processes=1, output="here")


def test_the_command_prints_and_writes_what_it_finds(capsys: pytest.CaptureFixture[str]) -> None:
    path = study(SMALL, head=FAST + QUICK)
    assert main(["optimize", str(path), "--processes", "1"]) == 0  # as the run of best.toml below
    said = capsys.readouterr().out
    assert "of which meet all claims (numerical errors aside)\n" in said and "\n\n\n" not in said
    assert said.startswith("Small: ") and "It is limited by 'the belt keeps a margin of 10 %'." in said
    assert "This is a search, not a proof that there is no better design." in said
    assert "646.8" in said  # 681.804 sqrt(0.9); with 90 steps the lowest margin is off by some 1e-5
    directory = Path("results/study")
    files = "best.png best.toml designs.csv runs.jsonl study.json"
    assert sorted(each.name for each in directory.iterdir()) == files.split()
    with (directory / "designs.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert {"shaft.speed [rev/min]", "largest shaft.speed [rev/min]", "dobby.law", "holds", "error"} < set(
        rows[0]
    )
    assert max(float(row["shaft.speed [rev/min]"]) for row in rows if row["holds"] == "true") < 646.83
    capsys.readouterr()
    assert main(["run", str(directory / "best.toml")]) == 0
    assert "holds  the belt keeps a margin of 10 %" in capsys.readouterr().out
    found = optimize(path, processes=1)  # from the designs that were run
    assert found.ran == 0
    (best,) = found.front
    low, high = best.indifferent["dobby.speed_reduction"]
    assert low <= best.values["dobby.speed_reduction"] <= high and high - low > 0.1  # type: ignore[operator]
    assert "shaft.speed" not in best.indifferent
    rows = {row[0]: row[3] for row in optimum.value_rows(found, best)}
    assert rows["dobby.speed_reduction"] == f"indifferent from {low:.7g} to {high:.7g}"
    # all claims hold at both ends as at the best value; just beyond a low end one does not
    for share, fine in ((low, True), (low - 1e-3, False)):
        judged = evaluate(DEMO, set=SHORT | best.values | {"dobby.speed_reduction": share}, errors="none")
        assert all(each.distance >= 0.0 for each in judged.claims) == fine


def test_a_claim_that_holds_nowhere_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    text = SMALL.replace('"400 rpm"', '"800 rpm"')
    assert main(["optimize", str(study(text, head=FAST + QUICK)), "--processes", "1"]) == 1
    said = " ".join(capsys.readouterr().out.split())
    assert "designs that were tried meets all claims." in said
    assert f"No design meets '{MARGIN}'; the nearest distance from its bound is -0.4" in said
    assert not Path("results/study/best.toml").exists() and Path("results/study/designs.csv").exists()


def test_a_claim_that_is_undecided_in_every_design_is_named_with_its_reason() -> None:
    claim = 'kind = "below"\nname = "springs"\nsignal = "damper_1.spring_force"\nbound = "5 kN"\n'
    scene = Path("springs.toml")
    scene.write_text(f"{DEMO.read_text().partition('[[claims]]')[0]}[[claims]]\n{claim}")
    text = 'maximise = "heald.stroke"\n[choices]\n"heald.stroke" = ["90 mm", "98 mm"]'
    found = searched(text, scene)
    assert str(found) == (
        "None of the 2 designs that were tried meets all claims."
        " No design meets 'springs', undecided in 2 of them:"
        " damper_1.spring_force is known only at the samples;"
        " set at_samples = true in the claim to judge these alone."
    )


def test_designs_that_cannot_be_run_are_counted() -> None:
    stroke = '"heald.stroke" = ["10 mm", "98 mm"]'  # clear_shed cannot be judged at 10 mm
    text = SMALL.replace("[choices]", f"{stroke}\n[choices]")
    found = searched(text)
    assert f"{len(found.failed)} of {found.runs} designs could not be run ({found.failed[0]}" in str(found)
    assert found.failed and all(found.failed)
    assert found and found.values["heald.stroke"] > 0.01  # type: ignore[operator]


def test_a_goal_may_be_the_distance_of_a_claim() -> None:
    text = f"""maximise = "{MARGIN}"
[ranges]
"shaft.speed" = ["500 rpm", "900 rpm"]
"belt.guide_clearance" = ["0.2 mm", "0.5 mm"]"""
    found = searched(text)
    assert found.values == pytest.approx({"shaft.speed": 500.0 * RPM, "belt.guide_clearance": 0.2e-3})
    assert found.goal == pytest.approx(found.verdicts[0].distance, rel=1e-12)


def test_a_goal_of_a_signal_is_spelt_and_has_an_error() -> None:
    """The lowest acceleration is that of finer samples, but for what these miss."""
    text = """maximise = "lowest heald_1.acceleration"
[choices]
"dobby.law" = ["sloped_line", "sloped_sine"]"""
    found = searched(text)
    setting = {"revolutions": 1, "steps_per_revolution": 5760, "dobby.law": found.values["dobby.law"]}
    run = evaluate(DEMO, set=setting, values=["heald_1.acceleration"], errors="none").trace
    (error,) = found.front[0].errors
    missed = 1e-6 * abs(found.goal)  # about (2 pi / 5760)^2 / 8 of the fourth harmonic
    assert abs(found.goal - np.min(run["heald_1.acceleration"])) <= error + missed
    assert 0.0 < error < 1e-4 * abs(found.goal)


def test_a_goal_may_be_the_highest_value_of_an_expression() -> None:
    """The frames stand at 98 mm and at 0, then at 0 and at their stroke: half of 98 mm is less than 90."""
    text = """minimise = "highest abs(heald_1.lift / 2 - heald_2.lift)"
[ranges]
"heald_2.stroke" = ["90 mm", "98 mm"]"""
    found = searched(text)
    assert found.goal == pytest.approx(0.09, rel=1e-9)
    (error,) = found.front[0].errors
    assert 0.0 < error < 1e-9


def test_whole_numbers_may_vary() -> None:
    text = 'maximise = "damper.thread_count"\n[ranges]\n"damper.thread_count" = [0, 4000]'
    scene = SIMS / "damper.toml"
    found = searched(text, scene)
    count = found.values["damper.thread_count"]
    assert isinstance(count, int) and 0 < count < 4000
    assert evaluate(scene, set=SHORT | {"damper.thread_count": count})
    assert not evaluate(scene, set=SHORT | {"damper.thread_count": count + 1})


def test_few_choices_are_all_run(capsys: pytest.CaptureFixture[str]) -> None:
    text = f"maximise = '{MARGIN}'\n[choices]\nhead = ['G6300 left', 'G6300 right']"
    path = study(text)
    assert main(["optimize", str(path), "--processes", "1"]) == 0
    assert "All 2 combinations were run." in capsys.readouterr().out
    found = optimize(path, processes=1)
    heads = ("G6300 left", "G6300 right")
    distances = [evaluate(DEMO, set=SHORT | {"head": head}).claims[0].distance for head in heads]
    assert found.goal == max(distances) and found.values["head"] == heads[distances.index(max(distances))]
    assert found.runs == 2 and "No claim and no end" not in str(found)


def test_a_goal_that_nothing_changes_is_named_and_leaves_one_design() -> None:
    dwell = "the frames dwell long enough"
    text = f"maximise = ['{dwell}', '{MARGIN}']\n[ranges]\n'belt.guide_clearance' = ['0.2 mm', '0.5 mm']"
    found = searched(text, head=f"{FAST}[search]\nruns = 50\npoints = 3")
    assert [each.values for each in found.front] == [{"belt.guide_clearance": 0.2e-3}]
    assert "One design is best in all goals." in str(found)
    assert f"The goal '{dwell}' is the same in all designs: nothing that varies changes it." in str(found)


def test_designs_that_are_alike_are_once_in_a_front() -> None:
    def at(*heights: float) -> Design:
        return Design(heights, heights, np.array(heights), np.array([]), np.array([]), True, "")

    # the first goal is constant but for rounding, which must not decide
    rounded = [at(-3.0 + 1e-15, 1.0), at(-3.0, 2.0), at(-3.0 - 1e-15, 1.0 + 1e-12)]
    assert [each.heights[1] for each in _front(rounded)] == [pytest.approx(1.0)]
    assert len(_front([at(1.0, 2.0), at(2.0, 1.0), at(2.0, 2.0), at(1.0 + 1e-13, 2.0)])) == 2


def test_a_safety_distance_that_no_design_keeps_is_named() -> None:
    text = "maximise = 'shaft.speed'\nsafety = '50 %'\n[ranges]\n'shaft.speed' = ['600 rpm', '900 rpm']"
    found = searched(text)
    near = "the largest distance from its bound is 81.8"
    assert not found and f"No design keeps the safety distance from '{SAFE}'; {near}" in str(found)


def test_a_study_may_set_an_accuracy() -> None:
    text = f"maximise = '{MARGIN}'\n[choices]\nhead = ['G6300 left', 'G6300 right']"
    found = searched(text, head="[set]\nrevolutions = 2\naccuracy = 0.01\n")
    assert found.scene and "\naccuracy = 0.01\n" in found.scene.read_text()
    assert "steps_per_revolution" not in found.scene.read_text()
