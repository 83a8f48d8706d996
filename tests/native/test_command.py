"""The command with native FMUs."""

import zipfile

import pytest

from loomfmu import cli
from loomfmu.cosim.importing import fmus


def test_build_native(tools, fmu_cache, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli.main(["build", "--native", "--platform", "linux64", "MainShaft"]) == 0
    assert capsys.readouterr().out == "build/native/MainShaft.fmu\n"
    assert (
        fmus.load(tmp_path / "build/native/MainShaft.fmu").sha256
        == fmus.of_component("MainShaft", "native").sha256
    )
    assert cli.main(["build", "--native", "--platform", "linux64", "--fmi", "3", "MainShaft"]) == 0
    assert capsys.readouterr().out == "build/native_fmi3/MainShaft.fmu\n"
    with zipfile.ZipFile("build/native_fmi3/MainShaft.fmu") as zipped:
        assert "binaries/x86_64-linux/MainShaft.so" in zipped.namelist()


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--native", "--platform", "linux"], "there is no platform 'linux'; did you mean 'linux64'?"),
        (["--platform", "linux64"], "--platform and --fmi are for native FMUs: add --native"),
        (["--fmi", "3"], "--platform and --fmi are for native FMUs: add --native"),
        (["--native", "MainShat"], "there is no FMU 'MainShat'; did you mean 'MainShaft'?"),
    ],
)
def test_what_cannot_be_built_is_said_in_one_line(capsys, arguments, complaint):
    assert cli.main(["build", *arguments]) == 2
    assert capsys.readouterr().err == f"loomfmu: {complaint}\n"


def test_a_missing_compiler_is_named(tools, tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("loomfmu.fmi.native.compiler.compiler", lambda: None)
    call = ["build", "--native", "--platform", "linux64", "--output", str(tmp_path), "MainShaft"]
    assert cli.main(call) == 2
    assert capsys.readouterr().err.endswith(
        'loomfmu: this needs a compiler, which is not installed: pip install "loomfmu[native]"\n'
    )
    assert list(tmp_path.iterdir()) == []


def test_run_native(built, tmp_path, capsys):
    scene = tmp_path / "scene.toml"
    scene.write_text("revolutions = 0.1\nsteps_per_revolution = 90\n[weft]\n")
    assert cli.main(["run", str(scene), "--native", "--output", str(tmp_path / "run.h5")]) == 0
    assert "no claims" in capsys.readouterr().out
