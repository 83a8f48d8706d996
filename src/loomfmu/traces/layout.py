"""The contents of a trace's file: the attributes of a signal, and all that is allowed.

Anything else might read other files, or fill the memory.
"""

from typing import Any

import h5py
import numpy as np

from .. import units
from ..declaring.variables import Beside
from .signals import Channel

FILTERS = {h5py.h5z.FILTER_DEFLATE, h5py.h5z.FILTER_SHUFFLE, h5py.h5z.FILTER_FLETCHER32}
BESIDE = {"valid_if": "ancillary_variables"}  # roles of `Beside` that have another name in CF
EXPANSION = 1100  # bytes that a stored byte may become: gzip makes up to 1032 of it
EXPANSION_OF_TIME = 150  # bytes of 8 a row: what grows from row to row is packed to 1/105 at best


class Foreign(Exception):
    """Something that no trace has; the text says what and where."""


def has(group: Any, name: str) -> bool:
    """Return whether a group has a member of that name, even one that leads to another file."""
    return bool(group.id.links.exists(name.encode()))


def member(group: Any, name: str) -> Any:
    """Return the member of a group by its name. Raises Foreign for a link: it may lead to another file."""
    check_link(group, name)
    return group[name]


def check_link(group: Any, name: str) -> None:
    """Raise Foreign unless the group itself has what is under a name, or has nothing there."""
    if has(group, name) and group.id.links.get_info(name.encode()).type != h5py.h5l.TYPE_HARD:
        raise Foreign(f"{group.name.rstrip('/')}/{name} is a link")


def attributes(item: Any) -> dict[str, Any]:
    """The attributes of a group or a dataset. Raises ValueError for text that is not in UTF-8."""
    return {name: legible(name, value) for name, value in item.attrs.items()}


def legible(name: str, value: Any) -> Any:
    """The value of an attribute, numbers as Python's own. Raises ValueError for text not in UTF-8."""
    try:
        f"{name}{value if isinstance(value, str) else ''}".encode()
    except UnicodeEncodeError:  # h5py gives what it cannot decode as surrogates
        raise ValueError(f"its attribute {name!a} is not text in UTF-8") from None
    return value.item() if isinstance(value, np.generic) else value


def about(unit: str, comment: str) -> dict[str, str]:
    """The attributes that every dataset has.

    There is no `long_name`: silx and h5web would label an axis with it instead of the name and the unit.
    """
    return {"UNIT": unit, "units": units.udunits(unit), "COMMENT": comment}


def about_channel(channel: Channel) -> dict[str, Any]:
    """The attributes of a channel's dataset, of which `channel_of` reads what matters."""
    said: dict[str, Any] = about(channel.unit, channel.description)
    # a coordinate by CF: as a second scale of HDF5, xarray would take it for the dimension
    said["coordinates"] = "shaft_angle"
    if channel.boolean:
        said["dtype"] = "bool"  # xarray reads it so; an enumeration would be texts in MATLAB
    if channel.display != channel.unit:
        said["DISPLAY_UNIT"] = channel.display
    if channel.rate:
        said["rate"] = channel.rate
    for role, variable in channel.beside._asdict().items():
        if variable:
            said[BESIDE.get(role, role)] = variable
    if channel.meanings:
        flags = range(channel.first_flag, channel.first_flag + len(channel.meanings))
        said["flag_values"] = np.array(flags, dtype="i4")
        said["flag_meanings"] = " ".join(channel.meanings)
    return said


def channel_of(signal: str, item: Any) -> Channel:
    """Read the channel that a dataset says it is. Raises ValueError for text that is not in UTF-8."""

    def text(name: str) -> str | None:
        found = legible(name, item.attrs.get(name))
        return None if found is None else str(found)

    instance, _, variable = signal.rpartition(".")
    unit = str(text("UNIT"))
    others = Beside(*(text(BESIDE.get(role, role)) for role in Beside._fields))
    return Channel(
        instance,
        variable,
        unit,
        text("DISPLAY_UNIT") or unit,
        str(text("COMMENT")),
        real=item.dtype.kind == "f",
        rate=text("rate"),
        beside=others,
    )


def column(item: Any) -> Any:
    """A dataset of a trace: a column of numbers, stored in this file. Raises Foreign for anything else."""
    if not isinstance(item, h5py.Dataset) or item.shape is None or len(item.shape) != 1:
        raise Foreign(f"{item.name} is not a column")
    if item.dtype.kind not in "iufb":
        raise Foreign(f"{item.name} does not hold numbers")
    created = item.id.get_create_plist()
    if item.is_virtual or item.external:
        raise Foreign(f"{item.name} lies in another file")
    filters = {created.get_filter(number)[0] for number in range(created.get_nfilters())}
    if not filters <= FILTERS:
        raise Foreign(f"{item.name} uses an HDF5 filter that traces never use")
    stored = min(item.id.get_storage_size(), item.file.id.get_filesize())
    chunk = item.chunks[0] * item.dtype.itemsize if item.chunks and item.size else 0
    rows_of_time = 8 * item.size if item.name == "/time" else 0
    if max(item.nbytes, chunk) > EXPANSION * stored or rows_of_time > EXPANSION_OF_TIME * stored:
        raise Foreign(f"{item.name} has {item.size} rows but stores almost none of them")
    return item
