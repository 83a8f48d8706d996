"""Start values: the arguments of FMI 2.0's setters, prepared for many runs."""

import ctypes
from collections.abc import Sequence
from typing import Any, NamedTuple

from .ports import Port

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
