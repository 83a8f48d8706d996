"""The directory of a sweep: what is finished, each a file that is there whole or not at all.

sweep.json        which sweep it is
batches/          rows_000000_000041.parquet ...; gone when the sweep is done
table.parquet     all rows
traces/           row_000017.h5 ...
map.png
sensitivity.csv   and sensitivity.png: indices
lock              there while a sweep writes; a process that ends, however, lets it go
"""

import contextlib
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from ..errors import LoomfmuError
from ..files import replace_file
from .directory import PARTIAL, Contents, files, owned
from .plan import SweepPlan
from .tables import schema_of, table_of, whole_table
from .worker import Batch

NAME = re.compile(r"rows_(\d+)_(\d+)\.parquet")
INDICES_FILE = "sensitivity.csv"
BATCH, TRACE_PARTIAL = r"rows_.*\.parquet", r"row_.*\.h5.*\.partial"


class Store(Contents):
    """The batches of one sweep. Make it with `opened`."""

    def __init__(self, directory: Path, plan: SweepPlan):
        self.plan = plan
        self.batches, self.traces = directory / "batches", directory / "traces"
        self.table_path, self.map_path = directory / "table.parquet", directory / "map.png"
        self.indices_path, self.bars_path = directory / INDICES_FILE, directory / "sensitivity.png"
        super().__init__(
            directory,
            targets=(self.table_path, self.map_path, self.indices_path, self.bars_path),
            numbered=((self.batches, BATCH), (self.traces, r"row_.*\.h5"), (self.traces, TRACE_PARTIAL)),
            unfinished=((directory, PARTIAL), (self.batches, PARTIAL), (self.traces, TRACE_PARTIAL)),
        )

    def trace_path(self, row: int) -> Path:
        """Return the path of the full trace of a row."""
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
        for path in files([(self.batches, BATCH)]):
            path.unlink()
        with contextlib.suppress(OSError):  # it holds something that is not ours, or is gone
            self.batches.rmdir()

    def _read(self, path: Path) -> Any:
        try:
            return pq.read_table(path, page_checksum_verification=True)
        except (OSError, pa.ArrowInvalid) as error:
            reason = str(error).splitlines()[0]
            raise LoomfmuError(
                f"{path}: cannot be read ({reason}); delete it to run its rows again"
            ) from None


@contextlib.contextmanager
def opened(
    directory: Path, plan: SweepPlan, fingerprint: str, restart: bool, inputs: Iterable[Path] = ()
) -> Iterator[Store]:
    """The store of a sweep, ours alone, with what was finished before. None of `inputs` is written.

    Raises:
        LoomfmuError: another sweep is there, finished or not, or is running there now
    """
    store = Store(directory, plan)
    with owned(store, "sweep", plan.title, fingerprint, restart, inputs):
        yield store


def _write(table: Any, path: Path) -> None:
    """Write a table: whole, or not under that name."""
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, row_group_size=max(1, table.num_rows), write_page_checksum=True)
    replace_file(path, sink.getvalue())
