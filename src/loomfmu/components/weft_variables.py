"""Declarations of WeftTension: what it is given, shows and keeps."""

from dataclasses import dataclass
from math import inf
from typing import ClassVar

from ..declaring.arrays import array
from ..declaring.declarations import auxiliary, output, parameter, state
from ..declaring.variables import Problem, Terminal
from ..physics.weft_way import PROGRAM_POINTS
from .head_inputs import head_acceleration, head_travel, head_velocity
from .shaft_driven import TOO_FAR, ShaftDriven
from .terminals import HEAD

FOLLOWED = "followed"  # what says when other outputs are known


@dataclass(slots=True)
class WeftVariables(ShaftDriven):
    """Variables of the weft yarn, and what it declares of itself."""

    problems: ClassVar[tuple[Problem, ...]] = (TOO_FAR,)
    terminals: ClassVar[tuple[Terminal, ...]] = (
        *ShaftDriven.terminals,
        HEAD.of("travel", "velocity", "acceleration"),
    )
    accuracy: ClassVar[str] = (
        "exact at samples while the brake yields, fourth order in the step while it holds"
    )
    longest_turn: ClassVar[float] = inf

    linear_density: float = parameter(
        "kg/m",
        30e-6,
        "Linear density of the yarn (assumed)",
        display="tex",
        minimum=0.0,
        maximum=1.0,
        nominal=1e-5,
    )
    yarn_stiffness: float = parameter(
        "N",
        75.0,
        "Tensile stiffness EA of the yarn, force per strain (assumed)",
        minimum=1e-6,
        maximum=1e6,
        nominal=100.0,
    )
    retardation_time: float = parameter(
        "s",
        1e-4,
        "Retardation time of the yarn, viscosity over stiffness (assumed)",
        display="ms",
        minimum=1e-9,
        maximum=1.0,
        nominal=1e-4,
    )
    yarn_diameter: float = parameter(
        "m",
        0.2e-3,
        "Diameter of the yarn, for its air drag (assumed)",
        display="mm",
        minimum=0.0,
        maximum=0.01,
        nominal=1e-4,
    )
    air_friction: float = parameter(
        "1",
        0.04,
        "Coefficient of friction in air along the yarn, for its circumference (assumed)",
        minimum=0.0,
        maximum=10.0,
        nominal=0.1,
    )
    supply_tension: float = parameter(
        "N",
        0.05,
        "Tension at the package without speed (assumed)",
        display="cN",
        minimum=0.0,
        maximum=1e3,
        nominal=0.1,
    )
    unwinding_factor: float = parameter(
        "1",
        1.0,
        "Unwinding tension over that of the yarn's momentum; above 1 with a balloon (assumed)",
        minimum=0.0,
        maximum=100.0,
    )
    brake_force: float = parameter(
        "N",
        0.2,
        "Force of the yarn brake, where brake_program is 1 (assumed)",
        display="cN",
        minimum=0.0,
        maximum=1e3,
        nominal=0.1,
    )
    brake_program: tuple[float, ...] = array(
        parameter(
            "1",
            1.0,
            f"Share of brake_force at a shaft angle of {point * 360 // PROGRAM_POINTS} deg",
            minimum=0.0,
            maximum=1e3,
        )
        for point in range(PROGRAM_POINTS)
    )
    friction: float = parameter(
        "1", 0.2, "Coefficient of friction between yarn and guide eyes (assumed)", minimum=0.0, maximum=2.0
    )
    wrap_angle: float = parameter(
        "rad",
        1.5707963267948966,
        "Sum of the wrap angles of all guide eyes (assumed)",
        display="deg",
        minimum=0.0,
        maximum=20.0,
    )
    supply_length: float = parameter(
        "m",
        0.6,
        "Length of yarn from the brake to where the head takes it (assumed)",
        display="mm",
        minimum=1e-2,
        maximum=100.0,
    )
    pick_up_travel: float = parameter(
        "m",
        0.1,
        "Travel at which the giver takes the weft, and the taker releases it (assumed)",
        display="mm",
        minimum=0.0,
        maximum=10.0,
        nominal=0.1,
    )
    travel: float = head_travel()
    velocity: float = head_velocity()
    acceleration: float = head_acceleration()
    tension: float = output(
        "N", "Tension of the weft at the head that carries it", display="cN", nominal=0.5, valid_if=FOLLOWED
    )
    highest_tension: float = output(
        "N",
        "Highest tension so far, on the continuous curve, without the snatch",
        display="cN",
        nominal=0.5,
        highest_of="tension",
        valid_if=FOLLOWED,
    )
    highest_snatch: float = output(
        "N",
        "Tension of the hardest snatch so far, as the giver takes the yarn up",
        display="cN",
        nominal=0.5,
        valid_if=FOLLOWED,
        so_far=True,
    )
    longest_slack: float = output(
        "s",
        "Longest time so far that the weft was carried without tension",
        display="ms",
        nominal=1e-3,
        valid_if=FOLLOWED,
        so_far=True,
    )
    slack: bool = output("1", "The weft is carried without tension", start=False, valid_if=FOLLOWED)
    carried: bool = output("1", "A head carries the weft", start=False)
    followed: bool = output(
        "1", "The shaft never turned back while a head carried the weft", start=True, so_far=True
    )
    length: float = output(
        "m", "Length of yarn from the brake to the head that carries it", valid_if=FOLLOWED
    )
    brake: float = output("N", "Force of the yarn brake at this shaft angle", display="cN", nominal=0.1)
    eye_tension: float = output(
        "N", "Tension of the weft behind the last guide eye", display="cN", nominal=0.5, valid_if=FOLLOWED
    )
    inertia_force: float = output(
        "N",
        "Part of tension that accelerates the yarn between brake and head",
        display="cN",
        nominal=0.1,
        valid_if=FOLLOWED,
    )
    drag_force: float = output(
        "N", "Part of tension that the air drag takes", display="cN", nominal=0.1, valid_if=FOLLOWED
    )
    strain: float = output("1", "Strain of the yarn between brake and head", nominal=1e-2, valid_if=FOLLOWED)

    gain: float = auxiliary("1", "Ratio of the tensions after and before all guide eyes")
    drag: float = auxiliary("kg/m2", "Air drag per length and square of the speed")
    pending: float = state("s", "Time from the last sample of the inputs to the next", minimum=0.0)
    inward: bool = state("1", "The head is on its way in, as a giver", start=True)
    length_offset: float = state("m", "Length less the travel on the way in, plus it on the way out")
    unstretched: float = state("m", "Unstretched length from brake to head", start=0.6, minimum=1e-60)
    slack_so_far: float = state("s", "Time without tension up to now", minimum=0.0)
    sampled_time: float = state("s", "Time of the last sample")
    sampled_travel: float = state("m", "Travel at the last sample")
    sampled_velocity: float = state("m/s", "Velocity at the last sample")
    sampled_acceleration: float = state("m/s2", "Acceleration at the last sample")
    sampled_angle: float = state("rad", "Shaft angle at the last sample")
    sampled_speed: float = state("rad/s", "Shaft velocity at the last sample")
    sampled_change: float = state("rad/s2", "Shaft acceleration at the last sample")
    turning: int = state(
        "1", "Direction of the shaft, 1 or -1; 0 before it first turns", start=0, minimum=-1, maximum=1
    )
    acceleration_rate: float = state("m/s3", "Rate of the acceleration between the last two samples")
