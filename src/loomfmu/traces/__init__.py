"""Recorded runs: in HDF5, written block by block while a run goes on and read by any tool, or in memory."""

from .reader import Trace
from .signals import Channel, Recording, Signals
from .writer import ROWS, TraceWriter

__all__ = ["ROWS", "Channel", "Recording", "Signals", "Trace", "TraceWriter"]
