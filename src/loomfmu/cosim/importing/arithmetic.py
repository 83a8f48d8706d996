"""The floating-point environment of this thread: how it rounds, what it traps, what it flushes to zero.

A third-party FMU may change it, and then all that is computed after it changes in the last bits.
"""

import ctypes
import sys
from collections.abc import Callable
from typing import Any

ROOM = 64  # bytes: more than any system's fenv_t has


def _functions() -> tuple[Any, Any]:
    """C's `fegetenv` and `fesetenv`; nothing that does anything where the C library lacks them."""
    try:
        library = ctypes.PyDLL("ucrtbase" if sys.platform == "win32" else None)
        return library.fegetenv, library.fesetenv
    except (AttributeError, OSError):
        return int, int


_get, _set = _functions()


class Environment:
    """The environment as it is now, to go back to."""

    def __init__(self) -> None:
        self.content = (ctypes.c_double * (ROOM // 8))()
        self._place = ctypes.c_void_p(ctypes.addressof(self.content))
        _get(self._place)

    def restore(self) -> None:
        """Let it be so again."""
        _set(self._place)


class Guarded:
    """A library whose functions leave the environment as it was; `plain` is the function without that."""

    def __init__(self, library: Any, environment: Environment):
        self._library, self._restore = library, environment.restore

    def __getitem__(self, name: str) -> Callable[..., int]:
        function, restore = self._library[name], self._restore

        def guarded(*arguments: Any) -> int:
            status = int(function(*arguments))
            restore()
            return status

        guarded.plain = function  # type: ignore[attr-defined]
        return guarded
