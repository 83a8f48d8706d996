"""The values of a run in memory, and the calls that move them between the FMUs."""

import ctypes
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..importing.calls import converting
from ..importing.conversions import SAME
from ..importing.slave import SIZES, Slave
from ..scenes.graph import Wire
from ..scenes.scene import Scene
from .steppers import Action, Rows

Floats = NDArray[np.float64]
Slot = tuple[str, int]  # the type of a value and its place among those of the type


@dataclass(frozen=True)
class ConstantShaft:
    """A main shaft that needs no FMU. Its values are those that `MainShaft` gives, to the last bit."""

    speed: float
    start_angle: float

    def values(self, variable: str, time: Floats) -> Floats | float:
        """An output of the shaft along times [s]; one number where it is the same at all of them."""
        if variable == "angle":
            return self.start_angle + self.speed * time
        return self.speed if variable == "velocity" else 0.0


class Signals:
    """The values of all outputs, of driven inputs and of shafts that need no FMU.

    `reals` and `integers` hold them, booleans among the integers; `slots` says where each is.
    """

    def __init__(
        self,
        scene: Scene,
        order: Sequence[str],
        fetched: Collection[tuple[str, str]] | None,
        shafts: Mapping[str, ConstantShaft],
    ):
        self.scene, self._order, self.shafts = scene, order, shafts
        self.slots = self._slots(fetched)
        reals = sum(kind == "Real" for kind, _ in self.slots.values())
        self.reals = np.zeros(max(1, reals))
        self.integers = np.zeros(max(1, len(self.slots) - reals), dtype=np.int32)

    def _slots(self, fetched: Collection[tuple[str, str]] | None) -> dict[tuple[str, str], Slot]:
        """Assign a place to each output: reals in one vector, integers and booleans in another.

        Outputs of one instance and type are side by side in the order of their value references.
        """
        slots: dict[tuple[str, str], Slot] = {}
        taken = {"Real": 0, "Integer": 0}

        def take(instance: str, variable: str, kind: str) -> None:
            vector = "Real" if kind == "Real" else "Integer"
            slots[instance, variable] = (kind, taken[vector])
            taken[vector] += 1

        for name in self._order:
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

    def real_slots(self, wires: Sequence[Wire]) -> list[int]:
        """Return the places of the real values of some wires."""
        slots = dict.fromkeys(self.slots[wire.source] for wire in wires)
        return [slot for kind, slot in slots if kind == "Real"]

    def driven_slots(self, *, real: bool) -> list[int]:
        """Return the places of the driven inputs among the reals or among the integers."""
        slots = [self.slots[drive.instance, drive.variable] for drive in self.scene.drives]
        return [slot for kind, slot in slots if (kind == "Real") is real]

    def begin(self, time: float) -> None:
        """The values before the first exchange: zeros, and those of driven inputs and shafts at the start."""
        self.reals[:], self.integers[:] = 0.0, 0
        if self.scene.drives:
            driven = self.driven(np.zeros(1))
            self.reals[self.driven_slots(real=True)] = driven.reals[0]
            self.integers[self.driven_slots(real=False)] = driven.integers[0]
        self.turn_shafts(np.array([time]), self.reals[np.newaxis, :])

    def driven(self, turns: Floats) -> Rows:
        """The driven inputs at numbers of revolutions, along the columns those of `driven_slots`."""
        if not self.scene.drives:
            return Rows(np.empty((len(turns), 0)), np.empty((len(turns), 0), dtype=np.int32))
        reals = [drive.along(turns) for drive in self.scene.drives if drive.kind == "Real"]
        integers = [drive.along(turns) for drive in self.scene.drives if drive.kind != "Real"]
        return Rows(
            np.array(reals, dtype=float).reshape(len(reals), len(turns)).T.copy(),
            np.array(integers, dtype=np.int32).reshape(len(integers), len(turns)).T.copy(),
        )

    def turn_shafts(self, times: Floats, rows: Floats) -> None:
        """Write the values of the shafts that need no FMU at these times."""
        for name, shaft in self.shafts.items():
            for variable in ("angle", "velocity", "acceleration"):
                rows[:, self.slots[name, variable][1]] = shaft.values(variable, times)

    def _address(self, kind: str, slot: int) -> int:
        vector: NDArray[Any] = self.reals if kind == "Real" else self.integers
        return int(vector.ctypes.data) + slot * SIZES[kind]

    def inputs(self, name: str, slave: Slave) -> list[Action]:
        """Calls that hand over an instance's wired inputs, straight from where their sources wrote them.

        Sources that are side by side go in one call.
        """
        instance = self.scene.instances[name]
        wires = [wire for wire in self.scene.wires if wire.sink[0] == name]
        wired = [
            (*self.slots[wire.source], instance.fmu.ports[wire.sink[1]].reference)
            for wire in wires
            if wire.conversion == SAME
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
            Action(slave, call)
            for kind, slot, references in runs
            for call in slave.value_calls("Set", kind, references, self._address(kind, slot))
        ] + self._converted(slave, [wire for wire in wires if wire.conversion != SAME])

    def _converted(self, slave: Slave, wires: Sequence[Wire]) -> list[Action]:
        """Calls that convert values of some wires and hand them over."""
        if not wires:
            return []
        values = (ctypes.c_double * len(wires))()
        place = ctypes.addressof(values)
        made = [
            converting(wire.conversion, self._address(*self.slots[wire.source]), values, number)
            for number, wire in enumerate(wires)
        ]
        references = [slave.fmu.ports[wire.sink[1]].reference for wire in wires]
        calls = [*made, *slave.value_calls("Set", "Real", references, place)]
        return [Action(slave, call) for call in calls]

    def outputs(self, name: str, slave: Slave) -> list[Action]:
        """Calls that fetch an instance's outputs, one for each type."""
        ports = self.scene.instances[name].fmu.ports
        actions = []
        for kind in SIZES:
            mine = [
                (slot, ports[variable].reference)
                for (instance, variable), (its_kind, slot) in self.slots.items()
                if instance == name and its_kind == kind and ports[variable].causality == "output"
            ]
            if mine:
                address = self._address(kind, mine[0][0])
                calls = slave.value_calls("Get", kind, [reference for _, reference in mine], address)
                actions += [Action(slave, call) for call in calls]
        return actions
