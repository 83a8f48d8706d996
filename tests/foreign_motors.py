"""Third-party FMUs: a small motor in C, compiled by gcc, as FMI 2.0 and as FMI 3.0."""

import shutil
import subprocess
import zipfile
from pathlib import Path
from tempfile import TemporaryDirectory

import fmpy
import pytest
from sharing import made_by_gcc

SOURCES = Path(__file__).with_name("motors")
HEADERS = Path(fmpy.__file__).with_name("c-code")

UNITS = """
<UnitDefinitions>
  <Unit name="rad"><BaseUnit rad="1"/><DisplayUnit name="deg" factor="57.29577951308232"/></Unit>
  <Unit name="rad.s-1"><BaseUnit rad="1" s="-1"/></Unit>
  <Unit name="rad/s2"><BaseUnit s="-2"/></Unit>
  <Unit name="deg"><BaseUnit rad="1" factor="0.0174532925199433"/></Unit>
  <Unit name="Nm"><BaseUnit kg="1" m="2" s="-2"/></Unit>
  <Unit name="kg.m2"><BaseUnit kg="1" m="2"/></Unit>
  <Unit name="K"><BaseUnit K="1"/></Unit>
</UnitDefinitions>
"""

FIXED = 'causality="parameter" variability="fixed"'

FMI2 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="{name}" guid="{{motor-2}}" generationTool="Motor Maker 7">
<CoSimulation modelIdentifier="{identifier}" {flags}/>
{units}
<TypeDefinitions>
  <SimpleType name="Angle"><Real unit="{phi}" displayUnit="deg"/></SimpleType>
  <SimpleType name="Mode"><Enumeration><Item name="both_ways" value="1"/><Item name="no_way_back" value="2"/>
  </Enumeration></SimpleType>
</TypeDefinitions>
<ModelVariables>
{p}name="J" valueReference="0" {fixed}><Real start="0.5" {kgm2} min="-10"/></ScalarVariable>
{p}name="tau_stall" valueReference="1" {fixed}><Real start="100" {nm}/></ScalarVariable>
{p}name="w_free" valueReference="2" {fixed}><Real start="60" {w}/></ScalarVariable>
{p}name="load.tau" valueReference="3" causality="input"><Real start="0" {nm}/></ScalarVariable>
{p}name="flange.phi" valueReference="4" causality="output"><Real {angle}/></ScalarVariable>
{p}name="flange.w" valueReference="5" causality="output"><Real {w} derivative="5"/></ScalarVariable>
{p}name="flange.a" valueReference="6" causality="output"><Real {a} derivative="6"/></ScalarVariable>
{p}name="time" valueReference="7" causality="output"><Real/></ScalarVariable>
{p}name="steps" valueReference="0" causality="output" variability="discrete"><Integer/></ScalarVariable>
{p}name="at_speed" valueReference="1" causality="output" variability="discrete"><Boolean/></ScalarVariable>
{p}name="verbose" valueReference="2" {fixed}><Boolean start="false"/></ScalarVariable>
{p}name="mode" valueReference="3" {fixed}><Enumeration declaredType="Mode" start="1"/></ScalarVariable>
{p}name="label" valueReference="0" {fixed}><String start="a motor"/></ScalarVariable>
{p}name="winding" valueReference="6" causality="output"><Real {kelvin}/></ScalarVariable>
</ModelVariables>
<ModelStructure/>
</fmiModelDescription>
"""

FMI3 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Motor3" instantiationToken="{{motor-3}}">
<CoSimulation modelIdentifier="Motor3"/>
<UnitDefinitions><Unit name="rad"><BaseUnit rad="1"/></Unit>
<Unit name="rad/s"><BaseUnit rad="1" s="-1"/></Unit>
<Unit name="rad/s2"><BaseUnit rad="1" s="-2"/></Unit><Unit name="N.m"><BaseUnit kg="1" m="2" s="-2"/></Unit>
<Unit name="kg.m2"><BaseUnit kg="1" m="2"/></Unit></UnitDefinitions>
<TypeDefinitions><EnumerationType name="Mode"><Item name="both_ways" value="1"/>
<Item name="no_way_back" value="2"/></EnumerationType></TypeDefinitions>
<ModelVariables>
<Float64 name="J" valueReference="0" {fixed} start="0.5" unit="kg.m2"/>
<Float64 name="tau_stall" valueReference="1" {fixed} start="100" unit="N.m"/>
<Float64 name="w_free" valueReference="2" {fixed} start="60" unit="rad/s"/>
<Float64 name="load" valueReference="3" causality="input" start="0" unit="N.m"/>
<Float64 name="angle" valueReference="4" causality="output" unit="rad"/>
<Float64 name="velocity" valueReference="5" causality="output" unit="rad/s" derivative="4"/>
<Float64 name="acceleration" valueReference="6" causality="output" unit="rad/s2" derivative="5"/>
<Int32 name="steps" valueReference="20" causality="output"/>
<Int32 name="verbose" valueReference="22" {fixed} start="0"/>
<Enumeration name="mode" valueReference="30" {fixed} start="1" declaredType="Mode"/>
<Enumeration name="mode_used" valueReference="31" causality="output" declaredType="Mode"/>
<Int64 name="microradians" valueReference="32" causality="output"/>
<Float32 name="velocity_32" valueReference="60" causality="output" unit="rad/s"/>
<Boolean name="at_speed" valueReference="40" causality="output"/>
<Boolean name="stalled" valueReference="41" causality="input" start="false"/>
<Float64 name="table" valueReference="50" {fixed} start="1 2"><Dimension start="2"/></Float64>
<String name="label" valueReference="51" {fixed}><Start value="a motor"/></String>
</ModelVariables>
<ModelStructure/>
</fmiModelDescription>
"""


HELD = ("Int8", "UInt8", "Int16", "UInt16", "UInt32", "UInt64")
# the motor of FMI 3.0 with an input and an output of each of these types, the output equal to the input
WHOLE = FMI3.replace(
    '<Boolean name="at_speed"',
    "".join(
        f'<{each} name="to_{each}" valueReference="{70 + 2 * place}" causality="input" start="0"/>\n'
        f'<{each} name="{each}" valueReference="{71 + 2 * place}" causality="output"/>\n'
        for place, each in enumerate(HELD)
    )
    + '<Boolean name="at_speed"',
)
SQUARE = '<Dimension start="2"/><Dimension start="2"/></Float64>'
ARRAYS = FMI3.replace(
    '<String name="label"',
    '<Float64 name="u" valueReference="80" causality="input" start="0.5">'
    f'{SQUARE}<Float64 name="y" valueReference="81" causality="output">{SQUARE}'
    '<Float32 name="twice" valueReference="82" causality="local"><Dimension start="2"/></Float32>'
    '<Float64 name="huge" valueReference="83" causality="output"><Dimension start="1001"/></Float64>'
    '<String name="label"',
)
BLANKS = FMI3.replace('"both_ways"', '"both ways"').replace('"no_way_back"', '"no way-back"')


def gcc() -> str:
    """The compiler, or no test."""
    found = shutil.which("gcc")
    if found is None:
        pytest.skip("gcc is not installed: no foreign FMU can be built")
    return found


def library(source: str, *options: str) -> bytes:
    """A shared library of one of the sources, compiled once."""
    call = [gcc(), "-shared", "-fPIC", "-O2", *options, f"-I{HEADERS}", f"-I{SOURCES}"]

    def make() -> bytes:
        with TemporaryDirectory() as directory:
            target = Path(directory) / "library.so"
            subprocess.run([*call, "-o", target, SOURCES / source, "-lm"], check=True)
            return target.read_bytes()

    texts = [file.read_text() for file in sorted(SOURCES.iterdir())]
    return made_by_gcc("library.so", [source, *options, *texts], make).read_bytes()


def packed(target: Path, description: str, binary: bytes | None, name: str, folder: str = "linux64") -> Path:
    """An FMU of a description and a library."""
    with zipfile.ZipFile(target, "w") as archive:
        archive.writestr("modelDescription.xml", description)
        archive.writestr("resources/readme.txt", "nothing")
        if binary is not None:
            archive.writestr(f"binaries/{folder}/{name}.so", binary)
    return target


def description2(name: str = "Motor", *, units: bool = True, phi: str = "rad", flags: str = "") -> str:
    """The model description of the FMI 2.0 motor, with units or without."""

    def unit(text: str) -> str:
        return f'unit="{text}"' if units else ""

    return FMI2.format(
        name=name,
        identifier="Motor",
        flags=flags,
        units=UNITS if units else "",
        phi=phi,
        p="<ScalarVariable ",
        fixed=FIXED,
        angle='declaredType="Angle"' if units else "",
        kgm2=unit("kg.m2"),
        nm=unit("Nm"),
        w=unit("rad.s-1"),
        a=unit("rad/s2"),
        kelvin=unit("K"),
    )


def motor2(
    directory: Path,
    name: str = "Motor",
    *,
    single: bool = False,
    defines: tuple[str, ...] = (),
    **options: object,
) -> Path:
    """The motor as an FMI 2.0 FMU; `defines` are macros of its source, such as LATE=1."""
    if single:
        options["flags"] = 'canBeInstantiatedOnlyOncePerProcess="true"'
    macros = [f"-D{macro}" for macro in (f"SINGLE={int(single)}", *defines)]
    binary = library("fmi2.c", *macros)
    return packed(directory / f"{name}.fmu", description2(name, **options), binary, "Motor")  # type: ignore[arg-type]


def misbehaving(directory: Path, what: str, where: str = "STEP", returned: int = 0) -> Path:
    """The motor as an FMI 2.0 FMU that crashes, hangs, ... as `misbehaves.c` says; in mode 2 it does not."""
    macros = [f"-DMISBEHAVES={what}", f"-DWHERE={where}", f"-DRETURNED={returned}"]
    binary = library("misbehaves.c", *macros)
    return packed(directory / "Motor.fmu", description2(), binary, "Motor")


def motor3(directory: Path, *, defines: tuple[str, ...] = (), description: str = FMI3) -> Path:
    """The motor as an FMI 3.0 FMU."""
    binary = library("fmi3.c", *(f"-D{macro}" for macro in defines))
    return packed(directory / "Motor3.fmu", description.format(fixed=FIXED), binary, "Motor3", "x86_64-linux")
