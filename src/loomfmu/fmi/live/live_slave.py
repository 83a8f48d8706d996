"""What runs a component inside a live FMU. Copied into the FMU, so it imports only what is copied beside it.

pythonfmu's compiled wrapper calls the methods below by name and asks for a class with a base called
`Fmi2Slave`. Every complaint is logged and remembered. Nothing raises but the end of the initialization and
the step: from a complaint on they are refused, which `live_wrapper` makes safe.
"""

import math
import operator
import struct
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

from .live_wrapper import let_go_at_exit, refuse

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
    """One variable."""

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
    rows: dict[int, Row]  # by value reference
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
        let_go_at_exit(str(kwargs.get("resources", "")), type(self.component).__name__)

    # ---- life cycle

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Keep the start time."""
        self.time = start_time

    def enter_initialization_mode(self) -> None:
        """From now on values can be read as well as set."""
        self.mode = INITIALIZING
        self.stale = True

    def exit_initialization_mode(self) -> None:
        """Compute the start, if that was not done for a reading already. Raises Refused."""
        self._refresh(logged=False)
        self.mode = STEPPING
        if self.failure:
            refuse(self, self.failure)

    def do_step(self, current_time: float, step_size: float) -> bool:
        """One communication step. Raises Refused where it cannot be made."""
        if not self.failure:
            self._step(current_time, step_size)
        if self.failure:
            refuse(self, self.failure)
        return not self.failure

    def _step(self, time: float, step_size: float) -> None:
        """One step, or the reason why there is none as `failure`."""
        if self.mode != STEPPING:
            self.failure = "a step was asked for before the initialization was finished"
            return
        if not (abs(time) <= LONGEST and 0.0 <= step_size <= LONGEST):
            self.failure = f"a step from {time!r} s by {step_size!r} s: finite and forward is asked for"
            return
        try:
            problem = self.component.step(time, step_size)
        except BaseException as error:  # Ctrl-C too: it would cut the wrapper's own bookkeeping short
            self.failure = f"at {time!r} s: {type(error).__name__}: {error}"
            return
        self.time = time + step_size
        self._report(problem)

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
                self._fail(f"{self.rows[reference].name} = {value} is more than an FMI integer holds")
                return [0] * len(references)
        return values

    def get_boolean(self, references: list[int]) -> list[bool]:
        """Values of boolean variables."""
        return self._get(references, "Boolean", False)

    def get_string(self, references: list[int]) -> list[str]:
        """No component has text variables."""
        self._fail(f"value reference {references} is no text variable")
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
        self._fail(f"value reference {references} is no text variable")

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
            if reference not in self.rows or self.rows[reference].kind != kind:
                self._fail(f"value reference {reference} is no {kind} variable")
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
        row = self.rows.get(reference)
        if row is not None and row.kind == kind and self._settable(row):
            return row.name, row.low, row.high
        return "", math.inf, -math.inf

    def _settable(self, row: Row) -> bool:
        return row.causality == "input" or (row.causality == "parameter" and self.mode != STEPPING)

    def _refuse(self, reference: int, value: Any, kind: str) -> None:
        row = self.rows.get(reference)
        if row is None or row.kind != kind:
            self._fail(f"value reference {reference} is no {kind} variable")
            return
        if not self._settable(row):
            when = "while stepping" if row.causality == "parameter" else "at all"
            self._fail(f"{row.name} is a {row.causality} and cannot be set {when}")
            return
        unit = "" if row.display == "1" else f" {row.display}"
        low, high = (
            bound / row.factor if abs(bound) < LARGEST else math.copysign(math.inf, bound)
            for bound in (row.low, row.high)
        )
        self._fail(f"{row.name} = {value / row.factor:.7g}{unit} is outside [{low:.7g}, {high:.7g}]{unit}")

    def _refresh(self, logged: bool = True) -> None:
        """Compute the start from the parameters and inputs as they now stand; tell why if it cannot be."""
        if not self.stale or self.failure:
            return
        self.stale = False
        try:
            self._report(self.component.initialize(self.time))
        except BaseException as error:  # Ctrl-C too: it would cut the wrapper's own bookkeeping short
            self.failure = f"at the start: {type(error).__name__}: {error}"
        if self.failure and logged:
            self._log(ERROR, self.failure)

    # ---- complaints

    def _report(self, problem: int) -> None:
        """Log what a component warns of, once, and remember as `failure` what ends the run."""
        if problem == 0:
            return
        text, warning = self.problems[problem - 1]
        shown = {
            row.name: f"{getattr(self.component, row.name) / row.factor:.7g}"
            + ("" if row.display == "1" else f" {row.display}")
            for row in self.rows.values()
        }
        text = text.format(**shown)
        if not warning:
            self.failure = text
        elif problem not in self.warned:
            self.warned.add(problem)
            self._log(WARNING, text)

    def _fail(self, text: str) -> None:
        self.failure = text
        self._log(ERROR, text)

    def _log(self, status: int, text: str) -> None:
        self.log_queue.append(Message(status, CATEGORIES[status][0], text))

    # ---- state

    def _get_fmu_state(self) -> tuple[Any, ...]:
        values = tuple(getattr(self.component, row.name) for row in self.rows.values())
        return (self.guid, self.mode, self.time, self.stale, self.failure, values)

    def _set_fmu_state(self, state: Any) -> None:
        if not isinstance(state, tuple) or state[0] != self.guid:
            self._fail("the FMU state to be set is not one of this FMU")
            return
        _guid, self.mode, self.time, self.stale, self.failure, values = state
        for row, value in zip(self.rows.values(), values, strict=True):
            setattr(self.component, row.name, value)

    @classmethod
    def _format(cls) -> str:
        return "<36s12sd?H" + "".join(FORMATS[row.kind] for row in cls.rows.values())

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
