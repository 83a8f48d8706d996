"""DetachingRoller: the torques that drive the detaching rollers of a cotton comber."""

from dataclasses import dataclass
from math import inf, sin
from typing import ClassVar

from ..declaring.declarations import indicator, input_, output, parameter
from ..declaring.variables import MIXED, NOTHING, Problem
from ..physics.detaching_roller import (
    DRAFT_END,
    DRAFT_START,
    assumed_fibre_share,
    assumed_motion,
    division_of,
    drafting_force,
    top_roller_torque,
)
from ..physics.shaft import too_far
from .quantities import FORCE, INERTIA, RADIUS, RATIO, SHARE, TURNING
from .shaft_driven import TOO_FAR, ShaftDriven


@dataclass(slots=True)
class DetachingRoller(ShaftDriven):
    """Detaching rollers of a comber: driving torques over a nip, one revolution of the comb cylinder.

    The shaft is the comb cylinder's: its revolutions are the nips. With `use_table` the rollers follow a
    built-in motion, an assumption; without it the inputs say how they move.
    """

    keeps: ClassVar[str] = NOTHING
    origin: ClassVar[str] = MIXED
    longest_turn: ClassVar[float] = inf
    problems: ClassVar[tuple[Problem, ...]] = (
        Problem(
            "the top roller's inertia exceeds the friction of the nip at roller_acceleration ="
            " {roller_acceleration}, so the model's drafting force is negative: increase nip_load ="
            " {nip_load} or slow down",
            warning=True,
        ),
        TOO_FAR,
    )

    use_table: bool = parameter(
        "1", True, "Use the built-in motion (assumed) instead of acceleration and fibre_share"
    )
    roller_radius: float = parameter(RADIUS, 0.0125, "Radius of a detaching roller")
    top_radius: float = parameter(RADIUS, 0.01225, "Radius of a top roller")
    roller_inertia: float = parameter(
        INERTIA.within(0.0, 1.0, nominal=1e-4), 135.64e-6, "Inertia of a detaching roller, for one unit"
    )
    top_inertia: float = parameter(
        INERTIA.within(0.0, 1.0, nominal=1e-5), 33.98e-6, "Inertia of a top roller"
    )
    nip_load: float = parameter(
        FORCE.within(0.0, 1e5, nominal=100.0), 300.0, "Load of a top roller on its detaching roller"
    )
    friction: float = parameter(RATIO.within(0.0, 2.0), 0.33, "Static friction between fibres and roller")
    units: int = parameter("1", 8, "Number of units side by side in the machine", minimum=1, maximum=1000)
    acceleration: float = input_(
        "rad/s2",
        8699.498672957831,
        "Acceleration of the rollers, used if use_table is false",
        minimum=-1e12,
        maximum=1e12,
        nominal=10000.0,
    )
    fibre_share: float = input_(
        SHARE, 1.0, "Fibres in the nip as a share of the maximum, used if use_table is false"
    )
    roller_ratio: float = input_(
        RATIO.within(-1e6, 1e6),
        0.5,
        "Velocity of the rollers relative to the shaft's, used if use_table is false",
    )
    prescribe_drafting_force: bool = parameter(
        "1", False, "Use largest_drafting_force; otherwise half of what the nip holds, by (16)"
    )
    largest_drafting_force: float = parameter(
        FORCE.within(0.0, 1e5, nominal=10.0),
        45.0,
        "Drafting force with the most fibres, used if prescribe_drafting_force is true (assumed)",
    )
    division: float = output("1", "Division of the nip, 0 to 40", nominal=10.0)
    roller_acceleration: float = output("rad/s2", "Acceleration of the rollers in use", nominal=10000.0)
    drafted_share: float = output("1", "Share of fibres in use; 0 outside divisions 18 to 30")
    drafting_force: float = output("N", "Force that drafts the fibres of a unit", nominal=10.0)
    holding_force: float = output(
        "N",
        "Force that the nip can hold: friction less what moves the top roller",
        nominal=100.0,
    )
    drafting_torque: float = output("N.m", "Torque of the drafting force on the back roller, M11")
    top_roller_torque: float = output("N.m", "Torque of a top roller on its roller, M12")
    inertia_torque: float = output("N.m", "Torque of a roller's own inertia, M13")
    back_torque: float = output("N.m", "Driving torque of the back roller of a unit, M1")
    front_torque: float = output("N.m", "Driving torque of the front roller of a unit, M2")
    unit_torque: float = output("N.m", "Driving torque of both rollers of a unit, M")
    machine_torque: float = output("N.m", "Driving torque of all units, M0", nominal=10.0)
    roller_velocity: float = output(TURNING, "Velocity of the rollers in use")
    shaft_torque: float = output(
        "N.m",
        "Torque of all units on the shaft, braking: machine_torque by the rollers' relative velocity",
        nominal=10.0,
    )
    kinetic_energy: float = output("J", "Kinetic energy of the rollers of all units")
    dissipated_power: float = output("W", "Power of the drafting forces of all units", nominal=100.0)
    nip_event: float = indicator("1", "Passes zero where the next nip begins")
    drafting_event: float = indicator("1", "Positive while fibres are drafted")

    def initialize(self, time: float) -> int:
        """Place the rollers."""
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Torques at the end of the step: a function of the shaft, or of the inputs, alone."""
        theta, speed, shaft_acceleration = self.shaft(time, step_size)
        if too_far(theta):
            return 2
        self.division = division_of(theta)
        drafting = self.division > DRAFT_START and self.division <= DRAFT_END
        self.nip_event = sin(0.5 * theta)
        self.drafting_event = (self.division - DRAFT_START) * (DRAFT_END - self.division)
        if self.use_table:
            first, second = assumed_motion(self.division)
            ratio = first
            self.roller_acceleration = second * speed * speed + first * shaft_acceleration
            self.drafted_share = assumed_fibre_share(self.division)
        else:
            ratio = self.roller_ratio
            self.roller_acceleration = self.acceleration
            self.drafted_share = self.fibre_share if drafting else 0.0
        self.top_roller_torque = top_roller_torque(
            self.roller_acceleration, self.roller_radius, self.top_radius, self.top_inertia
        )
        self.inertia_torque = self.roller_inertia * self.roller_acceleration
        resistance = self.top_roller_torque / self.roller_radius
        self.holding_force = self.friction * self.nip_load - resistance
        if self.prescribe_drafting_force:
            self.drafting_force = self.drafted_share * self.largest_drafting_force
        else:
            self.drafting_force = drafting_force(self.drafted_share, self.friction, self.nip_load, resistance)
        self.drafting_torque = self.drafting_force * self.roller_radius
        self.front_torque = self.top_roller_torque + self.inertia_torque
        self.back_torque = self.drafting_torque + self.front_torque
        self.unit_torque = self.back_torque + self.front_torque
        self.machine_torque = self.units * self.unit_torque
        self.roller_velocity = ratio * speed
        self.shaft_torque = self.machine_torque * ratio
        # both rollers of a unit, each with the inertia of M12 and M13
        top = top_roller_torque(1.0, self.roller_radius, self.top_radius, self.top_inertia)
        inertia = 2.0 * self.units * (self.roller_inertia + top)
        self.kinetic_energy = 0.5 * inertia * self.roller_velocity * self.roller_velocity
        self.dissipated_power = self.units * self.drafting_torque * self.roller_velocity
        return 1 if self.drafted_share > 0.0 and self.holding_force < 0.0 else 0
