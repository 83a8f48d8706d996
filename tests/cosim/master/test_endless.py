"""A live FMU whose step does not return: the time limit and Ctrl-C end it, and the trace is kept."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import loomfmu
from loomfmu import LoomfmuError

WAITING = '''"""A mechanism that may wait for ever."""

from dataclasses import dataclass
from typing import ClassVar

from loomfmu.mechanism import {keeps}, Component, output


@dataclass(slots=True)
class Waiting(Component):
    """A mechanism."""

    keeps: ClassVar[str] = {keeps}
    value: float = output("1", "Value")

    def initialize(self, time: float) -> int:
        """Begin."""
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Wait at {time} s."""
        self.value = time
        while time > {time}:
            self.value = self.value + 0.0
        return 0
'''
SCENE = """
duration = 2
step = 0.01
step_timeout = {timeout}
[waiting]
component = "waiting.py"
"""


def written(folder: Path, *, timeout: float, keeps: str = "MOTION", begin: float = 0.495) -> Path:
    (folder / "waiting.py").write_text(WAITING.format(keeps=keeps, time=begin))
    (folder / "scene.toml").write_text(SCENE.format(timeout=timeout))
    return folder / "scene.toml"


def test_a_step_that_does_not_return_ends_the_run(tmp_path: Path) -> None:
    scene = written(tmp_path, timeout=0.4)
    with pytest.raises(
        LoomfmuError, match=r"^waiting at 0.5 s: .* did not return within step_timeout = 0.4 s$"
    ):
        loomfmu.run(scene, output=tmp_path / "run.h5", flavour="live")
    (kept,) = tmp_path.glob("run.h5*")
    assert loomfmu.Trace(kept).rows == 51


@pytest.mark.parametrize("keeps", ["EXTREMES", "NOTHING"])
def test_loading_does_not_hang(tmp_path: Path, keeps: str) -> None:
    scene = written(tmp_path, timeout=0.4, keeps=keeps, begin=0.1)
    with pytest.raises(LoomfmuError, match="did not return within step_timeout"):
        loomfmu.evaluate(scene, values=["waiting.value"], flavour="live")


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no SIGINT to send")
def test_ctrl_c_ends_it(tmp_path: Path) -> None:
    scene = written(tmp_path, timeout=600)
    command = [sys.executable, "-m", "loomfmu.cli", "run", scene.name, "--output", "run.h5", "--live"]
    with subprocess.Popen(command, cwd=tmp_path, stderr=subprocess.PIPE, text=True) as process:
        end = time.monotonic() + 60.0
        while not list(tmp_path.glob("run.h5.*.partial")) and time.monotonic() < end:
            time.sleep(0.05)
        time.sleep(1.0)  # it has come to the step that does not return
        process.send_signal(signal.SIGINT)
        _out, text = process.communicate(timeout=60)
    assert process.returncode == 130
    assert text == "loomfmu: interrupted; 51 samples are in run.h5.partial\n"


def test_a_time_limit_without_effect_is_rejected(tmp_path: Path) -> None:
    scene = written(tmp_path, timeout=0.4)
    with pytest.raises(
        LoomfmuError, match=r"step_timeout = 0.4 s cannot stop native FMUs .* isolated = true"
    ):
        loomfmu.evaluate(scene, flavour="native")
