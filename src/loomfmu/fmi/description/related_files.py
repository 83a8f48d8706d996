"""The files that come with an FMU, listed as the layered standard FMI-LS-REF says."""

from xml.etree.ElementTree import Element, SubElement

from ...declaring.variables import Component, variables_of
from .parameter_sets import parameter_sets
from .xml_text import text_of

STANDARD = "org.fmi-standard.fmi-ls-ref"
FOLDER = f"extra/{STANDARD}"
ROOT = "../.."  # of the FMU, from that folder
HEAD = {
    "xmlns:fmi-ls": "http://fmi-standard.org/fmi-ls-manifest",
    "fmi-ls:fmi-ls-name": STANDARD,
    "fmi-ls:fmi-ls-version": "1.0.0-alpha.1",
    "fmi-ls:fmi-ls-description": (
        "Layered Standard providing information on related files included in an FMU."
    ),
}
RESULT = "All outputs by default values, stepped from each of its times to the next"


def related_files(component: type[Component], reference: bytes | None) -> dict[str, bytes]:
    """The manifest and the reference results by their names in the FMU; none where there is nothing to list.

    A reference is left out if it is not of the component's outputs: a file called so may be anything.
    """
    root, files = Element("fmiReferences", HEAD), {}
    if reference is not None and reference.splitlines()[:1] == [_heads(component).encode()]:
        name = f"{component.__name__}_out.csv"
        files[f"{FOLDER}/{name}"] = reference
        _add(root, "text/csv", name, "result", RESULT)
    for each in parameter_sets(component):
        _add(root, "application/x-ssp-parameter-set", f"{ROOT}/{each.file}", "parameter", each.name)
    return files | {f"{FOLDER}/fmi-ls-manifest.xml": text_of(root)} if len(root) else {}


def _heads(component: type[Component]) -> str:
    outputs = (each.structured for each in variables_of(component) if each.causality == "output")
    return ",".join(["time", *outputs])


def _add(root: Element, kind: str, source: str, role: str, description: str) -> None:
    SubElement(root, "Related", type=kind, source=source, role=role, description=description)
