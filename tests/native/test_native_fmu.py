"""What a native FMU is made of: description, exported functions, dependencies, sources, bytes."""

import hashlib
import os
import re
import subprocess
import xml.etree.ElementTree as ElementTree
import zipfile
from ctypes import c_char_p
from pathlib import Path

import fmpy
import pytest
from fmpy.validation import validate_fmu
from natives import MEMORYLESS, binary

from loomfmu.components import COMPONENTS
from loomfmu.cosim.importing import fmus
from loomfmu.declaring.variables import variables_of
from loomfmu.errors import LoomfmuError
from loomfmu.fmi.live_fmu import guid
from loomfmu.fmi.native import native_fmu
from loomfmu.fmi.native.fat_binary import ALIGNMENT, fat_binary
from loomfmu.fmi.native.platforms import check_platforms

pytestmark = pytest.mark.no_cover  # FMUs beside components, step by step: the tests of these cover them
either_fmi = pytest.mark.parametrize("fmi", [2, 3])
every_fmu = pytest.mark.parametrize("name", COMPONENTS)
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]


def output_of(*command: str | Path) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


@pytest.mark.few(4, each="fmi")
@either_fmi
@every_fmu
def test_it_is_valid(package, name, fmi):
    assert validate_fmu(str(package(name, fmi).path)) == []


@every_fmu
def test_its_description_is_that_of_the_live_flavour_but_for_what_it_can_do(built, name):
    def described(flavour: str) -> tuple[dict[str, str], str]:
        directory = fmus.of_component(name, flavour).directory
        root = ElementTree.parse(directory / "modelDescription.xml").getroot()
        exchange = root.find("ModelExchange")
        assert (exchange is not None) == (flavour == "native" and name in MEMORYLESS)
        if exchange is not None:  # the live wrapper knows co-simulation alone
            root.remove(exchange)
            indicators = [v.name for v in variables_of(COMPONENTS[name]) if v.indicator]
            assert root.attrib.pop("numberOfEventIndicators") == str(len(indicators))
        kind = root.find("CoSimulation")
        capabilities = dict(kind.attrib)
        kind.attrib.clear()
        kind.text = None
        for child in list(kind):
            kind.remove(child)
        ElementTree.indent(root)
        return capabilities, ElementTree.tostring(root, encoding="unicode")

    (live, one), (native, other) = described("live"), described("native")
    assert other == one
    assert {key: value for key, value in native.items() if live.get(key) != value} == {
        key: value
        for key, value in {
            "canInterpolateInputs": "true",  # one without inputs has none that it could not
            "canNotUseMemoryManagementFunctions": "false",
            "maxOutputDerivativeOrder": native["maxOutputDerivativeOrder"],
            "providesDirectionalDerivative": "true",
        }.items()
        if live.get(key) != value
    }
    assert built[name].guid == guid(COMPONENTS[name])


@either_fmi
@every_fmu
def test_it_exports_the_functions_of_the_standard_its_duals_and_needs_only_libc_and_libm(package, name, fmi):
    header = (native_fmu.HEADERS / f"fmi{fmi}Functions.h").read_text()
    wanted = set(re.findall(rf"#define (fmi{fmi}\w+) +fmi{fmi}FullName\(fmi{fmi}\w+\)", header))
    assert {f"fmi{fmi}Terminate", "fmi2NewDiscreteStates" if fmi == 2 else "fmi3SetTime"} <= wanted
    library = binary(package(name, fmi))
    symbols = output_of("objdump", "-T", library)
    assert {line.split()[-1] for line in symbols.splitlines() if " g " in line} == wanted | {"loomfmu_dual"}
    versions = re.findall(r"GLIBC_(\d+)\.(\d+)", symbols)
    assert max((int(major), int(minor)) for major, minor in versions) <= (2, 17)
    needed = {line.split()[0].rsplit("/", 1)[-1] for line in output_of("ldd", library).splitlines()}
    assert needed <= {"linux-vdso.so.1", "libm.so.6", "libc.so.6", "ld-linux-x86-64.so.2"}


def test_it_states_its_version_and_platform(native):
    library = native("MainShaft").library
    library.fmi2GetVersion.restype = library.fmi2GetTypesPlatform.restype = c_char_p
    assert (library.fmi2GetVersion(), library.fmi2GetTypesPlatform()) == (b"2.0", b"default")


@pytest.mark.few(1, each="fmi")
@either_fmi
@every_fmu
def test_its_sources_compile_without_a_warning(package, gcc, tmp_path, name, fmi):
    fmpy.extract(package(name, fmi).path, tmp_path)
    call = [gcc, "-std=c99", "-O1", *WARNINGS, "-c", f"fmi{fmi}.c", "-o", os.devnull]
    run = subprocess.run(call, cwd=tmp_path / "sources", capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr


def test_the_documented_command_builds_it_again(built, gcc, tmp_path):
    fmpy.extract(built["BeltMonitor"].path, tmp_path)
    page = (tmp_path / "documentation" / "index.html").read_text()
    command = re.search(r"<code>(cc [^<]*)", page)[1]
    subprocess.run(command, shell=True, cwd=tmp_path / "sources", check=True)
    assert "fmi2DoStep" in output_of("objdump", "-T", tmp_path / "sources" / "BeltMonitor.so")


def test_all_it_holds_has_a_licence(built):
    with zipfile.ZipFile(built["MainShaft"].path) as zipped:
        names = set(zipped.namelist())
        assert "Redistribution and use" in zipped.read("documentation/licenses/fmi_headers.txt").decode()
    assert {"documentation/licenses/license.txt", "sources/fmi2Functions.h", "sources/component.c"} <= names
    assert not [name for name in names if name.endswith((".py", ".pyc"))]
    description = ElementTree.fromstring(
        zipfile.ZipFile(built["MainShaft"].path).read("sources/buildDescription.xml")
    )
    assert [file.get("name") for file in description.iter("SourceFile")] == ["fmi2.c"]
    assert all(each.get("compiler") for each in description.iter("SourceFileSet"))  # beside its options


@pytest.mark.slow
def test_builds_repeat_to_the_byte(built, tmp_path, monkeypatch):
    # another directory and an empty cache of the compiler: nothing is taken from the first build
    monkeypatch.setenv("ZIG_GLOBAL_CACHE_DIR", str(tmp_path / "zig"))
    monkeypatch.setenv("ZIG_LOCAL_CACHE_DIR", str(tmp_path / "zig"))
    again = native_fmu.build_native("MainShaft", tmp_path, ("linux64",))
    assert hashlib.sha256(again.read_bytes()).hexdigest() == built["MainShaft"].sha256


def test_a_fat_binary_holds_its_parts():
    intel = b"\xcf\xfa\xed\xfe\x07\x00\x00\x01\x03\x00\x00\x00" + b"intel" * 5000
    arm = b"\xcf\xfa\xed\xfe\x0c\x00\x00\x01\x00\x00\x00\x00" + b"arm" * 7000
    joined = fat_binary([intel, arm])
    words = [int.from_bytes(joined[4 * n : 4 * n + 4], "big") for n in range(12)]
    assert words[:2] == [0xCAFEBABE, 2]
    for part, (processor, kind, offset, size, alignment) in zip(
        (intel, arm), (words[2:7], words[7:12]), strict=True
    ):
        assert joined[offset : offset + size] == part
        assert offset % 2**ALIGNMENT == 0 and alignment == ALIGNMENT
        assert processor.to_bytes(4, "little") == part[4:8] and kind.to_bytes(4, "little") == part[8:12]
    with pytest.raises(ValueError, match="a part of a fat binary begins with 0x464c457f"):
        fat_binary([b"\x7fELF" + b"\0" * 8])


def test_an_unknown_platform_or_flavour_is_named(tools):
    with pytest.raises(LoomfmuError, match=r"there is no platform 'linux46'; did you mean 'linux64'\?"):
        check_platforms(("win64", "linux46"))
    with pytest.raises(LoomfmuError, match=r"there is no flavour 'nativ'; did you mean 'native'\?"):
        fmus.of_component("MainShaft", "nativ")


@pytest.mark.slow
def test_it_is_built_for_all_platforms(tools, tmp_path):
    path = native_fmu.build_native("MainShaft", tmp_path)
    assert validate_fmu(str(path)) == []
    with zipfile.ZipFile(path) as zipped:
        windows = zipped.read("binaries/win64/MainShaft.dll")
        mac = zipped.read("binaries/darwin64/MainShaft.dylib")
        assert "documentation/licenses/mingw-w64.txt" in zipped.namelist()
    assert windows[:2] == b"MZ" and b"fmi2DoStep" in windows
    assert mac[:8] == bytes.fromhex("cafebabe00000002") and mac.count(b"_fmi2DoStep") >= 2
    assert native_fmu.build_native("MainShaft", tmp_path / "again").read_bytes() == path.read_bytes()
