"""The places of the files of traces: one that a new run replaces is kept while its trace is in use.

A second run of a scene writes to the name that the first one has. The first file then gets a hidden name
beside it, which lasts as long as the `Trace` objects that read it. That costs no copy, no memory and no open
file, however long the runs and however many the results; an open file would do on POSIX alone, and there for
a thousand results or so.

Such files, and those that runs have not finished, have the number of their process in their names: what a
killed one leaves is known by that.
"""

import contextlib
import hashlib
import os
import platform
import re
import secrets
import weakref
from functools import cache
from pathlib import Path

from ..files import put


class Place:
    """The present place of a trace's file; shared by all that read it."""

    def __init__(self, path: Path):
        self.path = path


_places: weakref.WeakValueDictionary[str, Place] = weakref.WeakValueDictionary()


def place_of(path: Path) -> Place:
    """The place of a trace under this name."""
    return _places.setdefault(os.path.realpath(path), Place(path.absolute()))


def replace(new: Path, path: Path) -> None:
    """Give a finished file the name that an older one may have. That one is kept while its trace is in use.

    Raises OSError.
    """
    place = _places.pop(os.path.realpath(path), None)
    if place is not None and path.exists():
        aside = path.with_name(f".{path.name}.{mark()}")
        try:
            os.link(path, aside)  # first a second name: at no time is there no file under the usual one
        except OSError:  # a file system without links
            path.rename(aside)
        place.path = aside
        weakref.finalize(place, _remove, aside, os.getpid())
    put(new, path)
    if (moved := _places.pop(os.path.realpath(new), None)) is not None:
        moved.path = path
        _places[os.path.realpath(path)] = moved


def mark() -> str:
    """A part of a file's name that no other file has and that tells which process it is of."""
    return f"{_machine()}-{os.getpid()}-{secrets.token_hex(4)}"


def abandoned(path: Path) -> list[Path]:
    """Return the files that killed processes have left beside a trace: hidden older ones and partial ones."""
    pattern = re.compile(rf"\.?{re.escape(path.name)}\.{_machine()}-(\d+)-[0-9a-f]{{8}}(\.partial)?")
    try:
        found = [(each, pattern.fullmatch(each.name)) for each in path.parent.iterdir()]
    except OSError:
        return []
    return sorted(each for each, match in found if match and not _runs(int(match[1])))


@cache
def _machine() -> str:
    """Eight digits for where a number means one process: a machine, on Linux its namespace of processes."""
    traits = [platform.node()]
    with contextlib.suppress(OSError):
        traits.append(Path("/etc/machine-id").read_text())
    with contextlib.suppress(OSError):
        traits.append(str(Path("/proc/self/ns/pid").readlink()))
    return hashlib.sha256("\n".join(traits).encode()).hexdigest()[:8]


def _runs(process: int) -> bool:
    """Return whether a process of this machine runs; always true on Windows, where asking would end it."""
    if os.name == "nt":
        return True
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:  # somebody else's
        return True
    return True


def _remove(path: Path, owner: int) -> None:
    """Delete a file that is no longer read; a forked process leaves it to the one that put it there."""
    if os.getpid() == owner:
        with contextlib.suppress(OSError):
            path.unlink()
