"""The sources of inputs, wires and tables, and the order in which a master steps its instances."""

import heapq
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import LoomfmuError, shown
from ..importing.conversions import SAME, Linear
from ..importing.fmus import Port, Value
from .settings import ITERATED, LAGGED

Floats = NDArray[np.float64]
ROUNDING = 1e-14  # of a number of revolutions
LATEST = 1e9  # revolutions or seconds: no scene is longer


@dataclass(frozen=True)
class Wire:
    """From an output to an input, each as (instance, variable); `conversion` is made of its values."""

    source: tuple[str, str]
    sink: tuple[str, str]
    conversion: Linear = SAME

    def __str__(self) -> str:
        return f"{'.'.join(self.source)} -> {'.'.join(self.sink)}"


@dataclass(frozen=True)
class Drive:
    """An input with its values over revolutions, or seconds, held before and after.

    Between them continuous reals lie on straight lines; an integer, a boolean, and a real that its FMU
    declares as discrete, are held until the next one.
    """

    instance: str
    variable: str
    periods: tuple[float, ...]
    values: tuple[Value, ...]
    kind: str = "Real"
    held: bool = False
    doubt: str = ""

    def along(self, revolutions: Floats) -> NDArray[Any]:
        """Values at numbers of revolutions since the start.

        >>> Drive("belt", "guide_clearance", (0.0, 2.0), (1.0, 3.0)).along(np.array([-1.0, 0.5, 9.0]))
        array([1. , 1.5, 3. ])
        >>> Drive("motor", "mode", (0.0, 2.0), (1, 3), "Integer", True).along(np.array([-1.0, 1.9, 2.0]))
        array([1, 1, 3], dtype=int32)
        """
        if not self.held:
            return np.interp(revolutions, self.periods, self.values)
        # to rounding, a communication point on a point of the table is that point
        last = np.searchsorted(self.periods, revolutions * (1.0 + ROUNDING), side="right") - 1
        kind = np.float64 if self.kind == "Real" else np.int32
        return np.array(self.values, dtype=kind)[np.maximum(last, 0)]


def drive(name: str, port: Port, table: Any) -> Drive:
    """A drive from its table in a scene, `[[revolution, value], ...]`, checked and in SI."""
    where = f"inputs.{name}"
    if port.causality != "input":
        raise LoomfmuError(f"{where}: {port.name} is not an input")
    if not isinstance(table, list) or not table:
        raise LoomfmuError(f'{where} = {shown(table)} is not a list such as [[0, "0.3 mm"], [10, "1 mm"]]')
    revolutions: list[float] = []
    values: list[Value] = []
    doubts: list[str] = []
    for row in table:
        if not isinstance(row, list) or len(row) != 2 or isinstance(row[0], bool):
            raise LoomfmuError(f"{where}: {shown(row)} is not a pair [revolution, value]")
        if not isinstance(row[0], int | float):
            raise LoomfmuError(f"{where}: revolution {shown(row[0])} is not a number")
        if revolutions and not row[0] > revolutions[-1]:
            raise LoomfmuError(
                f"{where}: the revolutions must increase; {shown(row[0])} follows {revolutions[-1]:g}"
            )
        if not abs(row[0]) <= LATEST:
            raise LoomfmuError(f"{where}: revolution {shown(row[0])} is not within {LATEST:g}")
        revolutions.append(float(row[0]))
        values.append(port.value(row[1], where))
        doubts.append(port.doubt(row[1], where))
    instance = name.partition(".")[0]
    doubt = next(filter(None, doubts), "")
    held = port.discrete or port.kind != "Real"
    return Drive(instance, port.name, tuple(revolutions), tuple(values), port.kind, held, doubt)


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


def usual_coupling(instances: Iterable[str], wires: Iterable[Wire], trusted: bool) -> str:
    """Return how loops are closed unless a scene says otherwise: iterated where all FMUs are `trusted`."""
    _order, closing = step_order(instances, wires)
    return ITERATED if closing and trusted else LAGGED


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
