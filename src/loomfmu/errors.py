"""What goes wrong by a user's hand: always one line that says what, where and what would be right."""

import difflib
from collections.abc import Iterable

MOST_SHOWN = 16  # names that a message lists


class LoomfmuError(Exception):
    """Bad input, or an FMU that failed; its text is the one line that a user sees."""


def suggestion(name: str, known: Iterable[str]) -> str:
    """The nearest known name as the end of a message.

    >>> suggestion("sped", ["speed", "angle"])
    "; did you mean 'speed'?"
    """
    known = list(known)
    near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    if near:
        return f"; did you mean {near[0]!r}?"
    shown = ", ".join(known[:MOST_SHOWN]) + (", .." if len(known) > MOST_SHOWN else "")
    return f"; known: {shown}" if known else ""
