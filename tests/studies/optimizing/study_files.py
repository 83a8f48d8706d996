"""Studies of the demo, short ones."""

from pathlib import Path
from typing import Any

from loomfmu import Optimum, optimize

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
    """The best design of a study, searched in this process."""
    return optimize(study(text, scene, head), **{"processes": 1} | how)
