"""Published machines and rapier heads as parameter sets inside an FMU (SSV of SSP 1.0): a host picks one."""

from dataclasses import dataclass, replace
from xml.etree.ElementTree import Element, SubElement

from ... import units
from ...declaring.variables import Component, variables_of
from ...machines import HEADS, MACHINES, Value, parameters
from .xml_text import text_of

SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
KINDS = {float: "Real", int: "Integer", bool: "Boolean"}

NOTE = """
## Parameter sets

The FMU brings the published values as parameter sets (SSV files of SSP 1.0), for hosts that can apply them:
{listed}
A set holds what the source says of that machine or head, in SI units, and nothing else. A machine's set and a
head's can be applied together.
"""


@dataclass(frozen=True)
class ParameterSet:
    """The published values of a machine or head that concern one component."""

    file: str
    name: str
    values: dict[str, Value]


def parameter_sets(component: type[Component]) -> list[ParameterSet]:
    """The sets that say something of a component."""
    model = component.__name__
    sets = [ParameterSet(f"machines/{name}", name, parameters(model, machine=name)) for name in MACHINES]
    sets += [ParameterSet(f"heads/{name}", name, parameters(model, head=name)) for name in HEADS]
    return [
        replace(each, file=f"resources/{each.file.replace(' ', '_')}.ssv") for each in sets if each.values
    ]


def parameter_files(component: type[Component], version: str) -> dict[str, bytes]:
    """The sets as files by their names in the FMU, the same bytes for the same values."""
    return {each.file: _text(component, each, version) for each in parameter_sets(component)}


def parameter_note(component: type[Component]) -> str:
    """Return the documentation of a component's parameter sets, or an empty text."""
    listed = "".join(f"\n- `{each.file}`: {each.name}" for each in parameter_sets(component))
    return NOTE.format(listed=f"{listed}\n") if listed else ""


def _text(component: type[Component], given: ParameterSet, version: str) -> bytes:
    variables = {variable.name: variable for variable in variables_of(component)}
    root = Element(
        "ssv:ParameterSet",
        {"xmlns:ssv": SSV, "xmlns:ssc": SSC},
        version="1.0",
        name=given.name,
        generationTool=f"loomfmu {version}",
    )
    listed = SubElement(root, "ssv:Parameters")
    used = set()
    for variable, value in given.values.items():
        kind = KINDS[variables[variable].type]
        attributes = {"value": str(value).lower() if kind == "Boolean" else repr(value)}
        if kind == "Real":
            attributes["unit"] = variables[variable].unit
            used.add(variables[variable].unit)
        SubElement(
            SubElement(listed, "ssv:Parameter", name=variables[variable].structured),
            f"ssv:{kind}",
            attributes,
        )
    section = SubElement(root, "ssv:Units")
    for unit in sorted(used):
        exponents = zip(units.BASES, units.unit(unit).dimension, strict=True)
        definition = SubElement(section, "ssc:Unit", name=unit)
        SubElement(definition, "ssc:BaseUnit", {base: str(power) for base, power in exponents if power})
    return text_of(root)
