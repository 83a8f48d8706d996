"""Traces in HDF5, read."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import h5py
import numpy as np
from numpy.typing import NDArray

from .. import units
from ..components import COMPONENTS
from ..declaring.variables import SHARED, variables_of
from ..display import notebook
from ..errors import LoomfmuError, shown
from ..units import UnitError
from . import arrays
from .layout import attributes, channel_of, check_link, column, has, member
from .opened import TraceFile
from .signals import Channel, Floats, Signals
from .verdict import HEADINGS, Verdict

ABOUT = (
    "parameter_units",
    "parameter_meanings",
    "NX_class",
    "signal",
    "axes",
    arrays.LISTED,
)  # attributes of a group that are not values
NO_JSON = (RecursionError, TypeError, ValueError)  # for a text or its contents


class Trace(Signals):
    """A run recorded in a file: `trace["belt.margin"]` is the signal's values, in SI.

    Iterate over it for the names of the signals. The file is open only during a read or a `with` statement,
    so you can keep hundreds of traces. A trace stays readable if this process writes another under its name.

    Some damaged files make HDF5 loop forever. If a file may be damaged, call
    `loomfmu.traces.damage.check(path)` first, as `loomfmu show` does: it reads the file in a separate
    process, which takes a third of a second.
    """

    def __init__(self, path: str | Path):
        self._file = TraceFile(Path(path))
        self.given = Path(path)  # what messages call it
        self.name = self.given.name
        self._cache: dict[str, NDArray[Any]] = {}
        self._channels: dict[str, Channel] = {}

    def __getstate__(self) -> dict[str, Any]:
        """Return the file alone: a copy in another process reads values from it when it needs them."""
        return {"_file": self._file, "given": self.given, "name": self.name, "_cache": {}, "_channels": {}}

    def __repr__(self) -> str:
        return f"<Trace {self.given}>"

    def _repr_html_(self) -> str:
        signals = notebook.table(
            ("signal", "unit", "what it is"),
            [(name, self.unit(name), self.description(name)) for name in self],
        )
        count = f"{len(self._signals)} signals, {self.rows} samples"
        verdicts = (
            [notebook.table(HEADINGS, [verdict.row for verdict in self.verdicts])] if self.judged else []
        )
        return notebook.block(
            f"{self.heading} ({self.given}, {self.status})",
            *verdicts,
            f"<details><summary>{count}</summary>{signals}</details>",
        )

    @property
    def path(self) -> Path:
        """The present path of the file."""
        return self._file.path

    def __enter__(self) -> Self:
        self._file.keep_open()
        return self

    def __exit__(self, *_error: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file, if it is open."""
        self._file.close()

    def __getitem__(self, signal: str) -> NDArray[Any]:
        if not isinstance(signal, str):
            raise self._unknown(signal)
        if signal not in self._cache:
            self._cache[signal] = self.read(signal)
        return self._cache[signal]

    def blocks(self, signal: str, rows: int) -> Iterator[NDArray[Any]]:
        """The values of a signal, so many rows at a time: none are kept, however long the run was."""
        with self._file.opened():  # once for all of them
            for start in range(0, self.rows, rows):
                yield self.read(signal, slice(start, start + rows))

    def _check_length(self, dataset: Any) -> None:
        if len(dataset) < self.rows:
            signal = dataset.name.strip("/").replace("/", ".")
            raise self._damaged(f"{signal} has {len(dataset)} samples, time has {self.rows}")

    def read(self, signal: str, rows: slice = slice(None)) -> NDArray[Any]:
        """The values of a signal, as `trace[signal]`, or some of them; this does not keep them in memory."""
        if signal in self._cache:
            return self._cache[signal][rows]
        with self._dataset(signal) as dataset:
            self._check_length(dataset)
            try:
                values = np.asarray(dataset[slice(*rows.indices(self.rows))])
            except (OSError, RuntimeError) as error:
                raise LoomfmuError(f"{self.given}: {dataset.name} cannot be read ({error})") from None
            return values.astype(bool) if dataset.attrs.get("dtype") == "bool" else values

    def array(self, name: str) -> NDArray[Any]:
        """The values of an array such as `plant.y`, along time and then along its own axes.

        Raises LoomfmuError where not all of its elements are recorded.
        """
        instance, _, array = name.partition(".")
        with self._file.opened() as file:
            group = member(file, instance) if has(file, instance) else {}
            if array not in (arrays.listed(group) if group else ()):
                raise self._unknown(name)
            names, shape = arrays.elements(member(group, array))
            return np.stack([self[f"{instance}.{each}"] for each in names], axis=-1).reshape(-1, *shape)

    def __contains__(self, signal: object) -> bool:
        return signal in self._signals

    def __iter__(self) -> Iterator[str]:
        return iter(self._signals)

    @cached_property
    def _signals(self) -> dict[str, None]:
        """The signals, in their order. A group that cannot be opened is not left out: KeyError says so."""
        with self._file.opened() as file:
            members = {name: member(file, name) for name in file}
            groups = {name: each for name, each in members.items() if isinstance(each, h5py.Group)}
            others = {name: arrays.listed(group) for name, group in groups.items()}
            found = [
                (name, variable)
                for name, group in groups.items()
                for variable in group
                if variable not in others[name]
            ]
            for name, variable in found:
                check_link(groups[name], variable)
            return {  # an instance has a link to the coordinates of all, or a signal of that name
                f"{name}.{variable}": None
                for name, variable in found
                if variable not in SHARED or groups[name][variable] != file[variable]
            }

    def check(self) -> None:
        """Read all that the file says of the run and its signals. Raises LoomfmuError where it is damaged."""
        with self._file.opened() as file:
            attributes(file)
            for dataset in (self._item(file, signal) for signal in (*SHARED, *self)):
                attributes(dataset)
                self._check_length(dataset)
            for name in {signal.partition(".")[0] for signal in self}:
                attributes(member(file, name))
            _ = self.time

    @contextmanager
    def _dataset(self, signal: str) -> Iterator[Any]:
        with self._file.opened() as file:
            if signal not in SHARED and signal not in self:
                raise self._unknown(signal)
            yield self._item(file, signal)

    def _item(self, file: Any, signal: str) -> Any:
        """The dataset of a signal."""
        instance, _, variable = signal.rpartition(".")
        return column(member(member(file, instance) if instance else file, variable))

    def channel(self, signal: str) -> Channel:
        """The channel that the file says a signal is. Raises LoomfmuError for one that is not recorded."""
        if signal not in self._channels:
            with self._dataset(signal) as dataset:
                self._channels[signal] = channel_of(signal, dataset)
        return self._channels[signal]

    @cached_property
    def rows(self) -> int:
        """Number of samples when first read; of a run that was cut off, those that all signals have."""
        with self._file.opened() as file:
            signals = ("time",) if self.judged else (*SHARED, *self)
            return min(len(self._item(file, signal)) for signal in signals)

    @cached_property
    def time(self) -> Floats:
        """Time of the samples [s]."""
        time: Floats = self.read("time")
        rises = np.diff(time) > 0.0
        if not np.all(rises):
            place = int(np.argmin(rises))
            raise self._damaged(f"after {time[place]:g} s comes {time[place + 1]:g} s")
        return time

    @cached_property
    def shaft_angle(self) -> Floats:
        """Shaft angle of the samples, not wrapped [rad]."""
        return self.read("shaft_angle")

    @property
    def attributes(self) -> dict[str, Any]:
        """The attributes of the run in the file."""
        with self._file.opened() as file:
            return attributes(file)

    @property
    def heading(self) -> str:
        """The heading of the run: machine, head, weave and speed, then all other values that were set.

        Traces of older versions do not say; then it is the title of the scene in quotes, and what differs.
        """
        if known := self.attributes.get("heading"):
            return str(known)
        changed = ", ".join(f"{key} = {value}" for key, value in self.overrides.items())
        return f'"{self.attributes["title"]}"' + (f"; {changed}" if changed else "")

    @property
    def origin(self) -> str:
        """The scene by its title, which is its author's words and not about values that were changed."""
        return ("changed from the scene" if self.overrides else "scene") + f' "{self.attributes["title"]}"'

    @property
    def status(self) -> str:
        """`complete`, `interrupted`, `failed`, `unjudged`, or `running` (also after a kill)."""
        return str(self.attributes["status"])

    @property
    def ended_by(self) -> str:
        """The FMU that ended the run before its time, and when; empty if the run went to its end."""
        return str(self.attributes.get("ended_by", ""))

    @cached_property
    def cut_short(self) -> str:
        """The share of the run that was made, if an FMU ended it early and the scene forbids that."""
        return str(self.attributes.get("cut_short", ""))

    @property
    def judged(self) -> bool:
        """Return whether the verdicts are stored with the run, because it went to its end."""
        return "claims" in self.attributes

    @property
    def verdicts(self) -> list[Verdict]:
        """The verdicts stored with the run, none if it was not judged; as JSON in the attribute `claims`."""
        try:
            stored = json.loads(self.attributes.get("claims", "[]"))
            if not isinstance(stored, list):
                raise ValueError(f"{shown(stored)} is not a list")
            return [Verdict.of(each) for each in stored]
        except (AttributeError, LookupError, OverflowError, *NO_JSON, UnitError) as error:
            raise self._damaged(f"its claims are not verdicts: {error}") from None

    @property
    def overrides(self) -> dict[str, Any]:
        """The values that differ from the scene, as `--set` takes them."""
        return self._table(self.attributes, "set")

    @cached_property
    def wires(self) -> dict[str, str]:
        """The output that each wired input took its values from; traces of older versions do not say."""
        found = self._table(self.attributes, "wires")
        return {str(sink): str(source) for sink, source in found.items()}

    def _table(self, attributes: Any, name: str) -> dict[str, Any]:
        """A table in JSON among attributes; empty where a trace of an older version has none."""
        try:
            found = json.loads(str(attributes.get(name, "{}")))
        except NO_JSON:
            found = None
        if not isinstance(found, dict):
            raise self._damaged(f"its `{name}` is not a table")
        return found

    @cached_property
    def fmus(self) -> dict[str, str]:
        """The name of each instance's FMU."""
        with self._file.opened() as file:
            names = dict.fromkeys(signal.partition(".")[0] for signal in self)
            return {name: str(member(file, name).attrs.get("fmu", "")) for name in names}

    @cached_property
    def own_speeds(self) -> frozenset[str]:
        """The instances that have a speed [rad/s] at which they turn by themselves."""
        return frozenset(name for name in self.fmus if self.parameter_unit(f"{name}.speed") == "rad/s")

    def _damaged(self, why: str) -> LoomfmuError:
        return LoomfmuError(f"{self.given}: the file is damaged ({why})")

    def displayed(self, signal: str) -> tuple[float, str]:
        """Return the unit that people read and the factor from it to the recorded values."""
        try:
            return super().displayed(signal)
        except UnitError as error:
            raise LoomfmuError(f"{self.given}: {signal}: {error}") from None

    def plot(self, *signals: str, over: str | None = None, fold: bool = False, axes: Any = None) -> Any:
        """Plot signals of one unit by matplotlib and return the axes.

        Args:
            signals: their names, such as `belt.margin`
            over: `"angle"` or `"time"`; the shaft's angle if a shaft turns, by default
            fold: lay the revolutions over one another, at 0 to 360 deg
            axes: where to draw; axes of a new figure by default

        Raises:
            LoomfmuError: a signal is not recorded, units differ, no shaft turns, or matplotlib is missing
        """
        from .plotting import plot

        return plot(self, signals, over, fold, axes)

    @cached_property
    def parameters(self) -> dict[str, float | int | str]:
        """The values of all instances by names such as `heald_1.stroke`: numbers in SI, and texts such as
        `belt.head`."""
        with self._file.opened() as file:
            groups = {name: member(file, name) for name in file if name not in SHARED}
            return {
                f"{name}.{key}": value if isinstance(value, int | float) else str(value)
                for name, group in groups.items()
                for key, value in attributes(group).items()
                if key not in ABOUT
            }

    def parameter_unit(self, name: str) -> str:
        """Unit of a value in `parameters`; "1" for one without."""
        return self._about_parameter(name, "parameter_units") or "1"

    def _about_parameter(self, name: str, attribute: str) -> str:
        """The entry of a value in `parameters` in a table of its group; empty where it has none."""
        instance, _, key = name.partition(".")
        with self._file.opened() as file:
            return str(self._table(member(file, instance).attrs, attribute).get(key, ""))

    def parameter_text(self, name: str) -> str:
        """A value in `parameters` as people read it."""
        if meaning := self._about_parameter(name, "parameter_meanings"):
            return meaning
        value = self.parameters[name]
        if not isinstance(value, float):
            return str(value)
        display = self._parameter_display(name)
        factor = units.unit(display).factor if display in units.UNITS else 1.0
        return f"{value / factor:.9g}" + ("" if display == "1" else f" {display}")

    def _parameter_display(self, name: str) -> str:
        """The unit in which people read a value; that of its FMU if it is not one of ours."""
        instance, _, key = name.partition(".")
        with self._file.opened() as file:
            component = COMPONENTS.get(str(member(file, instance).attrs.get("fmu", "")))
        declared = {each.name: each.display for each in variables_of(component)} if component else {}
        unit = self.parameter_unit(name)
        display = declared.get(key) or unit
        known = [units.UNITS.get(each) for each in (display, unit)]
        alike = known[0] and known[1] and known[0].dimension == known[1].dimension
        return display if alike else unit

    def parameter(self, signal: str) -> float:
        """A parameter of an instance, or an input that was left at its start, such as `heald_1.stroke`."""
        instance, _, name = signal.partition(".")
        with self._file.opened() as file:
            value = member(file, instance).attrs.get(name) if has(file, instance) else None
        if not isinstance(value, np.number | np.bool_):
            raise LoomfmuError(f"{self.name}: parameter {signal!r} is not recorded")
        return float(value)
