"""What goes wrong by a user's hand: always one line that says what, where and what would be right."""

import difflib
import os
import re
from collections.abc import Iterable, Mapping
from datetime import date, time
from pathlib import Path

MOST_SHOWN = 16  # names that a message lists
MOST_LETTERS = 60  # of a value that a message shows


class LoomfmuError(Exception):
    """Bad input, or an FMU that failed; its text is the one line that a user sees."""


def shown(value: object) -> str:
    """A value in a message: in one line, and not too long.

    >>> shown({"a": 1})
    "{'a': 1}"
    """
    text = " ".join((str(value) if isinstance(value, date | time) else repr(value)).split())
    return text if len(text) <= MOST_LETTERS else f"{text[:MOST_LETTERS]}..."


def path_of(given: object, what: str) -> Path:
    """A path that a caller gave. Raises LoomfmuError for what is none."""
    if not isinstance(given, str | os.PathLike) or "\n" in str(given):
        raise LoomfmuError(f"{what} = {shown(given)} is not a path")
    return Path(given)


def suggestion(name: str, known: Iterable[str], descriptions: Mapping[str, str] | None = None) -> str:
    """The nearest known name as the end of a message, by its spelling or by a word of its description.

    >>> suggestion("sped", ["speed", "angle"])
    "; did you mean 'speed'?"
    >>> suggestion("zeta", ["law", "reduction"], {"reduction": "Share of the speed taken off, zeta"})
    "; did you mean 'reduction'?"
    """
    known = list(known)
    word = re.compile(rf"\b{re.escape(name)}\b", re.IGNORECASE)
    described = [each for each, text in (descriptions or {}).items() if name and word.search(text)]
    # a slip of spelling first, then a word that was meant, then a distant likeness
    near = (
        difflib.get_close_matches(name, known, n=1, cutoff=0.75)
        or described
        or difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    )
    if near:
        return f"; did you mean {near[0]!r}?"
    shown = ", ".join(known[:MOST_SHOWN]) + (", ..." if len(known) > MOST_SHOWN else "")
    return f"; known: {shown}" if known else ""
