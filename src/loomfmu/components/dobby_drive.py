"""DobbyDrive: the rotor of the dobby with its speed modulator."""

from dataclasses import dataclass
from math import floor, pi

from ..physics.heald import lift_fraction
from ..physics.rotor import dwell_angle, rotor_law
from ..variables import output, parameter
from .shaft_driven import ShaftDriven


@dataclass(slots=True)
class DobbyDrive(ShaftDriven):
    """Dobby drive: a rotor that turns once a pick, slowed while the pattern changes."""

    law: int = parameter(
        "1", 4, "Rotor law of the speed modulator",
        choices=("uniform", "harmonic_ends", "sloped_line", "sloped_sine"),
    )  # fmt: skip
    speed_reduction: float = parameter(
        "1", 0.5, "Share of the rotor speed taken off at the slow point", minimum=0.0, maximum=1.0
    )
    slow_point: float = parameter(
        "rad", 3.141592653589793, "Shaft angle of the slow point, the middle of the open-shed dwell",
        display="deg", minimum=-6.283185307179586, maximum=6.283185307179586,
    )  # fmt: skip
    dwell_tolerance: float = parameter(
        "1", 0.015, "Share of the stroke within which a frame counts as dwelling", minimum=1e-9, maximum=0.5
    )
    rotor_angle: float = output(
        "rad", "Rotor angle from the slow point of pick 0, not wrapped", display="deg", unbounded=True,
        nominal=6.0, rate="rotor_velocity",
    )  # fmt: skip
    rotor_velocity: float = output(
        "rad/s", "Rotor velocity", display="rev/min", nominal=50.0, rate="rotor_acceleration"
    )
    rotor_acceleration: float = output("rad/s2", "Rotor acceleration", nominal=1000.0)
    lift_fraction: float = output(
        "1", "Lift of a frame that changes at every pick, as a share of its stroke", rate="lift_rate"
    )
    lift_rate: float = output("1/s", "Rate of lift_fraction", nominal=10.0, rate="lift_acceleration")
    lift_acceleration: float = output("1/s2", "Second rate of lift_fraction", nominal=1000.0)
    dwell_angle: float = output(
        "rad", "Shaft angle during which a changing frame stays within dwell_tolerance of its end",
        display="deg", variability="discrete", depends=(),
    )  # fmt: skip
    pick: int = output("1", "Pick that the shaft is in", start=0, variability="discrete")

    def initialize(self, time: float) -> int:
        """Find the dwell of the law and place the rotor."""
        self.dwell_angle = dwell_angle(self.law, self.speed_reduction, self.dwell_tolerance)
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Turn the rotor: a function of the shaft alone, exact for every step."""
        theta, speed, acceleration = self.shaft(time, step_size)
        turns = floor((theta - self.slow_point) / (2.0 * pi))
        angle, first, second = rotor_law(
            self.law, theta - self.slow_point - 2.0 * pi * turns, self.speed_reduction
        )
        self.rotor_angle = 2.0 * pi * turns + angle
        self.rotor_velocity = first * speed
        self.rotor_acceleration = second * speed * speed + first * acceleration
        self.lift_fraction, self.lift_rate, self.lift_acceleration = lift_fraction(
            self.rotor_angle, self.rotor_velocity, self.rotor_acceleration
        )
        self.pick = floor(theta / (2.0 * pi))
        return 0
