"""The command: it is installed, and says what it takes."""

import subprocess
import sys
from pathlib import Path

import pytest

from loomfmu.cli import main


@pytest.mark.parametrize("arguments", [["spin"], ["run"], ["run", "a", "b"], ["build", "--outpt", "x"]])
def test_a_command_that_is_none_returns_2(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as raised:
        main(arguments)
    assert raised.value.code == 2
    assert "usage: loomfmu" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["rnu", "x.toml"], "loomfmu: error: argument COMMAND: 'rnu' is unknown; did you mean 'run'?"),
        (
            ["export", "x.toml", "--ssp", "x.ssp", "--flavour", "natve"],
            "loomfmu export: error: argument --flavour: 'natve' is unknown; did you mean 'native'?",
        ),
    ],
)
def test_a_misspelt_word_is_answered_with_the_nearest(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        main(arguments)
    assert capsys.readouterr().err.splitlines()[-1] == said


@pytest.mark.parametrize(
    "command", [[Path(sys.executable).with_name("loomfmu")], [sys.executable, "-m", "loomfmu"]]
)
def test_the_command_is_installed(command: list[str | Path]) -> None:
    done = subprocess.run([*command, "list"], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("arguments", [[], ["--help"]])
def test_help_says_what_the_command_is_for(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as raised:
        main(arguments)
    assert raised.value.code == 0
    printed = " ".join(capsys.readouterr().out.split())
    assert printed.index("Simulate the mechanisms of a weaving loom") < printed.index("Exit status: 0 all")
    assert "1 a claim fails or is undecided;" in printed
