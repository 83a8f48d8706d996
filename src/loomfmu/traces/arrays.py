"""Arrays in a trace: beside the signals of its elements each is one dataset along time and its own axes.

That dataset is a virtual one of HDF5: it shows the elements' datasets and holds no samples of its own. Other
programs read it as any dataset; here the elements are read, so that no file can lead to another one.
"""

from collections.abc import Iterable, Sequence
from math import prod
from typing import Any

import h5py
import numpy as np
from h5py import h5d, h5p, h5s

from .chunks import annotate
from .layout import about, has
from .signals import Channel

LISTED = "_arrays"  # attribute of a group, which no parameter is called: names of members that are no signals
ELEMENTS = "elements"  # attribute of an array: the names of its elements, row by row
HERE = b"."  # the file that a virtual dataset is in


def write(file: Any, channels: Iterable[Channel]) -> None:
    """Write the arrays of which a trace that is complete has all elements."""
    found: dict[tuple[str, str], dict[tuple[int, ...], Channel]] = {}
    for channel in channels:
        if channel.array:
            found.setdefault((channel.instance, channel.array), {})[channel.place] = channel
    listed: dict[str, list[str]] = {}
    for (instance, array), elements in found.items():
        shape = tuple(np.max(list(elements), axis=0).tolist())
        axes = [f"{array}_axis_{number}" for number in range(1, len(shape) + 1)]
        group = file[instance]
        if len(elements) == prod(shape) and not any(has(group, name) for name in (array, *axes)):
            _write(file, group, array, axes, shape, elements)
            listed.setdefault(instance, []).extend((array, *axes))
    for instance, names in listed.items():
        annotate(file[instance], {LISTED: " ".join(names)})


def _write(
    file: Any,
    group: Any,
    array: str,
    axes: Sequence[str],
    shape: tuple[int, ...],
    elements: dict[tuple[int, ...], Channel],
) -> None:
    rows, channels = len(file["time"]), [elements[place] for place in sorted(elements)]
    samples, whole = h5s.create_simple((rows,)), h5s.create_simple((rows, *shape))
    layout = h5p.create(h5p.DATASET_CREATE)
    layout.set_obj_track_times(False)  # equal runs have equal files
    for channel in channels:
        first = (0, *(each - 1 for each in channel.place))
        whole.select_hyperslab(first, (1,) * len(first), block=(rows, *(1 for _ in shape)))
        layout.set_virtual(whole, HERE, f"{group.name}/{channel.variable}".encode(), samples)
    whole.select_all()
    kind = group[channels[0].variable].id.get_type()
    made = h5py.Dataset(h5d.create(group.id, array.encode(), kind, whole, dcpl=layout))
    names = " ".join(channel.variable for channel in channels)
    annotate(made, {**about(channels[0].unit, f"All elements of {array}"), ELEMENTS: names})
    made.dims[0].attach_scale(file["time"])
    for number, (name, length) in enumerate(zip(axes, shape, strict=True), start=1):
        axis = group.create_dataset(name, data=np.arange(1, length + 1, dtype="i4"))
        axis.make_scale(name)
        made.dims[number].attach_scale(axis)


def listed(group: Any) -> list[str]:
    """The members of a group that are no signals."""
    return str(group.attrs.get(LISTED, "")).split()


def elements(array: Any) -> tuple[list[str], tuple[int, ...]]:
    """The names of an array's elements, row by row, and its shape."""
    return str(array.attrs[ELEMENTS]).split(), array.shape[1:]
