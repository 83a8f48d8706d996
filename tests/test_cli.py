"""The command: it is installed, and says what it takes."""

import subprocess
import sys
from pathlib import Path

import pytest

from loomfmu.cli import main


@pytest.mark.parametrize("arguments", [[], ["spin"], ["run"], ["run", "a", "b"], ["build", "--outpt", "x"]])
def test_a_command_that_is_none_returns_2(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as raised:
        main(arguments)
    assert raised.value.code == 2
    assert "usage: loomfmu" in capsys.readouterr().err


def test_the_command_is_installed() -> None:
    done = subprocess.run([Path(sys.executable).with_name("loomfmu"), "list"], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_help_says_what_the_command_is_for(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        main(["--help"])
    printed = " ".join(capsys.readouterr().out.split())
    assert printed.index("Simulate the mechanisms of a weaving loom") < printed.index("Exit status: 0 all")
    assert "1 a claim fails or is undecided;" in printed
