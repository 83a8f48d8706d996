"""WeftInsertion: from the main shaft to the travel of the rapier head."""

from dataclasses import dataclass
from math import fabs, floor, inf, pi
from typing import ClassVar

from ..declaring.declarations import auxiliary, output, parameter
from ..declaring.variables import MIXED, NOTHING, Problem, Terminal
from ..physics.linkage import four_bar_margin, spherical_margin, spherical_rocker, weft_motion, wrapped
from ..physics.shaft import too_far
from .quantities import (
    ANGLE,
    BELT_MASS,
    INERTIA,
    LINK_LENGTH,
    LINK_PLACE,
    PHASE,
    RATIO,
    SMALL_MASS,
    TRAVEL,
    WHEEL_DIAMETER,
)
from .shaft_driven import TOO_FAR, ShaftDriven
from .shared_declarations import found_once
from .terminals import HEAD

FARTHEST_PHASE = pi / 3.0 + 1e-9  # of the crank from a dead centre that it is sure to belong to


@dataclass(slots=True)
class WeftInsertion(ShaftDriven):
    """Weft insertion: spherical crank-rocker, planar four-bar, sector gear, rapier wheel, rapier head."""

    problems: ClassVar[tuple[Problem, ...]] = (
        Problem(
            "the spherical linkage does not close over a whole turn: |cos(rocker_angle = {rocker_angle})|"
            " reaches or exceeds |cos(crank_cone = {crank_cone})|; choose rocker_angle nearer to 90 deg or a"
            " smaller crank_cone"
        ),
        Problem(
            "the planar four-bar does not close over the rocker's swing: crank_length = {crank_length},"
            " coupler_length = {coupler_length}, output_length = {output_length}, pivot at"
            " ({pivot_x}, {pivot_y}); its closure is {closure} and must not be negative"
        ),
        Problem("assembly = {assembly} must be -1 or 1"),
        TOO_FAR,
        Problem(
            "crank_phase = {crank_phase} is more than 60 deg from a multiple of 180 deg and does not say"
            " which dead centre is the outer one; set lead to shift the rapier against the shaft"
        ),
    )
    keeps: ClassVar[str] = NOTHING
    origin: ClassVar[str] = MIXED
    longest_turn: ClassVar[float] = inf
    terminals: ClassVar[tuple[Terminal, ...]] = (
        *ShaftDriven.terminals,
        HEAD.of("travel", "velocity", "acceleration"),
    )

    rocker_angle: float = parameter(
        ANGLE.within(0.0, pi), 1.0471975511965976, "Arc between the axes BC and AC"
    )
    crank_cone: float = parameter(
        ANGLE.within(0.0, 0.5 * pi), 0.4886921905584123, "Half-angle of the crank's cone, AC to OC"
    )
    crank_phase: float = parameter(
        PHASE,
        0.0,
        "Crank angle at shaft angle 0; the nearest multiple of 180 deg is the outer dead centre (identified)",
    )
    lead: float = parameter(
        PHASE, 0.0, "Angle by which the rapier leads the shaft, on top of crank_phase; negative if late"
    )
    rocker_offset: float = parameter(PHASE, 0.17121679962064373, "Angle between the rocker's arms BC and DC")
    planar_linkage: bool = parameter("1", True, "A planar four-bar C-D-K-G follows the rocker")
    crank_length: float = parameter(LINK_LENGTH, 0.150, "Length DC")
    coupler_length: float = parameter(LINK_LENGTH, 0.245, "Length DK")
    output_length: float = parameter(LINK_LENGTH, 0.121, "Length KG")
    pivot_x: float = parameter(LINK_PLACE, 0.243, "Position of G from C, x (identified)")
    pivot_y: float = parameter(LINK_PLACE, 0.258, "Position of G from C, y (identified)")
    assembly: int = parameter(
        "1", 1, "Assembly mode of the four-bar: 1 or -1 (identified)", minimum=-1, maximum=1
    )
    gear_ratio: float = parameter(
        RATIO.within(1e-3, 1e3), 9.625, "Gear ratio from sector gear to rapier wheel"
    )
    wheel_diameter: float = parameter(WHEEL_DIAMETER, 0.397, "Bottom diameter of the rapier wheel")
    moving_mass: float = parameter(
        SMALL_MASS.within(0.0, 100.0), 0.1105, "Mass of head and rigid belt section, counted in shaft_torque"
    )
    wheel_inertia: float = parameter(
        INERTIA.within(0.0, 10.0),
        0.0,
        "Inertia that turns with the rapier wheel (none published; 0 leaves it out)",
    )
    belt_mass: float = parameter(
        BELT_MASS.within(0.0, 10.0),
        0.0,
        "Mass of the belt per length (0 leaves it out; BeltDynamics assumes 0.05 kg/m)",
    )
    belt_length: float = parameter(
        TRAVEL.within(0.0, 20.0), 3.0, "Length of the belt behind the head, all of which moves (assumed)"
    )
    travel: float = output("m", "Travel of the rapier head from its outer dead centre", rate="velocity")
    velocity: float = output("m/s", "Velocity of the rapier head", nominal=10.0, rate="acceleration")
    acceleration: float = output("m/s2", "Acceleration of the rapier head", nominal=1000.0)
    stroke: float = found_once("m", "Travel at the inner dead centre, half a turn on")
    shaft_torque: float = output("N.m", "Torque the shaft needs to drive the moving masses", nominal=10.0)
    kinetic_energy: float = output("J", "Kinetic energy of head, belt and wheel", nominal=10.0)
    shaft_work: float = output("J", "Work taken from the shaft, now kinetic_energy", nominal=10.0)
    travel_per_angle: float = auxiliary("m", "Travel per radian of the sector gear, signed")
    sector_start: float = auxiliary("rad", "Angle of the sector gear at the outer dead centre")
    closure: float = auxiliary("m", "Margin by which the four-bar closes over the rocker's swing")

    def outer_crank(self) -> float:
        """The angle of the crank at the outer dead centre."""
        return pi * floor(self.crank_phase / pi + 0.5)

    def crank(self, theta: float) -> float:
        """The angle of the crank at an angle of the shaft."""
        return theta + self.crank_phase + self.lead

    def sector(self, crank: float) -> tuple[float, float, float]:
        """Angle of the sector gear at an angle of the crank, with its derivatives."""
        return weft_motion(
            crank,
            self.rocker_angle,
            self.crank_cone,
            self.rocker_offset,
            self.planar_linkage,
            self.crank_length,
            self.coupler_length,
            self.output_length,
            self.pivot_x,
            self.pivot_y,
            self.assembly,
        )

    def check(self) -> int:
        """Check that both linkages close over a whole turn, clear of dead points by more than rounding."""
        if spherical_margin(self.rocker_angle, self.crank_cone) < 1e-9:
            return 1
        if self.assembly == 0:
            return 3
        if fabs(self.crank_phase - self.outer_crank()) > FARTHEST_PHASE:
            return 5
        if self.planar_linkage:
            one_end, _first, _second = spherical_rocker(0.0, self.rocker_angle, self.crank_cone)
            other_end, _first, _second = spherical_rocker(pi, self.rocker_angle, self.crank_cone)
            low = (one_end if one_end < other_end else other_end) + self.rocker_offset
            high = (other_end if one_end < other_end else one_end) + self.rocker_offset
            self.closure = four_bar_margin(
                low,
                high,
                self.crank_length,
                self.coupler_length,
                self.output_length,
                self.pivot_x,
                self.pivot_y,
            )
            if self.closure < 1e-9:
                return 2
        return 0

    def initialize(self, time: float) -> int:
        """Check the linkages, find the stroke and the sign of the travel, place the head."""
        problem = self.check()
        if problem != 0:
            return problem
        outer = self.outer_crank()
        self.sector_start, _first, _second = self.sector(outer)
        middle, _first, _second = self.sector(pi + outer)
        swing = wrapped(middle - self.sector_start)
        self.travel_per_angle = 0.5 * self.gear_ratio * self.wheel_diameter
        if swing < 0.0:
            self.travel_per_angle = -self.travel_per_angle
        self.stroke = self.travel_per_angle * swing
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Move the head: a function of the shaft alone, exact for every step."""
        theta, speed, acceleration = self.shaft(time, step_size)
        if too_far(theta):
            return 4
        angle, first, second = self.sector(self.crank(theta))
        first = self.travel_per_angle * first
        second = self.travel_per_angle * second
        self.travel = self.travel_per_angle * wrapped(angle - self.sector_start)
        self.velocity = first * speed
        self.acceleration = second * speed * speed + first * acceleration
        wheel_radius = 0.5 * self.wheel_diameter
        reflected = (
            self.moving_mass
            + self.belt_mass * self.belt_length
            + self.wheel_inertia / (wheel_radius * wheel_radius)
        )
        self.shaft_torque = reflected * self.acceleration * first
        self.kinetic_energy = 0.5 * reflected * self.velocity * self.velocity
        self.shaft_work = self.kinetic_energy
        return 0
