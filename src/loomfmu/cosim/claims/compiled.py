"""A motion between its samples in C, to the same bits: most of what judging would cost in Python."""

import ctypes
from collections.abc import Callable, Sequence
from functools import cache, cached_property
from pathlib import Path
from struct import Struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...fmi.native.libraries import library_of
from ...traces import Column

SOURCE = Path(__file__).with_name("native") / "bernstein.c"
ROOM = 16  # for the crossings of one level, at first
Floats = NDArray[np.float64]
_Size, _Place, _Real = ctypes.c_ssize_t, ctypes.c_void_p, ctypes.c_double
_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {  # results and arguments
    "value_at": (_Real, [_Place, _Real]),
    "reach": (None, [_Place, _Place, _Place]),
    "crossings": (_Size, [_Place, _Place, _Place, _Real, _Place, _Size]),
    "passes": (_Size, [_Place, _Real, _Real, _Place, _Size]),
    "survey": (None, [_Place, _Place]),
}
_MOTION = [Struct(f"{2 + 2 * columns}n") for columns in range(5)]  # `struct motion` of bernstein.c
_Facts, _Times = _Real * 4, _Real * ROOM


class Compiled:
    """A motion of two samples or more, for as long as its arrays are there."""

    def __init__(self, library: Any, columns: Sequence[Column]):
        samples = len(columns[0].values)
        self._library, self._intervals = library, samples - 1
        places = [each for column in columns for each in (column.place, column.values.strides[0])]
        self._motion = _MOTION[len(columns)].pack(samples, len(columns) - 1, *places)

    def at(self, time: float) -> float:
        """Value at a time."""
        return float(self._library.value_at(self._motion, time))

    def survey(self) -> list[float]:
        """Return the numbers of `Survey` in curves.py."""
        facts = _Facts()
        self._library.survey(self._motion, facts)
        return facts[:]

    @cached_property
    def reach(self) -> tuple[Floats, Floats]:
        """Lowest and highest of the points of each interval."""
        lowest, highest = np.empty(self._intervals), np.empty(self._intervals)
        self._library.reach(self._motion, lowest.ctypes.data, highest.ctypes.data)
        return lowest, highest

    @cached_property
    def _reach_places(self) -> tuple[int, int]:
        lowest, highest = self.reach
        return lowest.ctypes.data, highest.ctypes.data

    def crossings(self, level: float) -> list[float]:
        """Times at which the motion passes a level."""
        return _all(self._library.crossings, self._motion, *self._reach_places, level)

    def passes(self, level: float, turn: float) -> list[float]:
        """Times at which it passes a level or one that is whole turns from it."""
        return _all(self._library.passes, self._motion, level, turn)


def _all(function: Callable[..., int], *arguments: Any) -> list[float]:
    """All times that a function finds."""
    times, room = _Times(), ROOM
    while (count := function(*arguments, times, room)) > room:
        times, room = (_Real * count)(), count
    return times[:count]


def compiled(columns: Sequence[Column]) -> Compiled | None:
    """The motion with these times, values and rates; None where there is no library, or no curve."""
    library = _library() if len(columns[0].values) > 1 else None
    return library and Compiled(library, columns)


@cache
def _library() -> Any:
    """The library with the types of its functions, or None."""
    path = library_of(SOURCE)
    if path is None:
        return None
    library = ctypes.PyDLL(str(path))
    for name, (result, arguments) in _FUNCTIONS.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library
