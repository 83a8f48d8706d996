"""Builds live FMUs: the same bytes from the same source."""

import hashlib
import uuid
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

from .. import units
from ..components import COMPONENTS
from ..declaring.variables import Component, variables_of
from ..files import write_file
from ..version import __version__
from .description import documentation
from .description.model_description import model_description
from .description.references import FIRST_REFERENCE, FMI_TYPES
from .fmu_files import (
    FMU,
    HEADERS,
    NAMESPACE,
    described,
    description_files,
    file_in,
    files_near,
    license_of,
    license_of_headers,
    zipped,
)
from .live import live_slave, live_state, live_wrapper
from .source import flatten

LIVE = (live_slave, live_state, live_wrapper)  # what is copied into each live FMU


def build(component: str | type[Component], directory: Path, overwrite: bool = False) -> Path:
    """Build one FMU into a directory and return its path. `overwrite` replaces what is not an FMU of ours.

    `component` is a class, or the name of one of ours. Raises KeyError for an unknown name and LoomfmuError
    for a file that cannot be written.
    """
    component = COMPONENTS[component] if isinstance(component, str) else component
    target = file_in(directory, component.__name__, overwrite)
    return write_file(target, archive(component), FMU, overwrite=overwrite)


def archive(component: type[Component]) -> bytes:
    """The FMU as bytes."""
    return zipped(_contents(component))


def guid(component: type[Component]) -> str:
    """Identity of an FMU: of all that is said of its variables, its source and the slave that runs it."""
    digest = hashlib.sha256(model_description(component, "", __version__))
    for content in description_files(component).values():
        digest.update(content)
    for part in (_rows(component), flatten(component), *map(_source, LIVE)):
        digest.update(part.encode())
    return str(uuid.uuid5(NAMESPACE, digest.hexdigest()))


def _contents(component: type[Component]) -> dict[str, bytes]:
    """All files of an FMU by their names in it."""
    name = component.__name__
    header = (HEADERS / "fmi2Functions.h").read_text("utf-8")
    identity = guid(component)
    # every FMU of a process shares one set of Python modules: the name must belong to this content alone
    package = f"loomfmu_{name.lower()}_{identity.replace('-', '')[:16]}"
    files = {
        "modelDescription.xml": model_description(component, identity, __version__),
        **files_near(component, {"icon.png": "model.png"}),
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
