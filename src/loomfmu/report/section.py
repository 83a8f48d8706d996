"""Sections of a report, each independent of the others, along one axis."""

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import listed
from ..traces import Trace, Verdict
from ..traces.plotting import curve_of
from .templates import text

TURN = 2.0 * math.pi
USUAL = math.radians(100.0)  # where a belt without guide hooks is pressed most
COARSEST = math.radians(10.0)  # between samples: beyond, neither motions nor intervals can be shown


@dataclass(frozen=True)
class Section:
    """A part of the page: `html` below the heading `title`, and what makes it follow the cursor.

    `data` is what `scripts`, files of the folder `page`, find by `loomfmu.data(name)`. `library` names the
    script and the style sheet of others that they need, without suffix.
    """

    name: str
    title: str
    html: str
    scripts: tuple[str, ...] = ()
    data: Any = None
    library: str = ""
    of_one: bool = True  # whether it shows a single trace

    @property
    def code(self) -> str:
        """The text of the scripts."""
        return "\n".join(map(text, ((f"{self.library}.js",) if self.library else ()) + self.scripts))

    @property
    def style(self) -> str:
        """The style sheet of the library."""
        return text(f"{self.library}.css") if self.library else ""

    @property
    def json(self) -> str:
        """The data as JSON that no text in it can end: it stands in a script element."""
        return embedded(self.data)


def embedded(data: Any) -> str:
    """Data as JSON inside a script element; what is not finite becomes null.

    >>> embedded({"a": "</script>", "b": math.nan})
    '{"a":"\\\\u003c/script>","b":null}'
    """
    text = json.dumps(_plain(data), ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")


def _plain(data: Any) -> Any:
    if isinstance(data, dict):
        return {str(key): _plain(value) for key, value in data.items()}
    if isinstance(data, np.ndarray):
        return _plain(data.tolist())
    if isinstance(data, list | tuple):
        return [_plain(each) for each in data]
    if isinstance(data, np.generic):
        return _plain(data.item())
    return None if isinstance(data, float) and not math.isfinite(data) else data


@dataclass(frozen=True)
class Subject:
    """The subject of a report: its traces, of which one is shown in motion.

    On a `live` page the FMUs themselves run: what it draws and judges then changes with each run.

    Places are positions on one axis: the shaft's angle, not wrapped [rad], or time [s] where no shaft turns.
    """

    traces: Sequence[Trace]
    live: bool = False

    @cached_property
    def shown(self) -> int:
        """The number of the trace that is shown in motion: that of the worst verdict, else the first."""
        return next((number for number, each in enumerate(self._placed) if self.worst in each), 0)

    @property
    def trace(self) -> Trace:
        """The trace that is shown in motion."""
        return self.traces[self.shown]

    @cached_property
    def turns(self) -> bool:
        """Return whether a shaft turns in the first trace: then positions are its angles."""
        return self.traces[0].turns

    @cached_property
    def positions(self) -> NDArray[np.float64]:
        """Position of each sample of the trace that is shown."""
        return self.along(self.trace)

    def along(self, trace: Trace) -> NDArray[np.float64]:
        """Position of each sample of a trace."""
        return trace.shaft_angle if self.turns else trace.time

    @cached_property
    def gap(self) -> float:
        """Largest distance between samples, as a position."""
        return float(np.max(np.diff(self.positions), initial=0.0))

    @cached_property
    def worst(self) -> Verdict | None:
        """Return the verdict that matters most, of those of any trace that have a place; None without one.

        One that fails comes before one that is undecided, and that before one that holds; then the one
        nearest to its bound or farthest beyond it, one without a distance last.
        """
        order = lambda each: (each.holds, not each.decided, math.isnan(each.away), each.away)  # noqa: E731
        return min(chain.from_iterable(self._placed), key=order, default=None)

    @cached_property
    def _placed(self) -> list[list[Verdict]]:
        """The verdicts of each trace that have a place."""
        return [[each for each in trace.verdicts if self.position(each) is not None] for trace in self.traces]

    @cached_property
    def start(self) -> float:
        """The position at which the page opens: that of the worst verdict, else 100 deg or the middle."""
        first, last = (float(self.positions[place]) for place in (0, -1))
        place = None if self.worst is None else self.position(self.worst)
        if place is None:
            place = first + USUAL if self.turns else 0.5 * (first + last)
        return min(max(place, first), last)

    def position(self, verdict: Verdict) -> float | None:
        """Return the position of a claim's worst value, or None if it has none."""
        if not math.isfinite(verdict.time):
            return None
        if not self.turns:
            return verdict.time
        if verdict.revolution is None:
            return None
        return (verdict.revolution - 1) * TURN + verdict.angle


def spread(count: int, most: int) -> NDArray[np.int64]:
    """Places in a row, at most so many, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def labels(traces: Sequence[Trace]) -> list[str]:
    """Return the names of traces in a legend: their files, with folders if two have the same name."""
    names = [trace.path.name for trace in traces]
    return [
        name if names.count(name) == 1 else str(trace.given)
        for trace, name in zip(traces, names, strict=True)
    ]


def bounds_of(
    traces: Sequence[Trace], signals: Sequence[str]
) -> dict[tuple[str, str], list[tuple[int, Verdict]]]:
    """Return the verdicts on signals, or on their held extremes, with the places of their traces.

    They are by their bounds, and by the traces that have these if not all do.
    """
    found: dict[str, list[tuple[int, Verdict]]] = {}
    for place, trace in enumerate(traces):
        for each in trace.verdicts:
            curve = next(
                (name for name in (each.signal, curve_of(trace, each.signal)) if name in signals), ""
            )
            if curve in trace and math.isfinite(each.bound) and each.unit == trace.unit(curve):
                found.setdefault(f"bound {each.shown(each.bound)}", []).append((place, each))
    names = labels(traces)
    owners = {said: list(dict.fromkeys(names[place] for place, _each in of)) for said, of in found.items()}
    return {
        (said, "" if len(owners[said]) == len(traces) else listed(owners[said])): of
        for said, of in found.items()
    }
