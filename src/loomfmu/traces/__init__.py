"""Recorded runs: in HDF5, written block by block while a run goes on and read by any tool, or in memory."""

from .chunks import ROWS
from .reader import Trace
from .signals import Channel, Recording, Signals
from .writer import TraceWriter

__all__ = ["ROWS", "Channel", "Recording", "Signals", "Trace", "TraceWriter"]
