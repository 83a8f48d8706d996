"""Environments with some of the packages that are installed here: made in seconds, without a network."""

import sys
import venv
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name


def needed(text: str) -> set[str]:
    """The names of all packages that one requires, directly or through others, and its own."""
    found: set[tuple[str, str]] = set()
    waiting = [Requirement(text)]
    while waiting:
        required = waiting.pop()
        for extra in required.extras | {""}:
            name = canonicalize_name(required.name)
            if (name, extra) in found:
                continue
            found.add((name, extra))
            for each in map(Requirement, metadata.requires(name) or ()):
                if each.marker is None or each.marker.evaluate({"extra": extra}):
                    waiting.append(each)
    return {name for name, _ in found}


def made(place: Path, names: set[str]) -> Path:
    """An environment with these packages, of those that this platform has; its Python."""
    venv.create(place, symlinks=True)
    version = f"python{sys.version_info.major}.{sys.version_info.minor}"
    packages = place / "lib" / version / "site-packages"
    for name in names:
        try:
            files = metadata.distribution(name).files or ()
        except metadata.PackageNotFoundError:  # of another platform
            continue
        for file in files:
            if ".." not in file.parts and "__pycache__" not in file.parts:
                target = packages / file
                target.parent.mkdir(parents=True, exist_ok=True)
                target.symlink_to(file.locate())
    return place / "bin" / "python"
