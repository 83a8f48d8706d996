"""The master: steps the instances of a scene in dependency order.

Within a step every source is stepped before its sinks and hands over the values it has at the end of
the step, so that a system without loops has no coupling error. Wires that close a loop carry the values
of the step before. Steps are counted as integers, `t = n h`: nothing drifts.
"""

import ctypes
import math
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import LoomfmuError
from .graph import step_order
from .scene import Scene
from .slave import Call, Slave, borrow, give_back

SIZES = {"Real": 8, "Integer": 4, "Boolean": 4}
INITIAL_PASSES = 100  # of an exchange around a loop that does not settle

Block = Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.int32]], None]


class Interrupted(Exception):
    """The user asked for the end of the run."""


class Master:
    """The instances of a scene, coupled. Use it in a `with` statement: it gives them back.

    Within that statement Ctrl-C does not raise, it fills `interrupted`.
    """

    def __init__(self, scene: Scene):
        self.scene = scene
        self.order, self.lagged = step_order(scene.instances, scene.wires)
        self.slots = self._slots()
        self.reals = np.zeros(max(1, sum(1 for kind, _ in self.slots.values() if kind == "Real")))
        self.integers = np.zeros(
            max(1, sum(1 for kind, _ in self.slots.values() if kind != "Real")), dtype=np.int32
        )
        self.slaves: dict[str, Slave] = {}
        self.unsettled = False
        self._time = ctypes.c_double(0.0)
        self._calls: list[tuple[Slave, str, Call]] = []

    def _slots(self) -> dict[tuple[str, str], tuple[str, int]]:
        """Where the value of each output stands: reals in one vector, integers and booleans in another.

        Outputs of one instance and type stand side by side in the order of their value references.
        """
        slots: dict[tuple[str, str], tuple[str, int]] = {}
        taken = {"Real": 0, "Integer": 0}
        for name in self.order:
            ports = self.scene.instances[name].fmu.ports.values()
            for kind in SIZES:
                for port in ports:
                    if port.causality == "output" and port.kind == kind:
                        vector = "Real" if kind == "Real" else "Integer"
                        slots[name, port.name] = (kind, taken[vector])
                        taken[vector] += 1
        for drive in self.scene.drives:
            slots[drive.instance, drive.variable] = ("Real", taken["Real"])
            taken["Real"] += 1
        return slots

    # ---- life cycle

    def __enter__(self) -> "Master":
        self._interrupts = ExitStack()
        self.interrupted = self._interrupts.enter_context(_interrupt_flag())
        try:
            for name in self.order:
                self.slaves[name] = borrow(self.scene.instances[name].fmu, name)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_: Any) -> None:
        for slave in self.slaves.values():
            give_back(slave)
        self.slaves.clear()
        self._interrupts.close()

    def initialize(self) -> None:
        """Set all values, exchange the outputs at the start until they settle, prepare the calls."""
        stop_time = self.scene.steps * self.scene.step_size
        for name in self.order:
            self.slaves[name].start(self.scene.instances[name].values, stop_time)
        self._drive(0)
        for _ in range(INITIAL_PASSES if self.lagged else 1):
            before = self.reals.copy(), self.integers.copy()
            for name in self.order:
                self._run_calls(self._inputs(name) + self._outputs(name))
            if np.array_equal(before[0], self.reals) and np.array_equal(before[1], self.integers):
                break
        else:
            self.unsettled = bool(self.lagged)
        for name in self.order:
            self.slaves[name].finish_initialization()
        step_size = ctypes.c_double(self.scene.step_size)
        self._calls = []
        for name in self.order:
            step = self.slaves[name].step_call(self._time, step_size)
            self._calls += [
                *self._inputs(name),
                (self.slaves[name], "fmi2DoStep", step),
                *self._outputs(name),
            ]

    def _run_calls(self, calls: list[tuple[Slave, str, Call]]) -> None:
        for slave, action, (function, arguments) in calls:
            status = function(*arguments)
            if status > 1:
                raise slave.failed(status, action, self._time.value)

    def _drive(self, steps: int) -> None:
        """Set the driven inputs to what they are after a number of steps."""
        revolution = steps / self.scene.steps_per_revolution
        for drive in self.scene.drives:
            self.reals[self.slots[drive.instance, drive.variable][1]] = drive.at(revolution)

    def _address(self, kind: str, slot: int) -> int:
        vector: NDArray[Any] = self.reals if kind == "Real" else self.integers
        return int(vector.ctypes.data) + slot * SIZES[kind]

    def _inputs(self, name: str) -> list[tuple[Slave, str, Call]]:
        """Calls that hand over an instance's wired inputs, straight from where their sources wrote them.

        Sources that stand side by side go in one call.
        """
        instance, slave = self.scene.instances[name], self.slaves[name]
        wired = [
            (*self.slots[wire.source], instance.fmu.ports[wire.sink[1]].reference)
            for wire in self.scene.wires
            if wire.sink[0] == name
        ] + [
            (*self.slots[name, drive.variable], instance.fmu.ports[drive.variable].reference)
            for drive in self.scene.drives
            if drive.instance == name
        ]
        runs: list[tuple[str, int, list[int]]] = []
        for kind, slot, reference in sorted(wired):
            if runs and runs[-1][0] == kind and runs[-1][1] + len(runs[-1][2]) == slot:
                runs[-1][2].append(reference)
            else:
                runs.append((kind, slot, [reference]))
        return [
            (slave, f"fmi2Set{kind}", slave.value_call("Set", kind, references, self._address(kind, slot)))
            for kind, slot, references in runs
        ]

    def _outputs(self, name: str) -> list[tuple[Slave, str, Call]]:
        """Calls that fetch an instance's outputs, one for each type."""
        slave = self.slaves[name]
        calls = []
        for kind in SIZES:
            mine = [
                (slot, self.scene.instances[name].fmu.ports[variable].reference)
                for (instance, variable), (its_kind, slot) in self.slots.items()
                if instance == name
                and its_kind == kind
                and self.scene.instances[name].fmu.ports[variable].causality == "output"
            ]
            if mine:
                address = self._address(kind, mine[0][0])
                call = slave.value_call("Get", kind, [reference for _, reference in mine], address)
                calls.append((slave, f"fmi2Get{kind}", call))
        return calls

    # ---- stepping

    def run(self, rows: int, write: Block, progress: Callable[[int], None]) -> None:
        """Step to the end; hand over every `rows` samples, and what there is when it ends early.

        Raises:
            LoomfmuError: an FMU failed, or gave a value that is not finite
            Interrupted: Ctrl-C, after the step under way
        """
        times = np.empty(rows)
        reals = np.empty((rows, len(self.reals)))
        integers = np.empty((rows, len(self.integers)), dtype=np.int32)
        times[0], reals[0], integers[0] = 0.0, self.reals, self.integers
        filled = 1

        def flush() -> None:
            self._check_finite(times[:filled], reals[:filled])
            write(times[:filled], reals[:filled], integers[:filled])

        calls = [(function, arguments) for _slave, _action, (function, arguments) in self._calls]
        step_size, time = self.scene.step_size, self._time
        driven = bool(self.scene.drives)
        interrupted = self.interrupted
        try:
            for step in range(self.scene.steps):
                if filled == rows:
                    flush()
                    filled = 0
                    progress(step)
                time.value = step * step_size
                if driven:
                    self._drive(step + 1)
                for function, arguments in calls:
                    if (status := function(*arguments)) > 1:
                        raise self._failure(arguments, status)
                times[filled] = (step + 1) * step_size
                reals[filled] = self.reals
                integers[filled] = self.integers
                filled += 1
                if interrupted:
                    raise Interrupted
        finally:
            if filled:
                flush()
        progress(self.scene.steps)

    def _failure(self, arguments: tuple[Any, ...], status: int) -> LoomfmuError:
        """What to raise for the call with these arguments."""
        slave, action, _call = next(call for call in self._calls if call[2][1] is arguments)
        return slave.failed(status, action, self._time.value)

    def _check_finite(self, times: NDArray[np.float64], reals: NDArray[np.float64]) -> None:
        """No NaN or infinity may pass for a result."""
        with np.errstate(over="ignore", invalid="ignore"):
            if math.isfinite(float(reals.sum())):
                return
        bad = np.argwhere(~np.isfinite(reals))
        if len(bad):
            row, column = bad[0]
            name = next(
                ".".join(key) for key, (kind, slot) in self.slots.items() if kind == "Real" and slot == column
            )
            raise LoomfmuError(f"{name} at {times[row]:.9g} s is {reals[row, column]}")

    def warnings(self) -> list[str]:
        """What the FMUs warned of."""
        return (
            [
                f"{slave.name}: {text}"
                for slave in self.slaves.values()
                for status, text in slave.messages
                if status == 1
            ]
            + [f"loop: {wire} carries the value of the step before" for wire in self.lagged]
            + [f"loop: the values at the start have not settled after {INITIAL_PASSES} exchanges"]
            * self.unsettled
        )


@contextmanager
def _interrupt_flag() -> Iterator[list[int]]:
    """Ctrl-C fills a list instead of raising: an exception inside a live FMU would be fatal to it."""
    interrupted: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield interrupted
        return
    previous = signal.signal(signal.SIGINT, lambda number, _frame: interrupted.append(number))
    try:
        yield interrupted
    finally:
        signal.signal(signal.SIGINT, previous)
