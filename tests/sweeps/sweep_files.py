"""A small scene, sweeps of it, and the command in a process of its own."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import loomfmu

SCENE = """
title = "Small"
revolutions = 1
steps_per_revolution = 90

[loom]
machine = "WL680-3600"
head = "G6300 left"

[shaft]
speed = "600 rev/min"

[[claims]]
name = "the belt does not buckle"
kind = "lowest_margin"
bound = 0.0

[[claims]]
name = "the loom runs below its safe speed"
kind = "above"
signal = "belt.lowest_speed_limit"
bound = "shaft.speed"
"""
HEAD = 'title = "Swept"\nscene = "scene.toml"\nvalues = ["belt.lowest_speed_limit"]\n'
NO_TRACES = "[traces]\nfailures = 0\nsample = 0\n"


def written(directory: Path, text: str, scene: str = SCENE, head: str = HEAD) -> Path:
    """A sweep beside its scene."""
    (directory / "scene.toml").write_text(scene)
    path = directory / "swept.toml"
    path.write_text(head + text)
    return path


def sweep_file(text: str, scene: str = SCENE, head: str = HEAD) -> Path:
    """A sweep and its scene in the current folder."""
    return written(Path(), text, scene, head)


def swept(text: str, output: str = "out", **files: Any) -> loomfmu.Sweep:
    """A sweep that was run in this process."""
    return loomfmu.sweep(sweep_file(text, **files), processes=1, output=output)


def started(path: Path, *arguments: str) -> subprocess.Popen[str]:
    """The command, in a process group of its own."""
    return subprocess.Popen(
        [sys.executable, "-m", "loomfmu.cli", "sweep", str(path), *arguments],
        cwd=path.parent,
        env=os.environ | {"COLUMNS": "150"},
        start_new_session=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
