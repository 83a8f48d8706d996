"""Variables of FMUs: their names, types, units and limits, and which of them may be wired."""

import math
import re
from dataclasses import dataclass, replace
from typing import Any

from ... import units
from ...declaring.variables import ALONE, Beside
from ...errors import LoomfmuError, listed, misspelt, numbered, shown
from .conversions import SAME, SCALES, Definition, Linear, Stated, stated

Value = float | int | bool
_WHOLE = re.compile(r"\s*[-+]?[0-9]{1,400}\s*")  # as a real a longer one is infinite
ELEMENT = 2**32  # references of an array's elements count these from 1, beyond the array's own
CARRIED = (-(2**31), 2**31 - 1)  # the integers that a master carries: those of FMI 2.0
# what variables of an FMI type can hold; the others hold any finite number
RANGES: dict[str, tuple[float, float]] = {
    "Integer": CARRIED,
    "Enumeration": CARRIED,
    **{f"Int{size}": (-(2 ** (size - 1)), 2 ** (size - 1) - 1) for size in (8, 16, 32, 64)},
    **{f"UInt{size}": (0, 2**size - 1) for size in (8, 16, 32, 64)},
    "Float32": (-3.4028234663852886e38, 3.4028234663852886e38),
}


def shown_in(name: str, display: str = "") -> str:
    """The unit to show values of a unit in; "1", the plain number, for one that is not SI or not ours."""
    known = units.UNITS.get(name)
    if known is None or known.factor != 1.0:
        return "1"
    display = units.canonical(display)
    wanted = units.UNITS.get(display)
    return display if wanted is not None and wanted.dimension == known.dimension else name


@dataclass(frozen=True)
class Port:
    """A variable of an FMU as its model description tells it.

    `name` is what scenes and traces call it: letters, digits and _. `own` is the FMU's own name for it,
    `base_type` its type there.
    `relative` says that it is a difference, as of temperatures: its unit has no offset.
    `exact` says that it starts with a value that may be given, as a state does that is an output.
    `beside` are the outputs that say more of it. `inner` is a local that a scene records as it does outputs.
    `array` is the FMU's name of the array that it is an element of; then `reference` has its number, too.
    """

    name: str
    kind: str  # Real, Integer, Boolean
    reference: int
    causality: str
    unit: str
    display: str
    minimum: float | None
    maximum: float | None
    start: Value | None
    description: str
    choices: tuple[str, ...] = ()
    numbers: tuple[int, ...] = ()  # of the choices, ascending
    rate: str | None = None
    own: str = ""
    base_type: str = ""
    discrete: bool = False  # it changes at events alone
    has_unit: bool = True
    definition: Definition | None = None
    relative: bool = False
    nominal: float | None = None
    beside: Beside = ALONE
    exact: bool = False
    inner: bool = False
    array: str = ""

    @property
    def settable(self) -> bool:
        """Return whether its value, or the one that it starts with, may be given."""
        return self.causality in ("parameter", "input") or self.exact

    @property
    def stated(self) -> Stated | None:
        """Its unit; None where none is stated, or for what is not a real number."""
        known = self.has_unit and self.kind == "Real"
        return Stated(self.unit, self.definition, self.relative) if known else None

    @property
    def in_array(self) -> tuple[str, tuple[int, ...]]:
        """The array that it is an element of, as traces call it, and its place there; none of a scalar."""
        places = re.findall("[0-9]+", self.own.removeprefix(self.array)) if self.array else []
        ending = "".join(f"_{each}" for each in places)
        if not ending or not self.name.endswith(ending):  # a scalar has such a name, and this one got another
            return "", ()
        return self.name.removesuffix(ending), tuple(map(int, places))

    def doubt(self, given: Any, where: str) -> str:
        """Return a warning about a number without unit, as `units.doubt` words it, or an empty text."""
        if self.kind != "Real" or self.unit not in units.UNITS or self.display in ("1", self.unit):
            return ""
        usual = float(self.start or self.nominal or 0.0)
        said = units.doubt(given, self.unit, self.display, usual)
        return f"{where} = {given} {said}" if said else ""

    def value(self, given: Any, where: str) -> Value:
        """A value as people write it, in the port's own type and unit, within its limits.

        Raises LoomfmuError with the name, the value and the limits.
        """
        if self.kind == "Boolean":
            if str(given).lower() not in ("true", "false"):
                raise LoomfmuError(f"{where} = {given!r} must be true or false")
            return str(given).lower() == "true"
        if self.choices and isinstance(given, str) and not given.isdigit():
            return self._choice(given, where)
        if self.kind == "Integer" and isinstance(given, str) and _WHOLE.fullmatch(given):
            given = int(given)
        if self.kind == "Integer" and isinstance(given, int) and not isinstance(given, bool):
            return self._within(given, where)  # as a real it might become another one
        try:
            value = self._quantity(given)
        except units.UnitError as error:
            raise LoomfmuError(f"{where}: {error}") from None
        return self._within(value, where)

    @property
    def meanings(self) -> tuple[str, ...]:
        """The choices without blanks, as lists in files have them; none if their numbers leave gaps."""
        in_a_row = len(self.numbers) == 0 or self.numbers[-1] - self.numbers[0] + 1 == len(self.numbers)
        return tuple(_joined(choice) for choice in self.choices) if in_a_row else ()

    def choice(self, number: float) -> str:
        """The choice that a number stands for."""
        return self.choices[self.numbers.index(int(number))]

    def meaning(self, value: Value) -> str:
        """The choice that a value stands for, or "true" or "false"; empty for a plain number."""
        if self.kind == "Boolean":
            return str(bool(value)).lower()
        return self.choice(value) if self.choices else ""

    def _choice(self, given: str, where: str) -> int:
        """The number of a choice, whichever of blank, - and _ its name is written with."""
        alike = [choice for choice in self.choices if _joined(choice) == _joined(given)]
        found = given if given in self.choices else alike[0] if len(alike) == 1 else None
        if found is None:
            known = listed((f"{choice!r}" for choice in self.choices), "or")
            near = "".join(f"; did you mean {choice!r}?" for choice in misspelt(given, self.choices))
            raise LoomfmuError(f"{where} = {shown(given)} must be {known}{near}")
        return self.numbers[self.choices.index(found)]

    def _quantity(self, given: Any) -> float:
        own, scale = self.stated, next((each for each in SCALES if str(given).endswith(each)), "")
        if scale and own and scale != own.name:  # such as "25 degC" for an input in K
            number = units.parse(given.strip().removesuffix(scale), "1")
            try:
                return Stated(scale, SCALES[scale]).conversion(own)(number)
            except ValueError:
                raise units.UnitError(f"{given} does not fit {units.fitted(own.name)}") from None
        if self.unit in units.UNITS:
            return units.parse(given, self.unit)
        if isinstance(given, str):  # a unit that is the FMU's alone can only be repeated
            given = given.strip().removesuffix(self.unit)
        return units.parse(given, "1")

    @property
    def range(self) -> tuple[float, float]:
        """The lowest and the highest value that it takes."""
        low, high = RANGES.get(self.base_type, (-math.inf, math.inf))
        return (
            low if self.minimum is None else max(low, self.minimum),
            high if self.maximum is None else min(high, self.maximum),
        )

    def _within(self, value: float, where: str) -> Value:
        if self.numbers and value not in self.numbers:
            found = shown(value) if isinstance(value, int) else f"{value:.7g}"
            raise LoomfmuError(f"{where} = {found} must be {numbered(self.choices, self.numbers)}")
        if value != value or abs(value) == math.inf:  # an integer may be too large for `isfinite`
            raise LoomfmuError(f"{where} = {value} is not a finite number")
        low, high = self.range
        if not low <= value <= high:
            factor = units.unit(self.display).factor
            unit = self.unit if self.display == "1" else self.display
            label = "" if unit == "1" else f" {unit}"
            found, lowest, highest = (
                shown(each) if isinstance(each, int) else f"{each / factor:.7g}"
                for each in (value, low, high)
            )
            raise LoomfmuError(f"{where} = {found}{label} is outside [{lowest}, {highest}]{label}")
        if self.kind == "Integer":
            if value != int(value):
                raise LoomfmuError(f"{where} = {value:.7g} is not a whole number")
            return int(value)
        return value

    def with_unit(self, unit: str, definition: Definition | None, where: str) -> "Port":
        """The port with the unit that a scene says it has. Raises LoomfmuError where the FMU says another."""
        said = stated(unit, definition)
        if said is None or self.kind != "Real":
            raise LoomfmuError(f"{where} = {unit!r}: {self.name} is not a real variable, so it has no unit")
        if self.stated is None:
            shown_as, known = shown_in(said.name), said.definition
            return replace(self, unit=said.name, display=shown_as, has_unit=True, definition=known)
        try:
            agrees = said.conversion(self.stated) == SAME
        except ValueError:
            agrees = False
        if not agrees:
            raise LoomfmuError(f"{where} = {unit!r}: the FMU itself says {self.unit}")
        return self


def _joined(choice: str) -> str:
    """The name of a choice in one word."""
    return "_".join(re.split(r"[\s_-]+", choice.strip()))


def conversion(source: str, origin: Stated | None, sink: str, to: Stated | None) -> Linear:
    """Return what leads from a value in the unit of one end of a wire to one in that of the other end.

    A value that has no unit at one end is handed over as it is. Raises LoomfmuError for units that do not
    fit each other.
    """
    if origin is None or to is None:
        return SAME
    try:
        return origin.conversion(to)
    except ValueError as error:
        raise LoomfmuError(f"{source} is in {origin.name}, {sink} in {to.name}{error}") from None
