"""The parameter values of a system package: sets, prefixes, mappings and units."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element

from ... import units
from ...errors import LoomfmuError, shown
from ..importing.fmus import Port
from ..importing.ports import Definition, own_definition, own_name
from ..scenes.instances import Instance
from .xml import full, read_units, required

Read = Callable[[str], Element]  # the root of an XML file in the package


@dataclass(frozen=True)
class Given:
    """A value as a parameter set has it."""

    name: str
    kind: str  # Real, Integer, Boolean, Enumeration, String, Binary
    text: str
    unit: str
    definition: Definition | None


def bound(element: Element, read: Read) -> Iterator[Given]:
    """The values that the bindings of a component or a system give, later ones before earlier."""
    for binding in element.iterfind(f"{full('ssd:ParameterBindings')}/{full('ssd:ParameterBinding')}"):
        inline = binding.find(f"{full('ssd:ParameterValues')}/{full('ssv:ParameterSet')}")
        source = binding.get("source")
        parameters = inline if inline is not None else read(source or "")
        targets = _mapping(binding, read)
        prefix = binding.get("prefix", "")
        for given in _values(parameters):
            name = prefix + given.name
            for target in targets.get(name, [] if targets else [name]):
                yield replace(given, name=target)


def _values(parameters: Element) -> Iterator[Given]:
    definitions = read_units(parameters.iterfind(full("ssv:Units")))
    for parameter in parameters.iterfind(f"{full('ssv:Parameters')}/{full('ssv:Parameter')}"):
        for value in parameter:
            kind = value.tag.rpartition("}")[2]
            if kind != "Annotations":
                unit = value.get("unit", "")
                text = required(value, "value")
                yield Given(required(parameter, "name"), kind, text, unit, definitions.get(unit))


def _mapping(binding: Element, read: Read) -> dict[str, list[str]]:
    """Return the variables that each name of a set stands for; nothing if names stand for themselves."""
    place = binding.find(full("ssd:ParameterMapping"))
    if place is None:
        return {}
    source = place.get("source")
    mapping = place.find(full("ssm:ParameterMapping")) if source is None else read(source)
    targets: dict[str, list[str]] = {}
    for entry in mapping.iterfind(full("ssm:MappingEntry")) if mapping is not None else ():
        if any(child.tag.endswith("Transformation") for child in entry):
            raise LoomfmuError(
                f"the mapping of {required(entry, 'source')} transforms its value;"
                " transformations are not supported"
            )
        targets.setdefault(required(entry, "source"), []).append(required(entry, "target"))
    return targets


def apply(instance: Instance, given: Given) -> str:
    """Set a value of an instance, or return why it is ignored, as the standard has it for unknown names.

    Raises LoomfmuError for a value that the variable cannot have.
    """
    where = f"{instance.name}.{given.name}"
    port = instance.fmu.ports.get(instance.fmu.name_of(given.name))
    if port is None or given.kind in ("String", "Binary"):
        text = given.kind in ("String", "Binary")
        reason = "it is a text" if text else f"{instance.fmu.name} has no such variable"
        return f"{where} of the package is ignored: {reason}"
    if port.causality not in ("parameter", "input"):
        return f"{where} of the package is ignored: it is neither a parameter nor an input"
    instance.values[port.name] = port.value(_value(port, given, where), where)
    return ""


def _value(port: Port, given: Given, where: str) -> float | bool | str:
    """A value in the unit of its variable."""
    if given.kind == "Boolean":
        if given.text not in ("true", "false", "1", "0"):
            raise LoomfmuError(f"{where} = {shown(given.text)} must be true or false")
        return given.text in ("true", "1")
    if given.kind in ("Enumeration", "Integer"):
        return given.text
    try:
        value = float(given.text)
    except ValueError:
        raise LoomfmuError(f"{where} = {shown(given.text)} is not a number") from None
    name = own_name(given.unit, given.definition) or given.unit
    if not given.unit or (port.has_unit and name == port.unit):
        return value
    if not port.has_unit:
        if name == "1":
            return value
        hint = f"--set {where.partition('.')[0]}.units.{port.name}=..."
        raise LoomfmuError(
            f"{where} = {given.text} {given.unit}, but the variable has no unit; state it: {hint}"
        )
    known = own_definition(name) if name in units.UNITS else None
    here, there = given.definition or known, port.definition
    if here and there and here.exponents == there.exponents and here.offset == there.offset == 0.0:
        return value * here.factor / there.factor
    raise LoomfmuError(f"{where} = {given.text} {given.unit}, which does not fit {units.fitted(port.unit)}")
