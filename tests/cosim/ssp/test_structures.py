"""What systems are made of beside FMUs: packages in packages, signal dictionaries, arrays of SSP 2.0."""

import zipfile
from pathlib import Path

import numpy as np
import pytest
from foreign_motors import ARRAYS, description2, library, motor2, motor3
from foreign_motors import packed as packed_fmu

from loomfmu import LoomfmuError
from loomfmu.cosim.run import Result, run
from loomfmu.cosim.ssp.xml import NAMESPACES, SSP

SPACES = " ".join(f'xmlns:{key}="{NAMESPACES[key]}"' for key in ("ssd", "ssc", "ssv", "ssb"))
MOTOR = '<ssd:Component name="{}" source="resources/Motor.fmu"/>'
RPM = '<ssc:Unit name="rpm"><ssc:BaseUnit rad="1" s="-1" factor="0.10471975511965977"/></ssc:Unit>'


def packed(path: Path, system: str, files: dict[str, bytes], units: str = RPM) -> Path:
    """A package of a system and files."""
    with zipfile.ZipFile(path, "w") as archive:
        text = (
            f'<ssd:SystemStructureDescription version="2.0" name="n" {SPACES}><ssd:System name="s">{system}'
        )
        archive.writestr(
            "SystemStructure.ssd",
            f"{text}</ssd:System><ssd:Units>{units}</ssd:Units></ssd:SystemStructureDescription>",
        )
        for name, content in files.items():
            archive.writestr(f"resources/{name}", content)
    return path


def ran(path: Path) -> Result:
    return run(path, set={"duration": "20 ms", "step": "1 ms"}, output=path.with_suffix(".h5"))


def values(**given: str) -> str:
    """A binding with values."""
    text = "".join(
        f'<ssv:Parameter name="{name.replace("__", ".")}"><ssv:{each}/></ssv:Parameter>'
        for name, each in given.items()
    )
    return (
        "<ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>"
        f'<ssv:ParameterSet version="2.0" name="p"><ssv:Parameters>{text}</ssv:Parameters></ssv:ParameterSet>'
        "</ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>"
    )


def connection(start: str, end: str) -> str:
    ends = [
        f'{which}Element="{owner}" {which}Connector="{name}"'
        for which, (owner, _, name) in (("start", start.partition(".")), ("end", end.partition(".")))
    ]
    return f"<ssd:Connection {' '.join(ends)}/>"


def in_system(elements: str, *connections: str, before: str = "", after: str = "") -> str:
    """The content of a system."""
    wires = f"<ssd:Connections>{''.join(connections)}</ssd:Connections>" if connections else ""
    return f"{before}<ssd:Elements>{elements}</ssd:Elements>{wires}{after}"


def connectors(**units: str) -> str:
    listed = (
        f'<ssd:Connector name="{name}" kind="{kind}">'
        + (f'<ssc:Float64 unit="{unit}"/>' if unit else "")
        + "</ssd:Connector>"
        for name, (kind, _, unit) in ((name, each.partition(" ")) for name, each in units.items())
    )
    return f"<ssd:Connectors>{''.join(listed)}</ssd:Connectors>"


def packages(tmp_path: Path, units: str = RPM, source: str = "in.ssp") -> Path:
    """Two of a package with a motor, whose speed in rev/min is an output; the first drives the second."""
    motor = {"Motor.fmu": motor2(tmp_path).read_bytes()}
    own = values(m__J='Real value="2"', m__tau_stall='Real value="90"')
    ends = connectors(speed="output rpm", load="input N.m") + own
    wires = [
        '<ssd:Connection startElement="m" startConnector="flange.w" endConnector="speed"/>',
        '<ssd:Connection startConnector="load" endElement="m" endConnector="load.tau"/>',
    ]
    inner = packed(tmp_path / "in.ssp", in_system(MOTOR.format("m"), *wires, before=ends), motor)
    other = f'<ssd:Component name="{{}}" type="{SSP}" source="resources/{source}">{{}}</ssd:Component>'
    both = other.format("one", values(m__J='Real value="3"')) + other.format(
        "two", values(load='Real value="5"')
    )
    return packed(tmp_path / "out.ssp", in_system(both), {"in.ssp": inner.read_bytes()} | motor, units)


def test_a_package_in_a_package_is_a_system_of_it(tmp_path: Path) -> None:
    result = ran(packages(tmp_path))
    one, two = (result.scene.instances[f"{name}_m"].values for name in ("one", "two"))
    assert one == {"J": 3.0, "tau_stall": 90.0} and two == {"J": 2.0, "tau_stall": 90.0, "load_tau": 5.0}
    assert set(result.scene.instances) == {"one_m", "two_m"} and not result.warnings
    assert np.all(np.diff(result.trace["one_m.flange_w"]) > 0.0)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"units": RPM.replace("0.1047", "0.2")}, "resources/in.ssp defines the unit 'rpm' in another way"),
        ({"source": "none.ssp"}, "resources/none.ssp is not in the package"),
        ({"source": "Motor.fmu"}, "SystemStructure.ssd is not in the package"),
    ],
)
def test_a_package_that_does_not_fit_is_refused(tmp_path: Path, changed: dict[str, str], said: str) -> None:
    with pytest.raises(LoomfmuError, match=said):
        ran(packages(tmp_path, **changed))


BUS = '<ssd:SignalDictionaryReference name="{}" dictionary="bus">{}</ssd:SignalDictionaryReference>'
ENTRIES = (
    f'<ssb:SignalDictionary version="2.0" {SPACES}><ssb:DictionaryEntry name="w"><ssc:Real unit="rpm"/>'
    f"</ssb:DictionaryEntry><ssb:Units>{RPM}</ssb:Units></ssb:SignalDictionary>"
)


@pytest.mark.parametrize("inline", [True, False])
def test_a_signal_dictionary_joins_what_is_connected_to_an_entry_of_it(tmp_path: Path, inline: bool) -> None:
    reference = connectors(w="inout")
    below = in_system(BUS.format("there", reference) + MOTOR.format("b"), connection("there.w", "b.load.tau"))
    below = below.replace("<ssd:Connection ", '<ssd:Connection suppressUnitConversion="true" ')
    content = ENTRIES if inline else ""
    place = "" if inline else 'source="resources/bus.ssb"'
    system = in_system(
        BUS.format("here", reference) + MOTOR.format("a") + f'<ssd:System name="below">{below}</ssd:System>',
        connection("a.flange.w", "here.w"),
        after="<ssd:SignalDictionaries>"
        f'<ssd:SignalDictionary name="bus" {place}>{content}</ssd:SignalDictionary></ssd:SignalDictionaries>',
    )
    files = {"Motor.fmu": motor2(tmp_path).read_bytes(), "bus.ssb": ENTRIES.encode()}
    (wire,) = ran(packed(tmp_path / "bus.ssp", system, files)).scene.wires
    assert str(wire) == "a.flange_w -> below_b.load_tau"  # rad/s become rev/min in the dictionary
    assert wire.conversion.factor == pytest.approx(30.0 / np.pi, rel=1e-12)
    wrong = system.replace('name="w" kind="inout"', 'name="v" kind="inout"').replace(
        'Connector="w"', 'Connector="v"'
    )
    with pytest.raises(LoomfmuError, match="here: bus has no entry 'v'"):
        ran(packed(tmp_path / "wrong.ssp", wrong, files))


def test_an_input_that_is_connected_to_another_one_takes_the_same_value(tmp_path: Path) -> None:
    wires = connection("a.flange.w", "b.load.tau"), connection("b.load.tau", "c.load.tau")
    wires = tuple(
        each.replace("<ssd:Connection ", '<ssd:Connection suppressUnitConversion="true" ') for each in wires
    )
    system = in_system("".join(map(MOTOR.format, "abc")), *wires)
    found = ran(packed(tmp_path / "a.ssp", system, {"Motor.fmu": motor2(tmp_path).read_bytes()})).scene.wires
    assert [str(each) for each in found] == [f"a.flange_w -> {name}.load_tau" for name in "bc"]


def test_arrays_are_set_and_connected(tmp_path: Path) -> None:
    motor3(tmp_path, description=ARRAYS)
    one = MOTOR.replace("/>", ">{}</ssd:Component>").format("one", values(u='Float64 value="1 2 3 4"'))
    system = in_system(one + MOTOR.format("two"), connection("one.y", "two.u"))
    path = packed(tmp_path / "a.ssp", system, {"Motor.fmu": (tmp_path / "Motor3.fmu").read_bytes()})
    result = ran(path)
    assert result.scene.instances["one"].values == {
        f"u_{r}_{c}": 2.0 * r + c - 2.0 for r in (1, 2) for c in (1, 2)
    }
    assert len(result.scene.wires) == 4
    with pytest.raises(LoomfmuError, match=r"one\.u has 4 elements, not 3"):
        ran(
            packed(
                path,
                system.replace("1 2 3 4", "1 2 3"),
                {"Motor.fmu": (tmp_path / "Motor3.fmu").read_bytes()},
            )
        )


def test_a_connector_states_the_unit_of_an_array(tmp_path: Path) -> None:
    motor3(tmp_path, description=ARRAYS)
    parts = "".join(
        MOTOR.replace("/>", ">{}</ssd:Component>").format(name, connectors(**{end: unit}))
        for name, end, unit in (("one", "y", "output mm"), ("two", "u", "input m"))
    )
    system = in_system(parts, connection("one.y", "two.u"))
    path = packed(tmp_path / "a.ssp", system, {"Motor.fmu": (tmp_path / "Motor3.fmu").read_bytes()})
    assert {each.conversion.factor for each in ran(path).scene.wires} == {0.001}


@pytest.mark.parametrize(
    ("wire", "said"),
    [
        (
            connection("a.steps", "b.mode"),
            "connection a.steps -> b.mode: an output cannot give the value of a",
        ),
        (
            connection("a.steps", "b.hidden"),
            "connection to b.hidden: its causality is local, so it cannot be connected",
        ),
    ],
)
def test_what_takes_no_value_of_a_connection_is_told(tmp_path: Path, wire: str, said: str) -> None:
    hidden = '<ScalarVariable name="hidden" valueReference="0" causality="local"><Integer/></ScalarVariable>'
    described = description2().replace("</ModelVariables>", f"{hidden}</ModelVariables>")
    content = packed_fmu(tmp_path / "Motor.fmu", described, library("fmi2.c"), "Motor").read_bytes()
    with pytest.raises(LoomfmuError, match=said):
        ran(
            packed(
                tmp_path / "a.ssp",
                in_system(MOTOR.format("a") + MOTOR.format("b"), wire),
                {"Motor.fmu": content},
            )
        )


LOADED = '<ssd:Connection startConnector="{}" endElement="m" endConnector="load.tau"/>'


def test_a_system_may_have_a_dot_in_its_name(tmp_path: Path) -> None:
    inside = in_system(MOTOR.format("m"), LOADED.format("load"), before=connectors(load="input"))
    given = values(a__b__load='Real value="5"')
    system = in_system(f'<ssd:System name="a.b">{inside}</ssd:System>', before=given)
    content = motor2(tmp_path).read_bytes()
    result = ran(packed(tmp_path / "a.ssp", system, {"Motor.fmu": content}))
    assert result.scene.instances["a_b_m"].values == {"load_tau": 5.0} and not result.warnings


def test_values_from_two_connectors_to_one_input_are_refused(tmp_path: Path) -> None:
    before = connectors(load="input", more="input") + values(load='Real value="5"', more='Real value="6"')
    wires = map(LOADED.format, ("load", "more"))
    system = in_system(MOTOR.format("m"), *wires, before=before)
    content = motor2(tmp_path).read_bytes()
    said = r"m\.load\.tau takes the values of two connectors, load and more"
    with pytest.raises(LoomfmuError, match=said):
        ran(packed(tmp_path / "a.ssp", system, {"Motor.fmu": content}))


SET = (
    f'<ssv:ParameterSet version="2.0" name="p" {SPACES}><ssv:Parameters><ssv:Parameter name="J">'
    '<ssv:Real value="{}"/></ssv:Parameter></ssv:Parameters></ssv:ParameterSet>'
)
FROM_COMPONENT = (
    '<ssd:ParameterBindings><ssd:ParameterBinding source="resources/set.ssv" sourceBase="component"/>'
    "</ssd:ParameterBindings>"
)


@pytest.mark.parametrize("nested", [False, True])
def test_values_may_be_in_a_file_of_their_fmu(tmp_path: Path, nested: bool) -> None:
    fmu = motor2(tmp_path)
    with zipfile.ZipFile(fmu, "a") as archive:
        archive.writestr("resources/set.ssv", SET.format(3))
    files = {"Motor.fmu": fmu.read_bytes(), "set.ssv": SET.format(4).encode()}
    system = in_system(MOTOR.replace("/>", f">{FROM_COMPONENT}</ssd:Component>").format("m"))
    path = packed(tmp_path / "a.ssp", system, files)
    if nested:
        inner = f'<ssd:Component name="in" type="{SSP}" source="resources/a.ssp"/>'
        path = packed(tmp_path / "b.ssp", in_system(inner), {"a.ssp": path.read_bytes()})
    (motor,) = ran(path).scene.instances.values()
    assert motor.values == {"J": 3.0}


@pytest.mark.parametrize(
    ("system", "said"),
    [
        (
            in_system(MOTOR.replace("/>", f">{FROM_COMPONENT}</ssd:Component>").format("m")),
            r"a\.ssp: resources/Motor\.fmu: resources/set\.ssv is not in the package",
        ),
        (
            in_system(MOTOR.format("m"), before=FROM_COMPONENT),
            "is for the values of a component, not of a sys",
        ),
    ],
)
def test_a_file_that_is_not_in_a_component_is_told(tmp_path: Path, system: str, said: str) -> None:
    files = {"Motor.fmu": motor2(tmp_path).read_bytes(), "set.ssv": SET.format(4).encode()}
    with pytest.raises(LoomfmuError, match=said):
        ran(packed(tmp_path / "a.ssp", system, files))


def bound(source: str, mapping: str = "") -> str:
    place = f'<ssd:ParameterMapping source="resources/{mapping}"/>' if mapping else ""
    return MOTOR.replace(
        "/>",
        f'><ssd:ParameterBindings><ssd:ParameterBinding source="{source}">{place}</ssd:ParameterBinding>'
        "</ssd:ParameterBindings></ssd:Component>",
    ).format("m")


def mapping(space: str) -> bytes:
    return f'<ParameterMapping xmlns="{space}" version="1.0"/>'.encode()


FILES = {
    "set.ssv": SET.format(3).encode(),
    "old.ssv": SET.format(3).replace(NAMESPACES["ssv"], "http://x").encode(),
    "none.ssm": mapping(NAMESPACES["ssm"]),
    "old.ssm": mapping("http://x"),
    "Readme.fmu": b"text",
}


@pytest.mark.parametrize(
    ("elements", "units", "said"),
    [
        (bound("resources/old.ssv"), RPM, "old.ssv is not a parameter set but '{http://x}ParameterSet'"),
        (bound("SystemStructure.ssd"), RPM, "SystemStructure.ssd is not a parameter set but '{http"),
        (bound("resources/set.ssv", "old.ssm"), RPM, "old.ssm is not a parameter mapping but '{http://x}Par"),
        (bound("").replace(' source=""', ""), RPM, "a.ssp: ParameterBinding has no source"),
        (MOTOR.format("m"), RPM.replace('s="-1"', 's="-0.5"'), "unit 'rpm': its exponents must be whole"),
        (
            MOTOR.format("m"),
            RPM.replace("0.10471975511965977", "0"),
            "unit 'rpm': a unit has the factor 0 and",
        ),
        (
            MOTOR.format("m").replace("Motor", "Readme"),
            RPM,
            "a.ssp: resources/Readme.fmu: not a readable FMU",
        ),
    ],
)
def test_a_file_that_is_something_else_is_told(tmp_path: Path, elements: str, units: str, said: str) -> None:
    files = FILES | {"Motor.fmu": motor2(tmp_path).read_bytes()}
    with pytest.raises(LoomfmuError) as raised:
        ran(packed(tmp_path / "a.ssp", in_system(elements), files, units))
    assert said in str(raised.value)


def test_a_mapping_without_entries_takes_nothing_of_its_set(tmp_path: Path) -> None:
    files = FILES | {"Motor.fmu": motor2(tmp_path).read_bytes()}
    elements = bound("resources/set.ssv", "none.ssm")
    assert not ran(packed(tmp_path / "a.ssp", in_system(elements), files)).scene.instances["m"].values


def test_another_version_of_the_standard_is_refused(tmp_path: Path) -> None:
    with zipfile.ZipFile(tmp_path / "a.ssp", "w") as archive:
        archive.writestr(
            "SystemStructure.ssd", f'<ssd:SystemStructureDescription version="9.0" name="n" {SPACES}/>'
        )
    with pytest.raises(LoomfmuError, match=r"is of SSP 9\.0; 1\.0 and 2\.0 are read"):
        ran(tmp_path / "a.ssp")
