"""Tables for people: in columns where these fit the terminal, else an entry of some lines for each row."""

import shutil
import sys
import textwrap
from collections.abc import Sequence

INDENT = "  "  # of the lines of an entry but the first


def show(headings: Sequence[str], rows: Sequence[Sequence[str]], entries: Sequence[Sequence[str]]) -> None:
    """Print rows below headings if the terminal is wide enough for them, and else entries, given in parts.

    Piped, there are 80 columns, unless the environment's COLUMNS says otherwise.
    """
    width = shutil.get_terminal_size().columns
    lines = in_columns([headings, *rows])
    if max(map(len, lines)) > width:
        lines = [line for entry in entries for line in as_entry(entry, width)]
    print()
    for line in lines:
        print(coloured(line))
    print()


def in_columns(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows as lines, each column as wide as its longest cell."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]


def as_entry(parts: Sequence[str], width: int) -> list[str]:
    """The parts of an entry as lines: a part goes on the line before if it fits, and is broken if long."""
    lines = [""]
    for part in parts:
        joined = f"{lines[-1]} {part}" if lines[-1] else part
        if len(joined) <= width:
            lines[-1] = joined
            continue
        first = INDENT if lines[-1] else ""
        broken = textwrap.wrap(
            part, width, initial_indent=first, subsequent_indent=INDENT, break_long_words=False,
            break_on_hyphens=False,
        )  # fmt: skip
        lines = [*filter(None, lines), *broken]
    return lines


def coloured(line: str) -> str:
    """A line in which failing catches the eye, on a terminal."""
    if not line.startswith("FAILS") or not sys.stdout.isatty():
        return line
    from rich.console import Console
    from rich.text import Text

    console = Console()
    with console.capture() as captured:
        console.print(
            Text.assemble(("FAILS", "bold red"), line.removeprefix("FAILS")), soft_wrap=True, end=""
        )
    return captured.get()
