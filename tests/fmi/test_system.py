"""Several components as one: what their variables become, and how a host may wire them."""

from xml.etree.ElementTree import Element, fromstring

import pytest

from loomfmu.components import COMPONENTS
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi.description.model_description import model_description, model_description3
from loomfmu.fmi.description.terminals import FILE, terminal_files
from loomfmu.fmi.system.system import Drive, Part, System, component_of

MARGIN, TRAVEL, CLEARANCE = "belt.margin", "weft.travel", "belt.guide_clearance"
OUTPUTS = frozenset([MARGIN, TRAVEL, "weft.velocity", "weft.acceleration", CLEARANCE, "heald_1.lift"])


@pytest.fixture(scope="module")
def system() -> System:
    """A weft insertion whose shaft is left open, a belt on it, and a frame that nothing turns."""
    motion = ("travel", "velocity", "acceleration")
    return System(
        name="system",
        title="A system",
        description="",
        parts=(
            Part("weft", COMPONENTS["WeftInsertion"], {"follow_shaft": True}),
            Part("belt", COMPONENTS["BeltMonitor"], {"inputs_at_step_end": True}),
            Part("heald_1", COMPONENTS["HealdFrame"], {"pattern_1": 2}),
        ),
        wires={f"belt.{name}": f"weft.{name}" for name in motion},
        drives={CLEARANCE: Drive((0.0, 1.0), (3e-4, 1e-3), held=False)},
        outputs=OUTPUTS,
        experiment=(2.0, 1e-3),
        step=1e-3,
    )


def test_variables_are_those_of_the_parts(system: System) -> None:
    variables = {v.name: v for v in variables_of(component_of(system))}
    assert next(iter(variables)) == "step"
    assert {name for name, v in variables.items() if v.causality == "output"} == OUTPUTS
    assert variables["belt.travel"].causality == "local"  # it is wired
    assert variables["weft.shaft_torque"].causality == "local"  # it is not an output of the system
    assert variables["weft.shaft_angle"].causality == "input"
    assert variables["weft.follow_shaft"].start is True
    assert variables["heald_1.pattern_1"].start == 2
    shown = {name: variables[name].structured for name in (MARGIN, "heald_1.pattern_1", "belt.travel")}
    assert list(shown.values()) == [MARGIN, "heald_1.pattern[1]", "internal.belt.travel"]
    assert variables[TRAVEL].rate == "weft.velocity"


def _named(root: Element, tag: str) -> dict[str, Element]:
    return {each.get("name", ""): each for each in root.iter(tag)}


def test_an_output_depends_on_what_leads_to_it_from_outside(system: System) -> None:
    root = fromstring(model_description(component_of(system), "", ""))
    listed = list(_named(root, "ScalarVariable"))
    needs = {}
    for each in root.findall("ModelStructure/Outputs/Unknown"):
        places = each.get("dependencies", "").split()
        needs[listed[int(each.get("index", "")) - 1]] = [listed[int(place) - 1] for place in places]
    shaft = [f"weft.shaft_{name}" for name in ("angle", "velocity", "acceleration")]
    rotor = {f"heald_1.rotor_{name}" for name in ("angle", "velocity", "acceleration")}
    assert needs[TRAVEL] == shaft
    assert set(shaft) <= set(needs[MARGIN])
    assert not [name for name in needs[MARGIN] if name in ("belt.travel", CLEARANCE)]
    assert needs[CLEARANCE] == []  # it follows a table
    assert rotor <= set(needs["heald_1.lift"])
    start = {
        listed[int(each.get("index", "")) - 1]: {
            listed[int(place) - 1] for place in each.get("dependencies", "").split()
        }
        for each in root.findall("ModelStructure/InitialUnknowns/Unknown")
    }
    assert {"weft.shaft_angle", "weft.follow_shaft"} <= start[TRAVEL] and "heald_1.stroke" not in start[
        TRAVEL
    ]
    assert start[CLEARANCE] == set()
    experiment = root.find("DefaultExperiment")
    assert experiment is not None
    assert (experiment.get("stopTime"), experiment.get("stepSize")) == ("2.0", "0.001")


def test_outputs_list_time_and_inputs_in_fmi_3_but_no_parameters(system: System) -> None:
    root = fromstring(model_description3(component_of(system), "", ""))
    listed = {each.get("valueReference"): each for each in root.iter() if each.get("causality")}
    needs = {
        listed[each.get("valueReference")].get("name"): each.get("dependencies", "").split()
        for each in root.findall("ModelStructure/Output")
    }
    assert needs.keys() == OUTPUTS
    kinds = {listed[each].get("causality") for needed in needs.values() for each in needed}
    assert kinds == {"input", "independent"}  # it keeps what its belt has seen, so parameters are fixed
    (time,) = (reference for reference, each in listed.items() if each.get("name") == "time")
    assert {name for name, needed in needs.items() if time not in needed} == {"heald_1.lift"}


def test_terminals_are_those_whose_members_all_lead_outside(system: System) -> None:
    root = fromstring(terminal_files(component_of(system))[FILE])
    kinds = {name: each.get("terminalKind") for name, each in _named(root, "Terminal").items()}
    assert kinds == {
        "weft.shaft": "org.pypi.loomfmu.shaft",
        "weft.head": "org.pypi.loomfmu.head",
        "belt.shaft": "org.pypi.loomfmu.shaft",
        "heald_1.rotor": "org.pypi.loomfmu.rotor",
    }
