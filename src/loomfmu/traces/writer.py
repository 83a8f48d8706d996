"""Traces in HDF5, written block by block while a run goes on.

One group for each instance, one dataset for each variable, all along `/time`. The file has its final name
only once it is complete. Until then it has a name of its own, so that runs with one output do not meet, and
every block written can be read, even after a kill.
"""

import contextlib
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..files import make_folder, put
from ..version import __version__
from . import arrays
from .chunks import INTEGERS, REALS, ROWS, Columns, annotate, chunk_of, dataset
from .disk import PER_DATASET, SPARE, block_size, edited, reserve
from .layout import about, about_channel
from .places import abandoned, mark, replace
from .reader import Trace
from .signals import Channel, Early, Floats, Integers

SOFTWARE = f"loomfmu {__version__}"
PER_ATTRIBUTE = 128  # bytes of a name and of what HDF5 says of an attribute
WHOLE = Early()  # a run that went to its end


def partial_of(path: Path, mark: str = "") -> Path:
    """The name of a trace that is not complete: with a mark while it is written, without one afterwards."""
    return path.with_name(f"{path.name}{mark and '.'}{mark}.partial")


class TraceWriter:
    """Writes a trace of at most so many rows. Complete it with `complete`, or leave it with `abandon`."""

    def __init__(
        self,
        path: Path,
        attributes: Mapping[str, Any],
        channels: Sequence[Channel],
        groups: Mapping[str, Mapping[str, Any]],
        rows: int = h5py.h5s.UNLIMITED,
    ):
        self.path = path
        self.partial = partial_of(path, mark())
        self.channels = channels
        self.rows = 0
        make_folder(self.partial.parent)
        texts = [str(value) for each in (attributes, *groups.values()) for value in each.values()]
        stored = sum(PER_ATTRIBUTE + len(text.encode()) for text in texts)
        header = SPARE + stored + PER_DATASET * (len(channels) + 2)
        self._block = block_size(rows, len(channels))
        try:
            with self.partial.open("xb") as file:
                reserve(file.fileno(), header)
        except OSError:
            self.partial.unlink(missing_ok=True)
            raise
        # v110 is the oldest format that can be read while it is written and after a kill
        # no block is read again: by default HDF5 keeps 8 MB of each dataset in memory
        self._file = h5py.File(self.partial, "w", libver=("v110", "v110"), rdcc_nbytes=16 * ROWS)
        try:
            self._keep_metadata()
            reserve(self._file.id.get_vfd_handle(), header)
            shared, datasets = self._create(attributes, groups, rows)
            self._shared = Columns(shared, "f8", chunk_of(rows))
            self._reals, self._real_columns = self._chosen(datasets, "f8", rows)
            self._integers, self._integer_columns = self._chosen(datasets, "i4", rows)
            self._file.swmr_mode = True
        except BaseException:
            self._file.close()
            self.partial.unlink(missing_ok=True)
            raise
        self._begun = self.partial.stat().st_mtime_ns

    def _keep_metadata(self) -> None:
        """Keep all metadata in memory, a kilobyte for each signal, until the file is closed.

        By default HDF5 evicts what exceeds a few megabytes. With readers allowed, as here, it then mixes up
        which entry depends on which: from about 2500 signals on, writing fails or corrupts the heap.
        """
        config = self._file.id.get_mdc_config()
        config.evictions_enabled = False
        config.incr_mode = config.flash_incr_mode = config.decr_mode = 0  # which that requires
        self._file.id.set_mdc_config(config)

    def _create(
        self, attributes: Mapping[str, Any], groups: Mapping[str, Mapping[str, Any]], rows: int
    ) -> tuple[list[Any], list[Any]]:
        """Everything in the file but samples; the datasets of angle and time, and those of the channels.

        They stay open: opened again while readers may join, HDF5 loses its place among thousands.
        """
        file = self._file
        first = {"Conventions": "CF-1.11", "software": SOFTWARE}
        if "command" in attributes:  # no date, by which equal runs would differ
            first["history"] = f"{SOFTWARE}: {attributes['command']}"
        shown = {"NX_class": "NXroot", "default": self.channels[0].instance} if self.channels else {}
        annotate(file, {**first, **shown, **attributes, "status": "running"})
        time = dataset(file, "time", REALS, rows)
        annotate(time, {**about("s", "Time since the start of the run"), "standard_name": "time"})
        time.make_scale("time")
        angle = dataset(file, "shaft_angle", REALS, rows)
        turned = about("rad", "Angle of the main shaft, not wrapped")
        annotate(angle, {**turned, "long_name": "shaft angle", "DISPLAY_UNIT": "deg"})
        angle.dims[0].attach_scale(time)
        found: dict[str, Any] = {}
        datasets = []
        driven = {(each.instance, each.variable) for each in self.channels}  # inputs have names of links
        for channel in self.channels:
            if channel.instance not in found:
                group = found[channel.instance] = file.create_group(channel.instance)
                group["time"] = time  # a link, which xarray needs there; of the angle, too
                if (channel.instance, "shaft_angle") not in driven:
                    group["shaft_angle"] = angle
                # NeXus: h5web opens the group on a plot of its first variable
                plot = {"NX_class": "NXdata", "signal": channel.variable, "axes": "time"}
                annotate(group, {**plot, **groups.get(channel.instance, {})})
            made = dataset(
                found[channel.instance], channel.variable, REALS if channel.real else INTEGERS, rows
            )
            annotate(made, about_channel(channel))
            made.dims[0].attach_scale(time)
            datasets.append(made)
        for instance in groups.keys() - found.keys():
            annotate(file.create_group(instance), groups[instance])
        return [angle, time], datasets

    def _chosen(self, datasets: Sequence[Any], kind: str, rows: int) -> tuple[Columns, list[int]]:
        """The datasets of one kind of channels, and the columns that go into them."""
        chosen = [
            (dataset, channel.column)
            for dataset, channel in zip(datasets, self.channels, strict=True)
            if channel.real == (kind == "f8")
        ]
        columns = Columns([dataset for dataset, _ in chosen], kind, chunk_of(rows))
        return columns, [column for _, column in chosen]

    def append(self, time: Floats, angle: Floats, reals: Floats, integers: Integers) -> None:
        """Write a block: values along the rows, signals along the columns."""
        reserve(self._file.id.get_vfd_handle(), self._file.id.get_filesize() + self._block)
        self.rows += len(time)
        self._shared.append(np.stack([angle, time]))
        self._reals.append(np.ascontiguousarray(reals.T[self._real_columns]))
        self._integers.append(np.ascontiguousarray(integers.T[self._integer_columns]))
        for columns in (self._reals, self._integers, self._shared):  # time last: where it is the longer one,
            columns.flush()  # h5netcdf follows the samples of a signal by zeros, and netCDF4 gives up
        self._file.flush()

    def seal(self) -> None:
        """Close the file under its provisional name: any reader can open it now."""
        self._file.close()

    def complete(self, verdicts: Sequence[dict[str, Any]], early: Early = WHOLE) -> Trace:
        """Give the file its verdicts, how an FMU ended the run `early`, and its final name; the trace.

        Another run may give its own file that name at any time: each is whole, and the last one stays.
        """
        self.seal()
        ended = {name: text for name, text in early._asdict().items() if text}
        self._annotate(
            {"claims": json.dumps(verdicts), **ended, "status": "complete"}, self._claimed(verdicts)
        )
        trace = Trace(self.partial)
        replace(self.partial, self.path)
        trace.given, trace.name = self.path, self.path.name
        kept = partial_of(self.path)  # what an earlier run left when it failed
        with contextlib.suppress(OSError):
            if kept.stat().st_mtime_ns < self._begun:
                kept.unlink()
        for left in abandoned(self.path):
            with contextlib.suppress(OSError):
                left.unlink()
        return trace

    def _claimed(self, verdicts: Sequence[dict[str, Any]]) -> str:
        """The recorded signal that a claim is on, the first of them; empty if there is none.

        For an extreme so far, a staircase, it is the signal whose extreme that is.
        """
        recorded = {f"{channel.instance}.{channel.variable}": channel.variable for channel in self.channels}
        for channel in self.channels:
            for extreme in {channel.beside.lowest, channel.beside.highest} - {channel.variable}:
                if f"{channel.instance}.{extreme}" in recorded:
                    recorded[f"{channel.instance}.{extreme}"] = channel.variable
        claimed = next((verdict["signal"] for verdict in verdicts if verdict["signal"] in recorded), "")
        return claimed and f"{claimed.partition('.')[0]}.{recorded[claimed]}"

    def _annotate(self, attributes: Mapping[str, str], plotted: str = "") -> None:
        """Write attributes of the closed file, and which signal viewers show first."""
        with edited(self.partial) as file:
            file.attrs.update(attributes)
            arrays.write(file, self.channels)
            if plotted:
                instance, _, variable = plotted.partition(".")
                file.attrs["default"], file[instance].attrs["signal"] = instance, variable

    def abandon(self, status: str) -> Path:
        """Close what was written so far, marked with its status, and keep it; its path.

        It takes the place of what an earlier run left.
        """
        with contextlib.suppress(OSError):  # a full disk: what was flushed can still be read
            self.seal()
            self._annotate({"status": status})
            put(self.partial, partial_of(self.path))
            self.partial = partial_of(self.path)
        return self.partial
