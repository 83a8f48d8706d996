"""Recorded runs: in HDF5, written block by block while a run goes on and read by any tool, or in memory."""

from .chunks import ROWS
from .comparing import compare
from .comparison import Comparison
from .kinds import PARTIAL, TRACE
from .reader import Trace
from .signals import Channel, Recording, Signals
from .verdict import Verdict
from .writer import TraceWriter, partial_of

__all__ = [
    "PARTIAL",
    "ROWS",
    "TRACE",
    "Channel",
    "Comparison",
    "Recording",
    "Signals",
    "Trace",
    "TraceWriter",
    "Verdict",
    "compare",
    "partial_of",
]
