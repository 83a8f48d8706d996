"""Two runs at a time with one output: each is there whole, and the last one to finish stays."""

import os
from pathlib import Path

import numpy as np
import pytest
from attack_figures import record
from commands import started

from loomfmu import Trace

SCENE = 'steps_per_revolution = 1440\nrecord = ["belt.margin"]\n[loom]\nmachine = "WL680-3600"\n'
SPEEDS = (500.0, 650.0)
OUTPUT = "results/scene.h5"


def pair(directory: Path, revolutions: int) -> None:
    """Run two, and look at what both have left."""
    (directory / "scene.toml").write_text(f"revolutions = {revolutions}\n{SCENE}")
    running = [
        started(directory, "run", "scene.toml", "--output", OUTPUT, "--set", f"shaft.speed={speed} rpm")
        for speed in SPEEDS
    ]
    said = [each.communicate(timeout=300) for each in running]  # both have ended before one is judged
    for each, (printed, errors) in zip(running, said, strict=True):
        assert (each.returncode, errors) == (0, ""), errors
        assert f"trace: {OUTPUT}" in printed
    assert os.listdir(directory / "results") == ["scene.h5"]
    with Trace(directory / "results" / "scene.h5") as trace:
        assert trace.status == "complete"
        assert trace.rows == 1440 * revolutions + 1
        speed = trace.parameter("shaft.speed") * 30.0 / np.pi
        assert min(abs(speed - each) for each in SPEEDS) < 1e-9  # rounding of the conversion
        # all of it is of that run: the time of a revolution, and as many
        np.testing.assert_allclose(trace.time[-1], 60.0 / speed * revolutions, rtol=1e-12)
        assert np.all(np.isfinite(trace["belt.margin"]))


@pytest.mark.slow
@pytest.mark.parametrize(("count", "revolutions"), [(4, 1), (24, 1), (3, 2000)])
def test_runs_with_one_output(tmp_path: Path, fmu_cache: None, count: int, revolutions: int) -> None:
    for _ in range(count):
        pair(tmp_path, revolutions)
    record("pairs of runs with one output", count)
