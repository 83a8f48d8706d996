"""Plots of the recorded signals: thinned so that no extreme is lost, in the units that people read.

A signal is read block by block and not kept: of a long run, only time and shaft angle are in memory. What the
page draws has 24 bits, an error of 6e-8 of a value; a screen shows 1e-3.
"""

import math
from base64 import b64encode
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..physics.belt import NO_LIMIT
from ..traces import Trace
from ..traces.excerpt import READ
from ..traces.plotting import SPEED, curve_of, known
from .section import Section, Subject, bounds_of, labels, spread
from .templates import template

Floats = NDArray[np.float64]
MOST_POINTS, FEWEST_POINTS = 10_000, 200  # of a curve
SHARE = 150_000  # points of the signals of claims, and of all others: 1.6 MB of a report
LIVE = ["this run", "the scene's own values"]  # what a page draws that runs the scene itself
ALONG = 2000  # points between which the page interpolates time over shaft angle


@dataclass(frozen=True)
class Outline:
    """The samples of a signal that a plot needs, extremes among them, in the file's unit."""

    places: NDArray[np.int64]
    values: Floats
    lowest: float
    highest: float
    last: float
    continuous: bool


def outline(trace: Trace, signal: str, points: int) -> Outline:
    """The lowest and the highest sample of each of so many buckets, and the first and last of all."""
    size = max(1, math.ceil(trace.rows / max(1, points // 2 - 1)))
    parts, start, last, kind = [], 0, math.nan, "f"
    for block in trace.blocks(signal, size * max(1, READ // size)):
        kind = block.dtype.kind
        values = known(trace, signal, block)
        picked = extremes(values, size)
        parts.append((picked + start, values[picked]))
        start, last = start + len(values), float(values[-1])
    places, values = (np.concatenate(column) for column in zip(*parts, strict=True))
    found = values[~np.isnan(values)]
    low, high = (float(found.min()), float(found.max())) if len(found) else (math.nan, math.nan)
    kept = bends(values)
    return Outline(places[kept], values[kept], low, high, last, kind == "f")


def extremes(values: Floats, size: int) -> NDArray[np.int64]:
    """Places of the lowest and the highest value of each `size` values, of the first and the last of all.

    >>> extremes(np.array([0.0, 5.0, 1.0, 2.0, 3.0, -7.0, 2.0]), 3).tolist()
    [0, 1, 4, 5, 6]
    """
    padded = np.concatenate([values, np.full(-len(values) % size, np.nan)]).reshape(-1, size)
    starts = np.arange(len(padded)) * size
    gaps = np.isnan(padded)
    lowest = starts + np.where(gaps, np.inf, padded).argmin(axis=1)
    highest = starts + np.where(gaps, -np.inf, padded).argmax(axis=1)
    edges = np.flatnonzero(np.diff(np.isnan(values)))  # so that no line crosses a gap
    return np.unique(np.concatenate([[0], lowest, highest, edges, edges + 1, [len(values) - 1]]))


def bends(values: Floats) -> NDArray[np.int64]:
    """Places of the values that a line needs: not those within a row of equal ones.

    >>> bends(np.array([1.0, 1.0, 1.0, 2.0, 2.0])).tolist()
    [0, 2, 3, 4]
    """
    equal = (values[1:] == values[:-1]) | (np.isnan(values[1:]) & np.isnan(values[:-1]))
    inside = np.concatenate([[False], equal[:-1] & equal[1:], [False]])[: len(values)]
    return np.flatnonzero(~inside)


def section(subject: Subject) -> Section | None:
    """All signals to choose from, those of the claims shown; None if nothing is recorded."""
    names = list(dict.fromkeys(name for trace in subject.traces for name in trace))
    if not names:
        return None
    judged = [curve_of(subject.trace, verdict.signal) for verdict in subject.trace.verdicts]
    claimed = [name for name in dict.fromkeys(judged) if name in names]
    finer = _points(subject, claimed)
    coarser = _points(subject, [name for name in names if name not in claimed])
    rows, signals = [], {}
    for name in names:
        row, signals[name] = _signal(subject, name, finer if name in claimed else coarser)
        rows.append(row | {"chosen": name in claimed})
    names_of_curves = LIVE if subject.live else labels(subject.traces)
    along = [_along(subject, trace) for trace in subject.traces]
    html = template("plots.html.j2").render(
        turns=subject.turns,
        groups=[(name, list(found)) for name, found in groupby(rows, lambda row: row["instance"])],
        count=len(names),
        several=len(subject.traces) > 1,
        labels=names_of_curves,
    )
    data = {
        "traces": along * len(LIVE) if subject.live else along,
        "drawn": subject.shown,
        "labels": names_of_curves,
        "signals": signals,
        "first": claimed or names[:1],
    }
    scripts = ("plots.js", "live_plots.js") if subject.live else ("plots.js",)
    return Section("plots", "Plots", html, scripts, data, "uplot/uPlot", of_one=False)


def _points(subject: Subject, names: list[str]) -> int:
    """Return the number of points that each curve of such signals may have."""
    curves = sum(name in trace for name in names for trace in subject.traces)
    return min(MOST_POINTS, max(FEWEST_POINTS, SHARE // max(1, curves)))


def _signal(subject: Subject, name: str, points: int) -> tuple[dict[str, Any], dict[str, Any]]:
    """A signal as a row of the table, and what the page draws of it."""
    source = next(trace for trace in subject.traces if name in trace)
    factor, unit = source.displayed(name)
    drawn: list[Any] = []
    summaries = []
    continuous = True
    for label, trace in zip(labels(subject.traces), subject.traces, strict=True):
        if name not in trace:
            drawn.append(None)
            continue
        found = outline(trace, name, points)
        continuous = found.continuous
        along = trace.shaft_angle if trace.turns else trace.time
        curve = [_packed(along[found.places]), _packed(found.values / factor)]
        drawn += [None] * len(LIVE) if subject.live else [curve]
        ends = (found.lowest, found.highest, found.last)
        numbers = ("\u2013" if math.isnan(value) else f"{value / factor:.6g}" for value in ends)
        summaries.append((label, *numbers))
    instance, _, variable = name.partition(".")
    about = source.description(name)
    row = {
        "name": name,
        "instance": instance,
        "variable": variable,
        "unit": "" if unit == "1" else unit,
        "about": about,
        "summaries": summaries,
    }
    bounds = [
        {
            "value": each.bound / factor,
            "text": "" if number else " of ".join(filter(None, key)),
            "holds": each.holds,
            "sense": each.sense,
            "worst": each.worst / factor,
            "at": subject.position(each) if place == subject.shown else None,
        }
        for key, verdicts in bounds_of(subject.traces, [name]).items()
        for number, (place, each) in enumerate(verdicts)
    ]
    return row, {
        "unit": row["unit"],
        "about": about,
        "step": not continuous,
        "free": NO_LIMIT / factor if source.unit(name) == SPEED else None,
        "bounds": bounds,
        "curves": drawn,
    }


def _along(subject: Subject, trace: Trace) -> dict[str, Any]:
    """Return time over shaft angle in a trace: its curves lie along the angle if a shaft turns."""
    places, turns = spread(trace.rows, ALONG), trace.turns
    return {
        "turns": turns,
        "times": _packed(trace.time[places]),
        "positions": _packed((trace.shaft_angle if turns else trace.time)[places]),
    }


def _packed(values: Floats) -> str:
    """Numbers as the page's script reads them: 32 bits each, as base64. What is not finite is a gap."""
    limit = float(np.finfo(np.float32).max)
    finite = np.where(np.abs(values) <= limit, values, np.nan)
    return b64encode(finite.astype("<f4").tobytes()).decode()
