"""Sweeps that are killed at any moment, or stopped by Ctrl-C, go on where they were."""

import os
import random
import signal
import time
from pathlib import Path
from typing import Any

import psutil
import pyarrow.parquet as pq
import pytest
from sweep_files import NO_TRACES, started, sweep_file, written

import loomfmu
from loomfmu.cosim.master.master import Interrupted
from loomfmu.cosim.master.rows import RowRunner

SPEEDS, MANY_SPEEDS = 41, 401


def swept(speeds: int) -> str:
    """A sweep of three times as many rows, a third of which cannot be run."""
    return (
        "[set]\nsteps_per_revolution = 1440\n"
        f'[grid]\n"shaft.speed" = {{ from = 40.0, to = 80.0, count = {speeds} }}\n'
        '"weft.coupler_length" = ["245 mm", "250 mm", "500 mm"]\n'
        "[traces]\nfailures = 1\nsample = 1\n"
    )


def undisturbed(directory: Path, speeds: int) -> bytes:
    """The table of the sweep that nobody disturbs."""
    return loomfmu.sweep(written(directory, swept(speeds)), processes=1, output=directory).path.read_bytes()


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    return undisturbed(tmp_path_factory.mktemp("whole"), SPEEDS)


def batches(results: Path) -> dict[str, int]:
    """The finished batches and when each was written."""
    return {path.name: path.stat().st_mtime_ns for path in (results / "batches").glob("*.parquet")}


def kill(path: Path, results: Path, moments: random.Random) -> bool:
    """Start the command and kill it at a random moment, from its first to that in which it ends.

    Whether it was still running; its workers end with it.
    """
    before = len(batches(results))
    more = moments.choice([None, 1, 1, 2])  # batches to wait for, if not for a time alone
    running = started(path, "--processes", "2")
    while more is not None and len(batches(results)) < before + more and running.poll() is None:
        time.sleep(0.005)
    time.sleep(moments.uniform(0.0, 1.5 if more is None else 0.1))
    alive = running.poll() is None
    workers = psutil.Process(running.pid).children(recursive=True) if alive else []
    running.kill()
    running.communicate()
    assert not psutil.wait_procs(workers, timeout=20)[1]
    return alive


@pytest.mark.slow
def test_a_sweep_that_is_killed_twenty_times_loses_and_doubles_nothing(tmp_path: Path) -> None:
    (tmp_path / "whole").mkdir()
    table = undisturbed(tmp_path / "whole", MANY_SPEEDS)
    path, results = sweep_file(swept(MANY_SPEEDS)), Path("results/swept")
    moments = random.Random(6)
    done: dict[str, int] = {}
    caught = 0
    for _ in range(20):
        caught += kill(path, results, moments)
        found = batches(results)
        over = (results / "table.parquet").exists()  # then its batches go
        assert over or done.items() <= found.items(), "a finished batch is neither lost nor written again"
        done = found
    assert caught > 12, "else the sweep was over too early"
    assert done, "else no kill came in the midst of the rows"
    running = started(path, "--processes", "2")
    printed, _errors = running.communicate(timeout=120)
    assert running.returncode == 1
    assert f"Swept: {3 * MANY_SPEEDS} combinations" in printed
    assert (results / "table.parquet").read_bytes() == table
    assert pq.read_table(results / "table.parquet")["row"].to_pylist() == list(range(3 * MANY_SPEEDS))
    assert not list(results.rglob("*.parquet.partial"))
    assert sorted(os.listdir(results)) == ["sweep.json", "table.parquet", "traces"]


@pytest.mark.parametrize("everybody", [True, pytest.param(False, marks=pytest.mark.slow)])
def test_ctrl_c_ends_a_sweep_that_goes_on_later(whole: bytes, everybody: bool) -> None:
    path = sweep_file(swept(SPEEDS))
    results = Path("results/swept")
    running = started(path, "--processes", "2")
    while not batches(results):
        assert running.poll() is None
        time.sleep(0.005)
    workers = psutil.Process(running.pid).children(recursive=True)
    if everybody:  # a terminal tells the whole group
        os.killpg(running.pid, signal.SIGINT)
    else:
        os.kill(running.pid, signal.SIGINT)
    printed, errors = running.communicate(timeout=60)
    assert running.returncode == 130, errors
    assert errors == (
        "loomfmu: interrupted; finished rows are kept in results/swept; run the same command to continue\n"
    )
    assert printed == ""
    assert not psutil.wait_procs(workers, timeout=20)[1]
    done = batches(results)
    assert done and not (results / "table.parquet").exists()
    if everybody:
        found = loomfmu.sweep(path, processes=1, output=results)
        assert 0 < found.ran < 3 * SPEEDS
        assert found.path.read_bytes() == whole
        assert sorted(os.listdir(results)) == ["sweep.json", "table.parquet", "traces"]


@pytest.mark.parametrize("how", [Interrupted, KeyboardInterrupt])
def test_ctrl_c_in_a_row_is_no_result_of_that_row(
    monkeypatch: pytest.MonkeyPatch, how: type[BaseException]
) -> None:
    text = '[grid]\n"shaft.speed" = { from = 40.0, to = 80.0, count = 50 }\n' + NO_TRACES
    path = sweep_file(text)
    whole = loomfmu.sweep(path, processes=1, output="whole").table
    calls = iter(range(50))
    part = RowRunner._part

    def interrupted(*arguments: Any) -> Any:
        if next(calls) == 2:
            raise how
        return part(*arguments)

    with monkeypatch.context() as patched:
        patched.setattr("loomfmu.cosim.master.rows.RowRunner._part", interrupted)
        with pytest.raises(KeyboardInterrupt, match=r"finished rows are kept in .*out; run the same"):
            loomfmu.sweep(path, processes=1, output="out")
    assert batches(Path("out")) and not Path("out/lock").exists()
    found = loomfmu.sweep(path, processes=1, output="out")
    assert 0 < found.ran < 50
    assert found.table.equals(whole, check_metadata=True)
