"""An instance of a third-party FMI 2.0 FMU.

Its status codes count, not its log; its messages come as printf formats with arguments; it is instantiated
anew for every run, since few tools make FMUs that can be reset; and Python's lock is released while it is
called, since it may have threads of its own that log.
"""

import ctypes
import math
from typing import TYPE_CHECKING, Any
from weakref import WeakValueDictionary

from fmpy.fmi2 import fmi2CallbackFunctions, fmi2CallbackLoggerTYPE, fmi2False
from fmpy.logging import addLoggerProxy

from .calls import WARNING
from .slave import MEMORY, Slave

if TYPE_CHECKING:
    from .fmus import Fmu

LAST_SUCCESSFUL_TIME, TERMINATED = 2, 3  # of fmi2StatusKind

_instances: "WeakValueDictionary[int, ForeignSlave]" = WeakValueDictionary()


def _dispatch(environment: int | None, _name: bytes, status: int, _category: bytes, message: bytes) -> None:
    """Give a message to the instance it belongs to: fmpy's proxy has one logger for the whole process."""
    slave = _instances.get(environment or 0)
    if slave is not None:
        slave._log(environment, b"", status, b"", message)


_logger = fmi2CallbackLoggerTYPE(_dispatch)


class ForeignSlave(Slave):
    """One instance of an FMI 2.0 FMU that this package has not made."""

    pooled = False
    refuses_by_log = False

    def __init__(self, fmu: "Fmu", name: str):
        super().__init__(fmu, name)
        self._library = self._guarded_library()

    def _open(self) -> Any:
        callbacks = fmi2CallbackFunctions(logger=_logger, componentEnvironment=id(self), **MEMORY)
        addLoggerProxy(ctypes.byref(callbacks))
        _instances[id(self)] = self
        return self._instantiated(self._wrapper, callbacks, self._resources(), fmi2False)

    def _log(self, _environment: Any, _instance: bytes, status: int, _category: bytes, text: bytes) -> None:
        self._keep(status, text)

    def _ended(self) -> float | None:
        kept = list(self.messages)  # it may complain of being asked
        ended, time = ctypes.c_int(), ctypes.c_double(-math.inf)
        try:
            status = self._library["fmi2GetBooleanStatus"](self._component, TERMINATED, ctypes.byref(ended))
            if status <= WARNING and ended.value:
                self._library["fmi2GetRealStatus"](self._component, LAST_SUCCESSFUL_TIME, ctypes.byref(time))
        except AttributeError:  # the library lacks a function that it should have
            return None
        self.messages[:] = kept
        return time.value if ended.value else None
