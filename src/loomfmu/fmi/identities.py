"""The identity of each build of our own FMUs, computed once for a state of their sources.

Flattening and describing a component takes a tenth of a second; reading the files that it depends on takes
a few milliseconds. So what was computed is kept under a digest of these files: in the package, if it brings
its FMUs, or in the cache.
"""

import hashlib
import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, cast

from .. import components
from ..cache.entries import IDENTITIES, made_file
from ..declaring.variables import Component
from ..files import replace_file
from .dataflow.dependencies import dependencies
from .native.platforms import SHIPPED, stamp

PACKAGE = Path(__file__).parents[1]
PARTS = (
    "components",
    "declaring",
    "fmi",
    "machines",
    "physics",
    "units.py",
    "version.py",
)
KINDS = (
    ".py",
    ".c",
    ".h",
    ".csv",
    ".txt",
)  # of files: others, such as bytecode and binaries, are made of them
TOOLS = ("ziglang", "fmpy", "pythonfmu")

Identity = dict[str, str]  # "guid", and a name in the cache for each flavour


def is_own(component: type[Component]) -> bool:
    """Return whether a component is one of this package, and not of a user's file."""
    return component.__module__.startswith(f"{components.__name__}.")


def identity(component: type[Component]) -> Identity:
    """GUID and names in the cache of a component's FMUs.

    Raises LoomfmuError for one that cannot be carried into an FMU.
    """
    return _kept(component.__name__)["fmu"] if is_own(component) else _computed(component)


def needs(component: type[Component]) -> Mapping[str, frozenset[str]]:
    """On what each output of a component depends over several steps, as `dependencies` says."""
    if not is_own(component):
        return dependencies(component).always
    kept = _kept(component.__name__)["needs"]
    return {output: frozenset(names.split()) for output, names in kept.items()}


def shipped(component: type[Component], fmi: int = 2) -> Path | None:
    """The native FMU for all platforms that the package brings, if it was built from these very sources."""
    path = SHIPPED / f"fmi{fmi}" / f"{component.__name__}.fmu"
    return path if is_own(component) and _shipped() is not None and path.is_file() else None


@cache
def sources() -> str:
    """A digest of all files that an FMU of ours depends on, and of their names."""
    home = documents()
    files = [file for part in PARTS for file in _files(PACKAGE / part)]
    files += [file for file in sorted(home.glob("*/*")) if file.is_file()]
    digest = hashlib.sha256()
    for file in files:
        content = file.read_bytes()
        digest.update(f"{file.parent.name}/{file.name} {len(content)}\n".encode() + content)
    return digest.hexdigest()


def documents() -> Path:
    """The folder with README, drawing, icon and reference of each FMU: in the package, or beside it."""
    installed = PACKAGE / "fmus"
    return installed if installed.is_dir() else PACKAGE.parents[1] / "fmus"


def write(directory: Path) -> None:
    """Keep the identities in a package that brings its FMUs."""
    kept = {"sources": sources(), "of": {name: _of(name) for name in components.COMPONENTS}}
    replace_file(directory / "identities.json", json.dumps(kept, indent=1).encode())


def _files(part: Path) -> list[Path]:
    if part.is_file():
        return [part]
    return sorted(file for file in part.rglob("*") if file.suffix in KINDS)


@cache
def _kept(name: str) -> dict[str, Any]:
    """The identity of a component and the needs of its outputs, as they are kept."""
    found = _shipped()
    if found is not None:
        return cast(dict[str, Any], found["of"][name])
    key = hashlib.sha256("\n".join([name, sources(), *map(stamp, TOOLS)]).encode()).hexdigest()
    made = made_file(IDENTITIES, key, "identity.json", lambda: json.dumps(_of(name)).encode())
    return cast(dict[str, Any], json.loads(made.read_bytes()))


@cache
def _shipped() -> dict[str, Any] | None:
    """The identities in the package, unless its sources have been changed since."""
    try:
        kept = json.loads((SHIPPED / "identities.json").read_bytes())
        return kept if kept["sources"] == sources() else None
    except (FileNotFoundError, KeyError, TypeError, ValueError):  # or a damaged one: FMUs are built anew
        return None


def _of(name: str) -> dict[str, Any]:
    component = components.COMPONENTS[name]
    found = dependencies(component).always
    needed = {output: " ".join(sorted(names)) for output, names in found.items()}
    return {"fmu": _computed(component), "needs": needed}


def _computed(component: type[Component]) -> Identity:
    from . import fmu_files, live_fmu
    from .native import native_fmu

    texts = sorted(fmu_files.files_near(component, fmu_files.TEXTS).items())
    suffix = hashlib.sha256(repr(texts).encode()).hexdigest()[:8]
    guid = live_fmu.guid(component)
    return {
        "guid": guid,
        "live": f"{guid}-{suffix}",
        "native": f"{native_fmu.identity(component)}-{suffix}",
    }
