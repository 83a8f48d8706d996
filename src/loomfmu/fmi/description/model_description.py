"""modelDescription.xml of an FMI 2.0 or FMI 3.0 FMU, derived from a component's declarations."""

from xml.etree.ElementTree import Element, SubElement

from ... import units
from ...declaring.variables import NOTHING, TIME, Component, Variable, variables_of
from ..dataflow.dependencies import dependencies
from ..live.live_slave import CATEGORIES
from .references import FIRST_REFERENCE, FMI_TYPES
from .xml_text import text_of

AUTHOR = "the loomfmu authors"
COPYRIGHT = f"Copyright (c) 2026 {AUTHOR}"
RELEASED = "2026-11-21T00:00:00Z"  # the day of this version, not of the build: builds repeat
FMI3_TYPES = {float: "Float64", int: "Int64", bool: "Boolean"}
DEFAULT_TOLERANCE = 1e-6  # for hosts that ask for one; nothing here is solved to a tolerance


def model_description(
    component: type[Component], guid: str, version: str, native: dict[str, str] | None = None
) -> bytes:
    """The model description of FMI 2.0 as XML text, the same bytes for the same declarations.

    `native` holds what the native flavour can do beyond the live one.
    """
    variables = variables_of(component)
    name = component.__name__
    root = Element(
        "fmiModelDescription",
        {"fmiVersion": "2.0", "modelName": name, "guid": guid} | _about(component, version),
    )
    _interfaces(root, component, native)
    _unit_definitions(root, variables)
    _type_definitions(root, name, variables)
    _log_and_experiment(root, component)
    listed = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(variables, start=FIRST_REFERENCE):
        _scalar(listed, reference, variable, name)
    _structure(root, component)
    return text_of(root)


def _interfaces(root: Element, component: type[Component], native: dict[str, str] | None) -> None:
    """Co-simulation, and model exchange of a native component without memory, each with what it can do."""
    capabilities = {
        "modelIdentifier": component.__name__,
        "needsExecutionTool": "false",
        "canBeInstantiatedOnlyOncePerProcess": "false",
        "canNotUseMemoryManagementFunctions": str(native is None).lower(),
        "canGetAndSetFMUstate": "true",
        "canSerializeFMUstate": "true",
    }
    if native is not None:
        capabilities["providesDirectionalDerivative"] = str(component.derivatives).lower()
    steps = {"canHandleVariableCommunicationStepSize": "true", "canInterpolateInputs": "false"}
    interfaces = {"CoSimulation": capabilities | steps | (native or {})}
    if native is not None and component.keeps == NOTHING:
        indicators = sum(variable.indicator for variable in variables_of(component))
        root.set("numberOfEventIndicators", str(indicators))
        exchange = {"ModelExchange": capabilities | {"completedIntegratorStepNotNeeded": "false"}}
        interfaces = exchange | interfaces
    for interface, attributes in interfaces.items():
        element = SubElement(root, interface, attributes)
        if native is not None:
            SubElement(SubElement(element, "SourceFiles"), "File", name="fmi2.c")


def _log_and_experiment(root: Element, component: type[Component]) -> None:
    """Log categories and default experiment, which FMI 2 and FMI 3 write alike."""
    categories = SubElement(root, "LogCategories")
    for category, description in CATEGORIES.values():
        SubElement(categories, "Category", name=category, description=description)
    end, step_size = component.experiment
    SubElement(
        root,
        "DefaultExperiment",
        startTime="0",
        stopTime=repr(end),
        tolerance=repr(DEFAULT_TOLERANCE),
        stepSize=repr(step_size),
    )


def _about(component: type[Component], version: str) -> dict[str, str]:
    """Attributes of the model as a whole, the same in FMI 2 and FMI 3."""
    return {
        "description": (component.__doc__ or "").splitlines()[0],
        "author": AUTHOR,
        "version": version,
        "copyright": COPYRIGHT,
        "license": "MIT",
        "generationTool": f"loomfmu {version}",
        "generationDateAndTime": RELEASED,
        "variableNamingConvention": "structured",
    }


def _unit_definitions(root: Element, variables: tuple[Variable, ...], also: tuple[str, ...] = ()) -> None:
    """Every unit in use, with its SI exponents and its display units."""
    displays: dict[str, set[str]] = {name: {name} for name in also}
    for variable in variables:
        if variable.type is float:
            displays.setdefault(variable.unit, set()).add(variable.display)
    definitions = SubElement(root, "UnitDefinitions")
    for name in sorted(displays):
        known = units.unit(name)
        definition = SubElement(definitions, "Unit", name=name)
        exponents = zip(units.BASES, known.dimension, strict=True)
        SubElement(definition, "BaseUnit", {base: str(power) for base, power in exponents if power})
        for display in sorted(displays[name] - {name}):
            factor = known.factor / units.unit(display).factor
            SubElement(definition, "DisplayUnit", name=display, factor=repr(factor))


def _type_definitions(root: Element, name: str, variables: tuple[Variable, ...], fmi: int = 2) -> None:
    """An enumeration type for each variable that has choices."""
    chosen = [variable for variable in variables if variable.choices]
    if not chosen:
        return
    definitions = SubElement(root, "TypeDefinitions")
    for variable in chosen:
        simple = "SimpleType" if fmi == 2 else "EnumerationType"
        enumeration = SubElement(definitions, simple, name=f"{name}.{variable.name}")
        if fmi == 2:
            enumeration = SubElement(enumeration, "Enumeration")
        for value, choice in enumerate(variable.choices, start=1):
            SubElement(enumeration, "Item", name=choice, value=str(value))


def _scalar(listed: Element, reference: int, variable: Variable, model: str) -> None:
    """One variable with its type, unit, limits and start."""
    scalar = SubElement(
        listed,
        "ScalarVariable",
        name=variable.structured,
        valueReference=str(reference),
        causality=variable.causality,
        variability=variable.variability,
        description=variable.description,
    )
    if not variable.settable:
        scalar.set("initial", "calculated")
    kind = "Enumeration" if variable.choices else FMI_TYPES[variable.type]
    SubElement(scalar, kind, _attributes_of(variable, model))


def _attributes_of(variable: Variable, model: str) -> dict[str, str]:
    """Start, limits, unit and type of a variable, which FMI 2 and FMI 3 call by the same names."""
    attributes: dict[str, str] = {}
    if variable.settable:
        attributes["start"] = _text(variable.start)
    if variable.type is not bool:
        for key, value in (("min", variable.minimum), ("max", variable.maximum)):
            if value is not None:
                attributes[key] = _text(variable.type(value))
    if variable.type is float:
        if variable.quantity:
            attributes["quantity"] = variable.quantity
        attributes["unit"] = variable.unit
        if variable.display != variable.unit:
            attributes["displayUnit"] = variable.display
        if variable.nominal is not None:
            attributes["nominal"] = _text(variable.nominal)
        if variable.unbounded:
            attributes["unbounded"] = "true"
    if variable.choices:
        attributes["declaredType"] = f"{model}.{variable.name}"
    return attributes


def _text(value: float | int | bool) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)


def _structure(root: Element, component: type[Component]) -> None:
    """Outputs with the inputs they depend on, and those of the start with inputs and parameters.

    In FMI 2.0 there is no variable that is the time.
    """
    variables = variables_of(component)
    index = {v.name: str(place) for place, v in enumerate(variables, start=1)}
    needs, inputs = dependencies(component), [v.name for v in variables if v.causality == "input"]
    structure = SubElement(root, "ModelStructure")
    outputs = SubElement(structure, "Outputs")
    unknowns = SubElement(structure, "InitialUnknowns")
    for parent, knowns, found in ((outputs, inputs, needs.once), (unknowns, index, needs.start)):
        for output, needed in found.items():
            listed = " ".join(index[name] for name in knowns if name in needed)
            SubElement(parent, "Unknown", index=index[output], dependencies=listed)


def output_order(component: type[Component]) -> int:
    """Return how often the outputs can be differentiated by reading their declared rates."""
    rates = {variable.name: variable.rate for variable in variables_of(component)}
    longest = 0
    for variable in variables_of(component):
        order, rate = 0, variable.rate if variable.causality == "output" else None
        while rate is not None:
            order, rate = order + 1, rates[rate]
        longest = max(longest, order)
    return longest


# FMI 3.0


def model_description3(component: type[Component], token: str, version: str) -> bytes:
    """The model description of FMI 3.0 as XML text, the same bytes for the same declarations."""
    variables = variables_of(component)
    name = component.__name__
    root = Element(
        "fmiModelDescription",
        {"fmiVersion": "3.0", "modelName": name, "instantiationToken": token} | _about(component, version),
    )
    common = {
        "modelIdentifier": name,
        "canGetAndSetFMUState": "true",
        "canSerializeFMUState": "true",
        "providesDirectionalDerivatives": str(component.derivatives).lower(),
        "providesAdjointDerivatives": str(component.derivatives).lower(),
    }
    if component.keeps == NOTHING:
        SubElement(root, "ModelExchange", common | {"needsCompletedIntegratorStep": "true"})
    order = str(output_order(component))
    steps = {"canHandleVariableCommunicationStepSize": "true", "maxOutputDerivativeOrder": order}
    SubElement(root, "CoSimulation", common | steps)
    _unit_definitions(root, variables, also=("s",))
    _type_definitions(root, name, variables, fmi=3)
    _log_and_experiment(root, component)
    listed = SubElement(root, "ModelVariables")
    for reference, variable in enumerate(variables, start=FIRST_REFERENCE):
        _variable3(listed, reference, variable, name)
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
    _structure3(root, component)
    return text_of(root)


def _variable3(listed: Element, reference: int, variable: Variable, model: str) -> None:
    """One variable with its type, unit, limits and start, all of them in one element."""
    kind = "Enumeration" if variable.choices else FMI3_TYPES[variable.type]
    attributes = {
        "name": variable.structured,
        "valueReference": str(reference),
        "causality": variable.causality,
        "variability": variable.variability,
        "description": variable.description,
    }
    if not variable.settable:
        attributes["initial"] = "calculated"
    SubElement(listed, kind, attributes | _attributes_of(variable, model))


def _time_reference(variables: tuple[Variable, ...]) -> int:
    """The value reference of the time: the one after all others."""
    return FIRST_REFERENCE + len(variables)


def _structure3(root: Element, component: type[Component]) -> None:
    """Outputs with the knowns they depend on, and those of the start with theirs.

    What is listed is what there are derivatives by, so no parameters where they are fixed after the start.
    """
    variables = variables_of(component)
    references = {v.name: str(place) for place, v in enumerate(variables, start=FIRST_REFERENCE)}
    references[TIME] = str(_time_reference(variables))
    structure = SubElement(root, "ModelStructure")
    needs = dependencies(component)
    for tag, found in (("Output", needs.once), ("InitialUnknown", needs.start)):
        for output, needed in found.items():
            listed = " ".join(place for name, place in references.items() if name in needed)
            SubElement(structure, tag, valueReference=references[output], dependencies=listed)
    for variable in variables:
        if variable.indicator:
            SubElement(structure, "EventIndicator", valueReference=references[variable.name])
