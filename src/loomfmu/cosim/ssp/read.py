"""System packages (SSP 1.0) as scenes: our own, to the last bit, and those of other makers.

A package is read from its structure: elements, connections, parameter sets. What a structure cannot say,
such as claims and what is recorded, is in the text of the scene that our own packages carry; another
maker's package runs by seconds and records all outputs.
"""

import hashlib
import posixpath
import zipfile
import zlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit
from xml.etree.ElementTree import Element, ParseError, fromstring

from ...errors import LoomfmuError
from ...files import source as readable
from ...fmi.cache_entries import PACKAGES, folder
from ..importing import fmus
from ..importing.descriptions import plain_names
from ..importing.fmus import Fmu
from ..scenes.graph import Wire
from ..scenes.instances import (
    PARAMETER_SETS,
    TIMES,
    Instance,
    as_shaft,
    check_name,
    components,
    overridden,
    override,
    unit_of,
    with_units,
)
from ..scenes.scene import Scene, assemble, check_free, toml
from ..scenes.wiring import wire
from .values import apply, bound
from .xml import FMU, OSP, OURS, SSD_FILE, full, read_units, said


def load(path: str | Path, overrides: dict[str, Any] | None = None) -> Scene:
    """A scene from a system package. Raises LoomfmuError naming the file and what is wrong."""
    path = Path(path)
    try:
        return _Package(path).scene(overrides or {})
    except (OSError, zipfile.BadZipFile, zlib.error, RuntimeError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        raise LoomfmuError(f"{path}: cannot be read ({reason})") from None
    except LoomfmuError as error:
        raise LoomfmuError(f"{path}: {error}") from None


KEPT = ("title", "description", "record", "inputs", "claims")  # keys of a scene that no structure can hold


@dataclass(frozen=True)
class _Found:
    """A component: the names of the systems around it and its own, its element, and those around it."""

    path: tuple[str, ...]
    element: Element
    around: tuple[Element, ...]


class _Package:
    """A package under reading."""

    def __init__(self, path: Path):
        self.path = path
        content = readable(path).read_bytes()
        self.sha256 = hashlib.sha256(content).hexdigest()
        with zipfile.ZipFile(path) as archive:
            self.files = {name: archive.read(name) for name in archive.namelist() if not name.endswith("/")}
        self.notes: list[str] = []
        self.root = self.read(SSD_FILE)
        self.units = read_units(self.root.iterfind(full("ssd:Units")))

    def read(self, source: str) -> Element:
        """The root of an XML file of the package."""
        name = self.member(source)
        try:
            return fromstring(self.files[name])
        except ParseError as error:
            raise LoomfmuError(f"{name}: it is no valid XML ({error})") from None

    def member(self, source: str) -> str:
        """The name of a file of the package, given as the structure refers to it."""
        name = posixpath.normpath(unquote(source))
        outside = bool(urlsplit(source).scheme) or name.startswith(("..", "/"))
        if outside or name not in self.files:
            raise LoomfmuError(f"{source or 'a parameter set'} is not in the package")
        return name

    def scene(self, overrides: dict[str, Any]) -> Scene:
        """The scene that the package describes, with some values changed."""
        annotation = self._scene_of_ours()
        system = self.root.find(full("ssd:System"))
        if system is None:
            raise LoomfmuError(f"{SSD_FILE} describes no system")
        found = list(_components(system))
        names = _names(found)
        text = None if annotation is None else toml(annotation.text or "")
        stated = _stated(names, text or {}, overrides)
        instances = {
            name: self._instance(name, each, stated[name], ours=text is not None)
            for name, each in names.items()
        }
        wires = _wires(system, instances, {each.path: name for name, each in names.items()})
        tables = self._foreign_tables() if annotation is None else _our_tables(text or {}, annotation)
        changed = _override(tables, instances, overrides)
        written = self.files[SSD_FILE].decode(errors="replace") if annotation is None else annotation.text
        made = assemble(tables, instances, wires, self.path.stem, written or "", self.path.parent)
        made = replace(
            made, package=self.path, package_sha256=self.sha256, notes=(*self.notes, *made.notes),
            overrides=dict(overrides),
        )  # fmt: skip
        for name, variable in changed:
            check_free(made, name, variable)
        return made

    def _scene_of_ours(self) -> Element | None:
        """The text of the scene, if the package is ours; those of version 0.1.0 have it at the root's end."""
        experiment = self.root.find(full("ssd:DefaultExperiment"))
        places = (self.root,) if experiment is None else (experiment, self.root)
        found = [_annotation(place, OURS, "loomfmu:Scene") for place in places]
        return next((element for element in found if element is not None), None)

    # ---- instances

    def _instance(self, name: str, found: _Found, stated: Any, ours: bool) -> Instance:
        """An instance with its values; `stated` are units, `ours` tells whether we made the package."""
        element = found.element
        check_name(name)
        source = said(element, "source")
        if element.get("type", FMU) != FMU:
            raise LoomfmuError(f"{name}: {source} is no FMU but {element.get('type')}")
        fmu = self._with_units(with_units(self._fmu(source), stated, name), element, name)
        if name == "shaft" and "angle" in fmu.ports:
            fmu = as_shaft(fmu)
        instance = Instance(name, fmu)
        for depth, level in enumerate((element, *reversed(found.around))):
            start = ".".join(found.path[len(found.path) - depth :]) + "." if depth else ""
            for given in bound(level, self.read):
                if given.name.startswith(start):
                    own = replace(given, name=given.name.removeprefix(start))
                    self.notes += [note for note in [apply(instance, own)] if note]
        if fmu.ours and not ours:  # whatever was meant for another master: ours works in dependency order
            instance.values.pop("inputs_at_step_end", None)
        instance.settle()
        return instance

    def _fmu(self, source: str) -> Fmu:
        """An FMU of the package, put where it can be read from."""
        name = self.member(source)
        content, file = self.files[name], posixpath.basename(name)
        key = hashlib.sha256(content).hexdigest()
        return fmus.load(folder(PACKAGES, key, [file], lambda _: content) / file)

    def _with_units(self, fmu: Fmu, element: Element, name: str) -> Fmu:
        """The units that connectors state, where the FMU itself states none."""
        ports = dict(fmu.ports)
        for connector in element.iterfind(f"{full('ssd:Connectors')}/{full('ssd:Connector')}"):
            real = connector.find(full("ssc:Real"))
            unit = real.get("unit", "") if real is not None else ""
            port = ports.get(fmu.name_of(said(connector, "name")))
            if unit and port is not None and port.kind == "Real":
                where = f"{name}.{port.name}"
                ports[port.name] = port.with_unit(unit, self.units.get(unit), where)
        return replace(fmu, ports=ports)

    # ---- the rest

    def _foreign_tables(self) -> dict[str, Any]:
        """What a scene's text would say beside its instances."""
        experiment = self.root.find(full("ssd:DefaultExperiment"))
        tables: dict[str, Any] = {"title": self.root.get("name") or self.path.stem}
        if experiment is None:
            return tables
        if float(experiment.get("startTime", "0")) != 0.0:
            raise LoomfmuError(f"it starts at {experiment.get('startTime')} s; runs start at 0 s")
        algorithm = _annotation(experiment, OSP, "osp:Algorithm")
        fixed = algorithm.find(full("osp:FixedStepAlgorithm")) if algorithm is not None else None
        if experiment.get("stopTime") is not None:
            tables["duration"] = float(experiment.get("stopTime", "0"))
        if fixed is not None:
            tables["step"] = float(said(fixed, "baseStepSize"))
        return tables


def _our_tables(text: dict[str, Any], annotation: Element) -> dict[str, Any]:
    """What the text of our own scene says beside its instances, with the times that it was packed with."""
    times = {key: float(annotation.attrib[key]) for key in TIMES if key in annotation.attrib}
    return {key: text[key] for key in KEPT if key in text} | times


def _annotation(parent: Element, kind: str, content: str) -> Element | None:
    """What an annotation of a kind holds."""
    for annotation in parent.iterfind(f"{full('ssd:Annotations')}/{full('ssc:Annotation')}"):
        if annotation.get("type") == kind:
            return annotation.find(full(content))
    return None


def _components(
    system: Element, path: tuple[str, ...] = (), around: tuple[Element, ...] = ()
) -> Iterator[_Found]:
    """The components of a system and of the systems in it."""
    around = (*around, system)
    for element in system.iterfind(f"{full('ssd:Elements')}/*"):
        here = (*path, said(element, "name"))
        if element.tag == full("ssd:Component"):
            yield _Found(here, element, around)
        elif element.tag == full("ssd:System"):
            yield from _components(element, here, around)
        else:
            raise LoomfmuError(
                f"{here[-1]} is a {element.tag.rpartition('}')[2]}: only FMUs and systems are run"
            )


def _names(found: list[_Found]) -> dict[str, _Found]:
    """Names of the instances: those of the components, with the systems' names before them."""
    if not found:
        raise LoomfmuError("the system has no components")
    return dict(zip(plain_names("_".join(each.path) for each in found), found, strict=True))


# ---- wires

Node = tuple[tuple[str, ...], str]  # an element, as the names that lead to it, and a connector of it


def _wires(system: Element, instances: dict[str, Instance], names: dict[tuple[str, ...], str]) -> list[Wire]:
    """The connections as wires from outputs to inputs, straight through the connectors of systems.

    Start and end of a connection tell no direction: causalities do.
    """
    nets: dict[Node, list[Node]] = {}
    order: list[Node] = []
    for one, other in _connections(system):
        joined = nets.setdefault(one, [one])
        for node in nets.setdefault(other, [other]) if nets.get(other) is not joined else ():
            joined.append(node)
            nets[node] = joined
        order += [one, other]
    wires: dict[Wire, None] = {}
    for node in dict.fromkeys(order):
        if _causality(node, instances, names) == "input":
            sources = [each for each in nets[node] if _causality(each, instances, names) == "output"]
            sink = f"{names[node[0]]}.{node[1]}"
            if len(sources) > 1:
                raise LoomfmuError(f"{sink} is connected to {len(sources)} outputs")
            if not sources:  # it leads to a connector of the whole system
                continue
            wires[wire(instances, sink, f"{names[sources[0][0]]}.{sources[0][1]}")] = None
    return list(wires)


def _causality(node: Node, instances: dict[str, Instance], names: dict[tuple[str, ...], str]) -> str:
    """What a connector of a component is; nothing for one of a system."""
    name = names.get(node[0])
    if name is None:
        return ""
    fmu = instances[name].fmu
    return fmu.port(fmu.name_of(node[1]), f"connection to {name}").causality


def _connections(system: Element, path: tuple[str, ...] = ()) -> Iterator[tuple[Node, Node]]:
    for connection in system.iterfind(f"{full('ssd:Connections')}/{full('ssd:Connection')}"):
        ends: list[Node] = []
        for end in ("start", "end"):
            owner = connection.get(f"{end}Element")
            here = path if owner is None else (*path, owner)
            ends.append((here, said(connection, f"{end}Connector")))
        _check_plain(connection, ends)
        yield ends[0], ends[1]
    for element in system.iterfind(f"{full('ssd:Elements')}/{full('ssd:System')}"):
        yield from _connections(element, (*path, said(element, "name")))


def _check_plain(connection: Element, ends: list[Node]) -> None:
    """Refuse a connection that changes its value on the way."""
    for child in connection:
        linear = child.tag == full("ssc:LinearTransformation")
        if linear and float(child.get("factor", "1")) == 1.0 and float(child.get("offset", "0")) == 0.0:
            continue
        if child.tag.endswith("Transformation"):
            shown = " -> ".join(".".join((*path, connector)) for path, connector in ends)
            raise LoomfmuError(f"connection {shown} transforms its value: that is not done")


def _stated(names: Iterable[str], text: dict[str, Any], overrides: dict[str, Any]) -> dict[str, Any]:
    """The units that the text of our scene states for each instance, and those that are set."""
    tables = {name: {"units": text.get(name, {}).get("units", {})} for name in names}
    for key, value in overrides.items():
        if unit_of(key.partition(".")[2]):
            override({}, tables, key, value, Path())
    return {name: table["units"] for name, table in tables.items()}


def _override(
    tables: dict[str, Any], instances: dict[str, Instance], overrides: dict[str, Any]
) -> list[tuple[str, str]]:
    """Let some values be others, a published name before what prevails over it; what was changed."""
    changed = [
        (name, variable, value)
        for key, value in overrides.items()
        for name, variable in overridden(instances, key, components(instances))
        if not unit_of(variable)  # units are known from the beginning
    ]
    for name, variable, value in sorted(changed, key=lambda each: each[1] not in PARAMETER_SETS):
        if name:
            instances[name].set(variable, value)
        else:
            tables[variable] = value
    return [(name, variable) for name, variable, _value in changed if name]
