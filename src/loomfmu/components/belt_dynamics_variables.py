"""Declarations of BeltDynamics: what it is given, shows and keeps."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import ClassVar

from ..declaring.arrays import array
from ..declaring.declarations import at_step_end, input_, output, parameter, state
from ..declaring.variables import Component, Problem, Terminal
from .head_inputs import head_acceleration, head_travel, head_velocity, yarn_tension
from .terminals import HEAD

NUMBERS = ("first", "second", "third", "fourth", "fifth", "sixth")
KNOWN, FOLLOWED = "deflection_known", "followed"  # what says when other outputs are known
ERROR, MARGIN_ERROR = "deflection_error", "margin_error"  # and how far they may be off


@dataclass(slots=True)
class BeltDynamicsVariables(Component):
    """Variables of the belt in motion, and what it declares of itself."""

    problems: ClassVar[tuple[Problem, ...]] = (
        Problem(
            "the belt has folded: until it is back in its guide, its deflection is shown as {deflection}, the"
            " largest possible where it folded",
            warning=True,
        ),
        Problem(
            "the belt's motion could not be followed to a free length of {free_length}: until it is back in"
            " its guide, nothing counts for the largest deflections; take more steps",
            warning=True,
        ),
        Problem("guide_clearance = {guide_clearance} must be less than guide_length = {guide_length}"),
    )
    terminals: ClassVar[tuple[Terminal, ...]] = (HEAD.of("travel", "velocity", "acceleration"),)
    accuracy: ClassVar[str] = "deflections to 2.5e-4 to 3e-2 of the largest, by its modes and its integration"
    longest_turn: ClassVar[float] = inf
    # works, energies and loads: 3e-4 as a rule, 3.6e-3 at most, between 35 and 17,000 steps in a revolution
    scatter: ClassVar[float] = 5e-3

    bending_stiffness: float = parameter(
        "N.m2",
        0.25,
        "Bending stiffness EI of the belt",
        minimum=1e-9,
        maximum=1e6,
        source="belt_#.bending_stiffness",
    )
    head_mass: float = parameter(
        "kg",
        0.1105,
        "Mass of rapier head and rigid section of the belt",
        display="g",
        minimum=1e-6,
        maximum=100.0,
        nominal=0.1,
        source="belt_#.head_mass",
    )
    head_length: float = parameter(
        "m",
        0.550,
        "Length of head and rigid section",
        display="mm",
        minimum=0.0,
        maximum=10.0,
        source="belt_#.head_length",
    )
    idle_travel: float = parameter(
        "m",
        0.243,
        "Travel of the head before it leaves the guide",
        display="mm",
        minimum=0.0,
        maximum=10.0,
        source="belt_#.idle_travel",
    )
    guide_end: int = parameter(
        "1",
        1,
        "Guide: pinned, with stiffness EI / mu^2, or with free play up to a slope, and stiffness EI",
        choices=("calibrated", "play"),
    )
    guide_clearance: float = parameter(
        "m",
        0.3e-3,
        "Clearance of the belt in its guide, used if guide_end is play",
        display="mm",
        minimum=0.0,
        maximum=0.05,
        nominal=1e-3,
        source="belt_#.guide_clearance",
        when="guide_end",
    )
    guide_length: float = parameter(
        "m",
        0.05,
        "Length over which the guide holds the belt, used if guide_end is play (assumed: none published)",
        display="mm",
        minimum=1e-3,
        maximum=10.0,
        when="guide_end",
    )
    guide_offset: float = parameter(
        "m",
        0.0,
        "Offset of the belt in the exit of its guide from the head's line, which turns as the belt"
        " grows (assumed; up to half the clearance to either side)",
        display="mm",
        minimum=-0.01,
        maximum=0.01,
        nominal=1e-4,
    )
    head_end: int = parameter(
        "1", 1, "Head: free to turn, or guided, so that it cannot turn", choices=("pinned", "guided")
    )
    taker: bool = parameter(
        "1",
        False,
        "The head takes the weft over and draws it out; otherwise it brings the weft in",
        source="belt_#.taker",
    )
    belt_mass: float = parameter(
        "kg/m",
        0.05,
        "Mass of the belt per length (assumed: the published section is 0.061 to 0.065 if"
        " solid, less a fifth for its holes; 0.04 to 0.065)",
        minimum=1e-5,
        maximum=10.0,
        nominal=0.1,
    )
    damping: float = parameter(
        "1/s",
        0.0,
        "Rate at which a free vibration of the belt decays (assumed: none published)",
        minimum=0.0,
        maximum=1e4,
        nominal=10.0,
    )
    bow: float = parameter(
        "m",
        0.3e-3,
        "Amplitude of the bow (assumed: none published; 0.05 to 0.5 mm)",
        display="mm",
        minimum=0.0,
        maximum=0.1,
        nominal=1e-3,
    )
    bow_of: int = parameter(
        "1",
        1,
        "What has the bow: the belt, which takes it along, or the span between guide and head",
        choices=("belt", "span"),
    )
    bow_length: float = parameter(
        "m",
        0.2,
        "Half a wave of the belt's own bow (assumed)",
        display="mm",
        minimum=1e-3,
        maximum=100.0,
        nominal=0.1,
    )
    thickness: float = parameter(
        "m",
        1.35e-3,
        "Thickness of the belt, for its strain (published: 30 mm x 1.35 mm)",
        display="mm",
        minimum=1e-6,
        maximum=0.1,
        nominal=1e-3,
    )
    allowed_deflection: float = parameter(
        "m",
        2e-3,
        "Deflection that the shed leaves room for",
        display="mm",
        minimum=1e-6,
        maximum=1.0,
        nominal=1e-3,
    )
    shortest_length: float = parameter(
        "m",
        0.02,
        "Free length below which the belt is taken as straight (assumed)",
        display="mm",
        minimum=1e-4,
        maximum=1.0,
        nominal=0.01,
    )
    modes: int = parameter(
        "1",
        6,
        "Number of modes that move; the others are held at 0, and the end shape stays that of six",
        minimum=1,
        maximum=6,
    )
    inputs_at_step_end: bool = at_step_end()
    travel: float = head_travel()
    velocity: float = head_velocity()
    acceleration: float = head_acceleration()
    yarn_tension: float = yarn_tension()
    length_factor: float = input_(
        "1",
        0.8,
        "Column length factor mu: stiffness EI / mu^2, if guide_end is calibrated",
        minimum=0.1,
        maximum=2.0,
        source="belt_#.length_factor",
    )

    free_length: float = output(
        "m", "Length of the belt between guide and head; negative while inside the guide", display="mm"
    )
    compression: float = output(
        "N",
        "Compression of the belt at the head, relieved by the head's lag; without meaning in the last degrees"
        " before the belt is back in its guide",
        nominal=100.0,
    )
    deflection: float = output(
        "m", "Largest deflection along the belt", display="mm", nominal=5e-3, valid_if=KNOWN, error=ERROR
    )
    deflection_rate: float = output("m/s", "Rate of the deflection where it is largest", valid_if=KNOWN)
    deflection_place: float = output(
        "m", "Distance of the largest deflection from the guide", display="mm", nominal=0.1, valid_if=KNOWN
    )
    deflection_known: bool = output(
        "1",
        "The deflection is known now: its motion is followed, and the free length is at most 5 times"
        " bow_length if the belt has the bow",
        start=True,
    )
    largest_deflection: float = output(
        "m",
        "Largest deflection so far, at free lengths up to 5 times bow_length if the belt has the bow",
        display="mm",
        nominal=5e-3,
        highest_of="deflection",
        valid_if=FOLLOWED,
        error=ERROR,
    )
    largest_at_risk: float = output(
        "m",
        "That of largest_deflection while the head was pushed",
        display="mm",
        nominal=5e-3,
        valid_if=FOLLOWED,
        error=ERROR,
        so_far=True,
    )
    deflection_error: float = output(
        "m",
        "How far deflections may be off with any steps, by modes and integration: 1e-2 of the largest so"
        " far, 2.5e-4 while the head is pushed outwards and no end may be clamped, 3e-2 where both may be;"
        " 100 times the largest with fewer than six modes",
        display="mm",
        nominal=1e-5,
    )
    margin: float = output(
        "1", "Dynamic margin, 1 - deflection / allowed_deflection", valid_if=KNOWN, error=MARGIN_ERROR
    )
    lowest_margin: float = output(
        "1", "Dynamic margin of largest_deflection", lowest_of="margin", valid_if=FOLLOWED, error=MARGIN_ERROR
    )
    margin_error: float = output(
        "1", "How far margins may be off, deflection_error / allowed_deflection", nominal=1e-2
    )
    growth_rate: float = output(
        "1/s",
        "Rate at which the belt would grow in the shape in which it buckles; 0 while it is stable",
        nominal=100.0,
        valid_if=KNOWN,
    )
    bending_strain: float = output(
        "1",
        "Largest strain on the surface of the belt by its curvature, that of the bow included",
        nominal=1e-3,
        valid_if=KNOWN,
    )
    guide_contact: int = output(
        "1",
        "Side of its guide on which the belt leans, 1 or -1; 0 while it turns freely",
        start=0,
        valid_if=KNOWN,
    )
    guide_moment: float = output(
        "N.m", "Moment by which the guide keeps the belt from turning", valid_if=KNOWN
    )
    steepness: float = output("1", "Sine of the largest slope of the belt", nominal=0.1, valid_if=KNOWN)
    shortening: float = output(
        "m",
        "Way by which the head lags behind because the belt is bent",
        display="mm",
        nominal=1e-3,
        valid_if=KNOWN,
    )
    energy: float = output(
        "J", "Energy of the deflection, against the belt held straight", nominal=0.1, valid_if=KNOWN
    )
    push_work: float = output("J", "Work of the compression on the shortening so far", nominal=0.1)
    guide_work: float = output("J", "Work done on the deflection at the guide so far", nominal=0.1)
    lost_work: float = output("J", "Work lost by damping so far", nominal=0.1)
    energy_through: float = output("J", "Sum of all work so far, each positive", nominal=0.1, so_far=True)
    energy_residual: float = output(
        "J",
        "Energy that all work so far does not explain; a belt that is held adds none",
        nominal=1e-9,
        valid_if=FOLLOWED,
    )
    folded: bool = output("1", "The belt has folded at least once", start=False, so_far=True)
    followed: bool = output(
        "1", "The belt's motion could always be followed; if not, take more steps", start=True, so_far=True
    )
    too_long: bool = output(
        "1",
        "The free length has been above 5 times bow_length, where largest_deflection does not count",
        start=False,
        so_far=True,
    )

    outside: bool = state("1", "The free length is above the shortest one", start=False)
    held: bool = state("1", "The belt is held until it is back in its guide", start=False)
    lost: bool = state("1", "It is held because its motion could not be followed", start=False)
    mode: Sequence[float] = array(state("m", f"Amplitude of the {each} mode") for each in NUMBERS)
    mode_rate: Sequence[float] = array(state("m/s", f"Rate of the {each} mode") for each in NUMBERS)
    sampled_travel: float = state("m", "Travel at the last sample of the inputs")
    sampled_velocity: float = state("m/s", "Velocity at the last sample")
    sampled_acceleration: float = state("m/s2", "Acceleration at the last sample")
    sampled_tension: float = state("N", "Weft tension at the last sample")
    sampled_step: float = state("s", "Duration of the last step")
    gauss: Sequence[float] = array(
        state("m/s2", f"Acceleration of the {each} mode, {stage} stage of the last integration step")
        for stage in NUMBERS[:3]
        for each in NUMBERS
    )
    gauss_step: float = state(
        "s", "Duration of the integration step of these accelerations, 0 if there was none"
    )
    halvings: int = state("1", "How often the integration step is halved", start=0)
