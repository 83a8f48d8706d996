"""Units of measurement: SI inside, anything people write at the boundaries.

Names are Modelica's (`rad/s`, `N.m2`, `rev/min`), as FMI model descriptions and SDF use them;
`udunits` gives the spelling that CF and xarray use.
"""

import math
import re
from dataclasses import dataclass, replace
from functools import cached_property
from numbers import Real
from typing import Any

from .errors import LoomfmuError, shown, suggestion


class UnitError(LoomfmuError):
    """A quantity that cannot be read, or units that do not fit each other."""


BASES = ("kg", "m", "s", "rad", "K", "A")  # as FMI calls them


@dataclass(frozen=True)
class Unit:
    """A unit: its SI exponents (of BASES) and the factor that leads to the SI base units."""

    kg: int = 0
    m: int = 0
    s: int = 0
    rad: int = 0
    factor: float = 1.0
    K: int = 0
    A: int = 0

    @cached_property
    def dimension(self) -> tuple[int, ...]:
        """SI exponents, in the order of BASES."""
        return tuple(getattr(self, base) for base in BASES)

    @property
    def rate(self) -> tuple[int, ...]:
        """SI exponents of its change in a second."""
        return replace(self, s=self.s - 1).dimension


STANDARD_GRAVITY = 9.80665  # m/s2, exact by definition
FAR = 4.0  # times the usual value, or a share of it: beyond that a number without unit is doubted

UNITS = {
    "1": Unit(),
    "%": Unit(factor=0.01),
    "m": Unit(m=1),
    "mm": Unit(m=1, factor=1e-3),
    "cm": Unit(m=1, factor=1e-2),
    "kg": Unit(kg=1),
    "g": Unit(kg=1, factor=1e-3),
    "s": Unit(s=1),
    "ms": Unit(s=1, factor=1e-3),
    "1/m": Unit(m=-1),
    "1/s": Unit(s=-1),
    "1/s2": Unit(s=-2),
    "rad": Unit(rad=1),
    "deg": Unit(rad=1, factor=math.pi / 180),
    "rev": Unit(rad=1, factor=2 * math.pi),
    "rad/s": Unit(rad=1, s=-1),
    "rev/min": Unit(rad=1, s=-1, factor=2 * math.pi / 60),
    "rad/s2": Unit(rad=1, s=-2),
    "m/s": Unit(m=1, s=-1),
    "m/s2": Unit(m=1, s=-2),
    "m/s3": Unit(m=1, s=-3),
    "N": Unit(kg=1, m=1, s=-2),
    "kN": Unit(kg=1, m=1, s=-2, factor=1e3),
    "cN": Unit(kg=1, m=1, s=-2, factor=1e-2),
    "gf": Unit(kg=1, m=1, s=-2, factor=1e-3 * STANDARD_GRAVITY),
    "N/m": Unit(kg=1, s=-2),
    "N/mm": Unit(kg=1, s=-2, factor=1e3),
    "Pa": Unit(kg=1, m=-1, s=-2),
    "MPa": Unit(kg=1, m=-1, s=-2, factor=1e6),
    "GPa": Unit(kg=1, m=-1, s=-2, factor=1e9),
    "N/s": Unit(kg=1, m=1, s=-3),
    "N.s": Unit(kg=1, m=1, s=-1),
    "N.s/m": Unit(kg=1, s=-1),
    "N.m": Unit(kg=1, m=2, s=-2),
    "N.m2": Unit(kg=1, m=3, s=-2),
    "N.m.s/rad": Unit(kg=1, m=2, s=-1, rad=-1),
    "J": Unit(kg=1, m=2, s=-2),
    "W": Unit(kg=1, m=2, s=-3),
    "kW": Unit(kg=1, m=2, s=-3, factor=1e3),
    "W/s": Unit(kg=1, m=2, s=-4),
    "kg/m": Unit(kg=1, m=-1),
    "kg/m2": Unit(kg=1, m=-2),
    "tex": Unit(kg=1, m=-1, factor=1e-6),
    "kg.m2": Unit(kg=1, m=2),
    "K": Unit(K=1),
    "K/s": Unit(K=1, s=-1),
    "W/K": Unit(kg=1, m=2, s=-3, K=-1),
    "J/K": Unit(kg=1, m=2, s=-2, K=-1),
    "A": Unit(A=1),
    "V": Unit(kg=1, m=2, s=-3, A=-1),
    "N.m/A": Unit(kg=1, m=2, s=-2, A=-1),
}

# what an SI unit measures here, as Modelica's library calls it; a pure number, or its rate, may be anything
QUANTITIES = {
    "m": "Length",
    "kg": "Mass",
    "s": "Time",
    "rad": "Angle",
    "rad/s": "AngularVelocity",
    "rad/s2": "AngularAcceleration",
    "m/s": "Velocity",
    "m/s2": "Acceleration",
    "N": "Force",
    "N.s": "Impulse",
    "Pa": "Pressure",
    "N/m": "TranslationalSpringConstant",
    "N.s/m": "TranslationalDampingConstant",
    "N.m": "Torque",
    "N.m2": "BendingStiffness",
    "N.m.s/rad": "RotationalDampingConstant",
    "J": "Energy",
    "W": "Power",
    "kg/m": "LinearDensity",
    "kg.m2": "MomentOfInertia",
    "K": "ThermodynamicTemperature",
    "W/K": "ThermalConductance",
    "J/K": "HeatCapacity",
    "A": "ElectricCurrent",
    "V": "ElectricPotential",
}

ALIASES = {"": "1", "-": "1", "rpm": "rev/min", "r/min": "rev/min", "°": "deg", "picks/min": "rev/min"}

# possessive: nothing is tried twice, so that the time grows with the length alone
_QUANTITY = re.compile(r"\s*+([-+]?(?:\d++(?:\.\d*+)?|\.\d++)(?:[eE][-+]?\d++)?+)\s*+(\S*+)\s*+")
_COMMA = re.compile(r"\s*[-+]?\d*,\d")


def canonical(name: str) -> str:
    """Return our name of a unit, given a name that other tools write for it.

    >>> canonical("rpm"), canonical("[m]"), canonical("[-]"), canonical("lx")
    ('rev/min', 'm', '1', 'lx')
    """
    bare = name.strip()
    bare = bare[1:-1].strip() if bare.startswith("[") and bare.endswith("]") else bare
    return ALIASES.get(bare, bare)


def unit(name: str, like: str = "") -> Unit:
    """The unit of that name.

    Raises:
        UnitError: there is none; the message names the nearest, of the dimension of the unit `like` if given.
    """
    known = UNITS.get(canonical(name))
    if known is None:
        fitting = alike(like) if like else [*UNITS, *filter(None, ALIASES)]
        raise UnitError(f"unknown unit {shown(name)}{suggestion(name, fitting)}")
    return known


def alike(like: str) -> dict[str, float]:
    """Return the factors to SI of all units of the dimension of one, by their names.

    >>> alike("K/s"), "rpm" in alike("rad/s")
    ({'K/s': 1.0}, True)
    """
    named = {name: unit(name) for name in (*UNITS, *filter(None, ALIASES))}
    return {name: each.factor for name, each in named.items() if each.dimension == unit(like).dimension}


def parse(quantity: str | float, target: str) -> float:
    """A quantity as people write it, in the unit `target`.

    A bare number counts as SI already. Raises UnitError for a text that is not a quantity, an unknown
    unit, or one of another dimension than `target`.

    >>> round(parse("685 rpm", "rad/s"), 4)
    71.733
    >>> parse("0.3mm", "m")
    0.0003
    >>> parse(0.8, "1")
    0.8
    """
    if isinstance(quantity, bool) or not isinstance(quantity, str | Real):
        raise UnitError(f'{shown(quantity)} is not a quantity such as "685 rpm"')
    if not isinstance(quantity, str):
        try:
            return float(quantity)
        except OverflowError:
            raise UnitError(f"{shown(quantity)} is too large") from None
    if _COMMA.match(quantity):
        meant = quantity.strip().replace(",", ".", 1)
        raise UnitError(f'{shown(quantity)} has a decimal comma: write "{meant}"')
    match = _QUANTITY.fullmatch(quantity)
    if match is None:
        raise UnitError(f'{shown(quantity)} is not a quantity such as "685 rpm"')
    number, name = match.groups()
    if name == "" and target != "1":
        return float(number)  # SI, as for a bare number
    wanted = unit(target)
    given = unit(name, like=target)
    if given.dimension != wanted.dimension:
        raise UnitError(f"{shown(quantity)} is in {name or '1'}, which does not fit {fitted(target)}")
    return float(number) * given.factor / wanted.factor


def fitted(target: str) -> str:
    """Return what a quantity must be convertible to, as part of a message."""
    return "a number without a unit" if target == "1" else target


class Si(float):
    """A number that is known to be in SI: it never causes a warning about its unit."""


def ends_of(text: str) -> tuple[str, str]:
    """Return both ends of a range LOW..HIGH; an end that is missing is an empty text.

    Raises UnitError where one end alone, other than 0, has no unit.

    >>> ends_of("0.2 mm .. 0.5 mm")
    ('0.2 mm', '0.5 mm')
    """
    low, _, high = (end.strip() for end in text.partition(".."))
    plain = [end for end in (low, high) if is_plain(end)]
    if low and high and len(plain) == 1 and float(plain[0]) != 0.0:
        raise UnitError(f"{shown(text)}: {plain[0]} has no unit; give both ends theirs")
    return low, high


def is_plain(quantity: Any) -> bool:
    """Return whether a quantity is a number without a unit, as people write it: read as SI.

    >>> is_plain("400"), is_plain(400), is_plain("400 rpm"), is_plain(None)
    (True, True, False, False)
    """
    if isinstance(quantity, str):
        match = _QUANTITY.fullmatch(quantity)
        return match is not None and not match.group(2)
    return isinstance(quantity, int | float) and not isinstance(quantity, Si | bool)


def doubt(quantity: Any, target: str, display: str, usual: float) -> str:
    """A warning about a number without unit that was probably meant in `display`, or an empty text.

    That is so where the number lies far from the usual value (SI) if it is read as SI, and near it if it is
    read in `display`.

    >>> doubt(480, "rad/s", "rev/min", 42.0)
    'is read as 480 rad/s = 4583.662 rev/min; write "480 rev/min" if that is meant'
    >>> doubt("480 rpm", "rad/s", "rev/min", 42.0), doubt(50.0, "rad/s", "rev/min", 42.0)
    ('', '')
    """
    if not is_plain(quantity):
        return ""
    value = parse(quantity, target)
    share = abs(value / usual) if usual else 0.0
    near = 1.0 / FAR <= share * unit(display).factor <= FAR
    if not near or 1.0 / FAR <= share <= FAR:
        return ""
    meant = f"{value:.7g} {display}"
    return f'is read as {show(value, target)} = {show(value, display)}; write "{meant}" if that is meant'


def show(value: float, name: str) -> str:
    """An SI value with the unit people read it in.

    >>> show(62.83185307179586, "rev/min")
    '600 rev/min'
    """
    return f"{value / unit(name).factor:.7g}" + ("" if name == "1" else f" {name}")


def exact(value: float, name: str) -> str:
    """An SI value as a number in a unit, with as many digits as it takes to read the same value again.

    >>> [exact(parse(text, "rad/s"), "rev/min") for text in ("640 rev/min", "646.81644207 rev/min")]
    ['640', '646.81644207']
    """
    factor = unit(name).factor
    number = value / factor
    texts = [f"{number:.{digits}g}" for digits in range(7, 18)]
    texts += [f"{math.nextafter(number, end):.17g}" for end in (-math.inf, math.inf)]
    return next((text for text in texts if float(text) * factor == value), texts[-3])


def si(name: str) -> str:
    """The SI unit of the same dimension.

    >>> si("rev/min"), si("%"), si("kN")
    ('rad/s', '1', 'N')
    """
    wanted = replace(unit(name), factor=1.0)
    return next(known for known, each in UNITS.items() if each == wanted)


def udunits(name: str) -> str:
    """The UDUNITS spelling of a Modelica unit name.

    >>> udunits("kg.m2"), udunits("m/s2"), udunits("N.s/m")
    ('kg m2', 'm s-2', 'N s m-1')
    """
    numerator, _, denominator = name.partition("/")
    parts = [] if numerator == "1" and denominator else numerator.split(".")
    if denominator:
        base = denominator.rstrip("0123456789")
        parts.append(f"{base}-{denominator[len(base) :] or 1}")
    return " ".join(parts)
