"""PatternLock: the sprung pawl that changes a coupling of the dobby."""

from collections.abc import Callable
from dataclasses import dataclass
from math import fabs, floor, inf, pi
from typing import Any, ClassVar

from ..declaring.declarations import auxiliary, indicator, output, parameter
from ..declaring.variables import MIXED, NOTHING, Problem
from ..physics.pattern_lock import (
    available_time,
    engagement,
    friction_power,
    pawl_inertia,
    pawl_turn,
    release_time,
    spring_torque,
    torque_speed_limit,
)
from ..physics.shaft import too_far
from .quantities import (
    ANGLE,
    DISTANCE,
    DURATION,
    EITHER_WAY,
    FORCE,
    HEAD_MASS,
    LENGTH,
    LEVER,
    LINK_LENGTH,
    RATIO,
    SHARE,
    STIFFNESS,
    TURN,
    TURNING,
)
from .shaft_driven import TOO_FAR, ShaftDriven
from .shared_declarations import found_once


@dataclass(slots=True)
class PatternLock(ShaftDriven):
    """Pattern lock: the pawl of a frame that changes at every pick, its torque, its time, its friction.

    In even picks the pawl turns from one disc to the other, in odd picks back, a pick lasting from one
    start of the engagement to the next.
    """

    keeps: ClassVar[str] = NOTHING
    origin: ClassVar[str] = MIXED
    longest_turn: ClassVar[float] = inf
    problems: ClassVar[tuple[Problem, ...]] = (TOO_FAR,)

    pawl_mass: float = parameter(HEAD_MASS, 0.170, "Mass of the pawl")
    pawl_length: float = parameter(LEVER, 0.160, "Length of the pawl")
    pawl_width: float = parameter(LENGTH.within(1e-4, 10.0, nominal=0.01), 0.030, "Width of the pawl")
    rest_share: float = parameter(SHARE, 0.15, "Share of the pawl's width that stays outside the slot")
    engagement_start: float = parameter(
        EITHER_WAY, 2.4870941840919194, "Shaft angle at which the engagement begins (assumed)"
    )
    engagement_angle: float = parameter(
        ANGLE.within(1e-3, 2.0 * pi), 1.3089969389957472, "Shaft angle that the engagement takes"
    )
    spring_force: float = parameter(
        FORCE.within(1e-6, 1e6, nominal=10.0),
        20.0,
        "Preload of the spring at the end of the turn; force of the pawl on its disc",
    )
    spring_stiffness: float = parameter(
        STIFFNESS.within(1e-3, 1e9, nominal=1e3), 2500.0, "Stiffness of the spring"
    )
    lever_arm: float = parameter(LINK_LENGTH, 0.050, "Lever arm of the spring")
    available_angle: float = parameter(
        TURN, 0.5 * pi, "Shaft angle of the rotor's dwell, in which the pawl must change over"
    )
    frame_count: int = parameter("1", 20, "Frames of the dobby, one pawl each", minimum=0, maximum=1000)
    friction_coefficient: float = parameter(RATIO.within(0.0, 10.0), 0.1, "Friction of a pawl on its disc")
    friction_radius: float = parameter(DISTANCE, 0.0875, "Radius at which a pawl rubs")
    rotor_ratio: float = parameter(
        RATIO.within(0.0, 100.0), 1.4, "Largest speed of the rotor relative to the shaft's"
    )
    gear_ratio: float = parameter(RATIO.within(1e-3, 1e3), 3.0, "Speed of the rotor relative to the disc's")
    turn: float = output(ANGLE, "Angle of the pawl", nominal=0.1, rate="turn_velocity")
    turn_velocity: float = output("rad/s", "Velocity of the pawl", nominal=10.0, rate="turn_acceleration")
    turn_acceleration: float = output("rad/s2", "Acceleration of the pawl", nominal=1000.0)
    inertia_torque: float = output("N.m", "Torque the spring needs to overcome the pawl's inertia")
    torque_margin: float = output(
        "1",
        "Share of the spring's torque left over by the pawl's inertia; above 1 where it slows the pawl down",
    )
    release_time: float = found_once(DURATION, "Time the spring takes to throw the pawl over", nominal=0.01)
    available_time: float = output(
        DURATION,
        "Time available in the dwell at the current speed; 1e6 s for a shaft at rest",
        nominal=0.01,
    )
    in_time: bool = output(
        "1",
        "At this speed the pawl changes over in time and its spring is strong enough",
        start=False,
    )
    torque_speed_limit: float = found_once(
        TURNING, "Shaft speed up to which the spring is strong enough", nominal=100.0
    )
    release_speed_limit: float = found_once(
        TURNING, "Shaft speed up to which the pawl changes over in time", nominal=100.0
    )
    speed_limit: float = found_once(TURNING, "The lower of the two speed limits", nominal=100.0)
    friction_power: float = output(
        "W",
        "Power lost by all pawls on the discs, at the rotor's highest speed",
        nominal=100.0,
    )
    inertia: float = auxiliary("kg.m2", "Moment of inertia of the pawl", minimum=0.0)
    whole_turn: float = auxiliary("rad", "Angle that the pawl turns from one disc to the other")
    in_time_event: float = indicator(
        "rad/s", "Margin of the shaft speed below speed_limit; in_time changes where it passes zero"
    )

    @classmethod
    def shortest_event(cls, value: Callable[[str], Any]) -> tuple[float, str]:
        """The engagement, in which the pawl turns."""
        return value("engagement_angle"), "the engagement"

    def initialize(self, time: float) -> int:
        """Find what depends on the parameters alone and place the pawl."""
        self.inertia = pawl_inertia(self.pawl_mass, self.pawl_length, self.pawl_width)
        self.whole_turn = pawl_turn(self.pawl_length, self.pawl_width, self.rest_share)
        self.release_time = release_time(
            self.inertia, self.whole_turn, self.spring_force, self.spring_stiffness, self.lever_arm
        )
        self.torque_speed_limit = torque_speed_limit(
            self.inertia,
            self.engagement_angle,
            self.whole_turn,
            self.spring_force,
            self.spring_stiffness,
            self.lever_arm,
        )
        self.release_speed_limit = self.available_angle / self.release_time
        self.speed_limit = self.torque_speed_limit
        if self.release_speed_limit < self.speed_limit:
            self.speed_limit = self.release_speed_limit
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Turn the pawl: a function of the shaft alone, exact for every step."""
        theta, speed, acceleration = self.shaft(time, step_size)
        if too_far(theta):
            return 1
        x = theta - self.engagement_start
        turns = floor(x / (2.0 * pi))
        angle, first, second = engagement(x - 2.0 * pi * turns, self.engagement_angle, self.whole_turn)
        if turns % 2 != 0:
            angle = self.whole_turn - angle
            first = -first
            second = -second
        self.turn = angle
        self.turn_velocity = first * speed
        self.turn_acceleration = second * speed * speed + first * acceleration
        self.inertia_torque = self.inertia * self.turn_acceleration
        self.torque_margin = 1.0 - self.inertia_torque / spring_torque(
            angle, self.whole_turn, self.spring_force, self.spring_stiffness, self.lever_arm
        )
        self.available_time = available_time(self.available_angle, fabs(speed))
        self.in_time = self.release_time <= self.available_time and fabs(speed) <= self.torque_speed_limit
        # at the limit itself the pawl is in time: the instant that is found lies just beyond
        self.in_time_event = self.speed_limit * (1.0 + 1e-12) - fabs(speed)
        self.friction_power = friction_power(
            self.friction_coefficient,
            self.spring_force,
            self.friction_radius,
            self.rotor_ratio / self.gear_ratio * fabs(speed),
            float(self.frame_count),
        )
        return 0
