"""Protection of this process from FMUs that run in it: its working directory, its end."""

import atexit
import contextlib
import ctypes
import os
import platform
import signal
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ...errors import LoomfmuError, listed, signal_name

FAILED = 2  # the exit status of a failed FMU


@contextmanager
def directory_kept() -> Iterator[None]:
    """Go back to the working directory that an FMU has left: relative paths mean what they meant.

    A copy of this process that an FMU has made by `fork`, and that returns from its call, too, ends here:
    there is one trace.
    """
    process, before = os.getpid(), Path()
    with contextlib.suppress(OSError):  # it was deleted
        before = Path.cwd()
    try:
        yield
    finally:
        if os.getpid() != process:
            os._exit(FAILED)
        with contextlib.suppress(OSError):
            os.chdir(before)


# ---- an FMU that ends the process

_running: list[Sequence[str]] = []  # the instances in this process, of each run that is under way


@contextmanager
def exit_named(instances: Sequence[str]) -> Iterator[None]:
    """Let an FMU that calls `exit` end the process as a failure, with a line that says so."""
    _watch()
    _running.append(instances)
    try:
        yield
    finally:
        _running.remove(instances)


def _exited(_argument: int | None) -> None:
    if not _running:
        return
    names = ", ".join(name for instances in _running for name in instances)
    with contextlib.suppress(Exception):
        sys.stdout.flush()
        os.write(
            2,
            f"loomfmu: an FMU ended the process (exit) before the run was finished, one of {names};"
            " isolated = true says which one and keeps the trace\n".encode(),
        )
    os._exit(FAILED)


_HANDLER = ctypes.CFUNCTYPE(None, ctypes.c_void_p)(_exited)
_OWNER = ctypes.c_int()  # what the C library knows the handler by
_watching: list[bool] = []


def _watch() -> None:
    """Have `_exited` called by the C library's `exit`, but not after Python has ended.

    Where the C library cannot take a handler back, as musl and Windows cannot, nothing is done.
    """
    if _watching or not (platform.libc_ver()[0] == "glibc" or sys.platform == "darwin"):
        return
    _watching.append(True)
    c_library = ctypes.CDLL(None)
    c_library.__cxa_atexit(_HANDLER, None, ctypes.byref(_OWNER))

    def take_back() -> None:
        _running.clear()  # a thread may still be in a run
        c_library.__cxa_finalize(ctypes.byref(_OWNER))

    atexit.register(take_back)


# ---- a child process that an FMU may end

FORKS = hasattr(os, "fork") and sys.platform != "darwin"  # whose libraries do not survive it


def supervised(run: Callable[[], int], instances: Sequence[str]) -> int:
    """The exit status that a run has in a child process, whatever these instances do to that process.

    Raises:
        LoomfmuError: the child ended before the run did
        KeyboardInterrupt: a second Ctrl-C, when the first did not end it
    """
    if not FORKS:
        return run()
    reading, writing = os.pipe()
    watched, held = os.pipe()  # closed with this process, however it ends
    child = os.fork()
    if not child:
        os.close(held)
        threading.Thread(target=_end_with_parent, args=(watched,), daemon=True).start()
        _watching.append(True)  # the parent says it, also where `exit` is not called
        status = run()
        with contextlib.suppress(OSError):  # an FMU has closed it
            os.write(writing, bytes([status]))
        os._exit(status)
    interrupts: list[int] = []

    def pass_on(number: int, _frame: Any) -> None:
        interrupts.append(number)
        os.kill(child, signal.SIGINT if len(interrupts) == 1 else signal.SIGKILL)

    previous = signal.signal(signal.SIGINT, pass_on)
    try:
        ended = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    finally:
        signal.signal(signal.SIGINT, previous)
    os.set_blocking(reading, False)  # what the FMU has started may still have the other end
    with contextlib.suppress(BlockingIOError):
        if status_byte := os.read(reading, 1):
            return status_byte[0]
    if len(interrupts) > 1:
        raise KeyboardInterrupt("interrupted; an FMU did not return")
    who = instances[0] if len(instances) == 1 else f"one of {listed(instances, 'or')}"
    what = f"crashed the process ({signal_name(-ended)})"
    what = what if ended < 0 else f"ended the process (exit status {ended})"
    raise LoomfmuError(
        f"{who} {what} before the run was finished; isolated = true keeps the trace up to there"
    )


def _end_with_parent(watched: int) -> None:
    os.read(watched, 1)
    os._exit(FAILED)
