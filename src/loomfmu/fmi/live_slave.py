"""What runs a component inside a live FMU. Copied into the FMU, so it imports nothing of loomfmu.

pythonfmu's compiled wrapper calls the methods below by name. It asks for a class with a base called
`Fmi2Slave` and takes an exception for the end of the process' peace (`fmi2Fatal`, then a crash when the
instance is freed), so nothing may raise: every complaint is logged, remembered, and ends the next step
with `fmi2Discard`, the one status that can be returned.
"""

import atexit
import math
import operator
import os
import struct
import sys
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

WARNING, DISCARD, ERROR = 1, 2, 3
CATEGORIES = {
    WARNING: ("logStatusWarning", "What a user should know though the run goes on"),
    DISCARD: ("logStatusDiscard", "A step that could not be made"),
    ERROR: ("logStatusError", "A value or a state that was refused"),
}
INSTANTIATED, INITIALIZING, STEPPING = "instantiated", "initializing", "stepping"
LARGEST = 1.7976931348623157e308
LONGEST = 1e15  # s: no angle that anybody turns through in that time overflows
LARGEST_INTEGER = 2147483647
FORMATS = {"Real": "d", "Integer": "q", "Boolean": "?"}


class Row(NamedTuple):
    """One variable: the index of its row is its value reference."""

    name: str
    kind: str
    causality: str
    low: float
    high: float
    display: str
    factor: float


class Message(NamedTuple):
    """A log message as pythonfmu reads it."""

    status: int
    category: str
    msg: str


class Fmi2Slave:
    """The base that pythonfmu's wrapper looks for."""

    log_queue: list[Message]

    def _get_log_queue(self) -> list[Message]:
        return self.log_queue


class LiveSlave(Fmi2Slave):
    """A component as an FMI 2.0 co-simulation slave."""

    # set by the entry module of each FMU
    component_class: Callable[[], Any]
    rows: tuple[Row, ...]
    problems: tuple[tuple[str, bool], ...]
    guid: str

    def __init__(self, **kwargs: Any) -> None:
        self.instance_name = str(kwargs.get("instance_name", ""))
        self.log_queue = []
        self.component = self.component_class()
        self.mode = INSTANTIATED
        self.time = 0.0
        self.failure = ""
        self.stale = True
        self.warned: set[int] = set()
        self.readers: dict[tuple[int, ...], Callable[[Any], Any]] = {}
        self.writers: dict[tuple[Any, ...], list[tuple[str, float, float]]] = {}
        _let_go_at_exit(str(kwargs.get("resources", "")), type(self.component).__name__)

    # ---- life cycle

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Keep the start time."""
        self.time = start_time

    def enter_initialization_mode(self) -> None:
        """From now on values can be read as well as set."""
        self.mode = INITIALIZING
        self.stale = True

    def exit_initialization_mode(self) -> None:
        """Compute the start, if that was not done for a reading already."""
        self._refresh()
        self.mode = STEPPING

    def do_step(self, current_time: float, step_size: float) -> bool:
        """One communication step; False where it cannot be made."""
        if self.mode != STEPPING:
            self._fail(DISCARD, "a step was asked for before the initialization was finished")
        elif not (abs(current_time) <= LONGEST and 0.0 <= step_size <= LONGEST):
            text = f"a step from {current_time!r} s by {step_size!r} s: finite and forward is asked for"
            self._fail(DISCARD, text)
        if self.failure:
            self._log(DISCARD, self.failure)
            return False
        try:
            problem = self.component.step(current_time, step_size)
        except BaseException as error:  # Ctrl-C too: nothing may reach the wrapper
            self._fail(DISCARD, f"at {current_time!r} s: {type(error).__name__}: {error}")
            return False
        self.time = current_time + step_size
        return problem == 0 or self._report(problem, DISCARD)

    def terminate(self) -> None:
        """Nothing is held that would have to be given back."""

    # ---- values

    def get_real(self, references: list[int]) -> list[float]:
        """Values of real variables."""
        return self._get(references, "Real", math.nan)

    def get_integer(self, references: list[int]) -> list[int]:
        """Values of integer variables and enumerations."""
        values = self._get(references, "Integer", 0)
        for reference, value in zip(references, values, strict=True):
            if not -LARGEST_INTEGER <= value <= LARGEST_INTEGER:
                self._fail(ERROR, f"{self.rows[reference].name} = {value} is more than an FMI integer holds")
                return [0] * len(references)
        return values

    def get_boolean(self, references: list[int]) -> list[bool]:
        """Values of boolean variables."""
        return self._get(references, "Boolean", False)

    def get_string(self, references: list[int]) -> list[str]:
        """No component has text variables."""
        self._fail(ERROR, f"value reference {references} is no text variable")
        return [""] * len(references)

    def set_real(self, references: list[int], values: list[float]) -> None:
        """Set real variables."""
        self._set(references, values, "Real")

    def set_integer(self, references: list[int], values: list[int]) -> None:
        """Set integer variables and enumerations."""
        self._set(references, values, "Integer")

    def set_boolean(self, references: list[int], values: list[bool]) -> None:
        """Set boolean variables."""
        self._set(references, values, "Boolean")

    def set_string(self, references: list[int], values: list[str]) -> None:
        """No component has text variables."""
        self._fail(ERROR, f"value reference {references} is no text variable")

    def _get(self, references: list[int], kind: str, nothing: Any) -> list[Any]:
        if self.stale and self.mode == INITIALIZING:
            self._refresh()
        key = tuple(references)
        reader = self.readers.get(key)
        if reader is None:
            reader = self._reader(key, kind)
            if reader is None:
                return [nothing] * len(references)
            self.readers[key] = reader
        values = reader(self.component)
        return list(values) if len(key) > 1 else [values]

    def _reader(self, key: tuple[int, ...], kind: str) -> Callable[[Any], Any] | None:
        for reference in key:
            if not 0 <= reference < len(self.rows) or self.rows[reference].kind != kind:
                self._fail(ERROR, f"value reference {reference} is no {kind} variable")
                return None
        names = [self.rows[reference].name for reference in key]
        return operator.attrgetter(*names) if names else None

    def _set(self, references: list[int], values: list[Any], kind: str) -> None:
        key = (kind, self.mode, *references)
        limits = self.writers.get(key)
        if limits is None:
            limits = self.writers[key] = [self._limits(reference, kind) for reference in references]
        component = self.component
        for reference, (name, low, high), value in zip(references, limits, values, strict=True):
            if low <= value <= high:
                setattr(component, name, value)
            else:
                self._refuse(reference, value, kind)
        self.stale = True

    def _limits(self, reference: int, kind: str) -> tuple[str, float, float]:
        """Name and limits of a variable; limits that let nothing pass for one that may not be set now."""
        if 0 <= reference < len(self.rows):
            row = self.rows[reference]
            if row.kind == kind and self._settable(row):
                return row.name, row.low, row.high
        return "", math.inf, -math.inf

    def _settable(self, row: Row) -> bool:
        return row.causality == "input" or (row.causality == "parameter" and self.mode != STEPPING)

    def _refuse(self, reference: int, value: Any, kind: str) -> None:
        if not 0 <= reference < len(self.rows) or self.rows[reference].kind != kind:
            self._fail(ERROR, f"value reference {reference} is no {kind} variable")
            return
        row = self.rows[reference]
        if not self._settable(row):
            when = "while stepping" if row.causality == "parameter" else "at all"
            self._fail(ERROR, f"{row.name} is a {row.causality} and cannot be set {when}")
            return
        unit = "" if row.display == "1" else f" {row.display}"
        low, high = (
            bound / row.factor if abs(bound) < LARGEST else math.copysign(math.inf, bound)
            for bound in (row.low, row.high)
        )
        self._fail(
            ERROR, f"{row.name} = {value / row.factor:.7g}{unit} is outside [{low:.7g}, {high:.7g}]{unit}"
        )

    def _refresh(self) -> None:
        """Compute the start from the parameters and inputs as they now stand."""
        if not self.stale or self.failure:
            return
        self.stale = False
        try:
            problem = self.component.initialize(self.time)
        except BaseException as error:  # Ctrl-C too: nothing may reach the wrapper
            self._fail(ERROR, f"at the start: {type(error).__name__}: {error}")
            return
        if problem:
            self._report(problem, ERROR)

    # ---- complaints

    def _report(self, problem: int, status: int) -> bool:
        """Tell a problem of the component; whether the run can go on."""
        text, warning = self.problems[problem - 1]
        shown = {
            row.name: f"{getattr(self.component, row.name) / row.factor:.7g}"
            + ("" if row.display == "1" else f" {row.display}")
            for row in self.rows
        }
        text = text.format(**shown)
        if not warning:
            self._fail(status, text)
            return False
        if problem not in self.warned:
            self.warned.add(problem)
            self._log(WARNING, text)
        return True

    def _fail(self, status: int, text: str) -> None:
        self.failure = text
        self._log(status, text)

    def _log(self, status: int, text: str) -> None:
        self.log_queue.append(Message(status, CATEGORIES[status][0], text))

    # ---- state

    def _get_fmu_state(self) -> tuple[Any, ...]:
        values = tuple(getattr(self.component, row.name) for row in self.rows)
        return (self.guid, self.mode, self.time, self.stale, self.failure, values)

    def _set_fmu_state(self, state: Any) -> None:
        if not isinstance(state, tuple) or state[0] != self.guid:
            self._fail(ERROR, "the FMU state to be set is not one of this FMU")
            return
        _guid, self.mode, self.time, self.stale, self.failure, values = state
        for row, value in zip(self.rows, values, strict=True):
            setattr(self.component, row.name, value)

    @classmethod
    def _format(cls) -> str:
        return "<36s12sd?H" + "".join(FORMATS[row.kind] for row in cls.rows)

    @classmethod
    def _fmu_state_to_bytes(cls, state: Any) -> bytes:
        if not isinstance(state, tuple):
            return b""
        guid, mode, time, stale, failure, values = state
        text = failure.encode()[:60000]
        head = (guid.encode(), mode.encode(), time, stale, len(text))
        try:
            packed: bytes = struct.pack(cls._format(), *head, *values) + text
        except struct.error:  # an integer beyond 64 bits
            return b""
        return packed

    @classmethod
    def _fmu_state_from_bytes(cls, data: bytes) -> tuple[Any, ...] | None:
        """The state, or None for bytes that are none: setting that is refused, with a message."""
        try:
            parts = cls._unpack(data)
            guid, mode, time, stale, length = next(parts), next(parts), next(parts), next(parts), next(parts)
            text = data[struct.calcsize(cls._format()) :].decode()
            known = mode.rstrip(b"\0").decode()
            if guid.decode() != cls.guid or len(text.encode()) != length:
                return None
            if known not in (INSTANTIATED, INITIALIZING, STEPPING):
                return None
            return cls.guid, known, time, stale, text, tuple(parts)
        except Exception:
            return None

    @classmethod
    def _unpack(cls, data: bytes) -> Iterator[Any]:
        return iter(struct.unpack_from(cls._format(), data))


# ---- the end of the process

_libraries: set[str] = set()  # those that are told to let go


def _let_go_at_exit(resources: str, name: str) -> None:
    """Make pythonfmu's wrapper let go of its `PyState` before the end of the process: it would do so twice.

    In a library that is not unloaded before, `exit` first runs the destructor of the pointer, which frees
    the state and keeps its address, then `onLibraryUnload`, which counts down in the freed memory. That
    corrupts the heap wherever the memory has another use by then. Once let go, both find nothing.
    On Windows they run in the other order. A host that is no Python has its interpreter ended by the state.
    """
    library = f"{resources.rstrip('/').rpartition('/')[0]}/binaries/linux64/{name}.so"
    if sys.platform == "linux" and sys.orig_argv and library not in _libraries:
        _libraries.add(library)
        atexit.register(_let_go, library)


def _let_go(library: str) -> None:
    try:
        import ctypes

        ctypes.CDLL(library, os.RTLD_NOLOAD).finalizePythonInterpreter()
    except (ImportError, OSError, AttributeError):  # no ctypes here, or the library was unloaded
        pass
