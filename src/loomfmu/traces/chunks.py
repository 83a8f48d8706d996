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

ROWS = 4096  # of a block and of a chunk
LEVEL = 1  # of compression: higher ones take three times as long for 5 % less
UNFILTERED = 0b11  # mask of a chunk that neither shuffle nor gzip has changed
TEXT = h5py.string_dtype()
STORED_TEXT, TEXT_IN_MEMORY = h5t.py_create(TEXT, logical=True), h5t.py_create(TEXT)
SCALAR = h5s.create(h5s.SCALAR)
EMPTY = h5s.create_simple((0,), (h5s.UNLIMITED,))
REALS, INTEGERS = h5t.IEEE_F64LE, h5t.STD_I32LE


def annotate(place: Any, values: Mapping[str, Any]) -> None:
    """Give something new in a file attributes that it does not have yet: numbers, texts or arrays.

    Each is closed here, not when Python gets to it: with one open, HDF5 lets no reader join.
    """
    for name, value in values.items():
        if isinstance(value, str):
            attribute = h5a.create(place.id, name.encode(), STORED_TEXT, SCALAR)
            attribute.write(np.array(value, dtype=TEXT), TEXT_IN_MEMORY)
            attribute.close()
        else:
            array = np.asarray(value)
            kind, space = h5t.py_create(array.dtype, logical=True), h5s.create_simple(array.shape)
            attribute = h5a.create(place.id, name.encode(), kind, space)
            attribute.write(array)
            attribute.close()


def dataset(group: Any, name: str, kind: Any) -> Any:
    """A new dataset that grows: packed chunks of so many rows as a block has. `kind` is REALS or INTEGERS."""
    return h5py.Dataset(h5d.create(group.id, name.encode(), kind, EMPTY, dcpl=_layout()))


@cache
def _layout() -> Any:
    layout = h5p.create(h5p.DATASET_CREATE)
    layout.set_chunk((ROWS,))
    layout.set_shuffle()
    layout.set_deflate(LEVEL)
    layout.set_obj_track_times(False)
    return layout


def packed(columns: NDArray[Any]) -> Iterator[bytes]:
    """One chunk for each row of an array (signals, samples), as HDF5's filters shuffle and gzip make it.

    A chunk is always whole: fewer samples than it holds are followed by zeros.
    """
    signals, samples = columns.shape
    size = columns.dtype.itemsize
    planes = np.zeros((signals, size, ROWS), dtype=np.uint8)
    planes[:, :, :samples] = columns.view(np.uint8).reshape(signals, samples, size).transpose(0, 2, 1)
    for plane in planes:
        yield zlib_ng.compress(plane, LEVEL)


def unpacked(columns: NDArray[Any]) -> Iterator[bytes]:
    """The same chunks before the filters: all of one length, so that they can be rewritten in place."""
    signals, samples = columns.shape
    whole = np.zeros((signals, ROWS), dtype=columns.dtype)
    whole[:, :samples] = columns
    for row in whole:
        yield row.tobytes()


class Columns:
    """Datasets of one type that get their samples together, and the samples of the chunk that is not full.

    A chunk that comes in one piece is packed. One that comes in several, as in a slow run, is written again
    with each piece and stays unpacked: packed, it would need a new place each time, and the file would grow
    to many times its size.
    """

    def __init__(self, datasets: Sequence[Any], kind: str):
        self._datasets = datasets
        self._pending = np.zeros((len(datasets), 0), dtype=kind)
        self._start = 0  # of the chunk that is not full

    def append(self, values: NDArray[Any]) -> None:
        """Add samples, a row for each dataset."""
        while values.shape[1]:
            fit = ROWS - self._pending.shape[1]
            begun = self._pending.shape[1] > 0
            chunk = values[:, :fit]
            if begun:
                chunk = np.concatenate([self._pending, chunk], axis=1)
            self._write(chunk, unpacked(chunk) if begun else packed(chunk), UNFILTERED if begun else 0)
            values = values[:, fit:]
            full = chunk.shape[1] == ROWS
            self._pending = chunk[:, :0] if full else chunk
            self._start += ROWS if full else 0

    def flush(self) -> None:
        """Write what HDF5 keeps of each dataset: all in one go takes time with the square of their number."""
        for dataset in self._datasets:
            dataset.id.flush()

    def _write(self, chunk: NDArray[Any], contents: Iterator[bytes], mask: int) -> None:
        for dataset, content in zip(self._datasets, contents, strict=True):
            dataset.id.set_extent((self._start + chunk.shape[1],))
            dataset.id.write_direct_chunk((self._start,), content, mask)
