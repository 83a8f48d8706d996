"""Derivatives of a run: each component steps with dual numbers, which its wires carry along.

The duals are those of the components' own source, in the libraries of their native FMUs. A state's derivative
goes from step to step with the state. What is computed from the samples of a run, such as a claim, is
differentiated along theirs.
"""

import ctypes
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..declaring.variables import EXTREMES, Component, variables_of
from ..errors import LoomfmuError
from ..fmi.native.libraries import needed_library
from ..traces import Recording
from .master.grid import Grid
from .master.steppers import SOURCE, arrays, fields
from .planning.pruning import prune
from .scenes.graph import step_order
from .scenes.instances import Instance
from .scenes.scene import Scene, differing

Floats = NDArray[np.float64]
Seeds = Mapping[tuple[str, str], float]  # derivatives of start values, by instance and variable
SHARE = 2.0**-17  # of a signal, by which samples move at most: the square of it is 6e-11
KINK = 1e-4  # of a slope: sides that differ more are those of a kink
TYPES = {float: "d", int: "q", bool: "?"}
KINDS: dict[type, Any] = {float: ctypes.c_double, int: ctypes.c_int64, bool: ctypes.c_bool}
SIZES = {float: 16, int: 8, bool: 1}  # bytes


class _Dual(ctypes.Structure):
    _fields_ = [
        *fields(size="size_t"),
        ("offsets", ctypes.POINTER(ctypes.c_size_t)),
        *fields(part="void_p"),
    ]


class _Copy(ctypes.Structure):
    _fields_ = fields(source="void_p", to="void_p", size="size_t")


class _Stepped(ctypes.Structure):
    _fields_ = [*fields(part="void_p", component="void_p"), *arrays("copies"), *fields(placed="size_t")]


class _Driven(ctypes.Structure):
    _fields_ = fields(to="void_p", type="int64")


class _Plan(ctypes.Structure):
    _fields_ = arrays("parts", "driven", "kept")


class _Instance:
    """A component with dual numbers, in memory."""

    def __init__(self, instance: Instance, component: type[Component]):
        fmu = instance.fmu.in_flavour("native")
        if not fmu.built or fmu.flavour != "native":
            raise LoomfmuError(f"{instance.name} has no derivatives: only our own native FMUs have them")
        library = ctypes.PyDLL(str(fmu.library))
        library.loomfmu_dual.restype = ctypes.POINTER(_Dual)
        table = library.loomfmu_dual().contents
        self.name, self.part, self.library = instance.name, table.part, library
        self.memory = np.zeros(-(-table.size // 8))  # doubles are aligned as it needs
        self.variables = {each.name: each for each in variables_of(component)}
        first = self.memory.ctypes.data
        self.places = {name: first + table.offsets[n] for n, name in enumerate(self.variables)}
        self._start: tuple[Instance, Floats] | None = None  # what was set last, without derivatives

    def set(self, instance: Instance, seeds: Seeds) -> None:
        """Give every variable its start value, and a parameter its derivative."""
        if not seeds and self._start and self._start[0] is instance:
            self.memory[:] = self._start[1]
            return
        self.memory[:] = 0.0
        for name, each in self.variables.items():
            value = each.type(instance.values.get(name, each.start))
            numbers = [value, seeds.get((self.name, name), 0.0)] if each.type is float else [value]
            for n, number in enumerate(numbers):
                KINDS[each.type].from_address(self.places[name] + 8 * n).value = number
        self._start = None if seeds else (instance, self.memory.copy())


@dataclass(frozen=True)
class Direction:
    """A run, and the derivatives of its samples by one value; `seeds` are those of its parameters."""

    recording: Recording
    time: Floats
    reals: Floats
    seeds: Seeds

    def slope(self, function: Callable[[Recording], Sequence[float] | Floats]) -> Floats:
        """Return the derivatives of numbers that are computed from the run; to greater values at a kink."""
        _below, above = self.sides(function)
        return np.asarray(above)

    def sides(self, function: Callable[[Recording], Sequence[float] | Floats]) -> Floats:
        """Return the derivatives of numbers that are computed from the run, by its value: two rows.

        They are those on the side of lesser and of greater values, which differ at a kink alone. The samples
        move along their derivatives by some millionths of their size, either way: the run itself is not
        repeated.
        """
        here = self.recording
        sizes = np.max(np.abs(here.reals), axis=0)
        moves = np.max(np.abs(self.reals), axis=0)[sizes > 0.0] / sizes[sizes > 0.0]
        greatest = max(float(np.max(moves, initial=0.0)), float(np.max(np.abs(self.time))) / here.time[-1])
        for (name, variable), seed in self.seeds.items():
            if value := abs(float(here.start(name, variable) or 0.0)):
                greatest = max(greatest, abs(seed) / value)
        step = SHARE / (greatest or 1.0)
        before, at, after = (
            np.asarray(function(here if not side else self._moved(side * step)), dtype=float)
            for side in (-1.0, 0.0, 1.0)
        )
        behind, ahead, both = (at - before) / step, (after - at) / step, (after - before) / (2.0 * step)
        kinked = np.abs(ahead - both) > KINK * np.maximum(np.abs(ahead), np.abs(both))
        return np.where(kinked, [behind, ahead], both)

    def _moved(self, step: float) -> Recording:
        here, seeds = self.recording, self.seeds

        def parameter(name: str, variable: str) -> Any:
            value, seed = here.start(name, variable), seeds.get((name, variable), 0.0)
            return value + step * seed if value is not None and seed else value

        return here.moved(here.time + step * self.time, here.reals + step * self.reals, parameter)


class Tangents:
    """The components that give some signals, with dual numbers. Raises LoomfmuError where there are none."""

    def __init__(self, scene: Scene, signals: Sequence[str]):
        self._pruned = needed = prune(scene, signals, keep_shafts=True)
        scene = needed.scene
        order, lagged = step_order(scene.instances, scene.wires)
        if lagged:
            raise LoomfmuError(f"{scene.name}: {lagged[0]} closes a loop, which has no derivatives here")
        self._instances = [_dual(scene.instances[name]) for name in order]
        self._named = {each.name: each for each in self._instances}
        self._signals = signals
        self._library = ctypes.PyDLL(str(needed_library(SOURCE)))
        copies = [
            (_Copy * len(wires))(*wires)
            for wires in (
                [
                    _Copy(self._place(wire.source), self._place(wire.sink), self._size(wire.source))
                    for wire in scene.wires
                    if wire.sink[0] == name
                ]
                for name in order
            )
        ]
        parts = [
            _Stepped(each.part, each.memory.ctypes.data, ctypes.addressof(wires), len(wires), 0)
            for each, wires in zip(self._instances, copies, strict=True)
        ]
        self._holding = [n for n, name in enumerate(order) if _holds(scene.instances[name])]
        driven = [
            _Driven(self._place(sink), ord(TYPES[self._named[sink[0]].variables[sink[1]].type]))
            for sink in ((drive.instance, drive.variable) for drive in scene.drives)
        ]
        self._drives = scene.drives
        self._kept = [
            (signal, place)
            for signal in signals
            if self._named[signal.partition(".")[0]].variables[signal.partition(".")[2]].type is float
            for place in [self._place(tuple(signal.split(".", 1)))]
        ]
        arrays = (
            (_Stepped * len(parts))(*parts),
            (_Driven * len(driven))(*driven),
            (ctypes.c_void_p * len(self._kept))(*(place for _signal, place in self._kept)),
        )
        self._memory, self._parts = (copies, arrays), arrays[0]
        self._plan = _Plan(*(part for array in arrays for part in (ctypes.addressof(array), len(array))))

    def _place(self, name: tuple[str, ...]) -> int:
        place: int = self._named[name[0]].places[name[1]]
        return place

    def _size(self, name: tuple[str, str]) -> int:
        return SIZES[self._named[name[0]].variables[name[1]].type]

    def along(self, scene: Scene, grid: Grid, seeds: Seeds, recording: Recording) -> Direction:
        """Repeat a recorded run of the scene, which differs in values alone, along some seeds.

        Communication points stay where they are in revolutions, so that their times change with the speed.
        """
        stretch = 0.0 if scene.step is not None else -seeds.get(("shaft", "speed"), 0.0) / scene.speed
        span = grid.span(0, grid.steps)
        rows = self._rows(scene, grid, seeds, stretch * span.starts, stretch * span.sizes)
        reals = np.zeros_like(recording.reals)
        for place, (signal, _address) in enumerate(self._kept):
            reals[:, recording.column(signal)] = rows[: len(reals), place, 1]
        if not math.isfinite(float(reals.sum())):
            raise LoomfmuError(f"{scene.name}: the derivative is not finite")
        return Direction(recording, stretch * recording.time, reals, seeds)

    @contextmanager
    def placed(self) -> Iterator[int]:
        """Place components that hold extremes at each time instead of stepping; the plan's address for C."""
        for place in self._holding:
            self._parts[place].placed = 1
        yield ctypes.addressof(self._plan)
        for place in self._holding:
            self._parts[place].placed = 0

    @property
    def driven(self) -> bool:
        """Return whether inputs follow tables."""
        return bool(self._drives)

    def is_whole(self, name: str, variable: str) -> bool:
        """Return whether a variable of an instance is no real number."""
        return self._named[name].variables[variable].type is not float

    def images(self, scene: Scene) -> Iterator[tuple[str, Floats, Floats, Mapping[str, int]]]:
        """Yield each instance's memory, a copy of it at the start of a scene, and the places of variables."""
        for each in self._instances:
            each.set(scene.instances[each.name], {})
            yield each.name, each.memory, each.memory.copy(), each.places

    def _rows(self, scene: Scene, grid: Grid, seeds: Seeds, starts: Floats, sizes: Floats) -> Floats:
        """Step along some seeds, and derivatives of the starts and the sizes of the steps: values and
        derivatives of what is kept, (samples, signals, 2)."""
        for each in self._instances:
            each.set(scene.instances[each.name], seeds)
        span = grid.span(0, grid.steps)
        driven = np.zeros((grid.steps + 1, len(self._drives)))
        for column, drive in enumerate(self._drives):
            driven[:, column] = drive.along(np.concatenate([[0.0], span.turns]))
        times = [np.stack(each, axis=1) for each in ((span.starts, starts), (span.sizes, sizes))]
        rows = np.empty((grid.steps + 1, len(self._kept), 2))
        self._library.step_tangents(
            ctypes.byref(self._plan),
            ctypes.c_int64(grid.steps),
            *(ctypes.c_void_p(each.ctypes.data) for each in (*times, driven, rows)),
        )
        return rows


def _dual(instance: Instance) -> _Instance:
    component = instance.fmu.component
    if component is None:
        raise LoomfmuError(f"{instance.name} has no derivatives: only our own native FMUs have them")
    return _Instance(instance, component)


def _holds(instance: Instance) -> bool:
    component = instance.fmu.component
    return component is not None and component.keeps == EXTREMES


def seeds_of(scene: Scene, moved: Scene, change: float) -> dict[tuple[str, str], float]:
    """Return the derivatives of all start values, from a scene that was read with another value."""
    return {
        (name, variable): (float(after) - float(before)) / change
        for name, variable, before, after in differing(scene, moved)
    }
