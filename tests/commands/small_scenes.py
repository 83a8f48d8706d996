"""Small scenes in the working directory, and what a command says of a mistake."""

from pathlib import Path

import pytest

HEAD = 'title = "Small"\nrevolutions = 1\nsteps_per_revolution = 90\n'
SHAFT = "[shaft]\n"
LOOM = '[loom]\nmachine = "WL680-3600"\nhead = "G6300 left"\nweave = "10/01"\n'
HUGE = "1" + 400 * "0"  # more than any float holds
CLAIM = '[[claims]]\nkind = "lowest_margin"\nbound = {bound}\n'


def scene(text: str) -> str:
    Path("scene.toml").write_text(text)
    return "scene.toml"


def one_line(capsys: pytest.CaptureFixture[str]) -> str:
    printed = capsys.readouterr()
    assert printed.err.count("\n") == 1 and printed.err.endswith("\n"), printed.err
    assert "Traceback" not in printed.err
    assert printed.out == ""
    assert printed.err.startswith("loomfmu: ")
    return printed.err.removeprefix("loomfmu: ").strip()
