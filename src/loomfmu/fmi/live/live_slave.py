"""The slave that runs a component inside a live FMU. Copied into the FMU, so it imports only its neighbours.

pythonfmu's compiled wrapper calls the methods below by name and expects a class with a base called
`Fmi2Slave`. Every complaint is logged and remembered: the next step, or the end of the initialization, then
raises, which `live_wrapper` makes safe. In other calls the wrapper does not survive an exception and cannot
return an error: they return OK. Nor does it pass on the GUID that a host gives: a wrong one is not noticed.
"""

import math
import operator
from collections.abc import Callable
from typing import Any, NamedTuple

from . import live_state
from .live_state import INITIALIZING, INSTANTIATED, LONGEST, STEPPING, Row, State
from .live_wrapper import let_go_at_exit, refuse

WARNING, DISCARD, ERROR = 1, 2, 3
CATEGORIES = {
    WARNING: ("logStatusWarning", "Warnings; the run continues"),
    DISCARD: ("logStatusDiscard", "Steps that cannot be computed"),
    ERROR: ("logStatusError", "Rejected values, calls and states"),
}
# what cannot be set, as its message calls it
CAUSALITIES = {"parameter": "a fixed parameter", "output": "an output", "local": "a local variable"}
LARGEST = 1.7976931348623157e308
LARGEST_INTEGER = 2147483647
LONGEST_INTEGER = 2**63  # first integer beyond 64 bits


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
        self.values = operator.attrgetter(*(row.name for row in self.rows.values()))
        self.readers: dict[tuple[Any, ...], Callable[[Any], Any]] = {}
        self.writers: dict[tuple[Any, ...], list[tuple[str, float, float]]] = {}
        let_go_at_exit(str(kwargs.get("resources", "")), type(self.component).__name__)

    # ---- life cycle

    def setup_experiment(self, start_time: float, stop_time: float | None, tolerance: float | None) -> None:
        """Keep the start time."""
        if not abs(start_time) <= LONGEST or (stop_time is not None and not stop_time >= start_time):
            self._fail("the start time must be finite and not after the stop time")
            return
        self.time = start_time

    def enter_initialization_mode(self) -> None:
        """From now on values can be read as well as set."""
        self.mode = INITIALIZING
        self.stale = True

    def exit_initialization_mode(self) -> None:
        """Compute the start, unless a reading already did. Raises Refused."""
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
        """One step, or the reason why it failed as `failure`."""
        if self.mode != STEPPING:
            self.failure = f"fmi2DoStep is not allowed in the state '{self.mode}'"
            return
        if not (abs(time) <= LONGEST and 0.0 <= step_size <= LONGEST):
            what = f"step from {time!r} s by {step_size!r} s"
            self.failure = f"{what}: time must be finite and the step not negative"
            return
        try:
            problem = self.component.step(time, step_size)
            self.time = time + step_size
            self._check_values()
            self._report(problem)
        except BaseException as error:  # whatever it raises would cut the wrapper's own bookkeeping short
            self.failure = f"at {time!r} s: {type(error).__name__}: {error}"

    def terminate(self) -> None:
        """There is nothing to release."""

    # ---- values

    def get_real(self, references: list[int]) -> list[float]:
        """Values of real variables."""
        return self._get(references, "Real", math.nan)

    def get_integer(self, references: list[int]) -> list[int]:
        """Values of integer variables and enumerations."""
        values = self._get(references, "Integer", 0)
        for reference, value in zip(references, values, strict=True):
            if not -LARGEST_INTEGER <= value <= LARGEST_INTEGER:
                self._fail(f"{self.rows[reference].name} = {value} exceeds the range of fmi2Integer")
                return [0] * len(references)
        return values

    def get_boolean(self, references: list[int]) -> list[bool]:
        """Values of boolean variables."""
        return self._get(references, "Boolean", False)

    def get_string(self, references: list[int]) -> list[str]:
        """No component has text variables."""
        for reference in references:
            self._fail(self._not_of(reference, "String"))
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
        for reference in references:
            self._fail(self._not_of(reference, "String"))

    def _get(self, references: list[int], kind: str, nothing: Any) -> list[Any]:
        if self.stale and self.mode == INITIALIZING:
            self._refresh()
        key = (kind, *references)
        reader = self.readers.get(key)
        if reader is None:
            reader = self._reader(references, kind)
            if reader is None:
                return [nothing] * len(references)
            self.readers[key] = reader
        values = reader(self.component)
        return list(values) if len(references) > 1 else [values]

    def _reader(self, references: list[int], kind: str) -> Callable[[Any], Any] | None:
        for reference in references:
            if reference not in self.rows or self.rows[reference].kind != kind:
                self._fail(self._not_of(reference, kind))
                return None
        names = [self.rows[reference].name for reference in references]
        return operator.attrgetter(*names) if names else None

    def _not_of(self, reference: int, kind: str) -> str:
        return f"value reference {reference % 2**32} is not a variable of type {kind}"

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
            self._fail(self._not_of(reference, kind))
            return
        if not self._settable(row):
            when = " while stepping" if row.causality == "parameter" else ""
            self._fail(f"{row.name} is {CAUSALITIES[row.causality]} and cannot be set{when}")
            return
        unit = "" if row.display == "1" else f" {row.display}"
        low, high = (
            bound / row.factor if abs(bound) < LARGEST else math.copysign(math.inf, bound)
            for bound in (row.low, row.high)
        )
        self._fail(f"{row.name} = {value / row.factor:.7g}{unit} is outside [{low:.7g}, {high:.7g}]{unit}")

    def _refresh(self, logged: bool = True) -> None:
        """Compute the start from the parameters and inputs as they now stand; log why if that fails."""
        if not self.stale or self.failure:
            return
        self.stale = False
        try:
            problem = self.component.initialize(self.time)
            self._check_values()
            self._report(problem)
        except BaseException as error:  # whatever it raises would cut the wrapper's own bookkeeping short
            self.failure = f"at the start: {type(error).__name__}: {error}"
        if self.failure and logged:
            self._log(ERROR, self.failure)

    def _check_values(self) -> None:
        """Fail where Python has computed what C cannot: a complex number, or an integer beyond 64 bits."""
        values = self.values(self.component)
        values = values if isinstance(values, tuple) else (values,)
        if {complex, int}.isdisjoint(map(type, values)):  # in most steps of most components
            return
        for row, value in zip(self.rows.values(), values, strict=True):
            kind = type(value)
            if kind is complex:
                self.failure = f"{row.name} is complex: a negative number to a fractional power"
                setattr(self.component, row.name, math.nan)
            elif kind is int and not -LONGEST_INTEGER <= value < LONGEST_INTEGER:
                self.failure = f"{row.name} = {value:.7g} exceeds a 64-bit integer"
                setattr(self.component, row.name, 0)

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

    def _get_fmu_state(self) -> State:
        values = tuple(getattr(self.component, row.name) for row in self.rows.values())
        return State(self.guid, self.mode, self.time, self.stale, self.failure, values)

    def _set_fmu_state(self, state: Any) -> None:
        if not isinstance(state, State) or state.guid != self.guid:
            self._fail("the FMU state is damaged, or of another FMU or another version of this one")
            return
        _guid, self.mode, self.time, self.stale, self.failure, values = state
        for row, value in zip(self.rows.values(), values, strict=True):
            setattr(self.component, row.name, value)

    @classmethod
    def _fmu_state_to_bytes(cls, state: Any) -> bytes:
        return live_state.to_bytes(cls.rows, state) if isinstance(state, State) else b""

    @classmethod
    def _fmu_state_from_bytes(cls, data: bytes) -> State | None:
        """The state, or None for bytes that hold none: setting that fails with a message."""
        return live_state.from_bytes(cls.rows, cls.guid, data)
