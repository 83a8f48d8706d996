"""The command: what it prints, what it returns, and one line for every mistake."""

import os
import shlex
import stat
import subprocess
import sys
import zipfile
from pathlib import Path

import h5py
import pytest
from live_fmus import NAMES

from loomfmu import LoomfmuError, Trace
from loomfmu.cli import main
from loomfmu.cosim.importing import fmus
from loomfmu.fmi.cache import cache_directory

HEAD = 'title = "Small"\nrevolutions = 1\nsteps_per_revolution = 90\n'
SHAFT = "[shaft]\n"
LOOM = '[loom]\nmachine = "WL680-3600"\nhead = "G6300 left"\nweave = "10/01"\n'
HUGE = "1" + 400 * "0"  # more than any float holds
CLAIM = '[[claims]]\nkind = "lowest_margin"\nbound = {bound}\n'


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def scene(text: str) -> str:
    Path("scene.toml").write_text(text)
    return "scene.toml"


# ---- run


@pytest.mark.parametrize(("bound", "status", "word"), [(0.1, 0, "holds"), (0.9, 1, "FAILS")])
def test_run_prints_the_verdicts_and_returns_whether_all_hold(
    capsys: pytest.CaptureFixture[str], bound: float, status: int, word: str
) -> None:
    text = HEAD + 'description = "To be read after the run."\n' + LOOM + CLAIM.format(bound=bound)
    assert main(["run", scene(text)]) == status
    printed = capsys.readouterr()
    assert printed.err == ""
    lines = printed.out.splitlines()
    assert lines[0] == "Small: 1 revolution at 400 rev/min, 90 steps"
    place = lines.index(f"{word}  lowest margin (belt.lowest_margin)")
    assert lines[place + 1].startswith("  0.6558")
    away = {0.1: "+555.8 %", 0.9: "-27.13 %"}[bound]
    assert f", bound {bound} ({away}), error 2e-05, at 0.0" in lines[place + 1]
    assert lines[place + 1].endswith(" deg,") and lines[place + 2] == "  rev. 1"
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
    arguments = [
        "--set",
        "shaft.speed=685rpm",
        "--set",
        "belt.guide_clearance = 0.5 mm",
        "--set",
        "heald.stroke=50mm",
    ]
    assert main(["run", scene(HEAD + LOOM), *arguments, "--set", "revolutions=0.5"]) == 0
    assert "0.5 revolutions at 685 rev/min" in capsys.readouterr().out
    with Trace("results/scene.h5") as trace:
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
    assert ": 2 nominal revolutions at 600 rev/min, the shaft turned 1.5 revolutions, 180 steps" in printed
    assert main(["run", scene(ramp)]) == 0
    assert ": 2 revolutions at 600 rev/min, 180 steps" in capsys.readouterr().out
    trace = Path("results/scene.h5")
    assert main(["run", scene(ramp + 'ramp_duration = "0.1 s"\n'), "--report"]) == 0
    assert "2.0 nominal; the shaft turned 1.5 revolutions" in trace.with_suffix(".html").read_text()


def test_warnings_go_to_the_error_stream(capsys: pytest.CaptureFixture[str]) -> None:
    text = (
        HEAD
        + LOOM
        + '[belt]\nguide_clearance = "1.2 mm"\n[wires]\nbelt.yarn_tension = "belt.inertia_force"\n'
    )
    assert main(["run", scene(text)]) == 0
    assert capsys.readouterr().err.splitlines() == [
        "warning: belt: guide_clearance = 1.2 mm: above 1 mm replace the belt or slow the loom down",
        "warning: loop: belt.inertia_force -> belt.yarn_tension carries the value of the step before",
    ]


def test_a_finished_run_replaces_an_older_one() -> None:
    shaft = HEAD + SHAFT
    assert main(["run", scene(shaft.replace("revolutions = 1", "revolutions = 2"))]) == 0
    assert main(["run", scene(shaft)]) == 0
    with Trace("results/scene.h5") as trace:
        assert (trace.status, trace.rows) == ("complete", 91)


def test_a_failed_run_leaves_an_older_one() -> None:
    assert main(["run", scene(HEAD + SHAFT)]) == 0
    older = Path("results/scene.h5").read_bytes()
    assert main(["run", scene(HEAD + LOOM + '[weft]\ncrank_cone = "80 deg"\n')]) == 2
    assert Path("results/scene.h5").read_bytes() == older
    assert os.listdir("results") == ["scene.h5"]


# ---- what no command overwrites

WIF = Path(__file__).parents[1] / "sims" / "weaves" / "twill_2_2.wif"


def untouched(path: Path) -> tuple[int, ...]:
    """What changes when a file is written, and not when it is read."""
    stat = path.lstat()
    return stat.st_mode, stat.st_ino, stat.st_size, stat.st_mtime_ns


@pytest.mark.parametrize("force", [[], ["--force"]])
@pytest.mark.parametrize(
    "command",
    [
        ["run", "scene.toml", "--output"],
        ["export", "scene.toml", "--ssp"],
        ["export", "scene.toml", "--fmu"],
    ],
)
def test_no_command_overwrites_what_it_reads_or_what_is_no_file(
    command: list[str], force: list[str], capfd: pytest.CaptureFixture[str]
) -> None:
    Path("plain.wif").write_bytes(WIF.read_bytes())
    scene(HEAD + LOOM.replace("10/01", "plain.wif"))
    Path("mine.fmu").write_bytes(fmus.of_component("MainShaft").path.read_bytes())
    with Path("scene.toml").open("a") as text:
        text.write('[motor]\nfmu = "mine.fmu"\n')
    Path("other_name.toml").hardlink_to("scene.toml")
    os.mkfifo("pipe")
    Path("to_device").symlink_to("/dev/null")
    Path("notes").touch()
    Path("to_notes").symlink_to("notes")
    Path("to_nothing").symlink_to("nothing")
    Path("directory").mkdir()
    before = {path: untouched(path) for path in Path().iterdir()}
    said = {
        "scene.toml": "it is an input of this command",
        "./other_name.toml": "it is an input of this command",
        "plain.wif": "it is an input of this command",
        "mine.fmu": "it is an input of this command",
        "directory": "it is a directory",
        "pipe": "it is a device or a pipe, not a file",
        "to_device": "it is a symbolic link; name the file itself",
        "to_notes": "it is a symbolic link; name the file itself",
        "to_nothing": "it is a symbolic link; name the file itself",
        "/dev/full": "it is a device or a pipe, not a file",
    }
    for target, why in said.items():
        assert main([*command, target, *force]) == 2
        shown = str(Path(target))
        assert capfd.readouterr().err == f"loomfmu: {shown}: cannot be written ({why})\n"
    assert {path: untouched(path) for path in Path().iterdir()} == before
    assert Path("/dev/full").is_char_device()


def test_options_of_one_kind_of_export_are_refused_for_the_other(capsys: pytest.CaptureFixture[str]) -> None:
    path = scene(HEAD + SHAFT)
    assert main(["export", path, "--fmu", "loom.fmu", "--flavour", "live"]) == 2
    assert "--flavour is for --ssp: one FMU of a whole scene is always native" in capsys.readouterr().err
    assert main(["export", path, "--ssp", "loom.ssp", "--fmi", "3"]) == 2
    assert "--fmi is for --fmu: a system package holds FMUs of FMI 2.0" in capsys.readouterr().err
    assert not list(Path().glob("loom.*"))


def test_what_is_not_ours_is_replaced_only_when_told_to(capsys: pytest.CaptureFixture[str]) -> None:
    path = scene(HEAD + SHAFT)
    Path("out").mkdir()
    targets = {
        "notes.h5": (["run", path, "--output", "notes.h5"], "a trace of loomfmu"),
        "loom.ssp": (
            ["export", path, "--ssp", "loom.ssp", "--flavour", "live"],
            "a system package of loomfmu",
        ),
        "out/MainShaft.fmu": (["build", "MainShaft", "--output", "out"], "an FMU of loomfmu"),
    }
    for target, (command, kind) in targets.items():
        with zipfile.ZipFile(target, "w") as theirs:  # a third-party one
            theirs.writestr("SystemStructure.ssd", "<ssd generationTool='other'/>")
            theirs.writestr("modelDescription.xml", "<fmiModelDescription generationTool='other'/>")
        older = Path(target).read_bytes()
        assert main(command) == 2
        replaces = "--force (overwrite=True in Python) replaces it"
        assert capsys.readouterr().err == (f"loomfmu: {target}: exists and is not {kind}; {replaces}\n")
        assert Path(target).read_bytes() == older
        assert main([*command, "--force"]) == 0
        assert main(command) == 0  # now it is ours
        Path(target).write_bytes(b"")
        assert main(command) == 0  # nothing is lost with an empty file
        assert stat.S_IMODE(Path(target).stat().st_mode) == 0o666 & ~umask()
        capsys.readouterr()
    Path("scene.h5.partial").write_text("my own notes")
    assert main(["run", path, "--output", "scene.h5"]) == 2
    assert (
        "scene.h5.partial: exists and is not a partial trace of an interrupted run" in capsys.readouterr().err
    )


def umask() -> int:
    found = os.umask(0)
    os.umask(found)
    return found


def test_a_report_replaces_only_a_report(capsys: pytest.CaptureFixture[str]) -> None:
    Path("docs/validation").mkdir(parents=True)
    Path("docs/validation.md").write_text("# My thesis\n")
    assert main(["validate", "--output", "docs"]) == 2
    assert "docs/validation.md: exists and is not a report of loomfmu" in capsys.readouterr().err
    Path("docs/validation.md").unlink()
    Path("docs/validation/accuracy.png").write_text("my own")
    assert main(["validate", "--output", "docs"]) == 2
    assert "docs/validation/accuracy.png: exists and is not a PNG" in capsys.readouterr().err
    assert os.listdir("docs") == ["validation"]


def test_a_cache_may_lie_anywhere(tmp_path: Path) -> None:
    # pythonfmu's wrapper decodes no escape but that of a space and crashes where it finds no resources
    for name in ("with space", "Jürgen", "50% #1 +ä"):
        environment = os.environ | {"LOOMFMU_CACHE": str(tmp_path / name)}
        command = [sys.executable, "-m", "loomfmu.cli", "run", scene(HEAD + SHAFT)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, "")


# ---- build, list, show


def test_build_writes_the_named_fmus(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build", "MainShaft", "BeltMonitor", "--output", "made"]) == 0
    assert capsys.readouterr().out.split() == ["made/MainShaft.fmu", "made/BeltMonitor.fmu"]
    assert sorted(os.listdir("made")) == ["BeltMonitor.fmu", "MainShaft.fmu"]
    assert fmus.load(Path("made/MainShaft.fmu")).sha256 == fmus.of_component("MainShaft").sha256


def test_build_writes_all_by_default(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["build"]) == 0
    assert sorted(os.listdir("build/fmus")) == sorted(f"{name}.fmu" for name in NAMES)
    assert len(capsys.readouterr().out.split()) == len(NAMES)


def test_list_names_what_there_is(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["list"]) == 0
    printed = capsys.readouterr().out
    for name in NAMES:
        assert f"\n{name}: " in "\n" + printed
    assert "outputs: travel, velocity, acceleration, stroke, shaft_torque" in printed
    assert "WL680-3600" in printed and "G6300 left" in printed


@pytest.mark.parametrize(("bound", "status"), [(0.1, 0), (0.9, 1)])
def test_show_summarises_and_tells_again_whether_all_claims_held(
    capsys: pytest.CaptureFixture[str], bound: float, status: int
) -> None:
    main(["run", scene(HEAD + LOOM + CLAIM.format(bound=bound))])
    capsys.readouterr()
    assert main(["show", "results/scene.h5"]) == status
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("Small (loomfmu ") and lines[0].endswith(", complete)")
    assert lines[1:3] == ["run by: loomfmu run scene.toml", "91 samples over 0.15 s, 1 revolution"]
    row = next(line.split() for line in lines if line.startswith("shaft.angle"))
    assert row == ["shaft.angle", "0", "360", "360", "deg"]
    row = next(line.split() for line in lines if line.startswith("weft.stroke"))
    assert row[1:] == ["2.09529", "2.09529", "2.09529", "m"]
    assert any("lowest margin" in line for line in lines)


def test_show_of_an_unfinished_run_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    main(["run", scene(HEAD + SHAFT)])
    with h5py.File("results/scene.h5", "r+") as file:
        file.attrs["status"] = "interrupted"
    capsys.readouterr()
    assert main(["show", "results/scene.h5"]) == 1
    assert ", interrupted)" in capsys.readouterr().out
    with h5py.File("results/scene.h5", "r+") as file:
        file.attrs["status"] = "running"
    assert main(["show", "results/scene.h5"]) == 1
    assert ", running, or killed)" in capsys.readouterr().out


def test_a_reader_that_goes_away_is_no_failure() -> None:
    main(["run", scene(HEAD + LOOM)])
    command = [sys.executable, "-m", "loomfmu.cli", "show", "results/scene.h5"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        running.stdout.close()
        assert running.stderr.read() == b""
        assert running.wait() == 141  # as the shell says of a broken pipe


@pytest.mark.parametrize("arguments", [[], ["spin"], ["run"], ["run", "a", "b"], ["build", "--outpt", "x"]])
def test_a_command_that_is_none_returns_2(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as raised:
        main(arguments)
    assert raised.value.code == 2
    assert "usage: loomfmu" in capsys.readouterr().err


def test_the_command_is_installed() -> None:
    done = subprocess.run([Path(sys.executable).with_name("loomfmu"), "list"], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


# ---- mistakes: one line that names what, where and what would be right

CASES: dict[str, tuple[str, str]] = {
    # the scene's own keys
    "unknown key": (HEAD + "revolution = 3\n", "revolution is unknown; did you mean 'revolutions'?"),
    "unknown table": (
        HEAD + "[belts_x]\na = 1\n",
        "[belts_x] is unknown and has no component = \"...\" of its own; did you mean 'belt'?",
    ),
    "no instance name": (
        HEAD + '["my shaft"]\ncomponent = "MainShaft"\n',
        "instance name 'my shaft' must be letters, digits and _, with a letter first",
    ),
    "taken name": (
        HEAD + '[time]\ncomponent = "MainShaft"\n',
        "instance name 'time' is taken: every trace has a time of its own",
    ),
    "unknown component": (
        HEAD + '[mine]\ncomponent = "BeltMonito"\n',
        "there is no component 'BeltMonito'; did you mean 'BeltMonitor'?",
    ),
    "component no name": (HEAD + "[mine]\ncomponent = 5\n", "mine.component = 5 is not a name in quotes"),
    "no shaft": (
        HEAD + '[shaft]\ncomponent = "HealdFrame"\n',
        "shaft.component = 'HealdFrame': the shaft of a scene must be a MainShaft or a DrivenShaft",
    ),
    "bad TOML": ("a = = 5", "not valid TOML: Invalid value (at line 1, column 5)"),
    "zero steps": (
        HEAD.replace("90", "0"),
        "steps_per_revolution = 0 is outside [1, 1e+09]",
    ),
    "half a step": (HEAD.replace("90", "90.5"), "steps_per_revolution = 90.5 is not a whole number"),
    "no number of steps": (HEAD.replace("90", "'many'"), "steps_per_revolution = 'many' is not a number"),
    "no way back": (
        HEAD.replace("revolutions = 1", "revolutions = -1"),
        "revolutions = -1 is outside [1e-09, 1e+09]",
    ),
    "no whole step": (
        HEAD.replace("revolutions = 1", "revolutions = 1e-6"),
        "revolutions = 1e-06 at 90 steps each is less than one step",
    ),
    "NaN revolutions": (
        HEAD.replace("revolutions = 1", "revolutions = nan"),
        "revolutions = nan is outside [1e-09, 1e+09]",
    ),
    "zero speed": (
        HEAD + "[shaft]\nspeed = 0\n",
        "shaft.speed = 0 rev/min: the shaft's speed sets the step, so it must not be 0",
    ),
    "record no list": (
        "record = 'belt.margin'\n" + HEAD + LOOM,
        'record = \'belt.margin\' is not a list such as ["belt.*", "weft.travel"]',
    ),
    "record unknown": (
        "record = ['belt.margn']\n" + HEAD + LOOM,
        "record: no output is called 'belt.margn'; did you mean 'belt.margin'?",
    ),
    # the loom
    "loom key": (HEAD + "[loom]\nmachin = 'x'\n", "loom.machin is unknown; did you mean 'machine'?"),
    "unknown machine": (
        HEAD + LOOM.replace("3600", "36"),
        "there is no machine 'WL680-36'; did you mean 'WL680-3600'?",
    ),
    "machine no name": (HEAD + "[loom]\nmachine = 5\n", "weft.machine = 5 is not a name in quotes"),
    "unknown head": (
        HEAD + LOOM.replace(" left", ""),
        "there is no head 'G6300'; did you mean 'G6300 left'?",
    ),
    "dampers": (
        HEAD + LOOM + 'dampers = "no"\n',
        "loom.dampers = 'no' must be true or false",
    ),
    "pattern": (
        HEAD + LOOM + '[heald_1]\npattern = "12"\n',
        "heald_1.pattern = '12' is not a string of pegs such as \"1010\"",
    ),
    "pattern too long": (
        HEAD + LOOM + f'[heald_1]\npattern = "{"10" * 65}"\n',
        "heald_1.pattern has 130 picks; the dobby holds 128",
    ),
    "pattern elsewhere": (
        HEAD + LOOM + '[belt]\npattern = "10"\n',
        "belt.pattern: a BeltMonitor has no pattern",
    ),
    # values
    "unknown variable": (
        HEAD + LOOM + "[belt]\nguide_clearence = 1\n",
        "belt.guide_clearence is unknown; did you mean 'guide_clearance'?",
    ),
    "setting an output": (
        HEAD + LOOM + "[belt]\nmargin = 1\n",
        "belt.margin is an output of BeltMonitor and cannot be set",
    ),
    "setting a state": (
        HEAD + LOOM + "[belt]\nsampled_travel = 1\n",
        "belt.sampled_travel is a state of BeltMonitor and cannot be set",
    ),
    "unknown unit": (
        HEAD + '[shaft]\nspeed = "600 rpmm"\n',
        "shaft.speed: unknown unit 'rpmm'; did you mean 'rpm'?",
    ),
    "unit of another dimension": (
        HEAD + '[shaft]\nspeed = "600 mm"\n',
        "shaft.speed: '600 mm' is in mm, which does not fit rad/s",
    ),
    "out of range": (
        HEAD + LOOM + '[belt]\nguide_clearance = "90 mm"\n',
        "belt.guide_clearance = 90 mm is outside [0, 50] mm",
    ),
    "NaN": (
        HEAD + LOOM + "[belt]\nguide_clearance = nan\n",
        "belt.guide_clearance = nan mm is outside [0, 50] mm",
    ),
    "infinite": (
        HEAD + LOOM + "[belt]\nyarn_tension = inf\n",
        "belt.yarn_tension = inf cN is outside [-1e+08, 1e+08] cN",
    ),
    "negative stiffness": (
        HEAD + LOOM + "[belt]\nbending_stiffness = -0.25\n",
        "belt.bending_stiffness = -0.25 N.m2 is outside [1e-09, 1000000] N.m2",
    ),
    "no quantity": (
        HEAD + LOOM + "[belt]\nguide_clearance = [1]\n",
        'belt.guide_clearance: [1] is not a quantity such as "685 rpm"',
    ),
    "unknown law": (
        HEAD + LOOM + '[dobby]\nlaw = "sloped-sin"\n',
        "dobby.law = 'sloped-sin' is unknown; did you mean 'sloped_sine'?",
    ),
    "no yes or no": (
        HEAD + LOOM + "[belt]\nprescribe_length_factor = 1\n",
        "belt.prescribe_length_factor = 1 must be true or false",
    ),
    "no whole number": (
        HEAD + "[shaft]\nripple_order = 1.5\n",
        "shaft.ripple_order = 1.5 is not a whole number",
    ),
    # wires
    "wire to nowhere": (
        HEAD + LOOM + '[wires]\n"belt.yarn" = "weft.travel"\n',
        "wire weft.travel -> belt.yarn: belt has no input 'yarn'; did you mean 'yarn_tension'?",
    ),
    "wire from nowhere": (
        HEAD + LOOM + '[wires]\n"belt.yarn_tension" = "weft.travl"\n',
        "wire weft.travl -> belt.yarn_tension: weft has no output 'travl'; did you mean 'travel'?",
    ),
    "wire from nobody": (
        HEAD + LOOM + '[wires]\n"belt.yarn_tension" = "wft.travel"\n',
        "wire wft.travel -> belt.yarn_tension: there is no instance 'wft'; did you mean 'weft'?",
    ),
    "wire between units": (
        HEAD + LOOM + '[wires]\n"belt.yarn_tension" = "weft.travel"\n',
        "wire weft.travel -> belt.yarn_tension: weft.travel is in m, belt.yarn_tension in N",
    ),
    "cutting no wire": (
        HEAD + LOOM + '[wires]\n"belt.travl" = false\n',
        "wires: 'belt.travl' is not wired; did you mean 'belt.travel'?",
    ),
    "wire to true": (
        HEAD + LOOM + '[wires]\n"belt.travel" = true\n',
        'wires: "belt.travel" = true must be an output, or false to cut the wire',
    ),
    "a date": (
        HEAD + LOOM + "[belt]\nguide_clearance = 2026-01-02\n",
        'belt.guide_clearance: 2026-01-02 is not a quantity such as "685 rpm"',
    ),
    "decimal comma": (
        HEAD + LOOM + '[belt]\nguide_clearance = "0,5mm"\n',
        "belt.guide_clearance: '0,5mm' has a decimal comma: write \"0.5mm\"",
    ),
    "the scene's key in a table": (
        HEAD + LOOM + "[shaft]\nrecord = []\n",
        "shaft.record is unknown: record belongs to the scene, write it above the first [table]",
    ),
    "wires no table": (
        "wires = 5\n" + HEAD,
        'wires must be a table of "instance.input" = "instance.output"',
    ),
    # claims
    "claims no tables": ("claims = 5\n" + HEAD, "claims are written as [[claims]] tables"),
    "claim kind": (
        HEAD + '[[claims]]\nkind = "abov"\n',
        "claim kind = 'abov' is unknown; did you mean 'above'?",
    ),
    "claim argument": (
        HEAD + LOOM + '[[claims]]\nkind = "above"\nsignal = "belt.margin"\nbond = 1\n',
        "claim 'above' has no 'bond'; did you mean 'bound'?",
    ),
    "claim lacks": (
        HEAD + LOOM + '[[claims]]\nkind = "above"\nsignal = "belt.margin"\n',
        "claim 'above' needs 'bound'",
    ),
    "claim lacks a signal": (
        HEAD + '[[claims]]\nkind = "above"\nbound = 1\n',
        "claim 'above' needs 'signal'",
    ),
    "claim signal": (
        HEAD + LOOM + '[[claims]]\nkind = "above"\nsignal = "belt.margn"\nbound = 1\n',
        "claim 'above': belt has no output 'margn'; did you mean 'margin'?",
    ),
    "claim instance": (
        HEAD + LOOM + '[[claims]]\nkind = "dwell"\nheald = "heald_7"\nat_least = 1\n',
        "claim 'dwell': there is no instance 'heald_7'; did you mean 'heald_2'?",
    ),
    "claim unit": (
        HEAD + LOOM + '[[claims]]\nkind = "above"\nsignal = "belt.margin"\nbound = "1 mm"\n',
        "claim 'above': bound: '1 mm' is in mm, which does not fit a number without a unit",
    ),
    "claim NaN": (
        HEAD + LOOM + '[[claims]]\nkind = "above"\nsignal = "belt.margin"\nbound = nan\n',
        "claim 'above': bound = nan is not finite",
    ),
    "claim window": (
        HEAD + LOOM + '[[claims]]\nkind = "above"\nsignal = "belt.margin"\nbound = 1\nwindow = "10..20"\n',
        "claim 'above': window = '10..20' must be two shaft angles, such as [\"330 deg\", \"30 deg\"]",
    ),
    "claim window unit": (
        HEAD + LOOM + '[[claims]]\nkind = "above"\nsignal = "weft.travel"\nbound = 1\nwindow = ["1 mm", 2]\n',
        "claim 'above': window: '1 mm' is in mm, which does not fit rad",
    ),
    "claim with a parameter as a bound that is none of a signal": (
        HEAD + LOOM + '[[claims]]\nkind = "lowest_margin"\nbound = "shaft.speed"\n',
        "claim 'lowest_margin': bound: 'shaft.speed' is not a quantity such as \"685 rpm\"",
    ),
    "huge speed": (HEAD + f"[shaft]\nspeed = {HUGE}\n", f"shaft.speed: {HUGE[:60]}... is too large"),
    "huge duration": (
        HEAD.replace("revolutions = 1", f"revolutions = {HUGE}") + LOOM,
        f"revolutions = {HUGE[:60]}... is outside [1e-09, 1e+09]",
    ),
    "huge bound": (
        HEAD + LOOM + f'[[claims]]\nkind = "lowest_margin"\nbound = {HUGE}\n',
        f"claim 'lowest_margin': bound: {HUGE[:60]}... is too large",
    ),
    "huge pattern length": (
        HEAD + LOOM + f"[heald]\npattern_length = {HUGE}\n",
        f"heald_1.pattern_length = {HUGE[:60]}... is outside [1, 128]",
    ),
    "claim angles beyond a revolution": (
        HEAD + LOOM + '[[claims]]\nkind = "dwell_contains"\nheald = "heald_1"\nangles = [91]\n',
        "claim 'dwell_contains': angles: 91 is 5213.916 deg, outside [-360, 360] deg",
    ),
    "claim height": (
        HEAD + LOOM + '[[claims]]\nkind = "rapier_in_open_shed"\nhead_height = "-5 mm"\n',
        "claim 'rapier_in_open_shed': head_height = '-5 mm' must not be negative",
    ),
    "claim count": (
        HEAD + LOOM + '[damper_1]\n[[claims]]\nkind = "stop_contacts"\ndamper = "damper_1"\nat_most = -1\n',
        "claim 'stop_contacts': at_most = -1 must not be negative",
    ),
    "claim tolerance": (
        HEAD + LOOM + '[[claims]]\nkind = "dwell"\nheald = "heald_1"\nat_least = 1\ntolerance = 0.9\n',
        "claim 'dwell': tolerance = 0.9 is outside (0, 0.5) of the stroke",
    ),
}


def one_line(capsys: pytest.CaptureFixture[str]) -> str:
    printed = capsys.readouterr()
    assert printed.err.count("\n") == 1 and printed.err.endswith("\n"), printed.err
    assert "Traceback" not in printed.err
    assert printed.out == ""
    assert printed.err.startswith("loomfmu: ")
    return printed.err.removeprefix("loomfmu: ").strip()


@pytest.mark.parametrize("case", CASES)
def test_a_mistake_in_a_scene_is_told_in_one_line(capsys: pytest.CaptureFixture[str], case: str) -> None:
    text, said = CASES[case]
    assert main(["run", scene(text)]) == 2
    assert one_line(capsys) == f"scene.toml: {said}"
    assert not Path("results").exists()  # nothing was run, nothing written


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("belt.guide_clearance", "--set belt.guide_clearance: not of the form INSTANCE.VARIABLE=VALUE"),
        ("bel.travel=1", "scene.toml: bel.travel: the scene has no instance 'bel'; did you mean 'belt'?"),
        ("belt.travl=1", "scene.toml: belt.travl is unknown; did you mean 'travel'?"),
        ("belt.margin=1", "scene.toml: belt.margin is an output of BeltMonitor and cannot be set"),
        ("revolution=2", "scene.toml: 'revolution' cannot be set; did you mean 'revolutions'?"),
        ("shaft.speed=", "scene.toml: shaft.speed: '' is not a quantity such as \"685 rpm\""),
        ("shaft.speed=nan", "scene.toml: shaft.speed: 'nan' is not a quantity such as \"685 rpm\""),
        (
            "shaft.speed=1e999",
            "scene.toml: shaft.speed = inf rev/min is outside [-9549.297, 9549.297] rev/min",
        ),
        ("shaft.speed=685rpmm", "scene.toml: shaft.speed: unknown unit 'rpmm'; did you mean 'rpm'?"),
        ("heald.strok=1", "scene.toml: heald_1.strok is unknown; did you mean 'stroke'?"),
        (
            "heald.inputs_at_step_end=maybe",
            "scene.toml: heald_1.inputs_at_step_end = 'maybe' must be true or false",
        ),
    ],
)
def test_a_mistake_in_set_is_told_in_one_line(
    capsys: pytest.CaptureFixture[str], given: str, said: str
) -> None:
    assert main(["run", scene(HEAD + LOOM), "--set", given]) == 2
    assert one_line(capsys) == said


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            '[weft]\ncrank_cone = "80 deg"\n',
            "weft: the spherical linkage does not close over a whole turn: |cos(rocker_angle = 60 deg)|"
            " reaches or exceeds |cos(crank_cone = 80 deg)|",
        ),
        (
            '[weft]\ncoupler_length = "20 mm"\n',
            "weft: the planar four-bar does not close over the rocker's swing: crank_length = 150 mm,"
            " coupler_length = 20 mm, output_length = 121 mm, pivot at (243 mm, 258 mm)",
        ),
        ("[weft]\nassembly = 0\n", "weft: assembly = 0 must be -1 or 1"),
        (
            '[damper_1]\nstart_displacement = "20 mm"\n',
            "damper_1: start_displacement = 20 mm must lie between the stops at free_travel = 15 mm",
        ),
    ],
)
def test_values_that_do_not_go_together_are_told_in_one_line(
    capsys: pytest.CaptureFixture[str], text: str, said: str
) -> None:
    assert main(["run", scene(HEAD + LOOM + text)]) == 2
    assert one_line(capsys).startswith(said)
    assert not Path("results").exists()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run", "missing.toml"], "missing.toml: cannot be read (No such file or directory)"),
        (["run", "."], ".: cannot be read (Is a directory)"),
        (
            ["run", "scene.toml", "--output", "scene.toml/x.h5"],
            "scene.toml/x.h5: cannot be written (scene.toml is not a directory)",
        ),
        (["run", "scene.toml", "--output", "."], ".: cannot be written (it is a directory)"),
        (["run", "scene.toml", "--output", ""], ".: cannot be written (it is a directory)"),
        (
            ["run", "scene.toml", "--output", "/proc/none/x.h5"],
            "/proc/none/x.h5: cannot be written (No such file or directory)",
        ),
        (["build", "MainShft"], "there is no FMU 'MainShft'; did you mean 'MainShaft'?"),
        (
            ["build", "MainShaft", "--output", "scene.toml"],
            "scene.toml/MainShaft.fmu: cannot be written (scene.toml is not a directory)",
        ),
        (["show", "missing.h5"], "missing.h5: there is no such file"),
        (
            ["show", "scene.toml"],
            "scene.toml: cannot be read as a trace (it is not an HDF5 file)",
        ),
        (
            ["show", "other.h5"],
            "other.h5: not a trace of loomfmu: the dataset /shaft_angle is missing",
        ),
    ],
)
def test_a_mistake_in_a_file_name_is_told_in_one_line(
    capsys: pytest.CaptureFixture[str], arguments: list[str], said: str
) -> None:
    scene(HEAD + SHAFT)
    with h5py.File("other.h5", "w") as other:
        other["time"] = [0.0]
    assert main(arguments) == 2
    assert one_line(capsys) == said


PIPED = {  # what names a pipe, and how the refusal begins
    "run pipe": "pipe: cannot be read",
    "run pipe.ssp": "pipe.ssp: cannot be read",
    "sweep pipe": "pipe: cannot be read",
    "sweep over.toml": "over.toml: pipe: cannot be read",
    "show pipe": "pipe: cannot be read as a trace",
    "run woven.toml": "woven.toml: pipe.wif: cannot be read",
    "run motor.toml": "motor.toml: motor.fmu: pipe: not a readable FMU",
    "show /dev/zero": "/dev/zero: cannot be read as a trace",
}


@pytest.mark.parametrize("command", PIPED)
def test_what_is_not_a_file_is_not_read(capsys: pytest.CaptureFixture[str], command: str) -> None:
    # to read a pipe would be to wait for ever
    for name in ("pipe", "pipe.ssp", "pipe.wif"):
        os.mkfifo(name)
    Path("woven.toml").write_text(HEAD + LOOM.replace("10/01", "pipe.wif"))
    Path("motor.toml").write_text('duration = 1\nstep = 0.1\n[motor]\nfmu = "pipe"\n')
    Path("over.toml").write_text('scene = "pipe"\n[grid]\nmachine = ["WL680-3600"]\n')
    assert main(command.split()) == 2
    assert one_line(capsys) == f"{PIPED[command]} (it is a device or a pipe, not a file)"


def test_a_trace_that_is_cut_short_is_told_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    main(["run", scene(HEAD + LOOM)])
    whole = Path("results/scene.h5").read_bytes()
    Path("cut.h5").write_bytes(whole[: len(whole) // 2])
    capsys.readouterr()
    assert main(["show", "cut.h5"]) == 2
    left = f"it is cut off: {len(whole) // 2} of its {len(whole)} bytes are left"
    assert one_line(capsys) == f"cut.h5: cannot be read as a trace ({left})"


def test_a_trace_that_is_damaged_is_told_in_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    main(["run", scene(HEAD + LOOM)])
    content = bytearray(Path("results/scene.h5").read_bytes())
    for place in range(2000, len(content), 997):
        content[place] ^= 0xFF
    Path("damaged.h5").write_bytes(content)
    capsys.readouterr()
    assert main(["show", "damaged.h5"]) == 2
    assert "Traceback" not in (said := capsys.readouterr().err)
    assert said.startswith("loomfmu: damaged.h5: ") and said.count("\n") == 1


# ---- foreign text, and faults of our own


def test_names_with_brackets_and_escapes_are_only_shown(capsys: pytest.CaptureFixture[str]) -> None:
    text = HEAD.replace("Small", r"force [kN] \u202e [/mm]") + LOOM
    text += CLAIM.format(bound=0.9) + 'name = "margin [/mm] [bold]"\n'
    assert main(["run", scene(text)]) == 1
    first = capsys.readouterr()
    assert main(["show", "results/scene.h5"]) == 1
    again = capsys.readouterr()
    for printed in (first.out, again.out):
        assert r"force [kN] \u202e [/mm]" in printed
        assert "FAILS  margin [/mm] [bold]" in printed
        assert not {"\x1b", "\u202e"} & set(printed)
    assert main(["run", "no\x1b[2Jfile\u202e.toml"]) == 2
    assert capsys.readouterr().err.startswith(r"loomfmu: no\x1b[2Jfile\u202e.toml: cannot be read")
    with pytest.raises(SystemExit):
        main(["run", "a", "\x1b[2J"])
    assert "\x1b" not in capsys.readouterr().err


@pytest.mark.parametrize("before", [[], ["--debug"]])
@pytest.mark.parametrize("after", [[], ["--debug"]])
def test_a_fault_of_our_own_is_told_in_one_line(
    before: list[str], after: list[str], capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_arguments: object) -> None:
        raise RuntimeError("a\x1b[2J\nfault")

    monkeypatch.setattr("loomfmu.catalogue.overview", broken)
    assert main([*before, "list", *after]) == 2  # 1 is the status of a claim that fails
    lines = capsys.readouterr().err.splitlines()
    said = r"loomfmu: RuntimeError: a\x1b[2J fault (a bug in loomfmu; please report it"
    assert lines[-1] == f"{said} with the output of --debug)"
    assert len(lines) == 1 if not before + after else "Traceback (most recent call last):" in lines


def test_help_says_what_the_command_is_for(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    printed = " ".join(capsys.readouterr().out.split())
    assert printed.index("Simulate the mechanisms of a weaving loom") < printed.index("Exit status: 0 all")
    assert "1 a claim fails or is undecided;" in printed


def test_a_trace_that_was_not_judged_is_not_one_that_holds(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", scene(HEAD + SHAFT)]) == 0
    with h5py.File("results/scene.h5", "r+") as file:
        del file.attrs["claims"]
    capsys.readouterr()
    assert main(["show", "results/scene.h5"]) == 1
    assert capsys.readouterr().out.endswith("claims not judged: the run did not finish\n")


# ---- FMU files


def test_files_that_are_no_fmus_are_told_in_one_line(tmp_path: Path) -> None:
    whole = fmus.of_component("MainShaft").path.read_bytes()
    path = tmp_path / "wrong.fmu"
    for content in (b"", b"no zip", whole[: len(whole) // 2], whole[:-30]):
        path.write_bytes(content)
        with pytest.raises(LoomfmuError) as raised:
            fmus.load(path)
        assert str(raised.value) == f"{path}: not a readable FMU (File is not a zip file)"
    with pytest.raises(LoomfmuError, match=r"none\.fmu: there is no such FMU$"):
        fmus.load(tmp_path / "none.fmu")
    with pytest.raises(LoomfmuError, match=r": not a readable FMU \(Is a directory"):
        fmus.load(tmp_path)
    unpacked = cache_directory() / "unpacked"
    assert all(len(entry.name) == 64 for entry in unpacked.iterdir())  # nothing half unpacked is left


def test_a_zip_that_is_no_fmu_is_told_in_one_line(tmp_path: Path) -> None:
    import zipfile

    def packed(**files: str) -> Path:
        path = tmp_path / f"{len(os.listdir(tmp_path))}.fmu"
        with zipfile.ZipFile(path, "w") as zipped:
            for name, text in files.items():
                zipped.writestr(f"{name}.xml", text)
        return path

    start = '<fmiModelDescription fmiVersion="{}" modelName="M" guid="g"{}>'
    model_exchange = start.format("2.0", "") + '<ModelExchange modelIdentifier="M"/>'
    cases = {
        packed(): "not a readable FMU",
        packed(other="<a/>"): "not a readable FMU",
        packed(modelDescription="<a"): "its modelDescription.xml cannot be read",
        packed(modelDescription="<a/>"): "its modelDescription.xml cannot be read",
        packed(modelDescription=model_exchange + "<ModelVariables/></fmiModelDescription>"): "only FMI 2.0",
    }
    for path, said in cases.items():
        with pytest.raises(LoomfmuError) as raised:
            fmus.load(path)
        assert str(raised.value).startswith(f"{path}: ")
        assert said in str(raised.value) and "\n" not in str(raised.value)


def test_a_value_is_set_once_and_a_trace_is_called_what_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    path = scene(HEAD + LOOM)
    assert main(["run", path, "--set", "shaft.speed=400rpm", "--set", "shaft.speed=500rpm"]) == 2
    assert one_line(capsys) == "--set shaft.speed is given twice: 400rpm and 500rpm"
    assert main(["run", path, "--output", "x.csv"]) == 2
    assert one_line(capsys) == "x.csv: a trace of loomfmu ends in .h5; name it x.h5"
    assert not Path("x.csv").exists()


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full device")
def test_output_that_nobody_takes_is_no_failed_claim() -> None:
    command = f"{sys.executable} -m loomfmu.cli list"
    closed = subprocess.run(f"{command} >&-", shell=True, capture_output=True, text=True)
    assert (closed.returncode, closed.stderr) == (0, "")
    full = subprocess.run(f"{command} >/dev/full", shell=True, capture_output=True, text=True)
    assert full.returncode == 2
    assert full.stderr == "loomfmu: standard output: No space left on device\n"
