"""The sources of inputs, wires and tables, and the order in which a master steps its instances."""

import heapq
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...declaring.upstream import sources_of
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


@dataclass
class _Group:
    """One instance alone or those of a loop, the first of the scene first.

    `feeding` is how many others that are left feed its members.
    """

    members: list[str]
    feeding: int


def _order(sources: Mapping[str, set[str]]) -> list[str]:
    """The order of instances, each given with those that feed it.

    A group is ready when nothing else feeds it: instances before loops. A loop is broken by taking its first
    instance, which may leave smaller groups; only these are looked for again.
    """
    rank = {name: number for number, name in enumerate(sources)}
    sinks = sources_of((sink, source) for sink, each in sources.items() for source in each)
    groups: dict[str, _Group] = {}
    ready: list[tuple[bool, int, _Group]] = []  # a heap
    order: list[str] = []
    taken: set[str] = set()

    def offer(group: _Group) -> None:
        if not group.feeding:
            heapq.heappush(ready, (len(group.members) > 1, rank[group.members[0]], group))

    def divide(names: Iterable[str]) -> None:
        for members in _strongly_connected(names, sources):
            others = (sources[name] - taken - set(members) for name in members)
            group = _Group(sorted(members, key=rank.__getitem__), sum(map(len, others)))
            groups.update(dict.fromkeys(members, group))
            offer(group)

    divide(sources)
    while ready:
        _is_loop, _rank, group = heapq.heappop(ready)
        name, *rest = group.members
        order.append(name)
        taken.add(name)
        for sink in sinks.get(name, ()):
            if groups[sink] is not group and sink not in taken:
                groups[sink].feeding -= 1
                offer(groups[sink])
        divide(rest)
    return order


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
