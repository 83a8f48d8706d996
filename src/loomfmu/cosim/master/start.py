"""Bringing the instances of a scene to the start of a run.

Sources leave initialization before their sinks, and their outputs are read after that: many third-party
FMUs compute these only then. A sink takes them while it is still in initialization itself, since FMI does
not allow an output to be read after an input was set, without a step between.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from ...fmi.system.loops import RULE
from ..importing.slave import Slave
from ..scenes.graph import Wire, step_order
from .loops import Broyden
from .signals import Signals
from .steppers import Action, perform


@dataclass
class Start:
    """The instances in the order of their steps, and the calls that hand over their inputs and outputs.

    `time` is that of the start [s], `warnings` tell where values do not agree at the start.
    """

    slaves: Mapping[str, Slave]
    inputs: Mapping[str, Sequence[Action]]
    outputs: Mapping[str, Sequence[Action]]
    lagged: Sequence[Wire]
    signals: Signals
    time: float = 0.0
    warnings: list[str] = field(default_factory=list)

    def make(self) -> None:
        """Let all instances leave initialization, with values that agree."""
        order = list(self.slaves)
        closing = {wire.sink[0] for wire in self.lagged}
        first = next((place for place, name in enumerate(order) if name in closing), len(order))
        for name in order[:first]:
            perform(self.inputs[name], self.time)
            self.slaves[name].finish_initialization()
            perform(self.outputs[name], self.time)
        self._leave_loops(order[first:])

    def _leave_loops(self, names: Sequence[str]) -> None:
        """Instances from the first loop on agree before each of them leaves, if something has changed.

        FMUs whose outputs may change as they leave go first: third-party ones.
        """
        third_party_first = sorted(names, key=lambda name: self.slaves[name].fmu.trusted)
        wires = self.signals.scene.wires
        within = [wire for wire in wires if wire.sink[0] in names and wire.source[0] in names]
        leaving, _ = step_order(third_party_first, within)
        handed: dict[Wire, float] = {}
        settled = changed = True
        for place, name in enumerate(leaving):
            if changed:
                settled &= self._exchange([each for each in names if each in leaving[place:]])
            handed |= {wire: self._value(wire) for wire in within if wire.sink[0] == name}
            changed = self._leave(name)
        if not settled:
            self.warnings.append(
                f"loop: the start values did not converge in {RULE.most_exchanges} exchanges"
            )
        self.warnings += [
            f"loop: {wire} changed after {wire.sink[0]} had left initialization;"
            f" its sample at {self.time:.9g} s is based on the old value"
            for wire, value in handed.items()
            if not math.isclose(value, self._value(wire), rel_tol=RULE.rounding)
        ]

    def _value(self, wire: Wire) -> float:
        kind, slot = self.signals.slots[wire.source]
        return float((self.signals.reals if kind == "Real" else self.signals.integers)[slot])

    def _leave(self, name: str) -> bool:
        """Let an instance leave initialization and read its outputs; whether any value is another one now."""
        reals, integers = self.signals.reals.copy(), self.signals.integers.copy()
        self.slaves[name].finish_initialization()
        perform(self.outputs[name], self.time)
        same = np.array_equal(reals, self.signals.reals, equal_nan=True)
        return not (same and np.array_equal(integers, self.signals.integers))

    def _exchange(self, names: Sequence[str]) -> bool:
        """Hand all outputs on until loops agree with themselves; where they cannot, hand them on once."""
        calls = [action for name in names for action in (*self.inputs[name], *self.outputs[name])]
        perform(calls, self.time)
        lagged = [wire for wire in self.lagged if {wire.source[0], wire.sink[0]} <= set(names)]
        if not lagged:
            return True
        reals, integers = self.signals.reals, self.signals.integers
        first = reals.copy(), integers.copy()
        known = {name: len(self.slaves[name].messages) for name in names}
        solver = Broyden(reals, integers, self.signals.real_slots(lagged))
        if solver.settle(lambda: perform(calls, self.time)):
            return True
        reals[:], integers[:] = first
        perform(calls, self.time)
        for name, count in known.items():
            del self.slaves[name].messages[count:]  # of values that were only tried
        return False
