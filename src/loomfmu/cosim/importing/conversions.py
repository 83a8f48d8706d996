"""Units that FMUs and packages define, and what leads from a value in one of them to a value in another."""

import math
from dataclasses import dataclass, replace

from ... import units

BASES = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")
ROUNDING = 1e-14  # of a few products


@dataclass(frozen=True)
class Linear:
    """A linear map of numbers: `factor` times the number, plus `offset`."""

    factor: float = 1.0
    offset: float = 0.0

    def __call__(self, value: float) -> float:
        """Return what becomes of a number."""
        return self.factor * value + self.offset

    def then(self, after: "Linear") -> "Linear":
        """Return this map with another one after it.

        >>> Linear(2.0, 1.0).then(Linear(3.0))
        Linear(factor=6.0, offset=3.0)
        """
        return Linear(after.factor * self.factor, after(self.offset))

    def is_like(self, other: "Linear") -> bool:
        """Return whether both maps are the same but for rounding."""
        pairs = ((self.factor, other.factor), (self.offset, other.offset))
        return all(math.isclose(*each, rel_tol=ROUNDING) for each in pairs)


SAME = Linear()


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


# scales with an offset are not among our units, which serve for differences, too
SCALES = {"degC": Definition((0, 0, 0, 0, 1, 0, 0, 0), 1.0, 273.15)}


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


@dataclass(frozen=True)
class Stated:
    """A unit that an FMU, a package or a scene states: its name, ours if we have it, and its definition.

    A `relative` one is that of differences, as of temperatures, which have no offset.
    """

    name: str
    definition: Definition | None
    relative: bool = False

    def conversion(self, to: "Stated") -> Linear:
        """Return what leads from a value in this unit to one in another.

        Raises ValueError, with a reason that may be empty, where the units do not fit each other.
        """
        one, other = self.definition, to.definition
        if one is None or other is None:
            if self.name == to.name:
                return SAME
            raise ValueError("")
        if self.relative or to.relative:
            one, other = replace(one, offset=0.0), replace(other, offset=0.0)
        if one.agrees(other):
            return SAME
        if one.exponents != other.exponents:
            raise ValueError(", and they define that unit differently" if self.name == to.name else "")
        return Linear(one.factor / other.factor, (one.offset - other.offset) / other.factor)


def stated(name: str, definition: Definition | None) -> Stated | None:
    """Return a unit that is stated so; None for an empty name.

    One that is called like one of ours, but defined otherwise, is foreign.

    >>> stated("[m3]", None), stated("", None)
    (Stated(name='m3', definition=None, relative=False), None)
    """
    if not name:
        return None
    known = own_name(name, definition)
    if known:
        return Stated(known, own_definition(known))
    bare = units.canonical(name)
    if bare in units.UNITS:  # defined otherwise: under our name it would be read as ours everywhere
        bare = f"foreign {bare}"
    return Stated(bare, definition or SCALES.get(bare))
