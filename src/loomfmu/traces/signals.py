"""Signals of a run, however they are kept; kept in memory."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Container, Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from ..declaring.variables import ALONE, Beside
from ..errors import LoomfmuError, shown, suggestion
from ..extras import need
from ..units import unit

Floats = NDArray[np.float64]
Integers = NDArray[np.int32]

NO_SHAFT = "no shaft turns"


@dataclass(frozen=True)
class Channel:
    """A recorded signal: all that a trace says of it.

    Until it is written it also has the `column` of its values, and the `array` that it is an element of, with
    its `place` there, counted from 1.
    """

    instance: str
    variable: str
    unit: str
    display: str
    description: str
    column: int = 0
    real: bool = True
    rate: str | None = None
    meanings: tuple[str, ...] = ()
    first_flag: int = 0
    boolean: bool = False
    beside: Beside = ALONE
    array: str = ""
    place: tuple[int, ...] = ()

    @cached_property
    def signal(self) -> str:
        """Its name, such as `belt.margin`."""
        return f"{self.instance}.{self.variable}"


class Column(NamedTuple):
    """Real numbers, one for each sample, and where they are in memory."""

    values: Floats
    place: int

    @classmethod
    def of(cls, values: NDArray[Any]) -> Self:
        """Values as real numbers."""
        reals = np.asarray(values, dtype=float)
        return cls(reals, reals.ctypes.data)


class Early(NamedTuple):
    """The early end of a run: which FMU ended it and when, and, if the scene does not allow that, how far it
    came. Texts are empty if they do not apply.
    """

    ended_by: str = ""
    cut_short: str = ""


class Signals(ABC):
    """Recorded signals of a run: `signals["belt.margin"]` are the signal's values, in SI."""

    name = ""  # what messages call it

    @abstractmethod
    def __getitem__(self, signal: str) -> NDArray[Any]: ...

    @abstractmethod
    def __contains__(self, signal: object) -> bool: ...

    @abstractmethod
    def __iter__(self) -> Iterator[str]: ...

    @property
    @abstractmethod
    def time(self) -> Floats:
        """Time of the samples [s]."""

    @property
    @abstractmethod
    def shaft_angle(self) -> Floats:
        """Shaft angle of the samples, not wrapped [rad]."""

    @cached_property
    def cut_short(self) -> str:
        """The share of the run that was made, if an FMU ended it early and the scene forbids that."""
        return ""

    @abstractmethod
    def channel(self, signal: str) -> Channel:
        """The channel of a signal. Raises LoomfmuError for one that is not recorded."""

    def unit(self, signal: str) -> str:
        """Unit of a signal."""
        return self.channel(signal).unit

    def display(self, signal: str) -> str:
        """Unit that people read a signal in."""
        return self.channel(signal).display

    def description(self, signal: str) -> str:
        """Return the description of a signal."""
        return self.channel(signal).description

    def is_real(self, signal: str) -> bool:
        """Return whether a signal holds real numbers; integers, choices and booleans do not vary smoothly."""
        return self.channel(signal).real

    def displayed(self, signal: str) -> tuple[float, str]:
        """Return the unit that people read and the factor from it to the recorded values."""
        display = self.display(signal)
        return unit(display).factor, self.unit(signal) if display == "1" else display

    def columns(self, signals: Sequence[str]) -> list[Column]:
        """The time of the samples, then the values of some signals."""
        return [Column.of(self.time), *(Column.of(self[signal]) for signal in signals)]

    @property
    def turns(self) -> bool:
        """Return whether a shaft turns, forwards."""
        angle = self.shaft_angle
        return len(angle) > 1 and bool(np.all(np.isfinite(angle))) and bool(angle[-1] > angle[0])

    @property
    def standing(self) -> str:
        """Return why nothing is shown over the shaft's angle; an empty text if it turns forwards."""
        if self.turns:
            return ""
        angle = self.shaft_angle
        return "the shaft turns backwards" if len(angle) > 1 and angle[-1] < angle[0] else NO_SHAFT

    def turned_otherwise(self, nominal: float) -> str:
        """Return how far the shaft turned if not by the nominal revolutions, as in a run-up; else an empty
        text.
        """
        if not self.turns:
            return ""
        turned = float(self.shaft_angle[-1] - self.shaft_angle[0]) / (2.0 * math.pi)
        same = abs(turned - nominal) <= 0.005 * nominal  # as people read them, three digits
        return "" if same else f"the shaft turned {turned:.3g} revolutions"

    def rate(self, signal: str) -> str | None:
        """The recorded signal that is this one's time derivative, if there is one."""
        return self._recorded(signal, self.channel(signal).rate)

    def beside(self, signal: str, role: str) -> str | None:
        """The recorded signal that says more of this one in a role of `Beside`, if there is one."""
        return self._recorded(signal, getattr(self.channel(signal).beside, role))

    def _recorded(self, signal: str, variable: str | None) -> str | None:
        """A variable of the instance that a signal is of, if it is recorded."""
        name = f"{signal.partition('.')[0]}.{variable}"
        return name if variable and name in self else None

    def validity(self, signal: str) -> str | None:
        """The recorded yes-or-no signal that says when this one is known, if there is one."""
        return self.beside(signal, "valid_if")

    def error(self, signal: str) -> str | None:
        """The recorded signal that says how far this one may be off whatever the steps, if there is one."""
        return self.beside(signal, "error")

    @abstractmethod
    def parameter(self, signal: str) -> float:
        """A parameter of an instance as it was set, such as `heald_1.stroke`."""

    @cached_property
    def wires(self) -> Mapping[str, str]:
        """The output that each wired input took its values from; empty where the trace does not say."""
        return {}

    @cached_property
    def fmus(self) -> Mapping[str, str]:
        """The name of each instance's FMU, as far as it is known."""
        return {}

    @cached_property
    def own_speeds(self) -> Container[str]:
        """The instances that have a speed [rad/s] at which they turn by themselves."""
        return ()

    @property
    def shared(self) -> dict[Any, Any]:
        """Data that the claims on a run share, where it is kept: that of a file may be too large."""
        return {}

    def to_xarray(self, *signals: str, fold: bool | int = False) -> Any:
        """The signals, or these alone, as an xarray `Dataset`: in SI, with units and the shaft's angle.

        The angle is a coordinate in rad, and once more in deg, as `degrees`.
        Folded, there is a row for each whole revolution, along the angle within it [rad]: `fold` is the
        number of angles, or True for as many as there are samples in a revolution.

        Raises:
            LoomfmuError: an unknown signal, a fold without a whole revolution, or no `loomfmu[xarray]`
        """
        need("to_xarray", "xarray")
        from .datasets import attributes, dataset

        for name in signals:
            if not isinstance(name, str):
                raise LoomfmuError(f"{shown(name)} is not the name of a signal such as 'belt.margin'")

        columns = {
            name: (self.read(name), attributes(self.unit(name), self.description(name)))
            for name in signals or tuple(self)
        }
        return dataset(self.name, self.time, self.shaft_angle, columns, fold)

    def to_pandas(self, *signals: str) -> Any:
        """The signals, or these alone, as a pandas `DataFrame` over time [s]: in SI.

        Beside them it has the shaft's angle as `shaft_angle` [rad] and `degrees` [deg]. Raises LoomfmuError
        as `to_xarray`.
        """
        return self.to_xarray(*signals).to_dataframe()

    def angles_where(self, condition: str) -> Floats:
        """The spans of the shaft's angle [deg] in which a signal meets a condition, a row (begin, end) each.

        The condition is such as `"heald_1.lift > 40 mm"`, with <, <=, > or >=. Angles are those of
        `shaft_angle`, not wrapped. Between samples, real numbers are joined by lines, all others keep their
        last value; no condition is met where a signal is not known.

        Raises:
            LoomfmuError: another condition, an unknown signal, a wrong unit, or a shaft that does not turn
                forwards
        """
        from .conditions import angles_where

        return angles_where(self, condition)

    def read(self, signal: str) -> NDArray[Any]:
        """The values of a signal, as `signals[name]`, which this does not keep in memory."""
        return self[signal]

    def _unknown(self, signal: object) -> LoomfmuError:
        return LoomfmuError(
            f"{self.name}: signal {shown(signal)} is not recorded{suggestion(str(signal), self)}"
        )


DERIVED = ("_joined", "_places", "time", "shaft_angle")  # of the blocks of a recording, when first read


class Recording(Signals):
    """A run that is kept in memory.

    It takes blocks as a `TraceWriter` does, and keeps their arrays. `parameter` gives a parameter of an
    instance as it was set, or None; `wires`, `fmus` and `own_speeds` are those of `Signals`.
    """

    def __init__(
        self,
        name: str,
        channels: Sequence[Channel],
        parameter: Callable[[str, str], float | int | bool | None],
        wires: Mapping[str, str] = MappingProxyType({}),
        fmus: Mapping[str, str] = MappingProxyType({}),
        own_speeds: Container[str] = (),
    ):
        self.name = name
        self._channels = {channel.signal: channel for channel in channels}
        self._parameter = parameter
        self.wires, self.fmus, self.own_speeds = dict(wires), dict(fmus), own_speeds
        self._parameters: dict[str, float] = {}
        self._shared: dict[Any, Any] = {}
        self._blocks: list[tuple[Floats, Floats, Floats, Integers]] = []

    def __repr__(self) -> str:
        return f"<Recording {self.name}: {len(self._channels)} signals>"

    def append(self, time: Floats, angle: Floats, reals: Floats, integers: Integers) -> None:
        """Keep a block: values along the rows, signals along the columns."""
        self._blocks.append((time, angle, reals, integers))
        self._shared.clear()
        for derived in DERIVED:
            self.__dict__.pop(derived, None)

    def moved(
        self, time: Floats, reals: Floats, parameter: Callable[[str, str], float | int | bool | None]
    ) -> "Recording":
        """Return the recording with other times, real values and parameters."""
        found = copy(self)
        found.__dict__ = self.__getstate__() | {"_parameter": parameter, "_parameters": {}, "_blocks": []}
        angle = reals[:, self._channels["shaft.angle"].column] if "shaft.angle" in self else self.shaft_angle
        found.append(time, angle, reals, self._joined[3])
        return found

    @property
    def reals(self) -> Floats:
        """All real values, a row for each sample."""
        found: Floats = self._joined[2]
        return found

    def column(self, signal: str) -> int:
        """Return the column of a signal in `reals`."""
        return self.channel(signal).column

    def start(self, instance: str, variable: str) -> float | int | bool | None:
        """A parameter of an instance as it was set, or None."""
        return self._parameter(instance, variable)

    def __getstate__(self) -> dict[str, Any]:
        """The samples, without what was derived of them: addresses mean nothing in another process."""
        kept = {name: value for name, value in self.__dict__.items() if name not in DERIVED}
        return kept | {"_shared": {}}

    @property
    def shared(self) -> dict[Any, Any]:
        """Data that the claims on it share."""
        return self._shared

    @cached_property
    def _joined(self) -> list[NDArray[Any]]:
        if len(self._blocks) == 1:
            return list(self._blocks[0])
        return [np.concatenate(parts) for parts in zip(*self._blocks, strict=True)]

    @cached_property
    def _places(self) -> tuple[int, int]:
        """Return the addresses of the times and of the real values in memory."""
        return self._joined[0].ctypes.data, self._joined[2].ctypes.data

    def columns(self, signals: Sequence[str]) -> list[Column]:
        """The time of the samples, then the values of some signals."""
        time, reals = self._places
        step = self._joined[2].strides[1]
        found = [Column(self.time, time)]
        for signal in signals:
            channel = self.channel(signal)
            place = reals + channel.column * step
            found.append(Column(self[signal], place) if channel.real else Column.of(self[signal]))
        return found

    @cached_property
    def time(self) -> Floats:
        """Time of the samples [s]."""
        return self._joined[0]

    @cached_property
    def shaft_angle(self) -> Floats:
        """Shaft angle of the samples, not wrapped [rad]."""
        return self._joined[1]

    def __getitem__(self, signal: str) -> NDArray[Any]:
        channel = self.channel(signal)
        values = self._joined[2 if channel.real else 3][:, channel.column]
        return values.astype(bool) if channel.boolean else values

    def __contains__(self, signal: object) -> bool:
        return signal in self._channels

    def __iter__(self) -> Iterator[str]:
        return iter(self._channels)

    def channel(self, signal: str) -> Channel:
        """The channel of a signal. Raises LoomfmuError for one that is not recorded."""
        if not isinstance(signal, str) or signal not in self._channels:
            raise self._unknown(signal)
        return self._channels[signal]

    def parameter(self, signal: str) -> float:
        """A parameter of an instance as it was set, such as `heald_1.stroke`."""
        if signal not in self._parameters:
            instance, _, name = signal.partition(".")
            value = self._parameter(instance, name)
            if value is None:
                raise LoomfmuError(f"{self.name}: parameter {signal!r} is not recorded")
            self._parameters[signal] = float(value)
        return self._parameters[signal]
