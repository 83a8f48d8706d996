"""`run` and `export`: what they print, write and return."""

import os
import shlex
import subprocess
import sys
from datetime import datetime
from pathlib import Path

import pytest
from small_scenes import CLAIM, HEAD, LOOM, SHAFT, one_line, scene

from loomfmu import Trace, evaluate
from loomfmu.cli import main


@pytest.mark.parametrize(("bound", "status", "word"), [(0.1, 0, "holds"), (0.9, 1, "FAILS")])
def test_run_prints_the_verdicts_and_returns_whether_all_hold(
    capsys: pytest.CaptureFixture[str], bound: float, status: int, word: str
) -> None:
    text = HEAD + 'description = "To be read after the run."\n' + LOOM + CLAIM.format(bound=bound)
    assert main(["run", scene(text)]) == status
    printed = capsys.readouterr()
    assert printed.err == ""
    lines = printed.out.splitlines()
    assert lines[0] == "WL680-3600, G6300 left, weave 10/01, 400 rev/min: 1 revolution, 90 steps"
    assert lines[1] == 'scene "Small"'
    place = lines.index(f"{word}  lowest margin (belt.lowest_margin)")
    assert lines[place + 1].startswith("  0.6558")
    away = {0.1: "+555.8 %", 0.9: "-27.13 %"}[bound]
    error = evaluate("scene.toml").claims[0].shown_error
    assert f", bound {bound} ({away}), error {error}, at 0.0" in lines[place + 1]
    assert " ".join("".join(lines[place + 1 : place + 3]).split()).endswith(" rev. 1")
    assert "To be read after the run." in lines
    assert lines[-1] == "trace: results/scene.h5    summary: loomfmu show results/scene.h5"
    assert main(["run", "scene.toml", "--set", "shaft.speed=300rpm", "--output", "other.h5"]) == status
    assert "To be read after the run." not in capsys.readouterr().out  # it is about the values of the scene
    with Trace("results/scene.h5") as trace:
        assert trace.rows == 91
        assert [verdict.holds for verdict in trace.verdicts] == [status == 0]


@pytest.mark.parametrize("name", ["a b.h5", "-x.h5", "plain.h5", "it's.h5"])
def test_the_summary_that_a_run_names_can_be_pasted(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", scene(HEAD + SHAFT), f"--output={name}"]) == 0
    command = capsys.readouterr().out.rpartition("summary: ")[2]
    assert main(shlex.split(command)[1:]) == 0


def test_run_without_claims_holds(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", scene(HEAD + SHAFT), "--output", "deep/down/there.h5"]) == 0
    assert "no claims" in capsys.readouterr().out
    assert os.listdir("deep/down") == ["there.h5"]


def test_set_takes_units_and_may_be_said_again(capsys: pytest.CaptureFixture[str]) -> None:
    values = ("shaft.speed=685rpm", "belt.guide_clearance = 0.5 mm", "heald.stroke=50mm", "revolutions=0.5")
    assert main(["run", scene(HEAD + LOOM), *(f"--set={value}" for value in values)]) == 0
    printed = capsys.readouterr().out
    assert " ".join(printed.split()).startswith(
        "WL680-3600, G6300 left, weave 10/01, 685 rev/min; belt.guide_clearance = 0.5 mm,"
        ' heald.stroke = 50mm, revolutions = 0.5: 0.5 revolutions, 45 steps changed from the scene "Small"'
    )
    with Trace(printed.split()[-1]) as trace:
        assert trace["belt.length_factor"][-1] == 0.9
        assert trace.parameter("heald_2.stroke") == 0.05
        assert trace.rows == 46


def test_a_run_up_turns_the_shaft_less_than_the_nominal_revolutions(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """It rises to its speed over one of the two revolutions: half a revolution less."""
    ramp = HEAD.replace("revolutions = 1", "revolutions = 2") + '[shaft]\nspeed = "600rpm"\n'
    assert main(["run", scene(ramp + 'ramp_duration = "0.1 s"\n')]) == 0
    printed = capsys.readouterr().out
    assert "scene, 600 rev/min: 2 nominal revolutions, the shaft turned 1.5 revolutions, 180 steps" in printed
    assert main(["run", scene(ramp)]) == 0
    assert "scene, 600 rev/min: 2 revolutions, 180 steps" in capsys.readouterr().out
    trace = Path("results/scene.h5")
    assert main(["run", scene(ramp + 'ramp_duration = "0.1 s"\n'), "--report"]) == 0
    assert "2.0 nominal; the shaft turned 1.5 revolutions" in trace.with_suffix(".html").read_text()


def test_warnings_go_to_the_error_stream(capsys: pytest.CaptureFixture[str]) -> None:
    text = '[belt]\nguide_clearance = "1.2 mm"\n[wires]\nbelt.yarn_tension = "belt.inertia_force"\n'
    assert main(["run", scene('coupling = "lagged"\n' + HEAD + LOOM + text)]) == 0
    assert capsys.readouterr().err.splitlines() == [
        "warning: belt: guide_clearance = 1.2 mm: above 1 mm replace the belt or slow the loom down",
        "warning: loop: belt.inertia_force -> belt.yarn_tension carries the value of the step before",
    ]


def test_a_finished_run_replaces_an_older_one_and_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    shaft = HEAD + SHAFT
    assert main(["run", scene(shaft.replace("revolutions = 1", "revolutions = 2"))]) == 0
    assert "replaced" not in capsys.readouterr().out
    written = datetime(2026, 3, 1, 14, 5, 9).timestamp()
    os.utime("results/scene.h5", (written, written))
    assert main(["run", scene(shaft)]) == 0
    line = "replaced: the trace of this name written at 2026-03-01 14:05:09"
    assert line in capsys.readouterr().out.splitlines()
    with Trace("results/scene.h5") as trace:
        assert (trace.status, trace.rows) == ("complete", 91)


def test_a_run_with_other_values_leaves_the_trace_of_the_scene(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", scene(HEAD + SHAFT)]) == 0
    before = Path("results/scene.h5").read_bytes()
    assert main(["run", "scene.toml", "--set", "shaft.speed=300 rpm", "--report"]) == 0
    assert "replaced" not in capsys.readouterr().out
    assert Path("results/scene.h5").read_bytes() == before
    other = "scene_shaft.speed=300rpm"
    assert sorted(os.listdir("results")) == ["scene.h5", f"{other}.h5", f"{other}.html"]


def test_a_run_leaves_the_trace_of_another_scene_of_that_name(capsys: pytest.CaptureFixture[str]) -> None:
    for folder in ("results/one", "results/two"):  # where `optimize` writes two scenes of one name
        Path(folder).mkdir(parents=True)
        Path(folder, "best.toml").write_text(HEAD + SHAFT)
        assert main(["run", f"{folder}/best.toml"]) == 0
    said = capsys.readouterr()
    other = os.path.normpath("results/one/best.toml")
    (own,) = Path("results").glob("best-????????.h5")
    first = Path("results/best.h5")
    assert said.err.splitlines() == [
        f"{first}: it is the trace of another scene, {other}; the new one is {own}"
    ]
    assert f"trace: {own}" in said.out
    assert Trace(first).attributes["scene_file"] == "one/best.toml"
    assert Trace(own).attributes["scene_file"] == "two/best.toml"
    assert main(["run", "results/one/best.toml"]) == main(["run", "results/two/best.toml"]) == 0
    assert capsys.readouterr().out.count("replaced: the trace of this name") == 2
    assert sorted(Path("results").glob("*.h5")) == sorted([first, own])


def test_a_failed_run_leaves_an_older_one() -> None:
    assert main(["run", scene(HEAD + SHAFT)]) == 0
    older = Path("results/scene.h5").read_bytes()
    assert main(["run", scene(HEAD + LOOM + '[weft]\ncrank_cone = "80 deg"\n')]) == 2
    assert Path("results/scene.h5").read_bytes() == older
    assert os.listdir("results") == ["scene.h5"]


def test_options_of_one_kind_of_export_are_refused_for_the_other(capsys: pytest.CaptureFixture[str]) -> None:
    path = scene(HEAD + SHAFT)
    assert main(["export", path, "--fmu", "loom.fmu", "--flavour", "live"]) == 2
    assert "--flavour is for --ssp: one FMU of a whole scene is always native" in capsys.readouterr().err
    assert main(["export", path, "--fmu", "loom.fmu", "--connectors"]) == 2
    assert "--connectors is for --ssp: one FMU of a whole scene" in capsys.readouterr().err
    assert not list(Path().glob("loom.*"))
    with pytest.raises(SystemExit, match="2"):
        main(["export", path])  # one of the two must be given


def test_a_value_is_set_once_and_a_trace_is_called_what_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    path = scene(HEAD + LOOM)
    assert main(["run", path, "--set", "shaft.speed=400rpm", "--set", "shaft.speed=500rpm"]) == 2
    assert one_line(capsys) == "--set shaft.speed is given twice: 400rpm and 500rpm"
    assert main(["run", path, "--output", "x.csv"]) == 2
    assert one_line(capsys) == "x.csv: a trace of loomfmu ends in .h5; name it x.h5"
    assert not Path("x.csv").exists()


@pytest.mark.slow
def test_a_cache_may_lie_anywhere(tmp_path: Path) -> None:
    # pythonfmu's wrapper decodes no escape but that of a space and crashes where it finds no resources
    for name in ("with space", "Jürgen", "50% #1 +ä"):
        environment = os.environ | {"LOOMFMU_CACHE": str(tmp_path / name)}
        command = [sys.executable, "-m", "loomfmu.cli", "run", scene(HEAD + SHAFT)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")


KINDS = {  # the text of a file of each kind, and the command that takes it
    "scene": ("run", HEAD + LOOM),
    "sweep": ("sweep", 'scene = "scene.toml"\n[grid]\n"shaft.speed" = ["500 rpm"]\n[traces]\n'),
    "study": ("optimize", 'scene = "scene.toml"\nmaximise = "shaft.speed"\n[ranges]\nspeed = [1, 2]\n'),
}


@pytest.mark.parametrize(
    ("arguments", "wanted"),
    [
        ("run", "scene"),
        ("limit --vary shaft.speed", "scene"),
        ("export --ssp x.ssp", "scene"),
        ("sweep", "sweep"),
        ("optimize", "study"),
    ],
)
def test_a_file_of_another_kind_is_called_what_it_is(
    arguments: str, wanted: str, capsys: pytest.CaptureFixture[str]
) -> None:
    command, *options = arguments.split()
    for kind, (takes, text) in KINDS.items():
        Path(f"{kind}.toml").write_text(text)
        if kind != wanted:
            assert main([command, f"{kind}.toml", *options]) == 2
            assert one_line(capsys) == f"{kind}.toml: is a {kind}, not a {wanted}; loomfmu {takes} takes it"


def test_the_suffix_of_a_scene_and_of_a_trace_may_be_left_out(capsys: pytest.CaptureFixture[str]) -> None:
    scene(HEAD + LOOM)
    assert main(["run", "scene"]) == 0
    assert main(["show", "results/scene"]) == 0
    assert "run by: loomfmu run scene.toml" in capsys.readouterr().out
    assert main(["run", "other"]) == 2
    assert one_line(capsys) == "other: cannot be read (No such file or directory)"
