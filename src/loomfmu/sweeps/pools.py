"""Pools that run tasks: in this process, or in worker processes of this machine.

Workers are spawned, never forked: a live FMU holds the state of the Python that it lives in. A worker has
one task at a time and nothing else to wait for, so the end of its process says which task was its last.
"""

import contextlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.resource_tracker import ensure_running
from typing import Any

from ..errors import LoomfmuError, signal_name

PATIENCE = 5.0  # s until a worker that does not stop is killed


@dataclass(frozen=True)
class Task:
    """A function with arguments, and a key to know it by."""

    key: Any
    function: Callable[..., Any]
    arguments: tuple[Any, ...]


class WorkerDied(Exception):
    """The process that had a task has ended."""


class Here:
    """This process: a task is done when it is submitted.

    As the other pools, it takes tasks and gives back what became of each: a value, or the exception raised.
    """

    workers = 1  # tasks that run at a time

    def __init__(self) -> None:
        self._done: list[tuple[Any, Any]] = []

    def room(self) -> int:
        """One, if the last task was taken back."""
        return 1 - len(self._done)

    def submit(self, task: Task) -> None:
        """Do the task."""
        self._done.append((task.key, _outcome(task)))

    def finished(self) -> list[tuple[Any, Any]]:
        """The task that was done."""
        done, self._done = self._done, []
        return done

    def close(self) -> None:
        """Nothing is open."""


def _outcome(task: Task) -> Any:
    try:
        return task.function(*task.arguments)
    except Exception as error:
        return error


class _Worker:
    """A process and the connection to it. It says once that it is ready, then answers each task."""

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.connection, far_end = context.Pipe()
        self.process = context.Process(target=_serve, args=(far_end,), daemon=True)
        with _undisturbed():
            self.process.start()
        far_end.close()
        self.ready = False
        self.task: Task | None = None

    def end(self) -> None:
        self.connection.close()
        self.process.terminate()
        self.process.join(PATIENCE)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()


class Processes:
    """Worker processes of this machine, started as they are needed."""

    def __init__(self, workers: int):
        self.workers = workers
        self._workers: list[_Worker] = []

    def room(self) -> int:
        """Workers without a task, there or to be started."""
        return self.workers - sum(worker.task is not None for worker in self._workers)

    def submit(self, task: Task) -> None:
        """Hand a task to a worker that has none."""
        idle = next((worker for worker in self._workers if worker.task is None), None)
        if idle is None:
            idle = _Worker()
            self._workers.append(idle)
        idle.task = task
        if idle.ready:
            self._send(idle)

    def _send(self, worker: _Worker) -> None:
        with contextlib.suppress(BrokenPipeError, ConnectionResetError):  # `finished` sees that it has ended
            worker.connection.send(worker.task)

    def finished(self) -> list[tuple[Any, Any]]:
        """Keys and outcomes of tasks that are done; `WorkerDied` for one whose worker has ended."""
        done: list[tuple[Any, Any]] = []
        while not done:
            waiting = {worker.connection: worker for worker in self._workers if worker.task is not None}
            for connection in wait(list(waiting)):
                done += self._receive(waiting[connection])  # type: ignore[index]
        return done

    def _receive(self, worker: _Worker) -> list[tuple[Any, Any]]:
        assert worker.task is not None
        try:
            outcome = worker.connection.recv()
        except (EOFError, ConnectionResetError):
            return [self._remove(worker)]
        if not worker.ready:
            worker.ready = True
            self._send(worker)
            return []
        key, worker.task = worker.task.key, None
        return [(key, outcome)]

    def _remove(self, worker: _Worker) -> tuple[Any, Any]:
        """Remove a worker that has ended; its task and how it ended."""
        worker.process.join(PATIENCE)
        code = worker.process.exitcode or 0
        self._workers.remove(worker)
        worker.end()
        if not worker.ready:
            raise LoomfmuError(
                "worker processes do not start; in a script, call sweep() under"
                ' if __name__ == "__main__": or set processes=1'
            )
        assert worker.task is not None
        how = signal_name(-code) if code < 0 else f"status {code}"
        return worker.task.key, WorkerDied(f"the process that ran it ended with {how}")

    def close(self) -> None:
        """End all workers."""
        while self._workers:
            self._workers.pop().end()


@contextlib.contextmanager
def _undisturbed() -> Iterator[None]:
    """A process that is started here hears no Ctrl-C from its first moment: its end is ours to decide.

    Ours hears what came meanwhile when it is started; on Windows, which cannot wait so, it is lost.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
    elif hasattr(signal, "pthread_sigmask"):
        ensure_running()  # else the first start lets the signal through
        previous = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            yield
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, previous)
    else:
        handler = signal.signal(signal.SIGINT, signal.SIG_IGN)
        try:
            yield
        finally:
            signal.signal(signal.SIGINT, handler)


def _serve(connection: "Connection[Any, Any]") -> None:
    """Answer tasks until the other end is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_follow_parent, daemon=True).start()
    # a run listens to Ctrl-C by itself; whoever started the sweep hears it too
    with contextlib.suppress(EOFError, BrokenPipeError, ConnectionResetError, KeyboardInterrupt):
        connection.send(None)
        while True:
            connection.send(_outcome(connection.recv()))


def _follow_parent() -> None:
    """End this process with the one that started it, which may be killed, and in the midst of a task."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
