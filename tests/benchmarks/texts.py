"""Numbers, tables and figures of the report."""

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from records import Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Find = Callable[[str], list[Row]]  # rows of a table by its name
Draw = Callable[["Figure"], None]
Figures = dict[str, tuple[str, float, Draw]]  # file -> caption, height in inches, what draws it


def shown(value: Any, digits: int = 3) -> str:
    """A number with that many digits, a text as it is.

    >>> shown(0.012345), shown(1234567.0), shown(-0.5, 1), shown("none"), shown(7.0)
    ('0.0123', '1,234,567', '-0.5', 'none', '7')
    """
    if not isinstance(value, int | float):
        return str(value)
    if abs(value) >= 10 ** (digits - 1) or value == 0:
        return f"{value:,.0f}"
    text = f"{value:.{digits}g}"
    return text if "e" not in text else f"{value:.{digits - 1}e}"


def error(value: Any) -> str:
    """An error with two digits.

    >>> error(3.14159e-7), error(0.0)
    ('3.1e-07', '0')
    """
    return value if isinstance(value, str) else "0" if value == 0 else f"{value:.1e}"


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table in Markdown.

    >>> print(table(["a", "b"], [["1", "2"]]))
    | a | b |
    |---|---|
    | 1 | 2 |
    """
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return "\n".join([*lines, *("| " + " | ".join(row) + " |" for row in rows)])


def whole(found: list[Row]) -> str:
    """A table with all its columns, as they were written."""
    if not found:
        return "*Not run.*"
    return table(list(found[0]), [[shown(cell) for cell in row.values()] for row in found])


def pivot(found: list[Row], row: str, column: str, cell: str, show: Callable[[Any], str] = shown) -> str:
    """One column of a table, spread out: a line for each value of `row`, a column for each of `column`."""
    columns = list(dict.fromkeys(each[column] for each in found))
    values = {(each[row], each[column]): show(each[cell]) for each in found}
    lines = list(dict.fromkeys(each[row] for each in found))
    heads = [row, *map(shown, columns)]
    return table(heads, [[shown(a), *(values.get((a, b), "") for b in columns)] for a in lines])


def only(found: list[Row], **wanted: Any) -> list[Row]:
    """The rows that have these values; `_` stands for a space in a column's name."""
    keys = {key.replace("_", " "): value for key, value in wanted.items()}
    return [row for row in found if all(row[key] == value for key, value in keys.items())]


def parts(*texts: str) -> str:
    """Paragraphs, the empty ones left out."""
    return "\n\n".join(text for text in texts if text)


def items(*lines: str) -> str:
    """A list."""
    return "\n".join(f"- {line}" for line in lines if line)
