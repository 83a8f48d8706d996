"""How a command ends: its exit status, and one line on whatever goes wrong."""

import os
import subprocess
import sys
from pathlib import Path

import h5py
import pytest
from small_scenes import HEAD, LOOM, SHAFT, one_line, scene

from loomfmu.cli import main


def test_a_reader_that_goes_away_is_no_failure() -> None:
    main(["run", scene(HEAD + LOOM)])
    command = [sys.executable, "-m", "loomfmu.cli", "show", "results/scene.h5"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
        running.stdout.close()
        assert running.stderr.read() == b""
        assert running.wait() == 141  # as the shell says of a broken pipe


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="the system has no full device")
def test_output_that_nobody_takes_is_no_failed_claim() -> None:
    command = f"{sys.executable} -m loomfmu.cli list"
    closed = subprocess.run(f"{command} >&-", shell=True, capture_output=True, text=True)
    assert (closed.returncode, closed.stderr) == (0, "")
    full = subprocess.run(f"{command} >/dev/full", shell=True, capture_output=True, text=True)
    assert full.returncode == 2
    assert full.stderr == "loomfmu: standard output: No space left on device\n"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["run", "missing.toml"], "missing.toml: cannot be read (No such file or directory)"),
        (["run", "."], ".: cannot be read (Is a directory)"),
        (["run", "scene.toml", "--output", "scene.toml/x.h5"],
         "scene.toml/x.h5: cannot be written (scene.toml is not a directory)"),
        (["run", "scene.toml", "--output", "."], ".: cannot be written (it is a directory)"),
        (["run", "scene.toml", "--output", ""], ".: cannot be written (it is a directory)"),
        (["run", "scene.toml", "--output", "/proc/none/x.h5"],
         "/proc/none/x.h5: cannot be written (No such file or directory)"),
        (["build", "MainShft"], "there is no FMU 'MainShft'; did you mean 'MainShaft'?"),
        (["build", "MainShaft", "--output", "scene.toml"],
         "scene.toml/MainShaft.fmu: cannot be written (scene.toml is not a directory)"),
        (["show", "missing.h5"], "missing.h5: there is no such file"),
        (["show", "scene.toml"],
         "scene.toml: cannot be read as a trace (it is not an HDF5 file; loomfmu run writes one)"),
        (["show", "other.h5"], "other.h5: not a trace of loomfmu (the dataset /shaft_angle is missing)"),
    ],
)  # fmt: skip
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
