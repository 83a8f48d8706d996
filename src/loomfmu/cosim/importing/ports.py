"""Variables of FMUs: their names, types, units and limits, and which of them may be wired."""

import math
import re
from dataclasses import dataclass, replace
from typing import Any

from ... import units
from ...declaring.variables import ALONE, Beside
from ...errors import LoomfmuError, listed, misspelt, numbered, shown

Value = float | int | bool
_WHOLE = re.compile(r"\s*[-+]?[0-9]{1,400}\s*")  # as a real a longer one is infinite
CARRIED = (-(2**31), 2**31 - 1)  # the integers that a master carries: those of FMI 2.0
# what variables of an FMI type can hold; the others hold any finite number
RANGES: dict[str, tuple[float, float]] = {
    "Integer": CARRIED,
    "Enumeration": CARRIED,
    **{f"Int{size}": (-(2 ** (size - 1)), 2 ** (size - 1) - 1) for size in (8, 16, 32, 64)},
    **{f"UInt{size}": (0, 2**size - 1) for size in (8, 16, 32, 64)},
    "Float32": (-3.4028234663852886e38, 3.4028234663852886e38),
}
BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")


@dataclass(frozen=True)
class Definition:
    """The definition of a unit in an FMU: exponents of `BASES`, factor and offset."""

    exponents: tuple[int, ...]
    factor: float = 1.0
    offset: float = 0.0

    def __post_init__(self) -> None:
        if self.factor == 0.0 or not math.isfinite(self.factor) or not math.isfinite(self.offset):
            raise ValueError(f"a unit has the factor {self.factor:g} and the offset {self.offset:g}")

    def agrees(self, other: "Definition") -> bool:
        """Return whether both mean the same; factors are printed with ten digits or more."""
        near = math.isclose(self.factor, other.factor, rel_tol=1e-9)
        return self.exponents == other.exponents and near and self.offset == other.offset

    def without_rad(self) -> "Definition":
        """The same with radians taken as 1."""
        return replace(self, exponents=(*self.exponents[:-1], 0))


def own_definition(name: str) -> Definition:
    """The definition of one of our own units."""
    known = units.unit(name)
    return Definition(tuple(getattr(known, base, 0) for base in BASES), known.factor)


def own_name(name: str, definition: Definition | None) -> str:
    """Return our name of an FMU's unit, or an empty text for an unknown one.

    >>> own_name("m/s^2", Definition((0, 1, -2, 0, 0, 0, 0, 0))), own_name("rpm", None), own_name("lx", None)
    ('m/s2', 'rev/min', '')
    """
    usual = units.canonical(name)
    if usual in units.UNITS:
        own = own_definition(usual)
        # rad is 1 in SI: many tools leave it out of rad/s
        if definition is None or own.agrees(definition) or own.without_rad().agrees(definition.without_rad()):
            return usual
    if definition is not None:
        for candidate in units.UNITS:
            if own_definition(candidate).agrees(definition):
                return candidate
    return ""


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
    `beside` are the outputs that say more of it.
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
    nominal: float | None = None
    beside: Beside = ALONE

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
        if self.unit in units.UNITS:
            return units.parse(given, self.unit)
        if isinstance(given, str):  # a unit that is the FMU's alone can only be repeated
            given = given.strip().removesuffix(self.unit)
        return units.parse(given, "1")

    def _within(self, value: float, where: str) -> Value:
        if self.numbers and value not in self.numbers:
            found = shown(value) if isinstance(value, int) else f"{value:.7g}"
            raise LoomfmuError(f"{where} = {found} must be {numbered(self.choices, self.numbers)}")
        low, high = RANGES.get(self.base_type, (-math.inf, math.inf))
        low = low if self.minimum is None else max(low, self.minimum)
        high = high if self.maximum is None else min(high, self.maximum)
        if not low <= value <= high or abs(value) == math.inf:
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
        name = own_name(unit, definition) or unit
        if not name or self.kind != "Real":
            raise LoomfmuError(f"{where} = {unit!r}: {self.name} is not a real variable, so it has no unit")
        if definition is None and name in units.UNITS:
            definition = own_definition(name)
        stated = replace(self, unit=name, display=shown_in(name), has_unit=True, definition=definition)
        if self.has_unit and _differ(self, stated):
            raise LoomfmuError(f"{where} = {unit!r}: the FMU itself says {self.unit}")
        return self if self.has_unit else stated


def _joined(choice: str) -> str:
    """The name of a choice in one word."""
    return "_".join(re.split(r"[\s_-]+", choice.strip()))


def _differ(one: Port, other: Port) -> bool:
    if one.definition is not None and other.definition is not None:
        return not one.definition.agrees(other.definition)
    return one.unit != other.unit


def mismatch(source: str, origin: Port, sink: str, to: Port) -> str:
    """Return why the units of two ports prevent a wire, or an empty text if they do not.

    A wire converts nothing, and a unit that is not stated is not guessed.
    """
    if not origin.has_unit and not to.has_unit:
        return ""
    if not (origin.has_unit and to.has_unit):
        lacking, port = (source, origin) if to.has_unit else (sink, to)
        other, unit = (sink, to.unit) if to.has_unit else (source, origin.unit)
        instance = lacking.split(".")[0]
        return (
            f"{lacking} has no unit, {other} is in {unit};"
            f' say what it is: [{instance}] units = {{{port.name} = "..."}} in a scene,'
            f" or --set {instance}.units.{port.name}=..."
        )
    if not _differ(origin, to):
        return ""
    reason = f"{source} is in {origin.unit}, {sink} in {to.unit}"
    if origin.unit == to.unit:
        return f"{reason}, and the two FMUs define that unit differently"
    if origin.definition and to.definition and origin.definition.exponents == to.definition.exponents:
        factor = origin.definition.factor / to.definition.factor
        reason += f": 1 {origin.unit} is {factor:.9g} {to.unit}, and a wire converts nothing"
    return reason
