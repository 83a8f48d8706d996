"""The kinds of files that traces consist of."""

from pathlib import Path

from ..files import Kind
from .opened import is_trace

SIGNATURE = b"\x89HDF\r\n\x1a\n"


def _is_partial(path: Path) -> bool:
    """Return whether a run may have left a file: if killed early, it has only reserved the space."""
    with path.open("rb") as file:
        return file.read(len(SIGNATURE)) in (SIGNATURE, bytes(len(SIGNATURE)))


TRACE = Kind("a trace of loomfmu", is_trace, (".h5", ".hdf5", ".hdf"))
PARTIAL = Kind("a partial trace of an interrupted run", _is_partial)
