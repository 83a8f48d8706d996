"""The arguments of claims: how each is read, in which unit, within which limits.

A claim declares its fields by `argument`, as components declare their variables.
"""

import math
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import MISSING, Field, dataclass, field
from typing import Any, NamedTuple

from ... import units
from ...errors import LoomfmuError, shown

TURN = 2.0 * math.pi
EMPTY = 1e-12  # rad: a window that is shorter has no width
PARAMETER = re.compile(r"[A-Za-z]\w*\.[A-Za-z]\w*")  # the name of a parameter as a bound
UnitOf = Callable[[], str]  # the unit of the signal that a claim is about


@dataclass(frozen=True)
class Argument:
    """An argument of a claim; `unit` is that of a quantity, SI."""

    unit: str = ""

    def read(self, given: Any, where: str, unit_of: UnitOf) -> Any:
        """The value as the claim uses it, quantities in SI. Raises LoomfmuError."""
        raise NotImplementedError

    def doubts(self, given: Any, where: str) -> Iterator[str]:
        """Yield a warning if a value without a unit looks wrong."""
        return iter(())


class Name(Argument):
    """The name of an instance or of a signal, or the claim's own."""

    def read(self, given: Any, where: str, unit_of: UnitOf) -> str:
        if not isinstance(given, str):
            raise LoomfmuError(f"{where} = {shown(given)} is not a name in quotes")
        return given


class Flag(Argument):
    """Yes or no."""

    def read(self, given: Any, where: str, unit_of: UnitOf) -> bool:
        if not isinstance(given, bool):
            raise LoomfmuError(f"{where} = {shown(given)} must be true or false")
        return given


class Names(Argument):
    """The names of some instances."""

    def read(self, given: Any, where: str, unit_of: UnitOf) -> list[str]:
        if not isinstance(given, list | tuple) or not all(isinstance(each, str) for each in given):
            raise LoomfmuError(f'{where} = {shown(given)} must be a list of names, such as ["heald_1"]')
        if not given:
            raise LoomfmuError(f"{where} = [] names nothing; leave it out to judge all")
        return list(given)


@dataclass(frozen=True)
class Quantity(Argument):
    """A quantity. A number without a unit that lies far from the `usual` value is doubted, see `units.doubt`.

    `between` are the open limits of a share `of` something.
    """

    unit: str = "1"
    display: str = ""
    usual: float = 0.0
    low: float = -math.inf
    between: tuple[float, float] | None = None
    of: str = ""

    def read(self, given: Any, where: str, unit_of: UnitOf) -> Any:
        return self.number(given, where, self.unit)

    def number(self, given: Any, where: str, unit: str) -> float:
        """A quantity in SI and within its limits."""
        try:
            value = units.parse(given, unit)
        except units.UnitError as error:
            raise LoomfmuError(f"{where}: {error}") from None
        if not math.isfinite(value):
            raise LoomfmuError(f"{where} = {shown(given)} is not finite")
        if self.between and not self.between[0] < value < self.between[1]:
            low, high = self.between
            raise LoomfmuError(f"{where} = {value:g} is outside ({low:g}, {high:g}) of {self.of}")
        if value < self.low:
            raise LoomfmuError(f"{where} = {given!r} must not be negative")
        return value

    def doubts(self, given: Any, where: str) -> Iterator[str]:
        for each in given if isinstance(given, list | tuple) else [given]:
            doubt = self.usual and each is not None and units.doubt(each, self.unit, self.display, self.usual)
            if doubt:
                yield f"{where} = {each} {doubt}"


class Bound(Quantity):
    """A quantity in the unit of the claim's signal, or the name of a parameter, such as "shaft.speed"."""

    def read(self, given: Any, where: str, unit_of: UnitOf) -> float | str:
        if isinstance(given, str) and PARAMETER.fullmatch(given):
            return given
        return self.number(given, where, unit_of())


class Angles(Quantity):
    """Angles of the shaft within its revolution."""

    def read(self, given: Any, where: str, unit_of: UnitOf) -> list[float]:
        if not isinstance(given, list | tuple) or not given:
            raise LoomfmuError(
                f'{where} = {shown(given)} must be a list of shaft angles, such as ["140 deg"]'
            )
        return [self.angle(each, where) for each in given]

    def angle(self, given: Any, where: str) -> float:
        """One angle, within a revolution either way."""
        angle = self.number(given, where, self.unit)
        if abs(angle) > TURN * (1.0 + 1e-12):
            raise LoomfmuError(f"{where}: {given!r} is {units.show(angle, 'deg')}, outside [-360, 360] deg")
        return angle


class Window(NamedTuple):
    """A part of the revolution, which may pass over 360 deg."""

    start: float
    end: float

    @property
    def width(self) -> float:
        """The width of the window [rad], a whole revolution in spite of rounding."""
        width = self.end - self.start
        width = width if width > 0.0 else width % TURN
        return width if width < TURN - EMPTY else TURN

    @property
    def words(self) -> str:
        """The window in words, for a verdict."""
        return "between {} and {}".format(*(units.show(angle, "deg") for angle in self))

    def __str__(self) -> str:
        return f"[{angles_text(self)}]"


class Edges(Quantity):
    """The two edges of a window of shaft angles."""

    def edge(self, given: Any, where: str) -> float:
        """An angle; a number without a unit is in radians, so that a large one was meant in degrees."""
        angle = self.number(given, where, self.unit)
        if abs(angle) > TURN * (1.0 + 1e-12) and re.fullmatch(r"[-+.\deE ]+", str(given)):
            raise LoomfmuError(
                f'{where} has {given} rad, more than a revolution; did you mean "{given} deg"?'
            )
        return angle

    def read(self, given: Any, where: str, unit_of: UnitOf) -> Window:
        if not isinstance(given, list | tuple) or len(given) != 2:
            raise LoomfmuError(
                f'{where} = {shown(given)} must be two shaft angles, such as ["330 deg", "30 deg"]'
            )
        window = Window(*(self.edge(each, where) for each in given))
        if window.end - window.start > TURN * (1.0 + 1e-12):
            raise LoomfmuError(f"{where} = {window} is longer than a revolution")
        width = window.width
        if min(width, TURN - width if window.end < window.start else width) < EMPTY:
            raise LoomfmuError(f"{where} = {window} is empty; a whole revolution is [0 deg, 360 deg]")
        return window

    def doubts(self, given: Any, where: str) -> Iterator[str]:
        yield from super().doubts(given, where)
        window = self.read(given, where, lambda: self.unit)
        if window.end < window.start and window.width > 0.5 * TURN:  # both edges may have been swapped
            other, same = map(_quoted, (window[::-1], (window.start - TURN, window.end)))
            width = units.show(window.width, "deg")
            yield (
                f"{where} = {window} covers {width}, through 360 deg; write {other} for the other part of the"
                f" revolution, or {same} if this one is meant"
            )


def _quoted(angles: Sequence[float]) -> str:
    """Shaft angles as a scene states them."""
    return "[" + ", ".join(f'"{units.show(angle, "deg")}"' for angle in angles) + "]"


def angles_text(angles: Sequence[float]) -> str:
    """Shaft angles as people read them.

    >>> angles_text([0.0, math.pi])
    '0 deg, 180 deg'
    """
    return ", ".join(units.show(angle, "deg") for angle in angles)


def argument(kind: Argument, default: Any = MISSING) -> Any:
    """A field of a claim; one without a default is needed."""
    return field(default=default, metadata={"argument": kind})


def argument_of(declared: Field[Any]) -> Argument:
    """Return the argument that a field of a claim was declared as."""
    kind: Argument = declared.metadata["argument"]
    return kind
