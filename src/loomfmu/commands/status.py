"""The end of a command: its exit status, and one line on whatever goes wrong."""

import argparse
import os
import sys
import threading
from collections.abc import Callable
from signal import SIG_IGN, SIGINT, signal
from time import perf_counter

from ..display import printed
from ..display.printed import complain
from ..errors import LoomfmuError, described, why

BEGUN = perf_counter()  # when the command started


def status_of(command: Callable[[], int], options: argparse.Namespace) -> int:
    """The exit status of a command; whatever goes wrong becomes one line."""
    try:
        status = command()
        _flush()
        return status
    except BrokenPipeError:  # the reader of our output has gone, as `head` does
        _drop_output()
        return 141
    except (Exception, KeyboardInterrupt) as error:
        interrupted = isinstance(error, KeyboardInterrupt)
        if interrupted and threading.current_thread() is threading.main_thread():
            signal(SIGINT, SIG_IGN)  # another Ctrl-C changes nothing any more
        if options.debug:
            printed.complain_of(error)
        complain(f"loomfmu: {_reason(error)}")
        return 130 if interrupted else 2


def _flush() -> None:
    """Write what was printed. Raises LoomfmuError where standard output takes nothing more."""
    try:
        if sys.stdout is not None:  # closed by whoever started this process
            sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise LoomfmuError(f"standard output: {error.strerror}") from None


def _drop_output() -> None:
    """Let Python end without another try to write what it could not."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _reason(error: BaseException) -> str:
    """Return the cause of an error in one line."""
    if isinstance(error, LoomfmuError):
        return str(error)
    if isinstance(error, OSError):
        return (f"{error.filename}: " if error.filename else "") + why(error)
    if isinstance(error, KeyboardInterrupt):
        return str(error) or "interrupted"
    if isinstance(error, MemoryError):
        return "out of memory"
    what = described(error)
    return f"{what} (a bug in loomfmu; please report it with the output of --debug)"
