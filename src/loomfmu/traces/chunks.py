"""Chunks of HDF5 datasets, packed here: what HDF5 itself would write, in a fraction of the time."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from zlib_ng import zlib_ng

ROWS = 16384  # of a block and of a chunk: with 4096, long traces take half as much space again
LEVEL = 1  # of compression: higher ones take three times as long for 5 % less
UNFILTERED = 0b11  # mask of a chunk that neither shuffle nor gzip has changed


def packed(columns: NDArray[Any], rows: int) -> Iterator[bytes]:
    """One chunk for each row of an array (signals, samples), as HDF5's filters shuffle and gzip make it.

    A chunk always has so many `rows`: fewer samples are followed by zeros.
    """
    signals, samples = columns.shape
    size = columns.dtype.itemsize
    planes = np.zeros((signals, size, rows), dtype=np.uint8)
    planes[:, :, :samples] = columns.view(np.uint8).reshape(signals, samples, size).transpose(0, 2, 1)
    for plane in planes:
        yield zlib_ng.compress(plane, LEVEL)


def unpacked(columns: NDArray[Any], rows: int) -> Iterator[bytes]:
    """The same chunks before the filters: all of one length, so that they can be rewritten in place."""
    signals, samples = columns.shape
    whole = np.zeros((signals, rows), dtype=columns.dtype)
    whole[:, :samples] = columns
    for row in whole:
        yield row.tobytes()


class Columns:
    """Datasets of one type that get their samples together, and the samples of the chunk that is not full.

    A chunk that comes in one piece is packed. One that comes in several, as in a slow run, is written again
    with each piece and stays unpacked: packed, it would need a new place each time, and the file would grow
    to many times its size.
    """

    def __init__(self, datasets: Sequence[Any], kind: str, rows: int):
        self._datasets, self._rows = datasets, rows  # of a chunk
        self._pending = np.zeros((len(datasets), 0), dtype=kind)
        self._start = 0  # of the chunk that is not full

    def append(self, values: NDArray[Any]) -> None:
        """Add samples, a row for each dataset."""
        while values.shape[1]:
            fit = self._rows - self._pending.shape[1]
            begun = self._pending.shape[1] > 0
            chunk = values[:, :fit]
            if begun:
                chunk = np.concatenate([self._pending, chunk], axis=1)
            self._write(chunk, (unpacked if begun else packed)(chunk, self._rows), UNFILTERED if begun else 0)
            values = values[:, fit:]
            full = chunk.shape[1] == self._rows
            self._pending = chunk[:, :0] if full else chunk
            self._start += self._rows if full else 0

    def flush(self) -> None:
        """Write what HDF5 keeps of each dataset: all in one go takes time with the square of their number."""
        for dataset in self._datasets:
            dataset.id.flush()

    def _write(self, chunk: NDArray[Any], contents: Iterator[bytes], mask: int) -> None:
        for dataset, content in zip(self._datasets, contents, strict=True):
            dataset.id.set_extent((self._start + chunk.shape[1],))
            dataset.id.write_direct_chunk((self._start,), content, mask)
