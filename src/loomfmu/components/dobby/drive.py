"""DobbyDrive: the rotor of the dobby with its speed modulator."""

from dataclasses import dataclass
from math import fabs, floor, inf, pi, sin
from typing import ClassVar

from ...declaring.declarations import indicator, output, parameter
from ...declaring.variables import MIXED, NOTHING, Terminal
from ...physics.heald import crank_slope, lift_fraction
from ...physics.rotor_laws.mechanisms import (
    NONCIRCULAR_GEARS,
    SLOTTED_LEVERS,
    gear_speed_extremes,
    noncircular_gears,
    slotted_levers,
    slotted_levers_place,
)
from ...physics.rotor_laws.plateau import PLATEAU, plateau_peaks
from ...physics.rotor_laws.rotor import highest_rates
from ...physics.rotor_laws.shed_cam import SPLINE_CAM, cam_phase
from ...physics.rotor_laws.table import TABLE
from ...physics.shaft import too_far
from ..quantities import ANGLE, INERTIA, TURNING
from ..shared_declarations import found_once
from ..terminals import OF_ROTOR, ROTOR
from .laws import RotorLaws


@dataclass(slots=True)
class DobbyDrive(RotorLaws):
    """Dobby drive: a rotor that turns once a pick, slowed while the pattern changes.

    With the law `spline_cam` there is no such rotor: a cam lifts and lowers the frames directly, once in
    two picks, and the rotor angle is only its phase.
    """

    keeps: ClassVar[str] = NOTHING
    origin: ClassVar[str] = MIXED
    longest_turn: ClassVar[float] = inf
    terminals: ClassVar[tuple[Terminal, ...]] = (*RotorLaws.terminals, ROTOR.of(*OF_ROTOR))

    rotor_inertia: float = parameter(
        INERTIA.within(0.0, 1e3),
        0.05,
        "Inertia of the rotor (assumed: none published); for spline_cam, of the cam shaft",
    )
    rotor_angle: float = output(
        ANGLE,
        "Rotor angle from the slow point of pick 0, not wrapped",
        unbounded=True,
        nominal=6.0,
        rate="rotor_velocity",
    )
    rotor_velocity: float = output(TURNING, "Rotor velocity", rate="rotor_acceleration")
    rotor_acceleration: float = output("rad/s2", "Rotor acceleration", nominal=1000.0)
    lift_fraction: float = output(
        "1", "Lift of a frame that changes at every pick, as a share of its stroke", rate="lift_rate"
    )
    lift_rate: float = output("1/s", "Rate of lift_fraction", nominal=10.0, rate="lift_acceleration")
    lift_acceleration: float = output("1/s2", "Second rate of lift_fraction", nominal=1000.0)
    rotor_ratio: float = output(
        "1", "Rotor velocity relative to the shaft's: what turns a torque on the rotor into one on the shaft"
    )
    lift_slope: float = output("1", "Slope of lift_fraction by the shaft angle")
    rotor_torque: float = output("N.m", "Torque that the rotor's own inertia takes from its modulator")
    shaft_torque: float = output(
        "N.m", "Torque of the rotor's own inertia on the main shaft, braking; those of the frames are theirs"
    )
    kinetic_energy: float = output("J", "Kinetic energy of the rotor", nominal=10.0)
    shaft_work: float = output("J", "Work taken from the shaft, now kinetic_energy", nominal=10.0)
    dwell_angle: float = found_once(
        ANGLE,
        "Shaft angle for which a changing frame stays within dwell_tolerance of its end",
        nominal=1.5,
    )
    clear_shed_angle: float = found_once(
        ANGLE,
        "Shaft angle for which a changing frame stays within clear_fraction of its end",
        nominal=1.5,
    )
    highest_speed: float = found_once(
        "1", "Largest rotor speed relative to the shaft's; for spline_cam, largest slope of lift_fraction"
    )
    highest_acceleration: float = found_once(
        "1", "Largest rotor acceleration at a shaft speed of 1 rad/s; for spline_cam, that of lift_fraction"
    )
    highest_jerk: float = found_once(
        "1", "Largest rotor jerk at a shaft speed of 1 rad/s; for spline_cam, that of lift_fraction"
    )
    pick: int = output("1", "Current pick of the shaft", start=0)
    pick_event: float = indicator("1", "Passes zero where pick changes")

    def initialize(self, time: float) -> int:
        """Check the law, find its peaks and dwells, and place the rotor."""
        problem = self.check()
        if problem != 0:
            return problem
        self.find_peaks()
        self.dwell_angle = self.dwell(self.dwell_tolerance)
        self.clear_shed_angle = self.dwell(self.clear_fraction)
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Turn the rotor: a function of the shaft alone, exact for every step."""
        theta, speed, acceleration = self.shaft(time, step_size)
        if too_far(theta):
            return 6
        self.pick = floor(theta / (2.0 * pi))
        self.pick_event = sin(0.5 * theta)
        if self.law == SPLINE_CAM:
            return self.turn_cam(theta - self.slow_point, speed, acceleration)
        turns = floor((theta - self.slow_point) / (2.0 * pi))
        angle, first, second = self.rotor(theta - self.slow_point - 2.0 * pi * turns)
        self.rotor_angle = 2.0 * pi * turns + angle
        self.rotor_velocity = first * speed
        self.rotor_acceleration = second * speed * speed + first * acceleration
        self.lift_fraction, self.lift_rate, self.lift_acceleration = lift_fraction(
            self.rotor_angle, self.rotor_velocity, self.rotor_acceleration
        )
        self.rotor_ratio = first
        self.lift_slope = crank_slope(self.rotor_angle) * first
        self.load_shaft(self.rotor_velocity, self.rotor_acceleration, first)
        return 0

    def load_shaft(self, velocity: float, acceleration: float, ratio: float) -> None:
        """Torques and energy of the inertia that turns with this motion, at this ratio to the shaft."""
        self.rotor_torque = self.rotor_inertia * acceleration
        self.shaft_torque = self.rotor_torque * ratio
        self.kinetic_energy = 0.5 * self.rotor_inertia * velocity * velocity
        self.shaft_work = self.kinetic_energy

    def turn_cam(self, turned: float, speed: float, acceleration: float) -> int:
        """Lift the frames by the spline cam; the rotor angle is its phase."""
        turns = floor(turned / (4.0 * pi))
        x = turned - 4.0 * pi * turns
        phase, rate = cam_phase(x, self.cam_top)
        self.rotor_angle = 4.0 * pi * turns + phase
        self.rotor_velocity = rate * speed
        self.rotor_acceleration = rate * acceleration
        self.lift_fraction, first, second = self.cam(x)
        self.lift_rate = first * speed
        self.lift_acceleration = second * speed * speed + first * acceleration
        self.rotor_ratio = rate
        self.lift_slope = first
        self.load_shaft(0.5 * speed, 0.5 * acceleration, 0.5)
        return 0

    def find_peaks(self) -> None:
        """Largest speed, acceleration and jerk of the law."""
        if self.law == SPLINE_CAM:
            lowest, highest, second, third = self.spline_peaks()
            steepest = highest if highest > -lowest else -lowest
            self.highest_speed = steepest / self.cam_span
            self.highest_acceleration = second / self.cam_span
            self.highest_jerk = third / self.cam_span
        elif self.law == TABLE:
            _lowest, highest, self.highest_acceleration, self.highest_jerk = self.spline_peaks()
            self.highest_speed = 1.0 + highest
        elif self.law == SLOTTED_LEVERS or self.law == NONCIRCULAR_GEARS:
            if self.law == SLOTTED_LEVERS:
                _angle, self.highest_speed, _second = self.rotor(pi)
            else:
                _lowest, self.highest_speed = gear_speed_extremes(*self.gear_harmonic)
            self.highest_acceleration = self.largest(False)
            self.highest_jerk = self.largest(True)
        elif self.law == PLATEAU:
            self.highest_speed, self.highest_acceleration, self.highest_jerk = plateau_peaks(
                self.speed_reduction, 0.5 * self.plateau_angle, self.ramp_angle
            )
        else:
            self.highest_speed, self.highest_acceleration, self.highest_jerk = highest_rates(
                self.law, self.speed_reduction
            )

    def rate_at(self, jerk: bool, place: float) -> float:
        """Size of acceleration or jerk of a smooth law: by shaft angle, for the levers by rotor angle."""
        if self.law == SLOTTED_LEVERS:
            x = slotted_levers_place(place, self.lever_radius, self.driven_radius, self.eccentricity)
            _angle, _first, second, third = slotted_levers(
                x, self.lever_radius, self.driven_radius, self.eccentricity
            )
        else:
            _angle, _first, second, third = noncircular_gears(place, *self.gear_harmonic)
        return fabs(third) if jerk else fabs(second)

    def largest(self, jerk: bool) -> float:
        """Largest acceleration or jerk of a smooth law: 120 places of half a turn, then each crest.

        Both are as large before the slow point as behind it. By rotor angle the levers' quick stretch is
        drawn out, so that the places lie dense enough there.
        """
        step = pi / 120.0
        before = self.rate_at(jerk, -step)
        here = self.rate_at(jerk, 0.0)
        largest = 0.0
        for index in range(121):
            after = self.rate_at(jerk, step * (index + 1))
            if here >= before and here >= after and here > 0.0:
                crest = self.crest(jerk, step * (index - 1), step * (index + 1))
                if crest > largest:
                    largest = crest
                if here > largest:
                    largest = here
            before = here
            here = after
        return largest

    def crest(self, jerk: bool, start: float, end: float) -> float:
        """Largest acceleration or jerk around one crest, by golden sections: exact to rounding."""
        golden = 0.6180339887498949
        low = start
        high = end
        left = high - golden * (high - low)
        right = low + golden * (high - low)
        at_left = self.rate_at(jerk, left)
        at_right = self.rate_at(jerk, right)
        for _ in range(35):
            if at_left > at_right:
                high = right
                right = left
                at_right = at_left
                left = high - golden * (high - low)
                at_left = self.rate_at(jerk, left)
            else:
                low = left
                left = right
                at_left = at_right
                right = low + golden * (high - low)
                at_right = self.rate_at(jerk, right)
        return at_left if at_left > at_right else at_right
