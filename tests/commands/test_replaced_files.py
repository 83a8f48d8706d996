"""What a command replaces, and what it never does."""

import os
import stat
import zipfile
from pathlib import Path

import pytest
from small_scenes import CLAIM, HEAD, LOOM, SHAFT, scene

from loomfmu.cli import main
from loomfmu.cosim.importing import fmus

SPEED = "shaft.speed=580rpm..700rpm"
WIF = Path(__file__).parents[2] / "sims" / "weaves" / "twill_2_2.wif"


def untouched(path: Path) -> tuple[int, ...]:
    """What changes when a file is written, and not when it is read."""
    stat = path.lstat()
    return stat.st_mode, stat.st_ino, stat.st_size, stat.st_mtime_ns


@pytest.mark.parametrize("force", [[], ["--force"]])
@pytest.mark.parametrize(
    "command",
    [["run", "scene.toml", "--output"], ["export", "scene.toml", "--ssp"], ["export", "scene.toml", "--fmu"]],
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


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (["limit", "scene.toml", "--vary", SPEED, "--points", "3", "--output", "found.csv"], "holds up to"),
        (["tolerances", "scene.toml", "--vary", SPEED, "--picture", "found.svg"], "worst"),
        (["fit", "scene.toml", "data.csv", "--vary", SPEED, "--output", "found.toml"], "shaft.speed"),
    ],
)
def test_what_was_found_is_shown_even_if_the_disk_is_full(
    command: list[str], said: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    scene(HEAD + LOOM + '[shaft]\nspeed = "600 rev/min"\n' + CLAIM.format(bound=0.1))
    Path("data.csv").write_text("time [s],belt.margin [1]\n0.02,1.0\n0.025,0.3\n0.027,0.4\n")

    def full(_descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    assert main(command) == 2
    printed = capsys.readouterr()
    assert said in printed.out
    assert printed.err.endswith(f"loomfmu: {command[-1]}: cannot be written (No space left on device)\n")
