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

    Where only loops are left, the first instance of the scene that lies on a loop fed by nothing but itself
    goes next; its wires from instances that have not been stepped yet carry the values of the step before.

    >>> step_order(["a", "b"], [Wire(("b", "y"), ("a", "u"))])
    (['b', 'a'], [])
    """
    waiting: Mapping[str, list[Wire]] = {name: [] for name in instances}
    for wire in wires:
        waiting[wire.sink[0]].append(wire)
    order: dict[str, None] = {}
    lagged: list[Wire] = []
    remaining = dict.fromkeys(waiting)
    while remaining:
        # an instance wired to itself is a loop of its own
        sources = {
            name: {w.source[0] for w in waiting[name]} & remaining.keys() - {name} for name in remaining
        }
        ready = [name for name in remaining if not sources[name]]
        name = ready[0] if ready else _first_in_a_loop(sources)
        lagged += [wire for wire in waiting[name] if wire.source[0] not in order]
        order[name] = None
        del remaining[name]
    return list(order), lagged


def _first_in_a_loop(sources: Mapping[str, set[str]]) -> str:
    """The first instance that lies upstream of everything upstream of it: no other loop feeds its own."""
    upstream = {name: _upstream(name, sources) for name in sources}
    return next(name for name in sources if all(name in upstream[other] for other in upstream[name]))


def _upstream(name: str, sources: Mapping[str, set[str]]) -> set[str]:
    """All that feeds an instance, near or far; itself if it lies on a loop."""
    found: set[str] = set()
    front = set(sources[name])
    while front:
        found |= front
        front = set().union(*(sources[each] for each in front)) - found
    return found
