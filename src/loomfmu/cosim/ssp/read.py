"""System packages (SSP 1.0 and 2.0) as scenes: our own, to the last bit, and those of other tools.

A package is read from its structure: elements, connections, parameter sets. What a structure cannot say,
such as claims and what is recorded, is in the text of the scene that our own packages carry; another
tool's package runs by seconds and records all outputs.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element

from ...declaring.variables import AT_STEP_END
from ...errors import LoomfmuError, listed, shown, why
from ...own.declared import PARAMETER_SETS
from ..importing import fmus
from ..importing.conversions import SAME, Stated
from ..importing.descriptions import plain_names
from ..importing.fmus import Fmu
from ..importing.ports import conversion
from ..scenes.graph import LATEST
from ..scenes.instance_tables import overridden, override, prevailing, state_units, unit_of
from ..scenes.instances import TOLERANCE, Instance, check_name
from ..scenes.scene import Scene, assemble
from ..scenes.settings import DEEPEST, TIMES, toml
from .connections import Nets, Reached
from .package import Package
from .structure import Node, connectors, joining, stated_by, structure, systems
from .values import Given, apply, bound
from .xml import FMU, OMS, OSP, OURS, SSD_FILE, full, read_units, real, required, transformed

# keys of a scene that no structure can hold
KEPT = ("title", "description", "coupling", "record", "inputs", "claims", "tolerances")

# where a package may state its step: element, kind and content of its annotation, way from there, attribute
STEPS = (
    ("ssd:DefaultExperiment", OSP, "osp:Algorithm", ("osp:FixedStepAlgorithm",), "baseStepSize"),
    ("ssd:System", OMS, "oms:Annotations", ("oms:SimulationInformation", "oms:FixedStepMaster"), "stepSize"),
)


def load(path: str | Path, overrides: dict[str, Any] | None = None) -> Scene:
    """A scene from a system package. Raises LoomfmuError naming the file and what is wrong."""
    path = Path(path)
    try:
        with Package(path) as package:
            return _Reader(package).scene(overrides or {})
    except OSError as error:
        raise LoomfmuError(f"{path}: cannot be read ({why(error)})") from None
    except ValueError as error:
        raise LoomfmuError(f"{path}: cannot be read ({error})") from None
    except LoomfmuError as error:
        raise LoomfmuError(f"{path}: {error}") from None


@dataclass(frozen=True)
class _Found:
    """A component: the names of the systems around it and its own, and its element."""

    path: tuple[str, ...]
    element: Element


class _Reader:
    """A package under reading."""

    def __init__(self, package: Package):
        self.package = package
        self.notes: list[str] = []
        self.unitless: list[str] = []  # values with a unit for variables without one
        self.root = structure(package)
        experiment = self.root.find(full("ssd:DefaultExperiment"))
        self.start_time = 0.0 if experiment is None else real(experiment, "startTime", 0.0)
        if abs(self.start_time) > LATEST:
            raise LoomfmuError(f"startTime = {self.start_time:g} s is not within {LATEST:g} s")
        self.units = read_units(self.root.iterfind(full("ssd:Units")))

    def scene(self, overrides: dict[str, Any]) -> Scene:
        """The scene that the package describes, with some values changed."""
        annotation = self._scene_of_ours()
        system = self.root.find(full("ssd:System"))
        if system is None:
            raise LoomfmuError(f"{SSD_FILE} describes no system")
        found = _names(list(_components(system)))
        names = {each.path: name for name, each in found.items()}
        text = None if annotation is None else toml(annotation.text or "")
        stated = _stated(found, text or {}, overrides)
        instances = {name: self._instance(name, each.element, stated[name]) for name, each in found.items()}
        for name, instance in instances.items():  # a structure has no place for these
            if TOLERANCE in (own := (text or {}).get(name, {})) and not instance.fmu.ours:
                instance.set(TOLERANCE, own[TOLERANCE])
        passing = joining(self.package, self.root, system)
        nets = Nets(system, instances, names, passing)
        for name, values in self._values(system, found, nets, passing).items():
            self._set(instances[name], values, ours=text is not None)
        if self.unitless:
            taken = f"values are taken as they are where the variable has no unit: {listed(self.unitless)}"
            lacking = self.unitless[0].partition(" ")[0].replace(".", ".units.", 1)
            self.notes.append(f"{taken}; state it by --set {lacking}=...")
        wires = nets.wires
        recorded = {} if text is not None else self._recorded(system, instances, nets)
        if text and text.get("claims") and any(transformed(each, "") != SAME for each in self.root.iter()):
            raise LoomfmuError("a connection transforms its value, so the claims cannot be judged")
        tables = self._foreign_tables() if annotation is None else _our_tables(text or {}, annotation)
        if text is not None:
            for instance in instances.values():
                instance.inherit_equals(instances, {wire.sink for wire in wires})
        changed = _override(tables, instances, overrides)
        written = self.package.text(SSD_FILE) if annotation is None else annotation.text
        path = self.package.path
        return assemble(
            tables,
            instances,
            wires,
            changed,
            name=path.stem,
            text=written or "",
            directory=path.parent,
            package=path,
            start_time=self.start_time,
            package_sha256=self.package.sha256,
            notes=tuple(self.notes),
            overrides=dict(overrides),
            connectors=recorded,
        )

    def _scene_of_ours(self) -> Element | None:
        """The text of the scene, if the package is ours; those of version 0.1.0 have it at the root's end."""
        experiment = self.root.find(full("ssd:DefaultExperiment"))
        places = (self.root,) if experiment is None else (experiment, self.root)
        found = [_annotation(place, OURS, "loomfmu:Scene") for place in places]
        return next((element for element in found if element is not None), None)

    # ---- instances

    def _values(
        self,
        system: Element,
        found: Mapping[str, _Found],
        nets: Nets,
        passing: Mapping[Node, Stated | None],
    ) -> dict[str, list[Given]]:
        """The values of each instance in the order they are set: those of outer systems later.

        Those that come along connections are last, the longest way last of all: an end of a connection has no
        value of its own. Raises LoomfmuError for values that come from two places.
        """
        given_in = partial(bound, read=self.package.root, units=self.units)
        values = {name: list(given_in(each.element)) for name, each in found.items()}
        wired: dict[str, list[tuple[Reached, Given]]] = {name: [] for name in found}
        dotted = {".".join(each.path): name for name, each in found.items()}
        nodes = {
            ".".join((*node[0], node[1])): node for node in reversed(list(passing))
        }  # the outermost counts
        for path, element in reversed(list(systems(system))):  # the outermost last: it prevails
            for given in given_in(element):
                if direct := _in_component(path, given, dotted):
                    values[direct[0]].append(direct[1])
                    continue
                whole = ".".join((*path, given.name))
                for name, value in self._by_wires(whole, nodes.get(whole), given, passing, nets):
                    wired[name].append(value)
        return {name: [*each, *nets.in_order(wired[name])] for name, each in values.items()}

    def _by_wires(
        self, whole: str, node: Node | None, given: Given, passing: Mapping[Node, Stated | None], nets: Nets
    ) -> list[tuple[str, tuple[Reached, Given]]]:
        """The instances to which a system's connector leads, each with the value under its own name for it.

        Notes a value that no instance takes; `whole` is its name.
        """
        inside = passing[node] if node else None
        takers = nets.reached(node, inside or given.unit) if node else []
        if not takers:
            reason = "there is no such component" if node is None else "no free input takes it"
            self.notes.append(f"{whole} of the package is ignored: {reason}")
            return []
        entered = conversion(whole, given.unit, "its connector", inside).then(given.transformation)
        found = []
        for taken in takers:
            name, variable = nets.variable(taken.node)
            made = entered.then(taken.conversion)
            value = replace(given, name=variable, unit=taken.unit, transformation=made)
            found.append((name, (taken, value)))
        return found

    def _instance(self, name: str, element: Element, stated: Any) -> Instance:
        """An instance; `stated` are units."""
        check_name(name)
        source = required(element, "source")
        if element.get("type", FMU) != FMU:
            raise LoomfmuError(f"{name}: {shown(source)} is not an FMU but {shown(element.get('type'))}")
        file = self.package.unpacked(source)
        try:
            loaded = fmus.load(file)
        except LoomfmuError as error:  # which names a file in the cache
            raise LoomfmuError(str(error).replace(str(file), source)) from None
        fmu = self._with_units(loaded.with_units(stated, name), element, name)
        if name == "shaft" and "angle" in fmu.ports:
            fmu = fmu.as_shaft()
        return Instance(name, fmu)

    def _set(self, instance: Instance, values: Iterable[Given], ours: bool) -> None:
        """Give an instance its values; `ours` says whether we made the package."""
        self.notes += filter(None, [apply(instance, given, self.unitless) for given in values])
        if instance.fmu.ours and not ours:  # what was meant for another master: ours goes by dependencies
            instance.values.pop(AT_STEP_END, None)
        instance.settle()

    def _with_units(self, fmu: Fmu, element: Element, name: str) -> Fmu:
        """The units that connectors state, where the FMU itself states none."""
        ports = dict(fmu.ports)
        for connector in connectors(element):
            unit = stated_by(connector, self.units)
            own = required(connector, "name")
            scalar = ports.get(fmu.name_of(own))
            for port in fmu.elements(own) or ([scalar] if scalar else []):
                if unit and port.kind == "Real":
                    ports[port.name] = port.with_unit(unit.name, unit.definition, f"{name}.{port.name}")
        return replace(fmu, ports=ports)

    # ---- the rest

    def _recorded(self, system: Element, instances: Iterable[str], nets: Nets) -> dict[str, str]:
        """The outputs of the outermost system as a trace calls them, below the name of the system.

        Notes those that are left out.
        """
        own, found = required(system, "name"), dict[str, str]()
        given = ("input", "parameter")
        known = {required(each, "name") for each in connectors(system) if each.get("kind") not in given}
        for name, signal, reason in nets.outputs():
            if name in known and reason:
                self.notes.append(f"{own}.{name} of the package is not recorded: {reason}")
            elif name in known:
                found[name] = signal
        owner = plain_names([*instances, own], [own])[-1]
        names = plain_names(found, found)
        return {f"{owner}.{name}": signal for name, signal in zip(names, found.values(), strict=True)}

    def _foreign_tables(self) -> dict[str, Any]:
        """Return a third-party package's settings, as the text of a scene without its instances."""
        experiment = self.root.find(full("ssd:DefaultExperiment"))
        tables: dict[str, Any] = {"title": self.root.get("name") or self.package.path.stem}
        if experiment is not None and experiment.get("stopTime") is not None:
            tables["duration"] = real(experiment, "stopTime", 0.0) - self.start_time
        for place, kind, content, master, attribute in STEPS:
            parent = self.root.find(full(place))
            annotation = None if parent is None else _annotation(parent, kind, content)
            fixed = None if annotation is None else annotation.find("/".join(map(full, master)))
            if fixed is not None:
                required(fixed, attribute)
                return tables | {"step": real(fixed, attribute, 0.0)}
        return tables


def _in_component(path: Sequence[str], given: Given, dotted: Mapping[str, str]) -> tuple[str, Given] | None:
    """The instance that a value of a system names, and the value under its own name for it; none otherwise.

    `dotted` are the instances by the names of the systems around them and their own, joined by dots.
    """
    most = max(name.count(".") for name in dotted) + 1
    parts = (*path, *given.name.split(".", most))
    for end in range(len(path) + 1, len(parts)):
        if name := dotted.get(".".join(parts[:end])):
            return name, replace(given, name=".".join(parts[end:]))
    return None


def _our_tables(text: dict[str, Any], annotation: Element) -> dict[str, Any]:
    """Return the settings of our own scene's text, with the times that it was packed with."""
    times = {key: real(annotation, key, 0.0) for key in TIMES if key in annotation.attrib}
    return {key: text[key] for key in KEPT if key in text} | times


def _annotation(parent: Element, kind: str, content: str) -> Element | None:
    """Return the content of an annotation of a kind."""
    for annotation in parent.iterfind(f"{full('ssd:Annotations')}/{full('ssc:Annotation')}"):
        if annotation.get("type") == kind:
            return annotation.find(full(content))
    return None


def _components(system: Element, path: tuple[str, ...] = ()) -> Iterator[_Found]:
    """The components of a system and of the systems in it. Raises LoomfmuError for what is neither."""
    names: set[str] = set()
    for element in system.iterfind(f"{full('ssd:Elements')}/*"):
        name = required(element, "name")
        here = (*path, name)
        if name in names:
            raise LoomfmuError(f"there are two elements called {shown('.'.join(here))}")
        if len(path) > DEEPEST:
            raise LoomfmuError(f"its systems are nested more than {DEEPEST} deep")
        names.add(name)
        if element.tag == full("ssd:Component"):
            yield _Found(here, element)
        elif element.tag == full("ssd:System"):
            yield from _components(element, here)
        elif element.tag != full("ssd:SignalDictionaryReference"):
            kind = element.tag.rpartition("}")[2]
            raise LoomfmuError(f"{name} is a {kind}: only FMUs, systems and dictionaries are supported")


def _names(found: list[_Found]) -> dict[str, _Found]:
    """Names of the instances: those of the components, with the systems' names before them."""
    if not found:
        raise LoomfmuError("the system has no components")
    return dict(zip(plain_names("_".join(each.path) for each in found), found, strict=True))


def _stated(names: Iterable[str], text: dict[str, Any], overrides: dict[str, Any]) -> dict[str, Any]:
    """The units that the text of our scene states for each instance, and those that are set."""
    tables = {name: {"units": text.get(name, {}).get("units", {})} for name in names}
    state_units(tables, text.get("units", {}))
    for key in overrides:
        if unit_of(key.partition(".")[2]):
            override(tables, key, overrides)
    return {name: table["units"] for name, table in tables.items()}


def _override(
    tables: dict[str, Any], instances: dict[str, Instance], overrides: dict[str, Any]
) -> list[tuple[str, str]]:
    """Let some values be others, a published name before what prevails over it; what was changed."""
    changed = [
        (name, variable, overrides[key])
        for key, name, variable in prevailing(overrides, partial(overridden, instances))
        if not unit_of(variable)  # units are known from the beginning
    ]
    for name, variable, value in sorted(changed, key=lambda each: each[1] not in PARAMETER_SETS):
        if name:
            instances[name].set(variable, value)
        else:
            tables[variable] = value
    found = [(name, variable) for name, variable, _value in changed if name]
    for name, instance in instances.items():
        for parameter in instance.inherited:
            if (name, parameter) not in found:
                instance.take(parameter, instances)
    return found
