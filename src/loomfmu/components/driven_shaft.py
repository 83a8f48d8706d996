"""DrivenShaft: the main shaft with its inertia, between its motor and the mechanisms."""

from dataclasses import dataclass
from typing import ClassVar

from ..physics.driven_shaft import driven_motion, summed
from ..variables import Component, Terminal, at_step_end, input_, output, parameter, state
from .terminals import SHAFT


@dataclass(slots=True)
class DrivenShaft(Component):
    """The loom's main shaft with its inertia: driven by a motor, braked by the mechanisms.

    Exact for torques that run on straight lines between their samples, or that are held over a step. The
    mechanisms' own masses are no part of the inertia: they act through the torques.
    """

    terminals: ClassVar[tuple[Terminal, ...]] = (SHAFT.of("angle", "velocity", "acceleration"),)

    speed: float = parameter(
        "rad/s", 41.88790204786391, "No-load speed of the motor, referred to the shaft", display="rev/min",
        minimum=-1000.0, maximum=1000.0, nominal=50.0,
    )  # fmt: skip
    torque_slope: float = parameter(
        "N.m.s/rad", 40.0, "Slope of the motor's torque line: torque per rad/s below speed (assumed)",
        minimum=0.0, maximum=1e9, nominal=10.0,
    )  # fmt: skip
    inertia: float = parameter(
        "kg.m2", 2.0, "Inertia of shaft, motor and flywheel, referred to the shaft (assumed)",
        minimum=1e-6, maximum=1e6,
    )  # fmt: skip
    start_angle: float = parameter(
        "rad", 0.0, "Shaft angle at the start; 0 is the rapiers' outer dead centre", display="deg",
        minimum=-1e6, maximum=1e6,
    )  # fmt: skip
    start_at_speed: bool = parameter("1", True, "Start at speed; if false, from rest")
    inputs_at_step_end: bool = at_step_end()
    torque_1: float = input_(
        "N.m", 0.0, "Load torque of a first mechanism; positive brakes the shaft", nominal=10.0,
        minimum=-1e12, maximum=1e12, source="weft.shaft_torque",
    )  # fmt: skip
    torque_2: float = input_(
        "N.m", 0.0, "Load torque of a second mechanism", nominal=10.0,
        minimum=-1e12, maximum=1e12, source="reed.shaft_torque",
    )  # fmt: skip
    torque_3: float = input_(
        "N.m", 0.0, "Load torque of a third mechanism", nominal=10.0,
        minimum=-1e12, maximum=1e12,
    )  # fmt: skip
    torque_4: float = input_(
        "N.m", 0.0, "Load torque of a fourth mechanism", nominal=10.0,
        minimum=-1e12, maximum=1e12,
    )  # fmt: skip
    angle: float = output(
        "rad", "Shaft angle, not wrapped", display="deg", unbounded=True, nominal=6.0, rate="velocity"
    )
    velocity: float = output("rad/s", "Shaft velocity", display="rev/min", nominal=50.0, rate="acceleration")
    acceleration: float = output("rad/s2", "Shaft acceleration", nominal=100.0)
    motor_torque: float = output("N.m", "Motor torque on the shaft", nominal=10.0)
    load_torque: float = output("N.m", "Load torque of all mechanisms, braking", nominal=10.0)
    angle_rest: float = state("rad", "Rounding error of the angle, carried on")
    velocity_rest: float = state("rad/s", "Rounding error of the velocity, carried on")

    def initialize(self, time: float) -> int:
        """Place the shaft at its start, at speed or at rest."""
        self.angle = self.start_angle
        self.velocity = self.speed if self.start_at_speed else 0.0
        self.angle_rest = 0.0
        self.velocity_rest = 0.0
        self.show()
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Turn the shaft over the step, exactly."""
        load = self.load()
        held = self.load_torque if self.inputs_at_step_end else load
        velocity, lead = driven_motion(
            self.drive() - held, load - held, step_size, self.inertia, self.torque_slope
        )
        self.angle, self.angle_rest = summed(self.angle, self.angle_rest, self.velocity * step_size + lead)
        self.velocity, self.velocity_rest = summed(self.velocity, self.velocity_rest, velocity)
        self.show()
        return 0

    def load(self) -> float:
        """Torque of all mechanisms at the present sample."""
        return self.torque_1 + self.torque_2 + self.torque_3 + self.torque_4

    def drive(self) -> float:
        """Torque of the motor at the present velocity."""
        return self.torque_slope * (self.speed - self.velocity - self.velocity_rest)

    def show(self) -> None:
        """Torques and acceleration at the end of the step."""
        self.load_torque = self.load()
        self.motor_torque = self.drive()
        self.acceleration = (self.motor_torque - self.load_torque) / self.inertia
