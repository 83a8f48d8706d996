"""The state of a live FMU as bytes, refused where they are damaged. Copied into the FMU beside its slave.

Layout, little-endian: the GUID, the place of the mode in `MODES`, the time, whether the start must be
computed anew, all variables in the order of their references, the text of a failure, a CRC-32 of all that.
"""

import struct
from collections.abc import Mapping
from typing import Any, NamedTuple
from zlib import crc32

INSTANTIATED, INITIALIZING, STEPPING = MODES = ("instantiated", "initialization mode", "step mode")
LONGEST = 1e15  # s: no angle that anybody turns through in that time overflows
LONGEST_TEXT = 60000
FORMATS = {"Real": "d", "Integer": "q", "Boolean": "?"}


class Row(NamedTuple):
    """One variable."""

    name: str
    kind: str
    causality: str
    low: float
    high: float
    display: str
    factor: float


class State(NamedTuple):
    """All that a host saves and restores."""

    guid: str
    mode: str
    time: float
    stale: bool
    failure: str
    values: tuple[Any, ...]


def _layout(rows: Mapping[int, Row]) -> struct.Struct:
    return struct.Struct("<36sBd?" + "".join(FORMATS[row.kind] for row in rows.values()))


def to_bytes(rows: Mapping[int, Row], state: State) -> bytes:
    """The state as bytes; none of one with an integer beyond 64 bits."""
    head = (state.guid.encode(), MODES.index(state.mode), state.time, state.stale)
    try:
        body = _layout(rows).pack(*head, *state.values) + state.failure.encode()[:LONGEST_TEXT]
    except struct.error:
        return b""
    return body + crc32(body).to_bytes(4, "little")


def from_bytes(rows: Mapping[int, Row], guid: str, data: bytes) -> State | None:
    """The state that bytes hold; None if they are damaged, of another FMU, or beyond a variable's limits."""
    layout, body = _layout(rows), data[:-4]
    if len(body) < layout.size or crc32(body).to_bytes(4, "little") != data[-4:]:
        return None
    owner, mode, time, stale, *values = layout.unpack_from(body)
    possible = all(row.low <= value <= row.high for row, value in zip(rows.values(), values, strict=True))
    if owner != guid.encode() or mode >= len(MODES) or not abs(time) <= LONGEST or not possible:
        return None
    return State(guid, MODES[mode], time, stale, body[layout.size :].decode(errors="replace"), tuple(values))
