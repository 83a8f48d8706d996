"""A run with signals that are made from its own."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .signals import Channel, Column, Floats, Signals


class Extended(Signals):
    """A run with further signals `made`, by name, some of which are `rates` of others or of its own.

    They are in one `unit`, which people read in a unit `display`.
    """

    def __init__(
        self,
        run: Signals,
        made: dict[str, NDArray[Any]],
        rates: Mapping[str, str],
        unit: str = "1",
        display: str = "1",
    ):
        self._run, self._made, self._rates = run, made, rates
        self._unit, self._display = unit, display
        self.name, self.cut_short = run.name, run.cut_short
        self.wires, self.fmus, self.own_speeds = run.wires, run.fmus, run.own_speeds

    @property
    def shared(self) -> dict[Any, Any]:
        """Data that the claims on the run share."""
        return self._run.shared

    @property
    def time(self) -> Floats:
        """Time of the samples [s]."""
        return self._run.time

    @property
    def shaft_angle(self) -> Floats:
        """Shaft angle of the samples, not wrapped [rad]."""
        return self._run.shaft_angle

    def __getitem__(self, signal: str) -> NDArray[Any]:
        return self._made[signal] if signal in self._made else self._run[signal]

    def __contains__(self, signal: object) -> bool:
        return signal in self._made or signal in self._run

    def __iter__(self) -> Iterator[str]:
        return iter([*self._run, *self._made])

    def channel(self, signal: str) -> Channel:
        """The channel of a signal. Raises LoomfmuError for one that is not there."""
        if signal not in self._made:
            return self._run.channel(signal)
        return Channel("", signal, self._unit, self._display, signal)

    def columns(self, signals: Sequence[str]) -> list[Column]:
        """The time of the samples, then the values of some signals."""
        time, *_none = self._run.columns([])
        return [time, *(self._column(each) for each in signals)]

    def _column(self, signal: str) -> Column:
        made = self._made.get(signal)
        return self._run.columns([signal])[1] if made is None else Column.of(made)

    def rate(self, signal: str) -> str | None:
        """The signal that is this one's time derivative, if there is one."""
        return self._rates.get(signal) or (None if signal in self._made else self._run.rate(signal))

    def beside(self, signal: str, role: str) -> str | None:
        """The signal that says more of this one in a role of `Beside`, if there is one."""
        return None if signal in self._made else self._run.beside(signal, role)

    def parameter(self, signal: str) -> float:
        """A parameter of an instance as it was set."""
        return self._run.parameter(signal)


RATE = "rate of "


class Resampled(Extended):
    """A run whose signals were computed at other times: only those that were `made`, with their `rates`."""

    def __init__(self, run: Signals, time: Floats, made: dict[str, NDArray[Any]], rates: Mapping[str, str]):
        super().__init__(run, made, rates)
        self._time, self._kept = time, dict[Any, Any]()

    @property
    def shared(self) -> dict[Any, Any]:
        """Data that the claims on the run share."""
        return self._kept

    @property
    def time(self) -> Floats:
        """Time of the samples [s]."""
        return self._time

    @property
    def shaft_angle(self) -> Floats:
        """Shaft angle of the samples, not wrapped [rad]; zeros in a run without a shaft."""
        found: Floats = self._made.get("shaft.angle", np.zeros(len(self._time)))
        return found

    def __contains__(self, signal: object) -> bool:
        return signal in self._made

    def __iter__(self) -> Iterator[str]:
        return iter(self._made)

    def channel(self, signal: str) -> Channel:
        """The channel of a signal. Raises LoomfmuError for one that is not there."""
        return self._run.channel(signal) if signal in self._run else super().channel(signal)

    def columns(self, signals: Sequence[str]) -> list[Column]:
        """The time of the samples, then the values of some signals."""
        return [Column.of(self._time), *(self._column(each) for each in signals)]

    def beside(self, signal: str, role: str) -> str | None:
        """The signal that says more of this one in a role of `Beside`, if there is one."""
        found = self._run.beside(signal, role) if signal in self._run else None
        return found if found in self._made else None
