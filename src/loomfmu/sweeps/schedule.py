"""The schedule of rows, and the place where they run.

Batches are long enough to keep all workers busy and the scheduling process idle.
"""

import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

from ..cosim.scenes.scene import Scene
from ..errors import LoomfmuError, shown
from .pools import Here, Processes, Task, WorkerDied
from .worker import Batch, Job, failed, run_rows

if TYPE_CHECKING:
    from .cluster import Cluster

Pool: TypeAlias = "Here | Processes | Cluster"  # takes tasks, and gives back what became of them
BATCH = 1.5  # s, what a batch should take: far above the cost of handing it over, little to lose
SMALLEST = 50  # part of such a batch that the last ones still are: the workers end within its time
GROWTH = 4  # of a batch over those before, until the time of a row is known well


class Schedule:
    """The rows that are left, cut into batches by the time that rows were seen to take.

    Report each batch that `next` returned: `measured` when it is done, `died` if its process has ended.
    """

    def __init__(self, left: Iterable[range], workers: int):
        self.running = 0  # batches that were given out
        self._left = deque(left)
        self._rows = sum(len(rows) for rows in self._left)
        self._workers = workers
        self._size = 1
        self._suspect: deque[range] = deque()  # parts of batches whose process ended
        self._alone = False  # one of them is running
        self._lone_deaths: set[int] = set()

    def next(self) -> range | None:
        """The next batch, if there is one to be run now.

        Near the end they get smaller, so that all workers end together. A suspect runs when nothing else
        does: a cluster blames all that a process had.
        """
        if self._alone or (self._suspect and self.running):
            return None
        if self._suspect:
            self._alone = True
            rows = self._suspect.popleft()
        elif self._left:
            rows = self._cut()
        else:
            return None
        self.running += 1
        return rows

    def _cut(self) -> range:
        rows = self._left.popleft()
        share = max(self._rows // (2 * self._workers), self._size // SMALLEST)
        size = max(1, min(self._size, share, len(rows)))
        if size < len(rows):
            self._left.appendleft(rows[size:])
        self._rows -= size
        return rows[:size]

    def measured(self, rows: range, seconds: float) -> None:
        """A batch is done; its rows took so long on average [s]."""
        self.running -= 1
        self._alone = False
        fitting = int(BATCH / seconds) if seconds > 0.0 else GROWTH * len(rows)
        self._size = max(1, min(fitting, GROWTH * max(len(rows), self._size)))

    def died(self, rows: range) -> bool:
        """The process that had a batch ended; whether that is the fault of its only row for certain.

        If it is not, it is run again in halves. A single row has a second chance: processes are killed from
        outside too.
        """
        self.running -= 1
        self._alone = False
        if len(rows) == 1 and rows.start in self._lone_deaths:
            return True
        if len(rows) == 1:
            self._lone_deaths.add(rows.start)
        middle = max(1, len(rows) // 2)
        self._suspect.extend(part for part in (rows[:middle], rows[middle:]) if part)
        return False


def run_batches(
    scene: Scene,
    settings: Callable[[range], list[dict[str, Any]]],
    job: Job,
    left: Iterable[range],
    pool: Pool,
    store: Callable[[range, Batch], None],
) -> None:
    """Run all rows that are left, each with its settings, and store each batch as it is done.

    Raises what a worker raised unless a row caused it.
    """
    schedule = Schedule(left, pool.workers)
    done: list[tuple[range, Batch]] = []
    while True:
        while pool.room() > 0 and (rows := schedule.next()) is not None:
            pool.submit(Task(rows, run_rows, (job, settings(rows))))
        for rows, batch in done:  # while the workers are busy again
            store(rows, batch)
        if not schedule.running:
            return
        done = []
        for rows, outcome in pool.finished():
            if isinstance(outcome, Batch):
                schedule.measured(rows, outcome.seconds)
                done.append((rows, outcome))
            elif not isinstance(outcome, WorkerDied):
                raise outcome
            elif schedule.died(rows):
                done.append((rows, Batch([failed(job, scene, _reason(scene, outcome))], (), 0.0)))


def _reason(scene: Scene, died: WorkerDied) -> str:
    """Return why a row whose process has ended could not be run."""
    inside = scene.unprotected
    who = f", with {', '.join(inside)} in it; isolated = true says which call of which FMU" if inside else ""
    return f"{died}{who}"


def check_place(processes: Any, scheduler: Any) -> None:
    """Refuse what is not a number of processes or an address. Raises LoomfmuError."""
    if processes is not None and (
        isinstance(processes, bool) or not isinstance(processes, int) or processes < 1
    ):
        raise LoomfmuError(f"processes = {shown(processes)} must be 1 or more")
    if scheduler is not None and not isinstance(scheduler, str):
        raise LoomfmuError(f'scheduler = {shown(scheduler)} is not an address such as "tcp://host:8786"')


@contextmanager
def resumable(directory: Path, what: str) -> Iterator[None]:
    """Say of Ctrl-C what is kept in a directory, and how to go on. Raises KeyboardInterrupt."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(
            f"interrupted; finished {what} are kept in {directory}; run the same command to continue"
        ) from None


def local(scene: Scene, processes: int | None, rows: int) -> Pool:
    """This process where one is enough, unless an FMU may end it; else processes of this machine."""
    # all cores that this process may use
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    workers = min(processes or cores, rows)
    return Processes(workers) if workers > 1 or scene.unprotected else Here()


def cluster(address: str) -> Pool:
    """The workers of a dask scheduler."""
    from .cluster import Cluster

    return Cluster(address)
