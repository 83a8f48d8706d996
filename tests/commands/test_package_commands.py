"""`build` and `list`."""

import os
from pathlib import Path

import pytest
from live_fmus import NAMES

from loomfmu.cli import main
from loomfmu.cosim.importing import fmus


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
