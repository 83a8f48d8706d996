"""PickingCam: a cam that throws the shuttle once in a revolution, its follower held by a spring."""

from dataclasses import dataclass
from math import floor, pi
from typing import ClassVar

from loomfmu.mechanism import (
    EXTREMES,
    TOO_FAR,
    Problem,
    ShaftDriven,
    auxiliary,
    lowest_so_far,
    output,
    parameter,
    too_far,
)


def rise(u: float) -> tuple[float, float, float, float]:
    """Share of the stroke and three derivatives at a share of the rise, 4-5-6-7 polynomial, equation (1).

    >>> rise(1.0)
    (1.0, 0.0, -0.0, 0.0)
    """
    w = 1.0 - u
    share = u * u * u * u * (35.0 - u * (84.0 - u * (70.0 - 20.0 * u)))
    return (
        share,
        140.0 * u * u * u * w * w * w,
        420.0 * u * u * w * w * (w - u),
        840.0 * u * w * (1.0 - 5.0 * u * w),
    )


def pick(angle: float, length: float) -> tuple[float, float, float, float]:
    """Share of the stroke and derivatives by angle: it rises over `length`, falls over as much, and rests."""
    x = angle - 2.0 * pi * floor(angle / (2.0 * pi))
    if x >= 2.0 * length:
        return 0.0, 0.0, 0.0, 0.0
    falling = x > length
    share, first, second, third = rise(2.0 - x / length if falling else x / length)
    sign = -1.0 if falling else 1.0
    square = length * length
    return share, sign * first / length, second / square, sign * third / (square * length)


@dataclass(slots=True)
class PickingCam(ShaftDriven):
    """Picking cam: the follower on a spring, its contact force and the lowest of it."""

    problems: ClassVar[tuple[Problem, ...]] = (TOO_FAR,)
    keeps: ClassVar[str] = EXTREMES
    longest_turn: ClassVar[float] = pi / 72.0  # an eighth of the shortest rise

    stroke: float = parameter("m", 0.03, "Stroke", display="mm", minimum=1e-4, maximum=1.0)
    pick_angle: float = parameter(
        "rad", pi / 3.0, "Angle of the rise, and of the fall", display="deg", minimum=pi / 9.0, maximum=pi
    )
    mass: float = parameter("kg", 1.0, "Mass of the follower", minimum=1e-3, maximum=100.0)
    spring_rate: float = parameter("N/m", 5000.0, "Rate of the spring", minimum=0.0, maximum=1e7)
    preload: float = parameter("N", 500.0, "Force of the spring at rest", minimum=0.0, maximum=1e6)
    lift: float = output("m", "Lift of the follower", display="mm", nominal=0.01, rate="velocity")
    velocity: float = output("m/s", "Velocity of the follower", rate="acceleration")
    acceleration: float = output("m/s2", "Acceleration of the follower", nominal=100.0)
    contact_force: float = output("N", "Force of the cam on the follower", nominal=100.0)
    lowest_contact_force: float = output(
        "N", "Lowest contact force so far, on the continuous curve", nominal=100.0, lowest_of="contact_force"
    )
    force_rate: float = auxiliary("N/s", "Rate of the contact force")
    sampled_acceleration: float = auxiliary("rad/s2", "Acceleration of the shaft at the last sample")

    def initialize(self, time: float) -> int:
        """Place the follower."""
        problem = self.move(time, 0.0)
        self.lowest_contact_force = self.contact_force
        return problem

    def step(self, time: float, step_size: float) -> int:
        """Move the follower and note the lowest force on the way."""
        force = self.contact_force
        rate = self.force_rate
        problem = self.move(time, step_size)
        self.lowest_contact_force = lowest_so_far(
            self.lowest_contact_force, step_size, force, rate, self.contact_force, self.force_rate
        )
        return problem

    def move(self, time: float, step_size: float) -> int:
        """Motion and force at the end of a step, equations (2) and (3)."""
        angle, speed, acceleration = self.shaft(time, step_size)
        if too_far(angle):
            return 1
        share, first, second, third = pick(angle, self.pick_angle)
        jolt = (acceleration - self.sampled_acceleration) / step_size if step_size > 0.0 else 0.0
        self.sampled_acceleration = acceleration
        self.lift = self.stroke * share
        self.velocity = self.stroke * first * speed
        self.acceleration = self.stroke * (second * speed * speed + first * acceleration)
        jerk = self.stroke * (
            third * speed * speed * speed + 3.0 * second * speed * acceleration + first * jolt
        )
        self.contact_force = self.preload + self.spring_rate * self.lift + self.mass * self.acceleration
        self.force_rate = self.spring_rate * self.velocity + self.mass * jerk
        return 0
