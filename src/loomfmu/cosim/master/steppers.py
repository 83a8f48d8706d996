"""Steppers, which make the prepared calls of a master step after step: in Python, or in C.

Both make the same calls in the same order on the same memory, so their results are equal to the last bit. The
compiled one is used where its library is there or can be built; the other one is the reference, and takes
FMUs in processes of their own.
"""

import ctypes
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, Protocol, cast

import numpy as np
from numpy.typing import NDArray

from ...errors import LoomfmuError
from ...extras import install
from ...fmi.native.libraries import library_of
from ..importing.calls import OK, REFUSED, WARNING, Call, Compiled
from ..importing.slave import Ended, Slave
from .grid import Span

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]
SOURCE = Path(__file__).with_name("native") / "stepper.c"


@dataclass(frozen=True)
class Action:
    """A prepared call with whom it goes to."""

    slave: Slave
    call: Call

    def make(self, time: float) -> int:
        """Make the call in the step from `time` on; its status."""
        return self.slave.noted(self.call.name, time, self.call.function, *self.call.arguments)


class Rows(NamedTuple):
    """Values along steps: a row for each step, a column for each value; booleans are among the integers."""

    reals: Floats
    integers: Integers

    def after(self, first: int) -> "Rows":
        """The rows from one on."""
        return Rows(self.reals[first:], self.integers[first:])


Advanced = tuple[int, LoomfmuError | None]


class Stepper(Protocol):
    """Takes steps and writes all values after each."""

    def advance(self, span: Span, driven: Rows, rows: Rows) -> Advanced:
        """Take the steps of a span with these values of the driven inputs; `rows` are to be filled.

        Returns:
            the number of steps taken, fewer when interrupted, and what an FMU failed with or ended the run
        with, if one did
        """


def perform(actions: Iterable[Action], time: float) -> None:
    """Make some calls. Raises LoomfmuError for the first that an FMU refuses."""
    for action in actions:
        if not OK <= (status := action.make(time)) <= WARNING:
            raise action.slave.failed(status, action.call.name, time)


def take(actions: Iterable[Action], time: float, end: float, status: int | None = None) -> Ended | None:
    """Make calls of a step from `time` to `end`; `status` is that of the first where it was made before.

    Where an FMU ends the simulation at the end of the step the others still make it, and it counts. Raises
    LoomfmuError for another failure, and for an FMU that ends within the step.
    """
    ended: Ended | None = None
    for action in actions:
        found = action.make(time) if status is None else status
        status = None
        if not OK <= found <= WARNING:
            failure = action.slave.failed(found, action.call.name, time)
            if isinstance(failure, Ended) and failure.time > end and not _at_end(failure, time, end):
                failure = Ended(failure.name, time)  # it cannot have ended after this step
            if not _at_end(failure, time, end):
                raise failure
            ended = ended or cast(Ended, failure)
    return ended


@dataclass
class Memory:
    """The memory that a master shares with its stepper: all outputs, driven inputs, the stop flag, the step.

    `time` and `size` are those of the step under way [s].
    """

    reals: Floats
    integers: Integers
    driven_reals: Sequence[int]
    driven_integers: Sequence[int]
    interrupted: ctypes.c_int32
    time: ctypes.c_double = field(default_factory=ctypes.c_double)
    size: ctypes.c_double = field(default_factory=ctypes.c_double)

    def drive(self, driven: Rows, step: int) -> None:
        """Let the driven inputs have their values of a step."""
        if self.driven_reals:
            self.reals[self.driven_reals] = driven.reals[step]
        if self.driven_integers:
            self.integers[self.driven_integers] = driven.integers[step]

    def write(self, rows: Rows, step: int) -> None:
        """Write all values as the row of a step."""
        rows.reals[step] = self.reals
        rows.integers[step] = self.integers


def stopped(
    actions: Sequence[Action], status: int | None, span: Span, step: int, memory: Memory, rows: Rows
) -> Advanced:
    """Make a step's calls from one with an error status on; return the steps taken and why the run ends."""
    try:
        ended = take(actions, float(span.starts[step]), float(span.ends[step]), status)
    except LoomfmuError as failure:
        return step, failure
    memory.write(rows, step)
    return step + 1, ended


def _at_end(failure: LoomfmuError, start: float, end: float) -> bool:
    """Return whether an error is that of an FMU that ended the simulation at the end of a step."""
    return isinstance(failure, Ended) and math.isclose(
        failure.time, end, rel_tol=1e-9, abs_tol=1e-6 * (end - start)
    )


class PythonStepper:
    """Makes the calls one by one through ctypes."""

    def __init__(self, actions: Sequence[Action], memory: Memory):
        self._actions, self._memory = actions, memory
        # at hand for the loop over them, where looking them up would take longer than the calls themselves
        self._calls = [(each.call.function, each.call.arguments, each.slave.logged) for each in actions]

    def advance(self, span: Span, driven: Rows, rows: Rows) -> Advanced:
        """See `Stepper`."""
        memory = self._memory
        time, size = memory.time, memory.size
        for step in range(len(span)):
            if memory.interrupted.value:
                return step, None
            time.value, size.value = span.starts[step], span.sizes[step]
            memory.drive(driven, step)
            start = time.value
            for place, (function, arguments, logged) in enumerate(self._calls):
                before = logged.value
                status = function(*arguments)
                if status == OK:
                    continue
                if status != WARNING:
                    return stopped(self._actions[place:], status, span, step, memory, rows)
                self._actions[place].slave.warned(self._actions[place].call.name, start, before)
            memory.write(rows, step)
        return len(span), None


def fields(**kinds: str) -> list[tuple[str, Any]]:
    """Return the fields of a C structure: their names by the kind of each, such as `x="size_t void_p"`.

    >>> fields(number="int64", place="void_p") == [("number", ctypes.c_int64), ("place", ctypes.c_void_p)]
    True
    """
    return [(name, getattr(ctypes, f"c_{kind}")) for name, kind in kinds.items()]


def arrays(*names: str) -> list[tuple[str, Any]]:
    """Return the fields of some arrays: where each is, and its length."""
    return [field for name in names for field in fields(**{name: "void_p", f"{name}_count": "size_t"})]


class _Plan(ctypes.Structure):
    _fields_ = [
        *arrays("calls", "reals", "integers", "driven_reals", "driven_integers"),
        *fields(interrupted="void_p", loop="void_p", environment="void_p", control="uint64"),
    ]


class _Outcome(ctypes.Structure):
    _fields_ = fields(call="int64", status="int64")


class CompiledStepper:
    """Makes the same calls in C; `loop` is where `struct loop` of stepper.c is, if a part is repeated."""

    def __init__(self, library: Path, actions: Sequence[Action], memory: Memory, loop: int | None = None):
        # Python's lock is kept, unless a third-party FMU may have threads that log
        ours = all(action.slave.fmu.trusted for action in actions)
        self._advance = (ctypes.PyDLL if ours else ctypes.CDLL)(str(library)).advance
        self._advance.restype = ctypes.c_int64
        self._actions, self._memory = actions, memory
        self._driven = [
            np.array(slots, dtype=np.int64) for slots in (memory.driven_reals, memory.driven_integers)
        ]
        self._calls = (Compiled * len(actions))(
            *[action.call.compiled for action in actions if action.call.compiled]
        )
        for action, call in zip(actions, self._calls, strict=True):
            call.logged = ctypes.addressof(action.slave.logged)
            call.silent = ctypes.addressof(action.slave.silent_of(action.call.name))
        foreign = next((each.slave for each in actions if not each.slave.fmu.trusted), None)
        self._plan = _Plan(
            ctypes.addressof(self._calls),
            len(actions),
            memory.reals.ctypes.data,
            len(memory.reals),
            memory.integers.ctypes.data,
            len(memory.integers),
            *(part for slots in self._driven for part in (slots.ctypes.data, len(slots))),
            ctypes.addressof(memory.interrupted),
            loop,
            ctypes.addressof(foreign.environment.content) if foreign else None,
        )
        self._outcome = _Outcome()

    def advance(self, span: Span, driven: Rows, rows: Rows) -> Advanced:
        """See `Stepper`."""
        self._outcome.status = 0
        arrays = (span.starts, span.sizes, *driven, *rows)
        assert all(array.flags.c_contiguous for array in arrays)
        taken = int(
            self._advance(
                ctypes.byref(self._plan),
                ctypes.c_int64(len(span)),
                *(_place(array) for array in arrays),
                ctypes.byref(self._outcome),
            )
        )
        if not self._outcome.status:
            return taken, None
        self._memory.time.value, self._memory.size.value = span.starts[taken], span.sizes[taken]
        return self._stopped(self._outcome.call, self._outcome.status, span, taken, rows)

    def _stopped(self, place: int, status: int, span: Span, step: int, rows: Rows) -> Advanced:
        """Return the steps taken and why the run ends, after a call failed or the C code refused one (status
        < 0).
        """
        # a value that was not handed over is tried again by Python, which says which one it is
        known = None if status == REFUSED else status
        return stopped(self._actions[place:], known, span, step, self._memory, rows)


def _place(array: NDArray[Any]) -> Any:
    """Return the address of a contiguous array as an argument, at a fifth of the cost of `ctypes.data`."""
    return ctypes.byref(ctypes.c_char.from_buffer(cast(Any, array))) if array.size else None


def compiled_library(actions: Sequence[Action], compiled: bool | None) -> Path | None:
    """The library of the compiled stepper where it is available and can make the calls.

    None otherwise, or if `compiled` is False. Raises LoomfmuError if it is True and that is not so.
    """
    able = all(action.call.compiled for action in actions)
    library = library_of(SOURCE) if able and compiled is not False else None
    if compiled and library is None:
        raise LoomfmuError(f"the compiled stepper is not available: {install('native')}")
    return library


def stepper(actions: Sequence[Action], memory: Memory, compiled: bool | None = None) -> Stepper:
    """The compiled stepper where it is available and fits the FMUs, unless `compiled` chooses one.

    Raises LoomfmuError where the compiled one is required and not available.
    """
    library = compiled_library(actions, compiled)
    return CompiledStepper(library, actions, memory) if library else PythonStepper(actions, memory)
