"""Builds native FMUs: a component translated to C, in a C shell, compiled for all platforms from any."""

import hashlib
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from ...components import COMPONENTS
from ...errors import LoomfmuError, suggestion
from ...files import ANY, write_file
from ...variables import Component
from ..builder import (
    FMU,
    HEADERS,
    beside,
    described,
    file_in,
    guid,
    license_of,
    license_of_headers,
    version,
    zipped,
)
from ..cache import compiler_environment
from ..description.model_description import model_description, output_order
from ..description.model_description3 import model_description3
from .fat_binary import fat_binary
from .tables import tables
from .translate import Translation, translate

SHELL = Path(__file__).with_name("shell")


@dataclass(frozen=True)
class Platform:
    """What a shared library is called on a platform, and how it is compiled and linked.

    `targets` has the compiler's name for each processor, with the name of its folder in FMI 3.
    """

    suffix: str
    targets: dict[str, str]
    options: tuple[str, ...]


PLATFORMS = {
    "linux64": Platform(
        ".so",
        {"x86_64-linux-gnu.2.17": "x86_64-linux"},
        ("-fPIC", "-Wl,--build-id=none", "-Wl,-rpath,$ORIGIN", "-lm"),
    ),
    "win64": Platform(".dll", {"x86_64-windows-gnu": "x86_64-windows"}, ()),
    "darwin64": Platform(
        ".dylib",
        {"x86_64-macos.11.0": "x86_64-darwin", "aarch64-macos.11.0": "aarch64-darwin"},
        ("-fPIC", "-Wl,-install_name,@rpath/{name}.dylib"),
    ),
}
# no fused multiply-add, as in Python; integers wrap alike in every build
ARITHMETIC = ("-O2", "-ffp-contract=off", "-fwrapv")
OPTIONS = " ".join(ARITHMETIC)
FLAGS = ("-shared", "-std=c99", *ARITHMETIC, "-g0", "-s", "-fno-sanitize=all")
COMMON_FILES = (
    "tables.h", "python_arithmetic.h", "grid.h", "instance.h", "messages.c", "instance.c", "values.c",
    "states.c", "solver.c",
)  # fmt: skip
SHELL_FILES = {
    2: (
        "carry.c", "fmi2.c", "fmi2_solver.c", "fmi2_values.c", "fmi2_steps.c",
        "fmi2TypesPlatform.h", "fmi2FunctionTypes.h", "fmi2Functions.h",
    ),
    3: (
        "fmi3.c", "fmi3_solver.c", "fmi3_values.c", "fmi3_steps.c", "fmi3_absent.c",
        "fmi3PlatformTypes.h", "fmi3FunctionTypes.h", "fmi3Functions.h",
    ),
}  # fmt: skip
ICONS = {2: "model.png", 3: "terminalsAndIcons/icon.png"}
COMMAND = f"cc -shared -fPIC -std=c99 {OPTIONS} -o {{name}}.so fmi{{fmi}}.c -lm"

BUILD_DESCRIPTION = f"""<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{{name}}">
    <SourceFileSet language="C99" compilerOptions="{OPTIONS}">
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
    documents = beside(component, {"icon.png": ICONS[fmi]}) | described(component, note)
    return assembled(component, guid(component), documents, sources(component, fmi), platforms, fmi)


def assembled(
    component: type[Component], token: str, documents: dict[str, bytes], code: dict[str, str],
    platforms: tuple[str, ...], fmi: int, capabilities: dict[str, str] | None = None,
) -> dict[str, bytes]:  # fmt: skip
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
        return model_description3(component, token, version())
    capabilities = {
        # of one without inputs too: PyFMI's master extrapolates a whole system or nothing of it
        "canInterpolateInputs": "true",
        "maxOutputDerivativeOrder": str(output_order(component)),
    } | capabilities
    return model_description(component, token, version(), capabilities)


def sources(component: type[Component], fmi: int = 2) -> dict[str, str]:
    """The C text of a native FMU: shell, tables, translated component, headers of the standard."""
    return with_shell(translate(component), tables(component, guid(component)), fmi)


def with_shell(translated: Translation, model: str, fmi: int) -> dict[str, str]:
    """A translation and the tables of its variables with the shell and the headers of the standard."""
    files = {"component.h": translated.header, "component.c": translated.code, "model.h": model}
    for file in (*COMMON_FILES, *SHELL_FILES[fmi]):
        place = SHELL if (SHELL / file).exists() else HEADERS
        files[file] = (place / file).read_text("utf-8")
    return files


def identity(component: type[Component], platforms: tuple[str, ...]) -> str:
    """What a native FMU depends on, as a name for a cache: the component, the shell and the tools."""
    digest = hashlib.sha256(repr((guid(component), platforms)).encode())
    for file in (*sorted(SHELL.iterdir()), *sorted(Path(__file__).parents[1].rglob("*.py"))):
        digest.update(file.read_bytes())
    for tool in ("ziglang", "fmpy"):
        digest.update(metadata.version(tool).encode() if find_spec(tool) else b"")
    return f"{guid(component)}-native-{digest.hexdigest()[:16]}"


def host_platform() -> str:
    """The platform that this process runs on."""
    return {"linux": "linux64", "win32": "win64", "darwin": "darwin64"}.get(sys.platform, "linux64")


def check_platforms(platforms: tuple[str, ...]) -> tuple[str, ...]:
    """The platforms, if they are known. Raises LoomfmuError for one that is not."""
    for platform in platforms:
        if platform not in PLATFORMS:
            raise LoomfmuError(f"there is no platform {platform!r}{suggestion(platform, PLATFORMS)}")
    return platforms


def licenses(platforms: tuple[str, ...], code: dict[str, str]) -> dict[str, bytes]:
    """The licences of all that is in the FMU."""
    header = next(text for file, text in code.items() if file.endswith("Functions.h"))
    found = {
        "license.txt": license_of("loomfmu"),
        "fmi_headers.txt": license_of_headers(header),
    }
    if "win64" in platforms:
        # what the compiler links into a DLL beside our own
        found["mingw-w64.txt"] = (_compiler() / "lib" / "libc" / "mingw" / "COPYING").read_bytes()
    return {f"documentation/licenses/{file}": content for file, content in found.items()}


def binaries(
    name: str, fmi: int, code: dict[str, str], platforms: tuple[str, ...]
) -> dict[str, bytes]:  # fmt: skip
    """The shared libraries by their places; in FMI 2 that of darwin64 holds both of its processors."""
    _compiler()
    targets = [target for platform in platforms for target in PLATFORMS[platform].targets]
    with tempfile.TemporaryDirectory(prefix="loomfmu-") as directory:
        for file, text in code.items():
            (Path(directory) / file).write_text(text, encoding="utf-8")
        with ThreadPoolExecutor() as pool:
            compiled = pool.map(lambda target: _compiled(name, fmi, target, Path(directory)), targets)
            libraries = dict(zip(targets, compiled, strict=True))
    found = {}
    for platform in platforms:
        suffix, places = PLATFORMS[platform].suffix, PLATFORMS[platform].targets
        parts = [libraries[target] for target in places]
        if fmi == 2:
            found[f"{platform}/{name}{suffix}"] = parts[0] if len(parts) == 1 else fat_binary(parts)
        else:
            for place, part in zip(places.values(), parts, strict=True):
                found[f"{place}/{name}{suffix}"] = part
    return found


def _compiled(name: str, fmi: int, target: str, directory: Path) -> bytes:
    """One shared library of an FMU."""
    platform = next(each for each in PLATFORMS.values() if target in each.targets)
    output = Path(target) / f"{name}{platform.suffix}"
    (directory / target).mkdir()
    _compile(f"fmi{fmi}.c", output, target, directory)
    return (directory / output).read_bytes()


def _compile(source: str, output: Path, target: str, directory: Path) -> None:
    """Compile a file into a shared library. Paths are relative, so that none gets into it."""
    platform = next(each for each in PLATFORMS.values() if target in each.targets)
    options = [option.format(name=output.stem) for option in platform.options]
    call = [sys.executable, "-m", "ziglang", "cc", "-target", target, *FLAGS, "-o", str(output), source]
    run = subprocess.run(
        [*call, *options],
        cwd=directory,
        env=compiler_environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    if run.returncode != 0:
        reason = (run.stderr.strip().splitlines() or ["no reason given"])[0]
        raise LoomfmuError(f"{output.stem} cannot be compiled for {target}: {reason}")


def library_identity(source: Path) -> str:
    """What a shared library of this source depends on, as a name for a cache. Raises as `build_library`."""
    _compiler()
    return hashlib.sha256(source.read_bytes() + metadata.version("ziglang").encode()).hexdigest()


def build_library(source: Path, output: Path, platform: str) -> None:
    """Compile one C file into a shared library file. Raises LoomfmuError as `library`, or naming the file."""
    write_file(output, library(source, platform), ANY)


def library(source: Path, platform: str) -> bytes:
    """One C file as a shared library for all processors of a platform.

    Raises LoomfmuError where there is no compiler, or it does not compile.
    """
    _compiler()
    suffix, targets = PLATFORMS[platform].suffix, PLATFORMS[platform].targets
    with tempfile.TemporaryDirectory(prefix="loomfmu-") as name:
        directory, output = Path(name), Path(f"{source.stem}{suffix}")
        shutil.copy(source, directory)
        parts = []
        for target in targets:
            _compile(source.name, output, target, directory)
            parts.append((directory / output).read_bytes())
    return parts[0] if len(parts) == 1 else fat_binary(parts)


@cache
def _compiler() -> Path:
    """Where the compiler is installed. Raises LoomfmuError if it is not."""
    found = find_spec("ziglang")
    if found is None or found.origin is None:
        raise LoomfmuError("native FMUs are compiled by ziglang: pip install 'loomfmu[native]'")
    return Path(found.origin).parent
