"""Runs that are killed at any moment lose a second at most; sweeps that are go on to the same table."""

import random
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from attack_figures import record
from commands import started
from sweeps.sweep_files import NO_TRACES, written
from sweeps.sweep_files import started as sweep_started

import loomfmu
from loomfmu import LoomfmuError, Trace

SCENE = 'steps_per_revolution = 1440\nrecord = ["belt.*", "weft.travel"]\n[loom]\nmachine = "WL680-3600"\n'
RUN = ("run", "scene.toml", "--set", "revolutions=20", "--output", "results/scene.h5")
SLOW = """
import sys, time
from loomfmu import cli
from loomfmu.cosim.master import master
take, taken = master.Master._advance, 0
def slowly(self, span, *rows):
    global taken
    time.sleep(0.2 * len(span))
    done = take(self, span, *rows)
    taken += done[0]
    print(taken, flush=True)
    return done
master.Master._advance = slowly
cli.main(["run", "scene.toml"])
"""


def test_a_run_of_slow_steps_loses_a_second_at_most(tmp_path: Path, fmu_cache: None) -> None:
    (tmp_path / "scene.toml").write_text("revolutions = 1\n" + SCENE)
    command = [sys.executable, "-c", SLOW]
    running = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    assert running.stdout is not None
    taken = 0
    while taken < 15:
        taken = int(running.stdout.readline())
    running.kill()
    rest = running.communicate()[0].split()
    taken = int(rest[-1]) if rest else taken
    with Trace(next((tmp_path / "results").glob("*.partial"))) as kept:
        assert kept.status == "running"
        assert kept.rows >= 1 + taken - 5  # steps of 0.2 s


def check_partial(directory: Path, whole: Trace) -> int:
    """What a killed run left is the beginning of the whole one, or was not begun; its samples."""
    (left,) = (directory / "results").glob("*.partial")
    try:
        kept = Trace(left)
    except LoomfmuError as error:
        assert (
            str(error).endswith(": the run ended before it wrote a sample")
            or left.read_bytes().strip(b"\0") == b""
        )
        left.unlink()
        return 0
    with kept:
        for signal in kept:
            np.testing.assert_array_equal(kept[signal], whole[signal][: kept.rows])
        np.testing.assert_array_equal(kept.time, whole.time[: kept.rows])
        found = kept.rows
    left.unlink()
    return found


def kill_runs(directory: Path, count: int, seed: int) -> None:
    """Kill runs at random moments, from their first to the one at which they end."""
    (directory / "scene.toml").write_text("revolutions = 1\n" + SCENE)
    before = time.monotonic()
    assert started(directory, *RUN).communicate() and (directory / "results" / "scene.h5").exists()
    length = time.monotonic() - before
    whole = Trace(directory / "results" / "scene.h5")
    values = {signal: whole[signal] for signal in whole}
    moments = random.Random(seed)
    ended = early = 0
    samples = []
    for _ in range(count):
        running = started(directory, *RUN)
        time.sleep(moments.uniform(0.0, 1.1 * length))
        running.kill()
        running.communicate()
        if list((directory / "results").glob("*.partial")):
            samples.append(check_partial(directory, whole))
        elif running.returncode == 0:
            ended += 1
        else:
            early += 1
        with Trace(directory / "results" / "scene.h5") as trace:
            assert trace.status == "complete" and len(trace.verdicts) == 0
            assert all(np.array_equal(trace[signal], values[signal]) for signal in values)
        whole = Trace(directory / "results" / "scene.h5")
    print(f"{early} before the first sample, {len(samples)} partial traces, {ended} had ended")
    record("runs killed at random moments", count)


def kill_sweep(directory: Path, count: int, seed: int) -> None:
    """Kill a sweep again and again until it is through."""
    text = (
        "[set]\nsteps_per_revolution = 1440\n"
        '[grid]\n"shaft.speed" = { from = 40.0, to = 80.0, count = 101 }\n'
    )
    (directory / "whole").mkdir()
    whole = loomfmu.sweep(written(directory / "whole", text + NO_TRACES), processes=1, output=directory / "w")
    moments = random.Random(seed)
    path = written(directory, text + NO_TRACES)
    rounds = kills = 0
    while kills < count:
        rounds += 1
        running = sweep_started(path, "--processes", "2", *(["--restart"] if rounds == 1 else []))
        time.sleep(moments.uniform(0.5, 2.5))
        kills += running.poll() is None
        running.kill()
        running.communicate()
        if (directory / "results" / "swept" / "table.parquet").exists():
            table = (directory / "results" / "swept" / "table.parquet").read_bytes()
            assert table == whole.path.read_bytes()
            rounds = 0
    again = loomfmu.sweep(path, processes=1, output=directory / "results" / "swept")
    assert again.path.read_bytes() == whole.path.read_bytes()
    record("sweeps killed at random moments", kills)


@pytest.mark.slow
@pytest.mark.parametrize(("runs", "sweeps", "seed"), [(6, 4, 1), (120, 50, 2)])
def test_runs_and_a_sweep_that_are_killed(
    tmp_path: Path, fmu_cache: None, runs: int, sweeps: int, seed: int
) -> None:
    kill_runs(tmp_path, runs, seed)
    kill_sweep(tmp_path, sweeps, seed)
