"""What happens when, over the main shaft: the rows of a timing diagram.

A row has intervals in which a signal is positive, and a curve between 0 and 1 that shows how it moves.
Edges are interpolated between the samples.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..traces import Trace
from .section import TURN, Subject

Floats = NDArray[np.float64]
Interval = tuple[float, float]


@dataclass(frozen=True)
class Bar:
    """Intervals of a row: where `values` are positive. `role` is what the style gives a colour."""

    label: str
    role: str
    values: Floats


@dataclass(frozen=True)
class Row:
    """A row of the diagram; `curve` is between 0 and 1, None for no curve."""

    name: str
    label: str
    bars: tuple[Bar, ...]
    curve: Floats | None = None


@dataclass(frozen=True)
class Revolution:
    """What there is of one revolution of the shaft, counted from 1: its rows along angles of 0 to 2 pi."""

    number: int
    intervals: dict[tuple[str, str], list[Interval]]
    curves: dict[str, tuple[Floats, Floats]]
    covered: Interval

    def same(self, other: "Revolution") -> bool:
        """Whether nothing in a drawing would tell them apart: to a hundredth of a degree."""
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

    @cached_property
    def rows(self) -> list[Row]:
        """One row for each mechanism that has something to show, in the order of the weft's way."""
        trace = self.subject.trace
        rows: list[Row] = []
        for fmu, make in MAKERS:
            for instance in sorted((name for name, its in trace.fmus.items() if its == fmu), key=in_order):
                rows += make(trace, instance)
        return rows

    @property
    def numbers(self) -> range:
        """Numbers of the revolutions that the run touches."""
        first, last = self.subject.positions[0], self.subject.positions[-1]
        return range(int(np.floor(first / TURN)) + 1, int(np.ceil(last / TURN - 1e-9)) + 1)

    def revolution(self, number: int) -> Revolution:
        """The rows in one revolution."""
        positions = self.subject.positions
        start = (number - 1) * TURN
        first, last = max(start, float(positions[0])), min(start + TURN, float(positions[-1]))
        inside = positions[(positions > first) & (positions < last)]
        along = np.concatenate([[first], inside, [last]])
        return Revolution(
            number,
            {
                (row.name, bar.label): [
                    (low - start, high - start)
                    for low, high in positive(along, np.interp(along, positions, bar.values))
                ]
                for row in self.rows
                for bar in row.bars
            },
            {
                row.name: (along - start, np.interp(along, positions, row.curve))
                for row in self.rows
                if row.curve is not None
            },
            (first - start, last - start),
        )

    def revolutions(self) -> Iterator[Revolution]:
        """All of them, one after the other."""
        return (self.revolution(number) for number in self.numbers)


def in_order(name: str) -> tuple[str, int]:
    """heald_2 comes before heald_10."""
    stem, _, number = name.rpartition("_")
    return (stem, int(number)) if number.isdigit() else (name, 0)


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


def _share(values: Floats) -> Floats | None:
    """Values between their lowest and highest, as 0 to 1; None if they do not move."""
    low, high = float(np.min(values)), float(np.max(values))
    return (values - low) / (high - low) if high > low else None


def _has(trace: Trace, instance: str, *variables: str) -> bool:
    return all(f"{instance}.{variable}" in trace for variable in variables)


def _rapier(trace: Trace, weft: str) -> Iterator[Row]:
    if not _has(trace, weft, "travel"):
        return
    travel = trace[f"{weft}.travel"]
    belts = [name for name, fmu in trace.fmus.items() if fmu == "BeltMonitor"]
    bars = [Bar("in the shed", "weft", travel - trace.parameter(f"{belt}.idle_travel")) for belt in belts[:1]]
    yield Row(weft, "Rapier head", tuple(bars), _share(travel))


def _belt(trace: Trace, belt: str) -> Iterator[Row]:
    if not _has(trace, belt, "free_length"):
        return
    free = trace[f"{belt}.free_length"]
    bars = [Bar("outside its guide", "belt", free)]
    if _has(trace, belt, "axial_force"):
        # a share of their scale each, so that the interpolated edge is that of whichever ends first
        force = trace[f"{belt}.axial_force"]
        pressed = np.minimum(free / np.max(np.abs(free)), force / max(float(np.max(np.abs(force))), 1e-300))
        bars.append(Bar("outside and compressed", "risk", pressed))
    yield Row(belt, "Belt", tuple(bars), _share(free))


def _frame(trace: Trace, heald: str) -> Iterator[Row]:
    if not _has(trace, heald, "lift"):
        return
    lift, stroke = trace[f"{heald}.lift"], trace.parameter(f"{heald}.stroke")
    dobbies = [name for name, fmu in trace.fmus.items() if fmu == "DobbyDrive"]
    tolerance = trace.parameter(f"{dobbies[0]}.dwell_tolerance") if dobbies else 0.015
    from_end = np.minimum(lift, stroke - lift)
    bars = (
        Bar("dwells", "dwell", tolerance * stroke - from_end),
        Bar("changes", "change", from_end - tolerance * stroke),
    )
    yield Row(heald, f"Frame {heald.rpartition('_')[2]}", bars, lift / stroke)


def _shed(trace: Trace, dobby: str) -> Iterator[Row]:
    frames = [name for name, fmu in trace.fmus.items() if fmu == "HealdFrame" and _has(trace, name, "lift")]
    if not frames:
        return
    share = trace.parameter(f"{dobby}.clear_fraction")
    closest = np.min(
        [
            share - np.minimum(trace[f"{name}.lift"], stroke - trace[f"{name}.lift"]) / stroke
            for name in frames
            for stroke in [trace.parameter(f"{name}.stroke")]
        ],
        axis=0,
    )
    yield Row(dobby, "Shed", (Bar("all frames near their ends", "shed", closest),))


def _reed(trace: Trace, reed: str) -> Iterator[Row]:
    if not _has(trace, reed, "position"):
        return
    position = trace[f"{reed}.position"]
    low, high = float(np.min(position)), float(np.max(position))
    bars = (Bar("in its front tenth", "reed", position - (high - 0.1 * (high - low))),) if high > low else ()
    yield Row(reed, "Reed", bars, _share(position))


def _lock(trace: Trace, lock: str) -> Iterator[Row]:
    if not _has(trace, lock, "turn", "turn_velocity"):
        return
    speed = np.abs(trace[f"{lock}.turn_velocity"])
    bars = (Bar("pawl turns", "lock", speed - 1e-6 * float(np.max(speed))),)
    yield Row(lock, "Pattern lock", bars, _share(trace[f"{lock}.turn"]))


MAKERS: tuple[tuple[str, Callable[[Trace, str], Iterator[Row]]], ...] = (
    ("WeftInsertion", _rapier),
    ("BeltMonitor", _belt),
    ("DobbyDrive", _shed),
    ("HealdFrame", _frame),
    ("ReedBeatUp", _reed),
    ("PatternLock", _lock),
)
