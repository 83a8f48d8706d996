"""The lines that the command prints about a sweep."""

import sys
from typing import Any

from .. import units
from ..display import printed
from ..display.printed import say
from ..errors import listed
from ..traces.verdict import FAILS, HOLDS, UNDECIDED
from .indices import WORDS, Influences
from .ranking import beyond, worst_rows
from .run import Sweep
from .store import INDICES_FILE
from .tables import claim_columns, labels_of

SHOWN = 5  # rows of a kind


def show(sweep: Sweep) -> None:
    """Print how many rows hold, the worst of them, and where the results are."""
    before = sweep.rows - sweep.ran
    again = f" ({before} run before)" if before else ""
    counts = [f"{sweep.holding} hold", f"{sweep.failing} fail"]
    counts += [f"{sweep.undecided} undecided"] * bool(sweep.undecided)
    counts += [f"{sweep.errors} could not be run"] * bool(sweep.errors)
    say(f"{sweep.plan.title}: {sweep.rows} combinations{again}: {listed(counts)}")
    if sweep.sensitivity is None:
        _show_worst(sweep)
    _show_texts(sweep, "error", "could not be run", sys.stdout)
    _show_texts(sweep, "warnings", "warned", sys.stderr)
    if sweep.sensitivity is not None:
        _show_indices(sweep.sensitivity)
    say(f"table: {sweep.path}")
    if sweep.map is not None:
        say(f"map: {sweep.map}")
    elif sweep.plan.map is not None:
        say(f"no map: no row has a value of {sweep.plan.map.value} there")
    if sweep.traces:
        say(f"traces: {len(sweep.traces)} in {sweep.traces[0].parent}")
    for row, reason in list(sweep.untraced.items())[:SHOWN]:
        say(f"row {row} has no trace: {reason}", to=sys.stderr)
    if len(sweep.untraced) > SHOWN:
        say(f"and {len(sweep.untraced) - SHOWN} more rows have no trace", to=sys.stderr)


def _show_indices(found: Influences) -> None:
    """Print how much each output depends on each range."""
    rows = found.brief
    printed.show(("output", found.lead), rows, [(f"{output}:", cells) for output, cells in rows])
    say(f"{found.lead}: {WORDS[found.lead]}, with its 95 % interval; all indices are in {INDICES_FILE}")
    for key in found.idle:
        say(f"{key} changes none of these outputs.")


def _show_worst(sweep: Sweep) -> None:
    """The rows furthest beyond their bounds, or the nearest to them."""
    rows = worst_rows(sweep.table, SHOWN)
    if not rows:
        return
    headings = ("worst", "row", *(axis.key for axis in sweep.plan.axes), "claim", "value", "bound", "note")
    table, entries = [], []
    claims, labels = beyond(sweep.table).claim, labels_of(sweep.table)
    for row in rows:
        number = int(claims[row])
        names = claim_columns(number, "holds", "worst", "bound", "decided", "note")
        holds, worst, bound, decided, note = (sweep.table[name][row].as_py() for name in names)
        word, claim = HOLDS if holds else FAILS if decided else UNDECIDED, labels[number].claim
        shown = [
            "-" if value is None else units.show(value, labels[number].display_unit)
            for value in (worst, bound)
        ]
        table.append((word, str(row), *_values(sweep, row), claim, *shown, note or ""))
        entry = f"{word}  row {row} ({_described(sweep, row)})", f"{claim} {shown[0]}, bound {shown[1]}"
        entries.append((*entry, f"({note})") if note else entry)
    if not any(line[-1] for line in table):
        headings, table = headings[:-1], [line[:-1] for line in table]
    printed.show(headings, table, entries)


def _values(sweep: Sweep, row: int) -> list[str]:
    """The values of a row on the axes."""
    return [axis.varied.show(sweep.table[axis.key][row].as_py()) for axis in sweep.plan.axes]


def _described(sweep: Sweep, row: int) -> str:
    """A row by its values on the axes."""
    keys = (axis.key for axis in sweep.plan.axes)
    return ", ".join(f"{key} = {value}" for key, value in zip(keys, _values(sweep, row), strict=True))


def _show_texts(sweep: Sweep, column: str, what: str, stream: Any) -> None:
    """The first of the rows that have a text in a column."""
    texts = sweep.table[column].to_pylist()
    rows = [row for row, text in enumerate(texts) if text is not None]
    for row in rows[:SHOWN]:
        say(f"row {row} {what} ({_described(sweep, row)}): {texts[row]}", to=stream)
    if len(rows) > SHOWN:
        say(f"and {len(rows) - SHOWN} more rows {what}", to=stream)
