"""Datasets and attributes of HDF5 files, made by the hundred, and their chunks, packed here.

The files are as h5py and HDF5 themselves would write them, in a fraction of the time. What datasets share is
made once: `create_dataset` and `attrs` of h5py make it anew for each, which took a quarter of the time of a
short run.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any

import h5py
import numpy as np
from h5py import h5a, h5d, h5p, h5s, h5t
from numpy.typing import NDArray
from zlib_ng import zlib_ng

ROWS = 4096  # of a block and of a chunk: more pack better, but in a slow run a block must not take a second
LEVEL = 1  # of compression: higher ones take three times as long for 5 % less
UNFILTERED = 0b11  # mask of a chunk that neither shuffle nor gzip has changed
TEXT = h5py.string_dtype()
STORED_TEXT, TEXT_IN_MEMORY = h5t.py_create(TEXT, logical=True), h5t.py_create(TEXT)
SCALAR = h5s.create(h5s.SCALAR)
REALS, INTEGERS = h5t.IEEE_F64LE, h5t.STD_I32LE


def annotate(place: Any, values: Mapping[str, Any]) -> None:
    """Give something new in a file attributes that it does not have yet: numbers, texts or arrays.

    A Boolean is stored as 0 or 1: netCDF cannot read the enumeration that h5py makes of it. Each is closed
    here, not when Python gets to it: with one open, HDF5 lets no reader join.
    """
    for name, value in values.items():
        if isinstance(value, str):
            attribute = h5a.create(place.id, name.encode(), STORED_TEXT, SCALAR)
            attribute.write(np.array(value, dtype=TEXT), TEXT_IN_MEMORY)
            attribute.close()
        else:
            array = np.asarray(int(value) if isinstance(value, bool | np.bool_) else value)
            kind, space = h5t.py_create(array.dtype, logical=True), h5s.create_simple(array.shape)
            attribute = h5a.create(place.id, name.encode(), kind, space)
            attribute.write(array)
            attribute.close()


def dataset(group: Any, name: str, kind: Any, rows: int) -> Any:
    """A new dataset that grows to so many rows, in packed chunks. `kind` is REALS or INTEGERS."""
    layout = _layout(chunk_of(rows))
    return h5py.Dataset(h5d.create(group.id, name.encode(), kind, _empty(rows), dcpl=layout))


def chunk_of(rows: int) -> int:
    """Rows of a chunk of a dataset of so many."""
    return min(rows, ROWS)


@cache
def _empty(rows: int) -> Any:
    """The space of a dataset that has no sample yet and may get so many.

    Readers of netCDF ask datasets without a limit for their length again and again.
    """
    return h5s.create_simple((0,), (rows,))


@cache
def _layout(chunk: int) -> Any:
    layout = h5p.create(h5p.DATASET_CREATE)
    layout.set_chunk((chunk,))
    layout.set_shuffle()
    layout.set_deflate(LEVEL)
    layout.set_obj_track_times(False)
    return layout


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
