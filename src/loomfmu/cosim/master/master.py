"""The master: steps the instances of a scene in dependency order.

Within a step every source is stepped before its sinks and hands over the values it has at the end of
the step, so that a system without loops has no coupling error. Wires that close a loop carry the values
of the step before, or are iterated until both ends agree (`coupling = "iterated"`).
"""

import ctypes
import math
from collections.abc import Callable, Collection, Mapping
from contextlib import AbstractContextManager, ExitStack, nullcontext
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import LoomfmuError
from ..importing.pool import borrow, give_back
from ..importing.process import Limits
from ..importing.slave import NEEDS_TOOL, Ended, Slave
from ..scenes.graph import step_order
from ..scenes.scene import Scene
from ..scenes.settings import ITERATED
from .endless import interruptible
from .grid import Grid, Span, uniform
from .guards import directory_kept, exit_named
from .loops import Growth, iteration
from .signals import ConstantShaft, Signals
from .start import Start
from .steppers import Action, Memory, Rows, Stepper, stepper

PATIENCE = 0.05  # s between looks for Ctrl-C
NOTHING = nullcontext()  # to be kept
HOLD = 0.5  # s that samples wait at most before they are handed over, if steps are not longer

Reals = NDArray[np.float64]
Integers = NDArray[np.int32]
Block = Callable[[Reals, Reals, Integers], None]


class Interrupted(Exception):
    """The user has interrupted the run."""


@dataclass
class _Calls:
    """Prepared calls of some instances, and what takes steps with them."""

    slaves: list[Slave]
    inputs: dict[str, list[Action]]
    outputs: dict[str, list[Action]]
    stepper: Stepper | None = None


class Master:
    """The instances of a scene, coupled. Use it in a `with` statement: it gives them back.

    `steps` is the number of steps that a run took, `ended` the FMU that ended it early, if one did.

    `fetched` are the outputs that are read from the FMUs, all by default; `shafts` the main shafts that
    need no FMU; `compiled` says whether steps are taken in C; by default they are where that is available.
    Within the `with` statement Ctrl-C does not raise, it fills `interrupted`.
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
        self.order, self.lagged = step_order(scene.instances, scene.wires)
        self.signals = Signals(scene, self.order, fetched, dict(shafts or {}))
        self.slots = self.signals.slots
        self.slaves: dict[str, Slave] = {}
        self._ours = all(instance.fmu.trusted for instance in scene.instances.values())
        self.interrupted = ctypes.c_int32(0)
        self._compiled = compiled
        self.steps = 0
        self.ended: Ended | None = None
        self._start_warnings: list[str] = []
        self._part = 1  # steps between looks for Ctrl-C
        self._calls: _Calls | None = None  # as they were prepared for the last run

    # ---- life cycle

    def loaded(self, scene: Scene, grid: Grid, shafts: Mapping[str, ConstantShaft]) -> "Master":
        """For the next run: the same scene with other values, and another grid."""
        self.scene, self.grid = scene, grid
        self.signals.shafts = shafts
        return self

    def __enter__(self) -> "Master":
        self._guards = ExitStack()
        self.interrupted.value, self.steps, self.ended = 0, 0, None
        scene = self.scene
        inside = [name for name in self.order if not scene.isolates(name)]
        # one that is given as a file may be live, too
        live = any(scene.instances[name].fmu.flavour != "native" for name in inside)
        self._guards.enter_context(interruptible(self.interrupted, scene.step_timeout, live))
        try:
            self._limits = Limits(scene.step_timeout, scene.run_timeout, self.interrupted)
            self._guards.enter_context(exit_named(inside))
            for name in self.order:
                limits, fmu = None if name in inside else self._limits, scene.instances[name].fmu
                with NOTHING if fmu.trusted else directory_kept():
                    self.slaves[name] = borrow(fmu, name, limits)
        except BaseException as error:
            self.__exit__(type(error))
            raise
        return self

    def __exit__(self, kind: type[BaseException] | None = None, *_: Any) -> None:
        with self._directory_kept():
            for slave in self.slaves.values():
                give_back(slave)
        self.slaves.clear()
        self._guards.close()
        if kind is None and self.interrupted.value:  # it came after the last check
            raise KeyboardInterrupt("interrupted")

    def _directory_kept(self) -> AbstractContextManager[None]:
        """Go back to the working directory that an FMU has left, as ours never do."""
        return NOTHING if self._ours else directory_kept()

    def initialize(self) -> None:
        """Set all values, exchange the outputs at the start until they settle, prepare the calls.

        Raises:
            LoomfmuError: an FMU refuses its values, or fails
            KeyboardInterrupt: Ctrl-C while an isolated FMU did not answer
        """
        try:
            with self._directory_kept():
                self._initialize()
        except LoomfmuError:
            if self.interrupted.value:
                raise KeyboardInterrupt("interrupted before the first step") from None
            raise

    def _initialize(self) -> None:
        signals = self.signals
        for name, slave in self.slaves.items():
            slave.start(self.scene.instances[name].values, self.grid.stop_time, self.grid.start)
        signals.begin(self.grid.start)
        calls = self._prepared()
        start = Start(self.slaves, calls.inputs, calls.outputs, self.lagged, signals, self.grid.start)
        start.make()
        self._start_warnings = start.warnings
        self._growth = Growth(self.lagged, signals.real_slots(self.lagged))
        if calls.stepper is None:
            calls.stepper = self._make_stepper(calls)
        self._stepper = calls.stepper
        # a loop has learnt from this run, and the calls of some instances serve one run alone
        lasts = all(slave.pooled and slave.keeps_calls for slave in self.slaves.values())
        self._calls = calls if lasts and not self.lagged else None

    @property
    def value_calls(self) -> tuple[dict[str, list[Action]], dict[str, list[Action]]]:
        """The calls that hand over the inputs of each instance, and its outputs, once it is initialized."""
        calls = self._prepared()
        return calls.inputs, calls.outputs

    def _prepared(self) -> "_Calls":
        """The calls that hand over inputs and outputs: those of the run before for the same instances."""
        slaves, signals = list(self.slaves.values()), self.signals
        if self._calls and all(a is b for a, b in zip(self._calls.slaves, slaves, strict=True)):
            return self._calls
        return _Calls(
            slaves,
            {name: signals.inputs(name, slave) for name, slave in self.slaves.items()},
            {name: signals.outputs(name, slave) for name, slave in self.slaves.items()},
        )

    def _make_stepper(self, calls: "_Calls") -> Stepper:
        """Return the stepper that makes the calls of all instances in their order."""
        signals = self.signals
        memory = Memory(
            signals.reals,
            signals.integers,
            signals.driven_slots(real=True),
            signals.driven_slots(real=False),
            self.interrupted,
        )
        actions = {
            name: [
                *calls.inputs[name],
                Action(slave, slave.step_call(memory.time, memory.size)),
                *calls.outputs[name],
            ]
            for name, slave in self.slaves.items()
        }
        if self.lagged and self.scene.coupling == ITERATED:
            slots = signals.real_slots(self.lagged)
            return iteration(actions, self.lagged, slots, memory, self._compiled)
        in_order = [action for each in actions.values() for action in each]
        return stepper(in_order, memory, self._compiled)

    # ---- stepping

    def run(self, rows: int, write: Block, progress: Callable[[int], None]) -> None:
        """Step to the end of the run, or until an FMU ends it.

        Samples are handed over when there are `rows` of them, or after half a second those that there are.

        Raises:
            LoomfmuError: an FMU failed, or gave a value that is not finite, or a loop is unstable
            Interrupted: Ctrl-C, after the step under way
        """
        times = np.empty(rows)
        values = Rows(
            np.empty((rows, len(self.signals.reals))),
            np.empty((rows, len(self.signals.integers)), dtype=np.int32),
        )
        times[0], values.reals[0], values.integers[0] = (
            self.grid.start,
            self.signals.reals,
            self.signals.integers,
        )
        handed, filled, step = 0, 1, 0
        due = perf_counter() + HOLD
        failure: LoomfmuError | None = None
        try:
            while step < self.grid.steps and not failure:
                if filled == rows or perf_counter() > due:
                    block = slice(handed, filled)
                    handed = filled = filled % rows  # first: what is found bad is not handed over again
                    self._hand_over(times[block], values.reals[block], values.integers[block], write)
                    progress(step)
                    due = perf_counter() + HOLD
                span = self.grid.span(step, min(rows - filled, self.grid.steps - step, self._part))
                before = perf_counter()
                taken, failure = self._advance(span, values.after(filled))
                grown = self._part * min(8.0, PATIENCE / max(perf_counter() - before, 1e-6))
                self._part = max(1, min(rows, int(grown)))
                times[filled : filled + taken] = span.ends[:taken]
                filled += taken
                step += taken
                if self.interrupted.value:
                    raise Interrupted
        finally:
            if filled > handed:
                block = slice(handed, filled)
                self._hand_over(times[block], values.reals[block], values.integers[block], write)
        self.steps = step
        if isinstance(failure, Ended):
            self.ended = failure if step < self.grid.steps else None
        elif failure:
            raise failure
        progress(self.grid.steps)

    def _advance(self, span: Span, rows: Rows) -> tuple[int, LoomfmuError | None]:
        """Take the steps of a span, write a row for each; how many were taken, and why not all."""
        driven = self.signals.driven(span.turns)
        with self._directory_kept():
            taken, failure = self._stepper.advance(span, driven, rows)
        if failure is None and taken and (reason := self._limits.passed):
            failure = LoomfmuError(f"{self.scene.name} at {span.ends[taken - 1]:.9g} s: {reason}")
        self.signals.turn_shafts((span.starts + span.sizes)[:taken], rows.reals[:taken])
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
        """Return the warnings of the FMUs and of the run."""
        lagged = [] if self.scene.coupling == ITERATED else self.lagged
        return (
            [line for slave in self.slaves.values() for line in slave.warnings()]
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
