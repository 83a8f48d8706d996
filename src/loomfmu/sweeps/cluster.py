"""Tasks on a dask cluster: anybody's scheduler, with workers that have loomfmu and see the same files."""

from typing import Any

import distributed

from ..errors import LoomfmuError
from .pools import Task, WorkerDied

ANSWER = 10.0  # s that a scheduler has to answer, and to find a worker


def _client(address: str, attempts: int = 3) -> Any:
    try:
        return distributed.Client(address, timeout=ANSWER, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        reason = " ".join(str(error).split())
        raise LoomfmuError(f"{address}: no dask scheduler answers ({reason})") from None
    except AssertionError:  # dask gives its event loop ten seconds to start, however busy the machine
        if attempts > 1:
            return _client(address, attempts - 1)
        raise LoomfmuError(f"{address}: this machine is too busy to start a dask client") from None


class Cluster:
    """The workers of a dask scheduler. Each process does one task at a time and has one waiting."""

    def __init__(self, address: str):
        self.address = address
        self._client = _client(address)
        try:
            self._client.wait_for_workers(1, timeout=ANSWER)
        except TimeoutError:
            self._client.close()
            raise LoomfmuError(f"{address}: the dask scheduler has no workers") from None
        self._tasks: dict[Any, Any] = {}  # future -> key

    @property
    def workers(self) -> int:
        """Processes that there are now."""
        return max(1, len(self._client.nthreads()))

    def room(self) -> int:
        """Two tasks for each process: one goes over while another is done."""
        return 2 * self.workers - len(self._tasks)

    def submit(self, task: Task) -> None:
        """Send a task."""
        self._tasks[self._client.submit(task.function, *task.arguments, pure=False)] = task.key

    def finished(self) -> list[tuple[Any, Any]]:
        """Keys and outcomes of tasks that are done; `WorkerDied` for one that its workers did not survive."""
        with self._client.as_current():
            done = distributed.wait(list(self._tasks), return_when="FIRST_COMPLETED").done
        return [(self._tasks.pop(future), self._outcome(future)) for future in done]

    def _outcome(self, future: Any) -> Any:
        if future.status == "finished":
            return future.result()
        if future.status != "error":
            raise LoomfmuError(f"{self.address}: lost the dask scheduler ({future.status})")
        error = future.exception()
        killed = isinstance(error, distributed.KilledWorker)
        return WorkerDied("the processes that ran it have ended") if killed else error

    def close(self) -> None:
        """Take back what is under way and leave the cluster as it was."""
        self._client.cancel(list(self._tasks))
        self._client.close()
