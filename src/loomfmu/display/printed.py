"""All that is printed: one place where foreign text is made harmless, tables that fit."""

import contextlib
import io
import math
import shutil
import sys
import textwrap
import traceback
import unicodedata
from collections.abc import Iterable, Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR, Decimal, localcontext
from typing import TextIO

from ..errors import LoomfmuError

COLOURS = {"FAILS": "bold red", "undecided": "bold yellow"}  # of verdicts
INDENT = "  "  # of the lines of an entry but the first


def safe(text: object) -> str:
    """A text as one line that a terminal only shows: control and format characters are spelt out.

    Titles, names, log texts and paths may come from anybody. Escape sequences would steer the terminal, and
    marks of writing direction would show something else than what is there.

    >>> safe("margin [/mm]"), safe("a\\x1b[31mb\\nc"), safe("\\u202egnp.exe")
    ('margin [/mm]', 'a\\\\x1b[31mb\\\\nc', '\\\\u202egnp.exe')
    """
    return "".join(
        character.encode("unicode_escape").decode() if _steers(character) else character
        for character in str(text)
    )


def _steers(character: str) -> bool:
    return unicodedata.category(character) in ("Cc", "Cf", "Cs", "Zl", "Zp")


def say(*lines: object, to: TextIO | None = None) -> None:
    """Print lines, on standard output if nothing else is given. The only way to the terminal."""
    stream = sys.stdout if to is None else to
    if stream is None:  # closed by whoever started this process
        return
    encoding = stream.encoding or "utf-8"
    try:
        for line in lines:
            text = safe(line).encode(encoding, "backslashreplace").decode(encoding)
            stream.write(_coloured(text, stream) + "\n")
    except BrokenPipeError:
        raise
    except OSError as error:
        name = "standard output" if to is None else "standard error"
        raise LoomfmuError(f"{name}: {error.strerror}") from None


def complain(*lines: object) -> None:
    """Print lines on standard error."""
    with contextlib.suppress(OSError):  # of a full disk behind it the command itself tells
        if sys.stdout is not None:
            sys.stdout.flush()
    if sys.stderr is not None:
        say(*lines, to=sys.stderr)


def warn(warnings: Iterable[object]) -> None:
    """Print warnings on standard error."""
    complain(*(f"warning: {warning}" for warning in warnings))


def complain_of(error: BaseException) -> None:
    """Print where an exception comes from on standard error."""
    complain(*"".join(traceback.format_exception(error)).splitlines())


def show(
    headings: Sequence[str],
    rows: Sequence[Sequence[str]],
    entries: Sequence[Sequence[str]],
    stacked: bool = False,
    further: bool = False,
) -> None:
    """Print rows below headings if the terminal is wide enough for them, and else entries, given in parts.

    Each part of a `stacked` entry begins a line, unless all fit on one. A `further` table has an empty line
    before it already. Piped, there are 80 columns, unless
    the environment's COLUMNS says otherwise.
    """
    width = shutil.get_terminal_size().columns
    lines = in_columns([[safe(cell) for cell in row] for row in (headings, *rows)])
    if max(map(len, lines)) > width:
        lines = [
            line for entry in entries for line in as_entry([safe(part) for part in entry], width, stacked)
        ]
    say(*([] if further else [""]), *lines, "")


def rounded(value: float, up: bool, digits: int = 10) -> str:
    """Return a number with so many digits, rounded up or down.

    >>> rounded(2 / 3, up=True), rounded(2 / 3, up=False)
    ('0.6666666667', '0.6666666666')
    """
    with localcontext(prec=digits, rounding=ROUND_CEILING if up else ROUND_FLOOR):
        return f"{+Decimal(value):f}"


def digits(value: float, error: float, most: int = 7) -> int:
    """Return the number of digits of a value that its error allows: 1 to `most`, or `most` if unknown.

    Rounding to them moves the value by no more than the error. So a value that is farther from a bound than
    its error is shown on its side of the bound.

    >>> digits(5596.747, 0.5), digits(5.8167, 0.06), digits(0.22556868, 6e-9)
    (4, 2, 7)
    """
    if not (0.0 < error < math.inf and 0.0 < abs(value) < math.inf):
        return most
    last = math.floor(math.log10(2.0 * error))  # the power of ten of the last digit
    return min(max(math.floor(math.log10(abs(value))) - last + 1, 1), most)


def brief(value: float, figures: int, sign: str = "") -> str:
    """Return a number rounded to so many digits, without an exponent up to a million.

    >>> brief(5596.747, 2), brief(12.3456, 4, "+"), brief(-0.0, 7)
    ('5600', '+12.35', '0')
    """
    return f"{float(f'{value:.{figures}g}') + 0.0:{sign}.{max(figures, 7)}g}"  # not -0


def as_csv(rows: Iterable[Sequence[object]]) -> str:
    """Rows as the text of a CSV file."""
    import csv  # few commands write any

    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def in_columns(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows as lines, each column as wide as its longest cell."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [
        "  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows
    ]


def as_entry(parts: Sequence[str], width: int, stacked: bool = False) -> list[str]:
    """The parts of an entry as lines: a part goes on the line before if it fits, and is broken if long.

    Those of a `stacked` entry go on one line, two blanks apart, if all fit.
    """
    if stacked and len(whole := "  ".join(parts)) <= width:
        return [whole]
    lines = [""]
    for part in parts:
        joined = f"{lines[-1]} {part}" if lines[-1] else part
        if len(joined) <= width and not (stacked and lines[-1]):
            lines[-1] = joined
            continue
        first = INDENT if lines[-1] else ""
        broken = textwrap.wrap(
            part,
            width,
            initial_indent=first,
            subsequent_indent=INDENT,
            break_long_words=False,
            break_on_hyphens=False,
        )
        lines = [*filter(None, lines), *broken]
    return lines


def _coloured(line: str, stream: TextIO) -> str:
    """A line in which what does not hold catches the eye, on a terminal."""
    word = next((each for each in COLOURS if line.startswith(f"{each} ")), "")
    if not word or not stream.isatty():
        return line
    from rich.console import Console
    from rich.text import Text

    console = Console(file=stream)
    text = Text.assemble((word, COLOURS[word]), line.removeprefix(word))  # a Text is never read as markup
    with console.capture() as captured:
        console.print(text, soft_wrap=True, end="")
    return captured.get()
