"""What keeps FMUs in this process from doing harm to it: Ctrl-C, the working directory, `exit`."""

import atexit
import contextlib
import ctypes
import os
import platform
import signal
import sys
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

FAILED = 2  # the exit status of a failed FMU


@contextmanager
def interrupt_fills(flag: ctypes.c_int32) -> Iterator[None]:
    """Ctrl-C sets a flag instead of raising: an exception inside a live FMU would be fatal to it."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def fill(_number: int, _frame: Any) -> None:
        flag.value = 1

    previous = signal.signal(signal.SIGINT, fill)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, previous)


@contextmanager
def directory_kept() -> Iterator[None]:
    """Go back to the working directory that an FMU has left: relative paths mean what they meant."""
    try:
        before = Path.cwd()
    except OSError:  # it was deleted
        yield
        return
    try:
        yield
    finally:
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
