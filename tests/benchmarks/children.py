"""Configurations in processes of their own, asked in turn.

Each has its own libraries, threads and cores, and whatever one does to its process leaves the others alone.
Asked in turn, all of them see the same weather of the machine.
"""

import os
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from statistics import median
from typing import Any

PATIENCE = 180.0  # s that an answer may take


class Failed(Exception):
    """A configuration that cannot be run here; the text says why."""


@dataclass(frozen=True)
class Timing:
    """Seconds that a run takes before its first step, and for a revolution."""

    set_up: float
    turn: float


class Child:
    """An object that `make(directory, *arguments)` builds in a process of its own.

    With `pinned` the process keeps to one core. Raises `Failed` if the object cannot be built.
    """

    def __init__(self, make: Callable[..., Any], *arguments: Any, pinned: bool = False):
        context = get_context("spawn")
        self._pipe, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, make, arguments, pinned))
        self._process.start()
        theirs.close()
        self._answer()

    def ask(self, method: str, *arguments: Any) -> Any:
        """What a method of the object returns. Raises `Failed`."""
        try:
            self._pipe.send((method, arguments))
        except OSError:
            raise Failed("its process has ended") from None
        return self._answer()

    def _answer(self) -> Any:
        try:
            if not self._pipe.poll(PATIENCE):
                raise Failed(f"no answer within {PATIENCE:g} s")
            good, answer = self._pipe.recv()
        except EOFError:
            self._process.join()
            raise Failed(f"its process ended with status {self._process.exitcode}") from None
        if not good:
            raise Failed(answer)
        return answer

    def close(self) -> None:
        """End the process."""
        self._pipe.close()
        self._process.join(10.0)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


def _serve(pipe: Connection, make: Callable[..., Any], arguments: tuple[Any, ...], pinned: bool) -> None:
    """Answer until nobody asks any more. What the libraries print goes nowhere."""
    if pinned and hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    sys.stdout.flush()
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    with tempfile.TemporaryDirectory(prefix="loomfmu-") as directory:
        try:
            made = make(Path(directory), *arguments)
            pipe.send((True, None))
            while True:
                method, given = pipe.recv()
                pipe.send((True, getattr(made, method)(*given)))
        except EOFError:
            return
        except Exception as error:
            pipe.send((False, _first_line(error)))


class Inside:
    """The same in this very process, for a look that need not be exact."""

    def __init__(self, make: Callable[..., Any], *arguments: Any, pinned: bool = False):
        self._kept = tempfile.TemporaryDirectory(prefix="loomfmu-")
        self.directory = Path(self._kept.name)
        try:
            self._made = self._tried(make, self.directory, *arguments)
        except Failed:
            self.close()
            raise

    def ask(self, method: str, *arguments: Any) -> Any:
        """What a method of the object returns. Raises `Failed`."""
        return self._tried(getattr(self._made, method), *arguments)

    def _tried(self, function: Callable[..., Any], *arguments: Any) -> Any:
        try:
            return function(*arguments)
        except Exception as error:
            raise Failed(_first_line(error)) from error

    def close(self) -> None:
        """Remove what it wrote."""
        self._kept.cleanup()


def _first_line(error: Exception) -> str:
    return (str(error) or type(error).__name__).splitlines()[0]


Asked = dict[str, Child | Inside]
Configurations = Mapping[str, tuple[Any, ...]]  # name -> arguments of `Child`


@contextmanager
def children(
    configurations: Configurations,
    fails: Callable[[str, str], None],
    pinned: bool = False,
    inside: bool = False,
) -> Iterator[Asked]:
    """The configurations that can be built here; `fails` is told name and reason of the others."""
    started: Asked = {}
    try:
        for name, arguments in configurations.items():
            try:
                started[name] = (Inside if inside else Child)(*arguments, pinned=pinned)
            except Failed as error:
                fails(name, str(error))
        yield started
    finally:
        for child in started.values():
            child.close()


@dataclass(frozen=True)
class Task:
    """What a configuration is asked to do, how often."""

    repeats: int
    steps: int
    turns: float


def in_turn(
    asked: Asked, tasks: Mapping[str, Task], fails: Callable[[str, str], None]
) -> dict[str, list[Timing]]:
    """Timings of each configuration, one round after the other. One that fails is dropped and named."""
    found: dict[str, list[Timing]] = {name: [] for name in asked}
    for turn in range(max((tasks[name].repeats for name in asked), default=0)):
        for name in list(found):
            task = tasks[name]
            if turn >= task.repeats:
                continue
            try:
                found[name].append(asked[name].ask("time", task.steps, task.turns))
            except Failed as error:
                fails(name, str(error))
                asked.pop(name).close()
                del found[name]
    return found


def middle(timings: list[Timing]) -> Timing:
    """Medians."""
    return Timing(median(each.set_up for each in timings), median(each.turn for each in timings))


def spread(timings: list[Timing]) -> float:
    """Largest distance of a time from the median, as a share of it."""
    centre = middle(timings).turn
    return max(abs(each.turn - centre) for each in timings) / centre
