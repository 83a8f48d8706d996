"""What the command prints of a sweep."""

import sys
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from .. import units
from .ranking import beyond, worst_rows
from .run import Sweep
from .tables import claim_columns, labels_of

SHOWN = 5  # rows of a kind


def show(sweep: Sweep) -> None:
    """Print how many rows hold, the worst of them, and where the results are."""
    before = sweep.rows - sweep.ran
    again = f" ({before} of them run before)" if before else ""
    counts = [f"{sweep.holding} hold", f"{sweep.failing} fail", f"{sweep.errors} could not be run"]
    print(f"{sweep.plan.title}: {sweep.rows} combinations{again}: {', '.join(counts)}")
    _show_worst(sweep)
    _show_texts(sweep, "error", "could not be run", sys.stdout)
    _show_texts(sweep, "warnings", "warned", sys.stderr)
    print(f"table: {sweep.path}")
    if sweep.map is not None:
        print(f"map: {sweep.map}")
    elif sweep.plan.map is not None:
        print(f"no map: no row has a value of {sweep.plan.map.value} there")
    if sweep.traces:
        print(f"traces: {len(sweep.traces)} in {sweep.traces[0].parent}")


def _show_worst(sweep: Sweep) -> None:
    """The rows furthest beyond their bounds, or the nearest to them."""
    rows = worst_rows(sweep.table, SHOWN)
    if not rows:
        return
    table = Table(box=box.SIMPLE_HEAD)
    for heading in ("worst", "row", *(axis.key for axis in sweep.plan.axes), "claim", "value", "bound"):
        table.add_column(heading, overflow="fold")
    claims, labels = beyond(sweep.table).claim, labels_of(sweep.table)
    for row in rows:
        number = int(claims[row])
        holds, worst, bound = (sweep.table[name][row].as_py() for name in claim_columns(number))
        unit = labels[number].unit
        table.add_row(
            "holds" if holds else "[bold red]FAILS[/]", str(row), *_values(sweep, row), labels[number].claim,
            *("-" if value is None else units.show(value, unit) for value in (worst, bound)),
        )  # fmt: skip
    Console(width=None if sys.stdout.isatty() else 150).print(table)


def _values(sweep: Sweep, row: int) -> list[str]:
    """The values of a row on the axes."""
    return [axis.varied.show(sweep.table[axis.key][row].as_py()) for axis in sweep.plan.axes]


def _show_texts(sweep: Sweep, column: str, what: str, stream: Any) -> None:
    """The first of the rows that have a text in a column."""
    texts = sweep.table[column].to_pylist()
    rows = [row for row, text in enumerate(texts) if text is not None]
    for row in rows[:SHOWN]:
        keys = (axis.key for axis in sweep.plan.axes)
        values = ", ".join(f"{key} = {value}" for key, value in zip(keys, _values(sweep, row), strict=True))
        print(f"row {row} {what} ({values}): {texts[row]}", file=stream)
    if len(rows) > SHOWN:
        print(f"and {len(rows) - SHOWN} more rows {what}", file=stream)
