"""Recorded runs as the rules in C have them: `native/judge.h` judges for a run and for a page alike."""

import ctypes
import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import LoomfmuError
from ...fmi.native.libraries import needed_library
from ...traces import Signals, Verdict
from ..standard import standard
from .movers import Mover, movers_of, owners_of

ROOM = 16  # for the times that a function finds, at first
BESIDE = ("valid_if", "error", "lowest", "highest")  # in the order of `run_beside`
FIELDS = (  # of `struct verdict`
    *("holds", "decided", "form", "bound", "worst", "time"),
    *("angle", "revolution", "error", "spread", "distance", "between"),
)
Floats = NDArray[np.float64]
Table = dict[str, tuple[int, list[str | None]]]  # of each signal its number, its rate and those `BESIDE` it
_Size, _Place, _Real, _Text = ctypes.c_ssize_t, ctypes.c_void_p, ctypes.c_double, ctypes.c_char_p
_Int, _Yes = ctypes.c_int, ctypes.c_bool
_FUNCTIONS: dict[str, tuple[Any, list[Any]]] = {  # results and arguments
    "run_new": (_Place, [_Size, _Place, _Size, _Text]),
    "run_free": (None, [_Place]),
    "run_add": (_Int, [_Place, _Text, _Place, _Size]),
    "run_beside": (None, [_Place, *[_Int] * 6, _Text]),
    "rule_of": (_Int, [_Text]),
    "run_note": (_Text, [_Place]),
    "run_renew": (None, [_Place, _Size]),
    "judge": (_Yes, [_Place, _Place, _Text, _Place]),
    "settle": (_Yes, [_Place, _Place, _Place, *[_Real] * 4]),
    "model_error": (_Real, [_Place, _Place, _Place]),
    "passages": (_Size, [_Place, _Int, _Real, _Place, _Size]),
    "stands_at": (_Size, [_Place, _Real, _Place, _Size]),
    "value_at": (_Real, [_Place, _Int, _Real]),
    "points_of": (_Size, [_Place, _Int, _Place]),
}
_Found = _Real * len(FIELDS)


class Form(NamedTuple):
    """The form of a verdict: its text, its signal, the unit of its number, that of texts, and its sense."""

    text: str
    signal: str
    unit: tuple[str, str]
    sense: int

    def judges(self, trace: Signals) -> bool:
        """Return whether the verdict's number is a value of its signal, which may only name where to look."""
        return self.signal in trace and self.unit[0] == trace.unit(self.signal)


class Question(NamedTuple):
    """The question that a claim asks of a run: a rule, what it takes, and the forms of its verdict.

    Numbers are given, or are parameters of the run, by their names. `words` are names for notes, in lines.
    """

    rule: str
    forms: Sequence[Form]
    signals: Sequence[str]
    numbers: Sequence[float | str]
    words: str = ""

    def written(self, trace: Signals, number: Callable[[str], int]) -> list[float | str]:
        """Return the list of numbers that `judge.h` takes, with parameters by their names.

        Args:
            trace: the run that says which units its signals have
            number: the number of a signal, -1 for anything else
        """
        forms = [(number(form.signal), form.sense, form.judges(trace)) for form in self.forms]
        signals = [number(signal) for signal in self.signals]
        owners = owners_of(self.signals)
        weave = standard().weave_of(owners, trace)
        turning = [
            (number(each.angle), float(each.turns), each.turn, each.speed or 0.0)
            for each in _movers(trace, owners)
        ]
        rule = library().rule_of(self.rule.encode())
        found: list[float | str] = [rule, len(forms), *chain.from_iterable(forms)]
        for part in (signals, self.numbers, weave, [*chain.from_iterable(turning)]):
            found += (len(part), *part)
        return found


def _movers(trace: Signals, owners: set[str]) -> list[Mover]:
    """Return what turns some instances. Raises LoomfmuError where an angle is not recorded."""
    known, wanted = trace.shared.setdefault(movers_of, {}), frozenset(owners)  # several claims ask
    if wanted not in known:
        known[wanted] = movers_of(wanted, trace)
        if missing := [each.angle for each in known[wanted] if each.angle and each.angle not in trace]:
            trace.columns(missing)  # which says so
    found: list[Mover] = known[wanted]
    return found


def needs_shaft(trace: Signals) -> None:
    """Refuse a run without a shaft's angle. Raises LoomfmuError."""
    if "shaft.angle" not in trace:
        raise LoomfmuError(f"{trace.name}: the claim needs shaft angles, but shaft.angle is not recorded")


class Run:
    """A recorded run, for as long as its samples are there: it keeps what C reads, but not the trace."""

    def __init__(self, trace: Signals):
        self._library = library()
        self._table: Table = {}
        time, text = trace.columns([])[0], trace.cut_short.encode()
        self._kept: list[Any] = [time, text]
        self.made: dict[str, Floats] = {}  # what C reads of signals that are not kept as real numbers
        self._samples = len(time.values)
        self._run = self._library.run_new(self._samples, time.place, time.values.strides[0], text)
        if not self._run:
            raise MemoryError
        self._number(trace, "shaft.angle")

    def __del__(self) -> None:
        if getattr(self, "_run", None):
            self._library.run_free(self._run)

    def verdict(self, trace: Signals, question: Question, name: str = "") -> Verdict:
        """Return the verdict on a claim that asks this question, and may have a name."""
        found, words = _Found(), question.words.encode()
        _check(self._library.judge(self._run, self._list(trace, question), words, found))
        return verdict_of(found[:], question.forms, name, self._library.run_note(self._run).decode())

    def question(self, trace: Signals, question: Question) -> tuple[Any, dict[int, str]]:
        """Return a question as the rules take it, and the parameters in it by their places."""
        written = self._written(trace, question)
        named = {place: each for place, each in enumerate(written) if isinstance(each, str)}
        return _filled(trace, written), named

    @property
    def rules(self) -> tuple[int, ...]:
        """The addresses of the functions that judge, settle, renew and tell the note, and of the run."""
        functions = (self._library[name] for name in ("judge", "settle", "run_renew", "run_note"))
        return (*(ctypes.cast(each, _Place).value or 0 for each in functions), int(self._run))

    def settled(self, trace: Signals, question: Question, verdict: Verdict, *changes: float) -> Verdict:
        """Return a verdict with its error; `changes` are what `settle` of judge.h takes after the verdict."""
        found = _numbers_of(verdict, question)
        _check(self._library.settle(self._run, self._list(trace, question), found, *changes))
        holds, decided, *_others, error, spread, _distance, _between = found
        return replace(verdict, error=error, spread=spread, decided=decided > 0.0, holds=holds > 0.0)

    def model_error(self, trace: Signals, question: Question, verdict: Verdict) -> float:
        """Return the model's own error, on any steps, as the error output of the judged signal states it."""
        verdict_ = _numbers_of(verdict, question)
        return float(self._library.model_error(self._run, self._list(trace, question), verdict_))

    def passages(self, trace: Signals, signal: str, level: float) -> list[float]:
        """Return all times at which a signal passes a level."""
        return _all(self._library.passages, self._run, self._number(trace, signal), level)

    def stands_at(self, angle: float) -> list[float]:
        """Return all times at which the shaft stands at an angle of its revolution, each once."""
        return _all(self._library.stands_at, self._run, angle)

    def at(self, trace: Signals, signal: str, time: float) -> float:
        """Return the value of a signal at a time."""
        return float(self._library.value_at(self._run, self._number(trace, signal), time))

    def points(self, trace: Signals, signal: str) -> Floats:
        """Return the Bernstein points of the polynomials on all intervals, one row for each."""
        number = self._number(trace, signal)
        count = self._library.points_of(self._run, number, None)
        points = np.empty((self._samples - 1, count))
        self._library.points_of(self._run, number, points.ctypes.data)
        return points

    def _list(self, trace: Signals, question: Question) -> Any:
        """Return a question as the rules take it. Raises LoomfmuError for a missing signal or parameter."""
        return _filled(trace, self._written(trace, question))

    def _written(self, trace: Signals, question: Question) -> list[float | str]:
        if missing := [signal for signal in question.signals if signal and signal not in trace]:
            trace.columns(missing)  # which says so
        return question.written(trace, lambda signal: self._number(trace, signal))

    def _number(self, trace: Signals, signal: str) -> int:
        """Return the number of a signal, -1 for anything else; it is added with all signals beside it."""
        known = len(self._table)
        number = number_of(self._table, trace, signal)
        new = list(self._table)[known:] if len(self._table) > known else []
        for name in new:
            named, column = name.encode(), trace.columns([name])[1]
            self._kept += (named, column)
            if not trace.is_real(name):
                self.made[name] = column.values
            if self._library.run_add(self._run, named, column.place, column.values.strides[0]) < 0:
                raise MemoryError
        for name in new:
            about = trace.description(name).encode()
            self._kept.append(about)
            self._library.run_beside(self._run, self._table[name][0], *beside(self._table, name), about)
        return number


def number_of(table: Table, trace: Signals, signal: str) -> int:
    """Return the number of a signal, -1 for anything else; it gets one, as do all signals beside it."""
    if signal in table:
        return table[signal][0]
    if signal not in trace:
        return -1
    others = [trace.rate(signal), *(trace.beside(signal, role) for role in BESIDE)]
    table[signal] = len(table), others
    for other in others:
        if other is not None:
            number_of(table, trace, other)
    return table[signal][0]


def beside(table: Table, signal: str) -> list[int]:
    """Return the numbers of a signal's rate and of those `BESIDE` it, -1 for none."""
    return [-1 if other is None else table[other][0] for other in table[signal][1]]


def run_of(trace: Signals) -> Run:
    """Return the run of a trace, the same for several claims if the trace keeps it."""
    kept: dict[Any, Any] = trace.shared
    if Run not in kept:
        kept[Run] = Run(trace)
    found: Run = kept[Run]
    return found


def verdict_of(numbers: Sequence[float], forms: Sequence[Form], name: str, note: str) -> Verdict:
    """Return a verdict from its `FIELDS`, in one of these forms; its claim may have a name."""
    values = [math.nan if math.isnan(each) else each for each in numbers]
    holds, decided, number, bound, worst, time, angle, revolution, error, *_rest, between = values
    form = forms[int(number)]
    return Verdict(
        f"{name}: {form.text}" if name else form.text,
        form.signal,
        holds > 0.0,
        bound,
        worst,
        *form.unit,
        time,
        angle,
        None if math.isnan(revolution) else int(revolution),
        note,
        sense=form.sense,
        error=error,
        decided=decided > 0.0,
        between=between,
    )


def _filled(trace: Signals, written: Sequence[float | str]) -> Any:
    """Return the list of numbers for C. Raises LoomfmuError for a missing parameter."""
    numbers = [trace.parameter(each) if isinstance(each, str) else each for each in written]
    return (_Real * len(numbers))(*numbers)


def _numbers_of(verdict: Verdict, question: Question) -> Any:
    """Return a verdict as the rules have it."""
    places = [(form.signal, form.sense) for form in question.forms]
    form = places.index((verdict.signal, verdict.sense))
    values = {name: getattr(verdict, name, form) for name in FIELDS} | {"revolution": math.nan}
    return _Found(*values.values())


def _check(done: bool) -> None:
    if not done:
        raise MemoryError


def _all(function: Callable[..., int], *arguments: Any) -> list[float]:
    """Return all times that a function finds."""
    times, room = (_Real * ROOM)(), ROOM
    while (count := function(*arguments, times, room)) > room:
        times, room = (_Real * count)(), count
    _check(count >= 0)
    return times[:count]


@cache
def library() -> Any:
    """Return the library with the types of its functions. Raises LoomfmuError if there is none."""
    try:
        loaded = ctypes.PyDLL(str(needed_library(standard().RULES)))
    except LoomfmuError as error:
        raise LoomfmuError(f"claims cannot be judged: {error}") from None
    for name, (result, arguments) in _FUNCTIONS.items():
        function = getattr(loaded, name)
        function.restype, function.argtypes = result, arguments
    return loaded
