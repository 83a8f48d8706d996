"""The table of a sweep for other tools: as CSV, and as a frame of pandas or a dataset of xarray.

The columns of a claim bear its name, where it has one of its own: `the belt does not buckle.distance`.
"""

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..display.printed import as_csv
from ..extras import need
from ..files import Kind
from ..traces.datasets import attributes
from .axes import Axis
from .tables import about_column, column_of, is_number

OTHERS = (".xlsx", ".xls", ".ods", ".tsv", ".txt", ".json", ".parquet", ".h5", ".nc")  # tables, but not ours
COLUMN = re.compile(r"claim_\d+\.(\w+)")


def _is_table(path: Path) -> bool:
    with path.open(encoding="utf-8", errors="replace") as file:
        line = file.readline(100_000).rstrip("\n")
    return line.startswith("row,") and line.endswith(",holds,first_failing_claim,warnings,error")


TABLE = Kind("the table of a sweep", _is_table, (".csv",))


def names(table: Any) -> list[str]:
    """Return the names of the columns, with claims by their own names, as far as no two are the same."""
    found = []
    for name in table.column_names:
        claim, part = about_column(table, name).get("claim"), COLUMN.fullmatch(name)
        found.append(f"{claim}.{part[1]}" if claim and part else name)
    often = Counter(found)
    return [each if often[each] == 1 else name for each, name in zip(found, table.column_names, strict=True)]


def csv(table: Any) -> str:
    """Return the table as CSV: numbers in the units that people read, which the heading names."""
    heading, columns = list[str](), list[Sequence[Any]]()
    for name, column in zip(names(table), table.column_names, strict=True):
        unit = ""
        if is_number(table, column):
            _words, unit, values = column_of(table, column)
            columns.append(["" if value != value else f"{float(value):.15g}" for value in values])
        else:
            columns.append(["" if value is None else value for value in table[column].to_pylist()])
        heading.append(f"{name} [{unit}]" if unit else name)
    return as_csv([heading, *zip(*columns, strict=True)])


def to_pandas(table: Any) -> Any:
    """Return the table as a frame of pandas, in SI. Raises LoomfmuError without the extra `xarray`."""
    need("to_pandas", "xarray")
    return table.rename_columns(names(table)).to_pandas()


def to_xarray(table: Any, axes: Sequence[Axis]) -> Any:
    """Return the table as a dataset of xarray, in SI with units, along the axes of its grid.

    Where it has sampled axes as well, it is along its rows. Raises LoomfmuError as `to_pandas`.
    """
    grid = [axis.key for axis in axes if not axis.sampled]
    along = grid if grid and len(grid) == len(axes) else ["row"]
    found = to_pandas(table).set_index(along).to_xarray()
    for name, column in zip(names(table), table.column_names, strict=True):
        about = about_column(table, column)
        if "unit" in about:
            found[name].attrs |= attributes(about["unit"], about.get("description", ""))
    return found
