"""Accuracy of the components over the number of steps in a revolution."""

import math
from functools import cache
from typing import NamedTuple

import damper_reference
import numpy as np
from driven_reference import Monolith
from scipy.interpolate import BPoly
from scipy.optimize import brentq

from loomfmu.components.belt_monitor import BeltMonitor
from loomfmu.components.weft_insertion import WeftInsertion
from loomfmu.cosim.run import evaluate
from loomfmu.cosim.scenes.scene import parse
from loomfmu.machines import parameters
from loomfmu.physics.rotor_laws.rotor import SLOPED_SINE, dwell_angle
from validation.calls import arguments, table
from validation.computed import belt, rotor
from validation.computed.heald import HealdLine
from validation.digits import number

DAMPER_STEPS = (9, 18, 36, 72, 144, 288, 576, 1152)
ORDER_FLOOR = 1e-9  # errors below it come near to rounding, of the component or of the reference
SPEED = 600.0 * math.pi / 30.0
DWELL = dwell_angle(SLOPED_SINE, 0.5, rotor.TOLERANCE)
MARGIN = 1.0 - (SPEED / belt.safe().speed) ** 2
DRIVEN_STEPS = (90, 360, 1440)
LOOM = """
revolutions = 1
steps_per_revolution = {steps}
coupling = "iterated"
[loom]
machine = "WL680-3600"
{fittings}
[shaft]
component = "DrivenShaft"
speed = "300 rev/min"
{shaft}
[[claims]]
kind = "energy_balance"
"""
FRAMES = 'weave = "1100/0110/0011/1001"\nreed = true'
# what the loom has beside its weft insertion, and what else its shaft has
LOOMS = {
    "weft": ("", ""),
    "frames": (FRAMES, 'torque_32 = "60 N.m"'),
    "carriers": (f"{FRAMES}\ndampers = true\nwarps = true", 'torque_32 = "60 N.m"'),
}


@cache
def damper(case: str) -> list[damper_reference.Row]:
    """Errors of the damper in a case of `tables/damper_cases.csv`, for each number of steps."""
    row = next(row for row in table("damper_cases") if row["case"] == case)
    (law, speed), given = arguments(row["arguments"])
    return damper_reference.convergence(speed, steps=DAMPER_STEPS, law=rotor.LAWS[law], **given)


def damper_error(case: str, steps: float) -> float:
    """Largest error of the displacement, over the largest displacement."""
    return damper(case)[DAMPER_STEPS.index(int(steps))].displacement


def damper_order(case: str, steps: float) -> str:
    """Order seen from the number of steps before."""
    found = damper(case)[DAMPER_STEPS.index(int(steps))]
    return "-" if math.isnan(found.order) or found.displacement < ORDER_FLOOR else number(found.order, 1)


@cache
def lowest_margin(steps: float) -> tuple[float, float]:
    """Lowest margin and lowest speed limit of a revolution in so many steps [1, rad/s]."""
    weft = WeftInsertion(**parameters("WeftInsertion", machine=belt.LOOM), speed=SPEED)
    of_belt = parameters("BeltMonitor", machine=belt.LOOM, head=belt.HEAD)
    monitor = BeltMonitor(**of_belt, speed=SPEED, inputs_at_step_end=True)
    step = 2.0 * math.pi / SPEED / steps
    weft.initialize(0.0)
    for n in range(int(steps) + 1):
        weft.step(n * step, 0.0)
        for signal in ("travel", "velocity", "acceleration"):
            setattr(monitor, signal, getattr(weft, signal))
        _problem = monitor.step((n - 1) * step, step) if n else monitor.initialize(0.0)
    return monitor.lowest_margin, monitor.lowest_speed_limit


def sampled_dwell(steps: float) -> float:
    """Dwell from samples of a frame's motion, on the quintics that join them [rad]."""
    line, angles, rows = HealdLine(SPEED, int(steps)), [], []
    for n in range(int(steps) + 1):
        angles.append(2.0 * math.pi * n / steps)
        rows.append([line.heald.lift, line.heald.velocity / SPEED, line.heald.acceleration / SPEED**2])
        line.advance()
    lift, stroke = BPoly.from_derivatives(angles, rows), line.heald.stroke
    share = 1.0 - rotor.TOLERANCE if float(lift(math.pi)) > 0.5 * stroke else rotor.TOLERANCE
    begin, end = (
        brentq(lambda x: float(lift(x)) - share * stroke, low, low + 0.5 * math.pi, xtol=1e-15)
        for low in (0.5 * math.pi, math.pi)
    )
    return float(end - begin)


def errors(steps: float) -> tuple[float, float, float]:
    """Errors of margin [1], limit [share] and sampled dwell [rad]."""
    margin, limit = lowest_margin(steps)
    return abs(margin - MARGIN), abs(limit / belt.safe().speed - 1.0), abs(sampled_dwell(steps) - DWELL)


class Comparison(NamedTuple):
    """Largest errors within the revolution, energy missing as a share, the motor's peak and the exact one."""

    velocity: float
    angle: float
    missing: float
    power: float
    exact_power: float


@cache
def _looms(loom: str) -> dict[int, Comparison]:
    """A loom with each number of steps against its integration."""
    found, exact = {}, None
    fittings, shaft = LOOMS[loom]
    for steps in reversed(DRIVEN_STEPS):
        scene = parse(LOOM.format(steps=steps, fittings=fittings, shaft=shaft), "driven")
        run = evaluate(scene, values=["shaft.velocity", "shaft.angle", "shaft.motor_power"])
        if exact is None:  # of the finest steps, which the others are among
            exact = Monolith(scene).solved(run.trace.time)
        velocity, angle = (each[:: DRIVEN_STEPS[-1] // steps] for each in exact)
        off = float(np.abs(run.trace["shaft.velocity"] - velocity).max())
        turned_off = float(np.abs(run.trace["shaft.angle"] - angle).max())
        power = float((40.0 * (scene.speed - velocity) * velocity).max())
        peak = float(run.trace["shaft.motor_power"].max())
        found[steps] = Comparison(off, turned_off, run.claims[0].worst, peak, power)
    return found


def driven(loom: str, steps: float) -> Comparison:
    """One of these comparisons."""
    return _looms(loom)[int(steps)]
