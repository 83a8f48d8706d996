"""Values as sets of the names that they may depend on, and the places where they stand."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Union

Names = frozenset[str]
Value = Union[Names, tuple["Value", ...], "Record"]  # of a list: all that is in it
Places = dict[str, Value]  # the locals, and the component's variables, which begin with a dot
NONE: Names = frozenset()


@dataclass(frozen=True)
class Record:
    """A record, field by field."""

    names: tuple[str, ...]
    values: tuple[Value, ...]


def flat(value: Value) -> Names:
    """All that a value depends on."""
    if isinstance(value, frozenset):
        return value
    return NONE.union(*map(flat, value.values if isinstance(value, Record) else value))


def joined(one: Value, other: Value) -> Value:
    """A value that is one or the other."""
    if one == other:
        return one
    if isinstance(one, Record) and isinstance(other, Record) and one.names == other.names:
        return Record(one.names, tuple(map(joined, one.values, other.values)))
    if isinstance(one, tuple) and isinstance(other, tuple) and len(one) == len(other):
        return tuple(map(joined, one, other))
    return flat(one) | flat(other)


def under(value: Value, condition: Names) -> Value:
    """A value that is there under a condition."""
    if isinstance(value, frozenset):
        return value | condition
    if isinstance(value, Record):
        return Record(value.names, tuple(under(each, condition) for each in value.values))
    return tuple(under(each, condition) for each in value)


def together(ways: Sequence[Places]) -> Places:
    """The places after one of several ways."""
    found = dict(ways[0])
    for way in ways[1:]:
        for name, value in way.items():
            found[name] = joined(found[name], value) if name in found else value
    return found
