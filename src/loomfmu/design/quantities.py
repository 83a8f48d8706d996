"""Arguments of the design functions: numbers in SI or texts with units, within limits."""

from dataclasses import replace
from numbers import Integral
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import units
from ..components.belt_monitor import BeltMonitor
from ..components.dobby.drive import DobbyDrive
from ..components.heald_frame import HealdFrame
from ..declaring.variables import Variable, variables_of
from ..errors import LoomfmuError, within

Quantity = float | str  # a number in SI, or a text such as "0.5 mm"

BELT = {variable.name: variable for variable in variables_of(BeltMonitor)}
DOBBY = {variable.name: variable for variable in variables_of(DobbyDrive)}
FRAME = {variable.name: variable for variable in variables_of(HealdFrame)}


def _free(unit: str, display: str, minimum: float, maximum: float, description: str) -> Variable:
    """A quantity that no component has, declared like a variable of one."""
    return Variable(
        "", float, "parameter", "fixed", unit, display, 0.0, description, minimum=minimum, maximum=maximum
    )


# by their names in the design functions, with the limits that they have in scenes
KNOWN = {
    "speed": replace(BELT["speed"], minimum=0.0),  # one way as the other
    "acceleration": _free("rad/s2", "rad/s2", -1e9, 1e9, "Angular acceleration of the main shaft"),
    "clearance": BELT["guide_clearance"],
    "tension": BELT["yarn_tension"],
    "mass": BELT["head_mass"],
    "stiffness": BELT["bending_stiffness"],
    "length_factor": BELT["prescribed_length_factor"],
    "speed_reduction": DOBBY["speed_reduction"],
    "rotor_inertia": DOBBY["rotor_inertia"],
    "stroke": FRAME["stroke"],
    "frame_mass": FRAME["frame_mass"],
    "gravity": FRAME["gravity"],
    "warp_tension": _free("N", "N", 0.0, 1e6, "Tension of all threads of a frame"),
    "warp_length": _free("m", "mm", 1e-3, 100.0, "Length of the warp to one side of the healds"),
    "width": _free("m", "m", 1e-3, 100.0, "Width in which weft is inserted"),
    "lowest_radius": _free("m", "mm", 1e-3, 10.0, "Smallest radius of a cam"),
    "highest_radius": _free("m", "mm", 1e-3, 10.0, "Largest radius of a cam"),
    "roller_radius": _free("m", "mm", 1e-4, 1.0, "Radius of roller and cutter"),
    "contact_load": _free("N", "N", -1e6, 1e6, "Load that presses a roller on its cam"),
    "contact_torque": _free("N.m", "N.m", -1e6, 1e6, "Torque that presses a roller on its cam"),
    "contact_width": _free("m", "mm", 1e-4, 1.0, "Width of cam and roller"),
    "contact_pressure": _free("Pa", "MPa", 0.0, 1e12, "Pressure of a contact"),
    "modulus": _free("Pa", "GPa", 1e3, 1e13, "Modulus of elasticity"),
    "moved_mass": _free("kg", "kg", 0.0, 1e3, "Mass that a roller moves"),
    "moved_inertia": _free("kg.m2", "kg.m2", 0.0, 1e4, "Inertia that a roller moves"),
    "tolerance": _free("m", "mm", 1e-9, 1e-2, "Tolerance of an arc"),
    "cut": _free("m", "mm", 0.0, 1.0, "Depth of a cut"),
    "deflection": _free("m", "mm", 0.0, 1.0, "Deflection that is allowed to a buckled belt"),
    "confuser": _free("m", "mm", 1e-4, 1.0, "Inner diameter of a confuser"),
    "gap": _free("m", "mm", 0.0, 1.0, "Gap between warp and confuser"),
    "shed_height": _free("m", "mm", 1e-4, 1.0, "Height of the open shed at the axis of the stream"),
    "shed_angle": _free("rad", "deg", 0.0, 1.5, "Angle of the shed"),
    "shaft_angle": _free("rad", "deg", -1e6, 1e6, "Angle of the main shaft"),
    "distance": _free("m", "mm", 1e-3, 1e4, "Distance of two places"),
    "arm": _free("m", "mm", 1e-3, 10.0, "Length of a rocker's arm"),
    "rocker": _free("m", "mm", 1e-3, 10.0, "Length of a rocker"),
    "rocker_angle": _free("rad", "deg", -3.2, 3.2, "Angle of a rocker"),
    "swing": _free("rad", "deg", 1e-6, 3.1, "Swing of a rocker"),
    "pressure_angle": _free("rad", "deg", -1.5, 1.5, "Pressure angle"),
    "frame_angle": _free("rad", "deg", 0.0, 1.6, "Angle between frame and middle of the swing"),
    "smallest_transmission_angle": _free("rad", "deg", 0.0, 1.6, "Smallest transmission angle"),
    "reed_limit": _free("m", "mm", 1e-3, 10.0, "Limit of a reed"),
    "sprocket_radius": _free("m", "mm", 1e-3, 10.0, "Radius of a sprocket"),
    "eccentricity": _free("m", "mm", 0.0, 10.0, "Eccentricity of a sprocket"),
    "reach": _free("m", "mm", 1e-4, 10.0, "Distance of a hook's joint"),
    "link": _free("m", "mm", 1e-4, 10.0, "Length of a link"),
    "place": _free("rad", "deg", -7.0, 7.0, "Direction of a link"),
}


def read(name: str, given: Any) -> float:
    """A quantity in SI. Raises LoomfmuError with its name, its value and its limits.

    >>> read("speed", "600 rpm") == read("speed", 20 * 3.141592653589793)
    True
    """
    return KNOWN[name].read(given, name)


def show(name: str, value: float) -> str:
    """A value (SI) in its display unit."""
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
    with within(where):
        return units.parse(given, unit)


def whole(name: str, given: Any, low: int) -> int:
    """A whole number, at least `low`. Raises LoomfmuError."""
    if isinstance(given, bool) or not isinstance(given, Integral) or given < low:
        raise LoomfmuError(f"{name} = {given!r} must be a whole number, {low} or more")
    return int(given)
