"""ReedBeatUp: from the main shaft to the reed."""

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, fabs, inf, pi, sin, sqrt
from typing import Any, ClassVar

from ..declaring.declarations import Quantity, auxiliary, output, parameter
from ..declaring.variables import MIXED, NOTHING, Problem
from ..physics.beat_up import fell_displacement
from ..physics.linkage import four_bar, four_bar_margin, wrapped
from ..physics.reed import (
    dead_centre,
    in_line_margin,
    reed_motion,
    rod_margin,
    servo_turn,
    smallest_transmission_angle,
    transmission_angle,
)
from ..physics.shaft import too_far
from .quantities import (
    ANGLE,
    CLOTH_STIFFNESS,
    INERTIA,
    LENGTH,
    LINK_LENGTH,
    LINK_PLACE,
    MASS,
    PHASE,
    RATIO,
    SPACING,
    TURNING,
)
from .shaft_driven import TOO_FAR, ShaftDriven
from .shared_declarations import found_once


@dataclass(slots=True)
class ReedBeatUp(ShaftDriven):
    """Reed beat-up: a crank-rocker, a rod and a reed on a line; one beat-up in a revolution."""

    keeps: ClassVar[str] = NOTHING
    origin: ClassVar[str] = MIXED
    longest_turn: ClassVar[float] = inf
    problems: ClassVar[tuple[Problem, ...]] = (
        Problem(
            "the crank cannot turn full circle: crank_length = {crank_length}, coupler_length ="
            " {coupler_length}, rocker_length = {rocker_length}, crank at ({crank_x}, {crank_y}), margin"
            " {closure}; the crank must be the shortest of the four links, and together with the longest"
            " shorter than the other two"
        ),
        Problem(
            "the rod cannot follow the rocker's whole swing: arm_length = {arm_length},"
            " rod_length = {rod_length}, reed_height = {reed_height}, margin {reach}"
        ),
        Problem(
            "the rocker's arm and the reed's rod line up within the swing, where the reed would reverse:"
            " arm_length = {arm_length}, rod_length = {rod_length}, reed_height = {reed_height},"
            " margin {clearance}"
        ),
        Problem("assembly = {assembly} or crank_direction = {crank_direction} must be -1 or 1"),
        TOO_FAR,
        Problem(
            "pick_spacing = {pick_spacing} must lie between least_spacing = {least_spacing} and"
            " resistance_reach = {resistance_reach}"
        ),
    )

    crank_length: float = parameter(LINK_LENGTH, 0.065168, "Length of the crank")
    coupler_length: float = parameter(LINK_LENGTH, 0.146334, "Length of the coupler between crank and rocker")
    rocker_length: float = parameter(LINK_LENGTH, 0.550, "Length of the rocker from its pivot to the coupler")
    crank_x: float = parameter(
        LINK_PLACE,
        -0.207977,
        "Position of the crank's centre from the rocker's pivot, towards the fell (identified)",
    )
    crank_y: float = parameter(
        LINK_PLACE, 0.525749, "Position of the crank's centre from the rocker's pivot, upwards (identified)"
    )
    assembly: int = parameter("1", -1, "Assembly mode of the four-bar: 1 or -1", minimum=-1, maximum=1)
    crank_direction: int = parameter(
        "1", 1, "Direction in which the crank turns: 1 from x to y, or -1 (assumed)", minimum=-1, maximum=1
    )
    arm_length: float = parameter(
        LINK_LENGTH, 0.67984, "Length of the rocker's arm from its pivot to the reed's rod (identified)"
    )
    arm_angle: float = parameter(PHASE, 0.0, "Angle from the rocker to its arm")
    rod_length: float = parameter(LINK_LENGTH, 0.48748, "Length of the rod that drives the reed (identified)")
    reed_height: float = parameter(
        LINK_PLACE, 0.66933, "Height of the reed's line above the rocker's pivot (identified)"
    )
    beat_up_angle: float = parameter(PHASE, 0.0, "Shaft angle of the beat-up, the reed's front dead centre")
    servo: bool = parameter(
        "1", False, "A servo turns the crank in part of the revolution; otherwise the shaft turns it evenly"
    )
    run_angle: float = parameter(
        ANGLE.within(0.01, 2.0 * pi),
        pi,
        "Shaft angle of the servo's run, with the beat-up in its middle (assumed)",
    )
    ramp_share: float = parameter(
        RATIO.within(0.001, 0.5),
        0.25,
        "Share of the run in which the servo speeds up, and in which it slows down (assumed)",
    )
    reed_mass: float = parameter(
        MASS.within(0.0, 1e4),
        1.0,
        "Mass that moves with the reed (none published: the torque is per kilogram)",
    )
    rocker_inertia: float = parameter(
        INERTIA.within(0.0, 1e4), 0.0, "Inertia of the rocker about its pivot (none published)"
    )
    weaving_resistance: float = parameter(
        Quantity("N.m", minimum=0.0, maximum=1e6, nominal=0.1),
        0.0,
        "Resistance of a pick against beat-up, times its spacing less least_spacing; 0: no cloth is woven",
    )
    warp_stiffness: float = parameter(
        CLOTH_STIFFNESS, 1.5e5, "Stiffness of all warp threads, from fell to back rest (assumed)"
    )
    cloth_stiffness: float = parameter(
        CLOTH_STIFFNESS, 3.75e5, "Stiffness of the cloth, from fell to take-up (assumed)"
    )
    pick_spacing: float = parameter(
        SPACING, 0.5e-3, "Spacing of the picks, as the cloth is taken up (assumed)"
    )
    least_spacing: float = parameter(SPACING, 0.3e-3, "Spacing to which no force could beat a pick (assumed)")
    resistance_reach: float = parameter(
        SPACING, 2e-3, "Distance from the pick before it at which a pick begins to resist (assumed)"
    )
    position: float = output(
        LENGTH, "Reed coordinate from the rocker's pivot, towards the fell", nominal=0.1, rate="velocity"
    )
    velocity: float = output("m/s", "Velocity of the reed", rate="acceleration")
    acceleration: float = output("m/s2", "Acceleration of the reed", nominal=100.0)
    transmission_angle: float = output(
        ANGLE, "Transmission angle of the crank-rocker; 90 deg is best", nominal=1.5
    )
    smallest_transmission_angle: float = found_once(
        ANGLE, "Smallest transmission angle in a revolution", nominal=1.5
    )
    pressure_angle: float = output(
        ANGLE, "Pressure angle of the reed's rod: its slope against the reed's line"
    )
    front_limit: float = found_once(LENGTH, "Reed coordinate at the beat-up", nominal=0.1)
    back_limit: float = found_once(LENGTH, "Reed coordinate at the back dead centre", nominal=0.1)
    stroke: float = found_once(LENGTH, "Travel of the reed between its limits", nominal=0.1)
    shaft_torque: float = output(
        "N.m",
        "Torque the shaft needs to drive the moving masses and to beat up; 0 with a servo",
        nominal=10.0,
    )
    fell_displacement: float = output(
        LENGTH, "Displacement of the fell by the reed, towards the cloth", nominal=1e-3, rate="fell_velocity"
    )
    fell_velocity: float = output("m/s", "Velocity of the fell")
    beat_up_force: float = output(
        "N", "Force of the reed on the fell", nominal=100.0, rate="beat_up_force_rate"
    )
    beat_up_force_rate: float = output("N/s", "Rate of beat_up_force", nominal=1e5)
    passed_torque: float = output(
        "N.m", "Part of shaft_torque that beats up: its work is not in shaft_work", nominal=10.0
    )
    crank_velocity: float = output(TURNING, "Velocity of the crank in its direction")
    crank_torque: float = output(
        "N.m", "Torque the crank needs in its direction, from the shaft or the servo", nominal=10.0
    )
    kinetic_energy: float = output("J", "Kinetic energy of reed and rocker", nominal=10.0)
    shaft_work: float = output(
        "J", "Work taken from the shaft, now kinetic_energy; 0 with a servo", nominal=10.0
    )
    beat_up_crank: float = auxiliary("rad", "Crank angle at the beat-up")
    closure: float = auxiliary("m", "Margin by which the crank-rocker closes over a whole turn")
    reach: float = auxiliary("m", "Margin by which the rod reaches the reed's line over the swing")
    clearance: float = auxiliary("rad", "Margin by which arm and rod stay out of line over the swing")

    def rocker(self, crank: float, crank_first: float) -> tuple[float, float, float]:
        """Angle of the rocker at a crank angle, with its derivatives by the crank's turn."""
        return four_bar(
            crank,
            crank_first,
            0.0,
            self.crank_length,
            self.coupler_length,
            self.rocker_length,
            -self.crank_x,
            -self.crank_y,
            self.assembly,
        )

    def swing_end(self, extended: bool) -> tuple[float, float]:
        """Crank angle and angle of the rocker's arm at an end of the swing."""
        crank = dead_centre(
            self.crank_length,
            self.coupler_length,
            self.rocker_length,
            -self.crank_x,
            -self.crank_y,
            self.assembly,
            extended,
        )
        angle, _first, _second = self.rocker(crank, 0.0)
        return crank, angle + self.arm_angle

    @classmethod
    def shortest_event(cls, value: Callable[[str], Any]) -> tuple[float, str]:
        """The run of the servo, or four times its speeding up, or the way to the beat-up on the fell."""
        run, run_name = inf, "the run of the servo"
        if value("servo"):
            run = min(1.0, 4.0 * value("ramp_share")) * value("run_angle")
        if not value("weaving_resistance"):
            return run, run_name
        # the reed is nowhere quicker than twice what a long coupler would make of it near its dead centre
        quickest = 2.0 * value("crank_length") * value("arm_length") / value("rocker_length")
        beat = sqrt(2.0 * (value("resistance_reach") - value("pick_spacing")) / quickest)
        if value("servo"):
            beat *= (1.0 - value("ramp_share")) * value("run_angle") / (2.0 * pi)
        return min((run, run_name), (beat, "the way of the pick into the fell"))

    def check(self) -> int:
        """Check that the crank makes full turns and that the rod swings the reed, clear of dead points."""
        if self.assembly == 0 or self.crank_direction == 0:
            return 4
        if not self.least_spacing < self.pick_spacing < self.resistance_reach:
            return 6
        frame = sqrt(self.crank_x * self.crank_x + self.crank_y * self.crank_y)
        self.closure = four_bar_margin(
            0.0,
            2.0 * pi,
            self.crank_length,
            self.coupler_length,
            self.rocker_length,
            -self.crank_x,
            -self.crank_y,
        )
        if frame - self.crank_length < self.closure:
            self.closure = frame - self.crank_length
        if self.closure < 1e-9:
            return 1
        _crank, one_end = self.swing_end(True)
        _crank, other_end = self.swing_end(False)
        half_swing = 0.5 * wrapped(other_end - one_end)
        middle = one_end + half_swing
        half_swing = fabs(half_swing)
        self.reach = rod_margin(middle, half_swing, self.arm_length, self.rod_length, self.reed_height)
        if self.reach < 1e-9:
            return 2
        self.clearance = in_line_margin(
            middle, half_swing, self.arm_length, self.rod_length, self.reed_height
        )
        return 3 if self.clearance < 1e-9 else 0

    def initialize(self, time: float) -> int:
        """Check the linkages, find the limits of the reed, place it."""
        problem = self.check()
        if problem != 0:
            return problem
        frame = sqrt(self.crank_x * self.crank_x + self.crank_y * self.crank_y)
        self.smallest_transmission_angle = smallest_transmission_angle(
            self.crank_length, self.coupler_length, self.rocker_length, frame
        )
        self.beat_up_crank, arm = self.swing_end(True)
        self.front_limit, _first, _second, _pressure = self.reed(arm, 0.0, 0.0)
        other_crank, arm = self.swing_end(False)
        self.back_limit, _first, _second, _pressure = self.reed(arm, 0.0, 0.0)
        if self.front_limit < self.back_limit:
            self.front_limit, self.back_limit = self.back_limit, self.front_limit
            self.beat_up_crank = other_crank
        self.stroke = self.front_limit - self.back_limit
        return self.step(time, 0.0)

    def reed(self, arm: float, first: float, second: float) -> tuple[float, float, float, float]:
        """Reed coordinate with its derivatives by the crank's turn, and the pressure angle."""
        return reed_motion(arm, first, second, self.arm_length, self.rod_length, self.reed_height)

    def step(self, time: float, step_size: float) -> int:
        """Move the reed: a function of the shaft alone, exact for every step."""
        theta, speed, acceleration = self.shaft(time, step_size)
        if too_far(theta):
            return 5
        turned = theta - self.beat_up_angle
        by_theta = 1.0
        bend = 0.0
        if self.servo:
            turned, by_theta, bend = servo_turn(turned, self.run_angle, self.ramp_share * self.run_angle)
        turning = by_theta * speed
        quickening = bend * speed * speed + by_theta * acceleration
        self.crank_velocity = turning
        crank = self.beat_up_crank + self.crank_direction * turned
        angle, first, second = self.rocker(crank, 1.0 * self.crank_direction)
        self.position, slope, curve, self.pressure_angle = self.reed(angle + self.arm_angle, first, second)
        self.velocity = slope * turning
        self.acceleration = curve * turning * turning + slope * quickening
        x = self.crank_x + self.crank_length * cos(crank)
        y = self.crank_y + self.crank_length * sin(crank)
        self.transmission_angle = transmission_angle(
            sqrt(x * x + y * y), self.coupler_length, self.rocker_length
        )
        rocker_acceleration = second * turning * turning + first * quickening
        stiffness = self.warp_stiffness + self.cloth_stiffness
        self.fell_displacement, by_way = fell_displacement(
            self.front_limit - self.position,
            self.velocity < 0.0,
            self.weaving_resistance,
            stiffness,
            self.least_spacing,
            self.pick_spacing,
            self.resistance_reach,
        )
        self.fell_velocity = by_way * self.velocity
        self.beat_up_force = stiffness * self.fell_displacement
        self.beat_up_force_rate = stiffness * self.fell_velocity
        beating = self.beat_up_force * slope
        self.crank_torque = (
            self.reed_mass * self.acceleration * slope
            + self.rocker_inertia * rocker_acceleration * first
            + beating
        )
        self.passed_torque = 0.0 if self.servo else beating
        self.shaft_torque = 0.0 if self.servo else self.crank_torque
        rocker_velocity = first * turning
        self.kinetic_energy = 0.5 * (
            self.reed_mass * self.velocity * self.velocity
            + self.rocker_inertia * rocker_velocity * rocker_velocity
        )
        self.shaft_work = 0.0 if self.servo else self.kinetic_energy
        return 0
