"""HealdFrame: a heald frame that follows its pattern."""

from dataclasses import dataclass
from math import fabs, inf, pi, sin
from typing import ClassVar

from ..declaring.arrays import array
from ..declaring.declarations import at_step_end, indicator, input_, output, parameter
from ..declaring.variables import MIXED, NOTHING, Component, Problem, Terminal
from ..physics.heald import crank_slope, lift_fraction, peg, slow_points_passed
from ..physics.shaft import carried, too_far
from .quantities import (
    FRAME_MASS,
    FREQUENCY,
    GRAVITY,
    LENGTH,
    LOAD,
    LOAD_WORK,
    RATIO,
    ROTOR_ANGLE,
    SHARE,
    STROKE,
    TURNING,
)
from .shaft_driven import turned_too_far
from .terminals import FRAME, OF_ROTOR, ROTOR

_SLOWEST = 1e-9  # rotor_ratio below which the rotor stands: a cam then has no torque about it


@dataclass(slots=True)
class HealdFrame(Component):
    """Heald frame: changes or holds at each slow point of the rotor, following its pattern.

    At the slow point of pick k the frame rests where peg k wants it: raised for 1, lowered for 0. Then
    it changes if peg k + 1 differs, and holds if not. The pattern repeats after `pattern_length` picks.
    """

    problems: ClassVar[tuple[Problem, ...]] = (
        turned_too_far("rotor"),
        Problem("sprung_mass = {sprung_mass} is part of frame_mass = {frame_mass} and cannot be more"),
    )
    keeps: ClassVar[str] = NOTHING
    origin: ClassVar[str] = MIXED
    longest_turn: ClassVar[float] = inf
    terminals: ClassVar[tuple[Terminal, ...]] = (
        ROTOR.of(*OF_ROTOR),
        FRAME.of("lift", "velocity", "acceleration"),
    )

    stroke: float = parameter(STROKE, 0.098, "Stroke of the frame")
    frame_mass: float = parameter(FRAME_MASS, 15.0, "Mass of the frame with all that it holds")
    sprung_mass: float = parameter(
        FRAME_MASS,
        0.0,
        "Part of frame_mass that hangs on springs in the frame, such as the carrier of a damper",
        source="damper_#.carrier_mass",
        source_for="load",
    )
    gravity: float = parameter(GRAVITY, 9.80665, "Gravity on the frame; 0 if springs carry its weight")
    warp_ratio: float = parameter(
        SHARE,
        0.16666666666666666,
        "Warp height at the rapier as a share of the lift (assumed: that of an air-jet loom)",
    )
    pattern_length: int = parameter("1", 2, "Picks after which the pattern repeats", minimum=1, maximum=128)
    pattern: tuple[int, ...] = array(
        parameter(
            "1",
            int(first == 0),
            f"Picks {first} to {first + 15}{', least bit first' if first == 0 else ''}",
            minimum=0,
            maximum=65535,
        )
        for first in range(0, 128, 16)
    )
    inputs_at_step_end: bool = at_step_end()
    follow_lift: bool = parameter(
        "1", False, "Follow the dobby's lift_fraction, as for a spline cam, instead of the crank on the rotor"
    )
    use_load_work: bool = parameter(
        "1", False, "Count load_work in shaft_work; otherwise passed_torque goes to load"
    )
    rotor_angle: float = input_(
        ROTOR_ANGLE,
        pi,
        "Rotor angle from the slow point of pick 0, not wrapped",
        unbounded=True,
        rate="rotor_velocity",
    )
    rotor_velocity: float = input_(
        TURNING.within(-1e9, 1e9), 41.88790204786391, "Rotor velocity", rate="rotor_acceleration"
    )
    rotor_acceleration: float = input_(
        "rad/s2", 0.0, "Rotor acceleration", nominal=1000.0, minimum=-1e15, maximum=1e15
    )
    lift_fraction: float = input_(
        RATIO.within(-1e3, 1e3),
        0.5,
        "Lift of a frame that changes at every pick, used if follow_lift is true",
        rate="lift_rate",
        when="follow_lift",
    )
    lift_rate: float = input_(
        FREQUENCY.within(-1e9, 1e9, nominal=10.0),
        10.471975511965976,
        "Rate of lift_fraction",
        rate="lift_acceleration",
        when="follow_lift",
    )
    lift_acceleration: float = input_(
        "1/s2",
        0.0,
        "Second rate of lift_fraction",
        nominal=1000.0,
        when="follow_lift",
        minimum=-1e15,
        maximum=1e15,
    )
    rotor_ratio: float = input_(
        RATIO.within(-1e3, 1e3),
        1.0,
        "Rotor velocity relative to the shaft's, for shaft_torque",
        source="dobby.rotor_ratio",
    )
    # not `when` follow_lift: a wire to it alone must not switch that on
    lift_slope: float = input_(
        RATIO.within(-1e6, 1e6),
        0.25,
        "Slope of lift_fraction by the shaft angle, for the torques if follow_lift is true",
        source="dobby.lift_slope",
    )
    load: float = input_(
        LOAD,
        0.0,
        "Force on the frame of what hangs in it, such as carrier or warp; positive upwards",
        source="damper_#.transmitted_force|warp_#.frame_load",
        source_for="shaft_torque",
    )
    load_work: float = input_(
        LOAD_WORK,
        0.0,
        "Work of the frame so far on what exerts load, at the end of the step",
        when="use_load_work",
        source="damper_#.frame_work|warp_#.frame_work",
        source_for="load",
    )
    lift: float = output(LENGTH, "Lift of the frame above its lowered position", nominal=0.1, rate="velocity")
    velocity: float = output("m/s", "Velocity of the frame", rate="acceleration")
    acceleration: float = output("m/s2", "Acceleration of the frame", nominal=10.0)
    warp_height: float = output(
        LENGTH, "Height of the warp above the closed shed, at the rapier", nominal=0.01
    )
    inertia_force: float = output("N", "Inertia force of the frame without its sprung mass", nominal=100.0)
    moving: bool = output("1", "The frame changes position between the current slow points", start=False)
    drive_force: float = output(
        "N",
        "Force of the drive on the frame, upwards: inertia and weight, less load if that is wired",
        nominal=100.0,
    )
    rotor_torque: float = output(
        "N.m",
        "Torque of the frame on the rotor, braking; of a rigid frame if load is not wired",
        nominal=10.0,
    )
    shaft_torque: float = output(
        "N.m",
        "Torque of the frame on the main shaft, braking; of a rigid frame if load is not wired",
        nominal=10.0,
    )
    kinetic_energy: float = output("J", "Kinetic energy of the frame without its sprung mass", nominal=10.0)
    potential_energy: float = output(
        "J", "Energy of the frame's weight, from its lowered position", nominal=10.0
    )
    passed_torque: float = output(
        "N.m",
        "Part of shaft_torque whose work is not in shaft_work: what goes to load without load_work",
        nominal=10.0,
    )
    shaft_work: float = output(
        "J",
        "Work taken from the shaft: kinetic and potential energy, and load_work if it is used",
        nominal=10.0,
    )
    slow_point_event: float = indicator("1", "Passes zero where the frame may begin or end a change")

    def requested(self, pick: int) -> int:
        """Position that the pattern asks for at a pick: 1 raised, 0 lowered."""
        index = pick % self.pattern_length
        return peg(self.pattern[index // 16], index % 16)

    def by_crank(self, turned: float, velocity: float, falling: bool) -> tuple[float, float, float]:
        """Share of the stroke above the lower end, by the crank: a frame falls as it rose, the other way."""
        if falling:
            return lift_fraction(2.0 * pi - turned, -velocity, -self.rotor_acceleration)
        return lift_fraction(turned, velocity, self.rotor_acceleration)

    def by_cam(self, pick: int, step_size: float, falling: bool) -> tuple[float, float, float]:
        """Share of the stroke above the lower end, by the dobby's lift, which rises in even turns."""
        share = self.lift_fraction
        rate = self.lift_rate
        if not self.inputs_at_step_end:
            share = carried(share, rate, self.lift_acceleration, step_size)
            rate = rate + self.lift_acceleration * step_size
        if (pick % 2 == 0) != falling:
            return share, rate, self.lift_acceleration
        return 1.0 - share, -rate, -self.lift_acceleration

    def slopes(self, pick: int, turned: float, change: int) -> tuple[float, float]:
        """Slope of the share of the stroke: by the rotor's angle and by the shaft's."""
        if not self.follow_lift:
            by_rotor = change * crank_slope(turned)
            return by_rotor, by_rotor * self.rotor_ratio
        # lift_fraction rises in even turns: a frame that does otherwise follows it upside down
        by_shaft = fabs(1.0 * change) * self.lift_slope
        if (pick % 2 == 0) != (change > 0):
            by_shaft = -by_shaft
        if fabs(self.rotor_ratio) < _SLOWEST:
            return 0.0, by_shaft
        return by_shaft / self.rotor_ratio, by_shaft

    def check(self) -> int:
        """Check that the mass of the frame includes that of its sprung parts."""
        if self.sprung_mass > self.frame_mass:
            return 2
        return 0

    def initialize(self, time: float) -> int:
        """Place the frame."""
        problem = self.check()
        if problem != 0:
            return problem
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Move the frame: a function of the rotor and the pattern alone."""
        angle = self.rotor_angle
        velocity = self.rotor_velocity
        if not self.inputs_at_step_end:
            angle = carried(angle, velocity, self.rotor_acceleration, step_size)
            velocity = velocity + self.rotor_acceleration * step_size
        if too_far(angle):
            return 1
        pick = slow_points_passed(angle)
        self.slow_point_event = sin(0.5 * angle)
        before = self.requested(pick)
        change = self.requested(pick + 1) - before
        share = 1.0 * before
        rate = 0.0
        second = 0.0
        if change != 0 and self.follow_lift:
            share, rate, second = self.by_cam(pick, step_size, change < 0)
        elif change != 0:
            share, rate, second = self.by_crank(angle - 2.0 * pi * pick, velocity, change < 0)
        self.lift = self.stroke * share
        self.velocity = self.stroke * rate
        self.acceleration = self.stroke * second
        self.warp_height = self.warp_ratio * (self.lift - 0.5 * self.stroke)
        self.inertia_force = (self.frame_mass - self.sprung_mass) * self.acceleration
        self.moving = change != 0
        by_rotor, by_shaft = self.slopes(pick, angle - 2.0 * pi * pick, change)
        weight = self.frame_mass * self.gravity
        self.drive_force = self.inertia_force + weight - self.load
        self.rotor_torque = self.drive_force * self.stroke * by_rotor
        self.shaft_torque = self.drive_force * self.stroke * by_shaft
        self.passed_torque = 0.0 if self.use_load_work else -self.load * self.stroke * by_shaft
        self.kinetic_energy = 0.5 * (self.frame_mass - self.sprung_mass) * self.velocity * self.velocity
        self.potential_energy = weight * self.lift
        self.shaft_work = self.kinetic_energy + self.potential_energy
        if self.use_load_work:
            self.shaft_work = self.shaft_work + self.load_work
        return 0
