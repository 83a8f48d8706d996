"""Libraries that do in C what this package also does in Python, with the same bits.

Each comes with the package, or is built once where a compiler is installed.
"""

from collections.abc import Iterable
from functools import cache
from pathlib import Path

from ...errors import LoomfmuError
from ..cache_entries import STEPPER, made_file
from . import platforms


@cache
def library_of(source: Path) -> Path | None:
    """The library of a C file, if there is one or it can be built."""
    platform = platforms.host()
    if not platform:
        return None
    shipped = _shipped(source, platform)
    if shipped.exists():
        return shipped
    from . import compiler  # a package that brings its libraries needs none

    try:
        identity = compiler.library_identity(source)
        return made_file(STEPPER, identity, shipped.name, lambda: compiler.library(source, platform))
    except LoomfmuError:  # no compiler, or no place to keep what it makes
        return None


def _shipped(source: Path, platform: str) -> Path:
    """Where the library of a platform lies in a package that brings it."""
    return source.with_name(platform) / f"{source.stem}{platforms.PLATFORMS[platform].suffix}"


def build_all(sources: Iterable[Path]) -> None:
    """Build libraries for all platforms, for a package that brings them. Raises LoomfmuError, OSError."""
    from .compiler import build_library

    for source in sources:
        for platform in platforms.PLATFORMS:
            build_library(source, _shipped(source, platform), platform)
