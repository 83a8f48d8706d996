"""The variables in a model description, FMI 2.0 and 3.0, of our FMUs and third-party ones."""

import itertools
import math
import re
from collections.abc import Collection, Iterable
from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import fromstring

import fmpy

from ...declaring.variables import ALONE, SHARED, Beside, Component, Variable, beside, variables_of
from ...errors import LONGEST_NAME, check_text, shown
from ...fmi.description.references import FIRST_REFERENCE, FMI_TYPES
from .conversions import BASES, Definition, own_definition, stated
from .ports import ELEMENT, RANGES, Port, Value, shown_in

# FMI type -> how scenes and the master know it; what is not here, such as String, is left out
KINDS = {
    "Real": "Real",
    "Integer": "Integer",
    "Enumeration": "Integer",
    "Boolean": "Boolean",
    "Float64": "Real",
    "Float32": "Real",
    **{f"{sign}Int{size}": "Integer" for sign in ("", "U") for size in (8, 16, 32, 64)},
}
MOST_ELEMENTS = 1000  # of an array that is exchanged
MOST_IN_ALL = 100_000  # of all of these in an FMU


def described(directory: Path) -> Any:
    """Read the model description of an FMU that is unpacked in a folder, whatever fmpy raises.

    What variables say of `relativeQuantity` is added: fmpy reads it of types alone.
    """
    description = fmpy.read_model_description(str(directory), validate=False)
    text = (directory / "modelDescription.xml").read_bytes()
    relative = dict[str | None, bool]()
    variables = fromstring(text).find("ModelVariables") if b"relativeQuantity" in text else None
    for element in () if variables is None else variables:
        said = [each.get("relativeQuantity") for each in (element, *element)]  # FMI 3.0, FMI 2.0
        if given := next(filter(None, said), ""):
            relative[element.get("name")] = given in ("true", "1")
    for variable in description.modelVariables:
        variable.relativeQuantity = relative.get(variable.name)
    return description


def is_ours(description: Any) -> bool:
    """Return whether an FMU states that this package made it."""
    return (description.generationTool or "").startswith("loomfmu ")


def exchange_of(description: Any) -> tuple[int, int, bool]:
    """The numbers of continuous states and of event indicators; whether the FMU is told of solver steps."""
    told = description.modelExchange.needsCompletedIntegratorStep
    return description.numberOfContinuousStates, description.numberOfEventIndicators, told


def ports_of(description: Any, component: type[Component] | None) -> dict[str, Port]:
    """The variables of the known types, elements of arrays each, by the names that scenes and traces use.

    `component` is the one that the FMU was made of, if it is known.
    """
    check_text(description.modelName or "", "modelName")
    _check(description.modelVariables)
    numbers = [v for v in description.modelVariables if v.type in KINDS]
    arrays = {v.valueReference: v.name for v in numbers if v.dimensions}
    sizes = (math.prod(v.shape) for v in numbers if v.dimensions)
    if sum(size for size in sizes if size <= MOST_ELEMENTS) > MOST_IN_ALL:
        raise ValueError(f"its arrays have more than {MOST_IN_ALL} elements")
    known = [each for v in numbers for each in _scalars(v)]
    recorded = {v.name for v in known if v.causality == "output"}
    names = dict(zip((v.name for v in known), plain_names((v.name for v in known), recorded), strict=True))
    if component is not None:
        declared = {v.structured: v.name for v in variables_of(component)}
        names = {name: declared.get(name, plain) for name, plain in names.items()}
    rates = _rates(description, names, component)
    definitions = {unit.name: _definition(unit.baseUnit) for unit in description.unitDefinitions}
    ports = [_port(variable, names[variable.name], rates, definitions) for variable in known]
    ports = [
        replace(port, array=arrays[port.reference % ELEMENT]) if port.reference >= ELEMENT else port
        for port in ports
    ]
    more = beside(component) if component else {}
    return {port.name: replace(port, beside=more.get(port.name, ALONE)) for port in ports}


def declared_ports(component: type[Component]) -> dict[str, Port]:
    """The variables of a component as `ports_of` would read them in the model description made of it."""
    numbered, more = enumerate(variables_of(component), start=FIRST_REFERENCE), beside(component)
    return {
        variable.name: _declared(variable, reference, more.get(variable.name, ALONE))
        for reference, variable in numbered
    }


def _declared(variable: Variable, reference: int, more: Beside) -> Port:
    real, number = variable.type is float, variable.type is not bool
    limits = (variable.minimum, variable.maximum) if number else (None, None)
    minimum, maximum = (None if each is None else variable.type(each) for each in limits)
    kind = FMI_TYPES[variable.type]
    unit = variable.unit if real else "1"
    return Port(
        name=variable.name,
        kind=kind,
        reference=reference,
        causality=variable.causality,
        unit=unit,
        display=shown_in(unit, variable.display if real else ""),
        minimum=minimum,
        maximum=maximum,
        start=variable.start if variable.settable else None,
        description=variable.description,
        choices=variable.choices,
        numbers=tuple(range(1, len(variable.choices) + 1)),
        rate=variable.rate,
        own=variable.structured,
        base_type="Enumeration" if variable.choices else kind,
        discrete=variable.variability == "discrete",
        definition=own_definition(unit),
        nominal=variable.nominal if real else None,
        beside=more,
    )


def unsupported_outputs(description: Any) -> tuple[str, ...]:
    """The outputs that have no ports: texts, binary values, clocks, arrays that are too large or empty."""
    outputs = [v for v in description.modelVariables if v.causality == "output"]
    return tuple(v.name for v in outputs if v.type not in KINDS or not _scalars(v))


def _scalars(variable: Any) -> list[Any]:
    """Return a scalar itself, or the elements of an array in their order; none of one that is too large.

    Raises ValueError where it has neither one start value nor one for each element.
    """
    if not variable.dimensions:
        return [variable]
    size = math.prod(variable.shape)
    if size > MOST_ELEMENTS:
        return []
    starts = [None] if variable.start is None else variable.start.split()
    if len(starts) not in (1, size):
        raise ValueError(f"{shown(variable.name)} has {size} elements and {len(starts)} start values")
    elements = []
    for number, place in enumerate(itertools.product(*(range(1, each + 1) for each in variable.shape))):
        element = copy(variable)
        element.name = f"{variable.name}[{','.join(map(str, place))}]"
        element.valueReference = variable.valueReference + ELEMENT * (number + 1)
        element.start = starts[number % len(starts)]
        element.derivative = None
        elements.append(element)
    return elements


def tolerance_of(description: Any) -> float | None:
    """Return the relative tolerance of the default experiment. Raises ValueError for one that cannot be."""
    experiment = description.defaultExperiment
    if experiment is None or experiment.tolerance is None:
        return None
    tolerance = float(experiment.tolerance)
    if not 0.0 < tolerance < math.inf:
        raise ValueError(f"DefaultExperiment tolerance = {tolerance:g} must be a finite number above 0")
    return tolerance


def _check(variables: Iterable[Any]) -> None:
    """Refuse what would let a value go to another variable. Raises ValueError."""
    names: set[str] = set()
    for variable in variables:
        name = variable.name
        if name in names:
            raise ValueError(f"two variables are called {shown(name)}")
        if not name or len(name) > LONGEST_NAME:
            raise ValueError(f"the name {shown(name)} has {len(name)} characters, not 1 to {LONGEST_NAME}")
        if not 0 <= variable.valueReference < 2**32:
            reference = shown(variable.valueReference)
            raise ValueError(f"{shown(name)} has the value reference {reference}, not a number of 32 bits")
        names.add(name)


def plain_names(names: Iterable[str], recorded: Collection[str] = ()) -> list[str]:
    """Names of letters, digits and _, a letter first, all different; `recorded` are those that a trace holds.

    >>> plain_names(["phi", "body.phi", "der(w)", "x[1]", "x_1", "time", "shaft.angle"], ["shaft.angle"])
    ['phi', 'body_phi', 'der_w', 'x_1', 'x_1_2', 'time_', 'shaft_angle_']
    """
    found: dict[str, None] = {}
    numbers: dict[str, int] = {}  # the last one that was tried for a name
    for name in names:
        plain = re.sub("[^A-Za-z0-9_]+", "_", name).strip("_") or "unnamed"
        plain = plain if plain[0].isalpha() else f"v_{plain}"
        # each group of a trace has these of its own; an input `shaft_angle` keeps its name, for the wires
        plain = f"{plain}_" if plain == "time" or (name in recorded and plain in SHARED) else plain
        free = plain
        while free in found:
            numbers[plain] = numbers.get(plain, 1) + 1
            free = f"{plain}_{numbers[plain]}"
        found[free] = None
    return list(found)


def _rates(description: Any, names: dict[str, str], component: type[Component] | None) -> dict[str, str]:
    """Return the outputs and their time derivatives, by our declarations or by the model description."""
    if component is not None:
        return {v.structured: v.rate for v in variables_of(component) if v.rate}
    return {
        variable.derivative.name: names[variable.name]
        for variable in description.modelVariables
        if variable.derivative is not None and variable.causality == "output" and variable.name in names
    }


def _definition(base: Any) -> Definition | None:
    if base is None:
        return None
    return Definition(tuple(getattr(base, name) for name in BASES), base.factor, base.offset)


def _port(variable: Any, name: str, rates: dict[str, str], definitions: dict[str, Definition | None]) -> Port:
    kind, declared = KINDS[variable.type], variable.declaredType
    items = declared.items if variable.type == "Enumeration" and declared else []
    choices = sorted((int(item.value), item.name) for item in items)
    values = [value for value, _name in choices]

    def said(attribute: str) -> Any:
        """An attribute of the variable, or else of its declared type."""
        own = getattr(variable, attribute)
        return own if own is not None or declared is None else getattr(declared, attribute)

    given = (said("unit") or "") if kind == "Real" else "1"
    unit = stated(given, definitions.get(given))
    name_of_unit = unit.name if unit else "1"
    return Port(
        name=name,
        kind=kind,
        reference=variable.valueReference,
        causality=variable.causality,
        unit=name_of_unit,
        display=shown_in(name_of_unit, said("displayUnit") or ""),
        minimum=min(values) if values else _limit(kind, said("min")),
        maximum=max(values) if values else _limit(kind, said("max")),
        start=None if variable.start is None else _start(variable.type, variable.start),
        description=variable.description or "",
        choices=tuple(choice for _value, choice in choices),
        numbers=tuple(values),
        rate=rates.get(variable.name),
        own=variable.name,
        base_type=variable.type,
        discrete=variable.variability == "discrete",
        has_unit=unit is not None,
        definition=unit.definition if unit else None,
        relative=bool(said("relativeQuantity")),
        nominal=_limit(kind, said("nominal")),
        exact=variable.causality in ("output", "local")
        and variable.initial == "exact"
        and variable.variability != "constant",
    )


def _limit(kind: str, text: str | None) -> float | None:
    """A limit that is one: tools write the largest numbers there are where there is none."""
    if kind == "Integer" and text is not None:
        return int(text)
    value = None if text is None else float(text)
    return None if value is None or math.isinf(value) else value


def _start(base_type: str, text: str) -> Value:
    """A start value. Raises ValueError for an integer that the type cannot hold."""
    kind = KINDS[base_type]
    if kind == "Boolean":
        return text in ("true", "1")
    if kind == "Real":
        return float(text)
    value, (low, high) = int(text), RANGES[base_type]
    if not low <= value <= high:
        raise ValueError(f"{shown(value)} is outside of what an {base_type} holds")
    return value
