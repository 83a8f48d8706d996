"""Stepping a scene with only what some signals need, and keeping these."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from ...traces import ROWS, Channel, Recording
from ..importing.slave import Ended
from ..master.grid import Grid
from ..master.master import Integers, Interrupted, Master, Reals
from ..scenes.scene import Scene
from .pruning import Pruned, effective, prune
from .requested import output_port


class Keeper(Protocol):
    """What takes the blocks of a run."""

    def append(self, time: Reals, angle: Reals, reals: Reals, integers: Integers) -> None:
        """Keep a block: values along the rows, signals along the columns."""


@dataclass(frozen=True)
class Plan:
    """How a scene is stepped: with what, and where."""

    scene: Scene
    pruned: Pruned
    grid: Grid

    @property
    def signals(self) -> tuple[str, ...]:
        """What is kept."""
        return self.pruned.signals

    def master(self) -> Master:
        """The master of the run."""
        return Master(self.pruned.scene, self.grid, self.pruned.fetched, self.pruned.shafts)


def channels(plan: Plan, master: Master) -> list[Channel]:
    """What is kept, where the master has it, and what is said of it."""
    found = []
    for signal in plan.signals:
        port = output_port(plan.scene, signal, "record")
        instance, variable = signal.split(".")
        kind, slot = master.slots[instance, variable]
        meanings = ("no", "yes") if kind == "Boolean" else port.meanings
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
                meanings=meanings,
                first_flag=port.first_choice if port.choices else 0,
                boolean=kind == "Boolean",
            )
        )
    return found


def record(master: Master, keeper: Keeper, progress: Callable[[int], None]) -> None:
    """Step an initialized master to the end."""
    _kind, column = master.slots.get(("shaft", "angle"), ("", -1))

    def write(times: Reals, reals: Reals, integers: Integers) -> None:
        angle = reals[:, column] if column >= 0 else np.zeros(len(times))  # a scene without shaft
        keeper.append(times, angle, reals, integers)

    master.run(ROWS, write, progress)


class InMemory(NamedTuple):
    """A run that is kept in memory: how it was stepped, how far, and what its FMUs warned of."""

    recording: Recording
    plan: Plan
    steps: int
    ended: Ended | None
    warnings: list[str]


def in_memory(scene: Scene, signals: Sequence[str], grid: Grid) -> InMemory:
    """Run a scene and keep these signals in memory."""
    plan = Plan(scene, prune(scene, signals), grid)
    with plan.master() as master:
        master.initialize()
        recording = Recording(scene.name, channels(plan, master), effective(scene, plan.pruned))
        try:
            record(master, recording, lambda _step: None)
        except Interrupted:
            raise KeyboardInterrupt("interrupted") from None
        return InMemory(recording, plan, master.steps, master.ended, master.warnings())
