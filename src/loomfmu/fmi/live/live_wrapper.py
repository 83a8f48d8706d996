"""Workarounds in a live FMU for pythonfmu's compiled wrapper. Copied into the FMU beside its slave."""

import atexit
import os
import sys
from typing import Any

# ---- failing


class Refused(Exception):
    """A call that fails: the wrapper answers `fmi2Fatal` and logs what this looks like."""

    def __repr__(self) -> str:
        return str(self)


def refuse(slave: Any, text: str) -> None:
    """Fail the call that is under way, so that no host can take it for a result. Returns where it cannot.

    The wrapper has no way to `fmi2Error`, and `fmi2Discard` it accompanies by `fmi2Terminated`: hosts then
    end the run as if all was well. What is left is an exception. It makes the wrapper let go of class,
    instance and log queue, and again when the instance is freed: so each gets one owner more before.
    Without logging the wrapper swallows the text; Python's own logging brings it to the user, on the
    standard error if the host has set up nothing else.
    """
    import logging

    logging.getLogger("loomfmu.live").error("%s: %s", slave.instance_name, text)
    try:
        import ctypes

        own = ctypes.pythonapi.Py_IncRef
    except (ImportError, AttributeError):  # a Python without ctypes
        return
    for owned in (type(slave), slave, slave.log_queue):
        own(ctypes.py_object(owned))
    raise Refused(text)


# ---- the end of the process

_libraries: set[str] = set()  # those that let go at exit


def let_go_at_exit(resources: str, name: str) -> None:
    """Make pythonfmu's wrapper let go of its `PyState` before the end of the process: it would do so twice.

    In a library that is not unloaded before, `exit` first runs the destructor of the pointer, which frees
    the state and keeps its address, then `onLibraryUnload`, which counts down in the freed memory. That
    corrupts the heap wherever the memory has another use by then. Once let go, both find nothing.
    On Windows they run in the other order. A host that is not Python has its interpreter ended by the state.
    """
    library = f"{resources.rstrip('/').rpartition('/')[0]}/binaries/linux64/{name}.so"
    if sys.platform == "linux" and sys.orig_argv and library not in _libraries:
        if not _libraries:
            os.register_at_fork(after_in_child=_forked)
        _libraries.add(library)
        atexit.register(_let_go, library)


def _forked() -> None:
    """In a forked child, leave out what ends the wrapper: its state waits for a thread that was not forked.

    `exit` calls what was registered last first: it writes what the C library still holds and ends the
    process with its status, before it comes to the wrapper.
    """
    atexit.unregister(_let_go)
    try:
        import ctypes

        c_library = ctypes.CDLL(None)
        c_library.on_exit(c_library._exit, None)
        c_library.__cxa_atexit(c_library.fflush, None, None)
    except (ImportError, OSError, AttributeError):  # no ctypes here, or another C library
        pass


def _let_go(library: str) -> None:
    try:
        import ctypes

        ctypes.CDLL(library, os.RTLD_NOLOAD).finalizePythonInterpreter()
    except (ImportError, OSError, AttributeError):  # no ctypes here, or the library was unloaded
        pass
