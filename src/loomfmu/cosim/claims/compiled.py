"""A motion between its samples in C, to the same bits: most of what judging would cost in Python."""

import ctypes
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from ...fmi.native.libraries import library_of

SOURCE = Path(__file__).with_name("native") / "bernstein.c"
ROOM = 16  # for the crossings of one level, at first
Floats = NDArray[np.float64]
_Four = ctypes.c_ssize_t * 4


class Compiled(ctypes.Structure):
    """`struct motion` of bernstein.c: its addresses belong to the arrays that it was made of."""

    _fields_ = (
        ("samples", ctypes.c_ssize_t),
        ("known", ctypes.c_ssize_t),
        ("columns", _Four),
        ("strides", _Four),
    )

    @classmethod
    def of(cls, time: Floats, values: Sequence[Floats]) -> Self | None:
        """The motion with these values and rates, two samples or more; None where no library is available."""
        if _library() is None:
            return None
        arrays = (time, *values)
        places = [array.ctypes.data for array in arrays]
        return cls(len(time), len(values), _Four(*places), _Four(*[array.strides[0] for array in arrays]))

    def finite(self) -> bool:
        """Whether all values and rates are finite."""
        return bool(_library().finite(self))

    def at(self, time: float) -> float:
        """Value at a time."""
        return float(_library().value_at(self, time))

    def crossings(self, level: float, first: int, end: int) -> list[float]:
        """Times in some intervals at which the motion passes a level."""
        count = room = ROOM
        while True:
            times = (ctypes.c_double * room)()
            count = _library().crossings(self, level, first, end, times, room)
            if count <= room:
                return times[:count]
            room = count


@cache
def _library() -> Any:
    """The library with the types of its functions, or None."""
    path = library_of(SOURCE)
    if path is None:
        return None
    library = ctypes.PyDLL(str(path))
    size, motion = ctypes.c_ssize_t, ctypes.POINTER(Compiled)
    types: dict[str, tuple[Any, list[Any]]] = {
        "finite": (ctypes.c_bool, [motion]),
        "value_at": (ctypes.c_double, [motion, ctypes.c_double]),
        "crossings": (size, [motion, ctypes.c_double, size, size, ctypes.c_void_p, size]),
    }
    for name, (result, arguments) in types.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library
