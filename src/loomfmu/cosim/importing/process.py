"""The process of an isolated FMU as the master sees it: started, asked within limits on time, and ended."""

import contextlib
import ctypes
import json
import math
import mmap
import os
import select
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from ...errors import LoomfmuError, signal_name, why
from .messages import PART, complete, framed, write

AVAILABLE = hasattr(select, "poll")  # not on Windows
LOOK = 100  # ms between looks for Ctrl-C and for the limits
GRACE = 1.0  # s for a call to return after Ctrl-C, and for a process to end by itself
END = 30.0  # s for all processes to end that an FMU has started: far more than a busy machine needs
START = 120.0  # s for Python to start on a busy machine
MOST_OUTPUT = 4096  # bytes of what an FMU prints that are kept
MOST_SHOWN = 200  # letters of it that a message shows
SCRIPT = (
    "import json, pathlib, sys; sys.path[:] = json.loads(pathlib.Path('path').read_bytes());"
    " from loomfmu.cosim.importing.supervisor import supervise; supervise(*map(int, sys.argv[1:]));"
    " from loomfmu.cosim.importing.worker import main; main()"
)


@dataclass
class Limits:
    """The longest times for a call of an isolated FMU and for a whole run [s]; Ctrl-C sets `interrupted`."""

    step: float = 60.0
    run: float = math.inf
    interrupted: ctypes.c_int32 = field(default_factory=ctypes.c_int32)

    def __post_init__(self) -> None:
        self._end = time.monotonic() + self.run

    @property
    def passed(self) -> str:
        """Return the message for a run that takes too long, or an empty text."""
        return (
            f"the run took longer than run_timeout = {self.run:g} s" if time.monotonic() > self._end else ""
        )


class ProcessDied(LoomfmuError):
    """The process of an isolated FMU has ended, or had to be ended; the text says why."""


class Process:
    """A process with shared memory and a folder of its own."""

    def __init__(self, size: int):
        if not AVAILABLE:
            raise LoomfmuError("isolated = true is not available on this system; set isolated = false")
        self._folder = Path(tempfile.mkdtemp(prefix="loomfmu-"))
        pipes: list[int] = []
        try:
            (self._folder / "memory").write_bytes(bytes(size))
            with (self._folder / "memory").open("r+b") as file:
                self._memory = mmap.mmap(file.fileno(), size)
            for _ in range(3):
                pipes += os.pipe()
            theirs, self._requests, self._replies, answers, self._prints, printed = pipes
            # in a file: live FMUs lengthen the path of this process, and a command line has limits
            places = dict.fromkeys(str(Path(place).absolute()) for place in sys.path)
            (self._folder / "path").write_text(json.dumps(list(places)))
            self._popen = subprocess.Popen(
                [sys.executable, "-c", SCRIPT, str(theirs), str(answers)],
                stdin=subprocess.DEVNULL,
                stdout=printed,
                stderr=subprocess.STDOUT,
                cwd=self._folder,
                pass_fds=(theirs, answers),
                start_new_session=True,
            )
        except OSError as error:
            for pipe in pipes:
                os.close(pipe)
            shutil.rmtree(self._folder, ignore_errors=True)
            raise LoomfmuError(f"a process for an isolated FMU cannot be started: {why(error)}") from None
        for pipe in (theirs, answers, printed):
            os.close(pipe)
        self.address = ctypes.addressof(ctypes.c_char.from_buffer(self._memory))
        self._poll = select.poll()
        self._poll.register(self._replies, select.POLLIN)
        self._output = b""
        self._reader = threading.Thread(target=self._follow, daemon=True)
        self._reader.start()

    def _follow(self) -> None:
        """Read what the FMU prints, so that it does not have to wait, and keep the end of it."""
        while part := os.read(self._prints, PART):
            self._output = (self._output + part)[-MOST_OUTPUT:]
        os.close(self._prints)

    @property
    def alive(self) -> bool:
        """Return whether it still runs."""
        return self._popen.poll() is None

    def ask(self, content: bytes, limits: Limits, action: Callable[[], str]) -> bytes:
        """Send a message and wait for the answer; `action` names what the FMU is doing meanwhile.

        Raises:
            ProcessDied: there was no answer within the limits, or after Ctrl-C; the process has ended
        """
        data = b""
        try:
            write(self._requests, framed(content))
            while not complete(data):
                if not self._poll.poll(LOOK):
                    self._wait(limits, action)
                part = os.read(self._replies, PART)
                if not part:
                    raise BrokenPipeError
                data += part
        except OSError:
            raise self._died(action()) from None
        return data[4:]

    def _wait(self, limits: Limits, action: Callable[[], str]) -> None:
        """Wait until there is something to read."""
        begun = time.monotonic()
        interrupted = math.inf
        while not self._poll.poll(LOOK):
            now = time.monotonic()
            if not self.alive:
                raise BrokenPipeError
            if limits.interrupted.value:
                interrupted = min(interrupted, now)
            if now - interrupted > GRACE:
                reason = f"interrupted in {action()}"
            elif now - begun > limits.step:
                reason = f"{action()} did not return within step_timeout = {limits.step:g} s"
            else:
                reason = limits.passed
            if reason:
                self.end()
                raise ProcessDied(reason + self._printed())

    def _died(self, action: str) -> ProcessDied:
        """Return the error for a process that no longer answers, and end it."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._popen.wait(GRACE)
        status = self._popen.returncode
        self.end()
        if status is None:
            reason = f"{action} closed the connection to the master"
        elif status < 0:
            reason = f"{action} crashed its process ({signal_name(-status)})"
        else:
            reason = f"{action} ended its process (exit status {status})"
        return ProcessDied(reason + self._printed())

    def _printed(self) -> str:
        """The last line that the FMU printed, as the end of a message."""
        self._reader.join(GRACE)
        lines = self._output.decode(errors="replace").split("\n")
        texts = [
            "".join(letter if letter.isprintable() else " " for letter in line).strip() for line in lines
        ]
        last = next(filter(None, reversed(texts)), "")
        return f"; it printed: {last[:MOST_SHOWN]}" if last else ""

    def end(self) -> None:
        """End it, and whatever it has started: its supervisor does, once the pipes are closed."""
        self._close()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._popen.wait(END)
        self._popen.kill()
        self._popen.wait()
        shutil.rmtree(self._folder, ignore_errors=True)

    def forsake(self) -> None:
        """In a forked process: leave it to the process that started it."""
        self._close()
        self._popen.returncode = 0  # it is not ours to wait for

    def _close(self) -> None:
        """Close the pipes: it ends by itself when no other process has them."""
        for pipe in (self._requests, self._replies):
            with contextlib.suppress(OSError):
                os.close(pipe)
        self._requests = self._replies = -1
