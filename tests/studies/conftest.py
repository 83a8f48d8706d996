"""Studies run in a folder of their own; a small loom whose claims can be proven, with its proofs."""

from pathlib import Path

import pytest

from loomfmu.cosim.scenes.scene import Scene, parse
from loomfmu.studies.proving.proofs import Proofs
from loomfmu.studies.proving.prove import prove

LOOM = """
revolutions = 2
steps_per_revolution = 720
[loom]
machine = "WL680-3600"
head = "G6300 left"
weave = "10/01"
[shaft]
speed = "600 rev/min"
[[claims]]
name = "margin"
kind = "lowest_margin"
bound = 0.1
[[claims]]
name = "safe speed"
kind = "above"
signal = "belt.lowest_speed_limit"
bound = "shaft.speed"
[[claims]]
name = "dwell"
kind = "dwell"
heald = "heald_1"
at_least = "80 deg"
[[claims]]
name = "transfer"
kind = "dwell_contains"
heald = "heald_2"
angles = ["140 deg", "180 deg", "220 deg"]
[[claims]]
name = "count"
kind = "below"
signal = "belt.buckled"
bound = 0.5
"""
SPEEDS = "shaft.speed=300rpm..640rpm"


@pytest.fixture(scope="session")
def loom() -> Scene:
    return parse(LOOM, "loom")


@pytest.fixture(scope="session")
def proofs(loom: Scene) -> Proofs:
    return prove(loom, over=[SPEEDS])


@pytest.fixture(autouse=True)
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
