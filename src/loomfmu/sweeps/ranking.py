"""The ranking of rows: the worst, and those that are run again with a full trace."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .tables import claim_columns, labels_of

DIGITS = 6  # that distinguish rows


@dataclass(frozen=True)
class Beyond:
    """The distance of each row beyond the bounds of the claims, and the claim (from 0) that is furthest
    beyond.

    Above 0 the claim fails. 1 is as far as the bound is from 0, the largest one where it differs from row to
    row; for a bound of 0 it is the furthest that any row is away from it, on either side. A claim that fails
    without a value counts as infinitely far, a row that has no result is NaN.
    """

    distance: NDArray[np.float64]
    claim: NDArray[np.int64]


def beyond(table: Any) -> Beyond:
    """Return how far the rows of a sweep's table are beyond the bounds of their claims."""
    claims = len(labels_of(table))
    if not claims:
        return Beyond(np.full(table.num_rows, np.nan), np.zeros(table.num_rows, np.int64))
    all_of_them = _distances(table)
    furthest = np.argmax(np.where(np.isnan(all_of_them), -np.inf, all_of_them), axis=0)
    return Beyond(np.take_along_axis(all_of_them, furthest[np.newaxis], 0)[0], furthest)


def _distances(table: Any) -> NDArray[np.float64]:
    """Return how far each row is beyond the bound of each claim: claims down, rows along.

    They are without the digits that rounding and the length of the steps decide.
    """
    rows = [distance(table, number).tolist() for number in range(len(labels_of(table)))]
    return np.array([[float(f"{value:.{DIGITS}g}") for value in row] for row in rows])


def distance(table: Any, number: int) -> NDArray[np.float64]:
    """Return how far the rows are beyond the bound of one claim, counted from 0; see `Beyond`."""
    holds, worst, bound = (
        table[name].to_numpy() for name in claim_columns(number, "holds", "worst", "bound")
    )
    fails = holds == np.False_  # rows without result are None
    judged = fails | (holds == np.True_)
    away = np.abs(worst - bound)
    scale = _largest(np.abs(bound)) or _largest(away)
    scaled = away / scale if scale > 0.0 else np.where(np.isnan(away), np.nan, 0.0)
    signed = np.where(fails, scaled, -scaled)
    return np.where(judged & np.isnan(signed), np.where(fails, np.inf, -np.inf), signed)


def undecided(table: Any) -> int:
    """In how many rows no claim fails, but one is undecided."""
    open_ones, failing = (np.zeros(table.num_rows, dtype=bool) for _ in range(2))
    for number in range(len(labels_of(table))):
        holds, decided = (table[name].to_numpy() for name in claim_columns(number, "holds", "decided"))
        open_ones |= decided == np.False_  # rows without result are None
        failing |= (holds == np.False_) & (decided != np.False_)
    return int(np.sum(open_ones & ~failing))


def _largest(values: NDArray[np.float64]) -> float:
    return float(np.max(values, initial=0.0, where=np.isfinite(values)))


def worst_rows(table: Any, count: int) -> list[int]:
    """The rows furthest beyond their bounds, or if none is beyond, the nearest to them.

    Rows that are alike in the claim that they are furthest beyond go by their next one, and so on.
    """
    judged = np.flatnonzero(~np.isnan(beyond(table).distance))
    if not len(judged):
        return []
    found = _distances(table)[:, judged]
    by_claim = -np.sort(-np.where(np.isnan(found), -np.inf, found), axis=0)
    return [int(row) for row in judged[np.lexsort(-by_claim[::-1])][:count]]


def traced_rows(table: Any, failures: int, sample: int) -> list[int]:
    """The rows to be run again: the worst of those that fail, and others spread evenly."""
    holds = table["holds"].to_numpy()
    failing = [row for row in worst_rows(table, table.num_rows) if holds[row] == np.False_][:failures]
    others = np.setdiff1d(np.flatnonzero(table["error"].is_null()), failing)
    places = np.linspace(0, len(others) - 1, min(sample, len(others))).round().astype(int)
    return sorted({*failing, *(int(row) for row in others[places])})
