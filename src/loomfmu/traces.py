"""Traces in HDF5: written block by block while a run goes on, read by any tool that reads HDF5.

One group for each instance, one dataset for each variable, all along `/time`. The file bears its final
name only once it is complete; until then every block written can be read, even after a kill.
"""

import contextlib
import errno
import json
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from . import units
from .errors import LoomfmuError, suggestion

ROWS = 1024  # of a block and of a chunk
SPARE = 65536  # bytes beyond what is reckoned with, for HDF5's own book-keeping
PER_DATASET = 4096  # bytes of book-keeping for a dataset, in its header or for a block
Floats = NDArray[np.float64]


def _reserve(file: int, size: int) -> None:
    """Take disk space for a file before HDF5 writes it: HDF5 does not survive a write that fails.

    Raises OSError where there is no space; where a system cannot tell, nothing is reserved.
    """
    if hasattr(os, "posix_fallocate"):
        try:
            os.posix_fallocate(file, 0, size)
        except OSError as error:
            if error.errno not in (errno.EOPNOTSUPP, errno.EINVAL):
                raise


def _take(path: Path, mode: str, size: int) -> None:
    """Reserve disk space for a file that is not open, or leave it as it was."""
    with path.open(mode) as file:
        before = os.fstat(file.fileno()).st_size
        try:
            _reserve(file.fileno(), size)
        except OSError:
            file.truncate(before)
            raise


@dataclass(frozen=True)
class Channel:
    """One recorded signal: where its values are found and what the trace says of it."""

    instance: str
    variable: str
    unit: str
    display: str
    description: str
    column: int
    real: bool = True
    rate: str | None = None
    meanings: tuple[str, ...] = ()
    first_flag: int = 0


class TraceWriter:
    """Writes a trace. Complete it with `complete`, or leave what was written with `abandon`."""

    def __init__(
        self,
        path: Path,
        attributes: dict[str, str],
        channels: Sequence[Channel],
        parameters: dict[str, dict[str, float | int | bool]],
    ):
        self.path = path
        self.partial = path.with_name(path.name + ".partial")
        self.channels = channels
        self.rows = 0
        self.partial.parent.mkdir(parents=True, exist_ok=True)
        texts = sum(len(text.encode()) for text in attributes.values())
        header = SPARE + texts + PER_DATASET * (len(channels) + 2)
        self._block = SPARE + (PER_DATASET + 8 * ROWS) * (len(channels) + 2)
        try:
            _take(self.partial, "wb", header)
        except OSError:
            self.partial.unlink(missing_ok=True)
            raise
        # v110 is the oldest format that can be read while it is written and after a kill
        # no block is read again: by default HDF5 keeps 8 MB of each dataset in memory
        self._file = h5py.File(self.partial, "w", libver=("v110", "v110"), rdcc_nbytes=16 * ROWS)
        try:
            _reserve(self._file.id.get_vfd_handle(), header)
            self._file.attrs.update({"Conventions": "CF-1.11", **attributes, "status": "running"})
            self._time = self._dataset("/time", "f8", "s", "time", "Time since the start of the run")
            self._time.make_scale("time")
            self._angle = self._dataset(
                "/shaft_angle", "f8", "rad", "shaft angle", "Angle of the main shaft, not wrapped"
            )
            self._angle.dims[0].attach_scale(self._time)
            self._datasets = [self._channel(channel) for channel in channels]
            for instance, values in parameters.items():
                self._file.require_group(instance).attrs.update(values)
            self._file.swmr_mode = True
        except BaseException:
            self._file.close()
            raise

    def _dataset(self, name: str, kind: str, unit: str, long_name: str, comment: str) -> Any:
        dataset = self._file.create_dataset(
            name, (0,), kind, maxshape=(None,), chunks=(ROWS,), shuffle=True, compression="gzip",
            compression_opts=4,
        )  # fmt: skip
        dataset.attrs.update(
            {"UNIT": unit, "units": units.udunits(unit), "long_name": long_name, "COMMENT": comment}
        )
        return dataset

    def _channel(self, channel: Channel) -> Any:
        group = self._file.require_group(channel.instance)
        if "time" not in group:
            group["time"] = self._time  # a hard link: without it xarray loses the axis
        dataset = self._dataset(
            f"/{channel.instance}/{channel.variable}",
            "f8" if channel.real else "i4",
            channel.unit,
            channel.variable.replace("_", " "),
            channel.description,
        )
        dataset.dims[0].attach_scale(self._time)
        if channel.display != channel.unit:
            dataset.attrs["DISPLAY_UNIT"] = channel.display
        if channel.rate:
            dataset.attrs["rate"] = channel.rate
        if channel.meanings:
            flags = range(channel.first_flag, channel.first_flag + len(channel.meanings))
            dataset.attrs["flag_values"] = np.array(flags, dtype="i4")
            dataset.attrs["flag_meanings"] = " ".join(channel.meanings)
        return dataset

    def append(self, time: Floats, angle: Floats, reals: Floats, integers: NDArray[np.int32]) -> None:
        """Write a block: values along the rows, signals along the columns."""
        _reserve(self._file.id.get_vfd_handle(), self._file.id.get_filesize() + self._block)
        start, self.rows = self.rows, self.rows + len(time)
        for dataset, values in ((self._time, time), (self._angle, angle)):
            dataset.resize((self.rows,))
            dataset[start:] = values
        for channel, dataset in zip(self.channels, self._datasets, strict=True):
            dataset.resize((self.rows,))
            dataset[start:] = (reals if channel.real else integers)[:, channel.column]
        self._file.flush()

    def seal(self, status: str) -> None:
        """Close the file under its provisional name, marked with its status."""
        self._file.close()
        self._annotate("status", status)

    def complete(self, verdicts: Sequence[dict[str, Any]]) -> Path:
        """Give the sealed file its verdicts and its final name."""
        self._annotate("claims", json.dumps(verdicts))
        self.partial.replace(self.path)
        return self.path

    def _annotate(self, name: str, text: str) -> None:
        """Write an attribute of the closed file."""
        _take(self.partial, "r+b", _superblock(self.partial)[1] + len(text.encode()) + SPARE)
        with h5py.File(self.partial, "r+") as file:
            file.attrs[name] = text

    def abandon(self, status: str) -> Path:
        """Close what was written so far, marked incomplete; its path."""
        with contextlib.suppress(OSError):  # a full disk: what was flushed can still be read
            self.seal(status)
        return self.partial


def _superblock(path: Path) -> tuple[bool, int]:
    """Whether an HDF5 file is marked as being written for readers beside the writer, and its length.

    The mark stays when the writer is killed; the length is the one that the file says it has.
    """
    with path.open("rb") as file:
        head = file.read(36)
    if len(head) < 36 or head[8] != 3:  # the version that our files have
        return False, 0
    return bool(head[11] & 4), int.from_bytes(head[28:36], "little")


class Trace:
    """A recorded run: `trace["belt.margin"]` is the signal's values, in SI."""

    def __init__(self, path: str | Path):
        self.path = Path(path)
        try:
            self._file = self._open()
        except FileNotFoundError:
            raise LoomfmuError(f"{self.path}: there is no such file") from None
        except (OSError, RuntimeError) as error:
            raise LoomfmuError(f"{self.path}: it is no readable trace ({error})") from None
        if not {"time", "shaft_angle"} <= set(self._file) or not {"title", "status"} <= set(self._file.attrs):
            self._file.close()
            raise LoomfmuError(
                f"{self.path}: it is no trace of a run: it lacks /time, /shaft_angle or a title"
            )
        self._cache: dict[str, NDArray[Any]] = {}

    def _open(self) -> Any:
        try:
            return h5py.File(self.path, "r")
        except OSError:
            marked, length = _superblock(self.path)
            if not marked or self.path.stat().st_size < length:
                raise  # HDF5 would look for the rest of a file that was cut off again and again
        return h5py.File(self.path, "r", swmr=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def __getitem__(self, signal: str) -> NDArray[Any]:
        if signal not in self._cache:
            self._cache[signal] = self._read(self._dataset(signal))
        return self._cache[signal]

    def _read(self, dataset: Any) -> NDArray[Any]:
        try:
            return np.asarray(dataset[: self.rows])
        except (OSError, RuntimeError) as error:
            raise LoomfmuError(f"{self.path}: {dataset.name} cannot be read ({error})") from None

    def __contains__(self, signal: str) -> bool:
        path = "/" + signal.replace(".", "/")
        return path in self._file and isinstance(self._file[path], h5py.Dataset)

    def __iter__(self) -> Iterator[str]:
        for name, group in self._file.items():
            if isinstance(group, h5py.Group):
                yield from (f"{name}.{variable}" for variable in group if variable != "time")

    def _dataset(self, signal: str) -> Any:
        if signal not in self:
            raise LoomfmuError(
                f"{self.path.name}: no signal {signal!r} is recorded{suggestion(signal, self)}"
            )
        return self._file["/" + signal.replace(".", "/")]

    @cached_property
    def rows(self) -> int:
        """Number of samples when first asked; of a run that was cut off, those that all signals have."""
        lengths = [len(self._dataset(signal)) for signal in self]
        return min(len(self._file["time"]), len(self._file["shaft_angle"]), *lengths)

    @cached_property
    def time(self) -> Floats:
        """Time of the samples [s]."""
        return self._read(self._file["time"])

    @cached_property
    def shaft_angle(self) -> Floats:
        """Shaft angle of the samples, not wrapped [rad]."""
        return self._read(self._file["shaft_angle"])

    @property
    def attributes(self) -> dict[str, Any]:
        """What the file says of the run."""
        return dict(self._file.attrs)

    @property
    def status(self) -> str:
        """`complete`, `interrupted`, `failed`, or `running` (also after a kill)."""
        return str(self._file.attrs["status"])

    @property
    def verdicts(self) -> list[dict[str, Any]]:
        """The verdicts stored with the run."""
        return list(json.loads(self._file.attrs.get("claims", "[]")))

    def unit(self, signal: str) -> str:
        """Unit of a signal."""
        return str(self._dataset(signal).attrs["UNIT"])

    def display(self, signal: str) -> str:
        """Unit that people read a signal in."""
        return str(self._dataset(signal).attrs.get("DISPLAY_UNIT", self.unit(signal)))

    def description(self, signal: str) -> str:
        """What a signal is."""
        return str(self._dataset(signal).attrs["COMMENT"])

    def rate(self, signal: str) -> str | None:
        """The recorded signal that is this one's time derivative, if there is one."""
        name = self._dataset(signal).attrs.get("rate")
        rate = f"{signal.split('.')[0]}.{name}"
        return rate if name and rate in self else None

    def parameter(self, signal: str) -> float:
        """A parameter of an instance as it was set, such as `heald_1.stroke`."""
        instance, _, name = signal.partition(".")
        if instance not in self._file or name not in self._file[instance].attrs:
            raise LoomfmuError(f"{self.path.name}: no parameter {signal!r} is recorded")
        return float(self._file[instance].attrs[name])
