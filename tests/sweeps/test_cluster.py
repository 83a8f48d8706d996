"""A dask cluster instead of processes of our own: the same batches, the same table."""

import importlib
import logging
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import odd_tasks
import pytest
from sweep_files import NO_TRACES, sweep_file, swept

import loomfmu
from loomfmu import LoomfmuError
from loomfmu.cli import main

distributed = pytest.importorskip("distributed")

SWEPT = (
    '[grid]\n"weft.coupler_length" = ["245 mm", "500 mm"]\n'
    '[sample]\ncount = 12\nseed = 4\n"shaft.speed" = ["500 rpm", "800 rpm"]\n' + NO_TRACES
)


@pytest.fixture(scope="module")
def cluster(fmu_cache: None) -> Iterator[Any]:
    """Two workers, started anew when they end."""
    import dask

    quiet = {"distributed.admin.system-monitor.disk": False, "distributed.scheduler.allowed-failures": 0}
    with dask.config.set(quiet):
        running = distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=2,
            dashboard_address=":0",
            silence_logs=logging.CRITICAL,
            host="127.0.0.1",
        )
        yield running
        running.close()


@pytest.mark.slow
def test_a_cluster_makes_the_table_of_one_process(cluster: Any) -> None:
    one = swept(SWEPT, "one")
    found = loomfmu.sweep("swept.toml", scheduler=cluster.scheduler_address, output="cluster")
    assert found.ran == 24 and found.errors == 12
    assert found.path.read_bytes() == one.path.read_bytes()


def test_a_search_on_a_cluster_finds_what_one_process_finds(cluster: Any) -> None:
    text = 'maximise = "shaft.speed"\n[ranges]\n"shaft.speed" = ["500 rpm", "800 rpm"]\n[search]\nruns = 50\n'
    path = sweep_file(text, head='scene = "scene.toml"\n')
    one = loomfmu.optimize(path, processes=1, output="one")
    found = loomfmu.optimize(path, scheduler=cluster.scheduler_address, output="cluster")
    assert found.goal == one.goal and found.runs == one.runs
    names = ("designs.csv", "best.toml")
    assert all((found.path / name).read_bytes() == (one.path / name).read_bytes() for name in names)


def test_the_rows_run_on_the_cluster_and_a_sweep_goes_on_there(
    cluster: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = sweep_file(SWEPT)
    output = Path("out")
    with monkeypatch.context() as killed_at_the_end:
        killed_at_the_end.setattr("loomfmu.sweeps.store.Store.tidy", lambda _store: None)
        loomfmu.sweep(path, processes=1, output=output)
    for batch in sorted(os.listdir(output / "batches"))[1:]:
        (output / "batches" / batch).unlink()

    def here(*_arguments: object, **_named: object) -> None:
        pytest.fail("a row ran in the process that asked")

    monkeypatch.setattr("loomfmu.cosim.prepared.Prepared.evaluate", here)
    before = (output / "table.parquet").read_bytes()
    (output / "table.parquet").unlink()
    arguments = ["sweep", str(path), "--output", str(output), "--scheduler", cluster.scheduler_address]
    assert main(arguments) == 1
    assert "24 combinations (1 run before)" in capsys.readouterr().out
    assert (output / "table.parquet").read_bytes() == before


@pytest.mark.slow
def test_a_row_that_ends_the_workers_of_a_cluster_is_found(
    cluster: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = sweep_file('[grid]\n"shaft.speed" = [60.0, 60.125, 60.25, 60.375]\n' + NO_TRACES)
    monkeypatch.setattr("loomfmu.sweeps.schedule.run_rows", odd_tasks.deadly_rows)
    found = loomfmu.sweep(path, scheduler=cluster.scheduler_address, output="out").table
    errors = found["error"].to_pylist()
    assert errors == [None, "the processes that ran it have ended", None, None]


def test_a_scheduler_that_does_not_answer_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("loomfmu.sweeps.cluster.ANSWER", 0.5)
    path = sweep_file(SWEPT)
    for address in ("tcp://127.0.0.1:1", "nonsense://there"):
        arguments = ["sweep", str(path), "--output", "out", "--scheduler", address]
        assert main(arguments) == 2
        errors = capsys.readouterr().err
        assert f"loomfmu: {address}: no dask scheduler answers (" in errors.splitlines()[-1]
        assert not Path("out").exists()


def test_a_scheduler_without_workers_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("loomfmu.sweeps.cluster.ANSWER", 0.5)
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=":0", host="127.0.0.1") as empty,
        pytest.raises(LoomfmuError, match="the dask scheduler has no workers"),
    ):
        loomfmu.sweep(sweep_file(SWEPT), scheduler=empty.scheduler_address, output="out")


def test_a_machine_too_busy_for_a_client_is_tried_again_then_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seen under load: dask asserts that its event loop has started within ten seconds."""
    tried: list[str] = []

    def late(address: str, **_: Any) -> None:
        tried.append(address)
        raise AssertionError

    monkeypatch.setattr(distributed, "Client", late)
    with pytest.raises(LoomfmuError, match="tcp://there:1: this machine is too busy to start a dask client"):
        importlib.import_module("loomfmu.sweeps.cluster").Cluster("tcp://there:1")
    assert tried == 3 * ["tcp://there:1"]
