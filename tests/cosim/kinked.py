"""A mechanism whose curve has a corner where it is lowest."""

from dataclasses import dataclass
from math import cos, fabs, pi, sin
from typing import ClassVar

from loomfmu.mechanism import (
    EXTREMES,
    TOO_FAR,
    Problem,
    ShaftDriven,
    lowest_so_far,
    output,
    parameter,
    too_far,
)


@dataclass(slots=True)
class Kinked(ShaftDriven):
    """A corner that points down, and a wave."""

    problems: ClassVar[tuple[Problem, ...]] = (TOO_FAR,)
    keeps: ClassVar[str] = EXTREMES
    longest_turn: ClassVar[float] = pi / 16.0

    height: float = parameter("m", 1.0, "height of the corner", minimum=-10.0, maximum=10.0)
    place: float = parameter("rad", 1.0, "angle of the corner")
    wave: float = parameter("m", 0.1, "height of the wave", minimum=-10.0, maximum=10.0)
    value: float = output("m", "value")
    velocity: float = output("m/s", "its rate")
    lowest: float = output("m", "lowest value so far", lowest_of="value")

    def initialize(self, time: float) -> int:
        """Begin."""
        angle, speed, _acceleration = self.shaft(time, 0.0)
        if too_far(angle):
            return 1
        self.move(angle, speed)
        self.lowest = self.value
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Go on."""
        angle, speed, _acceleration = self.shaft(time, step_size)
        if too_far(angle):
            return 1
        value = self.value
        velocity = self.velocity
        self.move(angle, speed)
        self.lowest = lowest_so_far(self.lowest, step_size, value, velocity, self.value, self.velocity)
        return 0

    def move(self, angle: float, speed: float) -> None:
        """Value and rate at an angle."""
        swing = sin(angle - self.place)
        slope = cos(angle - self.place)
        if swing < 0.0:
            slope = -slope
        self.value = self.height * fabs(swing) + self.wave * cos(angle)
        self.velocity = speed * (self.height * slope - self.wave * sin(angle))
