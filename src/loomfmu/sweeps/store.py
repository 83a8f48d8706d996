"""The directory of a sweep: what is finished, each a file that is there whole or not at all.

sweep.json        which sweep it is
batches/          rows_000000_000041.parquet ...; gone when the sweep is done
table.parquet     all rows
traces/           row_000017.h5 ...
map.png
lock              there while a sweep writes; a process that ends, however, lets it go
"""

import contextlib
import json
import os
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
from filelock import FileLock, Timeout

from ..errors import LoomfmuError
from ..files import ANY, cannot_write, check_target, replace_file
from .plan import SweepPlan
from .tables import schema_of, table_of, whole_table
from .worker import Batch

NAME = re.compile(r"rows_(\d+)_(\d+)\.parquet")
PARTIAL, TRACE_PARTIAL = ".*.partial", "row_*.h5*.partial"
LOCK, IDENTITY = "lock", "sweep.json"


class Store:
    """The batches of one sweep. Make it with `opened`."""

    def __init__(self, directory: Path, plan: SweepPlan):
        self.directory = directory
        self.plan = plan
        self.batches = directory / "batches"
        self.traces = directory / "traces"
        self.table_path = directory / "table.parquet"
        self.map_path = directory / "map.png"

    def trace_path(self, row: int) -> Path:
        """Where the full trace of a row is."""
        return self.traces / f"row_{row:06d}.h5"

    def done(self) -> list[range]:
        """Rows that are finished, in order."""
        found = []
        for path in self.batches.glob("*.parquet"):
            match = NAME.fullmatch(path.name)
            if match and path.is_file():
                found.append(range(int(match[1]), int(match[2]) + 1))
        return sorted(found, key=lambda rows: rows.start)

    def left(self) -> list[range]:
        """Rows that are not."""
        if self.table_path.exists():
            return []
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
        self.batches.mkdir(exist_ok=True)
        _write(table_of(self.plan, rows, batch), self._path(rows))

    def finish(self) -> Any:
        """The table of all rows, written unless it was, and returned."""
        finished = self.table_path.exists()
        if finished:
            table = self._read(self.table_path)
        else:
            table = self._joined()
        numbers = pa.chunked_array([range(self.plan.rows)], pa.int64())
        if table.column_names != schema_of(self.plan, ()).names or not table["row"].equals(numbers):
            where = self.table_path if finished else self.batches
            raise LoomfmuError(f"{where}: rows are missing or duplicated; --restart runs all rows again")
        if not finished:
            _write(table, self.table_path)
        return table

    def _joined(self) -> Any:
        try:
            return whole_table(self.plan, [self._read(self._path(rows)) for rows in self.done()])
        except (KeyError, TypeError, ValueError) as error:  # a table, but of something else
            reason = str(error).splitlines()[0]
            raise LoomfmuError(
                f"{self.batches}: not batches of this sweep ({reason}); --restart runs all rows again"
            ) from None

    def tidy(self) -> None:
        """Delete the batches of a sweep that is done: the table has their rows."""
        for path in _files(self.batches, "rows_*.parquet"):
            path.unlink()
        with contextlib.suppress(OSError):  # it holds something that is not ours, or is gone
            self.batches.rmdir()

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
        # its identity last: what a kill leaves over is still known
        for path in [*self.results(), *self.partial(), self.directory / IDENTITY]:
            path.unlink(missing_ok=True)

    def results(self) -> list[Path]:
        """What is there under the names of a sweep's results."""
        patterns = ((self.batches, "rows_*.parquet"), (self.traces, "row_*.h5"), (self.traces, TRACE_PARTIAL))
        found = [path for folder, pattern in patterns for path in _files(folder, pattern)]
        return [path for path in (self.table_path, self.map_path) if path.exists()] + found

    def partial(self) -> list[Path]:
        """What a sweep that was killed was about to write."""
        patterns = ((self.directory, PARTIAL), (self.batches, PARTIAL), (self.traces, TRACE_PARTIAL))
        return [path for folder, pattern in patterns for path in _files(folder, pattern)]


@contextlib.contextmanager
def opened(
    directory: Path, plan: SweepPlan, fingerprint: str, restart: bool, inputs: Iterable[Path] = ()
) -> Iterator[Store]:
    """The store of a sweep, ours alone, with what was finished before. None of `inputs` is written.

    Raises:
        LoomfmuError: another sweep is there, finished or not, or is running there now
    """
    store = Store(directory, plan)
    for target in (store.table_path, store.map_path, directory / LOCK, directory / IDENTITY):
        check_target(target, ANY, inputs)
    for folder in (store.batches, store.traces):
        if folder.is_symlink():  # what lies behind it is not ours to write and to delete
            raise LoomfmuError(f"{folder}: cannot be written (it is a symbolic link)")
    directory.mkdir(parents=True, exist_ok=True)
    with _locked(directory):
        _check_identity(store, fingerprint, restart)
        for path in store.partial():
            path.unlink(missing_ok=True)
        yield store


def _check_identity(store: Store, fingerprint: str, restart: bool) -> None:
    """Refuse to mix two sweeps, and to touch what no sweep wrote; only a sweep's own files are deleted."""
    path = store.directory / IDENTITY
    known = _known(path)
    if known is None and (path.exists() or store.results()):
        foreign = path if path.exists() else store.results()[0]
        raise LoomfmuError(
            f"{store.directory}: contains files that no loomfmu sweep wrote ({foreign.name});"
            " choose another directory with --output"
        )
    if restart:
        store.clear()
    elif known not in (None, fingerprint):
        raise LoomfmuError(
            f"{store.directory}: contains another sweep, or the sweep, its scene, an FMU or loomfmu has"
            " changed since; --restart deletes the old results, --output chooses another directory"
        )
    if restart or known is None:
        content = {"title": store.plan.title, "rows": store.plan.rows, "fingerprint": fingerprint}
        replace_file(path, (json.dumps(content, indent=1) + "\n").encode())


def _known(path: Path) -> str | None:
    """The fingerprint of the sweep that a directory holds; none without one."""
    try:
        return str(json.loads(path.read_text(encoding="utf-8"))["fingerprint"])
    except (FileNotFoundError, ValueError, KeyError, TypeError):
        return None


def _files(folder: Path, pattern: str) -> list[Path]:
    """The files of a folder with such names, and links to files: a folder may be called like a file."""
    return [path for path in folder.glob(pattern) if path.is_file() or path.is_symlink()]


def _write(table: Any, path: Path) -> None:
    """Write a table: whole, or not under that name."""
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, row_group_size=max(1, table.num_rows))
    replace_file(path, sink.getvalue())


@contextlib.contextmanager
def _locked(directory: Path) -> Iterator[None]:
    """Keep other sweeps out of a directory. The system frees the lock with the process that has it."""
    path = directory / LOCK
    descriptors: list[int] = []
    lock = FileLock(path, blocking=False, on_acquired=descriptors.append)
    try:
        lock.acquire()
    except Timeout:
        raise LoomfmuError(f"{directory}: another sweep is running there{_holder(path)}") from None
    try:
        _sign(path, descriptors[0])
        try:
            yield
        finally:
            with contextlib.suppress(PermissionError):  # Windows deletes it when it is let go
                path.unlink(missing_ok=True)
    finally:
        lock.release()


def _sign(path: Path, descriptor: int) -> None:
    """Write into a lock that is ours which process we are."""
    if os.fstat(descriptor).st_nlink > 1:
        raise LoomfmuError(f"{path}: cannot be written (it is a hard link to another file; delete it)")
    written = os.read(descriptor, 20).strip()
    if written and not written.isdigit():
        raise LoomfmuError(f"{path}: not the lock of a sweep; choose another directory with --output")
    try:
        os.ftruncate(descriptor, 0)
        os.lseek(descriptor, 0, os.SEEK_SET)
        # a blank first: other processes cannot read the byte that Windows locks
        os.write(descriptor, f" {os.getpid()}".encode())
    except OSError as error:
        path.unlink(missing_ok=True)
        raise cannot_write(path, error) from None


def _holder(path: Path) -> str:
    """The process that has a lock, as the end of a message; empty if that is unknown."""
    with contextlib.suppress(OSError), path.open("rb", buffering=0) as file:
        file.seek(1)
        if (process := file.read(20)).isdigit():
            return f" (process {process.decode()})"
    return ""
