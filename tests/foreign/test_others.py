"""The trials of FMUs of other makers, and the page that they go into."""

from pathlib import Path
from typing import Any

import numpy as np
import others
import pytest
from foreign_motors import ARRAYS, motor2, motor3, packed
from others import column, compared
from page import written

from loomfmu import LoomfmuError
from loomfmu.cosim.importing import fmus


def said_of(path: Path) -> dict[str, Any]:
    said: dict[str, Any] = {}
    compared(path, said.update)
    return said


def test_a_motor_gives_the_results_of_fmpy(tmp_path: Path) -> None:
    said = said_of(motor2(tmp_path))
    assert said["steps"] == 500 and said["signals"] > 5
    assert said["difference"] < 1e-12  # it adds up steps that differ in their last bits


def test_an_element_of_an_array_is_found_in_what_fmpy_gives(tmp_path: Path) -> None:
    ports = fmus.load(motor3(tmp_path, description=ARRAYS)).ports
    rows = np.zeros(7, [("y", float, (2, 2))])
    rows["y"][:, 1, 0] = 3.0
    assert column(rows, ports["y_2_1"]).tolist() == [3.0] * 7 and not column(rows, ports["y_1_2"]).any()


def test_a_difference_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(others, "column", lambda rows, port: column(rows, port) * (1.0 + 1e-6))
    assert said_of(motor2(tmp_path))["difference"] == pytest.approx(1e-6, rel=1e-3)


def test_a_refusal_is_told(tmp_path: Path) -> None:
    path = packed(tmp_path / "Motor.fmu", "<nothing/>", None, "Motor")
    with pytest.raises(LoomfmuError, match="cannot be read"):
        said_of(path)


def test_the_page_says_what_ran_and_what_did_not() -> None:
    text = written(
        {
            "one": {"alone": {"difference": 0.0}, "whole": {"difference": 2e-15}},
            "other": {"alone": {"absent": "gone"}},
        },
        {("one", 500): {"a.x": 0.5, "a.y": 0.001}, ("one", 1000): {"a.x": 0.25, "a.y": 0.0}},
        {"checker": {"2": {"number": 17}}},
        {"one": "1.0", "other": "", "checker": "2.0"},
        {
            "twice": {"expected": 2.0, "ours": 2.0 + 1e-12, "theirs": 1.0},
            "no end": {"expected": "wrong", "refused": "no|end", "theirs": 4.0},
            "a map": {"expected": 3.0, "refused": "a map", "said": "ends its process (status -6)"},
            "neither": {"expected": "wrong", "ours": 1.0, "said": "ends its process (status -6)"},
            "no time": {"expected": "unclear", "refused": "no time", "theirs": 1.0},
        },
        {"theirs.ssp": {"steps": 7, "signals": 3, "difference": 0.5, "at_end": 0.0}},
        [{"FMU": "b.fmu", "steps": 5, "difference": 1e-3}, {"FMU": "a.fmu", "refused": "it is a|b"}],
        steps=10,
        most=20,
    )
    lines = text.splitlines()
    assert "| one | 1.0 | 0 | 2e-15 |" in lines and "| other | not run | - |" in lines
    assert "| `a.x` | 0.5 | 0.25 |" in lines and "a.y" not in text
    assert "other: gone." in lines and "| checker | 2.0 | 17 |" in lines
    assert "| a.fmu |  |  |  |  |  | it is a\\|b |" in lines and "| b.fmu |  |  |  | 5 |  | 1e-03 |" in lines
    assert "| twice | 2 | 2 | 1 |" in lines and "| no end | wrong | no\\|end | 4 |" in lines
    assert "| a map | 3 | a map | ends its process (status -6) |" in lines
    assert "4 that are clear our runs treat 2 so, and OMSimulator 0; ours refuse 1 right ones." in lines
    assert "| theirs.ssp | 7 | 3 | 5e-01 | 0 |" in lines
    assert "Of 2 FMUs 1 run in both,\n1 are refused by us.\n" in text
