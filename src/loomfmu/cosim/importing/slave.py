"""An instantiated FMU under a master's hand.

Loading, checking and the life cycle go through fmpy. While stepping, the same library is called through
`ctypes.PyDLL` with arguments that were prepared once and point into the master's vectors: a tenth of
the cost of fmpy's public methods, and the same calls.
"""

import ctypes
import logging
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, ClassVar
from urllib.parse import unquote

from fmpy import calloc, free
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import (
    FMU2Slave,
    fmi2CallbackAllocateMemoryTYPE,
    fmi2CallbackFreeMemoryTYPE,
    fmi2CallbackFunctions,
    fmi2CallbackLoggerTYPE,
    fmi2CoSimulation,
    fmi2False,
    fmi2True,
)

from ...errors import LoomfmuError
from . import calls
from .arithmetic import Environment, Guarded
from .calls import (
    DISCARD,
    ERROR,
    FATAL,
    OK,
    PENDING,
    REFUSED,
    WARNING,
    Call,
    Compiled,
    Rollback,
    Setting,
    settings,
)
from .logged import Logged
from .ports import Value

if TYPE_CHECKING:
    from .fmus import Fmu

SIZES = {"Real": 8, "Integer": 4, "Boolean": 4}  # bytes of a value in the master's vectors
NEEDS_TOOL = "it says that it needs the tool that created it (needsExecutionTool = true)"
MEMORY = {
    "allocateMemory": fmi2CallbackAllocateMemoryTYPE(calloc),
    "freeMemory": fmi2CallbackFreeMemoryTYPE(free),
}
STATUS = {DISCARD: "Discard", ERROR: "Error", FATAL: "Fatal", PENDING: "Pending"}


class Ended(LoomfmuError):
    """An FMU ended the simulation itself, at `time` [s]."""

    def __init__(self, name: str, time: float):
        super().__init__(f"{name} ended the simulation at {time:.9g} s")
        self.name, self.time = name, time

    def __reduce__(self) -> tuple[type["Ended"], tuple[str, float]]:
        return Ended, (self.name, self.time)


class FMU2Ours(FMU2Slave):  # type: ignore[misc]
    """fmpy's slave; the signatures of its functions are inspected once, not for each instance."""

    _signatures: ClassVar[dict[str, tuple[Any, Any, Any]]] = {}

    def _loadFunctions(self) -> None:
        if not self._signatures:
            super()._loadFunctions()
            for name, found in self._functions.items():
                self._signatures[name] = found.argnames, found.argtypes, found.restype
        for name, (names, types, result) in self._signatures.items():
            function = self._functions[name] = getattr(self.dll, name)
            function.argnames, function.argtypes, function.restype = names, types, result


class Slave(Logged):
    """One instance of an FMU."""

    standard = "fmi2"  # what its functions begin with
    pooled = True  # whether it can be reset for another run
    keeps_calls = True  # whether prepared calls serve another run, too
    refuses_by_log = True  # whether what it logs as discarded or worse is a refusal, whatever it returns
    _state_word = "state"
    _wrapper: Any = FMU2Slave  # fmpy's class for it
    _interface = fmi2CoSimulation
    _at = 0.0  # s, where it stands, if it is solved here

    def __init__(self, fmu: "Fmu", name: str):
        super().__init__(name)
        self.fmu = fmu
        self._functions: dict[str, Callable[..., int]] = {}
        self._settings: dict[tuple[str, ...], list[Setting]] = {}
        self.fatal = False
        self.started = False
        self.environment = Environment()
        self._connect()

    def _connect(self) -> None:
        """Load the FMU and instantiate it."""
        self._saved = ctypes.c_void_p()
        self.fmu.check_platform(self.name)
        try:
            with _no_bytecode():
                self._slave = self._open()
        except Exception as error:
            hint = f" ({NEEDS_TOOL})" if self.fmu.needs_tool else ""
            raise LoomfmuError(
                f"{self.name}: {self.fmu.path} cannot be instantiated: {self._reason(error)}{hint}"
            ) from None
        finally:
            self.environment.restore()
        self._library: Any = ctypes.PyDLL(self._slave.dll._name, handle=self._slave.dll._handle)
        self._component = ctypes.c_void_p(self._slave.component)

    def _guarded_library(self) -> Guarded:
        """The library of a third-party FMU: it may have threads that log, which need Python's lock."""
        return Guarded(ctypes.CDLL(self._slave.dll._name, handle=self._slave.dll._handle), self.environment)

    def _open(self) -> Any:
        """fmpy's slave, instantiated."""
        # live FMUs say there why they fail, for hosts without FMI's logging: here it is in `messages`
        logging.getLogger("loomfmu.live").addHandler(_unheard)
        callbacks = fmi2CallbackFunctions(logger=fmi2CallbackLoggerTYPE(self._log), **MEMORY)
        # pythonfmu's wrapper knows no escape but %20 and crashes where it finds no resources
        return self._instantiated(FMU2Ours, callbacks, unquote(self._resources()), fmi2True)

    def _resources(self) -> str:
        return (self.fmu.directory.absolute() / "resources").as_uri()

    def _loaded(self, wrapper: Callable[..., Any]) -> Any:
        """fmpy's slave, of one of its classes, for the FMU's library."""
        return wrapper(
            guid=self.fmu.guid,
            unzipDirectory=str(self.fmu.directory),
            modelIdentifier=self.fmu.identifier,
            instanceName=self.name,
            libraryPath=str(self.fmu.library),  # fmpy takes linux64 on every processor
        )

    def _instantiated(
        self, wrapper: Callable[..., Any], callbacks: fmi2CallbackFunctions, resources: str, logging_on: int
    ) -> Any:
        """As fmpy's own method, but with these callbacks and this resource location."""
        slave = self._loaded(wrapper)
        slave.callbacks = callbacks
        slave.component = slave.fmi2Instantiate(
            self.name.encode(),
            self._interface,
            self.fmu.guid.encode(),
            resources.encode(),
            ctypes.byref(callbacks),
            fmi2False,
            logging_on,
        )
        if slave.component is None:
            raise LoomfmuError("no reason given")
        return slave

    def _do(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Call fmpy; a refusal, by status or by log, becomes one line that names the instance."""
        seen, failure = len(self.messages), None
        try:
            function(*arguments)
        except FMICallException as error:
            failure = error
            self._note(error.status)
        finally:
            self.environment.restore()
        if failure or self._complained(self.messages[seen:]):
            raise LoomfmuError(f"{self.name}: {self._reason(failure)}")

    def _complained(self, messages: Sequence[tuple[int, str]]) -> bool:
        return self.refuses_by_log and any(status >= DISCARD for status, _text in messages)

    def start(self, values: dict[str, Value], stop_time: float, start_time: float = 0.0) -> None:
        """Set the experiment up and the values, and enter the initialization."""
        self.forget_messages()
        first, stop = ctypes.c_double(start_time), ctypes.c_double(stop_time)
        self._do(self._call, "SetupExperiment", *self._tolerance(), first, fmi2True, stop)
        self.started = True
        for setting in self._settings_of(tuple(values)):
            setting.values[:] = [values[name] for name in setting.names]
            self._do(self._call, setting.function, setting.references, setting.size, setting.values)
        self._do(self._call, "EnterInitializationMode")

    def _tolerance(self) -> tuple[ctypes.c_int, ctypes.c_double]:
        """Return if a tolerance is defined, and the one of the FMU's default experiment."""
        stated = self.fmu.tolerance
        return ctypes.c_int(stated is not None), ctypes.c_double(stated or 0.0)

    def finish_initialization(self) -> None:
        """Leave the initialization; what the FMU complains of, or complained of before, is raised."""
        if self._complained(self.messages):
            raise LoomfmuError(f"{self.name}: {self._reason()}")
        self._do(self._call, "ExitInitializationMode")

    def _call(self, name: str, *arguments: Any) -> None:
        """Call a function of the FMU. Raises FMICallException, as fmpy's methods do."""
        function = self._functions.get(name)
        if function is None:
            function = self._functions[name] = self._library[f"{self.standard}{name}"]
        status = self.noted(f"{self.standard}{name}", self._at, function, self._component, *arguments)
        if not OK <= status <= WARNING:
            raise FMICallException(f"{self.standard}{name}", status)

    def _settings_of(self, names: tuple[str, ...]) -> list[Setting]:
        """Return the calls that set variables of these names, one for each type; kept from run to run."""
        if names not in self._settings:
            self._settings = {names: settings([self.fmu.ports[name] for name in names])}
        return self._settings[names]

    # ---- prepared calls

    def value_calls(self, action: str, kind: str, references: Sequence[int], place: int) -> list[Call]:
        """`fmi2GetReal` and its kin, moving values between the FMU and the memory at a place."""
        name, count = f"fmi2{action}{kind}", len(references)
        function, array = self._library[name], (ctypes.c_uint * count)(*references)
        arguments = (self._component, array, ctypes.c_size_t(count), ctypes.c_void_p(place))
        compiled = Compiled(
            calls.VALUES, calls.address(function), self._component, ctypes.addressof(array), count, place
        )
        return [Call(function, arguments, name, compiled)]

    def start_calls(self, names: tuple[str, ...], experiment: int) -> list[Compiled]:
        """The calls of `start` for values of these names, kept where `places_of` says.

        The start and the end of the experiment are at an address.
        """
        limited, tolerance = (each.value for each in self._tolerance())
        set_up = self.plain_call("SetupExperiment", calls.SET_UP)
        set_up.values, set_up.type, set_up.low = experiment, limited, tolerance
        found = [set_up]
        for each in self._settings_of(names):
            call = self.plain_call(each.function, calls.VALUES)
            call.references, call.count = ctypes.addressof(each.references), each.size.value
            call.values = ctypes.addressof(each.values)
            found.append(call)
        return [*found, self.plain_call("EnterInitializationMode")]

    def places_of(self, variable: str) -> list[tuple[int, bool]]:
        """Return where `start_calls` take the value of a variable from, if they do, and if it is whole."""
        found = []
        for each in self._settings_of(next(iter(self._settings))):
            if variable in each.names:
                size = ctypes.sizeof(each.values) // len(each.values)
                place = ctypes.addressof(each.values) + each.names.index(variable) * size
                found.append((place, each.function != "SetReal"))
        return found

    def plain_call(self, name: str, kind: int = calls.PLAIN) -> Compiled:
        """A call of a function by its name, which takes the instance alone."""
        function = self._library[f"{self.standard}{name}"]
        return Compiled(kind, calls.address(function), self._component)

    def step_call(self, time: ctypes.c_double, step_size: ctypes.c_double) -> Call:
        """`fmi2DoStep` over the step that `time` and `step_size` hold when it is called."""
        function = self._library["fmi2DoStep"]
        compiled = Compiled(calls.STEP, calls.address(function), self._component)
        arguments = (self._component, time, step_size, ctypes.c_int(1))
        return Call(function, arguments, "fmi2DoStep", compiled)

    # ---- rollback

    def save(self) -> None:
        """Keep the state as it is for `restore`. Raises LoomfmuError where the FMU cannot."""
        if self._state_function("Get")(self._component, ctypes.byref(self._saved)) not in (OK, WARNING):
            raise self.not_saved()

    def restore(self) -> None:
        """Go back to the state that was kept last."""
        if self._state_function("Set")(self._component, self._saved) not in (OK, WARNING):
            raise self.not_restored()

    def not_saved(self) -> LoomfmuError:
        """Return the error to raise if it cannot save its state."""
        return LoomfmuError(
            f"{self.name} cannot save its state, which an iterated loop requires: {self._reason()}"
        )

    def not_restored(self) -> LoomfmuError:
        """Return the error to raise if it cannot restore its state."""
        return LoomfmuError(f"{self.name} cannot restore a state that it saved: {self._reason()}")

    def rollback(self) -> Rollback | None:
        """Return the calls with which the compiled stepper saves and restores it, or None if only Python can.

        Raises LoomfmuError if the FMU has no such functions.
        """
        get, put = self._state_function("Get"), self._state_function("Set")
        return Rollback(
            calls.address(get), calls.address(put), self._component, ctypes.addressof(self._saved)
        )

    def forget(self) -> None:
        """Free the state that was kept."""
        if self._saved and not self.fatal:
            self._state_function("Free")(self._component, ctypes.byref(self._saved))
        self._saved.value = None

    def _state_function(self, action: str) -> Callable[..., int]:
        name = f"{self.standard}{action}FMU{self._state_word}"
        try:
            return self._library[name]  # type: ignore[no-any-return]
        except AttributeError:
            raise LoomfmuError(f"{self.name}: {self.fmu.path} has no {name}") from None

    def failed(self, status: int, action: str, time: float) -> LoomfmuError:
        """Return the error to raise for a status other than OK, of a call in the step from `time` on."""
        self._note(status)
        if status == REFUSED:
            return LoomfmuError(f"{self.name} at {time:.9g} s: {self._reason()}")
        if status == DISCARD and action.endswith("DoStep"):
            ended = self._ended()
            if ended is not None:
                return Ended(self.name, ended if ended >= time else time)
        kind = f"{self.standard}{STATUS[status]}" if status in STATUS else f"status {status}"
        reason = "steps in the background are not supported" if status == PENDING else self._reason()
        return LoomfmuError(f"{self.name} at {time:.9g} s: {action} returned {kind}: {reason}")

    def _ended(self) -> float | None:
        """Return the time at which the FMU ended the simulation, or None; our FMUs never do."""
        return None

    # ---- end

    def _note(self, status: int) -> None:
        """After a fatal status nothing more may be called. Our own live FMUs know no other and outlive it."""
        self.fatal = self.fatal or (status == FATAL and not self.fmu.trusted)

    def rest(self) -> bool:
        """Terminate and reset for another run; whether it can be used again."""
        try:
            self.forget()
            if self.started and not self.fatal:
                self._call("Terminate")
            self.started = False
            if self.pooled and not self.fatal:
                self._call("Reset")
                self.messages.clear()
                return True
        except FMICallException:
            pass
        return False

    def renew(self) -> None:
        """Reset it in the midst of a run: another one starts it by the calls of `start_calls`."""
        self._call("Reset")
        self.started = False

    def free(self) -> None:
        """Free the instance, unless it ended fatally: then that is not allowed."""
        if not self.fatal:
            self._slave.freeInstance()
            self.environment.restore()
            self.fatal = True


@contextmanager
def _no_bytecode() -> Iterator[None]:
    """Let Python inside an FMU write no bytecode beside its source: what is not in the FMU is not run."""
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        yield
    finally:
        sys.dont_write_bytecode = before


_unheard = logging.NullHandler()
