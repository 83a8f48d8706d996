"""Conditions on signals, such as `heald_1.lift > 40 mm`, and the spans of shaft angle that meet them."""

import operator
import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import units
from ..errors import LoomfmuError, shown, within

Floats = NDArray[np.float64]

COMPARISONS = {">=": operator.ge, "<=": operator.le, ">": operator.gt, "<": operator.lt}
CONDITION = re.compile(r"\s*(\S+?)\s*(>=|<=|>|<)\s*(.+?)\s*")


def angles_where(run: Any, condition: str) -> Floats:
    """Return the spans of angle as `Signals.angles_where` of a `run`, which lists the errors."""
    match = CONDITION.fullmatch(condition) if isinstance(condition, str) else None
    if match is None:
        raise LoomfmuError(
            f"the condition {shown(condition)} is not a signal, <, <=, > or >=, and a number with its unit,"
            ' such as "heald_1.lift > 40 mm"'
        )
    if not run.turns:
        raise LoomfmuError(f"{run.name}: {run.standing}, so there are no angles")
    signal, comparison, quantity = match.groups()
    values = run[signal]
    with within(f"the condition {shown(condition)}"):
        bound = units.parse(quantity, run.unit(signal))
    if bound and run.unit(signal) != "1" and units.is_plain(quantity):
        meant = f"{signal} {comparison} {quantity} {run.displayed(signal)[1]}"
        raise LoomfmuError(f'the condition {shown(condition)}: {quantity} has no unit; write "{meant}"')
    met = COMPARISONS[comparison](values, bound)
    smooth = np.isfinite(values) if values.dtype.kind == "f" else np.zeros(len(values), dtype=bool)
    if known := run.validity(signal):
        valid = np.asarray(run[known], dtype=bool)
        met, smooth = met & valid, smooth & valid
    return _spans(np.degrees(run.shaft_angle), np.asarray(values, dtype=float) - bound, met, smooth)


def _spans(angle: Floats, beyond: Floats, met: NDArray[np.bool_], smooth: NDArray[np.bool_]) -> Floats:
    """Begin and end of each stretch of samples that meet a condition.

    Between two `smooth` samples it is where the line between them crosses 0; else a sample holds until the
    next.
    """
    before = np.flatnonzero(met[1:] != met[:-1])
    after = before + 1
    line = smooth[before] & smooth[after]
    share = np.ones(len(before))
    share[line] = beyond[before[line]] / (beyond[before[line]] - beyond[after[line]])
    edges = list(angle[before] + share * (angle[after] - angle[before]))
    if met[0]:
        edges.insert(0, angle[0])
    if met[-1]:
        edges.append(angle[-1])
    return np.reshape(edges, (-1, 2)).astype(float)
