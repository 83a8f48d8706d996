"""The FMU as a file: what is in it, that builds repeat, and what its identity stands for."""

import ast
import hashlib
import html
import re
import struct
import zipfile
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from xml.etree.ElementTree import fromstring

import numpy as np
import pytest
from live_fmus import COMPONENTS, NAMES, in_a_process
from write_fmu_pages import SAMPLES, STEP_SIZE, reference, write_references

from loomfmu import LoomfmuError, components
from loomfmu.cosim.importing import fmus
from loomfmu.declaring.declarations import output, parameter
from loomfmu.declaring.variables import Component, variables_of
from loomfmu.fmi import fmu_files, live_fmu
from loomfmu.fmi.description import documentation

every_fmu = pytest.mark.parametrize("name", NAMES)


def contents(name: str) -> dict[str, bytes]:
    with zipfile.ZipFile(fmus.of_component(name).path) as zipped:
        return {entry.filename: zipped.read(entry) for entry in zipped.infolist()}


# ---- what is in it


@every_fmu
def test_documentation_has_equations_and_every_variable(name: str) -> None:
    page = contents(name)["documentation/index.html"].decode()
    assert page.startswith("<!DOCTYPE html>")
    assert "<h2>Equations</h2>" in page
    assert '<table class="equations">' in page and "<math" in page and "<script" not in page
    for variable in variables_of(COMPONENTS[name]):
        assert f"<td><code>{variable.name}</code></td>" in page
        assert f"<td>{html.escape(variable.description, quote=False)}</td>" in page


@every_fmu
def test_texts_spell_the_unit_of_speed_in_one_way(name: str) -> None:
    texts = [text for file, text in contents(name).items() if file.endswith((".html", ".xml"))]
    for text in texts:
        others = re.findall(r"(?<![a-z])r/min|rpm|(?i:(?:revolutions|turns|picks) per minute)", text.decode())
        assert others == []


@every_fmu
def test_documentation_says_what_the_host_must_have(name: str) -> None:
    page = contents(name)["documentation/externalDependencies.html"].decode()
    assert name in page
    assert "CPython 3.11 or newer" in page
    assert "GLIBC 2.32" in page


@every_fmu
def test_licences_of_all_that_is_in_it(name: str) -> None:
    files = contents(name)
    assert b"MIT License" in files["documentation/licenses/license.txt"]
    assert b"MIT License" in files["documentation/licenses/pythonfmu.txt"]
    assert files["documentation/licenses/license.txt"] != files["documentation/licenses/pythonfmu.txt"]
    notice = files["documentation/licenses/cppfmu.txt"].decode()
    assert f"pythonfmu {metadata.version('pythonfmu')} " in notice and "mozilla.org/MPL/2.0" in notice
    assert b"Redistribution and use" in files["documentation/licenses/fmi_headers.txt"]


@every_fmu
def test_documentation_shows_the_drawing_that_lies_beside_it(name: str) -> None:
    if not (fmu_files.folder(COMPONENTS[name]) / "drawing.svg").exists():
        return
    files = contents(name)
    assert '<img src="drawing.svg" alt="' in files["documentation/index.html"].decode()
    assert fromstring(files["documentation/drawing.svg"]).tag == "{http://www.w3.org/2000/svg}svg"


@every_fmu
def test_icon_is_a_png_of_128_by_128(name: str) -> None:
    if not (fmu_files.folder(COMPONENTS[name]) / "icon.png").exists():
        return
    png = contents(name)["model.png"]
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    assert struct.unpack(">II", png[16:24]) == (128, 128)


@every_fmu
def test_binaries_are_for_linux_and_windows(name: str) -> None:
    files = contents(name)
    assert files[f"binaries/linux64/{name}.so"].startswith(b"\x7fELF")
    assert files[f"binaries/win64/{name}.dll"].startswith(b"MZ")


@every_fmu
def test_its_python_imports_little_and_bears_a_name_of_its_own(name: str) -> None:
    files = contents(name)
    modules = {path: text for path, text in files.items() if path.endswith(".py")}
    entry = files["resources/slavemodule.txt"].decode()
    package = entry.removesuffix("_entry")
    identity = live_fmu.guid(COMPONENTS[name]).replace("-", "")
    assert package == f"loomfmu_{name.lower()}_{identity[:16]}"
    assert set(modules) == {
        f"resources/{entry}.py",
        f"resources/{package}/__init__.py",
        f"resources/{package}/component.py",
        *(f"resources/{package}/live_{part}.py" for part in ("slave", "state", "wrapper")),
    }
    imported = set()
    for text in modules.values():
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.Import):
                imported |= {alias.name for alias in node.names}
            elif isinstance(node, ast.ImportFrom):
                imported.add(f"{package}.{node.module}" if node.level else str(node.module))
    own = {module for module in imported if module.split(".")[0] == package}
    little = {
        "atexit",
        "collections.abc",
        "ctypes",
        "math",
        "operator",
        "os",
        "struct",
        "sys",
        "typing",
        "zlib",
    }
    # ctypes only where a call fails and at the end of the process, logging only where a call fails
    assert imported - own - {"logging"} <= little
    parts = ("component", "live_slave", "live_state", "live_wrapper", "None")  # None: the package itself
    assert own <= {f"{package}.{part}" for part in parts}


@every_fmu
def test_the_readme_in_the_repository_is_up_to_date(name: str) -> None:
    text = (fmu_files.folder(COMPONENTS[name]) / "README.md").read_text(encoding="utf-8")
    assert documentation.with_table(text, COMPONENTS[name]) == text, "run `make docs`"


def test_a_readme_without_a_table_gets_one_at_its_end() -> None:
    text = documentation.with_table("# MainShaft\n", components.MainShaft)
    assert text.startswith("# MainShaft\n\n## Variables\n\n<!--")
    assert text.count("| `speed` |") == 1
    assert documentation.with_table(text, components.MainShaft) == text


# ---- builds repeat


def digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


@pytest.mark.slow
def test_builds_repeat_in_another_directory_and_another_process(tmp_path: Path) -> None:
    before = {name: digest(fmus.of_component(name).path) for name in NAMES}
    assert {name: digest(live_fmu.build(name, tmp_path / "here")) for name in NAMES} == before
    for seed in ("1", "4242"):
        there = tmp_path / f"there {seed}"
        script = "import sys; from loomfmu.cli import main; main(['build', '--output', sys.argv[1]])"
        in_a_process(script, str(there), PYTHONHASHSEED=seed)
        assert {name: digest(there / f"{name}.fmu") for name in NAMES} == before


@every_fmu
def test_entries_are_in_order_and_dated_alike(name: str) -> None:
    with zipfile.ZipFile(fmus.of_component(name).path) as zipped:
        names = zipped.namelist()
        assert names == sorted(names)
        assert {entry.date_time for entry in zipped.infolist()} == {(1980, 1, 1, 0, 0, 0)}


def test_nothing_is_left_behind_where_an_fmu_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "MainShaft.fmu").mkdir()
    (tmp_path / "MainShaft.fmu" / "in the way").touch()
    with pytest.raises(LoomfmuError, match=r"MainShaft\.fmu: cannot be written \(it is a dir"):
        live_fmu.build("MainShaft", tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["MainShaft.fmu"]
    with pytest.raises(KeyError):
        live_fmu.build("Spindle", tmp_path)


# ---- identity


@dataclass(slots=True)
class MainShaft(Component):
    """A shaft."""

    speed: float = parameter("rad/s", 1.0, "Speed", minimum=-10.0, maximum=10.0)
    law: int = parameter("1", 1, "Law", choices=("constant", "ramp"))
    angle: float = output("rad", "Angle", unbounded=True)

    def initialize(self, time: float) -> int:
        """Start."""
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Go on."""
        self.angle = self.speed * (time + step_size)
        return 0


Original = MainShaft


def declared(name: str, kind: type, field: object) -> type[Component]:
    """The same component with one other declaration."""
    made = type(
        "MainShaft", (Original,), {"__annotations__": {name: kind}, name: field, "__doc__": Original.__doc__}
    )
    return dataclass(slots=True)(made)


def test_identity_changes_with_every_declaration() -> None:
    others = [
        declared("speed", float, parameter("rad/s", 2.0, "Speed", minimum=-10.0, maximum=10.0)),
        declared("speed", float, parameter("rad/s", 1.0, "Speed", minimum=-20.0, maximum=10.0)),
        declared("speed", float, parameter("rad/s", 1.0, "Speed", minimum=-10.0, maximum=20.0)),
        declared("speed", float, parameter("rad/s", 1.0, "Other speed", minimum=-10.0, maximum=10.0)),
        declared("speed", float, parameter("m/s", 1.0, "Speed", minimum=-10.0, maximum=10.0)),
        declared("speed", float, parameter("rad/s", 1.0, "Speed", minimum=-10.0, maximum=10.0, nominal=5.0)),
        declared(
            "speed", float, parameter("rad/s", 1.0, "Speed", minimum=-10.0, maximum=10.0, display="rev/min")
        ),
        declared("law", int, parameter("1", 1, "Law", choices=("constant", "smooth ramp"))),
        declared("angle", float, output("rad", "Angle")),
        declared("more", float, output("rad", "More")),
    ]
    same = declared("angle", float, output("rad", "Angle", unbounded=True))
    identities = [live_fmu.guid(other) for other in [Original, *others]]
    assert len(set(identities)) == len(identities)
    assert live_fmu.guid(same) == live_fmu.guid(Original)


def test_identity_changes_with_the_source(monkeypatch: pytest.MonkeyPatch) -> None:
    @dataclass(slots=True)
    class Faster(Original):
        """A shaft."""

        def step(self, time: float, step_size: float) -> int:
            """Go on."""
            self.angle = 2.0 * self.speed * (time + step_size)
            return 0

    Faster.__name__ = "MainShaft"
    before = live_fmu.guid(Original)
    assert live_fmu.guid(Faster) != before
    source = live_fmu._source
    for copied in live_fmu.LIVE:
        monkeypatch.setattr(live_fmu, "_source", lambda m, of=copied: source(m) + "# other\n" * (m is of))
        assert live_fmu.guid(Original) != before
    monkeypatch.setattr(live_fmu, "_source", source)
    assert live_fmu.guid(Original) == before
    monkeypatch.setattr(live_fmu, "__version__", "99.0")
    assert live_fmu.guid(Original) != before


@every_fmu
def test_value_references_and_identity_are_those_of_the_file(name: str) -> None:
    fmu = fmus.of_component(name)
    assert fmu.guid == live_fmu.guid(COMPONENTS[name])
    assert [port.reference for port in fmu.ports.values()] == list(range(1, len(fmu.ports) + 1))
    assert fmu.identifier == name


# ---- reference results


@every_fmu
def test_references_have_the_samples_of_one_revolution(name: str) -> None:
    path = fmu_files.folder(COMPONENTS[name]) / "reference.csv"
    times = np.genfromtxt(path, delimiter=",", names=True, deletechars="")["time"]
    np.testing.assert_array_equal(times, np.arange(SAMPLES) * STEP_SIZE)


def test_reference_results_are_written_where_the_fmus_lie(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("write_fmu_pages.folder", lambda component: tmp_path)
    monkeypatch.setattr("write_fmu_pages.COMPONENTS", {"MainShaft": components.MainShaft})
    write_references()
    written = (tmp_path / "reference.csv").read_text()
    assert written == reference(components.MainShaft)
    lines = written.splitlines()
    assert lines[0] == "time,angle,velocity,acceleration"
    assert lines[1] == "0.0,0.0,41.88790204786391,0.0"
    assert len(lines) == 1 + 145
    last = [float(value) for value in lines[-1].split(",")]
    np.testing.assert_allclose(last[:2], [0.15, 2 * np.pi], rtol=1e-15)  # one revolution, 2.5 deg apart


def test_the_documentation_says_what_the_fmu_calls_numbered_variables() -> None:
    page = fmu_files.described(COMPONENTS["HealdFrame"])["documentation/index.html"].decode()
    assert "<code>pattern_1</code> is called <code>pattern[1]</code>" in page
    assert "is called" not in fmu_files.described(COMPONENTS["BeltWrap"])["documentation/index.html"].decode()
