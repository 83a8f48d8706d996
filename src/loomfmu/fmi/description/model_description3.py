"""modelDescription.xml of an FMI 3.0 FMU, derived from a component's declarations."""

from xml.etree.ElementTree import Element, SubElement

from ...declaring.variables import NOTHING, TIME, Component, Variable, variables_of
from .model_description import (
    about,
    attributes_of,
    log_and_experiment,
    output_order,
    type_definitions,
    unit_definitions,
)
from .references import FIRST_REFERENCE
from .xml_text import text_of

FMI3_TYPES = {float: "Float64", int: "Int64", bool: "Boolean"}


def model_description3(component: type[Component], token: str, version: str) -> bytes:
    """The model description as XML text, the same bytes for the same declarations."""
    variables = variables_of(component)
    name = component.__name__
    root = Element(
        "fmiModelDescription",
        {"fmiVersion": "3.0", "modelName": name, "instantiationToken": token} | about(component, version),
    )
    common = {
        "modelIdentifier": name,
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
        "providesDirectionalDerivatives": "true",
        "providesAdjointDerivatives": "true",
    }
    if component.keeps == NOTHING:
        SubElement(root, "ModelExchange", common | {"needsCompletedIntegratorStep": "true"})
    order = str(output_order(component))
    steps = {"canHandleVariableCommunicationStepSize": "true", "maxOutputDerivativeOrder": order}
    SubElement(root, "CoSimulation", common | steps)
    unit_definitions(root, variables, also=("s",))
    type_definitions(root, name, variables, fmi=3)
    log_and_experiment(root, component)
    listed = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(variables, start=FIRST_REFERENCE):
        _variable(listed, reference, variable, name)
    SubElement(
        listed,
        "Float64",
        name="time",
        valueReference=str(_time_reference(variables)),
        causality="independent",
        variability="continuous",
        unit="s",
        description="Simulation time",
    )
    _structure(root, variables)
    return text_of(root)


def _variable(listed: Element, reference: int, variable: Variable, model: str) -> None:
    """One variable with its type, unit, limits and start: in FMI 3 all of them in one element."""
    kind = "Enumeration" if variable.choices else FMI3_TYPES[variable.type]
    about = {
        "name": variable.structured,
        "valueReference": str(reference),
        "causality": variable.causality,
        "variability": variable.variability,
        "description": variable.description,
    }
    if not variable.settable:
        about["initial"] = "calculated"
    SubElement(listed, kind, about | attributes_of(variable, model))


def _time_reference(variables: tuple[Variable, ...]) -> int:
    """The value reference of the time: the one after all others."""
    return FIRST_REFERENCE + len(variables)


def _structure(root: Element, variables: tuple[Variable, ...]) -> None:
    """Outputs with what they depend on (inputs, parameters and time), and the unknowns of the start."""
    references = {
        variable.name: reference for reference, variable in enumerate(variables, start=FIRST_REFERENCE)
    }
    references[TIME] = _time_reference(variables)
    inputs = [variable.name for variable in variables if variable.causality == "input"]
    parameters = [variable.name for variable in variables if variable.causality == "parameter"]
    structure = SubElement(root, "ModelStructure")
    outputs = [variable for variable in variables if variable.causality == "output"]
    for variable in outputs:
        needed = inputs if variable.depends is None else variable.depends
        timed = () if variable.depends == () else (TIME,)
        found = sorted({references[name] for name in (*needed, *parameters, *timed)})
        SubElement(
            structure,
            "Output",
            valueReference=str(references[variable.name]),
            dependencies=" ".join(map(str, found)),
        )
    for variable in outputs:
        SubElement(structure, "InitialUnknown", valueReference=str(references[variable.name]))
    for variable in variables:
        if variable.indicator:
            SubElement(structure, "EventIndicator", valueReference=str(references[variable.name]))
