"""The connections of a system package as wires, straight through the connectors of its systems."""

from collections.abc import Collection, Container, Iterator, Mapping
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from ...errors import LoomfmuError, shown, suggestion
from ..importing.conversions import SAME, Linear, Stated
from ..importing.ports import conversion
from ..scenes.graph import Wire
from ..scenes.instances import Instance
from ..scenes.wiring import check_once, elements, wire
from .structure import Node, connectors, dictionary, systems
from .values import Given
from .xml import full, required, suppressed, transformed

IN, OUT = "in", "out"  # of the ways of values through connectors of systems
WAYS = {"input": IN, "parameter": IN, "structuralParameter": IN, "output": OUT, "calculatedParameter": OUT}
Names = Mapping[tuple[str, ...], str]  # the instance that each component is, by the names that lead to it


@dataclass(frozen=True)
class Link:
    """A connection, from either end: what it makes of values, with or without converting units."""

    transformation: Linear
    suppressed: bool


@dataclass(frozen=True)
class Reached:
    """The way of a value to a connector, both ends included, and what became of its number and its unit.

    It is `plain` where nothing but a change of units did anything to it.
    """

    way: tuple[Node, ...]
    conversion: Linear
    unit: Stated | None
    plain: bool = True

    @property
    def node(self) -> Node:
        """The connector."""
        return self.way[-1]


class Nets:
    """Connectors that connections join, be it through connectors of systems.

    Start and end of a connection do not say which way values go: causalities do. `units` are those of the
    connectors of systems.
    """

    def __init__(
        self,
        system: Element,
        instances: dict[str, Instance],
        names: Names,
        units: Mapping[Node, Stated | None],
    ):
        self._instances, self._names, self._units = instances, names, units
        self._ways = {
            (path, required(each, "name")): WAYS.get(each.get("kind", ""), "")
            for path, element in systems(system)
            for each in connectors(element)
        }
        self._links: dict[Node, list[tuple[Node, Link, bool]]] = {}  # and whether a value goes that way
        known: dict[frozenset[Node], Link] = {}
        for path, one, other, link in _connections(system, units):
            if known.setdefault(frozenset((one, other)), link) != link:
                raise LoomfmuError(_two_ways(one, other))
            back = self._leads(other, one, path)
            there = self._leads(one, other, path) or not back  # as it is drawn, where kinds allow neither
            self._links.setdefault(one, []).append((other, link, there))
            self._links.setdefault(other, []).append((one, link, back))
        self._causality = {node: _causality(node, instances, names) for node in self._links}
        self._outputs = [node for node, causality in self._causality.items() if causality == "output"]

    @property
    def wires(self) -> list[Wire]:
        """Wires from outputs to inputs."""
        sources: dict[Node, dict[Node, Linear]] = {}
        for output in self._outputs:
            for end in self._flow(output, self._unit(output)):
                if self._causality[end.node] == "parameter":
                    ends = f"{_dotted(output)} -> {_dotted(end.node)}"
                    raise LoomfmuError(f"connection {ends}: an output cannot give the value of a parameter")
                if self._causality[end.node] != "output":
                    sources.setdefault(end.node, {})[output] = end.conversion
        wires: list[Wire] = []
        for sink in sorted(self._links, key=lambda node: node[0] not in self._names):
            found, owner = sources.get(sink, {}), self._names.get(sink[0])
            name = f"{owner}.{sink[1]}" if owner else _dotted(sink)
            if len(found) > 1:
                raise LoomfmuError(f"{name} is connected to {len(found)} outputs")
            for (path, connector), made in found.items() if owner else ():
                pairs = elements(self._instances, name, f"{self._names[path]}.{connector}")
                wires += [wire(self._instances, to, source, made) for to, source in pairs]
        return check_once(list(dict.fromkeys(wires)))

    def reached(self, node: Node, unit: Stated | None) -> list[Reached]:
        """Return the variables that take a value of a system's connector, in a unit.

        None do where it is not connected, or where an output of an FMU gives the value.
        """
        if node not in self._links or any(
            self._causality[each.node] == "output" for each in self._flow(node, unit)
        ):
            return []
        found = self._flow(node, unit, directed=True)
        return [each for each in found if self._causality[each.node] in ("input", "parameter")]

    def outputs(self) -> Iterator[tuple[str, str, str]]:
        """The connectors of the outermost system to which outputs lead, those, and why they are others.

        The reason is empty where nothing but the unit may change on the way.
        """
        for output in self._outputs:
            (name, variable), unit = self.variable(output), self._unit(output)
            fmu = self._instances[name].fmu
            changed = "it is an array" if fmu.elements(variable) else ""
            for end in self._flow(output, unit):
                if not end.node[0]:
                    reason = changed or ("" if end.plain else "a connection changes its value")
                    yield end.node[1], f"{name}.{fmu.name_of(variable)}", reason

    def variable(self, node: Node) -> tuple[str, str]:
        """The instance and the variable that a connector of a component is."""
        return self._names[node[0]], node[1]

    def _unit(self, node: Node) -> Stated | None:
        """The unit of a connector, if there is one."""
        name = self._names.get(node[0])
        if name is None:
            return self._units.get(node)
        fmu = self._instances[name].fmu
        return (fmu.elements(node[1]) or [fmu.ports[fmu.name_of(node[1])]])[0].stated

    def _leads(self, one: Node, other: Node, path: tuple[str, ...]) -> bool:
        """Return whether a value may go from one end of a connection in a system to the other.

        A system's input takes it from outside and gives it to what is inside, an output the other way round.
        """
        leaving, entering = self._ways.get(one, ""), self._ways.get(other, "")
        if one[0] == other[0]:  # through a system, or from its output back to its input
            no_start, no_end = (OUT, IN) if path == one[0] else (IN, OUT)
            return leaving != no_start and entering != no_end
        inside, outside = _is_inside(other, one), _is_inside(one, other)
        leaves_it = inside if leaving == IN else not (leaving == OUT and inside)
        return leaves_it and (outside if entering == OUT else not (entering == IN and outside))

    def _flow(self, start: Node, unit: Stated | None, *, directed: bool = False) -> Iterator[Reached]:
        """Yield what a value reaches, through connectors of systems and itself first.

        A unit is converted before the transformation of its connection, as the standard has it. A value that
        is `directed` goes through connectors of systems as their kinds say. Raises LoomfmuError where two
        ways make different values of it.
        """
        found = {start: Reached((start,), SAME, unit)}
        waiting = [found[start]]
        for here in waiting:
            yield here
            if here.node != start and self._causality[here.node] == "output":
                continue  # it gives a value of its own
            for node, link, leads in self._links[here.node]:
                if node in here.way or (directed and not leads):
                    continue
                to, made = self._unit(node), SAME
                if not link.suppressed:
                    made = conversion(f"connection from {_dotted(here.node)}", here.unit, _dotted(node), to)
                total = here.conversion.then(made).then(link.transformation)
                plain = here.plain and link == Link(SAME, suppressed=False)
                there = Reached((*here.way, node), total, to or here.unit, plain)
                if found.setdefault(node, there) is there:
                    waiting.append(there)
                elif not found[node].conversion.is_like(total):
                    raise LoomfmuError(_two_ways(start, node))

    def in_order(self, values: list[tuple[Reached, Given]]) -> list[Given]:
        """Return the values that reach an instance, those on a longer way later: its ends have none of their
        own.

        Raises LoomfmuError for a variable whose values do not come along one way; through a dictionary, or a
        connector of both ways, there is none.
        """
        values = sorted(values, key=lambda each: len(each[0].way))
        last: dict[Node, Reached] = {}
        for reached, _given in values:
            before = last.setdefault(reached.node, reached)
            end = before.way[0]
            if end not in reached.way or (end != reached.way[0] and not self._ways.get(end)):
                sink, *ends = map(_dotted, (reached.node, end, reached.way[0]))
                raise LoomfmuError(f"{sink} takes the values of two connectors, {ends[0]} and {ends[1]}")
            last[reached.node] = reached
        return [given for _reached, given in values]


def _is_inside(node: Node, system: Node) -> bool:
    """Return whether a connector belongs to something in the system of another one."""
    return len(node[0]) > len(system[0]) and node[0][: len(system[0])] == system[0]


def _causality(node: Node, instances: dict[str, Instance], names: Names) -> str:
    """Return the causality of a component's connector, or an empty text for one of a system."""
    name = names.get(node[0])
    if name is None:
        return ""
    fmu = instances[name].fmu
    array = fmu.elements(node[1])
    causality = (array or [fmu.port(fmu.name_of(node[1]), f"connection to {name}")])[0].causality
    if causality not in ("output", "input", "parameter"):
        raise LoomfmuError(
            f"connection to {_dotted(node)}: its causality is {causality}, so it cannot be connected"
        )
    return causality


def _connections(
    system: Element, passing: Container[Node]
) -> Iterator[tuple[tuple[str, ...], Node, Node, Link]]:
    """The connections of a system and of the systems in it: where each is, its ends, what it does to values.

    A connector of a reference to a signal dictionary is connected to the entry of that.
    """
    for path, owner in systems(system):
        elements = {required(each, "name"): each for each in owner.iterfind(f"{full('ssd:Elements')}/*")}
        for connection in owner.iterfind(f"{full('ssd:Connections')}/{full('ssd:Connection')}"):
            ends = [_end(connection, which, path, owner, elements) for which in ("start", "end")]
            transformation = transformed(connection, f"connection {' -> '.join(map(_dotted, ends))}")
            yield path, ends[0], ends[1], Link(transformation, suppressed(connection))
        for name, each in elements.items():
            if each.tag == full("ssd:SignalDictionaryReference"):
                wanted = required(each, "dictionary")
                homes = (dictionary(path[:depth], wanted) for depth in range(len(path), -1, -1))
                home = next((home for home in homes if (home, "") in passing), None)
                if home is None:
                    raise LoomfmuError(f"{name}: there is no signal dictionary {shown(wanted)}")
                for entry in (required(connector, "name") for connector in connectors(each)):
                    if (home, entry) not in passing:
                        raise LoomfmuError(f"{name}: {wanted} has no entry {shown(entry)}")
                    yield path, ((*path, name), entry), (home, entry), Link(SAME, suppressed=False)


def _end(
    connection: Element, which: str, path: tuple[str, ...], system: Element, elements: Mapping[str, Element]
) -> Node:
    """An end of a connection in a system. Raises LoomfmuError where there is no such connector."""
    if connection.get(f"{which}Indices") is not None:
        raise LoomfmuError(f"{which}Indices = {shown(connection.get(f'{which}Indices'))} is not supported")
    owner = connection.get(f"{which}Element") or None  # OMSimulator has an empty name for none
    node = (path if owner is None else (*path, owner), required(connection, f"{which}Connector"))
    if owner is not None:
        _check_known(node, "element", owner, elements)
    element = system if owner is None else elements[owner]
    if element.tag != full("ssd:Component"):
        known = [required(each, "name") for each in connectors(element)]
        _check_known(node, "connector of a system", node[1], known)
    return node


def _check_known(node: Node, kind: str, name: str, known: Collection[str]) -> None:
    """Refuse an end that does not exist: without that connection an input would keep its start value."""
    if name not in known:
        raise LoomfmuError(
            f"connection to {shown(_dotted(node))}: there is no {kind} {shown(name)}{suggestion(name, known)}"
        )


def _dotted(node: Node) -> str:
    return ".".join((*node[0], node[1]))


def _two_ways(one: Node, other: Node) -> str:
    return f"{_dotted(one)} and {_dotted(other)} are connected in two different ways"
