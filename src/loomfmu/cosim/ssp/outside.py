"""The connectors of the system in a package: what a tool sees that makes one FMU of it, or one element.

They are the speed of the main shaft, and the outputs that the scene records, that its claims need, and that a
terminal of an FMU has.
"""

from collections.abc import Sequence
from typing import NamedTuple
from xml.etree.ElementTree import Element, SubElement

from ..importing.descriptions import plain_names
from ..importing.ports import Port
from ..planning.requested import Requested
from ..scenes.scene import Scene
from .xml import connector

SPEED = "shaft", "speed"


class Outer(NamedTuple):
    """A connector of the system: its name, and whose variable it is joined to."""

    name: str
    instance: str
    port: Port


def outer_connectors(scene: Scene) -> list[Outer]:
    """The connectors that a scene's system has."""
    requested = Requested(scene)
    signals = dict.fromkeys(requested.needed(requested.claims, requested.recorded))
    for name, instance in scene.instances.items():
        terminals = instance.fmu.component.terminals if instance.fmu.component else ()
        signals |= {f"{name}.{each}": None for terminal in terminals for each in terminal.variables}
    shown = [(name, variable) for name, _, variable in (signal.partition(".") for signal in signals)]
    ports = {(name, each): scene.instances[name].fmu.ports[each] for name, each in shown}
    ports = {
        key: port
        for key, port in ports.items()
        if port.causality == "output" and port.base_type != "Enumeration"
    }
    shaft = scene.instances.get(SPEED[0])
    if shaft and SPEED[1] in shaft.fmu.ports:
        ports = {SPEED: shaft.fmu.ports[SPEED[1]]} | ports
    names = plain_names(f"{name}_{port.name}" for (name, _), port in ports.items())
    return [Outer(plain, key[0], port) for plain, (key, port) in zip(names, ports.items(), strict=True)]


def add_connectors(system: Element, outer: Sequence[Outer]) -> None:
    """Give a system its connectors, and join them to those of its components."""
    parts = {each.tag: each for each in system}
    elements, connections = parts["ssd:Elements"], parts.get("ssd:Connections")
    if connections is None:
        connections = Element("ssd:Connections")
        system.insert(list(system).index(elements) + 1, connections)
    listed = Element("ssd:Connectors")
    system.insert(0, listed)
    for each in outer:
        connector(listed, each.name, each.port.causality, each.port)
        out = each.port.causality == "output"
        inner, outside = ("start", "end") if out else ("end", "start")
        ends = {f"{inner}Element": each.instance, f"{inner}Connector": each.port.own}
        SubElement(connections, "ssd:Connection", ends | {f"{outside}Connector": each.name})
        if not out:
            component = next(part for part in elements if part.get("name") == each.instance)
            inside = next(part for part in component if part.tag == "ssd:Connectors")  # of its outputs
            connector(inside, each.port.own, "parameter", each.port)
