"""Wires that close a loop: watched while they carry the value of the step before, or iterated.

A shaft that feels the torque of its mechanisms, whose torque depends on its acceleration, is such a loop.
With the value of the step before it is unstable where the mechanisms' inertia exceeds the shaft's, however
small the step. Iterated, every step is repeated from a saved state until both ends of the loop agree.
"""

import ctypes
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ...errors import LoomfmuError
from ...fmi.system.loops import RULE
from ..importing.calls import Rollback
from ..importing.slave import Ended, Slave
from ..scenes.graph import Wire
from .grid import Span
from .steppers import (
    Action,
    Advanced,
    CompiledStepper,
    Memory,
    Rows,
    Stepper,
    arrays,
    compiled_library,
    fields,
    take,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]

NOT_SETTLED, NOT_SAVED, NOT_RESTORED = -1, -2, -3  # how stepper.c says why a step could not be iterated
HISTORY = 256  # samples over which an oscillation is followed
FLIPS = 10  # in a row, each larger than the one before: an extremum of a smooth signal gives one
GROWTH = 30.0  # from which on it is an oscillation, and not noise
FEW_FLIPS, SUDDEN = 4, 1e4  # or fewer flips with that growth: the next step may be beyond an FMU's limits
NOTICED = 1e-6  # share of the largest value from which on it is reported


def _product(one: Floats, other: Floats) -> float:
    """Scalar product, summed in order as stepper.c does: numpy's own order depends on the machine."""
    total = 0.0
    for each, its in zip(one, other, strict=True):
        total += each * its
    return total


class Broyden:
    """Solves `outputs(inputs) = inputs` for the real values on the wires of a loop, by Broyden's method.

    What it has learnt of the loop's slopes is kept from one step to the next, and a step begins with values
    that go on as over the last ones. Values that are not real are handed on as they are. `broyden.h`
    does the same arithmetic, to the last bit.
    """

    def __init__(self, reals: Floats, integers: Integers, slots: Sequence[int]):
        self._reals, self._integers, self._slots = reals, integers, list(slots)
        self.largest = np.zeros(len(slots))
        self.differences = np.full((RULE.orders, len(slots)), np.nan)  # of the values at the ends of steps
        self.inverse = -np.eye(len(slots))  # of the slopes of outputs(inputs) - inputs; at first: of -1

    def settle(self, exchange: Callable[[], None]) -> bool:
        """Exchange until the loop agrees with itself; whether it does.

        `exchange` takes the values on the wires from the master's memory and writes the new ones there.
        """
        guess = self._extrapolated(self._reals[self._slots])
        change = residual = np.zeros(0)
        least, stalls = np.inf, 0
        for number in range(RULE.most_exchanges):
            self._reals[self._slots] = guess
            others = self._integers.copy()
            exchange()
            found = self._reals[self._slots]
            if not np.all(np.isfinite(found)):
                return False
            before, residual = residual, found - guess
            largest = np.maximum(self.largest, np.abs(found))
            left = np.max(np.abs(residual) / np.where(largest > 0.0, largest, 1.0), initial=0.0)
            close = np.abs(residual) <= np.maximum(RULE.tolerance * np.abs(found), RULE.small * largest)
            stalls = stalls + 1 if left >= 0.5 * least else 0
            rounded = number >= RULE.few and stalls >= RULE.stalls and left <= RULE.rounding
            if (rounded or np.all(close)) and np.array_equal(others, self._integers):
                self.largest[:] = largest
                return True
            least = min(least, left)
            if len(change):
                self._learn(change, residual - before)
            change = np.array([-_product(row, residual) for row in self.inverse])
            guess = guess + change
        return False

    def _extrapolated(self, value: Floats) -> Floats:
        """Values a step further, from those at its start and the differences that are known."""
        guess = np.zeros(len(value))
        for kept in self.differences:
            guess += np.where(np.isnan(value), 0.0, value)
            value, kept[:] = value - kept, value
        return guess

    def _learn(self, change: Floats, effect: Floats) -> None:
        """Let the slopes be those seen along the last change."""
        answer = np.array([_product(row, effect) for row in self.inverse])
        scale = _product(change, answer)
        if abs(scale) > RULE.flat * _product(change, change):
            seen = np.array([_product(change, column) for column in self.inverse.T])
            self.inverse += np.outer(change - answer, seen) / scale


@dataclass
class Loop:
    """Calls that are repeated in each step until they agree with themselves: `actions[first:end]`."""

    actions: Sequence[Action]
    first: int
    end: int
    wires: str
    slots: Sequence[int]

    @property
    def slaves(self) -> list[Slave]:
        """Whose states are saved and restored."""
        return list(dict.fromkeys(action.slave for action in self.actions[self.first : self.end]))

    def unsettled(self, time: float) -> LoomfmuError:
        """Return the error to raise if the loop does not converge in the step from `time` [s] on."""
        return LoomfmuError(
            f"loop {self.wires} did not converge at {time:.9g} s in {RULE.most_exchanges} exchanges"
        )


def iteration(
    actions: Mapping[str, Sequence[Action]],
    lagged: Sequence[Wire],
    slots: Sequence[int],
    memory: Memory,
    compiled: bool | None = None,
) -> Stepper:
    """A stepper that repeats the part of each step that lies on a loop; in C where `stepper` would be.

    `actions` are those of the instances in their order, `slots` where the values on the `lagged` wires are.
    Raises LoomfmuError as `stepper` does.
    """
    order = list(actions)
    first = min(order.index(wire.sink[0]) for wire in lagged)
    last = max(order.index(wire.source[0]) for wire in lagged)
    before, looped = (
        [action for name in names for action in actions[name]]
        for names in (order[:first], order[first : last + 1])
    )
    flat = [action for name in order for action in actions[name]]
    wires = ", ".join(str(wire) for wire in lagged)
    loop = Loop(flat, len(before), len(before) + len(looped), wires, slots)
    # an FMU of ours never ends a run by itself, which would have to be seen through all exchanges of a step
    simple = all(action.slave.fmu.trusted for action in flat)
    library = compiled_library(flat, compiled) if simple or compiled else None
    return CompiledIteration(library, loop, memory) if library else Iteration(loop, memory)


class CompiledIteration(CompiledStepper):
    """Repeats that part of each step in C."""

    def __init__(self, library: Path, loop: Loop, memory: Memory):
        self._loop = loop
        self._slaves = loop.slaves
        self._solver = Broyden(memory.reals, memory.integers, loop.slots)
        self._slots = np.array(loop.slots, dtype=np.int64)
        self._room = np.zeros(7 * len(loop.slots))
        self._integers = np.empty_like(memory.integers)
        rollbacks = [found for slave in self._slaves if (found := slave.rollback())]
        self._rollbacks = (Rollback * len(self._slaves))(*rollbacks)
        solver = self._solver
        memories = (solver.largest, solver.differences, solver.inverse, self._room, self._integers)
        self._struct = _Loop(
            *(loop.first, loop.end),
            *(ctypes.addressof(self._rollbacks), len(self._rollbacks)),
            self._slots.ctypes.data,
            *RULE,
            len(self._slots),
            *(each.ctypes.data for each in memories),
        )
        super().__init__(library, loop.actions, memory, ctypes.addressof(self._struct))

    def _stopped(self, place: int, status: int, span: Span, step: int, rows: Rows) -> Advanced:
        if status >= 0:
            return super()._stopped(place, status, span, step, rows)
        failures = {
            NOT_SETTLED: lambda: self._loop.unsettled(float(span.starts[step])),
            NOT_SAVED: self._slaves[place].not_saved,
            NOT_RESTORED: self._slaves[place].not_restored,
        }
        return step, failures[status]()


class _Loop(ctypes.Structure):
    _fields_ = [
        *fields(first="size_t", end="size_t"),
        *arrays("rollbacks"),
        *fields(slots="void_p"),
        *fields(most_exchanges="int64", few="int64", stalls="int64", orders="int64"),
        *fields(tolerance="double", small="double", rounding="double", flat="double"),
        *fields(count="size_t", largest="void_p", differences="void_p", inverse="void_p"),
        *fields(room="void_p", integers="void_p"),
    ]


class Iteration:
    """Repeats that part of each step from a saved state, in Python."""

    def __init__(self, loop: Loop, memory: Memory):
        self._before, self._looped, self._after = (
            loop.actions[part]
            for part in (slice(loop.first), slice(loop.first, loop.end), slice(loop.end, None))
        )
        self._loop = loop
        self._slaves = loop.slaves
        self._memory = memory
        self._solver = Broyden(memory.reals, memory.integers, loop.slots)

    def advance(self, span: Span, driven: Rows, rows: Rows) -> Advanced:
        """See `Stepper`."""
        memory = self._memory
        for step in range(len(span)):
            if memory.interrupted.value:
                return step, None
            memory.time.value, memory.size.value = span.starts[step], span.sizes[step]
            memory.drive(driven, step)
            try:
                ended = self._step(float(span.ends[step]))
            except LoomfmuError as failure:
                return step, failure
            memory.write(rows, step)
            if ended:
                return step + 1, ended
        return len(span), None

    def _step(self, end: float) -> Ended | None:
        """Take one step; the FMU that ends the simulation with it. Raises LoomfmuError where that fails."""
        time = self._memory.time.value
        ended = take(self._before, time, end)
        for slave in self._slaves:
            slave.save()
        stepped = False
        ended_in_loop: Ended | None = None

        def exchange() -> None:
            nonlocal stepped, ended_in_loop
            if stepped:
                for slave in self._slaves:
                    slave.restore()
            stepped = True
            ended_in_loop = take(self._looped, time, end)

        if not self._solver.settle(exchange):
            raise self._loop.unsettled(time)
        after = take(self._after, time, end)
        return ended or ended_in_loop or after


class Growth:
    """Watches the wires that carry the value of the step before for an unstable loop."""

    def __init__(self, lagged: Sequence[Wire], slots: Sequence[int]):
        self._wires = ", ".join(str(wire) for wire in lagged)
        self._slots = list(slots)
        self._times, self._values = np.empty(0), np.empty((0, len(slots)))
        self._largest = np.zeros(len(slots))

    def check(self, times: Floats, reals: Floats) -> None:
        """Look at a block. Raises LoomfmuError if a value flips and grows from step to step."""
        if not self._slots:
            return
        with np.errstate(over="ignore", invalid="ignore"):
            self._values = np.concatenate([self._values, reals[:, self._slots]])
            self._times = np.concatenate([self._times, times])
            self._largest = np.fmax(self._largest, np.fmax.reduce(np.abs(self._values)))
            for column in range(len(self._slots)):
                self._follow(self._values[:, column], self._largest[column])
        self._values, self._times = self._values[-HISTORY:], self._times[-HISTORY:]

    def _follow(self, values: Floats, largest: float) -> None:
        """Look for a run of changes that flip and grow."""
        change = np.diff(values)
        swings = (change[1:] * change[:-1] < 0.0) & (np.abs(change[1:]) > np.abs(change[:-1]))
        start = 0
        for end in np.append(np.flatnonzero(~swings), len(swings)) if len(swings) else ():
            first, last = abs(change[start]), abs(change[end])
            grows = last > (GROWTH if end - start >= FLIPS else SUDDEN) * first
            if end - start >= FEW_FLIPS and grows and last > NOTICED * largest:
                factor = (last / first) ** (1.0 / (end - start))
                raise LoomfmuError(
                    f"loop {self._wires} is unstable, growing by a factor of {factor:.3g} per step from"
                    f' {self._times[start]:.6g} s on; set coupling = "iterated"'
                )
            start = end + 1
