"""Yuan and others, the reed beat-up mechanism."""

import math
from dataclasses import replace
from functools import cache

from loomfmu.components.reed_beat_up import ReedBeatUp
from loomfmu.design import guidance
from loomfmu.design.reed import crank_place, crank_rocker_without_quick_return, frame_angle_for, reed_dyad
from validation.digits import number

ROCKER = 0.550
SWING = math.radians(13.610)
SLOPE = 0.1154
PRESSURE = math.radians(1.235)
SPEED = math.pi  # 30 rev/min, identified
FRAME_ANGLE = math.radians(15.0)  # identified


@cache
def identified(frame_angle: float = FRAME_ANGLE, pressure: float = -PRESSURE) -> ReedBeatUp:
    """The machine for a frame angle: crank-rocker and dyad by the source's synthesis, not rounded."""
    crank, coupler, _frame, _smallest = crank_rocker_without_quick_return(ROCKER, SWING, frame_angle)
    x, y = crank_place(ROCKER, SWING, SLOPE, frame_angle)
    arm, rod, height = reed_dyad(0.490, 0.330, SWING, SLOPE, pressure)
    found = ReedBeatUp(
        crank_length=crank,
        coupler_length=coupler,
        rocker_length=ROCKER,
        crank_x=x,
        crank_y=y,
        arm_length=arm,
        rod_length=rod,
        reed_height=height,
        speed=SPEED,
    )
    found.initialize(0.0)
    return found


def frame_angle(smallest: float) -> float:
    """Frame angle for a smallest transmission angle [rad]."""
    return frame_angle_for(SWING, smallest)


def crank_rocker(frame_angle: float) -> tuple[float, float, float, float]:
    """Crank, coupler and frame [m], and the smallest transmission angle [rad]."""
    return crank_rocker_without_quick_return(ROCKER, SWING, frame_angle)


def line_of_centres() -> float:
    """Where the line of the crank's centres meets x = 0 [m]."""
    return ROCKER * math.cos(0.5 * SWING) * math.hypot(1.0, SLOPE)


def coupler_over_crank(angle: float) -> float:
    """Coupler over crank at a frame angle."""
    return math.tan(angle) / math.tan(0.5 * SWING)


def swing(frame_angle: float, smallest: float) -> float:
    """Swing by (13) for a frame angle and a smallest transmission angle [rad]."""
    return 2.0 * math.asin(math.sin(frame_angle) * math.cos(smallest))


def transmission_angle() -> float:
    """Transmission angle of rod and reed at the front dead centre [rad]."""
    return 0.5 * math.pi - abs(identified().pressure_angle)


def lengths(line: str = "") -> str:
    """Arm, rod and height in mm."""
    of = identified(pressure=PRESSURE if line == "above" else -PRESSURE)
    return " / ".join(number(1e3 * length, 2) for length in (of.arm_length, of.rod_length, of.reed_height))


@cache
def guided(places: float, given: str = "") -> guidance.Guidance:
    """The joint from places of the identified machine's rod, with the `pressure` angle or without."""
    reed = identified()
    middle, count = math.atan2(1.0, -SLOPE), int(places)
    arms = [middle + (-0.5 + k / (count - 1)) * SWING for k in range(count)]
    joints = [(reed.arm_length * math.cos(a), reed.arm_length * math.sin(a)) for a in arms]
    tilts = [math.asin((reed.reed_height - y) / reed.rod_length) for _x, y in joints]
    points = [
        (x + reed.rod_length * math.cos(tilt), reed.reed_height)
        for (x, _y), tilt in zip(joints, tilts, strict=True)
    ]
    slope = -PRESSURE if given == "pressure" else None
    return guidance.guided_joint(points, [tilt - tilts[0] for tilt in tilts], slope)


def motion(angle: float) -> tuple[float, float, float]:
    """Position, velocity and acceleration of the reed at a shaft angle from the beat-up [SI]."""
    machine = replace(identified())
    machine.initialize(0.0)
    machine.step(angle / SPEED, 0.0)
    return machine.position, machine.velocity, machine.acceleration
