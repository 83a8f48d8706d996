"""Recorded runs: in HDF5, written block by block while a run goes on and read by any tool, or in memory."""

from typing import TYPE_CHECKING, Any

from .chunks import ROWS
from .opened import PARTIAL, TRACE
from .reader import Trace
from .signals import Channel, Column, Early, Recording, Signals
from .verdict import Verdict
from .writer import TraceWriter, partial_of

if TYPE_CHECKING:
    from .comparing import compare
    from .comparison import Comparison

__all__ = [
    "PARTIAL",
    "ROWS",
    "TRACE",
    "Channel",
    "Column",
    "Comparison",
    "Early",
    "Recording",
    "Signals",
    "Trace",
    "TraceWriter",
    "Verdict",
    "compare",
    "partial_of",
]

_COMPARED = {"compare": "comparing", "Comparison": "comparison"}  # public name -> its module


def __getattr__(name: str) -> Any:
    """Load what compares traces when it is first used: a run compares none."""
    if name not in _COMPARED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module

    return getattr(import_module(f".{_COMPARED[name]}", __name__), name)
