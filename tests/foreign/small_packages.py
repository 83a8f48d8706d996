"""System packages that try one thing each, with the value that a signal has at the end by hand.

They are made of FMUs of Reference-FMUs, which are independent of us: one hands its input over, the other
multiplies its state by 1 - k / 10 in each of ten steps.
"""

import zipfile
from pathlib import Path
from typing import NamedTuple

from loomfmu.cosim.ssp.xml import NAMESPACES, SSD_FILE, SSP

IN, OUT = "Float64_continuous_input", "Float64_continuous_output"
SPACES = " ".join(f'xmlns:{key}="{space}"' for key, space in NAMESPACES.items() if key != "loomfmu")
MASTER = (  # the step of 0.1 s as OMSimulator has it
    '<ssd:Annotations><ssc:Annotation type="org.openmodelica"><oms:Annotations><oms:SimulationInformation>'
    '<oms:FixedStepMaster description="oms-ma" stepSize="0.1" absoluteTolerance="1e-4"'
    ' relativeTolerance="1e-4"/></oms:SimulationInformation></oms:Annotations></ssc:Annotation>'
    "</ssd:Annotations>"
)
BASES = {
    "m": 'm="1"',
    "mm": 'm="1" factor="0.001"',
    "K": 'K="1"',
    "degC": 'K="1" offset="273.15"',
    "cubit": 'm="1" factor="0.4572"',
}


# ---- parts of a structure


def connector(name: str, kind: str, unit: str = "", of: str = "Real") -> str:
    stated = f' unit="{unit}"' if unit else ""
    return f'<ssd:Connector name="{name}" kind="{kind}"><ssc:{of}{stated}/></ssd:Connector>'


def connectors(*each: str) -> str:
    return f"<ssd:Connectors>{''.join(each)}</ssd:Connectors>"


def value(name: str, number: object, unit: str = "", of: str = "Real") -> str:
    stated = f' unit="{unit}"' if unit else ""
    return f'<ssv:Parameter name="{name}"><ssv:{of} value="{number}"{stated}/></ssv:Parameter>'


def parameters(*each: str) -> str:
    inside = f"<ssv:Parameters>{''.join(each)}</ssv:Parameters>"
    return f'<ssv:ParameterSet version="1.0" name="set" {SPACES}>{inside}</ssv:ParameterSet>'


def bound(*each: str, attributes: str = "") -> str:
    inside = f"<ssd:ParameterValues>{parameters(*each)}</ssd:ParameterValues>"
    return f"<ssd:ParameterBinding {attributes}>{inside}</ssd:ParameterBinding>"


def bindings(*each: str) -> str:
    return f"<ssd:ParameterBindings>{''.join(each)}</ssd:ParameterBindings>"


def component(name: str, source: str, rest: str = "", attributes: str = "") -> str:
    return f'<ssd:Component name="{name}" source="resources/{source}" {attributes}>{rest}</ssd:Component>'


def passing(name: str, into: str = "", out: str = "", rest: str = "", more: str = "") -> str:
    """A component that hands its input over, in units."""
    known = connectors(connector(IN, "input", into), connector(OUT, "output", out), more)
    return component(name, "Feedthrough.fmu", known + rest)


def falling(name: str, *values: str, unit: str = "", rest: str = "", attributes: str = "") -> str:
    """A component whose state falls, in a unit, with values of its own."""
    known = connectors(connector("x", "output", unit), connector("k", "parameter"))
    own = bindings(bound(*values)) if values else rest
    return component(name, "Dahlquist.fmu", known + own, attributes)


def wire(source: str, sink: str, inside: str = "", attributes: str = "") -> str:
    """A connection between ends such as `f.u`, or `u` of the system itself."""
    ends = []
    for which, end in (("start", source), ("end", sink)):
        owner, dot, name = end.rpartition(".")
        ends.append((f'{which}Element="{owner}" ' if dot else "") + f'{which}Connector="{name}"')
    return f"<ssd:Connection {' '.join(ends)} {attributes}>{inside}</ssd:Connection>"


def system(name: str, *elements: str, outer: str = "", wires: str = "", rest: str = "") -> str:
    """A system; `outer` are its connectors and values."""
    joined = f"<ssd:Connections>{wires}</ssd:Connections>" if wires else ""
    inner = f"<ssd:Elements>{''.join(elements)}</ssd:Elements>{joined}{rest}"
    return f'<ssd:System name="{name}">{outer}{inner}</ssd:System>'


def described(inside: str, version: str = "1.0") -> str:
    """The text of a structure."""
    head = f'<ssd:SystemStructureDescription {SPACES} version="{version}" name="package">'
    return f'<?xml version="1.0" encoding="UTF-8"?>{head}{inside}</ssd:SystemStructureDescription>'


def linear(factor: float, offset: float = 0.0) -> str:
    return f'<ssc:LinearTransformation factor="{factor}" offset="{offset}"/>'


class Small(NamedTuple):
    """A package that tries one thing: its elements and wires, and a signal's value at the end by hand.

    The value is a text where the package is wrong. `files` are more than its FMUs.
    """

    elements: str
    wires: str
    signal: str
    expected: float | str
    outer: str = ""
    rest: str = ""
    version: str = "1.0"
    units: bool = True
    experiment: str = 'startTime="0" stopTime="1"'
    files: dict[str, str] = {}  # noqa: RUF012

    @property
    def structure(self) -> str:
        """Its text."""
        defined = (
            f'<ssc:Unit name="{name}"><ssc:BaseUnit {base}/></ssc:Unit>' for name, base in BASES.items()
        )
        units = f"<ssd:Units>{''.join(defined)}</ssd:Units>" if self.units else ""
        inside = system("root", self.elements, outer=self.outer, wires=self.wires, rest=self.rest + MASTER)
        text = described(f"{inside}{units}<ssd:DefaultExperiment {self.experiment}/>", self.version)
        if self.version == "2.0":
            text = text.replace(":Real", ":Float64").replace("Feedthrough.fmu", "Feedthrough3.fmu")
        return text


def fallen(k: float) -> float:
    """The state at the end."""
    return float((1.0 - k / 10.0) ** 10)


U, Y = connector("u", "input"), connector("y", "output")
BOX = system("{}", passing("f"), outer=connectors(U, Y), wires=wire("u", f"f.{IN}") + wire(f"f.{OUT}", "y"))
WHOLE = connector("Int32_input", "input", of="Integer") + connector("Int32_output", "output", of="Integer")
TRUTH = connector("Boolean_input", "input", of="Boolean") + connector(
    "Boolean_output", "output", of="Boolean"
)
ENTRY = '<ssb:DictionaryEntry name="s"><ssc:Real/></ssb:DictionaryEntry>'
DICTIONARY = f'<ssb:SignalDictionary version="1.0" {SPACES}>{ENTRY}</ssb:SignalDictionary>'
REFERENCE = (
    f'<ssd:SignalDictionaryReference name="r" dictionary="bus">{connectors(connector("s", "inout"))}'
    "</ssd:SignalDictionaryReference>"
)
BUS = wire("u", f"f.{IN}") + wire(f"f.{OUT}", "r.s") + wire("r.s", f"g.{IN}")
INNER = component("box", "inner.ssp", connectors(U, Y), f'type="{SSP}"')
MAPPED = (
    f'<ssm:ParameterMapping version="1.0" {SPACES}><ssm:MappingEntry source="gain" target="k">'
    f"{linear(0.5, 1)}</ssm:MappingEntry></ssm:ParameterMapping>"
)
F, G = f"f.{OUT}", f"g.{OUT}"


def given(number: object, unit: str = "", stated: str = "", of: str = "Real") -> str:
    """The connector `u` of the system in a unit, with a value in a unit."""
    return connectors(connector("u", "input", stated or unit, of)) + bindings(
        bound(value("u", number, unit, of))
    )


def both(*names: str) -> str:
    """The connector `u` of the system, and values in this order: 7 for itself, 5 for another one."""
    each = [value(name, 7.0 if name == "u" else 5.0) for name in names]
    return connectors(U) + bindings(bound(*each))


def inverted() -> str:
    entries = "".join(
        f'<ssc:MapEntry source="{a}" target="{b}"/>' for a, b in (("true", "false"), ("false", "true"))
    )
    return f"<ssc:BooleanMappingTransformation>{entries}</ssc:BooleanMappingTransformation>"


def dictionaries(rest: str) -> str:
    return f'<ssd:SignalDictionaries><ssd:SignalDictionary name="bus"{rest}</ssd:SignalDictionaries>'


INTO, THROUGH = wire("u", f"f.{IN}"), wire(F, f"g.{IN}")
FELL = "d.x"
SMALL: dict[str, Small] = {
    "value of an input of the system": Small(passing("f"), INTO, F, 3.5, given(3.5)),
    "the same with an empty `startElement`": Small(passing("f"), wire(".u", f"f.{IN}"), F, 3.5, given(3.5)),
    "value of a parameter of the system": Small(
        falling("d"),
        wire("p", "d.k"),
        FELL,
        fallen(2),
        connectors(connector("p", "parameter")) + bindings(bound(value("p", 2.0))),
    ),
    "the same, transformed": Small(
        falling("d"),
        wire("p", "d.k", linear(0.5, 0.25)),
        FELL,
        fallen(1.25),
        connectors(connector("p", "parameter")) + bindings(bound(value("p", 2.0))),
    ),
    "the same, and one of the component itself": Small(
        falling("d", value("k", 3.0)),
        wire("p", "d.k"),
        FELL,
        fallen(2),
        connectors(connector("p", "parameter")) + bindings(bound(value("p", 2.0), value("d.k", 4.0))),
    ),
    "output of the system": Small(falling("d"), wire("d.x", "y"), "y", fallen(1), connectors(Y)),
    "systems in the system": Small(
        BOX.format("a") + BOX.format("b"),
        wire("u", "a.u") + wire("a.y", "b.u"),
        f"b_f.{OUT}",
        4.0,
        given(4.0),
    ),
    "value along a connection, and one of its end": Small(
        BOX.format("a"), wire("u", "a.u"), f"a_f.{OUT}", 7.0, both("u", "a.u")
    ),
    "the same the other way round": Small(
        BOX.format("a"), wire("u", "a.u"), f"a_f.{OUT}", 7.0, both("a.u", "u")
    ),
    "value for a system with a dot in its name": Small(
        BOX.format("a.b"), "", f"a_b_f.{OUT}", 5.0, bindings(bound(value("a.b.u", 5.0)))
    ),
    "value for a system in the system": Small(
        system("a", falling("d"), outer=connectors(connector("p", "parameter")), wires=wire("p", "d.k")),
        "",
        "a_d.x",
        fallen(3),
        bindings(bound(value("a.p", 3.0))),
    ),
    "transformation": Small(
        passing("f") + passing("g"), INTO + wire(F, f"g.{IN}", linear(2, 1)), G, 15.0, given(7.0)
    ),
    "transformation of an integer": Small(
        passing("f", rest=bindings(bound(value("Int32_input", 3, of="Integer"))), more=WHOLE)
        + passing("g", more=WHOLE),
        wire("f.Int32_output", "g.Int32_input", linear(2, 1)),
        "g.Int32_output",
        7.0,
    ),
    "mapping of a yes-or-no value": Small(
        passing("f", rest=bindings(bound(value("Boolean_input", "true", of="Boolean"))), more=TRUTH)
        + passing("g", more=TRUTH),
        wire("f.Boolean_output", "g.Boolean_input", inverted()),
        "g.Boolean_output",
        0.0,
    ),
    "from m to mm": Small(
        falling("d", unit="m") + passing("f", "mm"), wire("d.x", f"f.{IN}"), F, 1000 * fallen(1)
    ),
    "the same, then a transformation": Small(
        falling("d", unit="m") + passing("f", "mm"),
        wire("d.x", f"f.{IN}", linear(2, 1)),
        F,
        2000 * fallen(1) + 1,
    ),
    "unit at one end": Small(falling("d", unit="m") + passing("f"), wire("d.x", f"f.{IN}"), F, fallen(1)),
    "from degC to K": Small(passing("f", "K"), INTO, F, 298.15, given(25.0, "degC")),
    "the same without definitions": Small(
        passing("f", "K"), INTO, F, 298.15, given(25.0, stated="degC"), units=False
    ),
    "the same in SSP 2.0": Small(passing("f", "K"), INTO, F, 298.15, given(25.0, "degC"), version="2.0"),
    "`suppressUnitConversion`": Small(
        passing("f", "K"),
        wire("u", f"f.{IN}", attributes='suppressUnitConversion="true"'),
        F,
        25.0,
        given(25.0, "degC"),
    ),
    "value in another unit": Small(passing("f", "m"), INTO, F, 1.5, given(1500.0, "mm", "m")),
    "value in a unit of its own": Small(passing("f", "m"), INTO, F, 0.9144, given(2.0, "cubit", "m")),
    "integer for a real": Small(passing("f"), INTO, F, 4.0, given(4, of="Integer")),
    "start at 2.5 s": Small(falling("d"), "", FELL, fallen(1), experiment='startTime="2.5" stopTime="3.5"'),
    "start at -1 s": Small(falling("d"), "", FELL, fallen(1), experiment='startTime="-1" stopTime="0"'),
    "9.5 steps": Small(falling("d"), "", FELL, "unclear", experiment='startTime="0.05" stopTime="1"'),
    "no stop time": Small(falling("d"), "", FELL, "unclear", experiment=""),
    "set and mapping in files": Small(
        falling(
            "d",
            rest=bindings(
                '<ssd:ParameterBinding source="resources/q.ssv">'
                '<ssd:ParameterMapping source="resources/q.ssm"/></ssd:ParameterBinding>'
            ),
        ),
        "",
        FELL,
        fallen(3),
        files={"q.ssv": parameters(value("gain", 4.0)), "q.ssm": MAPPED},
    ),
    "prefix": Small(
        falling("d"), "", FELL, fallen(3), bindings(bound(value("k", 3.0), attributes='prefix="d."'))
    ),
    "prefix of a system": Small(
        system("a", falling("d")),
        "",
        "a_d.x",
        fallen(3),
        bindings(bound(value("d.k", 3.0), attributes='prefix="a."')),
    ),
    "value of the component and of the system": Small(
        falling("d", value("k", 2.0)), "", FELL, fallen(3), bindings(bound(value("d.k", 3.0)))
    ),
    "two sets for a component": Small(
        falling("d", rest=bindings(bound(value("k", 2.0)), bound(value("k", 3.0)))), "", FELL, fallen(3)
    ),
    "value of a component's input": Small(passing("f", rest=bindings(bound(value(IN, 2.5)))), "", F, 2.5),
    "start of a state that is an output": Small(falling("d", value("x", 5.0)), "", FELL, 5 * fallen(1)),
    "the same in another unit": Small(
        falling("d", value("x", 5000.0, "mm"), unit="m"), "", FELL, 5 * fallen(1)
    ),
    "value for an output of the system": Small(
        falling("d"), wire("d.x", "y"), FELL, fallen(1), connectors(Y) + bindings(bound(value("y", 9.0)))
    ),
    "value for what does not exist": Small(falling("d", value("kk", 3.0)), "", FELL, fallen(1)),
    "components without connectors": Small(
        component("d", "Dahlquist.fmu") + component("f", "Feedthrough.fmu"),
        wire("d.x", f"f.{IN}"),
        F,
        fallen(1),
    ),
    "signal dictionary": Small(
        passing("f") + passing("g") + REFERENCE,
        BUS,
        G,
        6.0,
        given(6.0),
        dictionaries(f">{DICTIONARY}</ssd:SignalDictionary>"),
    ),
    "signal dictionary in a file": Small(
        passing("f") + passing("g") + REFERENCE,
        BUS,
        G,
        6.0,
        given(6.0),
        dictionaries(' source="resources/bus.ssb"/>'),
        files={"bus.ssb": DICTIONARY},
    ),
    "package in the package": Small(
        INNER + passing("g"),
        wire("u", "box.u") + wire("box.y", f"g.{IN}"),
        G,
        8.0,
        given(8.0),
        files={"inner.ssp": BOX.format("it")},
    ),
    "value for a package in the package": Small(
        INNER + passing("g"),
        wire("box.y", f"g.{IN}"),
        G,
        3.0,
        bindings(bound(value("box.u", 3.0))),
        files={"inner.ssp": BOX.format("it")},
    ),
    "SSP 2.0 with an FMU of FMI 3.0": Small(passing("f"), INTO, F, 3.5, given(3.5), version="2.0"),
    "loop": Small(passing("f") + passing("g"), THROUGH + wire(G, f"f.{IN}"), F, 0.0),
    "two outputs to an input": Small(
        passing("f") + falling("d") + falling("e"),
        wire("d.x", f"f.{IN}") + wire("e.x", f"f.{IN}"),
        F,
        "wrong",
    ),
    "an output to an input on two ways": Small(
        passing("f") + falling("d"),
        wire("d.x", "y") + wire("y", f"f.{IN}", linear(2)) + wire("d.x", f"f.{IN}"),
        F,
        "wrong",
        connectors(Y),
    ),
    "values of two connectors to an input": Small(
        passing("f"),
        INTO + wire("v", f"f.{IN}"),
        F,
        "wrong",
        connectors(U, connector("v", "input")) + bindings(bound(value("u", 1.0), value("v", 2.0))),
    ),
    "two outputs to an output of the system": Small(
        falling("d") + falling("e"), wire("d.x", "y") + wire("e.x", "y"), FELL, "wrong", connectors(Y)
    ),
    "set in a file that the FMU does not have": Small(
        falling(
            "d",
            rest=bindings('<ssd:ParameterBinding source="resources/q.ssv" sourceBase="component"/>'),
        ),
        "",
        FELL,
        "wrong",
        files={"q.ssv": parameters(value("k", 4.0))},
    ),
    "`_` in a number": Small(passing("f"), INTO, F, "wrong", given("1_0")),
    "connection from what does not exist": Small(
        passing("f") + falling("d"), wire("d.z", f"f.{IN}"), F, "wrong"
    ),
    "K for m": Small(passing("f", "m"), INTO, F, "wrong", given(2.0, "K", "m")),
    "two components of one name": Small(falling("d") + falling("d"), "", FELL, "wrong"),
    "FMU that is not there": Small(component("d", "none.fmu"), "", FELL, "wrong"),
    "FMU outside the package": Small(component("d", "../../none.fmu"), "", FELL, "wrong"),
}


SOURCES = {"Dahlquist": "2.0/Dahlquist", "Feedthrough": "2.0/Feedthrough", "Feedthrough3": "3.0/Feedthrough"}


def made(place: Path, fmus: Path) -> dict[str, Path]:
    """The small packages, of the FMUs in a folder of Reference-FMUs, by what they try."""
    found = {}
    for number, (name, small) in enumerate(SMALL.items()):
        text = small.structure
        found[name] = path = place / f"{number}.ssp"
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr(SSD_FILE, text)
            for file, content in small.files.items():
                if file.endswith(".ssp"):
                    content = _inner(place, content, fmus)
                archive.writestr(f"resources/{file}", content)
            _add(archive, text, fmus)
    return found


def _inner(place: Path, inside: str, fmus: Path) -> bytes:
    """A package of a system."""
    path = place / "inner.ssp"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(SSD_FILE, described(inside))
        _add(archive, inside, fmus)
    return path.read_bytes()


def _add(archive: zipfile.ZipFile, text: str, fmus: Path) -> None:
    """The FMUs that a structure names."""
    for name, file in SOURCES.items():
        if f"resources/{name}.fmu" in text:
            archive.write(fmus / f"{file}.fmu", f"resources/{name}.fmu")
