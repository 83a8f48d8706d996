"""New datasets and attributes of HDF5 files, made by the hundred.

What they share is made once. `create_dataset` and `attrs` of h5py make it anew for each, which took a quarter
of the time of a short run.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import h5py
import numpy as np
from h5py import h5a, h5d, h5p, h5s, h5t

from .chunks import LEVEL, ROWS

TEXT = h5py.string_dtype()
STORED_TEXT, TEXT_IN_MEMORY = h5t.py_create(TEXT, logical=True), h5t.py_create(TEXT)
SCALAR = h5s.create(h5s.SCALAR)
REALS, INTEGERS = h5t.IEEE_F64LE, h5t.STD_I32LE


def annotate(place: Any, values: Mapping[str, Any]) -> None:
    """Give something new in a file attributes that it does not have yet: numbers, texts or arrays.

    A Boolean is stored as 0 or 1: as the enumeration that h5py makes of it, netCDF cannot read it.

    Each is closed here, not when Python gets to it: with one open, HDF5 lets no reader join.
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
    """The space of a dataset without samples that may get so many: without a limit, readers of netCDF ask
    every dataset for its length again and again."""
    return h5s.create_simple((0,), (rows,))


@cache
def _layout(chunk: int) -> Any:
    layout = h5p.create(h5p.DATASET_CREATE)
    layout.set_chunk((chunk,))
    layout.set_shuffle()
    layout.set_deflate(LEVEL)
    layout.set_obj_track_times(False)
    return layout
