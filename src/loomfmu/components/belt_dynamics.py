"""BeltDynamics: the rapier belt between guide and head in motion, its bow amplified by the push."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import fabs, inf, sqrt
from typing import ClassVar

from ..declaring.arrays import array
from ..declaring.declarations import Quantity, at_step_end, auxiliary, input_, output, parameter, state
from ..declaring.variables import Component, Problem, Terminal
from ..physics.belt import LARGEST_BEND
from ..physics.belt_bending import LEAST_SQUARE, bent_belt
from ..physics.belt_ends import buckling, end_shape
from ..physics.belt_guide import before_switch, has_play, leans_on, next_contact, switched
from ..physics.belt_modes import Bow
from ..physics.belt_motion import accelerations, ends_at, energy_at
from ..physics.belt_moving import (
    Belt,
    Board,
    Instant,
    Path,
    crossing,
    instant,
    instant_at,
    length_at,
    may_clamp,
    motion_at,
    pushed,
    stands,
)
from ..physics.belt_rest import rest, rests
from ..physics.belt_shape import shape_at, shape_extremes
from ..physics.belt_steps import advance, fits, foresee, pieces, stages_of, suited, worked
from ..physics.numerics.extremes import highest_so_far
from ..physics.numerics.gauss import at_stage
from ..physics.numerics.motion import joined, joined_value, met
from .quantities import (
    ACCELERATION,
    BELT_MASS,
    BENDING_STIFFNESS,
    CLEARANCE,
    FREQUENCY,
    HEAD_LENGTH,
    HEAD_MASS,
    LENGTH,
    RADIUS,
    RATIO,
    THICKNESS,
)
from .shared_declarations import head_acceleration, head_travel, head_velocity, yarn_tension
from .terminals import HEAD

NUMBERS = ("first", "second", "third", "fourth", "fifth", "sixth")
# what says when other outputs are known
KNOWN, FOLLOWED, LARGEST = "deflection_known", "followed", "largest_known"
ERROR, MARGIN_ERROR = "deflection_error", "margin_error"  # and how far they may be off

CALIBRATED = 1  # guide: pinned, with a stiffness that makes up for it
GUIDED = 2  # head: it cannot turn
NO_BOARD = 1
SIDES = (0.0, 1.0, -1.0)  # of the race board, by the choices of `board`
JUMP = 1e-6  # m, that a standing head may be off
MOST_SWEEPS = 10000  # over the stages of the integration in one step; both strokes of a loom need fewer
MOST_HALVINGS = 13
SHORTEST_SHARE = 5e-3  # of an integration step: it goes that far at least, however contact comes and goes
BALANCED = 2.5e-10  # of the energy: what an integration step may leave unexplained, if it can be halved
UNBALANCED = 1e-6  # of the energy: a step that leaves more, however short, cannot be followed
EASY = 1e-3  # of that: then the next step may be twice as long
BALANCED_ON_BOARD = 1e-6  # as these three where a board pushes back, whose force has a kink: not of order 6
UNBALANCED_ON_BOARD = 1e-2
MOST_ON_BOARD = 4  # halvings for the sake of the energy: they bound the work of a step
EASY_ON_BOARD = 3e-2
LEAST_ENERGY = 1e-15  # J: below, rounding and not the step is at fault
STEEPEST = sqrt(1.0 - 2.0 * LEAST_SQUARE)  # sine of the slope at which the belt counts as folded: 72 degrees
MOST_WAVES = 5.0  # half waves of its own bow that a free belt may have: six modes cannot follow more
LEFT = 2.5e-4  # of the largest deflection: what six modes and the integration leave under the push
MORE_LEFT = 1e-2  # later, when the belt swings on and comes back, or where an end may be clamped
MOST_LEFT = 3e-2  # where both may be: under a load that lasts beyond Euler's
LEFT_ON_BOARD = 0.1  # on its cover: by the modes and the places that are looked at, as it bounces
UNKNOWN_LEFT = 100.0  # with fewer than six modes, of which one gives an eighth of the deflection of six
SHORTEST_STEP = 1e-100  # [s]: nothing moves in less, whose square is no number any more


@dataclass(slots=True)
class BeltDynamics(Component):
    """Rapier belt in motion: a beam of growing length that moves through the guide and pushes the head.

    Between two samples of the inputs the head moves on the quintic that joins them; six modes are integrated
    by Gauss's method of order 6.
    """

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
        Problem(
            "the guide's exit, guide_offset = {guide_offset}, lies beyond the race board, which is at"
            " board_distance = {board_distance} on that side"
        ),
    )
    terminals: ClassVar[tuple[Terminal, ...]] = (HEAD.of("travel", "velocity", "acceleration"),)
    accuracy: ClassVar[str] = "deflections to 2.5e-4 to 3e-2 of the largest, by its modes and its integration"
    longest_turn: ClassVar[float] = inf
    # works, energies and loads: 3e-4 as a rule, 3.6e-3 at most, between 35 and 17,000 steps in a revolution
    scatter: ClassVar[float] = 5e-3
    drawn: ClassVar[tuple[str, ...]] = (*(f"mode_{n}" for n in range(1, 7)), "guide_shape", "head_shape")

    bending_stiffness: float = parameter(
        BENDING_STIFFNESS, 0.25, "Bending stiffness EI of the belt", source="belt_#.bending_stiffness"
    )
    head_mass: float = parameter(
        HEAD_MASS, 0.1105, "Mass of rapier head and rigid section of the belt", source="belt_#.head_mass"
    )
    head_length: float = parameter(
        HEAD_LENGTH, 0.550, "Length of head and rigid section", source="belt_#.head_length"
    )
    idle_travel: float = parameter(
        HEAD_LENGTH, 0.243, "Travel of the head before it leaves the guide", source="belt_#.idle_travel"
    )
    guide_end: int = parameter(
        "1",
        1,
        "Guide: pinned, with stiffness EI / mu^2, or with free play up to a slope, and stiffness EI",
        choices=("calibrated", "play"),
    )
    guide_clearance: float = parameter(
        CLEARANCE,
        0.3e-3,
        "Clearance of the belt in its guide, used if guide_end is play",
        source="belt_#.guide_clearance",
        when="guide_end",
    )
    guide_length: float = parameter(
        LENGTH.within(1e-3, 10.0),
        0.05,
        "Length over which the guide holds the belt, used if guide_end is play (assumed: none published)",
        when="guide_end",
    )
    guide_offset: float = parameter(
        LENGTH.within(-0.01, 0.01, nominal=1e-4),
        0.0,
        "Offset of the belt in the exit of its guide from the head's line, which turns as the belt"
        " grows (assumed; up to half the clearance to either side)",
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
        BELT_MASS.within(1e-5, 10.0),
        0.05,
        "Mass of the belt per length (assumed: the published section is 0.061 to 0.065 if"
        " solid, less a fifth for its holes; 0.04 to 0.065)",
    )
    gravity: float = parameter(
        ACCELERATION.within(-100.0, 100.0, nominal=10.0),
        0.0,
        "Gravity across the belt, positive towards the side of its bow at the head; 0 leaves out its weight",
    )
    damping: float = parameter(
        FREQUENCY.within(0.0, 1e4, nominal=10.0),
        0.0,
        "Rate at which a free vibration of the belt decays (assumed: none published)",
    )
    bow: float = parameter(
        LENGTH.within(0.0, 0.1, nominal=1e-3),
        0.3e-3,
        "Amplitude of the bow (assumed: none published; 0.05 to 0.5 mm)",
    )
    bow_of: int = parameter(
        "1",
        1,
        "What has the bow: the belt, which takes it along, or the span between guide and head",
        choices=("belt", "span"),
    )
    bow_length: float = parameter(
        LENGTH.within(1e-3, 100.0, nominal=0.1), 0.2, "Half a wave of the belt's own bow (assumed)"
    )
    thickness: float = parameter(
        THICKNESS, 1.35e-3, "Thickness of the belt, for its strain (published: 30 mm x 1.35 mm)"
    )
    allowed_deflection: float = parameter(
        LENGTH.within(1e-6, 1.0, nominal=1e-3), 2e-3, "Deflection that the shed leaves room for"
    )
    shortest_length: float = parameter(
        RADIUS, 0.02, "Free length below which the belt is taken as straight (assumed)"
    )
    board: int = parameter(
        "1",
        1,
        "Race board along the free belt: none, on the side of its bow at the head, or on the other side",
        choices=("none", "bow", "other"),
    )
    board_distance: float = parameter(
        LENGTH.within(0.0, 1.0, nominal=1e-3),
        0.0,
        "Distance of the race board from the head's line (assumed)",
    )
    board_stiffness: float = parameter(
        Quantity("Pa", "MPa").within(1e3, 1e8, nominal=1e6),
        1e7,
        "Stiffness of the race board's cover, for each length of belt (assumed: nearly rigid)",
    )
    modes: int = parameter(
        "1",
        6,
        "Number of modes that move; the others are held at 0, and the end shape stays that of six",
        minimum=1,
        maximum=6,
    )
    only_push: bool = parameter(
        "1",
        False,
        "The belt is followed until the push on its head is over, as it is on a race board in any case",
    )
    inputs_at_step_end: bool = at_step_end()
    travel: float = head_travel()
    velocity: float = head_velocity()
    acceleration: float = head_acceleration()
    yarn_tension: float = yarn_tension()
    length_factor: float = input_(
        RATIO.within(0.1, 2.0),
        0.8,
        "Column length factor mu: stiffness EI / mu^2, if guide_end is calibrated",
        source="belt_#.length_factor",
    )

    free_length: float = output(
        LENGTH, "Length of the belt between guide and head; negative while inside the guide"
    )
    compression: float = output(
        "N",
        "Compression of the belt at the head, relieved by the head's lag; without meaning in the last degrees"
        " before the belt is back in its guide",
        nominal=100.0,
    )
    deflection: float = output(
        LENGTH, "Largest deflection along the belt", nominal=5e-3, valid_if=KNOWN, error=ERROR
    )
    deflection_rate: float = output("m/s", "Rate of the deflection where it is largest", valid_if=KNOWN)
    deflection_place: float = output(
        LENGTH, "Distance of the largest deflection from the guide", nominal=0.1, valid_if=KNOWN
    )
    deflection_known: bool = output(
        "1",
        "The deflection is known now: its motion is followed, and the free length is at most 5 times"
        " bow_length if the belt has the bow",
        start=True,
    )
    largest_deflection: float = output(
        LENGTH,
        "Largest deflection so far, at free lengths up to 5 times bow_length if the belt has the bow",
        nominal=5e-3,
        highest_of="deflection",
        valid_if=LARGEST,
        error=ERROR,
    )
    largest_at_risk: float = output(
        LENGTH,
        "That of largest_deflection while the head was pushed; on its way in alone with only_push or a board",
        nominal=5e-3,
        valid_if=FOLLOWED,
        error=ERROR,
        so_far=True,
    )
    deflection_error: float = output(
        LENGTH,
        "How far deflections may be off with any steps, by modes and integration: 1e-2 of the largest so"
        " far, 2.5e-4 while the head is pushed outwards and no end may be clamped, 3e-2 where both may be;"
        " 0.1 on a race board; 100 times the largest with fewer than six modes",
        nominal=1e-5,
    )
    margin: float = output(
        "1", "Dynamic margin, 1 - deflection / allowed_deflection", valid_if=KNOWN, error=MARGIN_ERROR
    )
    lowest_margin: float = output(
        "1", "Dynamic margin of largest_deflection", lowest_of="margin", valid_if=LARGEST, error=MARGIN_ERROR
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
        LENGTH, "Way by which the head lags behind because the belt is bent", nominal=1e-3, valid_if=KNOWN
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

    largest_known: bool = output(
        "1",
        "The largest deflection is known: the belt's motion could always be followed, and it was not let go"
        " after a push, see only_push",
        start=True,
        so_far=True,
    )

    outside: bool = state("1", "The free length is above the shortest one", start=False)
    held: bool = state("1", "The belt is held until it is back in its guide", start=False)
    lost: bool = state("1", "It is held because its motion could not be followed", start=False)
    released: bool = state("1", "It is held because its push is over", start=False)
    mode: Sequence[float] = array(state("m", f"Amplitude of the {each} mode") for each in NUMBERS)
    mode_rate: Sequence[float] = array(state("m/s", f"Rate of the {each} mode") for each in NUMBERS)
    guide_shape: float = auxiliary("m", "Amplitude of the end shape at the guide")
    head_shape: float = auxiliary("m", "Amplitude of the end shape at the head")
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

    def initialize(self, time: float) -> int:
        """Let the belt rest in equilibrium and forget all extremes and work."""
        if self.guide_end != CALIBRATED and self.guide_clearance >= self.guide_length:
            return 3
        if SIDES[self.board - 1] * self.guide_offset > self.board_distance:
            return 4
        self.folded = False
        self.followed = True
        self.too_long = False
        self.largest_known = True
        self.largest_deflection = 0.0
        self.largest_at_risk = 0.0
        self.lowest_margin = 1.0
        self.push_work = 0.0
        self.guide_work = 0.0
        self.lost_work = 0.0
        self.energy_through = 0.0
        self.energy_residual = 0.0
        self.sampled_step = 0.0
        self.go_in()
        self.remember()
        belt = self.given()
        path = self.path(0.0)
        if path.joined[0] > self.shortest_length:
            self.come_out(belt, path, 0.0)
        return self.show(belt, path)

    def step(self, time: float, step_size: float) -> int:
        """Move the belt from the last sample of its inputs to this one: out of its guide, on, back into it.

        Where inputs are values at the start of the step, this one is the start of the step.
        """
        if step_size < SHORTEST_STEP:
            return 0
        since = step_size if self.inputs_at_step_end else self.sampled_step
        self.sampled_step = step_size
        belt = self.given()
        path = self.path(since)
        ends_outside = length_at(path, 1.0) > self.shortest_length
        share = 0.0
        given_up = False
        if self.jumps(since):
            self.go_in()
            share = 1.0
        if not self.outside and ends_outside:
            if share == 0.0 and length_at(path, 0.0) < self.shortest_length:
                share = crossing(path, self.shortest_length)
            self.come_out(belt, path, share)
        if self.outside and ends_outside:
            self.move(belt, path, share, 1.0)
        elif self.outside:
            if length_at(path, 0.0) > self.shortest_length:
                self.move(belt, path, 0.0, crossing(path, self.shortest_length))
            given_up = self.lost
            self.go_in()
        self.remember()
        shown = self.show(belt, path)
        return 2 if given_up else shown

    def given(self) -> Belt:
        """The belt as it is now."""
        factor = self.length_factor if self.guide_end == CALIBRATED else 1.0
        side = SIDES[self.board - 1]
        return Belt(
            self.head_mass,
            self.belt_mass,
            self.gravity,
            2.0 * self.belt_mass * self.damping,
            self.bending_stiffness / (factor * factor),
            Bow(self.bow_of, self.bow, self.bow_length),
            self.guide_offset,
            self.guide_length,
            self.guide_clearance,
            self.guide_end != CALIBRATED,
            self.head_end == GUIDED,
            Board(side, self.board_distance, self.board_stiffness),
            self.modes,
        )

    def path(self, duration: float) -> Path:
        """The path over a time, from the last sample of the inputs to this one."""
        guide = self.idle_travel + self.head_length
        square = duration * duration
        place = [self.travel - guide, 0.0, 0.0, 0.0, 0.0, 0.0]
        tension = self.yarn_tension
        if duration > 0.0:
            rate = duration * self.sampled_velocity
            a0, a1, a2, a3 = joined(
                self.sampled_travel,
                rate,
                square * self.sampled_acceleration,
                self.travel,
                duration * self.velocity,
                square * self.acceleration,
            )
            place = [self.sampled_travel - guide, rate, a0, a1, a2, a3]
            tension = self.sampled_tension
        return Path(
            list(place),
            duration,
            self.velocity,
            self.acceleration,
            tension,
            self.yarn_tension,
            self.taker,
            0.5 * self.shortest_length,
        )

    def remember(self) -> None:
        """Keep the present inputs as the last sample."""
        self.sampled_travel = self.travel
        self.sampled_velocity = self.velocity
        self.sampled_acceleration = self.acceleration
        self.sampled_tension = self.yarn_tension

    def jumps(self, since: float) -> bool:
        """Return whether the travel jumps over a time since the last sample, more than its rates explain."""
        rates = fabs(self.sampled_velocity) + fabs(self.velocity)
        seconds = fabs(self.sampled_acceleration) + fabs(self.acceleration)
        change = self.travel - self.sampled_travel - 0.5 * since * (self.sampled_velocity + self.velocity)
        return fabs(change) > since * (0.5 * rates + since * seconds) + JUMP

    def go_in(self) -> None:
        """Put the belt back into its guide, straight."""
        self.outside = False
        self.held = False
        self.lost = False
        self.released = False
        self.mode = [0.0] * 6
        self.guide_shape = 0.0
        self.head_shape = 0.0
        self.deflection = 0.0
        self.deflection_place = 0.0
        self.bending_strain = 0.0
        self.shortening = 0.0
        self.steepness = 0.0
        self.settle()

    def settle(self) -> None:
        """Stop the motion of the modes, let go the guide, and forget the last integration step."""
        self.mode_rate = [0.0] * 6
        self.gauss = [0.0] * 18
        self.gauss_step = 0.0
        self.halvings = 0
        self.deflection_rate = 0.0
        self.growth_rate = 0.0
        self.guide_contact = 0
        self.guide_moment = 0.0
        self.energy = 0.0

    def come_out(self, belt: Belt, path: Path, share: float) -> None:
        """Put the belt where it comes out in equilibrium under its load, or without it if there is none."""
        self.go_in()
        self.outside = True
        length, velocity, acceleration, tension = motion_at(path, share)
        q = [0.0] * 6
        v = [0.0] * 6
        at_rest, contact = rest(belt, length, velocity, acceleration, tension, q, v)
        if not at_rest:
            q = [0.0] * 6
            v = [0.0] * 6
            at_rest, contact = rest(belt, length, 0.0, 0.0, 0.0, q, v)
        self.mode = q
        self.mode_rate = v
        self.guide_contact = contact
        at = instant(belt, length, velocity, acceleration, tension)
        before, before_rate = self.look(belt, at, q, v)
        if not at_rest:
            self.lose()
        elif not self.steepness < STEEPEST:
            self.fold(belt, at)
        else:
            self.take_extremes(belt, at, 0.0, before, before_rate, 0.0)

    def lose(self) -> None:
        """Hold the belt where its motion could last be followed: what it does from there on is unknown."""
        self.settle()
        self.held = True
        self.lost = True
        self.followed = False
        self.largest_known = False

    def fold(self, belt: Belt, at: Instant) -> None:
        """Hold the belt as it folded: it counts as bent as far as a belt of its length can be."""
        self.settle()
        self.held = True
        self.folded = True
        self.deflection = LARGEST_BEND * at.length
        if self.deflection > self.largest_deflection:
            self.largest_deflection = self.deflection
        load = pushed(belt, at.length, at.acceleration, at.tension)
        if load > 0.0 and self.deflection > self.largest_at_risk:
            self.largest_at_risk = self.deflection

    def move(self, belt: Belt, path: Path, start: float, end: float) -> None:
        """Integrate over a part of the step, in equal steps; one that does not settle is halved."""
        if self.held or path.duration <= 0.0:
            return
        q = list(self.mode)
        v = list(self.mode_rate)
        a = list(self.gauss)
        at = instant_at(belt, path, start)
        if stands(path) and rests(belt, at, self.guide_contact, q, v):
            return
        self.guide_contact = leans_on(belt, at, q, v)
        self.touch(belt, at, q, v)
        self.energy = energy_at(belt, at, self.guide_contact, q, v)
        load = pushed(belt, at.length, at.acceleration, at.tension)
        loads = [0.0] * 3
        size = (end - start) / pieces((end - start) * path.duration)
        share = start
        halvings = self.halvings if self.halvings < MOST_HALVINGS else MOST_HALVINGS
        reach = 1.0
        sweeps = 0
        on_board = self.board != NO_BOARD
        balanced = BALANCED_ON_BOARD if on_board else BALANCED
        unbalanced = UNBALANCED_ON_BOARD if on_board else UNBALANCED
        most = MOST_ON_BOARD if on_board else MOST_HALVINGS
        easy = EASY_ON_BOARD if on_board else EASY
        while end - share > 1e-12 and halvings <= MOST_HALVINGS and sweeps < MOST_SWEEPS:
            taken = suited(path, share, end, size) / 2.0**halvings
            taken = taken if taken < reach else reach
            taken = taken if taken < end - share - 1e-12 else end - share
            sweeps = sweeps + 1
            if not fits(path, share, taken):
                halvings = halvings + 1
                continue
            stages = stages_of(belt, path, share, taken)
            longer = stages.duration / self.gauss_step if self.gauss_step > 0.0 else 0.0
            self.gauss_step = 0.0
            a = foresee(belt, at, self.guide_contact, longer, q, v, a)
            settled, swept = advance(belt, stages, self.guide_contact, q, v, a, loads)
            sweeps = sweeps + swept
            if not settled:
                halvings = halvings + 1
                continue
            next_q, next_v = at_stage(3, stages.duration, q, v, a)
            after = instant_at(belt, path, share + taken)
            before = before_switch(belt, self.guide_contact, stages.duration, at, q, v, after, next_q, next_v)
            shortest = SHORTEST_SHARE * size
            if before < 1.0 and taken > shortest:
                reach = before * taken if before * taken > shortest else shortest
                continue
            work = worked(belt, stages, self.guide_contact, q, v, a, loads)
            energy = energy_at(belt, after, self.guide_contact, next_q, next_v)
            missing = energy - self.energy - work[0] - work[1] + work[2]
            error = fabs(missing) / (fabs(energy) + fabs(self.energy) + work[3] + LEAST_ENERGY)
            if error > balanced and halvings < most:
                halvings = halvings + 1
                continue
            if error > unbalanced:
                break
            if error < easy * balanced and halvings > 0:
                halvings = halvings - 1
            share = share + taken
            reach = 1.0
            at = after
            q = list(next_q)
            v = list(next_v)
            self.gauss_step = stages.duration
            self.push_work = self.push_work + work[0]
            self.guide_work = self.guide_work + work[1]
            self.lost_work = self.lost_work + work[2]
            self.energy_through = self.energy_through + work[3]
            self.energy_residual = self.energy_residual + missing
            self.energy = energy
            contact = self.guide_contact
            self.touch(belt, at, q, v)
            if self.guide_contact != contact:  # what that takes counts as work there
                self.energy = energy_at(belt, at, self.guide_contact, q, v)
                self.guide_work = self.guide_work + self.energy - energy
                self.energy_through = self.energy_through + fabs(self.energy - energy)
            self.mode = q
            self.mode_rate = v
            last, last_rate = self.look(belt, at, q, v)
            load_before = load
            load = self.take_extremes(belt, at, stages.duration, last, last_rate, load_before)
            if not self.steepness < STEEPEST:
                self.fold(belt, at)
                return
            if load <= 0.0 and load_before > 0.0 and self.lets_go():
                self.let_it_go()
                return
        self.gauss = a
        self.halvings = halvings
        if end - share > 1e-12:
            self.lose()

    def touch(self, belt: Belt, at: Instant, q: list[float], v: list[float]) -> None:
        """Begin or end contact in the guide where it is about to."""
        if not has_play(belt):
            return
        then = next_contact(belt, at, self.guide_contact, q, v)
        if then == self.guide_contact:
            return
        rates = switched(belt, at, self.guide_contact, then, q, v)
        for n in range(6):
            v[n] = rates[n]
        self.guide_contact = then
        self.gauss_step = 0.0

    def look(self, belt: Belt, at: Instant, q: list[float], v: list[float]) -> tuple[float, float]:
        """Find where the belt is farthest from its line, how steep and bent it is; the deflection before."""
        before = self.deflection
        before_rate = self.deflection_rate
        ends = ends_at(belt, at, self.guide_contact, q, v)
        self.guide_shape = ends.guide
        self.head_shape = ends.head
        shape = end_shape(ends.guide, ends.head, q)
        place, farthest, steepest, bend = shape_extremes(at.length, shape, ends.guide, ends.head)
        shape = end_shape(ends.guide_rate, ends.head_rate, v)
        rate, _first, _twice = shape_at(place, shape, ends.guide_rate, ends.head_rate)
        self.deflection = fabs(farthest)
        self.deflection_rate = rate if farthest >= 0.0 else -rate
        self.deflection_place = (1.0 - place) * at.length
        self.steepness = steepest
        self.bending_strain = 0.5 * self.thickness * bend
        return before, before_rate

    def take_extremes(
        self, belt: Belt, at: Instant, duration: float, last: float, last_rate: float, load_before: float
    ) -> float:
        """Bring the largest deflections up to an instant, on the cubic from the last look; the load now.

        What is too long for its modes does not count.
        """
        load = pushed(belt, at.length, at.acceleration, at.tension)
        if not self.follows(at.length):
            self.too_long = True
            return load
        value = self.deflection
        rate = self.deflection_rate
        part = 1.0
        if load <= 0.0 and load_before > 0.0:
            part = load_before / (load_before - load)
            value, rate = met(part, duration, last, last_rate, value, rate)
        if load > 0.0 or load_before > 0.0:
            self.largest_at_risk = highest_so_far(
                self.largest_at_risk, part * duration, last, last_rate, value, rate
            )
        if not self.lets_go():
            part, value, rate = 1.0, self.deflection, self.deflection_rate
        self.largest_deflection = highest_so_far(
            self.largest_deflection, part * duration, last, last_rate, value, rate
        )
        return load

    def lets_go(self) -> bool:
        """Return whether the belt is followed while its head is pushed alone."""
        return self.only_push or self.board != NO_BOARD

    def let_it_go(self) -> None:
        """Hold the belt, as if it were straight, from the end of the push until it is back in its guide."""
        self.go_in()
        self.outside = True
        self.held = True
        self.released = True
        self.largest_known = False

    def follows(self, length: float) -> bool:
        """Return whether six modes can follow the bow of a belt of that free length."""
        return self.bow_of != 1 or length <= MOST_WAVES * self.bow_length

    def show(self, belt: Belt, path: Path) -> int:
        """Outputs at the end of the step."""
        start, rate, a0, a1, a2, a3 = path.joined
        self.free_length, _second = joined_value(start, rate, a0, a1, a2, a3, 1.0)
        length, velocity, acceleration, tension = motion_at(path, 1.0)
        self.compression = self.head_mass * acceleration + tension
        if self.outside and not self.held:
            at = instant(belt, length, velocity, acceleration, tension)
            self.show_motion(belt, at)
        self.deflection_known = (
            not self.lost and not self.released and (not self.outside or self.follows(self.free_length))
        )
        self.deflection_error = self.left(may_clamp(belt)) * self.largest_deflection
        self.margin_error = self.deflection_error / self.allowed_deflection
        self.margin = 1.0 - self.deflection / self.allowed_deflection
        self.lowest_margin = 1.0 - self.largest_deflection / self.allowed_deflection
        if self.held and not self.released:
            return 2 if self.lost else 1
        return 0

    def show_motion(self, belt: Belt, at: Instant) -> None:
        """Load, growth and shortening of the belt, and the moment of its guide."""
        q = list(self.mode)
        v = list(self.mode_rate)
        _rates, self.compression = accelerations(belt, at, self.guide_contact, q, v)
        ends = ends_at(belt, at, self.guide_contact, q, v)
        bending = bent_belt(at, ends, q, v)
        length = at.length
        turn, wave = buckling(ends.clamped)
        critical = turn / length
        own = 0.5 * self.belt_mass * at.acceleration * length
        excess = self.compression + own - belt.stiffness * critical * critical
        self.growth_rate = wave / length * sqrt(excess / self.belt_mass) if excess > 0.0 else 0.0
        self.shortening = bending.shortening
        moment = 6.0 * ends.guide_excess / (length * length * length) - bending.force
        self.guide_moment = length * (belt.stiffness * moment - self.compression * bending.pull)

    def left(self, may_clamp: bool) -> float:
        """Share of the largest deflection by which deflections may be off with any steps."""
        if self.modes < 6:
            return UNKNOWN_LEFT
        if self.board != NO_BOARD:
            return LEFT_ON_BOARD
        if self.guide_end != CALIBRATED and self.head_end == GUIDED:
            return MOST_LEFT
        pushed_out = self.compression > 0.0 and self.velocity > 0.0
        return LEFT if pushed_out and not may_clamp else MORE_LEFT
