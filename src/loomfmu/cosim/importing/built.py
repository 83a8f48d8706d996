"""The files of our own components: built once, kept in the cache, and told from those of other makers."""

import zipfile
from functools import partial
from pathlib import Path
from typing import Literal, get_args

import fmpy

from ...cache.entries import FMUS, has_file, made_file
from ...components import COMPONENTS
from ...declaring.variables import Component
from ...errors import LoomfmuError, shown, suggestion
from ...fmi import identities
from ...fmi.native import platforms

Flavour = Literal["live", "native"]
FLAVOURS: tuple[str, ...] = get_args(Flavour)
LIVE = "resources/slavemodule.txt"  # pythonfmu's: a live FMU has it
Place = tuple[str, str, str]  # of a file in the cache: the kind of its entry, its key, its name


def check_flavour(flavour: str) -> None:
    """Refuse an unknown flavour."""
    if flavour not in FLAVOURS:
        raise LoomfmuError(f"there is no flavour {shown(flavour)}{suggestion(str(flavour), FLAVOURS)}")


def file_of(component: type[Component], flavour: str, chosen: tuple[str, ...], fmi: int = 2) -> Path:
    """The file of a component, built unless the same one was; a live one is for all platforms."""
    check_flavour(flavour)
    return made_file(
        *_place(component, flavour, chosen, fmi), partial(_archive, component, flavour, chosen, fmi)
    )


def file_here(component: type[Component], flavour: str, fmi: int = 2) -> Path:
    """The file of a component to run on this machine: the package brings it, or it is built."""
    return _brought(component, flavour, fmi) or file_of(component, flavour, (platforms.host(),), fmi)


def is_here(component: type[Component], flavour: str) -> bool:
    """Return whether `file_here` has nothing to build."""
    return bool(_brought(component, flavour, 2)) or has_file(
        *_place(component, flavour, (platforms.host(),), 2)
    )


def is_our_build(path: Path, name: str, fmi: int) -> bool:
    """Return whether an FMU of a component's name equals, in all files that a run uses, the one that we
    build.

    What a file says of its maker is no proof: another version, or someone else, may have written that.
    """
    if name not in COMPONENTS:
        return False
    given = run_files(path)
    flavour = "live" if LIVE in given else "native"
    try:
        return given == run_files(file_here(COMPONENTS[name], flavour, fmi))
    except LoomfmuError:  # no compiler
        return False


def run_files(path: Path) -> dict[str, bytes]:
    """The files of an FMU that count in a run, by their names in it."""
    with zipfile.ZipFile(path) as archive:
        return {
            name: archive.read(name)
            for name in archive.namelist()
            if counts_in_run(name) and not name.endswith("/")
        }


def counts_in_run(member: str) -> bool:
    """Return whether a run uses a file of an FMU: not documents, sources and other platforms' libraries."""
    top, _, rest = member.partition("/")
    if top == "binaries":
        return rest.partition("/")[0] in ("", fmpy.platform, fmpy.platform_tuple)
    return top not in ("documentation", "sources")


def _brought(component: type[Component], flavour: str, fmi: int) -> Path | None:
    return identities.shipped(component, fmi) if flavour == "native" else None


def _place(component: type[Component], flavour: str, chosen: tuple[str, ...], fmi: int) -> Place:
    parts = [identities.identity(component)[flavour]]
    if flavour == "native":
        parts += [*chosen, *(["fmi3"] if fmi == 3 else [])]
    return FMUS, "-".join(parts), f"{component.__name__}.fmu"


def _archive(component: type[Component], flavour: str, chosen: tuple[str, ...], fmi: int) -> bytes:
    from ...fmi import live_fmu
    from ...fmi.native import native_fmu

    if flavour == "live":
        return live_fmu.archive(component)
    return native_fmu.archive(component, chosen, fmi)
