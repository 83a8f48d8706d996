"""Errors that a user can make: always one line that says what is wrong, where, and what would be right."""

import errno
import os
import re
import signal
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from datetime import date, time
from pathlib import Path

MOST_SHOWN = 16  # names that a message lists
MOST_LETTERS = 60  # of a value that a message shows
SLIP, DISTANT = 0.85, 0.5  # likeness of two names: one is the other with a letter wrong, or reminds of it
LONGEST_LINE = 2000  # characters of a message
LONGEST_NAME = 1000  # characters of a title, a name or a path
FORBIDDEN = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")  # characters in XML 1.0


def one_line(text: str) -> str:
    """A text as one line that a terminal can show: control characters escaped, the middle of a long one cut.

    >>> one_line("two\\nlines and an \\x1b[1mescape")
    'two\\\\nlines and an \\\\x1b[1mescape'
    """
    if len(text) > LONGEST_LINE:
        text = f"{text[: LONGEST_LINE // 2]} ... {text[-LONGEST_LINE // 2 :]}"
    if text.isprintable():  # as nearly all are
        return text
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


class LoomfmuError(Exception):
    """Bad input, or an FMU that failed; its text is the one line that a user sees."""

    def __init__(self, text: str = ""):
        super().__init__(one_line(text))


@contextmanager
def within(where: object) -> Iterator[None]:
    """Name the place of an error before what it says.

    >>> with within("belt.mass"):
    ...     raise LoomfmuError("-1 kg is not positive")
    Traceback (most recent call last):
    loomfmu.errors.LoomfmuError: belt.mass: -1 kg is not positive
    """
    try:
        yield
    except LoomfmuError as error:
        raise LoomfmuError(f"{where}: {error}") from None


def described(error: BaseException) -> str:
    """The kind of an exception and what it says, which may fail itself, in one line.

    >>> described(ValueError("no"))
    'ValueError: no'
    """
    try:
        text = str(error)
    except Exception:
        text = ""
    return " ".join(f"{type(error).__name__}: {text}".split()).removesuffix(":")


def why(error: OSError) -> str:
    """Return the cause that the system states, and the remedy if one is known.

    >>> why(OSError(28, "No space left on device"))
    'No space left on device'
    """
    said = error.strerror or str(error)
    if error.errno in (errno.EMFILE, errno.ENFILE):
        said += " at the same time; raise the limit, such as with `ulimit -n 1024`"
    return said


def shown(value: object) -> str:
    """A value in a message: in one line, and not too long.

    >>> shown({"a": 1})
    "{'a': 1}"
    """
    try:
        text = " ".join((str(value) if isinstance(value, date | time) else repr(value)).split())
    except (ValueError, RecursionError):  # an integer of thousands of digits, lists thousands deep
        return f"that {type(value).__name__}"
    return text if len(text) <= MOST_LETTERS else f"{text[:MOST_LETTERS]}..."


def check_text(text: str, where: str, most: int = LONGEST_NAME) -> str:
    """A text that goes into traces and packages. Raises LoomfmuError for one that these cannot hold."""
    found = FORBIDDEN.search(text)
    if found:
        raise LoomfmuError(f"{where} contains the control character U+{ord(found[0]):04X}; remove it")
    if len(text) > most:
        raise LoomfmuError(f"{where} has {len(text)} characters; at most {most} are possible")
    return text


def path_of(given: object, what: str) -> Path:
    """A path that a caller gave. Raises LoomfmuError if it is not one."""
    if not isinstance(given, str | os.PathLike) or re.search("[\x00\n]", str(given)):
        raise LoomfmuError(f"{what} = {shown(given)} is not a path")
    return Path(given)


def numbered(names: Sequence[str], numbers: Iterable[int]) -> str:
    """The choices of an enumeration, for a number that is none of theirs.

    >>> numbered(["pinned", "guided"], [1, 2])
    '1 (pinned) or 2 (guided)'
    """
    return listed((f"{number} ({name})" for number, name in zip(numbers, names, strict=True)), "or")


def misspelt(name: str, known: Iterable[str], likeness: float = 0.75) -> list[str]:
    """The known name that differs from this one by a slip of spelling, if there is one."""
    import difflib  # most runs have no such error

    if len(name) > MOST_LETTERS:  # far from any name, and slow to compare
        return []
    return difflib.get_close_matches(name, known, n=1, cutoff=likeness)


def suggestion(name: str, known: Iterable[str], descriptions: Mapping[str, str] | None = None) -> str:
    """The nearest known name as the end of a message, by its spelling or by a word of its description.

    >>> suggestion("sped", ["speed", "angle"])
    "; did you mean 'speed'?"
    >>> suggestion("zeta", ["law", "reduction"], {"reduction": "Share of the speed taken off, zeta"})
    "; did you mean 'reduction'?"
    >>> suggestion("initial_speed", ["point_speed_8", "speed"])
    "; did you mean 'speed'?"
    """
    known = list(known)
    if len(name) > MOST_LETTERS:  # far from any name, and slow to compare
        return ""
    word = re.compile(rf"\b{re.escape(name)}\b", re.IGNORECASE)
    described = [each for each, text in (descriptions or {}).items() if name and word.search(text)]
    words = name.lower().split("_")
    within = [each for each in known if set(each.lower().split("_")) <= set(words)]
    # a slip of spelling first, then a word that was meant, then a distant likeness
    near = (
        misspelt(name, known, SLIP)
        or sorted(within, key=len, reverse=True)
        or misspelt(name, known)
        or described
        or misspelt(name, known, DISTANT)
    )
    if near:
        return f"; did you mean {near[0]!r}?"
    shown = ", ".join(known[:MOST_SHOWN]) + (", ..." if len(known) > MOST_SHOWN else "")
    return f"; known: {shown}" if known else ""


def listed(words: Iterable[object], last: str = "and") -> str:
    """Words as a list in a sentence.

    >>> listed(["a"]), listed(["a", "b"]), listed(["a", "b", "c"], "or")
    ('a', 'a and b', 'a, b or c')
    """
    *first, end = map(str, words)
    return f"{', '.join(first)} {last} {end}" if first else end


def signal_name(number: int) -> str:
    """Return the name of a signal.

    >>> signal_name(11), signal_name(37)
    ('SIGSEGV', 'signal 37')
    """
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"
