"""Names and units as XML, for the writer and the reader of system packages."""

import math
from collections.abc import Iterable
from xml.etree.ElementTree import Element, SubElement

from ...errors import LoomfmuError, shown, within
from ...fmi.description.model_description import FMI3_TYPES
from ...fmi.description.parameter_sets import SSC, SSV
from ...fmi.description.references import FMI_TYPES
from ..importing.conversions import BASES, SAME, Definition, Linear
from ..importing.ports import Port

SSD_FILE = "SystemStructure.ssd"
PARAMETER_SET = "application/x-ssp-parameter-set"
FMU = "application/x-fmu-sharedlibrary"
SSP = "application/x-ssp-package"
OSP = "com.opensimulationplatform"  # annotation of the Open Simulation Platform: the step
OMS = "org.openmodelica"  # annotation of OMSimulator: its master and its step
OURS = "org.pypi.loomfmu"  # our own annotation: the text of the scene
TYPES_3 = {FMI_TYPES[kind]: name for kind, name in FMI3_TYPES.items()}  # what FMUs of FMI 3.0 have instead
NAMESPACES = {
    "ssd": "http://ssp-standard.org/SSP1/SystemStructureDescription",
    "ssc": SSC,
    "ssv": SSV,
    "ssb": "http://ssp-standard.org/SSP1/SystemStructureSignalDictionary",
    "ssm": "http://ssp-standard.org/SSP1/SystemStructureParameterMapping",
    "osp": "http://opensimulationplatform.com/SSP/OSPAnnotations",
    "oms": "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd",
    "loomfmu": "https://pypi.org/project/loomfmu/scene",
}


def root(tag: str, *prefixes: str, **attributes: str) -> Element:
    """A root element. Names are written with these prefixes, which some tools look for literally."""
    spaces = {f"xmlns:{prefix}": NAMESPACES[prefix] for prefix in prefixes}
    return Element(tag, spaces | attributes)


def of_ssp_2(document: Element) -> Element:
    """The same document of SSP 2.0, which has the types of FMI 3.0."""
    document.set("version", "2.0")
    for element in document.iter():
        prefix, _, kind = element.tag.partition(":")
        element.tag = f"{prefix}:{TYPES_3.get(kind, kind)}"
    return document


def full(name: str) -> str:
    """A prefixed name as ElementTree reads it.

    >>> full("ssc:Unit")
    '{http://ssp-standard.org/SSP1/SystemStructureCommon}Unit'
    """
    prefix, _, tag = name.partition(":")
    return f"{{{NAMESPACES[prefix]}}}{tag}"


def connector(parent: Element, name: str, kind: str, port: Port) -> Element:
    """Write a connector of a variable, with its type and its unit."""
    element = SubElement(parent, "ssd:Connector", name=name, kind=kind)
    SubElement(element, f"ssc:{port.kind}", {"unit": port.unit} if stated_unit(port) else {})
    return element


def stated_unit(port: Port) -> bool:
    """Return whether a package states the unit of a variable."""
    return port.kind == "Real" and port.has_unit and port.definition is not None


def write_units(parent: Element, tag: str, units: dict[str, Definition]) -> None:
    """A section with the definitions of units, if there are any."""
    if not units:
        return
    section = SubElement(parent, tag)
    for name, definition in sorted(units.items()):
        unit = SubElement(section, "ssc:Unit", name=name)
        exponents = zip(BASES, definition.exponents, strict=True)
        attributes = {base: str(power) for base, power in exponents if power}
        if definition.factor != 1.0:
            attributes["factor"] = repr(definition.factor)
        if definition.offset != 0.0:
            attributes["offset"] = repr(definition.offset)
        SubElement(unit, "ssc:BaseUnit", attributes)


def read_units(sections: Iterable[Element]) -> dict[str, Definition]:
    """The definitions in the sections of units of a file."""
    found = {}
    for section in sections:
        for unit in section.iterfind(full("ssc:Unit")):
            base = unit.find(full("ssc:BaseUnit"))
            if base is not None:
                with within(f"unit {shown(name := unit.get('name', ''))}"):
                    found[name] = _defined(base)
    return found


def _defined(base: Element) -> Definition:
    """The definition of a unit. Raises LoomfmuError."""
    exponents = [real(base, name, 0.0) for name in BASES]
    if not all(each.is_integer() for each in exponents):
        raise LoomfmuError("its exponents must be whole numbers")
    try:
        return Definition(tuple(map(int, exponents)), real(base, "factor", 1.0), real(base, "offset", 0.0))
    except ValueError as error:
        raise LoomfmuError(str(error)) from None


def transformed(element: Element, where: str) -> Linear:
    """The transformation of a connection or of a mapping. Raises LoomfmuError for one of another kind."""
    for child in element:
        if child.tag == full("ssc:LinearTransformation"):
            return Linear(real(child, "factor", 1.0), real(child, "offset", 0.0))
        if child.tag.endswith("Transformation"):
            kind = child.tag.rpartition("}")[2]
            raise LoomfmuError(f"{where}: {kind} is not supported, only LinearTransformation is")
    return SAME


def suppressed(element: Element) -> bool:
    """Return whether a connection or a mapping hands values over without converting units."""
    return element.get("suppressUnitConversion") in ("true", "1")


def required(element: Element, attribute: str) -> str:
    """An attribute that has to be there. Raises LoomfmuError where it is not."""
    value = element.get(attribute)
    if value is None:
        raise LoomfmuError(f"{element.tag.rpartition('}')[2]} has no {attribute}")
    return value


def number(text: str) -> float:
    """Return a number of XML, which has no `_` between its digits. Raises ValueError.

    >>> number(" 1.5 ")
    1.5
    """
    if "_" in text:
        raise ValueError
    return float(text)


def real(element: Element, attribute: str, default: float) -> float:
    """A finite number as an attribute. Raises LoomfmuError for anything else."""
    text = element.get(attribute)
    try:
        value = default if text is None else number(text)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        tag = element.tag.rpartition("}")[2]
        raise LoomfmuError(f"{tag} {attribute} = {shown(text)} is not a finite number")
    return value
