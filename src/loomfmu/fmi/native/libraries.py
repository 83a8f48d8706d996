"""Libraries in C: one judges claims, the other does with the same bits what this package does in Python.

Each comes with the package, or is built once where a compiler is installed. One that comes with it is loaded
only if it is, to the last byte, what was built of the source beside it: each has its digest with it.
"""

import hashlib
from collections.abc import Iterable
from functools import cache, partial
from pathlib import Path

from ...cache.entries import STEPPER, made_file
from ...errors import LoomfmuError
from ...files import ANY, write_file
from . import platforms
from .sources import code_of


@cache
def library_of(source: Path) -> Path | None:
    """Return the library of a C file, if there is one or it can be built."""
    try:
        return needed_library(source)
    except LoomfmuError:  # no compiler, or no place to keep what it makes
        return None


def needed_library(source: Path) -> Path:
    """Return the library of a C file. Raises LoomfmuError if it is not here and cannot be built."""
    platform = platforms.host()
    shipped = _shipped(source, platform)
    if platform and _is_of(shipped, source):
        return shipped
    from . import compiler  # a package that brings its libraries needs none

    identity = compiler.library_identity(code_of(source))
    return made_file(STEPPER, identity, shipped.name, lambda: compiler.library(source, platform))


def module_of(source: str, code: dict[str, str]) -> bytes:
    """A file of some C code as a module of WebAssembly. Raises LoomfmuError if it cannot be built."""
    from . import compiler, web_assembly

    make = partial(web_assembly.web_assembly, source, code)
    name = Path(source).with_suffix(".wasm").name
    return made_file(STEPPER, compiler.library_identity(code, source), name, make).read_bytes()


def _shipped(source: Path, platform: str) -> Path:
    """Return the path of the library of a platform in a package that brings it."""
    suffix = platforms.PLATFORMS.get(platform, platforms.HERE).suffix
    return platforms.SHIPPED / platform / f"{source.stem}{suffix}"


def _seal_of(library: Path) -> Path:
    """The file that says which library of which source it is."""
    return library.with_name(f"{library.name}.sha256")


def _seal(source: Path, library: bytes) -> bytes:
    code = hashlib.sha256(repr(code_of(source)).encode())
    return hashlib.sha256(code.digest() + library).hexdigest().encode()


def _is_of(library: Path, source: Path) -> bool:
    """Return whether a library that the package brings is of this source, and unchanged since."""
    try:
        return _seal_of(library).read_bytes() == _seal(source, library.read_bytes())
    except OSError:
        return False


def build_all(sources: Iterable[Path], wanted: Iterable[str]) -> None:
    """Build libraries for platforms, for a package that brings them. Raises LoomfmuError."""
    from .compiler import library

    for source in sources:
        for platform in wanted:
            made = library(source, platform)
            path = write_file(_shipped(source, platform), made, ANY)
            write_file(_seal_of(path), _seal(source, made), ANY)
