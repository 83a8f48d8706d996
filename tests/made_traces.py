"""Traces that tests make of arrays, without a run."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from loomfmu.traces import Channel, Trace, TraceWriter, Verdict


def made(
    path: Path,
    signals: Mapping[str, Any],
    *,
    time: Any = None,
    angle: Any = None,
    unit: str = "m",
    display: str = "",
    attributes: Mapping[str, Any] | None = None,
    groups: Mapping[str, Mapping[str, Any]] | None = None,
    verdicts: Sequence[Verdict] = (),
) -> Trace:
    """A trace of signals by their names: reals in a unit, and whole numbers.

    By default there is a millisecond between samples, and no shaft turns.
    """
    columns = {name: np.asarray(values) for name, values in signals.items()}
    kinds = {name: "f8" if values.dtype.kind == "f" else "i4" for name, values in columns.items()}
    alike = {kind: [name for name in columns if kinds[name] == kind] for kind in ("f8", "i4")}
    channels = [
        Channel(
            *name.split("."),
            *((unit, display or unit) if kind == "f8" else ("1", "1")),
            name.rpartition(".")[2],
            alike[kind].index(name),
            real=kind == "f8",
        )
        for name, kind in kinds.items()
    ]
    rows = len(next(iter(columns.values())) if time is None else time)
    along = 1e-3 * np.arange(rows) if time is None else np.asarray(time)
    blocks = [
        np.array([columns[name] for name in names], kind).reshape(len(names), rows).T
        for kind, names in alike.items()
    ]
    writer = TraceWriter(path, {"title": "made"} | dict(attributes or {}), channels, groups or {})
    writer.append(along, np.zeros(rows) if angle is None else np.asarray(angle), *blocks)
    return writer.complete([verdict.as_dict() for verdict in verdicts])


def verdict(claim: str, signal: str, worst: float) -> Verdict:
    """The verdict on a claim that a length is not negative."""
    return Verdict(claim, signal, worst > 0.0, 0.0, worst, "m", "m", 0.1, 1.0, 1, sense=1)
