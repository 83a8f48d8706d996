"""The process between a master and an isolated FMU: when it ends, it ends all that the FMU has started.

What an FMU starts may leave its process group and outlive its parent. On Linux it then becomes a child of the
nearest process above that has said it takes such children, and that is this one. Elsewhere only what stays
in the FMU's process group is found.
"""

import contextlib
import ctypes
import os
import select
import shutil
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

LINUX = sys.platform == "linux"
TAKE_ORPHANS, END_WITH_PARENT = 36, 1  # PR_SET_CHILD_SUBREAPER and PR_SET_PDEATHSIG of prctl


def supervise(requests: int, replies: int) -> None:
    """Return in a new process, which is to be the FMU's; this one ends as that does, or with the master.

    Args:
        requests: the master's pipe, which is closed when the master is gone
        replies: the pipe that the master reads, which only the FMU's process keeps
    """
    _control(TAKE_ORPHANS, 1)
    worker = os.fork()
    if not worker:
        os.setsid()
        _control(END_WITH_PARENT, signal.SIGKILL)
        return
    os.close(replies)
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 1)
    os.dup2(nowhere, 2)
    threading.Thread(target=_end_with_master, args=(requests, worker), daemon=True).start()
    status = os.waitstatus_to_exitcode(os.waitpid(worker, 0)[1])
    _end(worker, os.killpg)
    _end_orphans()
    shutil.rmtree(Path.cwd(), ignore_errors=True)
    if status < 0:
        _end_by(-status)
    os._exit(status)


def _control(option: int, value: int) -> None:
    if LINUX:
        ctypes.CDLL(None).prctl(option, ctypes.c_ulong(value), 0, 0, 0)


def _end_with_master(requests: int, worker: int) -> None:
    """Wait until the master is gone, even if the FMU is in a call that does not return."""
    poll = select.poll()
    poll.register(requests, 0)
    poll.poll()
    _end(worker)


def _end(process: int, how: Callable[[int, int], None] = os.kill) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        how(process, signal.SIGKILL)


def _end_orphans() -> None:
    """End all children of this process: with each, its own children become children of this one."""
    while True:
        try:
            if os.waitpid(-1, os.WNOHANG) == (0, 0):
                for child in _children():
                    _end(child)
                os.waitpid(-1, 0)
        except ChildProcessError:
            return


def _children() -> Iterator[int]:
    for place in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = place.read_text(errors="replace").rpartition(")")[2].split()[1]
        except OSError:  # it has ended
            continue
        if int(parent) == os.getpid():
            yield int(place.parent.name)


def _end_by(number: int) -> None:
    """End as a process does that a signal ends, but without a file of its memory."""
    import resource

    resource.setrlimit(resource.RLIMIT_CORE, (0, resource.getrlimit(resource.RLIMIT_CORE)[1]))
    if number != signal.SIGKILL:
        signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
