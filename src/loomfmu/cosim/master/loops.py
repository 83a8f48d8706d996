"""Wires that close a loop: watched while they carry the value of the step before, or iterated.

A shaft that feels the torque of its mechanisms, whose torque depends on its acceleration, is such a loop.
With the value of the step before it is unstable where the mechanisms' inertia exceeds the shaft's, however
small the step. Iterated, every step is repeated from a saved state until both ends of the loop agree.
"""

import ctypes
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...errors import LoomfmuError
from ..importing.slave import Ended
from ..scenes.graph import Wire
from .grid import Span
from .steppers import Action, Advanced, Driven, Memory, take

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]

MOST_EXCHANGES = 50  # of a loop in one step: Broyden's method needs two or three where the loop is linear
TOLERANCE = 1e-11  # of the largest value on a wire so far: what rounding leaves of a loop with a gain of 1e4
FLAT = 1e-8  # slope from which on it is taken for rounding: there is no way to a solution along it
HISTORY = 256  # samples over which an oscillation is followed
FLIPS = 10  # in a row, each larger than the one before: an extremum of a smooth signal gives one
GROWTH = 30.0  # from which on it is an oscillation, and not noise
NOTICED = 1e-6  # share of the largest value from which on it is reported


class Broyden:
    """Solves `outputs(inputs) = inputs` for the real values on the wires of a loop, by Broyden's method.

    What it has learnt of the loop's slopes is kept from one step to the next. Values that are not real are
    handed on as they are.
    """

    def __init__(self, reals: Floats, integers: Integers, slots: Sequence[int]):
        self._reals, self._integers, self._slots = reals, integers, list(slots)
        self._largest = np.zeros(len(slots))
        self._inverse = -np.eye(len(slots))  # of the slopes of outputs(inputs) - inputs; at first: of -1

    def settle(self, exchange: Callable[[], None]) -> bool:
        """Exchange until the loop agrees with itself; whether it does.

        `exchange` takes the values on the wires from the master's memory and writes the new ones there.
        """
        guess = self._reals[self._slots]
        change = residual = np.zeros(0)
        for _ in range(MOST_EXCHANGES):
            self._reals[self._slots] = guess
            others = self._integers.copy()
            exchange()
            found = self._reals[self._slots]
            if not np.all(np.isfinite(found)):
                return False
            before, residual = residual, found - guess
            largest = np.maximum(self._largest, np.abs(found))
            agrees = np.all(np.abs(residual) <= TOLERANCE * largest)
            if agrees and np.array_equal(others, self._integers):
                self._largest = largest
                return True
            if len(change):
                self._learn(change, residual - before)
            change = -self._inverse @ residual
            guess = guess + change
        return False

    def _learn(self, change: Floats, effect: Floats) -> None:
        """Let the slopes be those seen along the last change."""
        answer = self._inverse @ effect
        scale = float(change @ answer)
        if abs(scale) > FLAT * float(change @ change):
            self._inverse += np.outer(change - answer, change @ self._inverse) / scale


class Iteration:
    """A stepper that repeats each step from a saved state until the loops agree."""

    def __init__(
        self, actions: Mapping[str, Sequence[Action]], lagged: Sequence[Wire], slots: Sequence[int],
        memory: Memory, time: ctypes.c_double, size: ctypes.c_double,
    ):  # fmt: skip
        order = list(actions)
        first = min(order.index(wire.sink[0]) for wire in lagged)
        last = max(order.index(wire.source[0]) for wire in lagged)
        self._before = [action for name in order[:first] for action in actions[name]]
        self._looped = [action for name in order[first : last + 1] for action in actions[name]]
        self._after = [action for name in order[last + 1 :] for action in actions[name]]
        self._slaves = list(dict.fromkeys(action.slave for action in self._looped))
        self._wires = ", ".join(str(wire) for wire in lagged)
        self._memory = memory
        self._time, self._size = time, size
        self._solver = Broyden(memory.reals, memory.integers, slots)

    def advance(self, span: Span, driven: Driven, reals: Floats, integers: Integers) -> Advanced:
        """See `Stepper`."""
        memory = self._memory
        for step in range(len(span)):
            if memory.interrupted.value:
                return step, None
            self._time.value, self._size.value = span.starts[step], span.sizes[step]
            memory.drive(driven, step)
            try:
                ended = self._step(float(span.ends[step]))
            except LoomfmuError as failure:
                return step, failure
            reals[step] = memory.reals
            integers[step] = memory.integers
            if ended:
                return step + 1, ended
        return len(span), None

    def _step(self, end: float) -> Ended | None:
        """Take one step; the FMU that ends the simulation with it. Raises LoomfmuError where that fails."""
        time = self._time.value
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
            raise LoomfmuError(
                f"loop: {self._wires}: did not converge at {time:.9g} s in {MOST_EXCHANGES} exchanges"
            )
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
            if end - start >= FLIPS and last > GROWTH * first and last > NOTICED * largest:
                factor = (last / first) ** (1.0 / (end - start))
                raise LoomfmuError(
                    f"loop: {self._wires}: unstable: grows by a factor of {factor:.3g} per step from"
                    f' {self._times[start]:.6g} s on; set coupling = "iterated"'
                )
            start = end + 1
