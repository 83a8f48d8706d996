"""The parameter values of a system package: sets, prefixes, mappings, units, and which of them prevails."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from ... import units
from ...errors import LoomfmuError
from ..importing.fmus import Port
from ..importing.ports import Definition, own_definition, own_name
from ..scenes.instances import Instance
from .xml import full, read_units, said

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
                yield Given(target, given.kind, given.text, given.unit, given.definition)


def _values(parameters: Element) -> Iterator[Given]:
    definitions = read_units(parameters.iterfind(full("ssv:Units")))
    for parameter in parameters.iterfind(f"{full('ssv:Parameters')}/{full('ssv:Parameter')}"):
        for value in parameter:
            kind = value.tag.rpartition("}")[2]
            if kind != "Annotations":
                unit = value.get("unit", "")
                text = said(value, "value")
                yield Given(said(parameter, "name"), kind, text, unit, definitions.get(unit))


def _mapping(binding: Element, read: Read) -> dict[str, list[str]]:
    """Which variables each name of a set stands for; nothing where names stand for themselves."""
    place = binding.find(full("ssd:ParameterMapping"))
    if place is None:
        return {}
    source = place.get("source")
    mapping = place.find(full("ssm:ParameterMapping")) if source is None else read(source)
    targets: dict[str, list[str]] = {}
    for entry in mapping.iterfind(full("ssm:MappingEntry")) if mapping is not None else ():
        if any(child.tag.endswith("Transformation") for child in entry):
            raise LoomfmuError(
                f"the mapping of {said(entry, 'source')} transforms its value: that is not done"
            )
        targets.setdefault(said(entry, "source"), []).append(said(entry, "target"))
    return targets


def apply(instance: Instance, given: Given) -> str:
    """Set a value of an instance, or say why it is left out, as the standard wants where names do not meet.

    Raises LoomfmuError for a value that the variable cannot have.
    """
    where = f"{instance.name}.{given.name}"
    port = instance.fmu.ports.get(instance.fmu.name_of(given.name))
    if port is None or given.kind in ("String", "Binary"):
        known = "a text" if given.kind in ("String", "Binary") else f"no variable of {instance.fmu.name}"
        return f"{where} of the package is {known}: it is left out"
    if port.causality not in ("parameter", "input"):
        return f"{where} of the package is neither parameter nor input: it is left out"
    instance.values[port.name] = port.value(_value(port, given, where), where)
    return ""


def _value(port: Port, given: Given, where: str) -> float | bool | str:
    """A value in the unit of its variable."""
    if given.kind == "Boolean":
        return given.text in ("true", "1")
    if given.kind in ("Enumeration", "Integer"):
        return given.text
    try:
        value = float(given.text)
    except ValueError:
        raise LoomfmuError(f"{where} = {given.text!r} is not a number") from None
    name = own_name(given.unit, given.definition) or given.unit
    if not given.unit or (port.has_unit and name == port.unit):
        return value
    if not port.has_unit:
        if name == "1":
            return value
        hint = f"--set {where.partition('.')[0]}.units.{port.name}=..."
        raise LoomfmuError(
            f"{where} = {given.text} {given.unit}, but the variable has no unit; say what it is: {hint}"
        )
    known = own_definition(name) if name in units.UNITS else None
    here, there = given.definition or known, port.definition
    if here and there and here.exponents == there.exponents and here.offset == there.offset == 0.0:
        return value * here.factor / there.factor
    raise LoomfmuError(f"{where} = {given.text} {given.unit}, which does not fit {units.fitted(port.unit)}")
