"""The platforms that native FMUs are built for, and what this machine has of them."""

import platform
import sys
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from ...errors import LoomfmuError, suggestion

SHIPPED = Path(__file__).with_name("shipped")  # what a package brings that needs no compiler
COMPILER = "ziglang"


@dataclass(frozen=True)
class Platform:
    """Name of a shared library on a platform, and the arguments that compile and link it.

    `targets` has the compiler's name for each processor, with the name of its folder in FMI 3.
    """

    suffix: str
    targets: dict[str, str]
    options: tuple[str, ...]


LINUX = ("-fPIC", "-Wl,--build-id=none", "-Wl,-rpath,$ORIGIN", "-lm")
# FMI 2 has no name for the second: it is that of FMI 3
PLATFORMS = {
    "linux64": Platform(".so", {"x86_64-linux-gnu.2.17": "x86_64-linux"}, LINUX),
    "aarch64-linux": Platform(".so", {"aarch64-linux-gnu.2.17": "aarch64-linux"}, LINUX),
    "win64": Platform(".dll", {"x86_64-windows-gnu": "x86_64-windows"}, ()),
    "darwin64": Platform(
        ".dylib",
        {"x86_64-macos.11.0": "x86_64-darwin", "aarch64-macos.11.0": "aarch64-darwin"},
        ("-fPIC", "-Wl,-install_name,@rpath/{name}.dylib"),
    ),
}
# this machine, where it is none of them: libraries are built for it, but no FMUs
HERE = Platform(".so", {"native": ""}, ("-fPIC", "-lm"))
SYSTEMS = {
    "linux": {"x86_64": "linux64", "aarch64": "aarch64-linux"},
    "win32": {"AMD64": "win64"},
    "darwin": {"x86_64": "darwin64", "arm64": "darwin64"},
}
MACHINE = f"{sys.platform} on {platform.machine()}"


def host() -> str:
    """The platform that this process runs on; empty if no native FMUs are built for it."""
    known = SYSTEMS.get(sys.platform, {}) if sys.maxsize > 2**32 else {}
    return known.get(platform.machine(), "")


def check_platforms(platforms: tuple[str, ...]) -> tuple[str, ...]:
    """The platforms, if they are known. Raises LoomfmuError for one that is not."""
    for each in platforms:
        if each not in PLATFORMS:
            raise LoomfmuError(f"there is no platform {each!r}{suggestion(each, PLATFORMS)}")
    return platforms


def platform_of(target: str) -> Platform:
    """The platform that a target of the compiler belongs to."""
    return next((each for each in PLATFORMS.values() if target in each.targets), HERE)


@cache
def compiler() -> Path | None:
    """Return the path of the compiler, if it is installed."""
    found = find_spec(COMPILER)
    return None if found is None or found.origin is None else Path(found.origin).parent


def stamp(package: str) -> str:
    """Return a stamp that changes when a package is installed anew; its version takes far longer."""
    found = find_spec(package)
    if found is None or found.origin is None:
        return ""
    status = Path(found.origin).stat()
    return f"{package} {status.st_size} {status.st_mtime_ns}"
