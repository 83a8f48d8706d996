"""Rows: one run again and again in C, with other start values; `native/rows.h` has the same structs."""

import ctypes
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...fmi.native.libraries import needed_library
from ..importing.calls import Compiled
from ..importing.slave import Slave
from .master import PATIENCE, Interrupted, Master
from .steppers import SOURCE, Action, arrays, fields

Floats = NDArray[np.float64]
Variable = tuple[str, str]  # an instance, and one of its variables
Setting = tuple[
    int, int, int
]  # a place, the column that it takes, 0 for a double or the kind of whole number
MOST, FIRST = 4096, 16  # rows that are handed over at once
ROOM = 1 << 20  # bytes for the notes of these rows


def parts_of(signal: str) -> Variable:
    """Return the instance and the variable that a signal or a parameter names."""
    instance, _, variable = signal.partition(".")
    return instance, variable


class Judging(NamedTuple):
    """The functions of the rules and their run; questions, each with its words and the number of its verdict.

    `copies` are the arrays from which the rules read signals that are not real numbers. `verdicts` is the
    number of verdicts, the composed ones included; `composed` is the address of their struct, or None.
    """

    rules: tuple[int, ...]
    questions: Sequence[tuple[Any, bytes, int]]
    copies: Mapping[str, Floats]
    verdicts: int
    composed: int | None


@dataclass(frozen=True)
class Varied:
    """The columns of the numbers that differ from row to row, by the variables that take them.

    `others` are further places that take numbers, `step` is the column of the step size, if it differs, and
    `reached` are the instances that the values reach: the others run once.
    """

    variables: Mapping[Variable, int]
    others: Sequence[Setting]
    step: int | None
    reached: Collection[str]


class Judged(NamedTuple):
    """The findings on rows: whether they were clean, the numbers of their verdicts, notes by row and verdict.

    `fastest` has the highest speed of each angle in any step, `reals` and `integers` the values at the end.
    """

    clean: NDArray[np.bool_]
    verdicts: Floats
    notes: dict[tuple[int, int], str]
    fastest: Floats
    reals: Floats
    integers: NDArray[np.int32]


class _Calls(ctypes.Structure):
    _fields_ = arrays("calls")


class _Way(ctypes.Structure):
    _fields_ = [(name, _Calls) for name in ("prepare", "start", "step", "end")]


class _Setting(ctypes.Structure):
    _fields_ = fields(to="void_p", column="int64", whole="int64")


class _Shaft(ctypes.Structure):
    _fields_ = fields(
        angle="int64", velocity="int64", acceleration="int64", speed="double", start_angle="double"
    )


class _Copied(ctypes.Structure):
    _fields_ = fields(place="int64", to="void_p", boolean="int64")


class AskedInC(ctypes.Structure):
    """A question for C."""

    _fields_ = fields(list="void_p", words="char_p", number="int64")


def asked_in_c(numbers: Any, words: bytes, number: int) -> AskedInC:
    """Return a question for C; whoever asks keeps its numbers and words."""
    return AskedInC(ctypes.addressof(numbers), words, number)


class JudgesInC(ctypes.Structure):
    """The functions of the rules, and their run, for C."""

    _fields_ = fields(judge="void_p", settle="void_p", renew="void_p", note="void_p", run="void_p")


LISTS = ("settings", "shafts", "copies", "asked", "angles", "heard")
VALUES = ("kept_reals", "kept_integers", "driven_reals", "driven_integers", "reals", "integers")
PLACES = ("interrupted", "experiment", "starts", "sizes", "times")
SAMPLES = ("driven_real_rows", "driven_integer_rows", "real_rows", "integer_rows")


class _Rows(ctypes.Structure):
    _fields_ = [
        ("whole", _Way),
        ("reached", _Way),
        *arrays(*LISTS, *VALUES),
        ("judges", JudgesInC),
        *fields(composed="void_p", verdicts="int64"),
        *fields(**dict.fromkeys((*PLACES, *SAMPLES), "void_p")),
        *fields(steps="int64", step_column="int64", warm="int64"),
    ]


class _Found(ctypes.Structure):
    _fields_ = fields(
        clean="void_p",
        exact="void_p",
        verdicts="void_p",
        fastest="void_p",
        reals="void_p",
        integers="void_p",
        notes="void_p",
        texts="void_p",
        room="int64",
        used="int64",
    )


class RowRunner:
    """Runs and judges rows with the instances of an initialized master, on its grid.

    `samples` is where the values of the row under way are: times, reals and integers, for who judges them.
    """

    def __init__(self, master: Master):
        self._master, self._signals = master, master.signals
        grid, signals = master.grid, master.signals
        span = grid.span(0, grid.steps)
        self._span = [np.array(each) for each in (span.starts, span.sizes, [grid.start, *span.ends])]
        start, steps = signals.driven(np.zeros(1)), signals.driven(span.turns)
        self._driven = (
            np.concatenate([start.reals, steps.reals]),
            np.concatenate([start.integers, steps.integers]),
        )
        size = grid.steps + 1
        self._blocks = (
            np.zeros((size, len(signals.reals))),
            np.zeros((size, len(signals.integers)), dtype=np.int32),
        )
        self.samples = (self._span[2], *self._blocks)
        self._experiment = np.array([grid.start, grid.stop_time])
        self._kept: list[Any] = []  # what C has the addresses of
        self._library = ctypes.PyDLL(str(needed_library(SOURCE)))
        self._library.run_rows.restype = ctypes.c_int64

    def prepare(self, judging: Judging, varied: Varied, angles: Sequence[str]) -> None:
        """Fill the structs for rows in which these values differ; `angles` are the signals to watch."""
        master, signals = self._master, self._signals
        self._angles, self._verdicts = len(angles), judging.verdicts
        self._calls = {name: self._calls_of(name, slave) for name, slave in master.slaves.items()}
        others = [name for name in master.slaves if name not in varied.reached]
        kept = [slot for (name, _variable), slot in master.slots.items() if name in others]
        shafts = (_Shaft * len(signals.shafts))(*self._shafts())
        rows = _Rows(
            whole=self._way(master.slaves),
            reached=self._way(name for name in master.slaves if name in varied.reached),
        )
        self._kept.append(judging)
        self._list(rows, "shafts", shafts)
        self._list(rows, "settings", self._settings(varied, shafts))
        self._list(rows, "copies", self._copies(judging.copies))
        asked = [asked_in_c(*each) for each in judging.questions]
        self._list(rows, "asked", (AskedInC * len(asked))(*asked))
        heard = [ctypes.addressof(slave.heard) for slave in master.slaves.values()]
        self._list(rows, "heard", (ctypes.c_void_p * len(heard))(*heard))
        self._list(rows, "angles", _places(master.slots[parts_of(signal)][1] for signal in angles))
        for real, name in ((True, "reals"), (False, "integers")):
            places = _places(slot for kind, slot in kept if (kind == "Real") is real)
            self._list(rows, f"kept_{name}", places)
            self._list(rows, f"driven_{name}", _places(signals.driven_slots(real=real)))
            self._list(rows, name, getattr(signals, name))
        rows.judges = JudgesInC(*judging.rules)
        rows.composed, rows.verdicts = judging.composed, judging.verdicts
        rows.interrupted = ctypes.addressof(master.interrupted)
        memory: list[NDArray[Any]] = [self._experiment, *self._span, *self._driven, *self._blocks]
        for name, each in zip((*PLACES[1:], *SAMPLES), memory, strict=True):
            setattr(rows, name, each.ctypes.data)
        rows.steps = master.grid.steps
        rows.step_column = -1 if varied.step is None else varied.step
        self._rows = rows

    def _list(self, rows: _Rows, name: str, content: Any) -> None:
        """Let a list of the struct be an array."""
        self._kept.append(content)
        place = content.ctypes.data if isinstance(content, np.ndarray) else ctypes.addressof(content)
        setattr(rows, name, place)
        setattr(rows, f"{name}_count", len(content))

    def _calls_of(self, name: str, slave: Slave) -> tuple[list[Compiled], ...]:
        """The calls that prepare, start, step and end an instance."""
        inputs, outputs = ([_compiled(each) for each in made[name]] for made in self._master.value_calls)
        step = [_compiled(Action(slave, slave.step_call(ctypes.c_double(), ctypes.c_double())))]
        values = self._master.scene.instances[name].values
        prepare = slave.start_calls(tuple(values), self._experiment.ctypes.data)
        leave, reset = slave.plain_call("ExitInitializationMode"), slave.plain_call("Reset")
        return prepare, [*inputs, leave, *outputs], [*inputs, *step, *outputs], [reset]

    def _way(self, names: Iterable[str]) -> _Way:
        parts = zip(*(self._calls[name] for name in names), strict=True)
        found = [[call for calls in part for call in calls] for part in parts] or [[]] * 4
        made = [(Compiled * len(each))(*each) for each in found]
        self._kept += made
        return _Way(*((ctypes.addressof(each), len(each)) for each in made))

    def _shafts(self) -> Iterable[_Shaft]:
        slots = self._master.slots
        for name, shaft in self._signals.shafts.items():
            places = (slots[name, each][1] for each in ("angle", "velocity", "acceleration"))
            yield _Shaft(*places, shaft.speed, shaft.start_angle)

    def _settings(self, varied: Varied, shafts: Any) -> Any:
        """Return where the numbers of a row go."""
        slaves, found = self._master.slaves, list[Setting](varied.others)
        for (name, variable), column in varied.variables.items():
            places = slaves[name].places_of(variable) if name in slaves else []
            found += [(place, column, int(whole)) for place, whole in places]
        for shaft, name in zip(shafts, self._signals.shafts, strict=True):
            for variable in ("speed", "start_angle"):
                if (name, variable) in varied.variables:
                    place = ctypes.addressof(shaft) + getattr(_Shaft, variable).offset
                    found.append((place, varied.variables[name, variable], 0))
        return (_Setting * len(found))(*(_Setting(*each) for each in found))

    def _copies(self, copies: Mapping[str, Floats]) -> Any:
        found = []
        for signal, values in copies.items():
            kind, slot = self._master.slots[parts_of(signal)]
            found.append(_Copied(slot, values.ctypes.data, kind == "Boolean"))
        return (_Copied * len(found))(*found)

    def run(
        self, values: Floats, wanted: NDArray[np.bool_], exact: NDArray[np.bool_] | None = None
    ) -> Judged:
        """Run the rows that are wanted, each with its values along the columns, and judge them.

        Of each row `exact` says which of the composed claims are judged, and no others are.
        """
        for slave in self._master.slaves.values():
            slave.renew()
        parts, first, size = [], 0, FIRST
        while first < len(values):
            part = slice(first, first + min(size, MOST))
            begun = perf_counter()
            own = None if exact is None else np.ascontiguousarray(exact[part])
            parts.append(self._part(np.ascontiguousarray(values[part]), wanted[part], own, first))
            grown = PATIENCE / max(perf_counter() - begun, 1e-6)
            size, first = max(1, int(size * min(8.0, grown))), part.stop
            for slave in self._master.slaves.values():
                slave.forget_messages()
        notes = {key: note for part in parts for key, note in part.notes.items()}
        joined = {
            name: np.concatenate([getattr(part, name) for part in parts])
            for name in Judged._fields
            if name != "notes"
        }
        return Judged(notes=notes, **joined)

    def _part(
        self, values: Floats, wanted: NDArray[np.bool_], exact: NDArray[np.bool_] | None, first: int
    ) -> Judged:
        count, texts = len(values), ctypes.create_string_buffer(ROOM)
        found = Judged(
            np.array(wanted),
            np.zeros((count, self._verdicts, 12)),
            {},
            np.zeros((count, self._angles)),
            np.zeros((count, len(self._signals.reals))),
            np.zeros((count, len(self._signals.integers)), dtype=np.int32),
        )
        notes = np.full((count, self._verdicts), -1, dtype=np.int64)
        filled = (found.verdicts, found.fastest, found.reals, found.integers, notes)
        given = _Found(
            found.clean.ctypes.data,
            None if exact is None else exact.ctypes.data,
            *(each.ctypes.data for each in filled),
            ctypes.addressof(texts),
            ROOM,
            0,
        )
        place = ctypes.c_void_p(values.ctypes.data)
        columns = ctypes.c_size_t(values.shape[1])
        done = self._library.run_rows(
            ctypes.byref(self._rows), ctypes.c_int64(count), place, columns, ctypes.byref(given)
        )
        if done < count:
            raise Interrupted
        for row, number in zip(*np.nonzero(notes >= 0), strict=True):
            text = ctypes.string_at(ctypes.addressof(texts) + int(notes[row, number]))
            found.notes[first + int(row), int(number)] = text.decode()
        return found


def _compiled(action: Action) -> Compiled:
    assert action.call.compiled is not None, "the calls of native FMUs can be made in C"
    return action.call.compiled


def _places(slots: Iterable[int]) -> NDArray[np.int64]:
    return np.array(list(slots), dtype=np.int64)
