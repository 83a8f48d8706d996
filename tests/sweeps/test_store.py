"""The directory of a sweep: whole batches, no other sweep's, one writer."""

import errno
import json
import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sweep_files import written

from loomfmu import LoomfmuError
from loomfmu.sweeps import plan as plans
from loomfmu.sweeps.plan import SweepPlan
from loomfmu.sweeps.store import Store, opened
from loomfmu.sweeps.tables import table_of, whole_table
from loomfmu.sweeps.worker import Batch, Label

LABELS = (
    Label("first", "belt.lowest_margin", "1", "1"),
    Label("second", "belt.lowest_speed_limit", "rad/s", "rev/min"),
)
ROWS = 24


@pytest.fixture
def plan(tmp_path: Path) -> SweepPlan:
    return plans.load(
        written(tmp_path, f'[grid]\n"shaft.speed" = {{ from = 40.0, to = 63.0, count = {ROWS} }}\n')
    )


def batch(rows: range) -> Batch:
    """Made-up results; every fifth row could not be run."""
    results = [
        [None] * 18 + [f"row {row}"]
        if row % 5 == 4
        else [
            70.0 + row,
            True,
            0.1 * row,
            0.0,
            0.1 * row,
            None,
            True,
            1e-9,
            row < 20,
            70.0 + row,
            60.0,
            10.0 + row,
            None,
            True,
            None,
            row < 20,
            None if row < 20 else "second",
            None,
            None,
        ]
        for row in rows
    ]
    return Batch(results, LABELS if any(row % 5 != 4 for row in rows) else (), 0.01)


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


def test_a_finished_batch_is_read_again_and_one_half_written_is_not(plan: SweepPlan, tmp_path: Path) -> None:
    place = tmp_path / "results"
    with opened(place, plan, "one", restart=False) as store:
        store.write(range(0, 10), batch(range(0, 10)))
        assert os.listdir(store.batches) == ["rows_000000_000009.parquet"]
    (place / "batches" / ".rows_000010_000019.parquet.01234567.partial").write_bytes(
        b"PAR1 and then the process was killed"
    )
    with opened(place, plan, "one", restart=False) as store:
        assert store.left() == [range(10, 24)]
        store.write(range(10, 24), batch(range(10, 24)))
        table = store.finish()
        store.tidy()
        assert sorted(os.listdir(place)) == ["lock", "sweep.json", "table.parquet"]
    assert sorted(os.listdir(place)) == ["sweep.json", "table.parquet"]
    assert not list(place.rglob("*.partial"))
    assert table["row"].to_pylist() == list(range(ROWS))
    assert pq.read_table(place / "table.parquet").equals(table, check_metadata=True)
    assert json.loads((place / "sweep.json").read_text()) == {"title": "Swept", "fingerprint": "one"}


def test_a_batch_that_cannot_be_read_is_named(plan: SweepPlan, tmp_path: Path) -> None:
    with opened(tmp_path / "results", plan, "one", restart=False) as store:
        store.write(range(0, 12), batch(range(0, 12)))
        store._path(range(12, 24)).write_bytes(b"nonsense")
        with pytest.raises(LoomfmuError, match=r"rows_000012_000023\.parquet: cannot be read .*; delete it"):
            store.finish()


def test_a_bit_of_the_table_that_turned_is_noticed(plan: SweepPlan, tmp_path: Path) -> None:
    with opened(tmp_path / "results", plan, "one", restart=False) as store:
        store.write(range(ROWS), batch(range(ROWS)))
        store.finish()
        content = bytearray(store.table_path.read_bytes())
        content[4 + 60] ^= 1  # behind the first page's header: in its values
        store.table_path.write_bytes(content)
        with pytest.raises(LoomfmuError, match=r"table\.parquet: cannot be read \(.*CRC"):
            store.finish()


def test_rows_that_are_there_twice_are_refused(plan: SweepPlan, tmp_path: Path) -> None:
    with opened(tmp_path / "results", plan, "one", restart=False) as store:
        for rows in (range(0, 12), range(10, 24)):
            store.write(rows, batch(rows))
        with pytest.raises(LoomfmuError, match="rows are missing or duplicated"):
            store.finish()


def test_another_sweep_is_refused_until_it_is_thrown_away(plan: SweepPlan, tmp_path: Path) -> None:
    place = tmp_path / "results"
    with opened(place, plan, "one", restart=False) as store:
        store.write(range(0, 24), batch(range(0, 24)))
        store.finish()
    (place / "notes.txt").write_text("mine")
    before = sorted(path.relative_to(place) for path in place.rglob("*"))
    with (
        pytest.raises(
            LoomfmuError, match=r"contains another sweep, or the sweep, .* --restart deletes the old results"
        ),
        opened(place, plan, "other", restart=False),
    ):
        pytest.fail("it was opened")
    assert sorted(path.relative_to(place) for path in place.rglob("*")) == before
    with opened(place, plan, "other", restart=True) as store:
        assert store.left() == [range(ROWS)]
    assert sorted(os.listdir(place)) == ["batches", "notes.txt", "sweep.json"]


@pytest.mark.parametrize("restart", [False, True])
@pytest.mark.parametrize(
    "name",
    ["table.parquet", "map.png", "sweep.json", "batches/rows_000000_000009.parquet", "traces/row_1.h5"],
)
def test_what_no_sweep_wrote_is_left_alone(plan: SweepPlan, tmp_path: Path, name: str, restart: bool) -> None:
    place = tmp_path / "results"
    (place / name).parent.mkdir(parents=True)
    (place / name).write_bytes(b"mine")
    said = rf"results: contains files that no loomfmu sweep wrote \({Path(name).name}\); choose another"
    with pytest.raises(LoomfmuError, match=said), opened(place, plan, "one", restart=restart):
        pytest.fail("it was opened")
    assert [path for path in place.rglob("*") if path.is_file()] == [place / name]
    assert (place / name).read_bytes() == b"mine"


def test_a_full_disk_is_told_with_the_files_name_and_leaves_no_lock(
    plan: SweepPlan, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "results"

    def full(*_: object) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr("loomfmu.sweeps.directory.os.write", full)
        with (
            pytest.raises(LoomfmuError, match=r"lock: cannot be written \(No space left on device\)"),
            opened(place, plan, "one", restart=False),
        ):
            pytest.fail("it was opened")
    assert os.listdir(place) == []


HOLDER = """
import sys, time
from pathlib import Path
from loomfmu.sweeps.directory import _locked
with _locked(Path(sys.argv[1]), "sweep"):
    print("held", flush=True)
    time.sleep(600)
"""


def test_a_second_sweep_is_kept_out_and_a_killed_one_is_not_in_the_way(
    plan: SweepPlan, tmp_path: Path
) -> None:
    place = tmp_path / "results"
    place.mkdir()
    command = [sys.executable, "-c", HOLDER, str(place)]
    holder = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    assert holder.stdout is not None and holder.stdout.readline() == "held\n"
    with (
        pytest.raises(LoomfmuError, match=rf"another sweep is running there \(process {holder.pid}\)"),
        opened(place, plan, "one", restart=True),
    ):
        pytest.fail("it was opened")
    holder.kill()
    holder.wait()
    holder.stdout.close()
    with opened(place, plan, "one", restart=False) as store:
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
def test_nothing_is_written_through_a_link(plan: SweepPlan, tmp_path: Path, name: str) -> None:
    place, victim = tmp_path / "results", tmp_path / "victim"
    place.mkdir()
    if name in ("batches", "traces"):
        victim.mkdir()
    else:
        victim.write_text("precious")
    (place / name).symlink_to(victim)
    with (
        pytest.raises(LoomfmuError, match=rf"{name}: cannot be written \(it is a symbolic link"),
        opened(place, plan, "one", restart=False),
    ):
        pytest.fail("it was opened")
    assert not list(victim.iterdir()) if victim.is_dir() else victim.read_text() == "precious"


def test_parts_are_not_written_through_links(plan: SweepPlan, tmp_path: Path) -> None:
    victim = tmp_path / "victim"
    victim.write_text("precious")
    with opened(tmp_path / "results", plan, "one", restart=False) as store:
        store.batches.mkdir()
        for name in ("rows_000000_000023.parquet", "rows_000000_000023.parquet.partial"):
            (store.batches / name).symlink_to(victim)
        (store.directory / "table.parquet.partial").symlink_to(victim)
        store.write(range(0, 24), batch(range(0, 24)))
        store.finish()
    assert victim.read_text() == "precious"


def test_a_folder_with_the_name_of_a_batch_is_no_batch(plan: SweepPlan, tmp_path: Path) -> None:
    place = tmp_path / "results"
    with opened(place, plan, "one", restart=False) as store:
        folder = store.batches / "rows_000000_000011.parquet"
        folder.mkdir(parents=True)
        assert store.left() == [range(ROWS)]
        with pytest.raises(LoomfmuError, match=r"rows_000000_000011\.parquet: cannot be written \(Is a dir"):
            store.write(range(0, 12), batch(range(0, 12)))
        store.write(range(0, 24), batch(range(0, 24)))
        store.finish()
        store.tidy()
    assert folder.is_dir()
    with opened(place, plan, "one", restart=True) as store:
        assert store.left() == [range(ROWS)]


def test_a_batch_of_something_else_is_told_in_one_line(plan: SweepPlan, tmp_path: Path) -> None:
    with opened(tmp_path / "results", plan, "one", restart=False) as store:
        store.batches.mkdir()
        pq.write_table(pa.table({"row": [1]}), store._path(range(ROWS)))
        with pytest.raises(LoomfmuError, match=r"batches: not batches of this sweep \("):
            store.finish()


def test_a_hard_link_is_no_lock(plan: SweepPlan, tmp_path: Path) -> None:
    victim = tmp_path / "victim"
    victim.write_text("123")
    (tmp_path / "results").mkdir()
    (tmp_path / "results" / "lock").hardlink_to(victim)
    said = r"lock: cannot be written \(it is a hard link to another file; delete it\)"
    with pytest.raises(LoomfmuError, match=said), opened(tmp_path / "results", plan, "one", restart=False):
        pytest.fail("it was opened")
    assert victim.read_text() == "123"
