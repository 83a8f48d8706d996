"""The parameter values of a system package: sets, prefixes, mappings and units."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

from ... import units
from ...errors import LoomfmuError, shown
from ..importing.conversions import SAME, Definition, Linear, Stated, stated
from ..importing.fmus import Port
from ..scenes.instances import Instance
from .xml import full, number, read_units, required, suppressed, transformed

Read = Callable[[str], Element]  # the root of an XML file in the package


@dataclass(frozen=True)
class Given:
    """A value as a parameter set has it, and what its mapping makes of it after its unit was converted."""

    name: str
    kind: str  # Real, Integer, Boolean, Enumeration, String, Binary
    text: str
    unit: Stated | None
    transformation: Linear = SAME

    def number(self, unit: Stated | None, where: str) -> float:
        """Return its number in a unit, or as it stands if there is none. Raises LoomfmuError."""
        try:
            value = number(self.text)
        except ValueError:
            raise LoomfmuError(f"{where} = {shown(self.text)} is not a number") from None
        if self.unit and unit:
            try:
                value = self.unit.conversion(unit)(value)
            except ValueError:
                own = f"{self.text} {self.unit.name}"
                raise LoomfmuError(f"{where} = {own}, which does not fit {units.fitted(unit.name)}") from None
        return self.transformation(value)


def bound(element: Element, read: Read, units: Mapping[str, Definition]) -> Iterator[Given]:
    """The values that the bindings of a component or a system give, later ones before earlier.

    `units` are those of the structure, which sets that stand in it may use.
    """
    for binding in element.iterfind(f"{full('ssd:ParameterBindings')}/{full('ssd:ParameterBinding')}"):
        inline = binding.find(f"{full('ssd:ParameterValues')}/{full('ssv:ParameterSet')}")
        parameters = inline
        if parameters is None:
            source = required(binding, "source")
            parameters = _of_kind("ssv:ParameterSet", "parameter set", source, read(source))
        targets = _mapping(binding, read)
        prefix = binding.get("prefix", "")
        for given in _values(parameters, units if inline is not None else {}):
            name = prefix + given.name
            if targets is None:
                yield replace(given, name=name)
            for target, made, kept in (targets or {}).get(name, ()):
                yield replace(given, name=target, transformation=made, unit=None if kept else given.unit)


def _values(parameters: Element, units: Mapping[str, Definition]) -> Iterator[Given]:
    definitions = {**units, **read_units(parameters.iterfind(full("ssv:Units")))}
    for parameter in parameters.iterfind(f"{full('ssv:Parameters')}/{full('ssv:Parameter')}"):
        for value in parameter:
            kind = value.tag.rpartition("}")[2]
            if kind != "Annotations":
                unit = value.get("unit", "")
                text, said = required(value, "value"), stated(unit, definitions.get(unit))
                yield Given(required(parameter, "name"), kind, text, said)


def _of_kind(tag: str, kind: str, source: str, found: Element) -> Element:
    """Return the root of a file. Raises LoomfmuError where it is another one: its values would be lost."""
    if found.tag != full(tag):
        raise LoomfmuError(f"{source} is not a {kind} but {shown(found.tag)}")
    return found


def _mapping(binding: Element, read: Read) -> dict[str, list[tuple[str, Linear, bool]]] | None:
    """Return the variables that each name of a set stands for; None if names stand for themselves.

    Each comes with what is made of the value, and with whether its number stays in its own unit.
    """
    place = binding.find(full("ssd:ParameterMapping"))
    if place is None:
        return None
    mapping = place.find(full("ssm:ParameterMapping"))
    if mapping is None:
        source = required(place, "source")
        mapping = _of_kind("ssm:ParameterMapping", "parameter mapping", source, read(source))
    targets: dict[str, list[tuple[str, Linear, bool]]] = {}
    for entry in mapping.iterfind(full("ssm:MappingEntry")):
        name = required(entry, "source")
        made = transformed(entry, f"the mapping of {name}")
        targets.setdefault(name, []).append((required(entry, "target"), made, suppressed(entry)))
    return targets


def apply(instance: Instance, given: Given, unitless: list[str]) -> str:
    """Set a value of an instance, or return why it is ignored, as the standard has it for unknown names.

    Values with a unit for a variable without one are added to `unitless`. Raises LoomfmuError for a value
    that the variable cannot have.
    """
    where = f"{instance.name}.{given.name}"
    if array := instance.fmu.elements(given.name):
        texts = given.text.split()
        if len(texts) != len(array):
            raise LoomfmuError(f"{where} has {len(array)} elements, not {len(texts)}")
        values = [replace(given, name=port.own, text=text) for port, text in zip(array, texts, strict=True)]
        return next(filter(None, [apply(instance, each, unitless) for each in values]), "")
    port = instance.fmu.ports.get(instance.fmu.name_of(given.name))
    if port is None or given.kind in ("String", "Binary"):
        text = given.kind in ("String", "Binary")
        reason = "it is a text" if text else f"{instance.fmu.name} has no such variable"
        return f"{where} of the package is ignored: {reason}"
    if not port.settable:
        return f"{where} of the package is ignored: its FMU computes it"
    instance.values[port.name] = port.value(_value(port, given, where), where)
    if given.unit and given.unit.name != "1" and port.kind == "Real" and port.stated is None:
        unitless.append(f"{instance.name}.{port.name} in {given.unit.name}")
    return ""


def _value(port: Port, given: Given, where: str) -> float | bool | str:
    """A value in the unit of its variable."""
    if given.transformation != SAME and port.kind != "Real":
        raise LoomfmuError(f"{where}: a value of type {port.kind} cannot be transformed")
    if given.kind == "Boolean":
        if given.text not in ("true", "false", "1", "0"):
            raise LoomfmuError(f"{where} = {shown(given.text)} must be true or false")
        return given.text in ("true", "1")
    if given.kind in ("Enumeration", "Integer") and given.transformation == SAME:
        return given.text
    return given.number(port.stated, where)
