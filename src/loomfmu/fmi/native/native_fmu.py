"""Builds native FMUs: a component translated to C, in a C shell, compiled for all platforms."""

import hashlib
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from ...components import COMPONENTS
from ...declaring.variables import Component
from ...files import write_file
from ...version import __version__
from ..description.model_description import model_description, model_description3, output_order
from ..fmu_files import FMU, HEADERS, described, file_in, files_near, license_of, license_of_headers, zipped
from ..live_fmu import guid
from .compiler import ARITHMETIC, MINGW, binaries, mingw_licence
from .platforms import PLATFORMS
from .tables import dual_tables, tables
from .translate import Translation, translate

SHELL = Path(__file__).with_name("shell")


OPTIONS = " ".join(ARITHMETIC)
COMMON_FILES = (
    "tables.h",
    "python_arithmetic.h",
    "grid.h",
    "broyden.h",
    "instance.h",
    "messages.c",
    "loop.c",
    "instance.c",
    "values.c",
    "states.c",
    "solver.c",
)
PAGE = 0  # not a version of FMI: the shell of a page in a browser
SHELL_FILES = {
    PAGE: ("page.c",),
    2: (
        "dual.h",
        "dual_grid.h",
        "derivatives.c",
        "carry.c",
        "fmi2.c",
        "fmi2_solver.c",
        "fmi2_values.c",
        "fmi2_steps.c",
        "fmi2TypesPlatform.h",
        "fmi2FunctionTypes.h",
        "fmi2Functions.h",
    ),
    3: (
        "dual.h",
        "dual_grid.h",
        "derivatives.c",
        "fmi3.c",
        "fmi3_solver.c",
        "fmi3_values.c",
        "fmi3_steps.c",
        "fmi3_absent.c",
        "fmi3PlatformTypes.h",
        "fmi3FunctionTypes.h",
        "fmi3Functions.h",
    ),
}
ICONS = {2: "model.png", 3: "terminalsAndIcons/icon.png"}
COMMAND = f"cc -shared -fPIC -std=c99 {OPTIONS} -o {{name}}.so fmi{{fmi}}.c -lm"

BUILD_DESCRIPTION = f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{{name}}">
    <SourceFileSet language="C99" compiler="cc" compilerOptions="{OPTIONS}">
      <SourceFile name="fmi{{fmi}}.c"/>
    </SourceFileSet>
    <Library name="m"/>
  </BuildConfiguration>
</fmiBuildDescription>
"""

NOTE = """
## The native flavour

This FMU is native: the component's Python source, translated to C, in a shell of C99. It needs no Python
and no library but those of the system. Its variables and results are those of the live flavour. The
folder `sources` holds all of it; one command, run in that folder, builds it for another platform:

    {command}
"""


def build_native(
    component: str | type[Component],
    directory: Path,
    platforms: tuple[str, ...] = tuple(PLATFORMS),
    fmi: int = 2,
    overwrite: bool = False,
) -> Path:
    """Build one native FMU of FMI 2 or FMI 3 into a directory and return its path.

    `component` is a class, or the name of one of ours. `overwrite` replaces what is not an FMU of ours.

    Raises:
        KeyError: an unknown component
        LoomfmuError: it does not translate, an unknown platform, no compiler, or the file cannot be written
    """
    component = COMPONENTS[component] if isinstance(component, str) else component
    target = file_in(directory, component.__name__, overwrite)
    return write_file(target, archive(component, platforms, fmi), FMU, overwrite=overwrite)


def archive(component: type[Component], platforms: tuple[str, ...], fmi: int = 2) -> bytes:
    """A native FMU as bytes. Raises LoomfmuError as `build_native`."""
    return zipped(contents(component, platforms, fmi))


def contents(component: type[Component], platforms: tuple[str, ...], fmi: int) -> dict[str, bytes]:
    """All files of a native FMU by their names in it."""
    note = NOTE.format(command=COMMAND.format(name=component.__name__, fmi=fmi))
    documents = files_near(component, {"icon.png": ICONS[fmi]}) | described(component, note)
    return assembled(component, guid(component), documents, sources(component, fmi), platforms, fmi)


def assembled(
    component: type[Component],
    token: str,
    documents: dict[str, bytes],
    code: dict[str, str],
    platforms: tuple[str, ...],
    fmi: int,
    capabilities: dict[str, str] | None = None,
) -> dict[str, bytes]:
    """A native FMU's files from what describes it and its C text, which is compiled."""
    name = component.__name__
    files = {
        "modelDescription.xml": _description(component, token, fmi, capabilities or {}),
        **documents,
        **licenses(platforms, code),
        "sources/buildDescription.xml": BUILD_DESCRIPTION.format(name=name, fmi=fmi).encode(),
        **{f"sources/{file}": text.encode() for file, text in code.items()},
    }
    for place, binary in binaries(name, fmi, code, platforms).items():
        files[f"binaries/{place}"] = binary
    return files


def _description(component: type[Component], token: str, fmi: int, capabilities: dict[str, str]) -> bytes:
    if fmi == 3:
        return model_description3(component, token, __version__)
    capabilities = {
        # of one without inputs too: PyFMI's master extrapolates a whole system or nothing of it
        "canInterpolateInputs": "true",
        "maxOutputDerivativeOrder": str(output_order(component)),
    } | capabilities
    return model_description(component, token, __version__, capabilities)


def sources(component: type[Component], fmi: int = 2) -> dict[str, str]:
    """The C text of a native FMU: shell, tables, translated component, headers of the standard."""
    return with_shell(translate(component), tables(component, guid(component)), dual_tables(component), fmi)


def with_shell(translated: Translation, model: str, dual_model: str, fmi: int) -> dict[str, str]:
    """A translation and the tables of its variables with a shell, and the headers of its standard.

    A page takes no derivatives.
    """
    files = {"component.h": translated.header, "component.c": translated.code, "model.h": model}
    if fmi != PAGE:
        files |= {"component_dual.c": translated.dual_code, "model_dual.h": dual_model}
    for file in (*COMMON_FILES, *SHELL_FILES[fmi]):
        place = SHELL if (SHELL / file).exists() else HEADERS
        files[file] = (place / file).read_text("utf-8")
    return files


def identity(component: type[Component]) -> str:
    """Return a name for a cache, by all that a native FMU needs: the component, the shell and the tools."""
    digest = hashlib.sha256(guid(component).encode())
    for file in (*sorted(SHELL.iterdir()), *sorted(Path(__file__).parents[1].rglob("*.py"))):
        digest.update(file.read_bytes())
    for tool in ("ziglang", "fmpy"):
        digest.update(metadata.version(tool).encode() if find_spec(tool) else b"")
    return f"{guid(component)}-native-{digest.hexdigest()[:16]}"


def licenses(platforms: tuple[str, ...], code: dict[str, str]) -> dict[str, bytes]:
    """The licences of all that is in the FMU."""
    header = next(text for file, text in code.items() if file.endswith("Functions.h"))
    found = {
        "license.txt": license_of("loomfmu"),
        "fmi_headers.txt": license_of_headers(header),
    }
    if "win64" in platforms:
        found[MINGW] = mingw_licence()
    return {f"documentation/licenses/{file}": content for file, content in found.items()}
