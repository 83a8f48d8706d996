"""The differences between two traces, as data and in words."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from .. import units
from ..display import notebook, printed
from ..errors import listed
from .verdict import place_text

SIGNAL_HEADINGS = ("signal", "first at", "", "", "largest difference", "relative", "at")
CHANGE_HEADINGS = ("what", "name", "", "")
KINDS = {
    "instance": ("instance", " in one trace only"),
    "value": ("value",),
    "claim": ("claim",),
    "run": ("difference", " in the run"),
    "unit": ("unit",),
    "signal": ("signal", " in one trace only"),
}  # of changes, as the summary counts them
MOST = 10  # signals that are shown, unless all are wanted


@dataclass(frozen=True)
class Place:
    """A sample: its time [s], the shaft's angle [rad] and the revolution; NaN and None without a shaft."""

    time: float
    angle: float
    revolution: int | None

    def __str__(self) -> str:
        return place_text(self.time, self.angle, self.revolution)


@dataclass(frozen=True)
class Difference:
    """A signal that differs: where first, with the values of both traces there, and where most.

    Values are in `unit`; people read them in `display`. `scale` is the largest magnitude of the signal in
    either trace; `largest` is infinite where only one of them has a value.
    """

    signal: str
    unit: str
    display: str
    first: Place
    values: tuple[float, float]
    largest: float
    scale: float
    at: Place

    @property
    def relative(self) -> float:
        """The largest difference as a share of the signal's largest magnitude."""
        return self.largest / self.scale if self.scale else math.inf

    def shown(self, value: float) -> str:
        """One of the values as people read it."""
        if math.isnan(value):
            return "no value"
        known = self.display != "1" and self.unit in units.UNITS and self.display in units.UNITS
        factor = units.unit(self.unit).factor / units.unit(self.display).factor if known else 1.0
        label = self.display if known else self.unit
        return f"{value * factor + 0.0:.7g}" + ("" if label == "1" else f" {label}")

    @property
    def row(self) -> tuple[str, ...]:
        """The difference as a row of a table."""
        values = (self.shown(value) for value in self.values)
        return (
            self.signal,
            str(self.first),
            *values,
            self.shown(self.largest),
            f"{self.relative:.3g}",
            str(self.at),
        )

    @property
    def entry(self) -> tuple[str, ...]:
        """The difference in parts, where the terminal has no room for a table."""
        signal, first, one, two, largest, relative, at = self.row
        return (
            f"signal {signal}",
            f"first at {first}: A {one}, B {two}",
            f"most at {at}: by {largest} (relative {relative})",
        )


@dataclass(frozen=True)
class Change:
    """Something else that differs: what it is, its name, and what it is in either trace."""

    what: str
    name: str
    first: str
    second: str

    @property
    def row(self) -> tuple[str, str, str, str]:
        """The change as a row of a table."""
        return self.what, self.name, self.first, self.second

    @property
    def entry(self) -> tuple[str, ...]:
        """The change in parts, where the terminal has no room for a table."""
        return f"{self.what} {self.name}", f"A: {self.first}", f"B: {self.second}"


@dataclass(frozen=True, repr=False)
class Comparison:
    """Two traces, compared; true if they are equal within the tolerance.

    `differences` are the signals that differ, the relatively largest difference first; `changes` what else
    does: values, claims, the length of the run, signals that only one trace has. `how` says at which samples
    they were compared, `notes` what may explain a difference, such as another version of an FMU, and counts
    as none. `earliest` is the signal that differs first.
    """

    names: tuple[str, str]
    compared: int
    how: str
    tolerance: float
    differences: tuple[Difference, ...]
    changes: tuple[Change, ...]
    notes: tuple[str, ...]
    earliest: Difference | None = None

    def __bool__(self) -> bool:
        return not self.differences and not self.changes

    @property
    def equal(self) -> bool:
        """Return whether nothing differs."""
        return bool(self)

    @property
    def summary(self) -> str:
        """The outcome in a line."""
        first, second = self.names
        limit = f"{self.tolerance:g} of each signal's largest magnitude"
        if self:
            equal = f"equal within {limit}" if self.tolerance else "exactly equal"
            return f"{first} and {second}: {_counted(self.compared, 'signal')}, {equal}"
        counts = Counter(change.what for change in self.changes)
        parts = [_counted(count, *KINDS[kind]) for kind, count in counts.items()]
        parts += [f"{len(self.differences)} of {_counted(self.compared, 'signal')}"] * bool(self.differences)
        beyond = f" by more than {limit}" if self.tolerance else ""
        return f"{first} and {second} differ{beyond}: {listed(parts)}"

    def __repr__(self) -> str:
        lines = [" | ".join(each.row) for _headings, found in self._tables(MOST) for each in found]
        return "\n  ".join([f"<Comparison {self.summary}", *lines, *self._ends(MOST)]) + ">"

    def _repr_html_(self) -> str:
        tables = [
            notebook.table(headings, [each.row for each in found])
            for headings, found in self._tables(MOST, self.names)
        ]
        lines = (self.how, *self._ends(MOST), *self.notes)
        return notebook.block(self.summary, *tables, *map(notebook.line, lines))

    def _tables(
        self, most: int | None, names: tuple[str, str] = ("A", "B")
    ) -> list[tuple[tuple[str, ...], Sequence[Change | Difference]]]:
        """Headings and rows of the tables that are not empty, causes first; at most so many signals."""
        tables = (CHANGE_HEADINGS, self.changes), (SIGNAL_HEADINGS, self.differences[:most])
        return [((*head[:2], *names, *head[4:]), found) for head, found in tables if found]

    def _ends(self, most: int | None) -> list[str]:
        """Return where the traces begin to differ, and how many signals the table leaves out."""
        if self.earliest is None:
            return []
        more = len(self.differences[most:]) if most is not None else 0
        left_out = f"{_counted(more, 'more signal')} with smaller relative differences"
        left_out += "; loomfmu compare --all lists all"
        return [f"first to differ: {self.earliest.signal} at {self.earliest.first}", *[left_out] * bool(more)]

    def show(self, most: int | None = MOST) -> None:
        """Print it, with at most so many signals; None for all."""
        printed.say(self.summary, self.how)
        if not self:
            printed.say("A: {}, B: {}".format(*self.names))
        for headings, found in self._tables(most):
            rows, entries = [each.row for each in found], [each.entry for each in found]
            printed.show(headings, rows, entries, stacked=True)
        printed.say(*self._ends(most), *self.notes)


def _counted(count: int, noun: str, more: str = "") -> str:
    return f"{count} {noun}" + "s" * (count != 1) + more
