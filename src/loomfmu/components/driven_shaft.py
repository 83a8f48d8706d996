"""DrivenShaft: the main shaft with its inertia, between its motor and the mechanisms."""

from dataclasses import dataclass
from math import fabs, inf
from typing import ClassVar

from ..declaring.arrays import array
from ..declaring.declarations import at_step_end, input_, output, parameter, state
from ..declaring.variables import Component, Problem, Terminal
from ..physics.driven_shaft import bulge_for, driven_motion, response, summed, work_of
from ..physics.motor import Motor, line_at
from ..physics.shaft_friction import MOST_GROWTH, parted_motion, sense_of, stopping_share
from .quantities import ANGLE, FRICTION, INERTIA, LOAD_TORQUE, LOAD_WORK, TORQUE, TURNING
from .shared_declarations import shaft_speed, shaft_start
from .terminals import SHAFT

POINTS = 8  # of the motor's characteristic
LOADS = 32  # mechanisms: 28 heald frames, dobby, both rapiers and reed


@dataclass(slots=True)
class DrivenShaft(Component):
    """The loom's main shaft with its inertia: driven by a motor, braked by the mechanisms.

    Exact for torques that run on straight lines between their samples, or that are held over a step. Where a
    mechanism also states the work that it takes, its torque follows the parabola that does this work. The
    mechanisms' own masses are no part of the inertia: they act through the torques.
    """

    terminals: ClassVar[tuple[Terminal, ...]] = (SHAFT.of("angle", "velocity", "acceleration"),)
    accuracy: ClassVar[str] = "fourth order in the step; second for a load that does not state its work"
    longest_turn: ClassVar[float] = inf
    problems: ClassVar[tuple[Problem, ...]] = (
        Problem(
            "motor_points = {motor_points}: a characteristic has at least 2 points, and the first of"
            " point_speed_1 = {point_speed_1}, {point_speed_2}, {point_speed_3}, {point_speed_4},"
            " {point_speed_5}, {point_speed_6}, {point_speed_7}, {point_speed_8} must rise; 0 stands for the"
            " line of speed and torque_slope"
        ),
    )

    speed: float = shaft_speed(
        "No-load speed of the motor, referred to the shaft; with motor_points, where the run starts"
    )
    torque_slope: float = parameter(
        FRICTION.within(0.0, 1e9, nominal=10.0),
        40.0,
        "Slope of the motor's torque line: torque per rad/s below speed (assumed)",
    )
    motor_points: int = parameter(
        "1", 0, "Points of the motor's characteristic; 0: its line", minimum=0, maximum=POINTS
    )
    point_speed: tuple[float, ...] = array(
        parameter(
            TURNING.within(-1000.0, 1000.0), 0.0, f"Speed at point {number} of the motor's characteristic"
        )
        for number in range(1, POINTS + 1)
    )
    point_torque: tuple[float, ...] = array(
        parameter(
            TORQUE.within(-1e9, 1e9, nominal=10.0),
            0.0,
            f"Torque at point {number} of the motor's characteristic",
        )
        for number in range(1, POINTS + 1)
    )
    inertia: float = parameter(
        INERTIA.within(1e-6, 1e6),
        2.0,
        "Inertia of shaft, motor and flywheel, referred to the shaft (assumed)",
    )
    dry_friction: float = parameter(
        TORQUE.within(0.0, 1e9, nominal=10.0),
        0.0,
        "Dry friction of the shaft: opposes its motion, and holds it at rest against torques up to this",
    )
    viscous_friction: float = parameter(
        FRICTION.within(0.0, 1e9, nominal=1.0),
        0.0,
        "Viscous friction of the shaft: torque that opposes motion, per rad/s",
    )
    start_angle: float = shaft_start("Shaft angle at the start; 0 is the rapiers' outer dead centre")
    start_at_speed: bool = parameter("1", True, "Start at speed; if false, from rest")
    inputs_at_step_end: bool = at_step_end()
    use_work: tuple[bool, ...] = array(
        parameter("1", False, f"Use work_{number}; otherwise torque_{number} runs on a straight line")
        for number in range(1, LOADS + 1)
    )
    torque: tuple[float, ...] = array(
        input_(
            LOAD_TORQUE,
            0.0,
            f"Load torque of mechanism {number}; positive acts backwards",
            source="*.shaft_torque",
        )
        for number in range(1, LOADS + 1)
    )
    work: tuple[float, ...] = array(
        input_(
            LOAD_WORK,
            0.0,
            f"Work that mechanism {number} has taken from the shaft, at the end of the step",
            source="*.shaft_work",
            when=f"use_work_{number}",
        )
        for number in range(1, LOADS + 1)
    )
    passed_torque: tuple[float, ...] = array(
        input_(
            LOAD_TORQUE,
            0.0,
            f"Part of torque_{number} whose work is not in work_{number}",
            source="*.passed_torque",
        )
        for number in range(1, LOADS + 1)
    )
    angle: float = output(ANGLE, "Shaft angle, not wrapped", unbounded=True, nominal=6.0, rate="velocity")
    velocity: float = output(TURNING, "Shaft velocity", rate="acceleration")
    acceleration: float = output("rad/s2", "Shaft acceleration", nominal=100.0)
    motor_torque: float = output("N.m", "Motor torque on the shaft", nominal=10.0)
    load_torque: float = output("N.m", "Load torque of all mechanisms, braking", nominal=10.0)
    friction_torque: float = output(
        "N.m", "Torque of dry and viscous friction, braking; at rest what holds the shaft", nominal=10.0
    )
    motor_power: float = output(
        "W", "Power of the motor", display="kW", nominal=1000.0, rate="motor_power_rate"
    )
    motor_power_rate: float = output("W/s", "Rate of motor_power", nominal=1e5)
    motor_work: float = output("J", "Work of the motor since the start", nominal=100.0, rate="motor_power")
    load_work: float = output(
        "J", "Work of the shaft on all mechanisms and friction since the start", nominal=100.0
    )
    other_work: float = output(
        "J", "Part of load_work that no mechanism states: friction, and torques without work", nominal=100.0
    )
    kinetic_energy: float = output("J", "Kinetic energy of inertia", nominal=1000.0)
    angle_rest: float = state("rad", "Rounding error of the angle, carried on")
    velocity_rest: float = state("rad/s", "Rounding error of the velocity, carried on")
    coupled_torque: float = state("N.m", "Load torque whose work the mechanisms state")
    coupled_work: float = state("J", "Work that the mechanisms had stated at the last sample")

    def initialize(self, time: float) -> int:
        """Place the shaft at its start, at speed or at rest."""
        if self.motor_points == 1:
            return 1
        for number in range(1, self.motor_points):
            if not self.point_speed[number - 1] < self.point_speed[number]:
                return 1
        self.angle = self.start_angle
        self.velocity = self.speed if self.start_at_speed else 0.0
        self.angle_rest = 0.0
        self.velocity_rest = 0.0
        self.motor_work = 0.0
        self.load_work = 0.0
        self.other_work = 0.0
        load, coupled, work = self.loads()
        self.show(load, coupled, work)
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Turn the shaft over the step, exactly."""
        load, coupled, work = self.loads()
        held, held_coupled = load, coupled
        if self.inputs_at_step_end:
            held, held_coupled = self.load_torque, self.coupled_torque
        motor = self.motor()
        torque, fall, below, above = line_at(
            motor, self.velocity, self.velocity_rest, self.acceleration > 0.0
        )
        slope = fall + self.viscous_friction
        free = torque - self.viscous_friction * self.velocity - held
        sense = sense_of(self.velocity, free, self.dry_friction)
        net = free - self.dry_friction * sense
        rise = load - held
        bulge = 0.0
        # where the torque rises with the velocity, the closed form has its limits
        grows = fall < 0.0 and (
            self.viscous_friction > 0.0 or fabs(slope) * step_size > MOST_GROWTH * self.inertia
        )
        gained, more, second, third = 0.0, 0.0, 0.0, 0.0
        if not grows:
            by = response(step_size, self.inertia, slope)
            if self.inputs_at_step_end:
                bulge = bulge_for(
                    work - self.coupled_work,
                    held_coupled,
                    coupled - held_coupled,
                    self.velocity,
                    net,
                    rise,
                    step_size,
                    by,
                )
            gained, more, second, third = driven_motion(self.velocity, net, rise, bulge, by)
        mean = self.velocity + more
        path = mean * sense
        parted = grows or self.leaves(net, rise, gained, step_size, slope, sense, below, above)
        rubbed = 0.0
        if parted:
            bulge = 0.0
            end, mean, second, path, square = parted_motion(
                motor,
                self.velocity,
                held,
                rise,
                step_size,
                self.inertia,
                self.viscous_friction,
                self.dry_friction,
            )
            rubbed = self.viscous_friction * step_size * square
            more = mean - self.velocity
            gained = end - self.velocity
            if end == 0.0:
                self.velocity_rest = 0.0
        done = work_of(held, rise, bulge, step_size, mean, second, third)
        kinetic = self.inertia * gained * (self.velocity + 0.5 * gained)
        rubbed = rubbed + self.dry_friction * step_size * path
        if self.viscous_friction > 0.0 and not parted:
            # the energy balance holds the integral of the squared velocity, which motor and friction share
            given = (torque + fall * self.velocity) * step_size * mean
            rubbed = rubbed + self.viscous_friction / slope * (given - done - rubbed - kinetic)
        self.load_work += done + rubbed
        self.other_work += rubbed + work_of(
            held - held_coupled, rise - (coupled - held_coupled), 0.0, step_size, mean, second, third
        )
        self.motor_work += done + rubbed + kinetic
        self.angle, self.angle_rest = summed(
            self.angle, self.angle_rest, self.velocity * step_size + more * step_size
        )
        self.velocity, self.velocity_rest = summed(self.velocity, self.velocity_rest, gained)
        self.show(load, coupled, work)
        return 0

    def leaves(
        self,
        net: float,
        rise: float,
        gained: float,
        step_size: float,
        slope: float,
        sense: float,
        below: float,
        above: float,
    ) -> bool:
        """Return whether the shaft may stop, is at rest with dry friction, or leaves the motor's line."""
        end = self.velocity + gained
        if self.dry_friction > 0.0:
            if self.velocity == 0.0 or sense * end <= 0.0:
                return True
            if self.passes(0.0, net, rise, step_size, slope, sense):
                return True
        if below > -inf and (end <= below or self.passes(below, net, rise, step_size, slope, 1.0)):
            return True
        return above < inf and (end >= above or self.passes(above, net, rise, step_size, slope, -1.0))

    def passes(
        self, point: float, net: float, rise: float, step_size: float, slope: float, sense: float
    ) -> bool:
        """Return whether the velocity, above a point (sense 1) or below it (-1), passes it in the step."""
        from_point = self.velocity - point
        return stopping_share(from_point, net, rise, step_size, self.inertia, slope, sense) < 1.0

    def motor(self) -> Motor:
        """The motor, as its functions take it."""
        return Motor(
            self.speed,
            self.torque_slope,
            self.motor_points,
            list(self.point_speed),
            list(self.point_torque),
        )

    def loads(self) -> tuple[float, float, float]:
        """Torque of all mechanisms; the part whose work they state, and this work."""
        torque = list(self.torque)
        use_work = list(self.use_work)
        load = 0.0
        coupled = 0.0
        work = 0.0
        for index in range(LOADS):
            load += torque[index]
            if use_work[index]:
                coupled += torque[index] - self.passed_torque[index]
                work += self.work[index]
        return load, coupled, work

    def show(self, load: float, coupled: float, work: float) -> None:
        """Keep the loads, and show torques, acceleration and power at the end of the step."""
        self.load_torque = load
        self.coupled_torque = coupled
        self.coupled_work = work
        motor = self.motor()
        self.motor_torque, fall, _below, _above = line_at(motor, self.velocity, self.velocity_rest, True)
        free = self.motor_torque - load
        sense = sense_of(self.velocity, free - self.viscous_friction * self.velocity, self.dry_friction)
        self.friction_torque = self.viscous_friction * self.velocity + self.dry_friction * sense
        if sense == 0.0:
            self.friction_torque = free
        self.acceleration = (free - self.friction_torque) / self.inertia
        self.motor_power = self.motor_torque * self.velocity
        self.motor_power_rate = (self.motor_torque - fall * self.velocity) * self.acceleration
        self.kinetic_energy = 0.5 * self.inertia * self.velocity * self.velocity
