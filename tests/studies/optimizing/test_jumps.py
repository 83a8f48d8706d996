"""A goal that jumps, where linear programs stop short of the best design."""

from pathlib import Path

import pytest
from study_files import searched

STAIRS = """
from dataclasses import dataclass
from math import fabs, floor
from typing import ClassVar

from loomfmu.mechanism import NOTHING, ShaftDriven, output, parameter


@dataclass(slots=True)
class Stairs(ShaftDriven):
    \"\"\"Stairs that fall towards their edges.\"\"\"

    keeps: ClassVar[str] = NOTHING
    longest_turn: ClassVar[float] = 0.3
    a: float = parameter("1", 0.5, "Along the stairs", minimum=0.0, maximum=1.0)
    b: float = parameter("1", 0.5, "Across", minimum=0.0, maximum=1.0)
    height: float = output("1", "Height")

    def initialize(self, time: float) -> int:
        \"\"\"Begin.\"\"\"
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        \"\"\"Go on.\"\"\"
        self.shaft(time, step_size)
        self.height = floor(7.0 * self.a) / 7.0 - 0.3 * fabs(self.b - 0.41) - 0.5 * self.a
        return 0
"""
SCENE = """
revolutions = 1
steps_per_revolution = 24
[stairs]
component = "stairs.py:Stairs"
speed = "600 rpm"
[[claims]]
kind = "above"
signal = "stairs.height"
bound = -100.0
at_samples = true
"""
GOAL = 'maximise = "lowest stairs.height"\n[ranges]\n"stairs.a" = [0.0, 1.0]\n"stairs.b" = [0.0, 1.0]\n'


def test_the_best_design_is_the_best_of_all_that_were_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("stairs.py").write_text(STAIRS)
    Path("stairs.toml").write_text(SCENE)
    (found,) = searched(GOAL, Path("stairs.toml"), "").front
    assert found.values["stairs.a"] == 1.0  # the top step, whose edge is the end of the range
    assert found.goals[0] == pytest.approx(0.5, abs=1e-3)
