"""Prepared calls of an FMU's functions: as Python makes them, and as the compiled stepper does."""

import ctypes
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, cast

from .conversions import Linear
from .ports import Port

OK, WARNING, DISCARD, ERROR, FATAL = range(5)  # any other status is a failure, too
PENDING = 5  # of FMI 2.0: it goes on with a step in the background
REFUSED = 1000  # not a status of FMI: a value was not handed over, since it would have become another one

# what a compiled call does, as stepper.c numbers it
VALUES, STEP, SET_3, GET_3, STEP_3, CONVERT, SET_UP, PLAIN = range(8)
# the FMI 3.0 types that differ from the master's own, as stepper.c numbers them
CONVERTED = (
    *("Float32", "Boolean", "Int8", "Int16", "Int64"),
    *("UInt8", "UInt16", "UInt32", "UInt64", "Enumeration"),
)


class Silent(ctypes.Structure):
    """Warnings of a function that came without a message: how many, and the time of the first [s]."""

    _fields_ = (("count", ctypes.c_int64), ("first", ctypes.c_double))

    def note(self, time: float) -> None:
        """Count one more."""
        if not self.count:
            self.first = time
        self.count += 1


class Compiled(ctypes.Structure):
    """A call as the compiled stepper makes it: `struct call` of stepper.c.

    Its addresses belong to what the `arguments` of the same `Call` keep alive.
    """

    _fields_ = (
        ("kind", ctypes.c_int64),
        ("function", ctypes.c_void_p),
        ("instance", ctypes.c_void_p),
        ("references", ctypes.c_void_p),
        ("count", ctypes.c_size_t),
        ("values", ctypes.c_void_p),
        ("masters", ctypes.c_void_p),
        ("type", ctypes.c_int64),
        ("low", ctypes.c_double),
        ("high", ctypes.c_double),
        ("logged", ctypes.c_void_p),
        ("silent", ctypes.c_void_p),
    )


class Rollback(ctypes.Structure):
    """The calls that save and restore a state: `struct rollback` of stepper.c."""

    _fields_ = (
        ("save", ctypes.c_void_p),
        ("restore", ctypes.c_void_p),
        ("instance", ctypes.c_void_p),
        ("state", ctypes.c_void_p),
    )


class Call(NamedTuple):
    """A prepared call.

    `name` is that of the FMU's function; `compiled` the same call for the compiled stepper, None where only
    Python can make it.
    """

    function: Callable[..., int]
    arguments: tuple[Any, ...]
    name: str
    compiled: Compiled | None = None


def converting(conversion: Linear, source: int, values: "ctypes.Array[ctypes.c_double]", place: int) -> Call:
    """Return what converts the number at an address and keeps it at a place among values."""
    here = ctypes.c_double.from_address(source)

    def convert() -> int:
        values[place] = conversion(here.value)
        return OK

    target = ctypes.addressof(values) + place * ctypes.sizeof(ctypes.c_double)
    compiled = Compiled(CONVERT, values=source, masters=target, low=conversion.factor, high=conversion.offset)
    return Call(convert, (), "conversion", compiled)


def address(function: Any) -> int | None:
    """Return the address of a library function's machine code."""
    return ctypes.cast(cast(Any, getattr(function, "plain", function)), ctypes.c_void_p).value


# ---- start values, set in many runs

C_TYPES: dict[str, Any] = {"Real": ctypes.c_double, "Integer": ctypes.c_int32, "Boolean": ctypes.c_int32}


class Setting(NamedTuple):
    """A function that sets the values of one type, and its arguments."""

    function: str
    names: list[str]
    references: Any
    size: ctypes.c_size_t
    values: Any


def settings(ports: Sequence[Port]) -> list[Setting]:
    """The functions that set these variables."""
    chosen = {kind: [port for port in ports if port.kind == kind] for kind in C_TYPES}
    return [_setting(kind, same) for kind, same in chosen.items() if same]


def _setting(kind: str, ports: Sequence[Port]) -> Setting:
    references = (ctypes.c_uint * len(ports))(*(port.reference for port in ports))
    names, values = [port.name for port in ports], (C_TYPES[kind] * len(ports))()
    return Setting(f"Set{kind}", names, references, ctypes.c_size_t(len(ports)), values)
