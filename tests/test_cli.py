"""The command: it is installed, and says what it takes."""

import subprocess
import sys
from pathlib import Path

import pytest

from loomfmu.cli import main


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("spin", "loomfmu: there is no command 'spin'; did you mean "),
        ("rnu x.toml", "loomfmu: there is no command 'rnu'; did you mean 'run'?"),
        ("--debug", "loomfmu: COMMAND is missing; see loomfmu --help"),
        ("run", "loomfmu run: SCENE is missing; write loomfmu run SCENE"),
        ("run a b", "loomfmu run: 'b' is one argument too many; write loomfmu run SCENE"),
        ("run a --set", "loomfmu run: --set needs a value; write --set INSTANCE.VARIABLE=VALUE"),
        ("run a --live --native", "loomfmu run: --native and --live exclude each other; leave out one"),
        ("run a --live=3", "loomfmu run: --live takes no value, but has '3'; see loomfmu run --help"),
        ("run a --frobnicate", "loomfmu run: there is no --frobnicate; see loomfmu run --help"),
        ("build --outpt x", "loomfmu build: there is no --outpt; did you mean --output?"),
        ("sweep a --processes x", "loomfmu sweep: --processes = 'x' is not a whole number; write --pro"),
        ("limit",
         "loomfmu limit: SCENE and --vary are missing; write loomfmu limit SCENE --vary INSTANCE.VARI"),
        ("export x",
         "loomfmu export: --fmu or --ssp is missing; write loomfmu export SCENE.toml --fmu FILE.fmu"),
        ("export x.toml --ssp x.ssp --flavour natve",
         "loomfmu export: --flavour = 'natve' is unknown; did you mean 'native'?"),
    ],
)  # fmt: skip
def test_a_mistake_in_a_command_is_one_line_with_the_remedy(
    words: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as raised:
        main(words.split())
    assert raised.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(said)


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
