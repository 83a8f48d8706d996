"""Third-party system packages: nested systems, inline parameters, mappings, units, no text of ours."""

import zipfile
from pathlib import Path

import numpy as np
import pytest
from foreign_motors import motor2
from motor_scenes import MOTOR, WEFT, exact

from loomfmu import LoomfmuError
from loomfmu.cosim.importing import fmus
from loomfmu.cosim.run import Result, run
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.ssp import export as ssp
from loomfmu.cosim.ssp import read
from loomfmu.cosim.ssp.package import Package
from loomfmu.cosim.ssp.xml import NAMESPACES

DRIVE = """
<ssd:System name="drive">
  <ssd:Connectors><ssd:Connector name="phi" kind="output"/><ssd:Connector name="w" kind="output"/>
  <ssd:Connector name="free" kind="input"/></ssd:Connectors>
  <ssd:Elements><ssd:Component name="motor" source="resources/Motor.fmu">
    {connectors}<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
      <ssv:ParameterSet version="1.0" name="inline"><ssv:Parameters>
        <ssv:Parameter name="J"><ssv:Real value="7"/></ssv:Parameter>
        <ssv:Parameter name="mode"><ssv:Enumeration value="no_way_back"/></ssv:Parameter>
        <ssv:Parameter name="w_free"><ssv:Real value="572.957795130823" unit="rpm"/></ssv:Parameter>
        {more}
      </ssv:Parameters><ssv:Units><ssc:Unit name="rpm">
        <ssc:BaseUnit rad="1" s="-1" factor="0.104719755119660"/></ssc:Unit></ssv:Units></ssv:ParameterSet>
    </ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>
  </ssd:Component></ssd:Elements>
  <ssd:Connections>
    <ssd:Connection startElement="motor" startConnector="flange.phi" endConnector="phi">{transformed}
    </ssd:Connection>
    <ssd:Connection startConnector="w" endElement="motor" endConnector="flange.w"/>
    <ssd:Connection startConnector="free" endElement="motor" endConnector="load.tau"/>
  </ssd:Connections>
</ssd:System>
"""
STRUCTURE = """<?xml version="1.0"?>
<ssd:SystemStructureDescription version="1.0" name="elsewhere" {namespaces}>
<ssd:System name="all">
<ssd:Connectors><ssd:Connector name="load" kind="input"/></ssd:Connectors>
<ssd:ParameterBindings>
  <ssd:ParameterBinding source="resources/outer.ssv"/>
  <ssd:ParameterBinding source="resources/mapped.ssv" prefix="set."><ssd:ParameterMapping>
    <ssm:ParameterMapping version="1.0"><ssm:MappingEntry source="set.inertia" target="drive.motor.J"/>
    </ssm:ParameterMapping></ssd:ParameterMapping></ssd:ParameterBinding>
</ssd:ParameterBindings>
<ssd:Elements>{drive}
  <ssd:Component name="left head" source="resources/left%20head.fmu"/>{other}
</ssd:Elements>
<ssd:Connections>
  <ssd:Connection startElement="drive" startConnector="phi"
    endElement="left head" endConnector="shaft_angle"/>
  <ssd:Connection startElement="left head" startConnector="shaft_velocity"
    endElement="drive" endConnector="w"/>
  <ssd:Connection startConnector="load" endElement="drive" endConnector="free"/>{connection}
</ssd:Connections>
</ssd:System>
<ssd:DefaultExperiment {experiment}>{algorithm}</ssd:DefaultExperiment>
</ssd:SystemStructureDescription>
"""
ALGORITHM = (
    '<ssd:Annotations><ssc:Annotation type="com.opensimulationplatform"><osp:Algorithm>'
    '<osp:FixedStepAlgorithm baseStepSize="1e-3"/></osp:Algorithm></ssc:Annotation></ssd:Annotations>'
)
# OMSimulator says the step below the system
STEP_OF_OMS = (
    '</ssd:Connections><ssd:Annotations><ssc:Annotation type="org.openmodelica"><oms:Annotations'
    f' xmlns:oms="{NAMESPACES["oms"]}"><oms:SimulationInformation><oms:FixedStepMaster stepSize="0.002000"/>'
    "</oms:SimulationInformation></oms:Annotations></ssc:Annotation></ssd:Annotations><ssd:Connections>"
)


def parameter(name: str, kind: str, attributes: str) -> str:
    return f'<ssv:Parameter name="{name}"><ssv:{kind} {attributes}/></ssv:Parameter>'


SETS = {
    "outer": parameter("left head.follow_shaft", "Boolean", 'value="1"')
    + parameter("left head.inputs_at_step_end", "Boolean", 'value="false"')
    + parameter("left head.crank_length", "Real", 'value="15" unit="cm"'),
    "mapped": parameter("inertia", "Real", 'value="0.5"') + parameter("other", "Real", 'value="3"'),
}
CENTIMETRE = '<ssv:Units><ssc:Unit name="cm"><ssc:BaseUnit m="1" factor="0.01"/></ssc:Unit></ssv:Units>'
DECANEWTON = '<ssc:Unit name="daN.m"><ssc:BaseUnit kg="1" m="2" s="-2" factor="10"/></ssc:Unit></ssv:Units>'


def package(
    directory: Path, files: dict[str, bytes] | None = None, units: bool = True, **changed: str
) -> Path:
    """A motor in a system of its own that drives a rapier head; `files` are more, `changed` parts of it."""
    spaces = " ".join(f'xmlns:{key}="{NAMESPACES[key]}"' for key in ("ssd", "ssc", "ssv", "ssm", "osp"))
    parts = {
        "namespaces": spaces,
        "experiment": 'startTime="0" stopTime="0.2"',
        "algorithm": ALGORITHM,
        **dict.fromkeys(("other", "connection", "more", "transformed", "connectors"), ""),
        **changed,
    }
    parts["drive"] = DRIVE.format(**parts)
    sets = {
        f"resources/{name}.ssv": f'<ssv:ParameterSet version="1.0" name="{name}" {spaces}>'
        f"<ssv:Parameters>{text}</ssv:Parameters>{CENTIMETRE}</ssv:ParameterSet>"
        for name, text in SETS.items()
    }
    path = directory / "elsewhere.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("SystemStructure.ssd", STRUCTURE.format(**parts))
        archive.write(motor2(directory, units=units), "resources/Motor.fmu")
        archive.write(fmus.of_component("WeftInsertion").path, "resources/left head.fmu")
        for name, content in (sets | (files or {})).items():
            archive.writestr(name, content)
    return path


def ran(tmp_path: Path, overrides: dict[str, object] | None = None, **changed: str) -> Result:
    return run(package(tmp_path, **changed), set=overrides, output=tmp_path / "elsewhere.h5")


@pytest.mark.parametrize("isolated", [True, False])
def test_it_starts_when_it_says(tmp_path: Path, isolated: bool) -> None:
    overrides: dict[str, object] = {"isolated": isolated}
    first = ran(tmp_path, overrides).trace
    usual = {signal: np.asarray(first[signal]) for signal in first}
    later = ran(tmp_path, overrides, experiment='startTime="-1.5" stopTime="-1.3"').trace
    np.testing.assert_allclose(later.time, np.linspace(-1.5, -1.3, 201), rtol=0, atol=1e-12)
    # the motor adds up its own steps
    np.testing.assert_allclose(later["drive_motor.time_"], later.time, rtol=0, atol=1e-12)
    for signal in set(usual) - {"drive_motor.time_"}:  # nothing else depends on when it is
        np.testing.assert_allclose(later[signal], usual[signal], rtol=1e-9, atol=1e-9, err_msg=signal)


def test_it_runs_with_its_own_wires_parameters_and_step(tmp_path: Path) -> None:
    result = ran(tmp_path)
    assert (result.scene.title, result.scene.step, result.scene.steps) == ("elsewhere", 1e-3, 200)
    assert list(result.scene.instances) == ["drive_motor", "left_head"]
    assert {str(wire) for wire in result.scene.wires} == {
        "drive_motor.flange_phi -> left_head.shaft_angle",
        "drive_motor.flange_w -> left_head.shaft_velocity",
    }
    motor, head = (result.scene.instances[name].values for name in ("drive_motor", "left_head"))
    # the outer system's word holds against the inner one's; 572.96 rpm are 60 rad/s to twelve digits
    assert motor["J"] == 0.5 and motor["mode"] == 2
    assert motor["w_free"] == pytest.approx(60.0, rel=1e-12)
    assert head["crank_length"] == pytest.approx(0.15, rel=1e-15)
    assert head["follow_shaft"] is True and head["inputs_at_step_end"] is True  # as our master has it
    trace = result.trace
    np.testing.assert_allclose(trace["drive_motor.flange_phi"], exact(trace.time)[0], rtol=0, atol=1e-9)
    assert np.ptp(trace["left_head.travel"]) > 1.0
    assert len(list(trace)) == 7 + 7  # all outputs
    assert trace.attributes["scene"].startswith("<?xml")


@pytest.mark.parametrize("units", [True, False])
def test_a_scene_with_another_makers_fmu_goes_there_and_back(tmp_path: Path, units: bool) -> None:
    motor2(tmp_path, units=units)
    stated = {"flange_phi": "rad", "flange_w": "rad/s", "flange_a": "rad/s2", "J": "kg.m2"}
    table = ", ".join(f'{name} = "{unit}"' for name, unit in stated.items())
    own = f'J = 0.7\ntolerance = 1e-7\nmode = "no_way_back"\nunits = {{{table}}}\n'
    scene = scenes.parse(MOTOR + own + WEFT, "motor", directory=tmp_path)
    ssp.export(scene, tmp_path / "motor.ssp", "live")
    before = run(scene, output=tmp_path / "before.h5").trace
    again = run(tmp_path / "motor.ssp", output=tmp_path / "after.h5")
    after = again.trace
    assert again.scene.instances["motor"].fmu.tolerance == 1e-7
    assert set(before) == set(after)
    for signal in before:
        np.testing.assert_array_equal(before[signal], after[signal])
        assert before.unit(signal) == after.unit(signal)


def test_the_step_of_omsimulator_counts_where_no_other_is_said(tmp_path: Path) -> None:
    assert read.load(package(tmp_path, algorithm="", connection=STEP_OF_OMS)).step == 2e-3
    assert read.load(package(tmp_path, connection=STEP_OF_OMS)).step == 1e-3
    with pytest.raises(LoomfmuError, match="stepSize"):
        read.load(package(tmp_path, algorithm="", connection=STEP_OF_OMS.replace('stepSize="0.002000"', "")))


def test_duration_step_and_values_can_be_set(tmp_path: Path) -> None:
    changed = {"duration": "0.1 s", "step": "0.5 ms", "drive_motor.J": 1.0, "left_head.follow_shaft": "false"}
    result = ran(tmp_path, changed)
    assert (result.scene.steps, result.scene.instances["drive_motor"].values["J"]) == (200, 1.0)
    again = run(result.scene, set={"step": "1 ms"}, output=tmp_path / "again.h5")
    assert again.scene.steps == 200 and again.scene.instances["drive_motor"].values["J"] == 0.5


def test_a_set_in_the_structure_has_the_units_of_the_structure(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    own = '<ssc:Unit name="turns"><ssc:BaseUnit rad="1" s="-1" factor="6.25"/></ssc:Unit>'
    with_units = STRUCTURE.replace("<ssd:DefaultE", f"<ssd:Units>{own}</ssd:Units><ssd:DefaultE")
    monkeypatch.setitem(globals(), "STRUCTURE", with_units)
    result = ran(tmp_path, more=parameter("w_free", "Real", 'value="8" unit="turns"'))
    assert result.scene.instances["drive_motor"].values["w_free"] == 50.0


def test_what_names_no_variable_is_left_out_and_told(tmp_path: Path) -> None:
    given = (("gain", "Real"), ("label", "String"), ("flange.phi", "Real"))
    more = "".join(parameter(name, kind, 'value="3"') for name, kind in given)
    assert ran(tmp_path, more=more).warnings == (
        "drive_motor.gain of the package is ignored: Motor has no such variable",
        "drive_motor.label of the package is ignored: it is a text",
        "drive_motor.flange.phi of the package is ignored: its FMU computes it",
    )


def test_outputs_of_the_system_are_recorded_by_their_names(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    known = "".join(
        f'<ssd:Connector name="{name}" kind="{kind}"/>'
        for name, kind in (("the angle", "output"), ("twice", "output"), ("start", "parameter"))
    )
    ends = '<ssd:Connection startElement="drive" startConnector="phi" endConnector='
    twice = f'{ends}"twice"><ssc:LinearTransformation factor="2"/></ssd:Connection>'
    outer = STRUCTURE.replace("<ssd:Connectors>", f"<ssd:Connectors>{known}", 1)
    monkeypatch.setitem(globals(), "STRUCTURE", outer)
    result = ran(tmp_path, connection=f'{ends}"the angle"/>{twice}{ends}"start"/>')
    trace = result.trace
    np.testing.assert_array_equal(trace["all.the_angle"], trace["drive_motor.flange_phi"])
    assert trace.unit("all.the_angle") == "rad" and not {"all.twice", "all.start"} & set(trace)
    assert result.warnings == ("all.twice of the package is not recorded: a connection changes its value",)


def test_a_value_for_a_component_that_does_not_exist_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    more = parameter("lft head.crank_length", "Real", 'value="1"')
    monkeypatch.setitem(SETS, "outer", SETS["outer"] + more)
    assert ran(tmp_path).warnings == (
        "lft head.crank_length of the package is ignored: there is no such component",
    )


@pytest.mark.parametrize(
    ("given", "torque"),
    [
        (parameter("load", "Real", 'value="7"'), 7.0),
        (parameter("load", "Real", 'value="0.7" unit="daN.m"'), 7.0),
        (parameter("drive.free", "Real", 'value="5"'), 5.0),  # a connector of a system in the system
        (parameter("drive.free", "Real", 'value="5"') + parameter("load", "Real", 'value="7"'), 7.0),
        (parameter("load", "Real", 'value="7"') + parameter("drive.free", "Real", 'value="5"'), 7.0),
        (
            parameter("load", "Real", 'value="7"') + parameter("drive.motor.load.tau", "Real", 'value="3"'),
            7.0,
        ),
    ],
)
def test_a_value_of_a_system_connector_reaches_what_is_wired_to_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: str, torque: float
) -> None:
    monkeypatch.setitem(SETS, "outer", SETS["outer"] + given)
    monkeypatch.setitem(globals(), "CENTIMETRE", CENTIMETRE.replace("</ssv:Units>", DECANEWTON))
    result = ran(tmp_path)
    assert not result.warnings
    assert result.scene.instances["drive_motor"].values["load_tau"] == pytest.approx(torque, rel=1e-15)


def test_a_value_without_unit_has_that_of_its_system_connector(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    load = '<ssd:Connector name="load" kind="input"/>'
    stated = load.replace("/>", '><ssc:Real unit="daN.m"/></ssd:Connector>')
    units = DECANEWTON.replace("<ssc:Unit ", "<ssd:Units><ssc:Unit ").replace("</ssv:", "</ssd:")
    structure = STRUCTURE.replace(load, stated).replace("<ssd:DefaultE", f"{units}<ssd:DefaultE")
    monkeypatch.setitem(SETS, "outer", SETS["outer"] + parameter("load", "Real", 'value="0.7"'))
    monkeypatch.setitem(globals(), "STRUCTURE", structure)
    assert ran(tmp_path).scene.instances["drive_motor"].values["load_tau"] == pytest.approx(7.0, rel=1e-15)


def test_a_value_of_a_system_connector_that_an_output_drives_is_left_out_and_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(SETS, "outer", SETS["outer"] + parameter("drive.phi", "Real", 'value="1"'))
    assert ran(tmp_path).warnings == ("drive.phi of the package is ignored: no free input takes it",)


def test_an_empty_element_of_a_connection_is_the_system_around_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    spelt = '<ssd:Connection startConnector="load"'
    monkeypatch.setitem(globals(), "STRUCTURE", STRUCTURE.replace(spelt, spelt + ' startElement=""'))
    assert len(ran(tmp_path).scene.wires) == 2


def test_units_that_connectors_state_count_where_the_fmu_states_none(tmp_path: Path) -> None:
    stated = "".join(
        f'<ssd:Connector name="{name}" kind="{kind}"><ssc:Real unit="{unit}"/></ssd:Connector>'
        for name, kind, unit in (
            ("flange.phi", "output", "rad"),
            ("flange.w", "output", "rad/s"),
            ("w_free", "parameter", "rad/s"),
        )
    )
    bare = run(package(tmp_path, units=False), output=tmp_path / "x.h5")
    assert bare.warnings == (
        "values are taken as they are where the variable has no unit: drive_motor.w_free in rev/min;"
        " state it by --set drive_motor.units.w_free=...",
        "values pass unchanged on wires with a unit at one end only:"
        " drive_motor.flange_phi -> left_head.shaft_angle in rad and"
        " drive_motor.flange_w -> left_head.shaft_velocity in rad/s;"
        ' state the others in [units], as "drive_motor.flange_w" = "...",'
        " or by --set drive_motor.units.flange_w=...",
    )
    assert bare.scene.instances["drive_motor"].values["w_free"] == 572.957795130823
    connectors = f"<ssd:Connectors>{stated}</ssd:Connectors>"
    result = run(package(tmp_path, units=False, connectors=connectors), output=tmp_path / "x.h5")
    assert result.trace.unit("drive_motor.flange_w") == "rad/s"
    assert result.scene.instances["drive_motor"].values["w_free"] == pytest.approx(60.0, rel=1e-12)


def test_units_can_be_stated_by_hand(tmp_path: Path) -> None:
    units = {"w_free": "rad/s", "flange_phi": "rad", "flange_w": "rad/s"}
    overrides = {f"drive_motor.units.{name}": unit for name, unit in units.items()}
    path = package(tmp_path, units=False)
    result = run(path, set=overrides, output=tmp_path / "x.h5")
    assert not result.warnings and result.trace.unit("drive_motor.flange_w") == "rad/s"
    assert result.scene.instances["drive_motor"].values["w_free"] == pytest.approx(60.0, rel=1e-12)
    with pytest.raises(LoomfmuError, match=r"drive_motor\.units: .* variable 'x'"):
        run(path, set={"drive_motor.units.x": "m"}, output=tmp_path / "x.h5")


FREE = 'startConnector="free" endElement="motor" endConnector="load.tau"'
TWICE = '<ssc:LinearTransformation factor="2" offset="1"/>'


@pytest.mark.parametrize(
    ("given", "attributes", "torque"),
    [
        ('value="7"', "", 15.0),
        ('value="0.7" unit="daN.m"', "", 15.0),  # the unit first, then the transformation
        ('value="0.7" unit="daN.m"', 'suppressUnitConversion="true"', 2.4),
    ],
)
def test_a_connection_transforms_a_value_after_its_unit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, given: str, attributes: str, torque: float
) -> None:
    made = f"<ssd:Connection {FREE} {attributes}>{TWICE}</ssd:Connection>"
    monkeypatch.setitem(globals(), "DRIVE", DRIVE.replace(f"<ssd:Connection {FREE}/>", made))
    monkeypatch.setitem(SETS, "outer", SETS["outer"] + parameter("load", "Real", given))
    monkeypatch.setitem(globals(), "CENTIMETRE", CENTIMETRE.replace("</ssv:Units>", DECANEWTON))
    values = ran(tmp_path).scene.instances["drive_motor"].values
    assert values["load_tau"] == pytest.approx(torque, rel=1e-15)


def test_wires_convert_and_transform_on_their_way_through_systems(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    degrees = '<ssd:Connector name="phi" kind="output"><ssc:Real unit="deg"/></ssd:Connector>'
    plain = '<ssd:Connector name="phi" kind="output"/>'
    with monkeypatch.context() as spelt:
        spelt.setitem(globals(), "DRIVE", DRIVE.replace(plain, degrees))
        result = ran(tmp_path, transformed=TWICE)  # 2 * degrees(angle) + 1
    wire = next(each for each in result.scene.wires if each.sink == ("left_head", "shaft_angle"))
    assert wire.conversion.factor == pytest.approx(2.0, rel=1e-15)
    assert wire.conversion.offset == pytest.approx(np.radians(1.0), rel=1e-15)
    radians = TWICE.replace('"1"', '"0.017453292519943295"')
    plainly = run(package(tmp_path, transformed=radians), output=tmp_path / "plainly.h5").trace
    travel = result.trace["left_head.travel"], plainly["left_head.travel"]
    np.testing.assert_allclose(*travel, rtol=1e-12, atol=1e-12)


def test_a_mapping_transforms_its_value(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    entry = '<ssm:MappingEntry source="set.inertia" target="drive.motor.J"'
    spelt = STRUCTURE.replace(f"{entry}/>", f"{entry}>{TWICE}</ssm:MappingEntry>")
    monkeypatch.setitem(globals(), "STRUCTURE", spelt)
    assert ran(tmp_path).scene.instances["drive_motor"].values["J"] == 2.0


def test_a_plain_number_is_one_for_a_variable_without_unit(tmp_path: Path) -> None:
    more = parameter("tau_stall", "Real", 'value="130" unit="-"') + parameter("w_free", "Real", 'value="50"')
    stated = {
        f"drive_motor.units.{name}": unit
        for name, unit in (("w_free", "rad/s"), ("flange_phi", "rad"), ("flange_w", "rad/s"))
    }
    result = run(package(tmp_path, units=False, more=more), set=stated, output=tmp_path / "x.h5")
    assert result.scene.instances["drive_motor"].values["tau_stall"] == 130.0
    assert result.scene.instances["drive_motor"].values["w_free"] == 50.0


def component(attributes: str) -> dict[str, str]:
    return {"other": f'<ssd:Component name="x" {attributes}/>'}


def connected(start: str, end: str) -> dict[str, str]:
    """One more connection; an end without a dot is a connector of the whole system."""
    ends = []
    for which, (element, _, connector) in (("start", start.rpartition(".")), ("end", end.rpartition("."))):
        ends += [f'{which}Element="{element}"'] * bool(element) + [f'{which}Connector="{connector}"']
    return {"connection": f"<ssd:Connection {' '.join(ends)}/>"}


def valued(name: str, kind: str, value: str) -> dict[str, str]:
    return {"more": parameter(name, kind, f'value="{value}"')}


MISTAKES = {
    "startTime = 1e+10 s is not within 1e+09 s": {"experiment": 'startTime="1e10" stopTime="2e10"'},
    "duration = -1 is outside": {"experiment": 'startTime="2" stopTime="1"'},
    "duration is given but not step": {"algorithm": ""},
    "there is no shaft whose speed sets the step: add duration": {"algorithm": "", "experiment": ""},
    "connection drive.motor.flange.phi -> drive.phi: IntegerMappingTransformation is not supported, only": {
        "transformed": "<ssc:IntegerMappingTransformation/>"
    },
    "drive.free and drive.motor.load.tau are connected in two different ways": {
        "transformed": f"</ssd:Connection><ssd:Connection {FREE}>{TWICE}",
    },
    "resources/none.fmu is not in the package": component('source="resources/none.fmu"'),
    "../x.fmu is not in the package": component('source="../x.fmu"'),
    "http://host/x.fmu is not in the package": component('source="http://host/x.fmu"'),
    "Component has no source": component(""),
    "bus: there is no signal dictionary 'd'": {
        "other": '<ssd:SignalDictionaryReference name="bus" dictionary="d"/>'
    },
    "x is a Note: only FMUs, systems and dictionaries are supported": {"other": '<ssd:Note name="x"/>'},
    "x: 'a.mo' is not an FMU but 'text/x-modelica'": component('source="a.mo" type="text/x-modelica"'),
    "a.ssp is not in the package": component('source="a.ssp" type="application/x-ssp-package"'),
    "startIndices = '1' is not supported": {
        "connection": '<ssd:Connection startElement="drive" startConnector="phi" startIndices="1"'
        ' endElement="left head" endConnector="shaft_angle"/>'
    },
    "drive_motor.load.tau is connected to 2 outputs": {
        "connection": "".join(
            connected(f"left head.{output}", "drive.free")["connection"]
            for output in ("shaft_torque", "shaft_work")
        )
    },
    "left head.travel and drive.free are connected in two different ways": {
        "connection": connected("left head.travel", "load")["connection"]
        + connected("left head.travel", "drive.free")["connection"].replace(
            "/>", f">{TWICE}</ssd:Connection>"
        )
    },
    "connection from left head.travel is in m, left head.shaft_acceleration in rad/s2": connected(
        "left head.travel", "left head.shaft_acceleration"
    ),
    "connection to 'lft head.travel': there is no element 'lft head'; did you mean 'left head'?": connected(
        "lft head.travel", "drive.free"
    ),
    "connection to 'drive.fre': there is no connector of a system 'fre'; did you mean 'free'?": connected(
        "left head.travel", "drive.fre"
    ),
    "connection to 'lod': there is no connector of a system 'lod'; did you mean 'load'?": connected(
        "lod", "drive.free"
    ),
    "there are two elements called 'left head'": {
        "other": '<ssd:Component name="left head" source="resources/Motor.fmu"/>'
    },
    "drive_motor.verbose = 'yes' must be true or false": valued("verbose", "Boolean", "yes"),
    "drive_motor.mode = 99999999999999999999 must be 1 (both_ways) or 2 (no_way_back)": valued(
        "mode", "Integer", "99999999999999999999"
    ),
    "DefaultExperiment stopTime = 'late' is not a finite number": {"experiment": 'stopTime="late"'},
    "connection to left_head: WeftInsertion has no variable 'travl'; did you mean 'travel'?": connected(
        "left head.travl", "left head.shaft_acceleration"
    ),
    "drive_motor.w_free = 1 kg, which does not fit rad/s": valued("w_free", "Real", '1" unit="kg'),
    "drive_motor.J = 'one' is not a number": valued("J", "Real", "one"),
    "drive_motor.J = '1_0' is not a number": valued("J", "Real", "1_0"),
    "DefaultExperiment stopTime = '1_0' is not a finite number": {"experiment": 'stopTime="1_0"'},
    "drive_motor.J = -11 kg.m2 is outside [-10, inf] kg.m2": valued("J", "Real", "-11"),
}


@pytest.mark.few(8)
@pytest.mark.parametrize("said", MISTAKES)
def test_what_cannot_be_run_is_told_in_one_line(tmp_path: Path, said: str) -> None:
    with pytest.raises(LoomfmuError) as raised:
        ran(tmp_path, **MISTAKES[said])
    text = str(raised.value)
    assert text.startswith(f"{tmp_path}/elsewhere.ssp: ") and said in text and "\n" not in text


def test_one_fmu_under_two_names_is_unpacked_twice(tmp_path: Path) -> None:
    path, found = tmp_path / "two.ssp", []
    with zipfile.ZipFile(path, "w") as archive:
        for name in ("one.fmu", "other.fmu"):
            archive.writestr(name, b"the same")
    with Package(path) as opened:
        found = [opened.unpacked(name) for name in ("one.fmu", "other.fmu")]
    assert all(each.read_bytes() == b"the same" for each in found)  # another run may use the first


def test_nothing_is_written_outside_the_cache(tmp_path: Path) -> None:
    path = package(tmp_path, {"../../x.fmu": b"anything"}, **component('source="../../x.fmu"'))
    with pytest.raises(LoomfmuError, match=r"\.\./\.\./x\.fmu is not in the package$"):
        run(path, output=tmp_path / "x.h5")


@pytest.mark.parametrize(
    ("system", "said"),
    [("", "describes no system"), ('<ssd:System name="s"/>', "the system has no components")],
)
def test_a_system_without_components_is_told(tmp_path: Path, system: str, said: str) -> None:
    start = f'<ssd:SystemStructureDescription version="1.0" name="n" xmlns:ssd="{NAMESPACES["ssd"]}">'
    with zipfile.ZipFile(tmp_path / "bare.ssp", "w") as archive:
        archive.writestr("SystemStructure.ssd", f"{start}{system}</ssd:SystemStructureDescription>")
    with pytest.raises(LoomfmuError, match=said):
        run(tmp_path / "bare.ssp", output=tmp_path / "x.h5")
