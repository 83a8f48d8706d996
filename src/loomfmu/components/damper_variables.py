"""Declarations of HealdDamper: what it is given, shows and keeps."""

from dataclasses import dataclass
from math import inf
from typing import ClassVar

from ..declaring.declarations import at_step_end, input_, output, parameter, state
from ..declaring.variables import MIXED, Problem, Terminal
from .shared_declarations import frame_acceleration, frame_lift, frame_velocity
from .terminals import CARRIER, FRAME
from .threads import Threads


@dataclass(slots=True)
class DamperVariables(Threads):
    """Variables of the damper, and what it declares of itself."""

    problems: ClassVar[tuple[Problem, ...]] = (
        Problem(
            "the step spans more than 10,000 contacts or pieces of the carrier's motion"
            " (spring_stiffness = {spring_stiffness}, damping_ratio = {damping_ratio}, stop_stiffness ="
            " {stop_stiffness}, carrier_mass = {carrier_mass}); use a smaller step"
        ),
        Problem(
            "start_displacement = {start_displacement} must lie between the stops at"
            " free_travel = {free_travel}"
        ),
    )
    terminals: ClassVar[tuple[Terminal, ...]] = (
        FRAME.of("lift", "velocity", "acceleration"),
        CARRIER.of("carrier_lift", "carrier_velocity", "carrier_acceleration"),
    )
    origin: ClassVar[str] = MIXED
    accuracy: ClassVar[str] = "sixth order in the step; second where threads turn slack, or with warp_force"
    longest_turn: ClassVar[float] = inf

    thread_count: int = parameter(
        "1",
        0,
        "Number of threads that the carrier lifts; 0 for no warp",
        minimum=0,
        maximum=1000000,
        source="warp_#.thread_count",
    )

    carrier_mass: float = parameter(
        "kg",
        7.5,
        "Mass of the heald carrier with its healds (assumed: half of the published 15 kg)",
        minimum=1e-3,
        maximum=1e3,
        nominal=10.0,
    )
    spring_stiffness: float = parameter(
        "N/m",
        5960.0,
        "Stiffness of one of the four springs",
        display="N/mm",
        minimum=0.0,
        maximum=1e12,
        nominal=1e4,
    )
    damping_ratio: float = parameter(
        "1",
        0.05,
        "Damping ratio of the suspension, relative to critical (assumed: none published)",
        minimum=0.0,
        maximum=100.0,
    )
    free_travel: float = parameter(
        "m",
        0.015,
        "Free travel of the carrier to either side",
        display="mm",
        minimum=0.0,
        maximum=1.0,
        nominal=0.01,
    )
    stop_stiffness: float = parameter(
        "N/m",
        2e6,
        "Stiffness of a stop (assumed: none published)",
        display="N/mm",
        minimum=1.0,
        maximum=1e12,
        nominal=1e6,
    )
    stop_restitution: float = parameter(
        "1", 0.5, "Coefficient of restitution of a stop (assumed)", minimum=0.15, maximum=1.0
    )
    start_displacement: float = parameter(
        "m", 0.0, "Displacement of the carrier at the start", display="mm", minimum=-1.0, maximum=1.0
    )
    start_rate: float = parameter(
        "m/s", 0.0, "Rate of the displacement at the start", minimum=-1e3, maximum=1e3
    )
    inputs_at_step_end: bool = at_step_end()
    lift: float = frame_lift(0.0)
    velocity: float = frame_velocity()
    acceleration: float = frame_acceleration(10.0)
    warp_force: float = input_(
        "N",
        0.0,
        "Further load on the carrier, upwards, such as a warp model of your own",
        nominal=100.0,
        minimum=-1e12,
        maximum=1e12,
    )
    displacement: float = output(
        "m", "Displacement of the carrier in its frame", display="mm", nominal=0.01, rate="rate"
    )
    rate: float = output("m/s", "Rate of the displacement")
    spring_force: float = output("N", "Force of the four springs on the frame", nominal=100.0)
    stop_force: float = output("N", "Force of the carrier on a stop", nominal=1000.0)
    transmitted_force: float = output(
        "N", "Force of the carrier on the frame: springs, damping, stops", nominal=1000.0
    )
    carrier_lift: float = output(
        "m",
        "Lift of the carrier, that of its frame and its displacement",
        display="mm",
        nominal=0.1,
        rate="carrier_velocity",
    )
    carrier_velocity: float = output("m/s", "Velocity of the carrier in space", rate="carrier_acceleration")
    carrier_acceleration: float = output("m/s2", "Acceleration of the carrier in space", nominal=100.0)
    warp_load: float = output("N", "Load of the threads on the carrier, positive upwards", nominal=100.0)
    stop_contacts: int = output("1", "Contacts with a stop so far", start=0, so_far=True)
    peak_load: float = output(
        "N", "Largest transmitted force so far, on the continuous curve", nominal=1000.0, so_far=True
    )
    acceleration_ratio: float = output(
        "1",
        "Largest acceleration of the carrier so far relative to the frame's; 0 while the frame rests",
        nominal=10.0,
    )
    kinetic_energy: float = output("J", "Kinetic energy of the carrier in space", nominal=10.0)
    potential_energy: float = output(
        "J", "Energy of springs and stop, from where the carrier hangs balanced", nominal=1.0
    )
    dissipated_power: float = output("W", "Power lost in the damping of suspension and stop", nominal=10.0)
    frame_work: float = output(
        "J", "Work of the frame on carrier and warp so far: that of transmitted_force, reversed", nominal=10.0
    )
    damping: float = state("N.s/m", "Damping of the suspension", minimum=0.0)
    stop_damping: float = state("N.s/m", "Damping of a stop", minimum=0.0)
    contact: int = state(
        "1", "0 free, 1 and -1 on the upper and lower stop, 2 and -2 released", start=0, minimum=-2, maximum=2
    )
    sampled_lift: float = state("m", "Lift at the last sample of the inputs")
    sampled_velocity: float = state("m/s", "Velocity at the last sample")
    sampled_acceleration: float = state("m/s2", "Acceleration at the last sample")
    sampled_force: float = state("N", "Further load at the last sample")
    thread_force: float = state("N", "Force of all threads above their pretension")
    largest_lift: float = state("m", "Largest absolute lift so far, the measure of its rounding", minimum=0.0)
    peak_carrier: float = state("m/s2", "Largest acceleration of the carrier so far", minimum=0.0)
    peak_frame: float = state("m/s2", "Largest acceleration of the frame so far", minimum=0.0)
