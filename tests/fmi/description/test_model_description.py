"""modelDescription.xml against the rules of FMI, the declarations, and what the components really do."""

import math
from pathlib import Path
from xml.etree.ElementTree import Element, fromstring

import fmpy.validation
import pytest
from live_fmus import COMPONENTS, NAMES

from loomfmu import units
from loomfmu.cosim.importing import fmus
from loomfmu.declaring.variables import Variable, variables_of
from loomfmu.fmi.dataflow.dependencies import dependencies
from loomfmu.fmi.description.model_description import model_description
from loomfmu.fmi.live.live_slave import CATEGORIES
from loomfmu.version import __version__

every_fmu = pytest.mark.parametrize("name", NAMES)


def xml(name: str) -> Element:
    return fromstring(model_description(COMPONENTS[name], "{guid}", "1.0"))


def listed(name: str) -> list[tuple[Variable, Element, Element]]:
    """Each declared variable with its element and the element of its type."""
    elements = xml(name).findall("ModelVariables/ScalarVariable")
    declared = variables_of(COMPONENTS[name])
    return [(variable, e, e[0]) for variable, e in zip(declared, elements, strict=True)]


@pytest.mark.few(5)
@every_fmu
def test_fmpy_finds_no_fault(name: str) -> None:
    assert fmpy.validation.validate_fmu(str(fmus.of_component(name).path)) == []


@every_fmu
def test_head(name: str) -> None:
    root = xml(name)
    assert root.attrib["fmiVersion"] == "2.0"
    assert root.attrib["modelName"] == name
    assert root.attrib["description"]
    kind = root.find("CoSimulation")
    assert kind is not None
    assert kind.attrib["modelIdentifier"] == name
    yes = {key for key, value in kind.attrib.items() if value == "true"}
    assert yes == {
        "canHandleVariableCommunicationStepSize",
        "canNotUseMemoryManagementFunctions",
        "canGetAndSetFMUstate",
        "canSerializeFMUstate",
    }
    experiment = root.find("DefaultExperiment")
    assert experiment is not None
    assert experiment.attrib == {
        "startTime": "0",
        "stopTime": "1.0",
        "tolerance": "1e-06",
        "stepSize": "0.0001",
    }
    categories = {category.attrib["name"] for category in root.findall("LogCategories/Category")}
    assert categories == {"logStatusWarning", "logStatusDiscard", "logStatusError"}
    assert categories == {category for category, _description in CATEGORIES.values()}


def test_author_and_date_are_those_of_the_version() -> None:
    root, house = xml("MainShaft"), Path(__file__).parents[3]
    assert root.attrib["copyright"] in (house / "LICENSE").read_text()
    assert root.attrib["copyright"].endswith(root.attrib["author"])
    day = root.attrib["generationDateAndTime"].removesuffix("T00:00:00Z")
    # a new version brings a new date
    assert f"## {__version__} ({day})" in (house / "CHANGELOG.md").read_text()


@every_fmu
def test_quantities_are_those_of_the_units(name: str) -> None:
    for variable, _element, kind in listed(name):
        shown = variable.type is float and variable.causality != "local"
        wanted = units.QUANTITIES.get(variable.unit) if shown else None
        assert kind.attrib.get("quantity") == wanted
        # a number, or a rate of one, can be anything; Modelica's library names no rate of power or force
        assert not shown or (wanted is None) == (variable.unit in ("1", "1/s", "1/s2", "W/s", "N/s"))


@every_fmu
def test_names_are_structured_and_those_of_the_declarations_in_scenes(name: str) -> None:
    root, declared = xml(name), variables_of(COMPONENTS[name])
    assert root.attrib["variableNamingConvention"] == "structured"
    names = [element.attrib["name"] for element in root.iterfind("ModelVariables/ScalarVariable")]
    for array in {text.partition("[")[0] for text in names if "[" in text}:
        places = [place for place, text in enumerate(names) if text.startswith(f"{array}[")]
        # all elements, from 1 on, one after the other: what the standard asks of an array
        assert places == list(range(places[0], places[0] + len(places)))
        assert [names[place] for place in places] == [f"{array}[{n}]" for n in range(1, len(places) + 1)]
    ports = fmus.of_component(name).ports
    assert list(ports) == [variable.name for variable in declared]
    assert [port.own for port in ports.values()] == names
    for variable in declared:
        assert variable.structured.startswith("internal.") == (variable.causality == "local")


@every_fmu
def test_every_variable_is_told_as_it_is_declared(name: str) -> None:
    for reference, (variable, element, kind) in enumerate(listed(name), start=1):
        assert element.attrib["name"] == variable.structured
        assert element.attrib["valueReference"] == str(reference)
        assert element.attrib["causality"] == variable.causality
        assert element.attrib["variability"] == variable.variability
        assert element.attrib["description"] == variable.description
        expected = "Enumeration" if variable.choices else {float: "Real", int: "Integer", bool: "Boolean"}
        assert kind.tag == (expected if isinstance(expected, str) else expected[variable.type])
        # start values where the user sets them, and nowhere else
        assert ("start" in kind.attrib) == variable.settable
        assert element.attrib.get("initial") == (None if variable.settable else "calculated")
        if variable.settable and variable.type is not bool:
            assert variable.type(kind.attrib["start"]) == variable.start
        if variable.settable and variable.type is bool:
            assert kind.attrib["start"] == ("true" if variable.start else "false")


@every_fmu
def test_limits_nominals_and_units_are_told_as_they_are_declared(name: str) -> None:
    for variable, _element, kind in listed(name):
        given = kind.attrib
        if variable.type is float:
            assert given["unit"] == variable.unit
            assert given.get("displayUnit", variable.unit) == variable.display
            assert given.get("unbounded", "false") == ("true" if variable.unbounded else "false")
            assert (float(given["nominal"]) if "nominal" in given else None) == variable.nominal
        for key, value in (("min", variable.minimum), ("max", variable.maximum)):
            if variable.type is bool:
                assert key not in given
            else:
                assert (float(given[key]) if key in given else None) == value
        if variable.settable:
            assert variable.complaint(variable.start) == ""


@every_fmu
def test_every_unit_is_defined_by_its_si_exponents(name: str) -> None:
    root = xml(name)
    definitions = {unit.attrib["name"]: unit for unit in root.findall("UnitDefinitions/Unit")}
    assert set(definitions) == {v.unit for v in variables_of(COMPONENTS[name]) if v.type is float}
    for unit, definition in definitions.items():
        base = definition.find("BaseUnit")
        assert base is not None
        exponents = tuple(int(base.attrib.get(key, "0")) for key in ("kg", "m", "s", "rad", "K", "A"))
        assert exponents == units.unit(unit).dimension
        assert "factor" not in base.attrib  # SI itself
        for display in definition.findall("DisplayUnit"):
            # FMI: shown = factor * value in the unit
            shown = float(display.attrib["factor"]) * units.parse(f"1 {display.attrib['name']}", unit)
            assert math.isclose(shown, 1.0, rel_tol=1e-15)  # one division and one multiplication
    used = {(v.unit, v.display) for v in variables_of(COMPONENTS[name]) if v.type is float}
    defined = {
        (unit, display.attrib["name"])
        for unit, definition in definitions.items()
        for display in definition.findall("DisplayUnit")
    }
    assert defined == {(unit, display) for unit, display in used if unit != display}


def test_some_facts_spelt_out() -> None:
    shaft = {variable.name: (element, kind) for variable, element, kind in listed("MainShaft")}
    speed = shaft["speed"][1].attrib
    assert (speed["unit"], speed["displayUnit"]) == ("rad/s", "rev/min")
    assert math.isclose(float(speed["start"]) * 60 / (2 * math.pi), 400.0, rel_tol=1e-15)
    assert shaft["angle"][1].attrib["unbounded"] == "true"
    assert shaft["speed"][0].attrib["variability"] == "fixed"
    factor = {
        display.attrib["name"]: float(display.attrib["factor"])
        for display in xml("MainShaft").findall("UnitDefinitions/Unit/DisplayUnit")
    }
    assert math.isclose(factor["rev/min"], 9.549296585513721, rel_tol=1e-15)
    assert math.isclose(factor["deg"], 57.29577951308232, rel_tol=1e-15)
    base = xml("BeltMonitor").find("UnitDefinitions/Unit[@name='N.m2']/BaseUnit")
    assert base is not None
    assert base.attrib == {"kg": "1", "m": "3", "s": "-2"}
    law = xml("DobbyDrive").find("TypeDefinitions/SimpleType[@name='DobbyDrive.law']/Enumeration")
    assert law is not None
    assert [(item.attrib["name"], item.attrib["value"]) for item in law][:4] == [
        ("uniform", "1"),
        ("harmonic_ends", "2"),
        ("sloped_line", "3"),
        ("sloped_sine", "4"),
    ]


@every_fmu
def test_structure_lists_every_output_with_what_it_depends_on(name: str) -> None:
    """That the outputs depend on no others is tested of the components themselves."""
    root = xml(name)
    places = {variable.name: place for place, variable in enumerate(variables_of(COMPONENTS[name]), start=1)}
    inputs = {v.name for v in variables_of(COMPONENTS[name]) if v.causality == "input"}
    needs = dependencies(COMPONENTS[name])
    for tag, knowns, wanted in (("Outputs", inputs, needs.once), ("InitialUnknowns", {*places}, needs.start)):
        found = {
            int(unknown.attrib["index"]): {int(place) for place in unknown.attrib["dependencies"].split()}
            for unknown in root.findall(f"ModelStructure/{tag}/Unknown")
        }
        assert found == {
            places[output]: {places[each] for each in needed & knowns} for output, needed in wanted.items()
        }
