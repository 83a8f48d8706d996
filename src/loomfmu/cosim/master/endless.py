"""Ctrl-C and `step_timeout` for live FMUs: their Python runs in this process, so a loop in it can be ended.

A handler of SIGINT runs between any two lines of Python, also inside a live FMU. An exception there is safe
only in the component's own code, whose caller takes it for a failed step; anywhere else it is fatal to the
FMU. So Ctrl-C fills a flag, which the master reads between steps, and only a call that does not return is
ended by an exception.
"""

import _thread
import ctypes
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import monotonic
from types import FrameType

LOOK = 0.1  # s between looks at the call under way
GRACE = 0.5  # s that a call may go on after Ctrl-C
CALLED = ("step", "initialize")  # methods of a component
CALLERS = ("_step", "_refresh")  # those of `LiveSlave` that call them and survive whatever they raise
LIVE = "live_slave.py"


@contextmanager
def interruptible(flag: ctypes.c_int32, step_timeout: float, live: bool) -> Iterator[None]:
    """Ctrl-C sets a flag. If there are live FMUs, a call that goes on after it, or for too long, fails."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    watch = _Watch(flag, step_timeout)
    previous = signal.signal(signal.SIGINT, watch.handle)
    threads = [threading.Thread(target=watch.look, daemon=True)] if live else []
    for thread in threads:
        thread.start()
    try:
        yield
    finally:
        watch.done.set()
        for thread in threads:
            thread.join()
        signal.signal(signal.SIGINT, previous)


class _Watch:
    """Looks at the call under way in the main thread."""

    def __init__(self, flag: ctypes.c_int32, limit: float):
        self.flag, self.limit = flag, limit
        self.done = threading.Event()
        self.reason = ""  # why the call under way is to be ended

    def handle(self, _number: int, frame: FrameType | None) -> None:
        """Handle SIGINT, from the user or from `look`."""
        reason, self.reason = self.reason, ""
        if not reason:
            self.flag.value = 1
        elif _call(frame):
            raise TimeoutError(reason)

    def look(self) -> None:
        """Look again and again until `done`, and end a call that takes too long."""
        seen: FrameType | None = None
        since = monotonic()
        main = threading.main_thread().ident or 0
        while not self.done.wait(LOOK):
            call = _call(sys._current_frames().get(main))
            if call is not seen:
                seen, since = call, monotonic()
            elif call is not None:
                lasted = monotonic() - since
                if self.flag.value and lasted > GRACE:
                    self.reason = "interrupted"
                elif lasted > self.limit:
                    self.reason = f"the call did not return within step_timeout = {self.limit:g} s"
                if self.reason:
                    _thread.interrupt_main()


def _call(frame: FrameType | None) -> FrameType | None:
    """The call of a live FMU's component that a frame is part of."""
    while frame is not None:
        caller = frame.f_back
        if (
            caller is not None
            and frame.f_code.co_name in CALLED
            and caller.f_code.co_name in CALLERS
            and Path(caller.f_code.co_filename).name == LIVE
        ):
            return frame
        frame = caller
    return None
