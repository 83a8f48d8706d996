"""Traces in HDF5, written block by block while a run goes on.

One group for each instance, one dataset for each variable, all along `/time`. The file bears its final
name only once it is complete; until then every block written can be read, even after a kill.
"""

import contextlib
import json
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from .. import units
from .chunks import LEVEL, ROWS, packed
from .disk import reserve, superblock, take
from .places import replace
from .signals import Channel, Floats, Integers

SOFTWARE = f"loomfmu {version('loomfmu')}"
SPARE = 65536  # bytes beyond what is reckoned with, for HDF5's own book-keeping
PER_ATTRIBUTE = 128  # bytes of a name and of what HDF5 says of an attribute
PER_DATASET = 4096  # bytes of book-keeping for a dataset, in its header or for a block


def partial_of(path: Path) -> Path:
    """What the file of a trace is called until it is complete."""
    return path.with_name(path.name + ".partial")


class TraceWriter:
    """Writes a trace. Complete it with `complete`, or leave what was written with `abandon`."""

    def __init__(
        self,
        path: Path,
        attributes: Mapping[str, Any],
        channels: Sequence[Channel],
        groups: Mapping[str, Mapping[str, Any]],
    ):
        self.path = path
        self.partial = partial_of(path)
        self.channels = channels
        self.rows = 0
        self.partial.parent.mkdir(parents=True, exist_ok=True)
        said = [str(value) for each in (attributes, *groups.values()) for value in each.values()]
        texts = sum(PER_ATTRIBUTE + len(text.encode()) for text in said)
        header = SPARE + texts + PER_DATASET * (len(channels) + 2)
        self._block = SPARE + (PER_DATASET + 8 * ROWS) * (len(channels) + 2)
        try:
            take(self.partial, "wb", header)
        except OSError:
            self.partial.unlink(missing_ok=True)
            raise
        # v110 is the oldest format that can be read while it is written and after a kill
        # no block is read again: by default HDF5 keeps 8 MB of each dataset in memory
        self._file = h5py.File(self.partial, "w", libver=("v110", "v110"), rdcc_nbytes=16 * ROWS)
        try:
            reserve(self._file.id.get_vfd_handle(), header)
            first = {"Conventions": "CF-1.11", "software": SOFTWARE}
            self._file.attrs.update({**first, **attributes, "status": "running"})
            self._time = self._dataset("/time", "f8", "s", "time", "Time since the start of the run")
            self._time.make_scale("time")
            self._angle = self._dataset(
                "/shaft_angle", "f8", "rad", "shaft angle", "Angle of the main shaft, not wrapped"
            )
            self._angle.dims[0].attach_scale(self._time)
            self._angle.attrs["DISPLAY_UNIT"] = "deg"
            datasets = [self._channel(channel) for channel in channels]
            self._reals, self._real_columns = self._chosen(datasets, real=True)
            self._integers, self._integer_columns = self._chosen(datasets, real=False)
            for instance, values in groups.items():
                self._file.require_group(instance).attrs.update(values)
            self._file.swmr_mode = True
        except BaseException:
            self._file.close()
            raise

    def _chosen(self, datasets: Sequence[Any], real: bool) -> tuple[list[Any], list[int]]:
        """The datasets of one kind of channels, and the columns that go into them."""
        pairs = [
            (each, of.column) for each, of in zip(datasets, self.channels, strict=True) if of.real == real
        ]
        return [dataset for dataset, _ in pairs], [column for _, column in pairs]

    def _dataset(self, name: str, kind: str, unit: str, long_name: str, comment: str) -> Any:
        dataset = self._file.create_dataset(
            name, (0,), kind, maxshape=(None,), chunks=(ROWS,), shuffle=True, compression="gzip",
            compression_opts=LEVEL,
        )  # fmt: skip
        dataset.attrs.update(
            {"UNIT": unit, "units": units.udunits(unit), "long_name": long_name, "COMMENT": comment}
        )
        return dataset

    def _channel(self, channel: Channel) -> Any:
        group = self._file.require_group(channel.instance)
        if "time" not in group:
            group["time"] = self._time  # hard links: without the time xarray loses the axis
            group["shaft_angle"] = self._angle
        dataset = self._dataset(
            f"/{channel.instance}/{channel.variable}",
            "f8" if channel.real else "i4",
            channel.unit,
            channel.variable.replace("_", " "),
            channel.description,
        )
        dataset.dims[0].attach_scale(self._time)
        # a coordinate by CF: as a second scale of HDF5, xarray would take it for the dimension
        dataset.attrs["coordinates"] = "shaft_angle"
        if channel.boolean:
            dataset.attrs["dtype"] = "bool"  # xarray reads it so; an enumeration would be texts in MATLAB
        if channel.display != channel.unit:
            dataset.attrs["DISPLAY_UNIT"] = channel.display
        if channel.rate:
            dataset.attrs["rate"] = channel.rate
        if channel.meanings:
            flags = range(channel.first_flag, channel.first_flag + len(channel.meanings))
            dataset.attrs["flag_values"] = np.array(flags, dtype="i4")
            dataset.attrs["flag_meanings"] = " ".join(channel.meanings)
        return dataset

    def append(self, time: Floats, angle: Floats, reals: Floats, integers: Integers) -> None:
        """Write a block: values along the rows, signals along the columns."""
        reserve(self._file.id.get_vfd_handle(), self._file.id.get_filesize() + self._block)
        start, self.rows = self.rows, self.rows + len(time)
        shared = np.stack([time, angle])
        self._extend([self._time, self._angle], shared, start)
        for datasets, columns, values in (
            (self._reals, self._real_columns, reals),
            (self._integers, self._integer_columns, integers),
        ):
            self._extend(datasets, np.ascontiguousarray(values.T[columns]), start)
        self._file.flush()

    def _extend(self, datasets: Sequence[Any], columns: NDArray[Any], start: int) -> None:
        """Add values, a row for each dataset, from a sample on."""
        end = start + columns.shape[1]
        if start % ROWS or end - start > ROWS:  # they begin or end within a chunk: HDF5 knows how
            for dataset, values in zip(datasets, columns, strict=True):
                dataset.resize((end,))
                dataset[start:] = values
            return
        for dataset, chunk in zip(datasets, packed(columns), strict=True):
            dataset.id.set_extent((end,))
            dataset.id.write_direct_chunk((start,), chunk)

    def seal(self, status: str, ended_by: str = "") -> None:
        """Close the file under its provisional name, marked with its status, and with who ended the run."""
        self._file.close()
        if ended_by:
            self._annotate("ended_by", ended_by)
        self._annotate("status", status)

    def complete(self, verdicts: Sequence[dict[str, Any]]) -> Path:
        """Give the sealed file its verdicts and its final name."""
        self._annotate("claims", json.dumps(verdicts))
        replace(self.partial, self.path)
        return self.path

    def _annotate(self, name: str, text: str) -> None:
        """Write an attribute of the closed file."""
        take(self.partial, "r+b", superblock(self.partial)[1] + len(text.encode()) + SPARE)
        with h5py.File(self.partial, "r+") as file:
            file.attrs[name] = text

    def abandon(self, status: str) -> Path:
        """Close what was written so far, marked incomplete; its path."""
        with contextlib.suppress(OSError):  # a full disk: what was flushed can still be read
            self.seal(status)
        return self.partial
