"""Traces in HDF5, read."""

import json
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from ..errors import LoomfmuError
from .disk import superblock
from .signals import Floats, Signals


class Trace(Signals):
    """A run recorded in a file: `trace["belt.margin"]` is the signal's values, in SI."""

    def __init__(self, path: str | Path):
        self.path = Path(path)
        self.name = self.path.name
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
            marked, length = superblock(self.path)
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

    def __contains__(self, signal: object) -> bool:
        path = "/" + str(signal).replace(".", "/")
        return path in self._file and isinstance(self._file[path], h5py.Dataset)

    def __iter__(self) -> Iterator[str]:
        for name, group in self._file.items():
            if isinstance(group, h5py.Group):
                yield from (f"{name}.{variable}" for variable in group if variable != "time")

    def _dataset(self, signal: str) -> Any:
        if signal not in self:
            raise self._unknown(signal)
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
    def ended_by(self) -> str:
        """Which FMU ended the run before its time, and when; empty for one that went to its end."""
        return str(self._file.attrs.get("ended_by", ""))

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
            raise LoomfmuError(f"{self.name}: no parameter {signal!r} is recorded")
        return float(self._file[instance].attrs[name])
