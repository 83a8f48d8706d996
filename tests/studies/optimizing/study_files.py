"""Studies of the demo, short ones."""

from pathlib import Path

SIMS = Path(__file__).parents[3] / "sims"
DEMO = SIMS / "wl680_3600.toml"
FAST = "[set]\nrevolutions = 2\nsteps_per_revolution = 90\n"
QUICK = "[search]\nruns = 50\n"


def study(directory: Path, text: str, scene: Path = DEMO, head: str = FAST) -> Path:
    """A study of a scene, with `text` before its tables."""
    path = directory / "study.toml"
    path.write_text(f"scene = '{scene}'\n{text}\n{head}")
    return path
