"""Builds live FMUs: the same bytes from the same source."""

import hashlib
import inspect
import io
import re
import textwrap
import uuid
import zipfile
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import fmpy

from .. import units
from ..components import COMPONENTS
from ..declaring.variables import Component, variables_of
from ..files import check_target, write_file, zip_with
from ..version import __version__
from .description import documentation
from .description.model_description import model_description
from .description.parameter_sets import parameter_files, parameter_note
from .description.references import FIRST_REFERENCE, FMI_TYPES
from .description.terminals import terminal_files
from .live import live_slave, live_state, live_wrapper
from .source import flatten

FMU = zip_with("an FMU of loomfmu", "modelDescription.xml", ".fmu")
TEXTS = {name: name for name in ("README.md", "drawing.svg", "icon.png")}  # that lie with a component
HEADERS = Path(fmpy.__file__).with_name("c-code")  # those of the standard
LIVE = (live_slave, live_state, live_wrapper)  # what is copied into each live FMU
EARLIEST = (1980, 1, 1, 0, 0, 0)  # the first date a zip can hold: builds repeat
NAMESPACE = uuid.uuid5(uuid.NAMESPACE_URL, "https://pypi.org/project/loomfmu")


def folder(component: type[Component]) -> Path:
    """Return the folder with README, icon and reference of an FMU: that of its file, or the package's."""
    package = Path(__file__).parents[1]
    home = Path(inspect.getfile(component)).parent
    if not home.is_relative_to(package / "components"):
        return home
    name = re.sub(r"(?<!^)(?=[A-Z])", "_", component.__name__).lower()
    installed = package / "fmus" / name
    return installed if installed.is_dir() else package.parents[1] / "fmus" / name


def build(component: str | type[Component], directory: Path, overwrite: bool = False) -> Path:
    """Build one FMU into a directory and return its path. `overwrite` replaces what is not an FMU of ours.

    `component` is a class, or the name of one of ours. Raises KeyError for an unknown name and LoomfmuError
    for a file that cannot be written.
    """
    component = COMPONENTS[component] if isinstance(component, str) else component
    target = file_in(directory, component.__name__, overwrite)
    return write_file(target, archive(component), FMU, overwrite=overwrite)


def file_in(directory: Path, name: str, overwrite: bool) -> Path:
    """The file of an FMU in a directory. Raises LoomfmuError where it may not be written, before the work."""
    target = directory / f"{name}.fmu"
    check_target(target, FMU, overwrite=overwrite)
    return target


def archive(component: type[Component]) -> bytes:
    """The FMU as bytes."""
    return zipped(_contents(component))


def zipped(contents: dict[str, bytes]) -> bytes:
    """Files by their names as a zip, the same bytes for the same files."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archived:
        for name, content in sorted(contents.items()):
            entry = zipfile.ZipInfo(name, EARLIEST)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            archived.writestr(entry, content)
    return buffer.getvalue()


def guid(component: type[Component]) -> str:
    """Identity of an FMU: of all that is said of its variables, its source and the slave that runs it."""
    digest = hashlib.sha256(model_description(component, "", __version__))
    for content in _told(component).values():
        digest.update(content)
    for part in (_rows(component), flatten(component), *map(_source, LIVE)):
        digest.update(part.encode())
    return str(uuid.uuid5(NAMESPACE, digest.hexdigest()))


def described(component: type[Component], note: str = "") -> dict[str, bytes]:
    """The files that describe a component in every flavour; the note ends the documentation."""
    text = beside(component, {"README.md": "text"}).get("text")
    readme = documentation.derived(component) if text is None else text.decode("utf-8-sig")
    readme = documentation.with_table(readme, component)
    note = documentation.names_note(component) + parameter_note(component) + note
    return {
        "documentation/index.html": documentation.page(component.__name__, readme + note),
        **beside(component, {"drawing.svg": "documentation/drawing.svg"}),
        **_told(component),
    }


def beside(component: type[Component], names: dict[str, str]) -> dict[str, bytes]:
    """Files that lie with a component, by their names in the FMU; those that are not there are left out."""
    home = folder(component)
    return {there: (home / here).read_bytes() for here, there in names.items() if (home / here).is_file()}


def _told(component: type[Component]) -> dict[str, bytes]:
    """Return the files that describe the variables in addition to the model description."""
    return terminal_files(component) | parameter_files(component, __version__)


def _contents(component: type[Component]) -> dict[str, bytes]:
    """All files of an FMU by their names in it."""
    name = component.__name__
    header = (HEADERS / "fmi2Functions.h").read_text("utf-8")
    identity = guid(component)
    # every FMU of a process shares one set of Python modules: the name must belong to this content alone
    package = f"loomfmu_{name.lower()}_{identity.replace('-', '')[:16]}"
    files = {
        "modelDescription.xml": model_description(component, identity, __version__),
        **beside(component, {"icon.png": "model.png"}),
        **described(component),
        "documentation/externalDependencies.html": documentation.external_dependencies(name),
        "documentation/licenses/license.txt": license_of("loomfmu"),
        "documentation/licenses/pythonfmu.txt": license_of("pythonfmu"),
        "documentation/licenses/cppfmu.txt": Path(live_slave.__file__).with_name("cppfmu.txt").read_bytes(),
        "documentation/licenses/fmi_headers.txt": license_of_headers(header),
        "resources/slavemodule.txt": f"{package}_entry".encode(),
        f"resources/{package}_entry.py": _entry(component, package, identity).encode(),
        f"resources/{package}/__init__.py": b"",
        f"resources/{package}/component.py": flatten(component).encode(),
    } | {f"resources/{package}/{Path(str(each.__file__)).name}": _source(each).encode() for each in LIVE}
    for binary in sorted((_wrapper() / "resources" / "binaries").rglob("*")):
        if binary.is_file():
            files[f"binaries/{binary.parent.name}/{name}{binary.suffix}"] = binary.read_bytes()
    return files


def _wrapper() -> Path:
    """Return the folder of pythonfmu, for its compiled wrapper."""
    found = find_spec("pythonfmu")
    assert found is not None and found.origin is not None, "pythonfmu is installed with this package"
    return Path(found.origin).parent


def _entry(component: type[Component], package: str, identity: str) -> str:
    """The module that pythonfmu's wrapper runs anew for every instance: so it is short.

    It needs a function of its own: without one the wrapper frees the module's names under it.
    """
    return f'''"""Entry of the FMU {component.__name__}."""

import {package}.component as _component
import {package}.live_slave as _slave

_Row = _slave.Row


class {component.__name__}Slave(_slave.LiveSlave):
    """{component.__name__} as a co-simulation slave."""

    component_class = _component.{component.__name__}
    guid = {identity!r}
    problems = {tuple((problem.text, problem.warning) for problem in component.problems)!r}
    rows = {{
{_rows(component)}
    }}

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
'''


def _rows(component: type[Component]) -> str:
    """The variables as the live slave needs them, by value reference."""
    lines = []
    for reference, variable in enumerate(variables_of(component), start=FIRST_REFERENCE):
        row = (
            variable.name,
            FMI_TYPES[variable.type],
            variable.causality,
            *variable.limits,
            variable.display,
            units.unit(variable.display).factor,
        )
        lines.append(f"        {reference}: _Row{row!r},")
    return "\n".join(lines)


def _source(module: ModuleType) -> str:
    """The text of a module that is copied into each live FMU."""
    assert module.__file__ is not None, "modules of this package have files"
    return Path(module.__file__).read_text(encoding="utf-8")


def license_of(distribution: str) -> bytes:
    """The licence text that a distribution carries, or that lies at the root of a checkout."""
    for file in metadata.files(distribution) or ():
        if "license" in file.name.lower():
            return Path(str(file.locate())).read_bytes()
    return (Path(__file__).parents[3] / "LICENSE").read_bytes()


def license_of_headers(header: str) -> bytes:
    """The licence of the standard's headers, which one of them states."""
    return textwrap.dedent(header[header.index("Copyright (C)") : header.index("*/")]).encode()
