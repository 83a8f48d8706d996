"""The messages between the master and the process of an isolated FMU.

A message is its length in four bytes and its content. The master sends `CALLS` and the numbers of prepared
calls, or a pickled method with its arguments; the answer is `DONE`, or a pickled `Answer`. Values do not go
through the pipes: both sides have them in shared memory.
"""

import os
from typing import Any, NamedTuple

CALLS = b"\0"  # what no pickle begins with
DONE = b"\0"
# the shared memory begins with these: time and size of a step [s], and the place of the call under way
TIME, SIZE, PLACE, VALUES = 0, 8, 16, 24
PART = 65536  # bytes that are read at a time


class Answer(NamedTuple):
    """The value of a method or what it raised, the FMU's messages and warnings without one, whether it failed
    fatally."""

    value: Any
    error: Exception | None
    messages: list[tuple[int, str]]
    silent: dict[str, tuple[int, float]]
    fatal: bool


def framed(content: bytes) -> bytes:
    """A message."""
    return len(content).to_bytes(4, "little") + content


def complete(data: bytes) -> bool:
    """Return whether the bytes read so far are a whole message."""
    return len(data) >= 4 and len(data) >= 4 + int.from_bytes(data[:4], "little")


def write(pipe: int, message: bytes) -> None:
    """Write a message."""
    while message:
        message = message[os.write(pipe, message) :]
