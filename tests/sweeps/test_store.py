"""The directory of a sweep: whole batches, no other sweep's, one writer."""

import errno
import json
import os
import subprocess
import sys
from collections.abc import Callable
from contextlib import AbstractContextManager
from itertools import pairwise
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sweep_files import sweep_file

from loomfmu import LoomfmuError
from loomfmu.sweeps import plan as plans
from loomfmu.sweeps.plan import SweepPlan
from loomfmu.sweeps.store import Store, opened
from loomfmu.sweeps.tables import table_of, whole_table
from loomfmu.sweeps.worker import Batch, ClaimResult, Label

LABELS = (
    Label("first", "belt.lowest_margin", "1", "1"),
    Label("second", "belt.lowest_speed_limit", "rad/s", "rev/min"),
)
ROWS = 24
RESULTS = Path("results")


@pytest.fixture
def plan() -> SweepPlan:
    return plans.load(sweep_file(f'[grid]\n"shaft.speed" = {{ from = 40.0, to = 63.0, count = {ROWS} }}\n'))


def batch(rows: range) -> Batch:
    """Made-up results; every fifth row could not be run."""
    results: list[list[Any]] = []
    for row in rows:
        if row % 5 == 4:
            results.append([*[None] * 18, f"row {row}"])
            continue
        holds = row < 20
        first = ClaimResult(True, 0.1 * row, 0.0, 0.1 * row, None, True, 1e-9)
        second = ClaimResult(holds, 70.0 + row, 60.0, 10.0 + row, None, True, None)
        results.append([70.0 + row, *first, *second, holds, None if holds else "second", None, None])
    return Batch(results, LABELS if any(row % 5 != 4 for row in rows) else (), 0.01)


def here(plan: SweepPlan, fingerprint: str = "one", restart: bool = False) -> AbstractContextManager[Store]:
    return opened(RESULTS, plan, fingerprint, restart)


def refused(plan: SweepPlan, said: str, fingerprint: str = "one", restart: bool = False) -> None:
    """The directory is not opened."""
    with pytest.raises(LoomfmuError, match=said), here(plan, fingerprint, restart):
        pytest.fail("it was opened")


def parts(cuts: set[int]) -> list[range]:
    ends = [0, *sorted(cuts), ROWS]
    return [range(start, stop) for start, stop in pairwise(ends)]


@given(cuts=st.sets(st.integers(1, ROWS - 1)), order=st.randoms(use_true_random=False))
@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_the_table_is_the_same_whatever_the_batches_were(
    plan: SweepPlan, cuts: set[int], order: object
) -> None:
    whole = whole_table(plan, [table_of(plan, range(ROWS), batch(range(ROWS)))])
    pieces = [table_of(plan, rows, batch(rows)) for rows in parts(cuts)]
    order.shuffle(pieces)  # type: ignore[attr-defined]
    found = whole_table(plan, pieces)
    assert found.equals(whole, check_metadata=True)
    sinks = [pa.BufferOutputStream(), pa.BufferOutputStream()]
    for table, sink in zip((found, whole), sinks, strict=True):
        pq.write_table(table, sink)
    assert sinks[0].getvalue() == sinks[1].getvalue()


@given(cuts=st.sets(st.integers(1, ROWS - 1)), kept=st.sets(st.integers(0, ROWS)))
@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_what_is_left_is_what_is_not_done(plan: SweepPlan, cuts: set[int], kept: set[int]) -> None:
    store = Store(plan.path.parent / "there", plan)
    store.batches.mkdir(parents=True, exist_ok=True)
    for path in store.batches.iterdir():
        path.unlink()
    done = [rows for number, rows in enumerate(parts(cuts)) if number in kept]
    for rows in done:
        store._path(rows).touch()
    assert store.done() == done
    rows_done, rows_left = ([row for rows in found for row in rows] for found in (done, store.left()))
    assert sorted(rows_done + rows_left) == list(range(ROWS))


def test_a_finished_batch_is_read_again_and_one_half_written_is_not(plan: SweepPlan) -> None:
    with here(plan) as store:
        store.write(range(0, 10), batch(range(0, 10)))
        assert os.listdir(store.batches) == ["rows_000000_000009.parquet"]
    partial = RESULTS / "batches" / ".rows_000010_000019.parquet.01234567.partial"
    partial.write_bytes(b"PAR1 and then the process was killed")
    with here(plan) as store:
        assert store.left() == [range(10, 24)]
        store.write(range(10, 24), batch(range(10, 24)))
        table = store.finish()
        store.tidy()
        assert sorted(os.listdir(RESULTS)) == ["lock", "sweep.json", "table.parquet"]
    assert sorted(os.listdir(RESULTS)) == ["sweep.json", "table.parquet"]
    assert table["row"].to_pylist() == list(range(ROWS))
    assert pq.read_table(RESULTS / "table.parquet").equals(table, check_metadata=True)
    assert json.loads((RESULTS / "sweep.json").read_text()) == {"title": "Swept", "fingerprint": "one"}


def half_nonsense(store: Store) -> None:
    store.write(range(0, 12), batch(range(0, 12)))
    store._path(range(12, 24)).write_bytes(b"nonsense")


def rows_twice(store: Store) -> None:
    for rows in (range(0, 12), range(10, 24)):
        store.write(rows, batch(rows))


def another_table(store: Store) -> None:
    store.batches.mkdir()
    pq.write_table(pa.table({"row": [1]}), store._path(range(ROWS)))


def turned_bit(store: Store) -> None:
    store.write(range(ROWS), batch(range(ROWS)))
    store.finish()
    content = bytearray(store.table_path.read_bytes())
    content[4 + 60] ^= 1  # behind the first page's header: in its values
    store.table_path.write_bytes(content)


@pytest.mark.parametrize(
    ("damage", "said"),
    [
        (half_nonsense, r"rows_000012_000023\.parquet: cannot be read .*; delete it"),
        (rows_twice, "rows are missing or duplicated"),
        (another_table, r"batches: not batches of this sweep \("),
        (turned_bit, r"table\.parquet: cannot be read \(.*CRC"),
    ],
)
def test_damage_is_noticed_and_named(plan: SweepPlan, damage: Callable[[Store], None], said: str) -> None:
    with here(plan) as store:
        damage(store)
        with pytest.raises(LoomfmuError, match=said):
            store.finish()


def test_another_sweep_is_refused_until_it_is_thrown_away(plan: SweepPlan) -> None:
    with here(plan) as store:
        store.write(range(0, 24), batch(range(0, 24)))
        store.finish()
    (RESULTS / "notes.txt").write_text("mine")
    before = sorted(RESULTS.rglob("*"))
    refused(plan, "contains another sweep, or the sweep, .* --restart deletes the old results", "other")
    assert sorted(RESULTS.rglob("*")) == before
    with here(plan, "other", restart=True) as store:
        assert store.left() == [range(ROWS)]
    assert sorted(os.listdir(RESULTS)) == ["batches", "notes.txt", "sweep.json"]


@pytest.mark.parametrize("restart", [False, True])
@pytest.mark.parametrize(
    "name",
    ["table.parquet", "map.png", "sweep.json", "batches/rows_000000_000009.parquet", "traces/row_1.h5"],
)
def test_what_no_sweep_wrote_is_left_alone(plan: SweepPlan, name: str, restart: bool) -> None:
    mine = RESULTS / name
    mine.parent.mkdir(parents=True)
    mine.write_bytes(b"mine")
    said = rf"results: contains files that no loomfmu sweep wrote \({mine.name}\); choose another"
    refused(plan, said, restart=restart)
    assert [path for path in RESULTS.rglob("*") if path.is_file()] == [mine]
    assert mine.read_bytes() == b"mine"


def test_a_full_disk_is_told_with_the_files_name_and_leaves_no_lock(
    plan: SweepPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr("loomfmu.sweeps.directory.os.write", full)
        refused(plan, r"lock: cannot be written \(No space left on device\)")
    assert not RESULTS.exists()


HOLDER = """
import sys, time
from pathlib import Path
from loomfmu.sweeps.directory import _locked
with _locked(Path(sys.argv[1]), "sweep"):
    print("held", flush=True)
    time.sleep(600)
"""


def test_a_second_sweep_is_kept_out_and_a_killed_one_is_not_in_the_way(plan: SweepPlan) -> None:
    RESULTS.mkdir()
    command = [sys.executable, "-c", HOLDER, str(RESULTS)]
    holder = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert holder.stdout is not None and holder.stdout.readline() == "held\n"
    refused(plan, rf"another sweep is running there \(process {holder.pid}\)", restart=True)
    holder.kill()
    holder.wait()
    holder.stdout.close()
    with here(plan) as store:
        assert store.left() == [range(ROWS)]


RIVAL = """
import sys, time
from pathlib import Path
from loomfmu import LoomfmuError
from loomfmu.sweeps.directory import _locked
place, got, until = Path(sys.argv[1]), 0, time.monotonic() + 2.0
while time.monotonic() < until:
    try:
        with _locked(place, "sweep"):
            (place / "mine").mkdir()  # fails where two have the lock
            (place / "mine").rmdir()
            got += 1
    except LoomfmuError:
        pass
print(got)
"""


def test_a_lock_that_is_deleted_by_its_holder_is_held_by_one_at_a_time(tmp_path: Path) -> None:
    command = [sys.executable, "-c", RIVAL, str(tmp_path)]
    rivals = [
        subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(3)
    ]
    for rival in rivals:
        printed, errors = rival.communicate(timeout=60)
        assert errors == "" and int(printed) > 0
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize("name", ["lock", "table.parquet", "sweep.json", "map.png", "batches", "traces"])
def test_nothing_is_written_through_a_link(plan: SweepPlan, name: str) -> None:
    victim = Path("victim").absolute()
    RESULTS.mkdir()
    if name in ("batches", "traces"):
        victim.mkdir()
    else:
        victim.write_text("precious")
    (RESULTS / name).symlink_to(victim)
    refused(plan, rf"{name}: cannot be written \(it is a symbolic link")
    assert not list(victim.iterdir()) if victim.is_dir() else victim.read_text() == "precious"


def test_parts_are_not_written_through_links(plan: SweepPlan) -> None:
    victim = Path("victim").absolute()
    victim.write_text("precious")
    with here(plan) as store:
        store.batches.mkdir()
        for name in ("rows_000000_000023.parquet", "rows_000000_000023.parquet.partial"):
            (store.batches / name).symlink_to(victim)
        (store.directory / "table.parquet.partial").symlink_to(victim)
        store.write(range(0, 24), batch(range(0, 24)))
        store.finish()
    assert victim.read_text() == "precious"


def test_a_hard_link_is_no_lock(plan: SweepPlan) -> None:
    victim = Path("victim")
    victim.write_text("123")
    RESULTS.mkdir()
    (RESULTS / "lock").hardlink_to(victim)
    refused(plan, r"lock: cannot be written \(it is a hard link to another file; delete it\)")
    assert victim.read_text() == "123"


def test_a_folder_with_the_name_of_a_batch_is_no_batch(plan: SweepPlan) -> None:
    with here(plan) as store:
        folder = store.batches / "rows_000000_000011.parquet"
        folder.mkdir(parents=True)
        assert store.left() == [range(ROWS)]
        with pytest.raises(LoomfmuError, match=r"rows_000000_000011\.parquet: cannot be written \(Is a dir"):
            store.write(range(0, 12), batch(range(0, 12)))
        store.write(range(0, 24), batch(range(0, 24)))
        store.finish()
        store.tidy()
    assert folder.is_dir()
    with here(plan, restart=True) as store:
        assert store.left() == [range(ROWS)]
