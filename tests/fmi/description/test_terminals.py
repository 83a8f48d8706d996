"""Terminals: one connection wires what belongs together, as FMI 3.0 has it and FMI 2.0.4 takes it over."""

import zipfile
from pathlib import Path
from xml.etree.ElementTree import fromstring

import fmpy
import pytest
from live_fmus import COMPONENTS, NAMES
from lxml import etree

from loomfmu.cosim.importing import fmus
from loomfmu.declaring.variables import variables_of
from loomfmu.fmi.description.terminals import FILE
from loomfmu.fmi.native import native_fmu

every_fmu = pytest.mark.parametrize("name", NAMES)
SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi3" / "fmi3TerminalsAndIcons.xsd"


def terminals(name: str) -> dict[str, tuple[str, dict[str, str]]]:
    """Kind and members of each terminal, as a tool finds them in the FMU."""
    with zipfile.ZipFile(fmus.of_component(name).path) as zipped:
        if FILE not in zipped.namelist():
            return {}
        root = fromstring(zipped.read(FILE))
    assert root.attrib == {"fmiVersion": "3.0"}
    found = {}
    for terminal in root.iterfind("Terminals/Terminal"):
        assert terminal.attrib["matchingRule"] == "plug"
        assert {member.attrib["variableKind"] for member in terminal} == {"signal"}
        members = {member.attrib["memberName"]: member.attrib["variableName"] for member in terminal}
        found[terminal.attrib["name"]] = (terminal.attrib["terminalKind"], members)
    return found


@every_fmu
def test_the_file_keeps_to_the_schema(name: str) -> None:
    with zipfile.ZipFile(fmus.of_component(name).path) as zipped:
        if FILE in zipped.namelist():
            etree.XMLSchema(etree.parse(SCHEMA)).assertValid(etree.fromstring(zipped.read(FILE)))
        assert (FILE in zipped.namelist()) == bool(COMPONENTS[name].terminals)


@every_fmu
def test_members_are_variables_of_the_model_description(name: str) -> None:
    description = fmpy.read_model_description(str(fmus.of_component(name).path))
    known = {variable.name for variable in description.modelVariables}
    for _kind, members in terminals(name).values():
        assert set(members.values()) <= known


def outputs(name: str) -> set[str]:
    """The outputs of a component."""
    return {variable.name for variable in variables_of(COMPONENTS[name]) if variable.causality == "output"}


def wires(source: str, sink: str) -> dict[str, str]:
    """What a connection of the terminals that fit wires, by the rule `plug`."""
    (joined,) = [
        (from_, to)
        for kind, from_ in terminals(source).values()
        for other, to in terminals(sink).values()
        if kind == other
        and set(from_) == set(to)
        and set(from_.values()) <= outputs(source)
        and not set(to.values()) & outputs(sink)
    ]
    return {joined[1][member]: joined[0][member] for member in joined[0]}


@pytest.mark.parametrize("shaft", ["MainShaft", "DrivenShaft"])
@pytest.mark.parametrize(
    "driven", ["WeftInsertion", "BeltMonitor", "DobbyDrive", "PatternLock", "ReedBeatUp", "DetachingRoller"]
)
def test_one_connection_wires_the_shaft(shaft: str, driven: str) -> None:
    assert wires(shaft, driven) == {
        "shaft_angle": "angle",
        "shaft_velocity": "velocity",
        "shaft_acceleration": "acceleration",
    }


def test_one_connection_wires_head_rotor_and_frame() -> None:
    assert set(terminals("WeftInsertion")) == {"shaft", "head"}
    head, known = terminals("BeltMonitor")["head"], ("travel", "velocity", "acceleration")
    assert head == ("org.pypi.loomfmu.head", {name: name for name in known})
    rotor = ("rotor_angle", "rotor_velocity", "rotor_acceleration")
    lift = ("lift_fraction", "lift_rate", "lift_acceleration")
    assert wires("DobbyDrive", "HealdFrame") == {name: name for name in (*rotor, *lift)}
    for sink in ("HealdDamper", "WarpTension"):
        assert wires("HealdFrame", sink) == {n: n for n in ("lift", "velocity", "acceleration")}
    for sink in ("WarpTension", "HealdPlay"):
        carried = {n: f"carrier_{n}" for n in ("lift", "velocity", "acceleration")}
        assert wires("HealdDamper", sink) == carried


@pytest.mark.parametrize("fmi", [2, 3])
def test_native_fmus_have_the_same_file(monkeypatch: pytest.MonkeyPatch, fmi: int) -> None:
    monkeypatch.setattr(native_fmu, "binaries", lambda *_rest: {})
    with zipfile.ZipFile(fmus.of_component("BeltMonitor").path) as zipped:
        wanted = zipped.read(FILE)
    assert native_fmu.contents(COMPONENTS["BeltMonitor"], ("linux64",), fmi)[FILE] == wanted
