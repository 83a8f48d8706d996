"""Compiles C to shared libraries for all platforms from any, or takes those that the package brings."""

import hashlib
import os
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import BoundedSemaphore

from ...cache.directory import compiler_environment
from ...errors import LoomfmuError
from ...extras import install
from .fat_binary import fat_binary
from .linking import keeps, link
from .platforms import COMPILER, HERE, PLATFORMS, SHIPPED, compiler, platform_of, stamp
from .sources import code_of

# no fused multiply-add, as in Python; integers wrap alike in every build
ARITHMETIC = ("-O2", "-ffp-contract=off", "-fwrapv")
PLAIN = (*ARITHMETIC, "-g0", "-s", "-fno-sanitize=all")
FLAGS = ("-shared", "-std=c99", *PLAIN)
# C++ that needs no library of its own, with C of ours in it
CPLUSPLUS = ("-std=c++17", "-fno-exceptions", "-fno-rtti", "-nostdlib++", "-Wno-address-of-temporary")
MINGW = "mingw-w64.txt"  # the licence of what the compiler links into a DLL beside our own

# two more than cores: some wait for one that makes the system's libraries for the first time
_turns = BoundedSemaphore((os.cpu_count() or 1) + 2)


def binaries(name: str, fmi: int, code: dict[str, str], platforms: tuple[str, ...]) -> dict[str, bytes]:
    """The shared libraries by their places; in FMI 2 that of darwin64 holds both of its processors.

    Those that the package brings are taken if they were made of this very code.
    """
    found = _shipped(name, fmi, code)
    places = [f"{place}/{name}{PLATFORMS[each].suffix}" for each in platforms for place in _places(each, fmi)]
    if found is None:
        found = _compiled(name, fmi, code, platforms)
    return {place: found[place] for place in places}


def of_boxes(source: str, code: dict[str, str]) -> bytes:
    """A file of C++ that uses libm alone, as a shared library for this machine. Raises as `library`."""
    with folder(code) as directory:
        output, (target,) = Path(source).with_suffix(HERE.suffix), HERE.targets
        _compile(source, output, target, directory, ("-shared", *CPLUSPLUS, *PLAIN))
        return (directory / output).read_bytes()


def mingw_licence() -> bytes:
    """The licence of what is linked into a library for Windows. Raises LoomfmuError without a compiler."""
    shipped = SHIPPED / MINGW
    if shipped.is_file():
        return shipped.read_bytes()
    return (_required() / "lib" / "libc" / "mingw" / "COPYING").read_bytes()


def library_identity(code: dict[str, str], target: str = "") -> str:
    """Return a name for a library of this code in a cache: it depends on all that the library does.

    Raises as `library`.
    """
    _required()
    return hashlib.sha256((target + repr(code) + stamp(COMPILER)).encode()).hexdigest()


def library(source: Path, platform: str) -> bytes:
    """One C file, with the headers beside it, as a shared library for a platform.

    It is for all processors of the platform; without one it is for this machine. Raises LoomfmuError if there
    is no compiler, or if compilation fails.
    """
    wanted = PLATFORMS.get(platform, HERE)
    with folder(code_of(source)) as directory:
        output, parts = Path(f"{source.stem}{wanted.suffix}"), []
        for target in wanted.targets:
            _compile(source.name, output, target, directory)
            parts.append((directory / output).read_bytes())
    return parts[0] if len(parts) == 1 else fat_binary(parts)


def _places(platform: str, fmi: int) -> list[str]:
    """The folders below `binaries` that hold the libraries of a platform."""
    return [platform] if fmi == 2 else list(PLATFORMS[platform].targets.values())


def _shipped(name: str, fmi: int, code: dict[str, str]) -> dict[str, bytes] | None:
    """The libraries of the FMU that the package brings, if it was compiled from this code."""
    path = SHIPPED / f"fmi{fmi}" / f"{name}.fmu"
    if not path.is_file():
        return None
    with zipfile.ZipFile(path) as archive:
        if any(archive.read(f"sources/{file}") != text.encode() for file, text in code.items()):
            return None
        libraries = [member for member in archive.namelist() if member.startswith("binaries/")]
        return {member.removeprefix("binaries/"): archive.read(member) for member in libraries}


def _compiled(name: str, fmi: int, code: dict[str, str], platforms: tuple[str, ...]) -> dict[str, bytes]:
    from concurrent.futures import ThreadPoolExecutor  # what is built already needs none

    targets = [target for platform in platforms for target in PLATFORMS[platform].targets]
    with folder(code) as directory, ThreadPoolExecutor() as pool:
        made = pool.map(lambda target: _library_of(name, fmi, target, directory), targets)
        libraries = dict(zip(targets, made, strict=True))
    found = {}
    for platform in platforms:
        parts = [libraries[target] for target in PLATFORMS[platform].targets]
        if fmi == 2 and len(parts) > 1:
            parts = [fat_binary(parts)]
        for place, part in zip(_places(platform, fmi), parts, strict=True):
            found[f"{place}/{name}{PLATFORMS[platform].suffix}"] = part
    return found


def _library_of(name: str, fmi: int, target: str, directory: Path) -> bytes:
    """One shared library of an FMU."""
    output = Path(target) / f"{name}{platform_of(target).suffix}"
    (directory / target).mkdir()
    _compile(f"fmi{fmi}.c", output, target, directory)
    return (directory / output).read_bytes()


@contextmanager
def folder(code: dict[str, str]) -> Iterator[Path]:
    """A folder with these files, for as long as they are compiled."""
    with tempfile.TemporaryDirectory(prefix="loomfmu-") as name:
        for file, text in code.items():
            Path(name, file).write_text(text, encoding="utf-8")
        yield Path(name)


def _compile(source: str, output: Path, target: str, directory: Path, flags: tuple[str, ...] = FLAGS) -> None:
    """Compile a file into a shared library. Paths are relative, so that none gets into it."""
    options = [option.format(name=output.stem) for option in platform_of(target).options]
    made_in(directory, target, source, output, *flags, *options)


def made_in(directory: Path, target: str, source: str, output: Path, *flags: str) -> None:
    """Compile a file in a directory and link it. Raises LoomfmuError with the reason."""
    if keeps(target):
        compiled = output.with_suffix(".o").as_posix()
        compiled_in(directory, target, *flags, "-c", "-o", compiled, source)
        if link(lambda *given: zig(*given).returncode == 0, target, compiled, output.as_posix(), directory):
            return
    compiled_in(directory, target, *flags, "-o", output.as_posix(), source)


def compiled_in(directory: Path, target: str, *arguments: str) -> None:
    """Compile in a directory; what is compiled is named after `-o`. Raises LoomfmuError with the reason."""
    run = zig(directory, "cc", "-target", target, *arguments)
    if run.returncode != 0:
        lines = run.stderr.strip().splitlines() or ["no reason given"]
        reason = next((line for line in lines if "error:" in line), lines[0])
        name = Path(arguments[arguments.index("-o") + 1]).stem
        raise LoomfmuError(f"{name} cannot be compiled for {target}: {reason}")


def zig(directory: Path, *arguments: str, **environment: str) -> "subprocess.CompletedProcess[str]":
    """Call the compiler in a directory. Raises LoomfmuError if it is not installed."""
    _required()
    with _turns:
        return subprocess.run(
            [sys.executable, "-m", COMPILER, *arguments],
            cwd=directory,
            env=compiler_environment() | environment,
            capture_output=True,
            text=True,
            check=False,
        )


def _required() -> Path:
    """Return the path of the compiler. Raises LoomfmuError if it is not installed."""
    found = compiler()
    if found is None:
        raise LoomfmuError(f"this needs a compiler, which is not installed: {install('native')}")
    return found
