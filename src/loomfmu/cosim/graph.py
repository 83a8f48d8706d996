"""Order in which a master steps its instances."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Wire:
    """From an output to an input, each as (instance, variable)."""

    source: tuple[str, str]
    sink: tuple[str, str]

    def __str__(self) -> str:
        return f"{'.'.join(self.source)} -> {'.'.join(self.sink)}"


def step_order(instances: Iterable[str], wires: Iterable[Wire]) -> tuple[list[str], list[Wire]]:
    """Instances so that sources come before sinks, and the wires that close a loop.

    Where only loops are left, the first of the remaining instances in the scene's order goes next, and
    its wires from instances that have not been stepped yet carry the values of the step before.

    >>> step_order(["a", "b"], [Wire(("b", "y"), ("a", "u"))])
    (['b', 'a'], [])
    """
    waiting: Mapping[str, list[Wire]] = {name: [] for name in instances}
    for wire in wires:
        waiting[wire.sink[0]].append(wire)
    order: list[str] = []
    lagged: list[Wire] = []
    remaining = list(waiting)
    while remaining:
        ready = [
            name
            for name in remaining
            if all(w.source[0] in order or w.source[0] == name for w in waiting[name])
        ]
        # an instance wired to itself is a loop of its own
        name = ready[0] if ready else remaining[0]
        lagged += [wire for wire in waiting[name] if wire.source[0] not in order]
        order.append(name)
        remaining.remove(name)
    return order, lagged
