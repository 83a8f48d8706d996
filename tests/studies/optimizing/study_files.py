"""Studies of the demo, short ones."""

from pathlib import Path
from typing import Any

import pytest
from matplotlib.figure import Figure

from loomfmu import Optimum, optimize
from loomfmu.studies.optimizing import best_design

SIMS = Path(__file__).parents[3] / "sims"
DEMO = SIMS / "wl680_3600.toml"
FAST = "[set]\nrevolutions = 2\nsteps_per_revolution = 90\n"
QUICK = "[search]\nruns = 50\n"
GOAL = 'maximise = "shaft.speed"\n'
SPEED = '[ranges]\n"shaft.speed" = ["400 rpm", "900 rpm"]\n'


def study(text: str, scene: Path = DEMO, head: str = FAST) -> Path:
    """A study of a scene in the current folder, with `text` before its tables."""
    path = Path("study.toml")
    path.write_text(f"scene = '{scene}'\n{text}\n{head}")
    return path


def searched(text: str, scene: Path = DEMO, head: str = FAST + QUICK, **how: Any) -> Optimum:
    """The best design of a study, searched in this process; drawing its picture takes half a second."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(best_design, "draw", lambda *_given: Figure())
        return optimize(study(text, scene, head), **{"processes": 1} | how)
