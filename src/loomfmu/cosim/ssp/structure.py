"""The structure of a system package, in which packages stand in the places of components."""

from collections.abc import Iterator, Mapping
from xml.etree.ElementTree import Element, SubElement

from ...errors import LoomfmuError, shown
from ..importing.conversions import Definition, Stated, stated
from ..scenes.settings import DEEPEST
from .package import Package
from .xml import SSD_FILE, SSP, full, read_units, required

Node = tuple[tuple[str, ...], str]  # an element, as the names that lead to it, and a connector of it
REALS = ("Real", "Float64", "Float32")


def structure(package: Package, depth: int = 0) -> Element:
    """The root of a package's structure: each component that is a package itself is the system in that.

    What that refers to is named after its package, so that `Package` finds it. Raises LoomfmuError.
    """
    root = package.root(SSD_FILE)
    if not (version := root.get("version", "1.0")).startswith(("1.", "2.")):
        raise LoomfmuError(f"{SSD_FILE} is of SSP {version}; 1.0 and 2.0 are read")
    own = read_units(root.iterfind(full("ssd:Units")))
    for elements in list(root.iter(full("ssd:Elements"))):
        for place, component in enumerate(elements):
            _enter_component(package, component)
            if component.tag != full("ssd:Component") or component.get("type") != SSP:
                continue
            name, source = required(component, "name"), required(component, "source")
            if depth > DEEPEST:
                raise LoomfmuError(f"{name}: its packages are nested more than {DEEPEST} deep")
            inner = structure(package.opened(source), depth + 1)
            units = read_units(inner.iterfind(full("ssd:Units")))
            if differing := [unit for unit in units if unit in own and own[unit] != units[unit]]:
                raise LoomfmuError(f"{source} defines the unit {shown(differing[0])} in another way")
            own |= units
            root.extend(inner.findall(full("ssd:Units")))
            elements[place] = _placed(inner, component, name, source)
    if any(each.get("sourceBase") == "component" for each in root.iter()):
        raise LoomfmuError('sourceBase = "component" is for the values of a component, not of a system')
    return root


def _enter_component(package: Package, component: Element) -> None:
    """Name the files in a component that its values are taken from after that component."""
    for each in component.iter() if component.tag == full("ssd:Component") else ():
        if each.get("sourceBase") == "component":
            source = required(component, "source")
            package.opened(source)
            each.set("source", f"{source}!/{required(each, 'source')}")
            del each.attrib["sourceBase"]


def _placed(inner: Element, component: Element, name: str, source: str) -> Element:
    """The system of a package in the place of a component, whose parameters prevail over its own."""
    system = inner.find(full("ssd:System"))
    if system is None:
        raise LoomfmuError(f"{source}: {SSD_FILE} describes no system")
    for each in system.iter():
        if "source" in each.attrib and each.tag.startswith(full("ssd:")):  # those of ssm: are names
            each.set("source", f"{source}!/{each.get('source')}")
    system.set("name", name)
    bindings = system.find(full("ssd:ParameterBindings"))
    if bindings is None:
        bindings = SubElement(system, full("ssd:ParameterBindings"))
    bindings.extend(component.findall(f"{full('ssd:ParameterBindings')}/*"))
    return system


def systems(system: Element, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Element]]:
    """A system and the systems in it, each with the names that lead to it; the outer ones first."""
    yield path, system
    for element in system.iterfind(f"{full('ssd:Elements')}/{full('ssd:System')}"):
        yield from systems(element, (*path, required(element, "name")))


def connectors(element: Element) -> list[Element]:
    """The connectors of an element."""
    return element.findall(f"{full('ssd:Connectors')}/{full('ssd:Connector')}")


def joining(package: Package, root: Element, system: Element) -> dict[Node, Stated | None]:
    """The connectors that pass values on, and their units: of systems, and of signal dictionaries."""
    units, found = read_units(root.iterfind(full("ssd:Units"))), dict[Node, Stated | None]()
    for path, element in systems(system):
        references = element.iterfind(f"{full('ssd:Elements')}/{full('ssd:SignalDictionaryReference')}")
        passing = [(path, element), *(((*path, required(each, "name")), each) for each in references)]
        for place, owner in passing:
            for connector in connectors(owner):
                found[place, required(connector, "name")] = stated_by(connector, units)
        for each in element.iterfind(f"{full('ssd:SignalDictionaries')}/{full('ssd:SignalDictionary')}"):
            source, home = each.get("source"), dictionary(path, required(each, "name"))
            content = each.find(full("ssb:SignalDictionary")) if source is None else package.root(source)
            entries = content.findall(full("ssb:DictionaryEntry")) if content is not None else []
            defined = read_units(content.iterfind(full("ssb:Units"))) if content is not None else {}
            found |= {(home, required(entry, "name")): stated_by(entry, defined) for entry in entries}
            found[home, ""] = None  # that it is there
    return found


def dictionary(path: tuple[str, ...], name: str) -> tuple[str, ...]:
    """Return the path of the entries of a dictionary of a system, a name that no element has."""
    return (*path, f"\0{name}")


def stated_by(element: Element, units: Mapping[str, Definition]) -> Stated | None:
    """The unit that a connector or an entry of a dictionary states, if it does."""
    kinds = (element.find(full(f"ssc:{kind}")) for kind in REALS)
    name = next((kind.get("unit", "") for kind in kinds if kind is not None), "")
    return stated(name, units.get(name))
