"""Torque of a motor over the velocity of its shaft: a straight line, or straight lines between points.

Beyond its first and last point a characteristic goes on along its first and last line. A motor whose no-load
speed is negative is mirrored.
"""

from dataclasses import dataclass
from math import inf


@dataclass(frozen=True)
class Motor:
    """No-load speed [rad/s] and slope of its line [N m s/rad], or from 2 `points` on its first points.

    They are velocities, which rise [rad/s], and the torques there [N m].
    """

    speed: float
    slope: float
    points: int
    velocities: list[float]
    torques: list[float]


def line_at(motor: Motor, velocity: float, rest: float, upwards: bool) -> tuple[float, float, float, float]:
    """The straight line on which the motor's torque is at a velocity.

    Args:
        velocity, rest: of the shaft, and its rounding error [rad/s]
        upwards: at a point, the line above it is meant; otherwise the one below it

    Returns:
        torque there [N m]; by how much it falls for each rad/s [N m s/rad]; the velocities between which the
        line holds [rad/s]

    >>> line_at(Motor(40.0, 2.0, 0, [], []), 30.0, 0.0, True)
    (20.0, 2.0, -inf, inf)
    >>> induction = Motor(50.0, 0.0, 3, [0.0, 40.0, 50.0], [80.0, 100.0, 0.0])
    >>> line_at(induction, 40.0, 0.0, True), line_at(induction, 40.0, 0.0, False)
    ((100.0, 10.0, 40.0, inf), (100.0, -0.5, -inf, 40.0))
    """
    if motor.points < 2:
        return motor.slope * (motor.speed - velocity - rest), motor.slope, -inf, inf
    sense = -1.0 if motor.speed < 0.0 else 1.0
    here = sense * velocity
    above = upwards == (sense > 0.0)
    index = 0
    for number in range(1, motor.points - 1):
        point = motor.velocities[number]
        if here > point or (here == point and above):
            index = number
    start = motor.velocities[index]
    rise = motor.torques[index + 1] - motor.torques[index]
    fall = -rise / (motor.velocities[index + 1] - start)
    torque = motor.torques[index] - fall * (here - start + sense * rest)
    low = start if index > 0 else -inf
    high = motor.velocities[index + 1] if index < motor.points - 2 else inf
    if sense < 0.0:
        return -torque, fall, -high, -low
    return torque, fall, low, high
