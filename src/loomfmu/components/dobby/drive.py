"""DobbyDrive: the rotor of the dobby with its speed modulator."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import asin, fabs, floor, inf, pi, sin, sqrt
from typing import Any, ClassVar

from ...declaring.arrays import array
from ...declaring.declarations import auxiliary, indicator, output, parameter
from ...declaring.variables import MIXED, NOTHING, Problem, Terminal
from ...physics.heald import crank_slope, lift_fraction
from ...physics.numerics.brackets import at_root, nearer_root
from ...physics.numerics.spline import Cubic, cubic_piece, slope_extremes, stretch_above, turning_points
from ...physics.rotor_laws.mechanisms import (
    NONCIRCULAR_GEARS,
    SLOTTED_LEVERS,
    gear_speed_extremes,
    noncircular_gears,
    slotted_levers,
)
from ...physics.rotor_laws.plateau import PLATEAU, plateau_law, plateau_peaks
from ...physics.rotor_laws.rotor import dwell_angle, highest_rates, rotor_law
from ...physics.rotor_laws.shed_cam import SPLINE_CAM, cam_phase, not_a_knot
from ...physics.rotor_laws.table import TABLE, bend_weight
from ...physics.shaft import too_far
from ..quantities import ANGLE, DISTANCE, EITHER_WAY, INERTIA, LENGTH, LEVER, RATIO, SHARE, TURN, TURNING
from ..shaft_driven import TOO_FAR, ShaftDriven
from ..shared_declarations import found_once
from ..terminals import OF_ROTOR, ROTOR
from .peaks import SmoothLaw, highest_of


@dataclass(slots=True)
class DobbyDrive(ShaftDriven):
    """Dobby drive: a rotor that turns once a pick, slowed while the pattern changes.

    With the law `spline_cam` there is no such rotor: a cam lifts and lowers the frames directly, once in
    two picks, and the rotor angle is only its phase.
    """

    keeps: ClassVar[str] = NOTHING
    origin: ClassVar[str] = MIXED
    longest_turn: ClassVar[float] = inf
    terminals: ClassVar[tuple[Terminal, ...]] = (*ShaftDriven.terminals, ROTOR.of(*OF_ROTOR))
    problems: ClassVar[tuple[Problem, ...]] = (
        Problem(
            "eccentricity = {eccentricity} reaches or exceeds lever_radius = {lever_radius} or driven_radius"
            " = {driven_radius}: the levers cannot turn full circle; it must be smaller than both"
        ),
        Problem(
            "the rotor would stop or reverse: with gear_harmonic_1 = {gear_harmonic_1} to gear_harmonic_4 ="
            " {gear_harmonic_4} its lowest speed is {lowest_speed} of the shaft's and must be above 0"
        ),
        Problem(
            "the rotor would stop or reverse: with the {table_points} points of its table its lowest speed is"
            " {lowest_speed} of the shaft's and must be above 0; the points must rise without sharp bends"
        ),
        Problem(
            "cam_angle_1 = {cam_angle_1} to cam_angle_6 = {cam_angle_6} must rise from 0 to 720 deg, each by"
            " 0.01 deg or more"
        ),
        Problem(
            "the cam's spline starts at cam_height_1 = {cam_height_1}, ends at cam_height_6 = {cam_height_6}"
            " and rises by {cam_span}; both ends must be equal, and it must rise"
        ),
        TOO_FAR,
        Problem(
            "half of plateau_angle = {plateau_angle} and ramp_angle = {ramp_angle} exceed 180 deg; reduce one"
        ),
        Problem(
            "law = table has no table: table_1 to table_36 are those of an even turn; set table_points and"
            " table_1, table_2, ..., or law = uniform"
        ),
    )

    law: int = parameter(
        "1",
        4,
        "Rotor law",
        choices=(
            "uniform",
            "harmonic_ends",
            "sloped_line",
            "sloped_sine",
            "slotted_levers",
            "noncircular_gears",
            "spline_cam",
            "table",
            "plateau",
        ),
    )
    speed_reduction: float = parameter(
        SHARE,
        0.5,
        "Share by which the rotor slows down at the slow point, zeta (harmonic_ends, sloped_..., plateau)",
    )
    slow_point: float = parameter(
        EITHER_WAY,
        pi,
        "Shaft angle of the slow point, the middle of the open-shed dwell; start of the rise for spline_cam",
    )
    dwell_tolerance: float = parameter(
        RATIO.within(1e-9, 0.5), 0.015, "Share of the stroke within which a frame counts as dwelling"
    )
    clear_fraction: float = parameter(
        RATIO.within(1e-9, 0.5),
        0.08325,
        "Share of the stroke within which the warp counts as clear of the weft",
    )
    lever_radius: float = parameter(
        LEVER, 0.1, "Radius of the pin on the driving pulley (slotted_levers; assumed)"
    )
    driven_radius: float = parameter(
        LEVER, 0.1, "Radius of the pin on the lever about the eccentric (slotted_levers; assumed)"
    )
    eccentricity: float = parameter(
        DISTANCE, 0.04, "Distance of the eccentric from the shaft (slotted_levers; assumed)"
    )
    gear_harmonic: tuple[float, ...] = array(
        parameter(
            RATIO.within(-10.0, 10.0),
            share,
            f"Amplitude of the {which} harmonic of the rotor speed (noncircular_gears; assumed)",
        )
        for share, which in ((-0.27, "1st"), (-0.13, "2nd"), (-0.05, "3rd"), (-0.025, "4th"))
    )
    cam_angle: tuple[float, ...] = array(
        parameter(
            ANGLE.within(0.0, 4.0 * pi),
            degrees * pi / 180.0,
            f"Shaft angle of control point {number}, from the start of the rise",
        )
        for number, degrees in enumerate((0.0, 80.0, 295.0, 450.0, 657.0, 720.0), start=1)
    )
    cam_height: tuple[float, ...] = array(
        parameter(
            LENGTH.within(-1.0, 1.0, nominal=0.01),
            height,
            f"Height at control point {number}, of the warp in the air stream (Table 4.2)",
        )
        for number, height in enumerate((0.0, 0.002, 0.015, 0.0145, 0.0015, 0.0), start=1)
    )
    table_points: int = parameter(
        "1", 36, "Number of points, evenly spaced over a turn from the slow point", minimum=4, maximum=36
    )
    table: tuple[float, ...] = array(  # by default that of an even turn
        parameter(
            ANGLE.within(-2.0 * pi, 4.0 * pi),
            2.0 * pi * point / 36,
            f"Rotor angle at point {point + 1} of the table",
        )
        for point in range(36)
    )
    plateau_angle: float = parameter(
        TURN,
        0.5 * pi,
        "Shaft angle of lowest speed, half to either side of the slow point (plateau; inferred)",
    )
    ramp_angle: float = parameter(
        ANGLE.within(pi / 180.0, pi),
        40.9 * pi / 180.0,
        "Shaft angle from lowest to highest speed (plateau; inferred)",
    )
    cam_bend: Sequence[float] = array(
        auxiliary("m", f"Second derivative of the cam's spline at control point {number}")
        for number in range(1, 7)
    )
    cam_top: float = auxiliary(
        "rad", "Shaft angle from the start of the rise to the highest point of the cam"
    )
    cam_span: float = auxiliary("m", "Largest height of the cam's spline above its start")
    lowest_speed: float = auxiliary("1", "Lowest rotor speed over the shaft's, for laws that could reverse")
    segment: int = auxiliary(
        "1", "Current segment of the spline, counted from 0; -1 for none", start=-1, minimum=-1, maximum=36
    )
    segment_start: float = auxiliary("rad", "Start of the current segment")
    segment_length: float = auxiliary("rad", "Length of the current segment", minimum=0.0)
    segment_left: float = auxiliary("1", "Value at the start of the current segment")
    segment_right: float = auxiliary("1", "Value at the end of the current segment")
    segment_left_bend: float = auxiliary("1", "Second derivative at the start of the current segment")
    segment_right_bend: float = auxiliary("1", "Second derivative at the end of the current segment")
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
        ANGLE, "Shaft angle for which a changing frame stays within dwell_tolerance of its end", nominal=1.5
    )
    clear_shed_angle: float = found_once(
        ANGLE, "Shaft angle for which a changing frame stays within clear_fraction of its end", nominal=1.5
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

    @classmethod
    def shortest_event(cls, value: Callable[[str], Any]) -> tuple[float, str]:
        """The ramp of a plateau, or what points of a table or of a cam make the rotor do."""
        law = value("law")
        if law == PLATEAU:
            return value("ramp_angle"), "the ramp of the plateau"
        if law == TABLE:
            return 4.0 * pi / value("table_points"), "what a point of the table does to the rotor"
        if law == SPLINE_CAM:
            angles = [value(f"cam_angle_{number}") for number in range(1, 7)]
            return min(b - a for a, b in pairwise(angles)), "a part of the cam"
        return inf, ""

    def check(self) -> int:
        """Check that the law can be driven: the rotor makes full turns and never turns back."""
        self.segment = -1
        if self.law == SLOTTED_LEVERS:
            if self.eccentricity >= self.lever_radius or self.eccentricity >= self.driven_radius:
                return 1
        elif self.law == NONCIRCULAR_GEARS:
            self.lowest_speed, _highest = gear_speed_extremes(*self.gear_harmonic)
            if self.lowest_speed <= 0.0:
                return 2
        elif self.law == TABLE:
            lowest, _highest, second, _third = self.spline_peaks()
            if second == 0.0:
                return 8
            self.lowest_speed = 1.0 + lowest
            if self.lowest_speed <= 0.0:
                return 3
        elif self.law == SPLINE_CAM:
            return self.check_cam()
        elif self.law == PLATEAU and 0.5 * self.plateau_angle + self.ramp_angle > pi + 1e-12:
            return 7
        return 0

    def check_cam(self) -> int:
        """Check that the cam's points make a law; set its spline and its highest point."""
        if self.cam_angle[0] != 0.0 or fabs(self.cam_angle[5] - 4.0 * pi) > 1e-9:
            return 4
        for index in range(5):
            if self.cam_angle[index + 1] - self.cam_angle[index] < 1.745e-4:
                return 4
        self.cam_bend = not_a_knot(list(self.cam_angle), list(self.cam_height))
        self.find_top()
        if fabs(self.cam_height[5] - self.cam_height[0]) > 1e-9 or self.cam_span < 1e-9:
            return 5
        return 0

    def find_top(self) -> None:
        """Highest point of the cam's spline."""
        self.cam_top = 0.0
        self.cam_span = 0.0
        for index in range(5):
            self.load(index)
            segment = self.cubic()
            first, second = turning_points(segment)
            for place in range(3):
                distance = self.segment_length
                if place == 0:
                    distance = first
                if place == 1:
                    distance = second
                height, _slope, _bend, _third = self.piece(distance)
                if height - self.cam_height[0] > self.cam_span:
                    self.cam_span = height - self.cam_height[0]
                    self.cam_top = self.segment_start + distance

    def deviation(self, index: int) -> float:
        """By how much a point of the table is ahead of an even turn; counted from 0, round and round."""
        point = index % self.table_points
        return self.table[point] - 2.0 * pi * point / self.table_points

    def table_bend(self, index: int) -> float:
        """Second derivative of the table's spline at a point, counted from 0."""
        before = self.deviation(index + self.table_points - 1)
        here = self.deviation(index)
        bend = 0.0
        for distance in range(self.table_points):
            after = self.deviation(index + distance + 1)
            bend = bend + bend_weight(distance, self.table_points) * (before - 2.0 * here + after)
            before = here
            here = after
        return bend

    def load(self, index: int) -> None:
        """Make a segment of the spline the present one."""
        if index != self.segment:
            if self.law == SPLINE_CAM:
                self.segment_start = self.cam_angle[index]
                self.segment_length = self.cam_angle[index + 1] - self.segment_start
                self.segment_left = self.cam_height[index]
                self.segment_right = self.cam_height[index + 1]
                self.segment_left_bend = self.cam_bend[index]
                self.segment_right_bend = self.cam_bend[index + 1]
            else:
                self.segment_length = 2.0 * pi / self.table_points
                self.segment_start = self.segment_length * index
                self.segment_left = self.deviation(index)
                if index == self.segment + 1 and self.segment >= 0:
                    self.segment_left_bend = self.segment_right_bend
                else:
                    self.segment_left_bend = self.table_bend(index)
                self.segment_right = self.deviation(index + 1)
                self.segment_right_bend = self.table_bend(index + 1)
            self.segment = index

    def cubic(self) -> Cubic:
        """The present segment of the spline."""
        return Cubic(
            self.segment_length,
            self.segment_left,
            self.segment_right,
            self.segment_left_bend,
            self.segment_right_bend,
        )

    def piece(self, distance: float) -> tuple[float, float, float, float]:
        """Value and derivatives of the spline at a distance from the start of the present segment."""
        segment = self.cubic()
        return cubic_piece(segment, distance)

    def spline_peaks(self) -> tuple[float, float, float, float]:
        """Lowest and highest slope of the spline, its largest second and third derivative."""
        lowest = 1e300
        highest = -1e300
        second = 0.0
        third = 0.0
        segments = self.table_points if self.law == TABLE else 5
        for index in range(segments):
            self.load(index)
            segment = self.cubic()
            low, high = slope_extremes(segment)
            lowest = low if low < lowest else lowest
            highest = high if high > highest else highest
            for end in range(2):
                _value, _slope, bend, change = self.piece(end * self.segment_length)
                second = fabs(bend) if fabs(bend) > second else second
                third = fabs(change) if fabs(change) > third else third
        return lowest, highest, second, third

    def rotor(self, x: float) -> tuple[float, float, float]:
        """Rotor angle and its derivatives over one turn, 0 to 2 pi from the slow point."""
        if self.law == SLOTTED_LEVERS:
            angle, first, second, _third = slotted_levers(
                x, self.lever_radius, self.driven_radius, self.eccentricity
            )
            return angle, first, second
        if self.law == NONCIRCULAR_GEARS:
            angle, first, second, _third = noncircular_gears(x, *self.gear_harmonic)
            return angle, first, second
        if self.law == TABLE:
            index = floor(x * self.table_points / (2.0 * pi))
            if index >= self.table_points:
                index = self.table_points - 1
            self.load(index if index > 0 else 0)
            ahead, first, second, _third = self.piece(x - self.segment_start)
            return x + ahead, 1.0 + first, second
        if self.law == PLATEAU:
            return plateau_law(x, self.speed_reduction, 0.5 * self.plateau_angle, self.ramp_angle)
        return rotor_law(self.law, x, self.speed_reduction)

    def cam(self, x: float) -> tuple[float, float, float]:
        """Height of the cam over its start, as a share of the largest, and its derivatives, 0 to 4 pi."""
        index = 0
        for knot in range(1, 5):
            if x >= self.cam_angle[knot]:
                index = knot
        self.load(index)
        height, slope, bend, _third = self.piece(x - self.segment_start)
        return (height - self.cam_height[0]) / self.cam_span, slope / self.cam_span, bend / self.cam_span

    def dwell(self, tolerance: float) -> float:
        """Shaft angle during which a changing frame stays within a share of its stroke of its end.

        For the rotor laws around the slow point; for the spline cam around its top, in two picks.
        """
        if self.law == SPLINE_CAM:
            return self.angle_above(self.cam_height[0] + (1.0 - tolerance) * self.cam_span)
        if self.law >= SLOTTED_LEVERS:
            reach = 4.0 * asin(sqrt(tolerance))
            late = self.place_of(reach)
            return late - self.place_of(-reach)
        return dwell_angle(self.law, self.speed_reduction, tolerance)

    def angle_above(self, level: float) -> float:
        """Shaft angle during which the cam's spline lies at or above a height, in two picks."""
        total = 0.0
        for index in range(5):
            self.load(index)
            segment = self.cubic()
            total = total + stretch_above(segment, level)
        return total

    def place_of(self, angle: float) -> float:
        """Shaft angle from the slow point at which the rotor has an angle, by Newton steps in a bracket."""
        start, _first, _second = self.rotor(0.0)
        turns = floor((angle - start) / (2.0 * pi))
        target = angle - 2.0 * pi * turns
        low = 0.0
        high = 2.0 * pi
        if self.law == TABLE:
            for index in range(1, self.table_points):
                if self.table[index] <= target:
                    low = 2.0 * pi * index / self.table_points
            high = low + 2.0 * pi / self.table_points
        x = 0.5 * (low + high)
        for _ in range(200):
            reached, first, _second = self.rotor(x)
            if reached > target:
                high = x
            else:
                low = x
            nearer = nearer_root(low, high, x, reached - target, first)
            if nearer == x or high - low <= 1e-16 * high:
                break
            x = nearer
        reached, first, _second = self.rotor(x)
        return at_root(x, reached - target, first) + 2.0 * pi * turns

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
            law = SmoothLaw(
                self.law == SLOTTED_LEVERS,
                self.lever_radius,
                self.driven_radius,
                self.eccentricity,
                list(self.gear_harmonic),
            )
            self.highest_acceleration = highest_of(law, False)
            self.highest_jerk = highest_of(law, True)
        elif self.law == PLATEAU:
            self.highest_speed, self.highest_acceleration, self.highest_jerk = plateau_peaks(
                self.speed_reduction, 0.5 * self.plateau_angle, self.ramp_angle
            )
        else:
            self.highest_speed, self.highest_acceleration, self.highest_jerk = highest_rates(
                self.law, self.speed_reduction
            )
