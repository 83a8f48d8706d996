"""Order in which a master steps its instances."""

import heapq
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
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
    fed: dict[str, list[Wire]] = {name: [] for name in instances}
    for wire in wires:
        fed[wire.sink[0]].append(wire)
    # an instance wired to itself is a loop of its own
    sources = {name: ({w.source[0] for w in each} & fed.keys()) - {name} for name, each in fed.items()}
    order = _order(sources)
    place = {name: number for number, name in enumerate(order)}
    end = len(order)
    lagged = [w for name in order for w in fed[name] if place.get(w.source[0], end) >= place[name]]
    return order, lagged


def _order(sources: Mapping[str, set[str]]) -> list[str]:
    """The order of instances, each given with those that feed it."""
    names = list(sources)
    rank = {name: number for number, name in enumerate(names)}
    sinks: dict[str, list[str]] = {name: [] for name in names}
    for name in names:
        for source in sources[name]:
            sinks[source].append(name)
    waiting = {name: len(sources[name]) for name in names}
    ready = [rank[name] for name in names if not waiting[name]]  # in order: a heap already
    loops = _Loops(sources, rank)
    order: list[str] = []
    while len(order) < len(names):
        name = names[heapq.heappop(ready) if ready else loops.first()]
        order.append(name)
        loops.take(name, sinks[name])
        for sink in sinks[name]:
            waiting[sink] -= 1
            if not waiting[sink] and sink not in loops.taken:
                heapq.heappush(ready, rank[sink])
    return order


class _Loops:
    """The loops among the instances that are left.

    An instance that is taken out breaks its own loop alone: only that is looked through again.
    """

    def __init__(self, sources: Mapping[str, set[str]], rank: Mapping[str, int]):
        self.sources, self.rank = sources, rank
        self.taken: set[str] = set()
        self._members: list[list[str]] = [list(sources)]  # of each loop
        self._loop = dict.fromkeys(sources, 0)  # its number
        self._feeding = [0]  # wires that lead into it from what is left
        self._unfed: list[tuple[int, int]] = []  # heap of loops without such wires: rank of the first, number
        self._broken = 0  # the loop that may have fallen apart

    def first(self) -> int:
        """The rank of the first instance on a loop that nothing else feeds."""
        left = [name for name in self._members[self._broken] if name not in self.taken]
        found = len(self._members)
        for members in _strongly_connected(left, self.sources):
            self._loop |= dict.fromkeys(members, len(self._members))
            self._members.append(members)
        for number in range(found, len(self._members)):
            self._feeding.append(self._count(number))
            self._offer(number)
        rank, self._broken = heapq.heappop(self._unfed)
        return rank

    def take(self, name: str, sinks: Sequence[str]) -> None:
        """Take out an instance that feeds these."""
        self.taken.add(name)
        for sink in sinks:
            number = self._loop[sink]
            if number != self._loop[name]:
                self._feeding[number] -= 1
                self._offer(number)

    def _count(self, number: int) -> int:
        inside = set(self._members[number])
        return sum(len(self.sources[name] - inside - self.taken) for name in inside)

    def _offer(self, number: int) -> None:
        """Have a loop ready to be broken once nothing else feeds it; one instance alone needs no breaking."""
        if not self._feeding[number] and len(self._members[number]) > 1:
            first = min(self.rank[name] for name in self._members[number])
            heapq.heappush(self._unfed, (first, number))


def _strongly_connected(names: Iterable[str], sources: Mapping[str, set[str]]) -> Iterator[list[str]]:
    """Groups of instances of which each feeds, near or far, all others of its group: Tarjan's algorithm."""
    number = dict.fromkeys(names, 0)  # of an instance as they are met, from 1 on
    lowest: dict[str, float] = {}  # number that is reached from it, infinite where its group is known
    met: list[str] = []
    for root in number:
        path = [(root, iter(sources[root]))] if not number[root] else []
        while path:
            name, rest = path[-1]
            if not number[name]:
                number[name] = len(lowest) + 1
                lowest[name] = number[name]
                met.append(name)
            for source in rest:
                if number.get(source) == 0:
                    path.append((source, iter(sources[source])))
                    break
                lowest[name] = min(lowest[name], lowest.get(source, math.inf))
            else:
                path.pop()
                if lowest[name] == number[name]:
                    group: list[str] = []
                    while not group or group[-1] != name:
                        group.append(met.pop())
                    lowest |= dict.fromkeys(group, math.inf)
                    yield group
                if path:
                    above = path[-1][0]
                    lowest[above] = min(lowest[above], lowest[name])
