"""The place in which the rows of a sweep and the runs of a search are computed."""

import os
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from ..cosim.scenes.scene import Scene
from ..errors import LoomfmuError, shown
from .pools import Here, Pool, Processes


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


@contextmanager
def local(scene: Scene, processes: int | None, rows: int) -> Iterator[Pool]:
    """This process where one is enough, unless an FMU may end it; else processes of this machine."""
    workers = min(processes or _cores(), rows)
    pool: Pool = Processes(workers) if workers > 1 or scene.unprotected else Here()
    with closing(pool):
        yield pool


@contextmanager
def cluster(address: str) -> Iterator[Pool]:
    """The workers of a dask scheduler."""
    from .cluster import Cluster

    with closing(Cluster(address)) as pool:
        yield pool


def _cores() -> int:
    """Cores that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
