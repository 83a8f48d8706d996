"""Claims that are composed, for C: `master/native/compose.h` has the same structs."""

import ctypes
from collections.abc import Mapping, Sequence
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..fmi.native.libraries import needed_library
from ..traces import Signals
from ..traces.extended import RATE, Resampled
from .claims.claim import Claim
from .claims.judging import run_of
from .master.rows import AskedInC, JudgesInC, Setting, Variable, asked_in_c
from .master.steppers import SOURCE, arrays, fields
from .planning.requested import SHAFT_ANGLE
from .scenes.scene import Scene
from .tangents import Tangents

Floats = NDArray[np.float64]
REAL, WHOLE = 0, 2  # doubles and int64_t, as components with dual numbers have them
SHARE = 1e-12  # of value or bound: what rounding leaves


class _Recorded(ctypes.Structure):
    _fields_ = fields(first="void_p", stride="int64")


class _Moving(ctypes.Structure):
    _fields_ = [
        *fields(asked="int64", held="int64", sign="double", values="void_p", stride="int64"),
        ("recorded", _Recorded),
        *fields(start="double", width="double"),
        *arrays("windows"),
    ]


class _Latch(ctypes.Structure):
    _fields_ = fields(values="void_p", base="int64", sign="double")


class _Image(ctypes.Structure):
    _fields_ = [("to", ctypes.c_void_p), ("from", ctypes.c_void_p), ("size", ctypes.c_size_t)]


TIMES, ROWS = ("times", "new_times", "merged_times"), ("rows", "new_rows", "merged_rows")
DUALS, REALS, MARKS = (
    ("starts", "sizes"),
    ("lowest", "left"),
    ("inside", "may_be", "unsure"),
)
PLACES = (*TIMES, *ROWS, *DUALS, *REALS, *MARKS)
_EXPRESS = ctypes.PYFUNCTYPE(None, ctypes.c_int64)


class _Composed(ctypes.Structure):
    _fields_ = [
        *arrays("images", "motions", "latches", "asked"),
        ("run", _Recorded),
        ("run_angle", _Recorded),
        *fields(tangents="void_p", express="void_p"),
        ("judges", JudgesInC),
        *fields(**dict.fromkeys(PLACES, "void_p")),
        *fields(room="int64", count_column="int64", angle="int64"),
        *fields(count="int64", more="int64", complete="int64", share="double"),
    ]


class Composition:
    """The structs of claims on a run, by their numbers among all that are judged, and the memory for samples.

    It keeps what C has the addresses of: `struct` is the whole, `named` are the questions of rows and the
    parameters in each, by their places.
    """

    def __init__(
        self,
        claims: Mapping[int, Claim],
        tangents: Tangents,
        signals: Sequence[str],
        latches: Mapping[str, tuple[str, float]],
        windows: Mapping[str, Sequence[str]],
        scene: Scene,
        run: Signals,
        room: int,
    ):
        self.tangents, self._places = tangents, {name: place for place, name in enumerate(signals)}
        self._claims, self._latches, self._run, self._room = claims, latches, run, room
        self._memory = _memory(room, len(signals))
        self._held = {name: np.zeros(room) for name in latches}
        self._expressed = list[tuple[Claim, NDArray[Any]]]()
        self._images = list(tangents.images(scene))
        self._kept: list[Any] = []
        angle = run.columns([SHAFT_ANGLE])[1].values if SHAFT_ANGLE in run else np.zeros(len(run.time))
        self.struct = _Composed(
            run=self._recorded(run.columns([])[0].values),
            run_angle=self._recorded(angle),
            angle=self._places.get(SHAFT_ANGLE, -1),
            room=room,
            share=SHARE,
        )
        self._list(
            "images",
            _Image,
            [(to.ctypes.data, start.ctypes.data, to.nbytes) for _n, to, start, _p in self._images],
        )
        self._list("motions", _Moving, self._motions(windows))
        held = [
            (self._held[name].ctypes.data, self._places[base], sign) for name, (base, sign) in latches.items()
        ]
        self._list("latches", _Latch, held)
        for name, each in self._memory.items():
            setattr(self.struct, name, each.ctypes.data)
        self.struct.asked_count = len(claims)

    def placed(self, steps: int, wanted: NDArray[np.bool_]) -> tuple[Resampled, Floats]:
        """Return samples that show the worst values of the wanted claims, and how far these may be off."""
        samples = ctypes.c_int64(len(self._run.time))
        place, express = ctypes.c_void_p(wanted.ctypes.data), _EXPRESS(self._express)
        if self._expressed:
            self.struct.express = ctypes.cast(express, ctypes.c_void_p).value
        with self.tangents.placed() as self.struct.tangents:
            count = _compose()(ctypes.byref(self.struct), ctypes.c_int64(steps), samples, place)
        found: Floats = self._memory["left"][: len(self._claims)]
        return self._samples(count), found

    def _samples(self, count: int) -> Resampled:
        """Return the run with the first samples in memory."""
        made = dict[str, NDArray[Any]]()
        for name, place in self._places.items():
            made[name] = self._memory["rows"][:count, place, 0]
            made[RATE + name] = self._memory["rows"][:count, place, 1]
        made |= {name: values[:count] for name, values in self._held.items()}
        rates = {name: RATE + name for name in self._places}
        return Resampled(self._run, self._memory["times"][:count], made, rates)

    def _express(self, count: int) -> None:
        """Compute the expressions of claims at the first samples in memory."""
        samples = self._samples(count)
        for claim, places in self._expressed:
            for place, (run, name, _sign) in zip(places, claim.motions(samples), strict=True):
                rate = run.rate(name)
                place[:count, 0] = run[name]
                place[:count, 1] = np.nan if rate is None else run[rate]

    def _recorded(self, values: Floats) -> _Recorded:
        self._kept.append(values)
        return _Recorded(values.ctypes.data, values.strides[0] // values.itemsize)

    def _motions(self, windows: Mapping[str, Sequence[str]]) -> list[tuple[Any, ...]]:
        rows, signals = self._memory["rows"], len(self._places)
        found = list[tuple[Any, ...]]()
        for asked, claim in enumerate(self._claims.values()):
            motions = claim.motions(self._run)
            plain = all(name in self._run for _run, name, _sense in motions)
            places = np.zeros((0 if plain else len(motions), self._room, 2))
            if not plain:
                self._expressed.append((claim, places))
            window = getattr(claim, "window", None)
            start, width = (window.start, window.width) if window else (0.0, -1.0)
            for number, (run, name, sense) in enumerate(motions):
                base, sign = self._latches.get(name, (name, sense))
                shown = np.array([self._places[each] for each in windows.get(base, ())], dtype=np.int64)
                self._kept.append(shown)
                values = rows[:, self._places[base]] if plain else places[number]
                recorded = self._recorded(run.columns([name])[1].values)
                stride = signals if plain else 1
                at = (asked, name in self._latches, sign, values.ctypes.data, stride, recorded, start, width)
                found.append((*at, shown.ctypes.data, len(shown)))
        return found

    def _list(self, name: str, kind: Any, content: Sequence[Any]) -> None:
        made = (kind * len(content))(*(each if isinstance(each, kind) else kind(*each) for each in content))
        self._kept.append(made)
        setattr(self.struct, name, ctypes.addressof(made))
        setattr(self.struct, f"{name}_count", len(content))

    # ---- rows

    def ask(self) -> None:
        """Let C judge the claims of rows, too, each on the samples that it placed."""
        samples = self._samples(self._room)
        asked = {number: claim.question(samples) for number, claim in self._claims.items()}
        judging = run_of(samples)
        self.named = [judging.question(samples, each) for each in asked.values()]
        words = [each.words.encode() for each in asked.values()]
        numbers = [each for each, _named in self.named]
        self.struct.judges = JudgesInC(*judging.rules)
        self._list("asked", AskedInC, [asked_in_c(*e) for e in zip(numbers, words, asked, strict=True)])
        self._kept += [judging, words]

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


@cache
def _compose() -> Any:
    function = ctypes.PyDLL(str(needed_library(SOURCE))).compose
    function.restype = ctypes.c_int64
    return function
