"""Conditions: a claim in terms of the shaft angle alone, without a run, for claims that can be stated so.

A run shows a claim at its samples and between them; a condition says what must be so at every angle.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from ...components import COMPONENTS
from ...declaring.variables import Variable, variables_of
from ...errors import LoomfmuError
from .arguments import Window
from .movers import Wired

STANDS = 4e-9  # of a revolution: a run reaches an angle that is closer to its end; more than judging takes
Floats = NDArray[np.float64]


class Unprovable(LoomfmuError):
    """A claim that depends on more than the present shaft angle, or on equations that are not known."""


@dataclass(frozen=True)
class Sum:
    """A sum of shares of signals and parameters, and a constant: what must not be negative, in SI."""

    terms: tuple[tuple[float, str], ...]
    constant: float = 0.0

    @property
    def negated(self) -> "Sum":
        """Return what is not negative where this is not positive."""
        return Sum(tuple((-share, name) for share, name in self.terms), -self.constant)


@dataclass(frozen=True)
class Always:
    """At all angles, or those of a window, or at some of every revolution, one of these is not negative."""

    any_of: tuple[Sum, ...]
    window: Window | None = None
    angles: tuple[float, ...] = ()

    @property
    def forms(self) -> tuple[Sum, ...]:
        """Return all that it is about."""
        return self.any_of

    def ranges(self, first: float, last: float) -> list[tuple[float, float]]:
        """Return the ranges of the shaft angle between two angles that it is about [rad].

        Raises Unprovable if it names an angle, or a window, that is not between them.
        """
        if self.window is None and not self.angles:
            return [(first, last)]
        turn = 2.0 * math.pi
        found: list[tuple[float, float]] = []
        wanted = [(angle, 0.0) for angle in self.angles]
        if self.window is not None:
            wanted = [(self.window.start, self.window.width)]
        for start, width in wanted:
            before = len(found)
            for number in range(
                math.floor((first - start - width) / turn) - 1, math.ceil((last - start) / turn) + 2
            ):
                low, high = max(first, start + turn * number), min(last, start + turn * number + width)
                if low <= high + STANDS * turn:
                    found.append((min(low, high), max(low, high)))
            if len(found) == before:
                raise Unprovable(
                    f"the run never reaches {math.degrees(start):.7g} deg, which the claim names"
                )
        return found


@dataclass(frozen=True)
class Sometime:
    """At some angle of the run, or of each whole pass through a window, this is not negative."""

    form: Sum
    window: Window | None = None

    angles: ClassVar[tuple[float, ...]] = ()

    @property
    def forms(self) -> tuple[Sum, ...]:
        """Return all that it is about."""
        return (self.form,)

    def ranges(self, first: float, last: float) -> list[tuple[float, float]]:
        """Return the whole run between two angles, or its whole passes through the window [rad].

        Raises Unprovable if there is no such pass.
        """
        found = Always((self.form,), self.window).ranges(first, last)
        whole = (self.window.width if self.window else last - first) - STANDS * 2.0 * math.pi
        passes = [(low, high) for low, high in found if high - low >= whole]
        if not passes:
            raise Unprovable("the run does not pass through the window of the claim")
        return passes


OUT, RISES, FALLS, IN, UNKNOWN = range(5)  # what a form does in a cell of angles


@dataclass(frozen=True)
class Spans:
    """Whenever one of these stops being negative, it stays so for an angle [rad]; one does so at least once.

    One that an end of the run cuts off is not known to last longer, as in a run.
    """

    insides: tuple[Sum, ...]
    at_least: float

    widest: ClassVar[float] = 0.05  # a cell of angles, at first [rad]
    finest: ClassVar[float] = 2.0**-12  # the closest that an end of a span is looked for [rad]
    most: ClassVar[int] = 2**16  # cells

    @property
    def forms(self) -> tuple[Sum, ...]:
        """Return all that it is about."""
        return self.insides

    def hold(self, first: float, last: float, kinds_of: Callable[[Sum, Floats], NDArray[np.int_]]) -> bool:
        """Return whether all spans between two angles last long enough, and there is one.

        `kinds_of` says what a form does between edges. Cells are bisected where spans begin and end.
        """
        shown = False
        for form in self.insides:
            cells = max(2, math.ceil((last - first) / self.widest))
            if cells > self.most:
                return False
            edges = np.linspace(first, last, cells + 1)
            while (doubtful := self.doubtful(kinds := kinds_of(form, edges), edges)).any():
                if (np.diff(edges)[doubtful] < self.finest).any():
                    return False
                edges = np.sort(np.concatenate([edges, 0.5 * (edges[:-1] + edges[1:])[doubtful]]))
            shown |= any(each.length >= max(self.at_least, 1e-300) for each in _spans(kinds, edges))
        return shown

    def doubtful(self, kinds: NDArray[np.int_], edges: Floats) -> NDArray[np.bool_]:
        """Return the cells to bisect: those of each stretch that may be a span which is too short."""
        doubtful = np.zeros(len(kinds), dtype=bool)
        for each in _spans(kinds, edges):
            if not (each.known and (each.excused or each.length >= self.at_least)):
                doubtful[each.cells] = kinds[each.cells] != IN
        return doubtful


@dataclass(frozen=True)
class _Span:
    """Cells of angles that may be a span: its least length [rad], 0 where that is not known.

    It is `excused` from being long where there is none.
    """

    cells: slice
    known: bool
    excused: bool
    length: float


def _spans(kinds: NDArray[np.int_], edges: Floats) -> Iterator[_Span]:
    """Yield each stretch that may be a span. It is known where it only rises, is inside, then only falls."""
    outside = [-1, *np.flatnonzero(kinds == OUT).tolist(), len(kinds)]
    for before, after in pairwise(outside):
        cells = slice(before + 1, after)
        group = kinds[cells]
        rises, inside, falls = (int(np.sum(group == kind)) for kind in (RISES, IN, FALLS))
        known = np.array_equal(group, [RISES] * rises + [IN] * inside + [FALLS] * falls)
        length = float(np.diff(edges)[cells][rises : rises + inside].sum()) * (1.0 - 1e-12)
        cut = (falls and before == -1) or (rises and after == len(kinds))
        yield _Span(cells, known, not (inside or cut or (rises and falls)), length * known)


Condition = Always | Sometime | Spans


def above(signal: str, bound: float | str, share: float = 1.0, window: Window | None = None) -> Always:
    """Return the condition that a share of a signal is at least as large as this share of a bound."""
    if isinstance(bound, str):
        return Always((Sum(((share, signal), (-share, bound))),), window)
    return Always((Sum(((share, signal),), -share * bound),), window)


def present(signal: str, run: Wired, sense: int) -> str:
    """Return the signal of which this one holds the lowest values, or the highest ones with -1; or itself.

    Raises Unprovable for another signal with a memory, and for a truth value.
    """
    name, _, variable = signal.rpartition(".")
    kind = run.fmus.get(name, "")
    declared = {each.name: each for each in variables_of(COMPONENTS[kind])} if kind in COMPONENTS else {}
    if variable not in declared:
        raise Unprovable(f"the equations of {signal} are not known")
    found = declared[variable]
    base = found.lowest_of if sense > 0 else found.highest_of
    if base and found.type is float:
        return f"{name}.{base}"
    if remembers(found):
        raise Unprovable(f"{signal} depends on the run so far")
    return signal


def remembers(variable: Variable) -> bool:
    """Return whether an output holds what was before, such as an extreme."""
    held = variable.one_way and variable.causality == "output" and variable.variability != "fixed"
    return held and not variable.constant


def names_of(conditions: Sequence[Condition]) -> list[str]:
    """Return the signals and parameters that conditions are about."""
    forms = [form for condition in conditions for form in condition.forms]
    return list(dict.fromkeys(name for form in forms for _share, name in form.terms))
