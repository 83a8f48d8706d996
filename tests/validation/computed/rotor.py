"""Korolev, the rotor of the dobby: its laws, dwells, accelerations and loads."""

import math
from functools import cache

from scipy.optimize import brentq, minimize_scalar

from loomfmu.components.dobby.drive import DobbyDrive
from loomfmu.design.loads import Loads, dobby_loads, least_loaded
from loomfmu.physics.heald import lift_fraction
from loomfmu.physics.rotor_laws.plateau import PLATEAU
from loomfmu.physics.rotor_laws.rotor import HARMONIC_ENDS, SLOPED_LINE, SLOPED_SINE, UNIFORM, dwell_angle

LAWS = {
    "uniform": UNIFORM,
    "harmonic ends": HARMONIC_ENDS,
    "sloped line": SLOPED_LINE,
    "sloped sine": SLOPED_SINE,
    "slotted levers": 5,
    "non-circular gears": 6,
    "plateau": PLATEAU,
}
TOLERANCE = 0.015  # of the stroke, section 2.5
STROKE = 0.098  # m, the default of HealdFrame
SPEED = 280.0 * math.pi / 30.0  # of the measured loom, section 3.4


@cache
def drive(law: str, reduction: float | str = 0.5, **shape: float) -> DobbyDrive:
    """A drive at 1 rad/s, its slow point at the shaft angle 0; "-" for a law without reduction."""
    given = 0.5 if isinstance(reduction, str) else reduction
    found = DobbyDrive(law=LAWS[law], speed_reduction=given, slow_point=0.0, speed=1.0, **shape)
    found.initialize(0.0)
    return found


def motion(law: str, reduction: float | str, angle: float = 0.0) -> tuple[float, float, float]:
    """Angle, speed and acceleration of the rotor at a shaft angle from the slow point."""
    return drive(law, reduction).rotor(angle)


def lowest_speed(law: str, reduction: float | str) -> float:
    """Speed of the rotor over the shaft's at the slow point or opposite it, the lower one."""
    return min(motion(law, reduction, x)[1] for x in (0.0, math.pi))


def dwell(law: str, reduction: float, tolerance: float = TOLERANCE) -> float:
    """Shaft angle during which a changing frame is within a share of its stroke of its end [rad]."""
    return dwell_angle(LAWS[law], reduction, tolerance)


@cache
def largest_lift_rate(law: str, reduction: float, order: float = 2, **shape: float) -> float:
    """Largest derivative of that order of the lift by the shaft angle, as a share of the stroke."""
    turned = drive(law, reduction, **shape)

    def size(x: float) -> float:
        return -abs(lift_fraction(*turned.rotor(x))[int(order)])

    step = math.pi / 360.0
    start = min((k * step for k in range(361)), key=size)
    bounds = (max(start - step, 0.0), min(start + step, math.pi))
    found = minimize_scalar(size, bounds=bounds, method="bounded", options={"xatol": 1e-10})
    return -min(float(found.fun), size(start))


def growth(law: str, **shape: float) -> float:
    """Share by which the largest acceleration of a frame grows from zeta = 0.3 to 0.7."""
    low, high = (largest_lift_rate(law, z, **shape) for z in (0.3, 0.7))
    return high / low - 1.0


def reduction_for(law: str, angle: float) -> float | str:
    """Speed reduction with which a law dwells for an angle [rad]."""
    if dwell(law, 1.0) < angle:
        return "not reached"
    return float(brentq(lambda z: dwell(law, z) - angle, 0.0, 1.0, xtol=1e-13))


def travel_left(angle: float) -> float:
    """Share of its stroke that a frame of the default drive has left to go at a shaft angle [rad]."""
    turned = drive("sloped sine").rotor(math.pi - angle)[0]
    return 0.5 * (1.0 - math.cos(0.5 * turned))


@cache
def loads(
    law: str, reduction: float, frame_mass: float = 15.0, gravity: float = 0.0, warp_tension: float = 0.0
) -> Loads:
    """Peaks of the loads of one frame on the measured loom."""
    return dobby_loads(
        law.replace(" ", "_"),
        reduction,
        speed=SPEED,
        stroke=STROKE,
        frame_mass=frame_mass,
        gravity=gravity,
        warp_tension=warp_tension,
    )


def peak(quantity: str, law: str, reduction: float, **given: float) -> float:
    """Peak of one of these loads, without its sign [N or N m]."""
    return abs(getattr(loads(law, reduction, **given), quantity).value)


@cache
def least_reduction(law: str, mass: float, warp: float) -> float:
    """Zeta at which the torque on the rotor is least, of a frame with its warp."""
    return least_loaded(
        law.replace(" ", "_"),
        "rotor_torque",
        highest=0.8,
        speed=SPEED,
        stroke=STROKE,
        frame_mass=mass,
        gravity=0.0,
        warp_tension=warp,
    )
