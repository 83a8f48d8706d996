"""Quantities that the design functions are given: numbers in SI, or texts with units, within limits."""

from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import units
from ..components.belt_monitor import BeltMonitor
from ..errors import LoomfmuError
from ..variables import Variable, variables_of

Quantity = float | str  # a number in SI, or a text such as "0.5 mm"

BELT = {variable.name: variable for variable in variables_of(BeltMonitor)}


def _free(unit: str, display: str, minimum: float, maximum: float, description: str) -> Variable:
    """A quantity that no component has, declared as theirs are."""
    return Variable(
        "", float, "parameter", "fixed", unit, display, 0.0, description, minimum=minimum, maximum=maximum
    )


# by the names that the design functions call them: with the limits that the scenes have
KNOWN = {
    "speed": BELT["speed"],
    "clearance": BELT["guide_clearance"],
    "tension": BELT["yarn_tension"],
    "mass": BELT["head_mass"],
    "stiffness": BELT["bending_stiffness"],
    "length_factor": BELT["prescribed_length_factor"],
    "width": _free("m", "m", 1e-3, 100.0, "Width in which weft is inserted"),
    "lowest_radius": _free("m", "mm", 1e-3, 10.0, "Smallest radius of a cam"),
    "highest_radius": _free("m", "mm", 1e-3, 10.0, "Largest radius of a cam"),
    "roller_radius": _free("m", "mm", 1e-4, 1.0, "Radius of roller and cutter"),
    "tolerance": _free("m", "mm", 1e-9, 1e-2, "Tolerance of an arc"),
    "cut": _free("m", "mm", 0.0, 1.0, "Depth of a cut"),
}


def read(name: str, given: Any) -> float:
    """A quantity in SI. Raises LoomfmuError, naming it, its limits and what was given.

    >>> read("speed", "600 rpm") == read("speed", 20 * 3.141592653589793)
    True
    """
    return KNOWN[name].read(given, name)


def show(name: str, value: float) -> str:
    """A value (SI) as people read it."""
    return units.show(value, KNOWN[name].display)


def listed(name: str, given: Any, unit: str) -> NDArray[np.float64]:
    """A list of quantities of a unit, each a number in SI or a text.

    >>> listed("heights", ["1 mm", 0.5], "m").tolist()
    [0.001, 0.5]
    """
    if isinstance(given, str) or not hasattr(given, "__iter__"):
        raise LoomfmuError(f"{name} = {given!r} is not a list of quantities")
    return np.array([_number(f"{name}[{place}]", each, unit) for place, each in enumerate(given)])


def _number(where: str, given: Any, unit: str) -> float:
    try:
        return units.parse(given, unit)
    except units.UnitError as error:
        raise LoomfmuError(f"{where}: {error}") from None


def whole(name: str, given: Any, low: int) -> int:
    """A whole number from a lowest one on. Raises LoomfmuError."""
    if isinstance(given, bool) or not isinstance(given, Integral) or given < low:
        raise LoomfmuError(f"{name} = {given!r} is not a whole number of {low} or more")
    return int(given)
