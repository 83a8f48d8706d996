"""terminalsAndIcons.xml: which variables one connection wires, derived from a component's declarations.

FMI 2.0.4 takes the file over from FMI 3.0 as it is, under the same name.
"""

from xml.etree.ElementTree import Element, SubElement

from ...declaring.variables import Component, variables_of
from .xml_text import text_of

FILE = "terminalsAndIcons/terminalsAndIcons.xml"
KIND = "org.pypi.loomfmu"  # what is before the name of a kind of terminals, so that it is ours alone


def terminal_files(component: type[Component]) -> dict[str, bytes]:
    """The file by its name in the FMU; none where a component has no terminals."""
    if not component.terminals:
        return {}
    names = {variable.name: variable.structured for variable in variables_of(component)}
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    listed = SubElement(root, "Terminals")
    for terminal in component.terminals:
        element = SubElement(
            listed,
            "Terminal",
            name=terminal.name,
            matchingRule="plug",
            terminalKind=f"{KIND}.{terminal.kind}",
            description=terminal.description,
        )
        for member, variable in zip(terminal.members, terminal.variables, strict=True):
            SubElement(
                element,
                "TerminalMemberVariable",
                variableName=names[variable],
                memberName=member,
                variableKind="signal",
            )
    return {FILE: text_of(root)}
