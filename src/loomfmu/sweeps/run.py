"""Running a sweep: batches until all rows are there, then the table, the picture and the traces."""

import hashlib
from contextlib import ExitStack, closing
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..cosim.scenes.scene import files_of
from ..display.printed import as_csv
from ..display.progress import Advance
from ..display.progress import progress as progress_bar
from ..errors import LoomfmuError, described, path_of
from ..extras import installed
from ..files import ANY, check_target, write_file
from ..traces import TRACE
from . import plan as plans
from .plan import SweepPlan
from .pools import Task, WorkerDied
from .schedule import Pool, check_place, cluster, local, resumable, run_batches
from .worker import Batch, Job, job_of, run_trace

if TYPE_CHECKING:
    from .indices import Influences
    from .store import Store


@dataclass(frozen=True)
class Sweep:
    """A finished sweep; true where all claims hold in all rows.

    `table` is a pyarrow.Table as in the file `path`, `ran` the number of rows that were run now and not
    before, `map` the picture if the file has a `[map]`, `traces` the full traces of single rows, `untraced`
    why there is none of some of them; `sensitivity` the indices if the file has a `[sensitivity]`.
    """

    plan: SweepPlan
    table: Any
    path: Path
    ran: int
    map: Path | None
    traces: tuple[Path, ...]
    untraced: dict[int, str]
    sensitivity: "Influences | None" = None

    @property
    def warnings(self) -> tuple[str, ...]:
        """The warnings of the sweep and of its scene; those of single rows are in the table."""
        return self.plan.notes

    @property
    def rows(self) -> int:
        """Number of combinations."""
        return int(self.table.num_rows)

    @property
    def holding(self) -> int:
        """Number of rows in which all claims hold."""
        return self._count(True)

    @property
    def failing(self) -> int:
        """Number of rows in which a claim fails."""
        return self._count(False) - self.undecided

    @property
    def undecided(self) -> int:
        """Number of rows in which no claim fails, but one is within its numerical error of its bound."""
        from .ranking import undecided

        return undecided(self.table)

    @property
    def errors(self) -> int:
        """Number of rows that could not be run."""
        return self.rows - self.holding - self.failing - self.undecided

    @property
    def holds(self) -> bool:
        """Return whether all rows could be run and all claims hold."""
        return self.holding == self.rows

    def __bool__(self) -> bool:
        return self.holds

    def to_pandas(self) -> Any:
        """The table as a pandas `DataFrame`, in SI, with claims by their names, such as `NAME.distance`."""
        from .exported import to_pandas

        return to_pandas(self.table)

    def to_xarray(self) -> Any:
        """The table as an xarray `Dataset`, in SI with units, along the axes of the grid.

        With a sample it is along its rows. Raises LoomfmuError without `loomfmu[xarray]`.
        """
        from .exported import to_xarray

        return to_xarray(self.table, self.plan.axes)

    def _count(self, holds: bool) -> int:
        return int(self.table["holds"].to_pylist().count(holds))


def sweep(
    path: str | Path,
    *,
    processes: int | None = None,
    output: str | Path | None = None,
    scheduler: str | None = None,
    restart: bool = False,
    overwrite: bool = False,
    progress: bool = False,
) -> Sweep:
    """Run a sweep, or what is left of it, and make its table, picture and traces.

    Args:
        path: the sweep file
        processes: worker processes on this machine, all cores by default; 1 runs in this process
        output: directory of the results; `results/<sweep>` below the current directory by default. A file
            .csv gets the table, in the units that people read, beside the usual directory
        scheduler: address of a dask scheduler, such as "tcp://host:8786", whose workers run the rows
        restart: discard earlier results in the directory, of this or another sweep
        overwrite: replace a file .csv that is not the table of a sweep
        progress: show a progress bar, if standard error is a terminal

    Raises:
        LoomfmuError: bad input, or a directory that holds another sweep; one line that names what and where
        KeyboardInterrupt: Ctrl-C; the batches that are finished stay, and the same call goes on from there
    """
    check_place(processes, scheduler)
    path = path_of(path, "sweep")
    plan = plans.load(path)
    from . import exported
    from .store import opened

    job = job_of(plan, plan.values)
    inputs, wanted = [Path(path), *files_of(plan.scene)], path_of(output, "output") if output else None
    written = wanted if wanted and wanted.suffix == ".csv" else None
    if wanted and wanted.suffix in exported.OTHERS:
        raise LoomfmuError(f"output {wanted} is neither a directory nor a file .csv; name one of these")
    if written:
        check_target(written, exported.TABLE, inputs, overwrite)  # before the runs
    directory = wanted if wanted and not written else Path("results") / plan.name
    with resumable(directory, "rows"):
        fingerprint = _fingerprint(plan, job)
        with opened(directory, plan, fingerprint, restart, inputs) as store, ExitStack() as pools:
            here = pools.enter_context(closing(local(plan.scene, processes, plan.rows)))
            rows_pool = pools.enter_context(closing(cluster(scheduler))) if scheduler else here
            ran = _run_rows(store, job, rows_pool, progress)
            table = store.finish()
            picture = _draw(store, table)
            found = _indices(store, table)
            traces, untraced = _run_traces(store, job, table, here, progress)
            store.tidy()
    if written:
        write_file(written, exported.csv(table).encode(), exported.TABLE, inputs, overwrite)
    return Sweep(plan, table, store.table_path, ran, picture, traces, untraced, found)


def _fingerprint(plan: SweepPlan, job: Job) -> str:
    """Return the digest of a sweep: its text, its points, and all that its results depend on."""
    digest = hashlib.sha256(f"{plan.text}\0{job.identity}".encode())
    for axis in plan.axes:  # a sample may be another with another scipy
        digest.update(repr(axis.values.tolist()).encode())
    return digest.hexdigest()


def _run_rows(store: "Store", job: Job, pool: Pool, progress: bool) -> int:
    """Run what is not finished yet; how many rows that was."""
    left = store.left()
    count = sum(len(rows) for rows in left)
    title, total = store.plan.title, store.plan.rows
    with progress_bar(title, total, total - count, wanted=progress) as advance:

        def keep(rows: range, batch: Batch) -> None:
            store.write(rows, batch)
            advance(len(rows))

        run_batches(store.plan.scene, store.plan.settings, job, left, pool, keep)
    return count


def _draw(store: "Store", table: Any) -> Path | None:
    """The picture of the sweep, if it has a `[map]`."""
    if store.plan.map is None:
        return None
    from .maps import draw

    return draw(store.plan, table, store.map_path)


def _indices(store: "Store", table: Any) -> "Influences | None":
    """The indices of the sweep, if it has a `[sensitivity]`, as table and picture."""
    plan = store.plan
    if plan.sensitivity is None:
        return None
    from .indices import csv_rows, draw, influences

    found = influences(plan.sensitivity, table, plan.sample, plan.title)
    write_file(store.indices_path, as_csv(csv_rows(found)).encode(), ANY)
    if installed("plot"):
        from ..report import pictures

        pictures.save(draw(found), store.bars_path, plan.title, overwrite=True)
    return found


def _run_traces(
    store: "Store", job: Job, table: Any, pool: Pool, progress: bool
) -> tuple[tuple[Path, ...], dict[int, str]]:
    """Full traces of the worst rows and of some others, on this machine; why there is none of some."""
    from .ranking import traced_rows

    limits = store.plan.traces
    paths = {row: store.trace_path(row) for row in traced_rows(table, limits.failures, limits.sample)}
    left = [row for row, path in paths.items() if not TRACE.ours(path)]
    settings = {row: store.plan.settings(range(row, row + 1))[0] for row in left}
    tasks = [Task(row, run_trace, (job, settings[row], paths[row])) for row in left]
    with progress_bar("traces", len(left), wanted=progress) as advance:
        failed = _do(tasks, pool, advance)
    return tuple(path for row, path in paths.items() if row not in failed), failed


def _do(tasks: list[Task], pool: Pool, advance: Advance) -> dict[Any, str]:
    """Do tasks that give nothing back; why some failed, by their keys."""
    failed: dict[Any, str] = {}
    under_way = 0
    while tasks or under_way:
        while tasks and pool.room() > 0:
            pool.submit(tasks.pop(0))
            under_way += 1
        for row, outcome in pool.finished():
            under_way -= 1
            if isinstance(outcome, Exception):
                failed[row] = (
                    str(outcome) if isinstance(outcome, LoomfmuError | WorkerDied) else described(outcome)
                )
            advance(1)
    return dict(sorted(failed.items()))
