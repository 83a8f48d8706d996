"""Eccentric: what it computes (the functions) and how an FMU shows it (the class)."""

from dataclasses import dataclass
from math import cos, pi, sin
from typing import ClassVar

from loomfmu.mechanism import (
    EXTREMES,
    TOO_FAR,
    Problem,
    ShaftDriven,
    highest_so_far,
    output,
    parameter,
    too_far,
)


def lift_by_angle(angle: float, stroke: float) -> tuple[float, float, float]:
    """Lift above the lower dead centre and its derivatives by the shaft angle, equation (1).

    Args:
        angle: shaft angle from the lower dead centre [rad]
        stroke: way from one dead centre to the other [m]

    Returns:
        lift [m], first and second derivative by angle [m]

    >>> lift_by_angle(0.0, 0.02)
    (0.0, 0.0, 0.01)
    """
    return 0.5 * stroke * (1.0 - cos(angle)), 0.5 * stroke * sin(angle), 0.5 * stroke * cos(angle)


@dataclass(slots=True)
class Eccentric(ShaftDriven):
    """Follower that the main shaft lifts and lowers once in a revolution.

    Say here what it is good for, what it assumes and what it leaves out.
    """

    problems: ClassVar[tuple[Problem, ...]] = (TOO_FAR,)
    # from step to step it carries the extreme alone: all other outputs follow from time and inputs;
    # remove the line if you add a `state`
    keeps: ClassVar[str] = EXTREMES
    # 15 deg: steps of that size show how its outputs change
    longest_turn: ClassVar[float] = pi / 12.0

    stroke: float = parameter(
        "m", 0.02, "Way from one dead centre to the other", display="mm", minimum=1e-4, maximum=1.0
    )
    lift: float = output("m", "Lift above the lower dead centre", display="mm", nominal=0.01, rate="velocity")
    velocity: float = output("m/s", "Velocity of the follower", rate="acceleration")
    acceleration: float = output("m/s2", "Acceleration of the follower", nominal=10.0)
    highest_velocity: float = output(
        "m/s", "Highest velocity so far, on the continuous curve", highest_of="velocity"
    )

    def initialize(self, time: float) -> int:
        """Place the follower and forget the extreme."""
        angle, speed, acceleration = self.shaft(time, 0.0)
        if too_far(angle):
            return 1
        self.move(angle, speed, acceleration)
        self.highest_velocity = self.velocity
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Move the follower to the end of the step, and note how fast it was on the way."""
        angle, speed, acceleration = self.shaft(time, step_size)
        if too_far(angle):
            return 1
        velocity = self.velocity
        rate = self.acceleration
        self.move(angle, speed, acceleration)
        # a comparison with the velocity here would miss what lies between the samples
        self.highest_velocity = highest_so_far(
            self.highest_velocity, step_size, velocity, rate, self.velocity, self.acceleration
        )
        return 0

    def move(self, angle: float, speed: float, acceleration: float) -> None:
        """Lift, velocity and acceleration at an angle of the shaft, equation (2)."""
        lift, first, second = lift_by_angle(angle, self.stroke)
        self.lift = lift
        self.velocity = first * speed
        self.acceleration = second * speed * speed + first * acceleration
