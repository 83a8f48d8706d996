"""Where the files of traces lie: one that a new run replaces is kept while its trace is in use.

A second run of a scene writes to the name that the first one has. The first file then gets a hidden name
beside it, which lasts as long as the `Trace` objects that read it. That costs no copy, no memory and no open
file, however long the runs and however many the results; an open file would do on POSIX alone, and there for
a thousand results or so.
"""

import contextlib
import os
import secrets
import weakref
from pathlib import Path

from ..files import put


class Place:
    """Where the file of a trace lies now; shared by all that read it."""

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
        aside = path.with_name(f".{path.name}.{secrets.token_hex(4)}")
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


def _remove(path: Path, owner: int) -> None:
    """Delete a file that is no longer read; a forked process leaves it to the one that put it there."""
    if os.getpid() == owner:
        with contextlib.suppress(OSError):
            path.unlink()
