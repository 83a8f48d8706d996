"""The master: steps the instances of a scene in dependency order.

Within a step every source is stepped before its sinks and hands over the values it has at the end of
the step, so that a system without loops has no coupling error. Wires that close a loop carry the values
of the step before, or are iterated until both ends agree (`coupling = "iterated"`).
"""

import ctypes
import math
from collections.abc import Callable, Collection, Mapping
from contextlib import ExitStack
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import LoomfmuError
from ..importing.pool import borrow, give_back
from ..importing.process import Limits
from ..importing.slave import NEEDS_TOOL, SIZES, Ended, Slave
from ..scenes.graph import step_order
from ..scenes.scene import ITERATED, Scene
from .constant_shaft import ConstantShaft
from .grid import Grid, Span, uniform
from .guards import directory_kept, exit_named, interrupt_fills
from .loops import Growth, Iteration
from .start import Slot, Start
from .steppers import Action, Driven, Memory, Stepper, stepper

PATIENCE = 0.05  # s between looks for Ctrl-C

Reals = NDArray[np.float64]
Integers = NDArray[np.int32]
Block = Callable[[Reals, Reals, Integers], None]


class Interrupted(Exception):
    """The user asked for the end of the run."""


class Master:
    """The instances of a scene, coupled. Use it in a `with` statement: it gives them back.

    `steps` are those that a run has taken, `ended` tells of an FMU that ended it before its time.

    `fetched` are the outputs that are read from the FMUs, all by default; `shafts` the main shafts that
    need no FMU; `compiled` tells whether the steps are taken in C: where that can be had, by default. Within
    the `with` statement Ctrl-C does not raise, it fills `interrupted`.
    """

    def __init__(
        self,
        scene: Scene,
        grid: Grid | None = None,
        fetched: Collection[tuple[str, str]] | None = None,
        shafts: Mapping[str, ConstantShaft] | None = None,
        compiled: bool | None = None,
    ):
        self.scene = scene
        self.grid = grid or uniform(scene)
        self.shafts = dict(shafts or {})
        self.order, self.lagged = step_order(scene.instances, scene.wires)
        self.slots = self._slots(fetched)
        self.reals = np.zeros(max(1, sum(1 for kind, _ in self.slots.values() if kind == "Real")))
        self.integers = np.zeros(
            max(1, sum(1 for kind, _ in self.slots.values() if kind != "Real")), dtype=np.int32
        )
        self.slaves: dict[str, Slave] = {}
        self.interrupted = ctypes.c_int32(0)
        self._compiled = compiled
        self.steps = 0
        self.ended: Ended | None = None
        self._start_warnings: list[str] = []
        self._time, self._size = ctypes.c_double(0.0), ctypes.c_double(0.0)
        self._growth = Growth(self.lagged, self._lagged_slots())

    def _slots(self, fetched: Collection[tuple[str, str]] | None) -> dict[tuple[str, str], Slot]:
        """Where the value of each output stands: reals in one vector, integers and booleans in another.

        Outputs of one instance and type stand side by side in the order of their value references.
        """
        slots: dict[tuple[str, str], Slot] = {}
        taken = {"Real": 0, "Integer": 0}

        def take(instance: str, variable: str, kind: str) -> None:
            vector = "Real" if kind == "Real" else "Integer"
            slots[instance, variable] = (kind, taken[vector])
            taken[vector] += 1

        for name in self.order:
            ports = self.scene.instances[name].fmu.ports.values()
            for kind in SIZES:
                for port in ports:
                    wanted = fetched is None or (name, port.name) in fetched
                    if port.causality == "output" and port.kind == kind and wanted:
                        take(name, port.name, kind)
        for drive in self.scene.drives:
            take(drive.instance, drive.variable, drive.kind)
        for name in self.shafts:
            for variable in ("angle", "velocity", "acceleration"):
                take(name, variable, "Real")
        return slots

    def _lagged_slots(self) -> list[int]:
        """Where the real values of the wires stand that close a loop."""
        slots = dict.fromkeys(self.slots[wire.source] for wire in self.lagged)
        return [slot for kind, slot in slots if kind == "Real"]

    # ---- life cycle

    def __enter__(self) -> "Master":
        self._guards = ExitStack()
        self._guards.enter_context(interrupt_fills(self.interrupted))
        try:
            scene = self.scene
            self._limits = Limits(scene.step_timeout, scene.run_timeout, self.interrupted)
            inside = [name for name in self.order if not scene.isolates(name)]
            self._guards.enter_context(exit_named(inside))
            for name in self.order:
                limits = None if name in inside else self._limits
                with directory_kept():
                    self.slaves[name] = borrow(scene.instances[name].fmu, name, limits)
        except BaseException as error:
            self.__exit__(type(error))
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None = None, *_: Any) -> None:
        with directory_kept():
            for slave in self.slaves.values():
                give_back(slave)
        self.slaves.clear()
        self._guards.close()
        if kind is None and self.interrupted.value:  # it came when nobody looked any more
            raise KeyboardInterrupt("interrupted")

    def initialize(self) -> None:
        """Set all values, exchange the outputs at the start until they settle, prepare the calls.

        Raises:
            LoomfmuError: an FMU refuses its values, or fails
            KeyboardInterrupt: Ctrl-C while an isolated FMU did not answer
        """
        try:
            with directory_kept():
                self._initialize()
        except LoomfmuError:
            if self.interrupted.value:
                raise KeyboardInterrupt("interrupted before the first step") from None
            raise

    def _initialize(self) -> None:
        for name in self.order:
            self.slaves[name].start(self.scene.instances[name].values, self.grid.stop_time)
        driven = self._driven(np.zeros(1))
        self.reals[self._driven_slots(real=True)] = driven.reals[0]
        self.integers[self._driven_slots(real=False)] = driven.integers[0]
        self._turn_shafts(np.zeros(1), self.reals[np.newaxis, :])
        start = Start(
            self.slaves,
            {name: self._inputs(name) for name in self.order},
            {name: self._outputs(name) for name in self.order},
            self.scene.wires,
            self.lagged,
            self.slots,
            self.reals,
            self.integers,
        )
        start.make()
        self._start_warnings = start.warnings
        self._stepper = self._make_stepper()

    def _make_stepper(self) -> Stepper:
        """What takes the steps: the calls of all instances in their order."""
        actions = {
            name: [
                *self._inputs(name),
                Action(self.slaves[name], self.slaves[name].step_call(self._time, self._size)),
                *self._outputs(name),
            ]
            for name in self.order
        }
        memory = Memory(
            self.reals, self.integers, self._driven_slots(real=True), self._driven_slots(real=False),
            self.interrupted,
        )  # fmt: skip
        if self.lagged and self.scene.coupling == ITERATED:
            return Iteration(actions, self.lagged, self._lagged_slots(), memory, self._time, self._size)
        in_order = [action for name in self.order for action in actions[name]]
        return stepper(in_order, memory, self._time, self._size, self._compiled)

    def _driven_slots(self, *, real: bool) -> list[int]:
        """Where the driven inputs stand among the reals, or among the integers."""
        slots = [self.slots[drive.instance, drive.variable] for drive in self.scene.drives]
        return [slot for kind, slot in slots if (kind == "Real") is real]

    def _driven(self, turns: Reals) -> Driven:
        """The driven inputs at numbers of revolutions, along the columns those of `_driven_slots`."""
        reals = [drive.along(turns) for drive in self.scene.drives if drive.kind == "Real"]
        integers = [drive.along(turns) for drive in self.scene.drives if drive.kind != "Real"]
        return Driven(
            np.array(reals, dtype=float).reshape(len(reals), len(turns)).T.copy(),
            np.array(integers, dtype=np.int32).reshape(len(integers), len(turns)).T.copy(),
        )

    def _turn_shafts(self, times: Reals, rows: Reals) -> None:
        """Write where the shafts that need no FMU stand at these times."""
        for name, shaft in self.shafts.items():
            for variable in ("angle", "velocity", "acceleration"):
                rows[:, self.slots[name, variable][1]] = shaft.values(variable, times)

    def _address(self, kind: str, slot: int) -> int:
        vector: NDArray[Any] = self.reals if kind == "Real" else self.integers
        return int(vector.ctypes.data) + slot * SIZES[kind]

    def _inputs(self, name: str) -> list[Action]:
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
            Action(slave, slave.value_call("Set", kind, references, self._address(kind, slot)))
            for kind, slot, references in runs
        ]

    def _outputs(self, name: str) -> list[Action]:
        """Calls that fetch an instance's outputs, one for each type."""
        slave, ports = self.slaves[name], self.scene.instances[name].fmu.ports
        actions = []
        for kind in SIZES:
            mine = [
                (slot, ports[variable].reference)
                for (instance, variable), (its_kind, slot) in self.slots.items()
                if instance == name and its_kind == kind and ports[variable].causality == "output"
            ]
            if mine:
                address = self._address(kind, mine[0][0])
                call = slave.value_call("Get", kind, [reference for _, reference in mine], address)
                actions.append(Action(slave, call))
        return actions

    # ---- stepping

    def run(self, rows: int, write: Block, progress: Callable[[int], None]) -> None:
        """Step to the end, the run's or that which an FMU makes of it; hand over every `rows` samples.

        Raises:
            LoomfmuError: an FMU failed, or gave a value that is not finite, or a loop is unstable
            Interrupted: Ctrl-C, after the step under way
        """
        times = np.empty(rows)
        reals = np.empty((rows, len(self.reals)))
        integers = np.empty((rows, len(self.integers)), dtype=np.int32)
        times[0], reals[0], integers[0] = 0.0, self.reals, self.integers
        filled, step, part = 1, 0, 1
        failure: LoomfmuError | None = None
        try:
            while step < self.grid.steps and not failure:
                if filled == rows:
                    filled = 0  # first: what is handed over and found bad is not handed over again
                    self._hand_over(times, reals, integers, write)
                    progress(step)
                span = self.grid.span(step, min(rows - filled, self.grid.steps - step, part))
                before = perf_counter()
                taken, failure = self._advance(span, reals[filled:], integers[filled:])
                grown = part * min(8.0, PATIENCE / max(perf_counter() - before, 1e-6))
                part = max(1, min(rows, int(grown)))
                times[filled : filled + taken] = span.ends[:taken]
                filled += taken
                step += taken
                if self.interrupted.value:
                    raise Interrupted
        finally:
            if filled:
                self._hand_over(times[:filled], reals[:filled], integers[:filled], write)
        self.steps = step
        if isinstance(failure, Ended):
            self.ended = failure if step < self.grid.steps else None
        elif failure:
            raise failure
        progress(self.grid.steps)

    def _advance(self, span: Span, reals: Reals, integers: Integers) -> tuple[int, LoomfmuError | None]:
        """Take the steps of a span, write a row for each; how many were taken, and why not all."""
        driven = self._driven(span.turns)
        with directory_kept():
            taken, failure = self._stepper.advance(span, driven, reals, integers)
        if failure is None and (reason := self._limits.passed):
            failure = LoomfmuError(f"{self.scene.name} at {span.ends[taken - 1]:.9g} s: {reason}")
        self._turn_shafts((span.starts + span.sizes)[:taken], reals[:taken])
        return taken, failure

    def _hand_over(self, times: Reals, reals: Reals, integers: Integers, write: Block) -> None:
        """Pass a block on, up to what is not finite: no NaN or infinity may pass for a result."""
        sound = _finite_rows(reals)
        if sound:
            write(times[:sound], reals[:sound], integers[:sound])
        self._growth.check(times, reals)
        if sound < len(reals):
            column = int(np.flatnonzero(~np.isfinite(reals[sound]))[0])
            name = next(".".join(key) for key, slot in self.slots.items() if slot == ("Real", column))
            raise LoomfmuError(f"{name} at {times[sound]:.9g} s is {reals[sound, column]}")

    def warnings(self) -> list[str]:
        """What the FMUs warned of."""
        lagged = [] if self.scene.coupling == ITERATED else self.lagged
        return (
            [
                f"{slave.name}: {text}"
                for slave in self.slaves.values()
                for status, text in slave.messages
                if status == 1
            ]
            + [f"{slave.name}: {NEEDS_TOOL}" for slave in self.slaves.values() if slave.fmu.needs_tool]
            + [f"loop: {wire} carries the value of the step before" for wire in lagged]
            + self._start_warnings
            + [f"{self.ended}; the run would have gone on to {self.grid.stop_time:.9g} s"] * bool(self.ended)
        )


def _finite_rows(reals: Reals) -> int:
    """Number of rows before the first that holds a value which is not finite."""
    with np.errstate(over="ignore", invalid="ignore"):
        if math.isfinite(float(reals.sum())):  # a tenth of the cost of looking at each
            return len(reals)
    bad = np.flatnonzero(~np.isfinite(reals).all(axis=1))
    return int(bad[0]) if len(bad) else len(reals)
