"""The file of a trace: the kinds of such files, and one of them opened for as long as it is read."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import RLock
from typing import Any

import h5py

from ..declaring.variables import SHARED
from ..errors import LoomfmuError
from ..files import Kind, source
from .disk import superblock
from .layout import Foreign, has
from .places import place_of

REQUIRED = ("title", "status", "software")  # attributes that every trace has
SIGNATURE = b"\x89HDF\r\n\x1a\n"


class TraceFile:
    """The file of a trace, wherever a newer one under its name has moved it to.

    Messages call it what it was `given` as. Raises LoomfmuError for what is not a trace, is damaged or was
    replaced by another program: at once, or for a copy from another process, which has the `state` that the
    file had there, when it is first read.
    """

    def __init__(self, path: Path, state: tuple[int, ...] = ()):
        self._place = place_of(path)
        self.given = path
        self._file: Any = None
        self._turn = RLock()  # threads may share a trace
        self._state = state
        if state:
            return
        with self.opened() as file:
            if lacking := _lacking(file):
                raise LoomfmuError(f"{self.given}: not a trace of loomfmu ({lacking} is missing)")
            if file.attrs["status"] != "running":  # else it grows
                self._state = _state(self.path)

    def __reduce__(self) -> tuple[type["TraceFile"], tuple[Any, ...]]:
        return TraceFile, (self.path, self._state)  # not opened before it is read, unless it grows

    @property
    def path(self) -> Path:
        """The present path of the file."""
        return self._place.path

    def _open(self) -> Any:
        try:
            if self._state and _state(self.path) != self._state:
                raise LoomfmuError(f"{self.given}: another trace has replaced it since it was opened")
            return _hdf5(self.path)
        except FileNotFoundError:
            raise LoomfmuError(f"{self.given}: there is no such file") from None
        except (OSError, RuntimeError) as error:
            reason = getattr(error, "strerror", None) or _damage(self.path) or error
            raise LoomfmuError(f"{self.given}: cannot be read as a trace ({reason})") from None

    @contextmanager
    def opened(self) -> Iterator[Any]:
        """The file, opened unless it is. What h5py raises where it meets nonsense names the file."""
        with self._turn:
            kept = self._file is not None
            self.keep_open()
            try:
                yield self._file
            except Foreign as error:
                raise LoomfmuError(f"{self.given}: not a trace of loomfmu ({error})") from None
            except (KeyError, OSError, RuntimeError, TypeError, ValueError) as error:
                raise LoomfmuError(f"{self.given}: the file is damaged ({error.args[0]})") from None
            finally:
                if not kept:
                    self.close()

    def keep_open(self) -> None:
        """Open the file, unless it is, until it is closed."""
        self._file = self._file or self._open()

    def close(self) -> None:
        """Close the file, if it is open."""
        if self._file is not None:
            self._file.close()
            self._file = None


def is_trace(path: Path) -> bool:
    """Return whether a file is a trace by the names in it; values, which damage can make endless, are not
    read.
    """
    try:
        with _hdf5(path) as file:
            return not _lacking(file)
    except (KeyError, LoomfmuError, OSError, RuntimeError):
        return False


def _is_partial(path: Path) -> bool:
    """Return whether a run may have left a file: if killed early, it has only reserved the space."""
    with path.open("rb") as file:
        return file.read(len(SIGNATURE)) in (SIGNATURE, bytes(len(SIGNATURE)))


TRACE = Kind("a trace of loomfmu", is_trace, (".h5", ".hdf5", ".hdf"))
PARTIAL = Kind("a partial trace of an interrupted run", _is_partial)


def _hdf5(path: Path) -> Any:
    source(path)
    try:
        return h5py.File(path, "r")
    except OSError:
        begun, marked, length = superblock(path)
        if begun and not marked:
            raise LoomfmuError(f"{path}: the run ended before it wrote a sample") from None
        if not marked or path.stat().st_size < length:
            raise  # HDF5 would look for the rest of a file that was cut off again and again
    return h5py.File(path, "r", swmr=True)


def _damage(path: Path) -> str:
    """Return why HDF5 cannot open a file, or an empty text if that is not known."""
    try:
        size, length = path.stat().st_size, superblock(path)[2]
        if not h5py.is_hdf5(path):
            return "it is not an HDF5 file; loomfmu run writes one" if size else "it is empty"
    except (OSError, RuntimeError):
        return ""
    return f"it is cut off: {size} of its {length} bytes are left" if size < length else ""


def _lacking(file: Any) -> str:
    """Return a required part that a file lacks, or an empty text for a trace."""
    datasets = (f"the dataset /{name}" for name in SHARED if not has(file, name))
    attributes = (f"the attribute {name!r}" for name in REQUIRED if name not in file.attrs)
    return next(iter((*datasets, *attributes)), "")


def _state(path: Path) -> tuple[int, ...]:
    """Return numbers that change with a file and are the same on every machine that shares it."""
    found = path.stat()
    return found.st_ino, found.st_size, found.st_mtime_ns
