"""Claims that are composed, for rows in C: `master/native/compose.h` has the same structs."""

import ctypes
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..traces import Recording
from ..traces.extended import RATE, Resampled
from .claims.claim import Claim
from .claims.judging import run_of
from .master.rows import AskedInC, JudgesInC, Setting, Variable, asked_in_c
from .master.steppers import arrays, fields
from .scenes.scene import Scene
from .tangents import Tangents

Floats = NDArray[np.float64]
REAL, WHOLE = 0, 2  # doubles and int64_t, as components with dual numbers have them


class Rule(NamedTuple):
    """The numbers by which steps are divided, see composed.py."""

    parts: int
    rounds: int
    doubt: float
    narrow: float
    exact: float
    rounded: float
    share: float


class _Moving(ctypes.Structure):
    _fields_ = [
        *fields(asked="int64", base="int64", held="int64", sign="double", recorded="int64"),
        *arrays("windows"),
    ]


class _Latch(ctypes.Structure):
    _fields_ = fields(values="void_p", base="int64", sign="double")


class _Image(ctypes.Structure):
    _fields_ = [("to", ctypes.c_void_p), ("from", ctypes.c_void_p), ("size", ctypes.c_size_t)]


TIMES, ROWS = ("times", "new_times", "merged_times"), ("rows", "new_rows", "merged_rows")
DUALS, REALS, MARKS = ("starts", "sizes"), ("lowest", "left"), ("doubtful", "own", "inside", "may_be")
PLACES = (*TIMES, *ROWS, *DUALS, *REALS, *MARKS)


class _Composed(ctypes.Structure):
    _fields_ = [
        *arrays("images", "motions", "latches", "asked"),
        *fields(tangents="void_p"),
        ("judges", JudgesInC),
        *fields(**dict.fromkeys(PLACES, "void_p")),
        *fields(room="int64", count_column="int64", parts="int64", rounds="int64"),
        *fields(doubt="double", narrow="double", exact="double", rounded="double", share="double"),
    ]


class Composition:
    """The structs of claims, by their numbers among all that are judged.

    It keeps what C has the addresses of: `struct` is the whole, `named` are the questions and
    the parameters in each, by their places.
    """

    def __init__(
        self,
        claims: Mapping[int, Claim],
        tangents: Tangents,
        signals: Sequence[str],
        latches: Mapping[str, tuple[str, float]],
        windows: Mapping[str, Sequence[str]],
        rule: Rule,
        scene: Scene,
        run: Recording,
        room: int,
    ):
        self.tangents, self._places = tangents, {name: place for place, name in enumerate(signals)}
        self._memory = _memory(room, len(signals))
        self._held = {name: np.zeros(room) for name in latches}
        made = {name: self._memory["rows"][:, place, 0] for place, name in enumerate(signals)}
        rates = {name: RATE + name for name in made}
        made |= {rates[name]: self._memory["rows"][:, place, 1] for name, place in self._places.items()}
        self._samples = Resampled(run, self._memory["times"], made | self._held, rates)
        asked = {number: claim.question(self._samples) for number, claim in claims.items()}
        judging = run_of(self._samples)
        self.named = [judging.question(self._samples, each) for each in asked.values()]
        words = [each.words.encode() for each in asked.values()]
        self._images = list(tangents.images(scene))
        self.struct = _Composed(judges=JudgesInC(*judging.rules), room=room, **rule._asdict())
        self._kept: list[Any] = [judging, words]
        self._list(
            "images",
            _Image,
            [(to.ctypes.data, start.ctypes.data, to.nbytes) for _n, to, start, _p in self._images],
        )
        self._list("motions", _Moving, self._motions(claims, latches, windows, run))
        held = [
            (self._held[name].ctypes.data, self._places[base], sign) for name, (base, sign) in latches.items()
        ]
        self._list("latches", _Latch, held)
        numbers = [each for each, _named in self.named]
        given = [asked_in_c(*each) for each in zip(numbers, words, asked, strict=True)]
        self._list("asked", AskedInC, given)
        for name, each in self._memory.items():
            setattr(self.struct, name, each.ctypes.data)

    def _motions(
        self,
        claims: Mapping[int, Claim],
        latches: Mapping[str, tuple[str, float]],
        windows: Mapping[str, Sequence[str]],
        run: Recording,
    ) -> list[tuple[Any, ...]]:
        found = list[tuple[Any, ...]]()
        for place, claim in enumerate(claims.values()):
            for name, sense in claim.extremes():
                base, sign = latches.get(name, (name, sense))
                shown = np.array([self._places[each] for each in windows.get(base, ())], dtype=np.int64)
                self._kept.append(shown)
                held, column = name in latches, run.column(name)
                found.append((place, self._places[base], held, sign, column, shown.ctypes.data, len(shown)))
        return found

    def _list(self, name: str, kind: Any, content: Sequence[Any]) -> None:
        made = (kind * len(content))(*(each if isinstance(each, kind) else kind(*each) for each in content))
        self._kept.append(made)
        setattr(self.struct, name, ctypes.addressof(made))
        setattr(self.struct, f"{name}_count", len(content))

    def settings(self, takers: Mapping[Variable, int]) -> list[Setting]:
        """Return where the numbers of a row go: into the components at their start."""
        found = []
        for name, memory, start, places in self._images:
            for (owner, variable), column in takers.items():
                if owner == name and variable in places:
                    offset = places[variable] - memory.ctypes.data
                    whole = WHOLE if self.tangents.is_whole(name, variable) else REAL
                    found.append((start.ctypes.data + offset, column, whole))
        return found


def _memory(room: int, signals: int) -> dict[str, NDArray[Any]]:
    """The arrays that C fills, by the names of their places."""
    found: dict[str, NDArray[Any]] = {name: np.zeros(room) for name in (*TIMES, *REALS)}
    found |= {name: np.zeros((room, signals, 2)) for name in ROWS}
    found |= {name: np.zeros((room, 2)) for name in DUALS}
    found |= {name: np.zeros(room, dtype=np.uint8) for name in MARKS}
    return {name: found[name] for name in PLACES}
