"""The directory of a sweep: its finished batches, each a file that is there whole or not at all.

sweep.json        which sweep it is
batches/          rows_000000_000041.parquet ...
table.parquet     all rows
traces/           row_000017.h5 ...
map.png
lock              held while a sweep writes there; a process that ends, however, lets it go
"""

import contextlib
import json
import os
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import pyarrow as pa
import pyarrow.parquet as pq

from ..errors import LoomfmuError
from .plan import Plan
from .tables import table_of, whole_table
from .worker import Batch

NAME = re.compile(r"rows_(\d+)_(\d+)\.parquet")
PARTIAL = ".partial"
FAR = 1 << 30  # where Windows locks a byte: a locked byte cannot be read


class Store:
    """The batches of one sweep. Make it with `opened`."""

    def __init__(self, directory: Path, plan: Plan):
        self.directory = directory
        self.plan = plan
        self.batches = directory / "batches"
        self.table_path = directory / "table.parquet"
        self.map_path = directory / "map.png"

    def trace_path(self, row: int) -> Path:
        """Where the full trace of a row is."""
        return self.directory / "traces" / f"row_{row:06d}.h5"

    def done(self) -> list[range]:
        """Rows that are finished, in order."""
        found = []
        for path in self.batches.glob("*.parquet"):
            match = NAME.fullmatch(path.name)
            if match:
                found.append(range(int(match[1]), int(match[2]) + 1))
        return sorted(found, key=lambda rows: rows.start)

    def left(self) -> list[range]:
        """Rows that are not."""
        gaps, end = [], 0
        for rows in [*self.done(), range(self.plan.rows, self.plan.rows)]:
            if rows.start > end:
                gaps.append(range(end, rows.start))
            end = rows.stop
        return gaps

    def _path(self, rows: range) -> Path:
        return self.batches / f"rows_{rows.start:06d}_{rows.stop - 1:06d}.parquet"

    def write(self, rows: range, batch: Batch) -> None:
        """Keep a finished batch."""
        _write(table_of(self.plan, rows, batch), self._path(rows))

    def finish(self) -> Any:
        """The table of all rows, written and returned."""
        parts = [self._read(self._path(rows)) for rows in self.done()]
        table = whole_table(self.plan, parts)
        if not table["row"].equals(pa.chunked_array([range(self.plan.rows)], pa.int64())):
            raise LoomfmuError(f"{self.batches}: rows are missing or double; --restart runs them all again")
        _write(table, self.table_path)
        return table

    def _read(self, path: Path) -> Any:
        try:
            return pq.read_table(path)
        except (OSError, pa.ArrowInvalid) as error:
            reason = str(error).splitlines()[0]
            raise LoomfmuError(
                f"{path}: cannot be read ({reason}); delete it to run its rows again"
            ) from None

    def clear(self) -> None:
        """Delete what a sweep wrote here, and nothing else."""
        own = [self.table_path, self.map_path]
        patterns = (("batches", "rows_*.parquet"), ("traces", "row_*.h5"), ("traces", "row_*.h5.partial"))
        own += [path for folder, pattern in patterns for path in (self.directory / folder).glob(pattern)]
        # its identity last: what a kill leaves over is still known
        for path in [*own, *self.partial(), self.directory / "sweep.json"]:
            path.unlink(missing_ok=True)

    def partial(self) -> list[Path]:
        """What a sweep that was killed was about to write."""
        folders = (self.directory, self.batches)
        return [path for folder in folders for path in folder.glob(f"*{PARTIAL}")]


@contextlib.contextmanager
def opened(directory: Path, plan: Plan, fingerprint: str, restart: bool) -> Iterator[Store]:
    """The store of a sweep, ours alone, with what was finished before.

    Raises:
        LoomfmuError: another sweep is there, finished or not, or is running there now
    """
    directory.mkdir(parents=True, exist_ok=True)
    store = Store(directory, plan)
    with _locked(directory):
        if restart:
            store.clear()
        _check_identity(store, fingerprint)
        for path in store.partial():
            path.unlink(missing_ok=True)
        store.batches.mkdir(exist_ok=True)
        yield store


def _check_identity(store: Store, fingerprint: str) -> None:
    """Refuse to mix two sweeps."""
    path = store.directory / "sweep.json"
    if path.exists():
        try:
            known = json.loads(path.read_text(encoding="utf-8"))["fingerprint"]
        except (ValueError, KeyError, TypeError):
            known = None
        if known != fingerprint:
            raise LoomfmuError(
                f"{store.directory}: it holds another sweep, or its file, its scene, an FMU or loomfmu has"
                " changed since; --restart throws that away, --output names another place"
            )
    elif store.done() or store.table_path.exists():
        raise LoomfmuError(
            f"{store.directory}: it holds results of no known sweep; --output names another place"
        )
    else:
        content = {"title": store.plan.title, "rows": store.plan.rows, "fingerprint": fingerprint}
        _replace(path, (json.dumps(content, indent=1) + "\n").encode())


def _write(table: Any, path: Path) -> None:
    """Write a table: whole, or not under that name."""
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, row_group_size=max(1, table.num_rows))
    _replace(path, sink.getvalue())


def _replace(path: Path, content: Any) -> None:
    temporary = path.with_name(path.name + PARTIAL)
    with temporary.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    temporary.replace(path)


@contextlib.contextmanager
def _locked(directory: Path) -> Iterator[None]:
    """Keep other sweeps out of a directory. The system frees the lock with the process that has it."""
    with (directory / "lock").open("a+") as file:
        try:
            _lock(file)
        except (BlockingIOError, PermissionError):
            file.seek(0)
            holder = file.read(20).strip()
            who = f" (process {holder})" if holder else ""
            raise LoomfmuError(f"{directory}: another sweep is running there{who}") from None
        file.seek(0)
        file.truncate()
        file.write(str(os.getpid()))
        file.flush()
        yield


if sys.platform == "win32":
    import msvcrt

    def _lock(file: IO[str]) -> None:
        file.seek(FAR)
        msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)

else:
    import fcntl

    def _lock(file: IO[str]) -> None:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
