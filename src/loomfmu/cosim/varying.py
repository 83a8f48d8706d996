"""The parts of rows in C that differ from row to row: values, steps, and the numbers in questions."""

import ctypes
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import LoomfmuError
from ..traces import Recording
from .claims.claim import Claim
from .claims.judging import run_of
from .master.grid import uniform
from .master.rows import Judged, Judging, RowRunner, Setting, Variable, parts_of
from .planning.pruning import Pruned
from .planning.requested import parameter_of
from .scenes.instances import Instance, altered
from .scenes.scene import Scene
from .scenes.settings import SLOWEST

Floats = NDArray[np.float64]
SPEED = ("shaft", "speed")


class Steps:
    """The steps of rows: their grid, the sizes if these differ, and the table of all values for C."""

    def __init__(self, scene: Scene, takers: Mapping[Variable, int], columns: Mapping[str, Floats]):
        self.grid, self.size = uniform(scene), None
        self.possible = np.ones(len(next(iter(columns.values()))), dtype=bool)
        self.table, self.column = np.column_stack(list(columns.values())), None
        if SPEED in takers and scene.step is None:
            speed = np.abs(self.table[:, takers[SPEED]])
            self.possible = speed >= SLOWEST
            with np.errstate(divide="ignore"):
                self.size = 2.0 * math.pi / (speed * scene.steps_per_period)
            self.column = self.table.shape[1]
            self.add(self.size)

    def add(self, values: Any) -> None:
        """Add a column, or the same number for all rows."""
        self.table = np.column_stack([self.table, np.broadcast_to(values, len(self.table))])


class Questions:
    """The questions of rows, and what runs them; `named` are the parameters in each question."""

    def __init__(self, runner: RowRunner, recording: Recording, claims: Sequence[Claim]):
        self.runner, self.recording = runner, recording
        times, reals, integers = runner.samples
        recording.append(times, np.zeros(len(times)), reals, integers)
        self._run = run_of(recording)
        asked = [claim.question(recording) for claim in claims]
        self.forms = [each.forms for each in asked]
        self.named = [self._run.question(recording, each) for each in asked]
        self._words = [each.words.encode() for each in asked]

    def judging(self, composed: int | None = None) -> Judging:
        """The questions for C, with the address of the struct of composed ones."""
        numbers = [each for each, _named in self.named]
        asked = list(zip(numbers, self._words, range(len(numbers)), strict=True))
        return Judging(self._run.rules, asked, self._run.made, len(asked), composed)

    def held(self, judged: Judged, signals: Sequence[str]) -> dict[str, NDArray[Any]]:
        """The last values of some signals."""
        found = dict[str, NDArray[Any]]()
        for signal in signals:
            channel = self.recording.channel(signal)
            values = (judged.reals if channel.real else judged.integers)[:, channel.column]
            found[signal] = values.astype(bool) if channel.boolean else values
        return found


def numbers_of(
    questions: Iterable[tuple[Any, Mapping[int, str]]], takers: Mapping[Variable, int]
) -> list[Setting]:
    """Return where questions take parameters that differ from row to row."""
    return [
        (ctypes.addressof(numbers) + place * ctypes.sizeof(ctypes.c_double), takers[parts_of(name)], 0)
        for numbers, named in questions
        for place, name in named.items()
        if parts_of(name) in takers
    ]


def turned(takers: Mapping[Variable, int], pruned: Pruned) -> dict[Variable, int]:
    """The takers, with what turns by itself as a shaft would turn it."""
    found = dict(takers)
    for name, shaft in pruned.turning.items():
        for variable in ("speed", "start_angle") if shaft in pruned.shafts else ():
            found.pop((name, variable), None)
            if (shaft, variable) in takers:
                found[name, variable] = takers[shaft, variable]
    return found


def reads(scene: Scene, name: str, takers: Mapping[Variable, int]) -> bool:
    """Return whether the longest step of an instance depends on values that differ from row to row."""
    instance, read_ones = scene.instances[name], set[str]()
    component = instance.fmu.component
    if component is None:
        return True

    def read(variable: str) -> Any:
        read_ones.add(variable)
        return instance.effect(variable)

    component.shortest_event(read)
    component.longest_step(read)
    return any((name, each) in takers for each in read_ones)


def with_row(
    scene: Scene, name: str, table: Sequence[Floats], takers: Mapping[Variable, int], row: int
) -> Instance:
    """An instance with the values of a row."""
    instance = scene.instances[name]
    own = {variable: float(table[place][row]) for (owner, variable), place in takers.items() if owner == name}
    return altered(instance, values=instance.values | own)


def allows(
    claim: Claim, scene: Scene, table: Sequence[Floats], takers: Mapping[Variable, int], row: int
) -> bool:
    """Return whether a claim refuses no parameter of a row."""

    def read(name: str) -> float:
        place = takers.get(parts_of(name))
        return parameter_of(scene, name) if place is None else float(table[place][row])

    try:
        claim.check_parameters(read)
    except LoomfmuError:
        return False
    return True
