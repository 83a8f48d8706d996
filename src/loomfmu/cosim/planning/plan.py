"""Stepping a scene with only what some signals need, and keeping these signals."""

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ...display import printed
from ...traces import ROWS, Channel, Early, Recording, TraceWriter
from ..importing import fmus
from ..importing.slave import Ended
from ..master.grid import Grid, uniform
from ..master.master import Integers, Interrupted, Master, Reals
from ..scenes.scene import Scene
from ..scenes.settings import MAY_END
from .pruning import Effective, Pruned, prune
from .requested import Requested, beside_of, effective_wires, output_port, own_speeds


@dataclass(frozen=True)
class Plan:
    """A scene to be stepped: its FMUs, without those left out, and its grid."""

    scene: Scene
    pruned: Pruned
    grid: Grid
    effective: Effective

    @property
    def signals(self) -> tuple[str, ...]:
        """The signals that are kept."""
        return self.pruned.signals

    @property
    def wires(self) -> dict[str, str]:
        """The output that each wired input takes its values from, be it of a shaft that needs no FMU."""
        wires, kept = effective_wires(self.scene), self.pruned.scene.instances
        return {sink: source for sink, source in wires.items() if sink.partition(".")[0] in kept}


class Stepping:
    """Runs a scene with only what some signals need, as often as wanted.

    What does not depend on values is done once: what is left out, the order, where values are, the calls.
    """

    def __init__(self, requested: Requested, signals: Sequence[str]):
        scene = requested.scene
        self._pruned = pruned = prune(scene, signals)
        self._effective = Effective(scene, requested.claims, pruned)
        self._master = Master(pruned.scene, uniform(scene), pruned.fetched, pruned.shafts)
        self._scene = scene

    @cached_property
    def channels(self) -> list[Channel]:
        """The signals that are kept: their places in the master, and their descriptions for a trace."""
        return _channels(self._scene, self._pruned.signals, self._master)

    def plan(self, scene: Scene, grid: Grid) -> Plan:
        """The plan for this scene, which differs in values alone, on a grid."""
        pruned = self._pruned if scene is self._scene else self._pruned.of(scene)
        return Plan(scene, pruned, grid, self._effective.of(scene, pruned))

    @contextmanager
    def stepped(self, plan: Plan) -> Iterator[Master]:
        """The master of a run, initialized."""
        build_needed(plan.pruned.scene)
        with self._master.loaded(plan.pruned.scene, plan.grid, plan.pruned.shafts) as master:
            master.initialize()
            yield master

    def recording(self, plan: Plan) -> Recording:
        """Return an empty recording of a run."""
        running = plan.pruned.scene
        kinds = {name: instance.fmu.name for name, instance in running.instances.items()}
        return Recording(
            plan.scene.name, self.channels, plan.effective.value, plan.wires, kinds, own_speeds(running)
        )

    def in_memory(self, scene: Scene, grid: Grid) -> "InMemory":
        """Run a scene, which differs in values alone, and keep the signals in memory."""
        plan = self.plan(scene, grid)
        with self.stepped(plan) as master:
            recording = self.recording(plan)
            try:
                record(master, recording, lambda _step: None, grid.steps + 1)
            except Interrupted:
                raise KeyboardInterrupt("interrupted") from None
            early = early_end(plan, master.ended)
            recording.cut_short = early.cut_short
            return InMemory(recording, plan, master.steps, early, master.warnings())


def build_needed(scene: Scene, *, report: bool = False) -> None:
    """Build the FMUs of a scene that have yet to be built, side by side. Raises LoomfmuError."""
    missing = fmus.unbuilt(instance.fmu for instance in scene.instances.values())
    if not missing:
        return
    if report and sys.stderr.isatty():
        names = ", ".join(fmu.name for fmu in missing)
        printed.complain(f"building {len(missing)} FMUs (once): {names}")
    fmus.build(missing)


def _channels(scene: Scene, signals: Sequence[str], master: Master) -> list[Channel]:
    found = []
    for signal in signals:
        port = output_port(scene, signal, "record")
        instance, variable = signal.split(".")
        kind, slot = master.slots[instance, variable]
        meanings = ("no", "yes") if kind == "Boolean" else port.meanings
        array, place = port.in_array
        found.append(
            Channel(
                instance=instance,
                variable=variable,
                unit=port.unit,
                display=port.display,
                description=port.description,
                column=slot,
                real=kind == "Real",
                rate=port.rate,
                beside=beside_of(scene, signal),
                meanings=meanings,
                first_flag=port.numbers[0] if port.numbers else 0,
                boolean=kind == "Boolean",
                array=array,
                place=place,
            )
        )
    return found


def record(
    master: Master, keeper: Recording | TraceWriter, progress: Callable[[int], None], rows: int = ROWS
) -> None:
    """Step an initialized master to the end, and hand over blocks of so many rows.

    A block that holds the whole run belongs to the keeper; of others the memory is used again.
    """
    _kind, column = master.slots.get(("shaft", "angle"), ("", -1))

    def write(times: Reals, reals: Reals, integers: Integers) -> None:
        angle = reals[:, column] if column >= 0 else np.zeros(len(times))  # a scene without shaft
        keeper.append(times, angle, reals, integers)

    master.run(rows, write, progress)


class InMemory(NamedTuple):
    """A run that is kept in memory: how it was stepped, how far, how it ended early, warnings of its FMUs."""

    recording: Recording
    plan: Plan
    steps: int
    early: Early
    warnings: list[str]


def early_end(plan: Plan, ended: Ended | None) -> Early:
    """Return how an FMU ended a run early, if one did."""
    if ended is None:
        return Early()
    start, stop = plan.grid.start, plan.grid.stop_time
    share = f"{100.0 * (ended.time - start) / (stop - start):.3g} %"
    short = f"the run ended at {share} of its length, by {ended.name}; set {MAY_END} = true if it may"
    return Early(f"{ended.name} at {ended.time:.9g} s", "" if plan.scene.may_end else short)


def explained(plan: Plan) -> tuple[str, ...]:
    """Return what a run skips, why, and how many steps that saves."""
    kept, whole = len(plan.pruned.scene.instances), len(plan.scene.instances)
    taken, lines = plan.grid.steps, plan.pruned.skipped
    done, full = kept * taken, whole * plan.scene.steps
    ran = f"ran {kept} of {whole} FMUs, {taken} steps each"
    if done == full:
        saved = "no steps skipped" if lines else "nothing skipped"
        return (*lines, f"{ran}; {saved}")
    if not done:
        return (*lines, f"ran none of {whole} FMUs; {full} FMU steps skipped")
    ratio = f"{full / done:.3g} times fewer" if done < full else f"{100 * (done / full - 1):.2g} % more"
    return (*lines, f"{ran}: {done} FMU steps instead of {full}, {ratio}")
