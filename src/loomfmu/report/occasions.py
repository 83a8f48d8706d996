"""The rows of a timing diagram: events over the angle of the main shaft.

A row has intervals in which a rule is positive, and a curve between 0 and 1 that shows how it moves.
Edges are interpolated between the samples.

Signals are read one revolution at a time and not kept; extremes of the whole run are found block by block.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property, lru_cache, partial

import numpy as np
from numpy.typing import NDArray

from ..traces import Trace
from ..traces.excerpt import READ
from .rules import Rule, evaluated
from .section import TURN, Subject

Floats = NDArray[np.float64]
Interval = tuple[float, float]
SMALL = 1e-300  # so that nothing is divided by 0
EXTREMES = {"lowest": np.min, "highest": np.max}  # operations on the whole run
CURVE = 180  # points of a curve, about


@dataclass(frozen=True)
class Bar:
    """Intervals of a row: where a rule is positive. `role` is what the style gives a colour."""

    label: str
    role: str
    rule: Rule


@dataclass(frozen=True)
class Row:
    """A row of the diagram; `curve` is a rule with values from 0 to 1, or of NaN for no curve."""

    name: str
    label: str
    bars: tuple[Bar, ...]
    curve: Rule = float("nan")


@dataclass(frozen=True)
class Revolution:
    """One revolution of the shaft, counted from 1: its rows along angles of 0 to 2 pi."""

    number: int
    intervals: dict[tuple[str, str], list[Interval]]
    curves: dict[str, tuple[Floats, Floats]]
    covered: Interval

    def same(self, other: "Revolution") -> bool:
        """Return whether both would be drawn alike: to a hundredth of a degree."""
        mine, its = (
            [
                (key, round(edge / TURN * 36000.0))
                for key, found in each.intervals.items()
                for pair in found
                for edge in pair
            ]
            for each in (self, other)
        )
        return mine == its and self.covered == other.covered


@dataclass(frozen=True)
class Occasions:
    """The rows of a trace whose shaft turns, and its revolutions."""

    subject: Subject
    _known: dict[str, float] = field(default_factory=dict)  # extremes by their rules

    @cached_property
    def rows(self) -> list[Row]:
        """One row for each mechanism that has something to show, in the order of the weft's way."""
        trace = self.subject.trace
        made = (make(trace, name) for fmu, needed, make in MAKERS for name in instances(trace, fmu, *needed))
        return [row for row in made if row]

    @cached_property
    def _bars(self) -> dict[tuple[str, str], Rule]:
        return {(row.name, bar.label): self._settled(bar.rule) for row in self.rows for bar in row.bars}

    @cached_property
    def _curves(self) -> dict[str, Rule]:
        return {row.name: self._settled(row.curve) for row in self.rows}

    def _settled(self, rule: Rule) -> Rule:
        """A rule with parameters and extremes as numbers: of names, those of signals are left."""
        if isinstance(rule, str):
            return rule if rule in self.subject.trace else self.subject.trace.parameter(rule)
        if not isinstance(rule, list):
            return rule
        settled = [rule[0], *map(self._settled, rule[1:])]
        if rule[0] not in EXTREMES:
            return settled
        key = repr(settled)
        if key not in self._known:
            blocks = (slice(start, start + READ) for start in range(0, self.subject.trace.rows, READ))
            found = [evaluated(settled, partial(self.subject.trace.read, rows=rows)) for rows in blocks]
            self._known[key] = float(EXTREMES[rule[0]](found))
        return self._known[key]

    @property
    def numbers(self) -> range:
        """Numbers of the revolutions that the run touches."""
        first, last = self.subject.positions[0], self.subject.positions[-1]
        return range(int(np.floor(first / TURN)) + 1, int(np.ceil(last / TURN - 1e-9)) + 1)

    def revolution(self, number: int) -> Revolution:
        """The rows in one revolution."""
        trace, every = self.subject.trace, self.subject.positions
        start = (number - 1) * TURN
        first, last = max(start, float(every[0])), min(start + TURN, float(every[-1]))
        rows = slice(
            max(int(np.searchsorted(every, first, side="right")) - 1, 0),
            int(np.searchsorted(every, last)) + 1,
        )
        positions = every[rows]
        along = np.concatenate([[first], positions[(positions > first) & (positions < last)], [last]])
        read = lru_cache(maxsize=8)(partial(trace.read, rows=rows))  # the signals of a few rows

        def on(rule: Rule, places: Floats) -> Floats:
            found = np.asarray(evaluated(rule, read), dtype=float)
            return np.asarray(np.interp(places, positions, np.broadcast_to(found, positions.shape)))

        shown = np.append(along[: -1 : max(1, len(along) // CURVE)], last)
        curves = {row: (shown - start, on(rule, shown)) for row, rule in self._curves.items()}
        return Revolution(
            number,
            {
                bar: [(low - start, high - start) for low, high in positive(along, on(rule, along))]
                for bar, rule in self._bars.items()
            },
            {row: curve for row, curve in curves.items() if np.isfinite(curve[1]).all()},
            (first - start, last - start),
        )

    def revolutions(self) -> Iterator[Revolution]:
        """All of them, one after the other."""
        return (self.revolution(number) for number in self.numbers)


def in_order(name: str) -> tuple[str, int]:
    """heald_2 comes before heald_10."""
    stem, _, number = name.rpartition("_")
    return (stem, int(number)) if number.isdigit() else (name, 0)


def instances(trace: Trace, fmu: str, *variables: str) -> list[str]:
    """Instances of an FMU that record all of some variables, heald_2 before heald_10."""
    found = (
        name
        for name, its in trace.fmus.items()
        if its == fmu and all(f"{name}.{each}" in trace for each in variables)
    )
    return sorted(found, key=in_order)


def positive(along: Floats, values: Floats) -> list[Interval]:
    """Intervals in which values on straight lines between their places are positive.

    >>> positive(np.array([0.0, 1.0, 2.0, 3.0]), np.array([-1.0, 1.0, 1.0, -1.0]))
    [(0.5, 2.5)]
    """
    above = values > 0.0
    change = np.flatnonzero(above[1:] != above[:-1])
    share = values[change] / (values[change] - values[change + 1])
    edges = [float(edge) for edge in along[change] + share * (along[change + 1] - along[change])]
    if above[0]:
        edges.insert(0, float(along[0]))
    if above[-1]:
        edges.append(float(along[-1]))
    return [pair for pair in zip(edges[::2], edges[1::2], strict=True) if pair[1] > pair[0]]


def _share(rule: Rule) -> Rule:
    """Values between their lowest and highest, as 0 to 1."""
    return ["/", ["-", rule, ["lowest", rule]], ["-", ["highest", rule], ["lowest", rule]]]


def _scaled(rule: Rule) -> Rule:
    """A share of the scale, so that of several the interpolated edge is that of whichever ends first."""
    return ["/", rule, ["highest", ["abs", rule], SMALL]]


def _from_end(heald: str) -> Rule:
    """Return the distance of a frame from the nearer end of its stroke."""
    return ["min", f"{heald}.lift", ["-", f"{heald}.stroke", f"{heald}.lift"]]


def _rapier(trace: Trace, weft: str) -> Row:
    travel = f"{weft}.travel"
    belts = instances(trace, "BeltMonitor")
    belts.sort(key=lambda belt: trace.wires.get(f"{belt}.travel") != travel)  # its own one first
    bars = [Bar("in the shed", "weft", ["-", travel, f"{belt}.idle_travel"]) for belt in belts[:1]]
    label = _of_both(trace, travel, "head") or _numbered("Rapier", weft, alone="Rapier head")
    return Row(weft, label, tuple(bars), _share(travel))


def _belt(trace: Trace, belt: str) -> Row:
    free, force = f"{belt}.free_length", f"{belt}.axial_force"
    bars = [Bar("outside its guide", "belt", free)]
    if force in trace:
        bars.append(Bar("outside and compressed", "risk", ["min", _scaled(free), _scaled(force)]))
    if f"{belt}.margin" in trace:
        bars.append(Bar("buckled", "buckled", ["-", 0.0, f"{belt}.margin"]))
    label = _of_both(trace, trace.wires.get(f"{belt}.travel", ""), "belt") or _numbered("Belt", belt)
    return Row(belt, label, tuple(bars), _share(free))


def _of_both(trace: Trace, travel: str, part: str) -> str:
    """Return the name of a part of giver or taker, by the travel of its head; empty for a single rapier."""
    for name in instances(trace, "WeftTransfer"):
        for role in ("giver", "taker"):
            if travel and trace.wires.get(f"{name}.{role}_travel") == travel:
                return f"{role.capitalize()} {part}"
    return ""


def _numbered(label: str, instance: str, alone: str = "") -> str:
    """A label with the number of the instance; without a number, `alone` if there is one.

    A narrow screen has room for some 12 letters.
    """
    number = in_order(instance)[1]
    return f"{label} {number}" if number else alone or label


def _transfer(_trace: Trace, transfer: str) -> Row:
    overlap = f"{transfer}.overlap"
    enough = Bar("heads overlap enough", "transfer", ["-", overlap, f"{transfer}.needed_overlap"])
    passed: Rule = ["max", overlap, 0.0]
    return Row(transfer, "Transfer", (enough,), ["/", passed, ["highest", ["max", passed, SMALL]]])


def _brake(trace: Trace, yarn: str) -> Row | None:
    brake, program = f"{yarn}.brake", f"{yarn}.brake_program_"
    if len({value for name, value in trace.parameters.items() if name.startswith(program)}) < 2:
        return None
    opened = Bar("brake opened", "brake", ["-", ["*", 0.999, f"{yarn}.brake_force"], brake])
    return Row(yarn, "Weft brake", (opened,), _scaled(brake))


def _frame(trace: Trace, heald: str) -> Row:
    dobbies = instances(trace, "DobbyDrive")
    share: Rule = f"{dobbies[0]}.dwell_tolerance" if dobbies else 0.015
    within: Rule = ["*", share, f"{heald}.stroke"]
    bars = (
        Bar("dwells", "dwell", ["-", within, _from_end(heald)]),
        Bar("changes", "change", ["-", _from_end(heald), within]),
    )
    lifted: Rule = ["/", f"{heald}.lift", f"{heald}.stroke"]
    return Row(heald, f"Frame {heald.rpartition('_')[2]}", bars, lifted)


def _shed(trace: Trace, dobby: str) -> Row | None:
    frames = instances(trace, "HealdFrame", "lift")
    if not frames:
        return None
    clear = [["-", f"{dobby}.clear_fraction", ["/", _from_end(name), f"{name}.stroke"]] for name in frames]
    return Row(dobby, "Shed", (Bar("all frames near their ends", "shed", ["min", *clear]),))


def _reed(_trace: Trace, reed: str) -> Row:
    position = f"{reed}.position"
    highest: Rule = ["highest", position]
    front: Rule = ["-", highest, ["*", 0.1, ["-", highest, ["lowest", position]]]]
    return Row(reed, "Reed", (Bar("in its front tenth", "reed", ["-", position, front]),), _share(position))


def _lock(_trace: Trace, lock: str) -> Row:
    speed: Rule = ["abs", f"{lock}.turn_velocity"]
    bars = (Bar("pawl turns", "lock", ["-", speed, ["*", 1e-6, ["highest", speed]]]),)
    return Row(lock, "Pattern lock", bars, _share(f"{lock}.turn"))


# FMUs, the variables that their rows need, and what makes a row; in the order of the weft's way
MAKERS: tuple[tuple[str, tuple[str, ...], Callable[[Trace, str], Row | None]], ...] = (
    ("WeftInsertion", ("travel",), _rapier),
    ("WeftTransfer", ("overlap",), _transfer),
    ("WeftTension", ("brake",), _brake),
    ("BeltMonitor", ("free_length",), _belt),
    ("DobbyDrive", (), _shed),
    ("HealdFrame", ("lift",), _frame),
    ("ReedBeatUp", ("position",), _reed),
    ("PatternLock", ("turn", "turn_velocity"), _lock),
)
