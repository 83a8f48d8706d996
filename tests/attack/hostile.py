"""Hostile files: valid ones with seeded random damage, and a reader that may refuse them in one line only."""

import random
import re
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from attack_figures import record

from loomfmu import LoomfmuError
from loomfmu.errors import LONGEST_LINE

HANGS_AFTER = 30  # s: hundreds of times what the slowest file takes, on a busy machine, too
few_and_many = pytest.mark.parametrize("count", [40, pytest.param(4000, marks=pytest.mark.slow)])  # of files

VALUES = (
    "0", "-1", "1e400", "-1e-400", "nan", "inf", "1" * 400, "-" + "9" * 5000, "0x7fffffffffffffff", "1_0",
    "true", '""', '"' + "1" * 1600 + ' x y"', '"1e999 mm"', '"5 kg"', '"\u00b2"', '"\u0663 mm"',
    '"a\\u0000b"', '"\\u001b[1m"', '"\\uffff"', '"' + "a" * 200_000 + '"', '"../../../etc/passwd"',
    '"a\\nb"', "[]", "[[]]", "[" * 3000 + "]" * 3000, "{}", "{a = {b = 1}}", "[1, [2, {}]]", "1979-05-27",
    "07:32:00", '"/dev/zero"', '"*"', '"[[!"', '"(((((((("',
)  # fmt: skip
SNIPPETS = (
    b"\x00", b"\xff\xfe", b"\xef\xbb\xbf", b"\n" * 3000, b"=", b"[", b"]", b'"', b"<", b">", b"&", b"&#0;",
    b"<!--", b"]]>", b"[[claims]]\n", b"[wires]\n", b"a" + b".a" * 3000 + b" = 1\n", b"[" * 3000, b"1" * 5000,
    b"\xc2\xb2", b"/", b"..", b"%00", b"-", b"e", b"0", b"9" * 30, b"<a>" * 3000,
)  # fmt: skip


class Hung(BaseException):
    """A file that is never done with; not an Exception, so that nothing swallows it."""


@contextmanager
def guarded() -> Iterator[None]:
    """End what does not end by itself."""

    def ring(*_: Any) -> None:
        raise Hung

    before = signal.signal(signal.SIGALRM, ring)
    signal.alarm(HANGS_AFTER)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def damaged(content: bytes, chance: random.Random) -> bytes:
    """Some content with a few things cut, doubled, flipped, moved or put in."""
    for _ in range(chance.choice((1, 1, 1, 2, 3, 8))):
        kind = chance.randrange(6)
        at, other = (chance.randrange(len(content) + 1) for _ in range(2))
        low, high = sorted((at, min(len(content), at + chance.choice((1, 2, 10, 100, 1000)))))
        if kind == 0:
            content = content[:low] + content[high:]
        elif kind == 1:
            content = content[:high] + content[low:]
        elif kind == 2 and at < len(content):
            content = content[:at] + bytes([content[at] ^ (1 << chance.randrange(8))]) + content[at + 1 :]
        elif kind == 3:
            content = content[:at] + chance.choice(SNIPPETS) + content[at:]
        elif kind == 4:
            content = content[:other] + content[low:high] + content[other:]
        else:
            content = content[:at] if chance.random() < 0.1 else content
    return content


def revalued(text: str, chance: random.Random) -> str:
    """A text of lines `key = value`, or of attributes, with some values that nobody means."""
    places = list(re.finditer(r'(?<=[=])\s*("[^"\n]*"|[^\s"<>]+)', text))
    chosen = chance.sample(places, min(len(places), chance.choice((1, 1, 2, 4))))
    for place in sorted(chosen, key=lambda each: -each.start()):
        text = f"{text[: place.start(1)]}{chance.choice(VALUES)}{text[place.end(1) :]}"
    return text


def attacked(
    what: str, make: Callable[[random.Random, int], Path], read: Callable[[Path], Any], count: int
) -> None:
    """Read as many files as that. Each one is read, or refused in one line; the figures are recorded."""
    refused = 0
    for number in range(count):
        path = make(random.Random(f"{what} {number}"), number)
        try:
            with guarded():
                read(path)
        except LoomfmuError as error:
            refused += 1
            line = str(error)
            assert line and line.isprintable() and len(line) <= LONGEST_LINE + 100, (what, number, line)
        except (Exception, Hung) as error:
            pytest.fail(f"{what} {number}: {type(error).__name__}: {str(error)[:300]}")
    assert refused > count // 10  # else the damage is none
    record(f"damaged {what}, read", count, refused)
