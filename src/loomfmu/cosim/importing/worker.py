"""The process of an isolated FMU: it makes the calls that the master sends, until the master is gone."""

import ctypes
import mmap
import os
import pickle
import sys
from array import array
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from ...errors import LoomfmuError, described
from .calls import OK, WARNING, Call
from .messages import CALLS, DONE, PART, PLACE, SIZE, TIME, Answer, complete, framed, write
from .pool import opened
from .slave import Slave

Prepared = list[tuple[int, Call]]


class Worker:
    """Serves one instance of an FMU after the other, of one FMU, in a folder of its own."""

    def __init__(self, requests: int, replies: int):
        self._requests, self._replies = requests, replies
        self._folder = Path.cwd()
        with Path("memory").open("r+b") as file:
            self._memory = mmap.mmap(file.fileno(), 0)
        for file_name in ("memory", "path"):  # an FMU might open a file of that name
            Path(file_name).unlink()
        self._time = ctypes.c_double.from_buffer(self._memory, TIME)
        self._size = ctypes.c_double.from_buffer(self._memory, SIZE)
        self._place = ctypes.c_int64.from_buffer(self._memory, PLACE)
        self._start = ctypes.addressof(self._time)
        self._known: tuple[Any, Any] = [], {}  # messages, and warnings without one, as the master has them
        self._slave: Slave
        self._calls: list[tuple[Call, ...]] = []
        self._batches: dict[bytes, Prepared] = {}

    def serve(self) -> None:
        """Answer requests until the master closes its end."""
        done, process = framed(DONE), os.getpid()
        while request := self._read():
            value: Any
            calls = request[:1] == CALLS
            if calls:
                value, error = self._make(request[1:]), None
            else:
                value, error = self._perform(*pickle.loads(request))
            if os.getpid() != process:  # the FMU has called `fork`: its copy must not answer, too
                os._exit(0)
            known, self._known = self._known, (list(self._slave.messages), self._slave.silent)
            if calls and value is None and known == self._known:
                write(self._replies, done)
                continue
            answer = Answer(value, error, *self._known, self._slave.fatal)
            write(self._replies, framed(pickle.dumps(tuple(answer))))

    def _read(self) -> bytes:
        data = b""
        while not complete(data):
            part = os.read(self._requests, PART)
            if not part:
                return b""
            data += part
        return data[4:]

    def _make(self, numbers: bytes) -> tuple[int, int] | None:
        """Make prepared calls up to the first that fails; its place among them and its status."""
        if numbers not in self._batches:
            self._batches[numbers] = [
                (place, call)
                for place, number in enumerate(array("I", numbers))
                for call in self._calls[number]
            ]
        time = self._time.value
        for place, call in self._batches[numbers]:
            self._place.value = place
            status = self._slave.noted(call.name, time, call.function, *call.arguments)
            if not OK <= status <= WARNING:
                return place, status
        return None

    def _perform(self, method: str, arguments: tuple[Any, ...]) -> tuple[Any, Exception | None]:
        """Call a method of this object, or else of the instance."""
        try:
            found = getattr(self, method, None) or getattr(self._slave, method)
            return found(*arguments), None
        except LoomfmuError as error:
            return None, error
        except Exception as error:
            return None, LoomfmuError(described(error))

    # ---- what the master sends beside the methods of `Slave`

    def instantiate(self, facts: dict[str, Any], name: str) -> None:
        """Load an FMU and instantiate it."""
        os.chdir(self._folder)  # the one before may have left it
        self._calls.clear()
        self._batches.clear()
        self._slave = SimpleNamespace(messages=[], silent={}, fatal=False)  # type: ignore[assignment]
        self._slave = opened(SimpleNamespace(**facts, check_platform=lambda _name: None), name)  # type: ignore[arg-type]

    def prepare(self, action: str, kind: str, references: list[int], offset: int) -> str:
        """Prepare a call that moves values to or from a place in the shared memory; the function's name."""
        return self._prepared(*self._slave.value_calls(action, kind, references, self._start + offset))

    def prepare_step(self) -> str:
        """Prepare the call that takes a step; the function's name."""
        return self._prepared(self._slave.step_call(self._time, self._size))

    def _prepared(self, *calls: Call) -> str:
        self._calls.append(calls)
        return " or ".join(call.name for call in calls)

    def terminate(self) -> bool:
        """Terminate and free the instance; whether another one may follow."""
        self._slave.rest()
        failed = self._slave.fatal
        self._slave.free()
        return not failed


def main() -> None:
    """Serve the pipes that the arguments name."""
    Worker(*map(int, sys.argv[1:])).serve()
    os._exit(0)  # without what libraries would do at the end of a process
