"""Sections of the report: tables of published numbers beside computed ones, read from TOML and CSV.

The rows of a section are those of a `table`, of the chapter's published `numbers`, of `each` combination of
some values, or written out in `rows`. Each column is a `text` or a number that it `computes`, in its `unit`
with its `digits`, beside what is `printed`.
"""

import csv
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from validation.calls import HERE, combined, factor, filled, rows, shown, value
from validation.published import Published

Cell = str | Published
QUANTITY = {
    "computes": "{computes}",
    "printed": "{printed}",
    "unit": "{unit}",
    "digits": "{digits}",
    "criterion": "{criterion}",
    "role": "{role}",
}


@dataclass(frozen=True)
class Row:
    """Cells of a row, and a remark on it."""

    cells: tuple[Cell, ...]
    remark: str = ""


@dataclass(frozen=True)
class Section:
    """A table with its title, an introduction, remarks after it, and its figures.

    With `split` every published number takes three columns, headed "published", "computed" and
    "difference, %"; without it one cell holds all three. The first `labels` columns name a row. `figures` are
    names of image files and their captions.
    """

    title: str
    heads: tuple[str, ...]
    rows: tuple[Row, ...]
    intro: str = ""
    remarks: tuple[str, ...] = ()
    split: bool = True
    labels: int = 1
    figures: tuple[tuple[str, str], ...] = ()

    @property
    def numbers(self) -> list[Published]:
        """Every published number of the table."""
        return [cell for row in self.rows for cell in row.cells if isinstance(cell, Published)]

    def missed(self) -> Iterator[str]:
        """A line for each row with a number that is not reproduced: its label and both values."""
        for row in self.rows:
            label = ", ".join(str(cell) for cell in row.cells[: self.labels])
            if verdicts := self._verdicts(row):
                yield f"{label}: {verdicts}"

    @property
    def _compared(self) -> list[int]:
        """The columns that hold published numbers."""
        places = range(len(self.heads))
        return [k for k in places if any(isinstance(row.cells[k], Published) for row in self.rows)]

    def markdown(self) -> str:
        """The section as text."""
        parts = [f"### {self.title}", self.intro]
        if self._compared and not self.split:
            parts.append("Each cell: published / computed / difference in percent.")
        parts.append(self._table())
        parts.append("\n".join(f"- {remark}" for remark in self.remarks))
        parts.extend(f"![{caption}](validation/{name})\n\n*{caption}.*" for name, caption in self.figures)
        return "\n\n".join(part for part in parts if part)

    def _table(self) -> str:
        heads: list[str] = []
        for index, head in enumerate(self.heads):
            if index in self._compared and self.split:
                prefix = f"{head}: " if head else ""
                heads += [f"{prefix}published", f"{prefix}computed", f"{prefix}difference, %"]
            else:
                heads.append(head)
        rows = [self._cells(row) for row in self.rows]
        if any(row[-1] for row in rows):
            heads.append("remark")
        else:
            rows = [row[:-1] for row in rows]
        lines = [heads, ["---"] * len(heads), *rows]
        return "\n".join("| " + " | ".join(line) + " |" for line in lines)

    def _cells(self, row: Row) -> list[str]:
        """Cells as text, the remark last: what is not reproduced, then the row's own."""
        texts: list[str] = []
        for index, cell in enumerate(row.cells):
            if isinstance(cell, Published):
                texts += cell.cells if self.split else [" / ".join(cell.cells)]
            else:
                texts += ["", cell, ""] if self.split and index in self._compared else [cell]
        missed = self._verdicts(row)
        remarks = [f"not reproduced: {missed}" if missed else "", row.remark]
        return [*texts, "; ".join(part for part in remarks if part)]

    def _verdicts(self, row: Row) -> str:
        """Numbers of a row that are not reproduced, with both values."""
        return "; ".join(
            f"{head}: {cell.verdict}" if head else cell.verdict
            for head, cell in zip(self.heads, row.cells, strict=True)
            if isinstance(cell, Published) and not cell.reproduced
        )


def read(given: dict[str, Any], source: str) -> Section:
    """A section of a chapter; `source` names the chapter's published numbers."""
    labels = given.get("labels", 1)
    columns = [
        {**column, **others} for column in _columns(given) for others in combined(column.get("each", {}))
    ]
    found = [
        Row(_row(columns, row, labels), filled(row.get("remark", ""), row)) for row in _rows(given, source)
    ]
    found += [
        Row(tuple(filled(each) if isinstance(each, str) else _cell(each, {}, "") for each in cells))
        for cells in given.get("rows", ())
    ]
    return Section(
        text(given["title"]),
        tuple(filled(column.get("head", ""), column) for column in columns),
        tuple(found),
        text(given.get("intro", "")),
        tuple(text(each) for each in given.get("remarks", ())),
        given.get("split", True),
        labels,
        tuple((name, caption) for name, caption in given.get("figures", ())),
    )


def text(given: str) -> str:
    """A text of a TOML file in one line, its numbers computed."""
    return filled(" ".join(given.split()))


def _columns(given: dict[str, Any]) -> list[dict[str, Any]]:
    if "numbers" not in given:
        return list(given["columns"])
    label, head = given.get("heads", ("quantity", ""))
    return [{"head": label, "text": "{quantity}"}, {"head": head, **QUANTITY}]


def _rows(given: dict[str, Any], source: str) -> list[dict[str, str]]:
    if "numbers" not in given:
        return rows(given) if "table" in given or "each" in given else []
    with (HERE / "published" / f"{source}.csv").open(newline="", encoding="utf-8") as file:
        return [row for row in csv.DictReader(file) if row["section"] == given["numbers"]]


def _row(columns: list[dict[str, Any]], row: dict[str, str], labels: int) -> tuple[Cell, ...]:
    cells: list[Cell] = []
    for column in columns:
        label = ", ".join(str(cell) for cell in cells[:labels])
        cells.append(_cell(column, row, label))
    return tuple(cells)


def _cell(column: dict[str, Any], row: dict[str, str], label: str) -> Cell:
    """The cell of a column in a row, which its label names among the column's `roles` of some rows."""
    given = {name: filled(str(each), column | row) for name, each in column.items() if name in FIELDS}
    if not given.get("computes"):
        shown_as: dict[str, str] = column.get("names", {})
        return shown_as.get(given.get("text", ""), given.get("text", ""))
    found, unit, digits = value(given["computes"]), given.get("unit", ""), given.get("digits", "")
    if "printed" not in given:
        return shown(found, unit, digits)
    if not given["printed"]:
        return str(column.get("unprinted", "{}")).format(shown(found, unit, digits))
    digits = digits or str(len(given["printed"].partition(".")[2]) + 1)
    role = column.get("roles", {}).get(label, given.get("role") or "computed")
    kind = role.replace("misprint", "").strip() or "computed"
    criterion = given.get("criterion") or "calculation"
    return Published(
        given["printed"], found / factor(unit), int(digits), criterion, kind, role.endswith("misprint")
    )


FIELDS = ("text", "computes", "printed", "unit", "digits", "criterion", "role")
