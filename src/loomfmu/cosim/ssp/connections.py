"""The connections of a system package as wires, straight through the connectors of its systems."""

from collections.abc import Collection, Iterator, Mapping
from xml.etree.ElementTree import Element

from ...errors import LoomfmuError, shown, suggestion
from ..scenes.graph import Wire
from ..scenes.instances import Instance
from ..scenes.wiring import wire
from .xml import full, real, required

Node = tuple[tuple[str, ...], str]  # an element, as the names that lead to it, and a connector of it
Names = Mapping[tuple[str, ...], str]  # the instance that each component is, by the names that lead to it


class Nets:
    """Connectors that connections join, be it through connectors of systems.

    Start and end of a connection do not say which way values go: causalities do.
    """

    def __init__(self, system: Element, instances: dict[str, Instance], names: Names):
        self._instances, self._names = instances, names
        self._nets = _joined(system)
        self._causality = {node: _causality(node, instances, names) for node in self._nets}

    @property
    def wires(self) -> list[Wire]:
        """Wires from outputs to inputs."""
        wires: dict[Wire, None] = {}
        for node, net in self._nets.items():
            if self._causality[node] != "input":
                continue
            sources = self._outputs(net)
            sink = f"{self._names[node[0]]}.{node[1]}"
            if len(sources) > 1:
                raise LoomfmuError(f"{sink} is connected to {len(sources)} outputs")
            for path, connector in sources:  # none where it leads to a connector of the whole system
                wires[wire(self._instances, sink, f"{self._names[path]}.{connector}")] = None
        return list(wires)

    def reached(self, node: Node) -> list[tuple[str, str]]:
        """Return instances and variables that take the value of a system's connector.

        None do where it is not connected, or where an output of an FMU gives the value.
        """
        net = self._nets.get(node, [])
        takers = [each for each in net if self._causality[each] in ("input", "parameter")]
        return [] if self._outputs(net) else [(self._names[path], variable) for path, variable in takers]

    def _outputs(self, net: Collection[Node]) -> list[Node]:
        return [each for each in net if self._causality[each] == "output"]


def _joined(system: Element) -> dict[Node, list[Node]]:
    """The net of each connector, in the order of the connections."""
    nets: dict[Node, list[Node]] = {}
    for one, other in _connections(system):
        joined, added = sorted(
            (nets.setdefault(node, [node]) for node in (one, other)), key=len, reverse=True
        )
        if joined is not added:
            joined += added
            nets |= dict.fromkeys(added, joined)
    return nets


def _causality(node: Node, instances: dict[str, Instance], names: Names) -> str:
    """Return the causality of a component's connector, or an empty text for one of a system."""
    name = names.get(node[0])
    if name is None:
        return ""
    fmu = instances[name].fmu
    return fmu.port(fmu.name_of(node[1]), f"connection to {name}").causality


def _connections(system: Element, path: tuple[str, ...] = ()) -> Iterator[tuple[Node, Node]]:
    """The two ends of each connection of a system and of the systems in it."""
    elements = {required(each, "name"): each for each in system.iterfind(f"{full('ssd:Elements')}/*")}
    systems = {name: each for name, each in elements.items() if each.tag == full("ssd:System")}
    connectors = {(*path, name): _connectors(each) for name, each in systems.items()}
    connectors[path] = _connectors(system)
    for connection in system.iterfind(f"{full('ssd:Connections')}/{full('ssd:Connection')}"):
        ends = []
        for which in ("start", "end"):
            owner = connection.get(f"{which}Element") or None  # OMSimulator has an empty name for none
            node = (path if owner is None else (*path, owner), required(connection, f"{which}Connector"))
            if owner is not None:
                _check_known(node, "element", owner, elements)
            if node[0] in connectors:
                _check_known(node, "connector of a system", node[1], connectors[node[0]])
            ends.append(node)
        _check_plain(connection, ends)
        yield ends[0], ends[1]
    for name, element in systems.items():
        yield from _connections(element, (*path, name))


def _connectors(system: Element) -> set[str]:
    listed = system.iterfind(f"{full('ssd:Connectors')}/{full('ssd:Connector')}")
    return {required(each, "name") for each in listed}


def _check_known(node: Node, kind: str, name: str, known: Collection[str]) -> None:
    """Refuse an end that does not exist: without that connection an input would keep its start value."""
    if name not in known:
        raise LoomfmuError(
            f"connection to {shown(_dotted(node))}: there is no {kind} {shown(name)}{suggestion(name, known)}"
        )


def _dotted(node: Node) -> str:
    return ".".join((*node[0], node[1]))


def _check_plain(connection: Element, ends: list[Node]) -> None:
    """Refuse a connection that changes its value on the way."""
    for child in connection:
        linear = child.tag == full("ssc:LinearTransformation")
        if linear and real(child, "factor", 1.0) == 1.0 and real(child, "offset", 0.0) == 0.0:
            continue
        if child.tag.endswith("Transformation"):
            raise LoomfmuError(
                f"connection {' -> '.join(map(_dotted, ends))} transforms its value;"
                " transformations are not supported"
            )
