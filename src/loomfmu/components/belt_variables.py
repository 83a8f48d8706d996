"""Declarations of BeltMonitor: what it is given, shows and keeps."""

from dataclasses import dataclass
from math import inf
from typing import ClassVar

from ..declaring.declarations import auxiliary, input_, output, parameter
from ..declaring.variables import EXTREMES, MIXED, Problem, Terminal
from .head_inputs import head_acceleration, head_travel, head_velocity, yarn_tension
from .shaft_driven import TOO_FAR, ShaftDriven
from .terminals import HEAD


@dataclass(slots=True)
class BeltVariables(ShaftDriven):
    """Variables of the monitor, and what it declares of itself."""

    problems: ClassVar[tuple[Problem, ...]] = (
        Problem(
            "guide_clearance = {guide_clearance}: above 1 mm replace the belt or slow the loom down",
            warning=True,
        ),
        TOO_FAR,
    )
    keeps: ClassVar[str] = EXTREMES
    origin: ClassVar[str] = MIXED
    longest_turn: ClassVar[float] = inf
    windows: ClassVar[tuple[str, ...]] = ("free_length", "axial_force")
    terminals: ClassVar[tuple[Terminal, ...]] = (
        *ShaftDriven.terminals,
        HEAD.of("travel", "velocity", "acceleration"),
    )

    bending_stiffness: float = parameter(
        "N.m2", 0.25, "Bending stiffness EI of the belt", minimum=1e-9, maximum=1e6
    )
    head_mass: float = parameter(
        "kg",
        0.1105,
        "Mass of rapier head and rigid section of the belt",
        display="g",
        minimum=1e-6,
        maximum=100.0,
        nominal=0.1,
    )
    head_length: float = parameter(
        "m", 0.550, "Length of head and rigid section", display="mm", minimum=0.0, maximum=10.0
    )
    idle_travel: float = parameter(
        "m", 0.243, "Travel of the head before it leaves the guide", display="mm", minimum=0.0, maximum=10.0
    )
    prescribe_length_factor: bool = parameter(
        "1", False, "Use prescribed_length_factor instead of deriving it from guide_clearance"
    )
    prescribed_length_factor: float = parameter(
        "1",
        0.8,
        "Column length factor, used if prescribe_length_factor is true",
        minimum=0.1,
        maximum=2.0,
        when="prescribe_length_factor",
    )
    taker: bool = parameter(
        "1", False, "The head takes the weft over and draws it out; otherwise it brings the weft in"
    )
    travel: float = head_travel()
    velocity: float = head_velocity()
    acceleration: float = head_acceleration(398.0)
    yarn_tension: float = yarn_tension()
    guide_clearance: float = input_(
        "m",
        0.3e-3,
        "Clearance of the belt in its guide; grows with wear",
        display="mm",
        minimum=0.0,
        maximum=0.05,
        nominal=1e-3,
        unless="prescribe_length_factor",
    )
    free_length: float = output(
        "m",
        "Length of the belt between guide and head; negative while inside the guide",
        display="mm",
        nominal=1.0,
        depends=("travel", "velocity", "acceleration"),
    )
    inertia_force: float = output(
        "N", "Inertia force of the head on the belt", nominal=100.0, depends=("acceleration",)
    )
    axial_force: float = output(
        "N",
        "Compression of the belt: inertia force and weft tension",
        nominal=100.0,
        depends=("velocity", "acceleration", "yarn_tension"),
    )
    critical_force: float = output(
        "N",
        "Critical load of the free section; inside the guide, that of a section of 1 mm",
        nominal=100.0,
        depends=("travel", "velocity", "acceleration", "guide_clearance"),
    )
    length_factor: float = output("1", "Column length factor in use", follows="guide_clearance")
    margin: float = output("1", "Margin against buckling, 1 - compression / critical load")
    lowest_margin: float = output("1", "Lowest margin so far, on the continuous curve", lowest_of="margin")
    speed_limit: float = output(
        "rad/s",
        "Shaft speed at which the belt would just buckle here; 95493 rev/min if it cannot",
        display="rev/min",
        nominal=100.0,
        pole=True,
    )
    lowest_speed_limit: float = output(
        "rad/s",
        "Lowest speed limit so far, on the continuous curve",
        display="rev/min",
        nominal=100.0,
        lowest_of="speed_limit",
    )
    deflection: float = output(
        "m", "Largest deflection of the buckled belt, exact elastica", display="mm", nominal=5e-3
    )
    at_risk: bool = output("1", "The belt is outside its guide and in compression", start=False)
    largest_deflection: float = output(
        "m",
        "Largest deflection so far, on the continuous curve",
        display="mm",
        nominal=5e-3,
        highest_of="deflection",
    )
    buckled: bool = output("1", "The belt has buckled at least once", start=False, lowest_of="margin")

    acceleration_rate: float = auxiliary("m/s3", "Rate of the acceleration between the last two samples")
    bend_rate: float = auxiliary("m/s", "Rate of the second derivative by shaft angle between the samples")
    factor_clearance: float = auxiliary("m", "Clearance for which length_factor was computed")
    sampled_time: float = auxiliary("s", "Time of the last sample of the inputs")
    sampled_travel: float = auxiliary("m", "Travel at the last sample")
    sampled_velocity: float = auxiliary("m/s", "Velocity at the last sample")
    sampled_acceleration: float = auxiliary("m/s2", "Acceleration at the last sample")
    sampled_force: float = auxiliary("N", "Weft tension at the last sample")
    sampled_clearance: float = auxiliary("m", "Guide clearance at the last sample")
    sampled_angle: float = auxiliary("rad", "Shaft angle at the last sample")
    sampled_slope: float = auxiliary("m", "Travel by shaft angle at the last sample, first derivative")
    sampled_bend: float = auxiliary("m", "Travel by shaft angle at the last sample, second derivative")
    sampled_turning: bool = auxiliary("1", "The shaft was turning at the last sample", start=False)
    bump_by_time: float = auxiliary("m", "Bump of the rate by time over the last step")
    bump_time: float = auxiliary("s", "Duration of the last step, if it was interpolated", minimum=0.0)
    bump_by_angle: float = auxiliary("m", "Bump of the rate by shaft angle over the last step")
    bump_angle: float = auxiliary("rad", "Shaft angle of the last step, if it was interpolated")
    joined_angle: float = auxiliary("rad", "Shaft angle of the current sample")
    joined_slope: float = auxiliary("m", "First derivative by shaft angle at the current sample")
    joined_bend: float = auxiliary("m", "Second derivative by shaft angle at the current sample")
    joined_turning: bool = auxiliary("1", "The shaft is turning at the current sample", start=False)
