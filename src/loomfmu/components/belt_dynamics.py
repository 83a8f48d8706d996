"""BeltDynamics: the rapier belt between guide and head in motion, its bow amplified by the push."""

from dataclasses import dataclass
from math import fabs, sqrt

from ..physics.belt import LARGEST_BEND
from ..physics.belt_bending import LEAST_SQUARE
from ..physics.belt_ends import buckling, end_shape
from ..physics.belt_shape import shape_at, shape_extremes
from ..physics.numerics.extremes import highest_so_far
from ..physics.numerics.motion import met
from .belt_guide import CALIBRATED, GUIDED, SHORTEST_SHARE
from .belt_rest import BeltRest

JUMP = 1e-6  # m, that a standing head may be off
MOST_SWEEPS = 10000  # over the stages of the integration in one step; both strokes of a loom need fewer
MOST_HALVINGS = 13
BALANCED = 2.5e-10  # of the energy: what an integration step may leave unexplained, if it can be halved
UNBALANCED = 1e-6  # of the energy: a step that leaves more, however short, cannot be followed
EASY = 1e-3  # of that: then the next step may be twice as long
LEAST_ENERGY = 1e-15  # J: below, rounding and not the step is at fault
GROWTH = 0.05  # of the free length in a step of the integration
MOST_STEPS = 50  # of the integration in one step, before they are halved
LARGEST_STEP = 5e-4  # s, of the integration
STEEPEST = sqrt(1.0 - 2.0 * LEAST_SQUARE)  # sine of the slope at which the belt counts as folded: 72 degrees
MOST_WAVES = 5.0  # half waves of its own bow that a free belt may have: six modes cannot follow more
LEFT = 2.5e-4  # of the largest deflection: what six modes and the integration leave under the push
MORE_LEFT = 1e-2  # later, when the belt swings on and comes back, or where an end may be clamped
MOST_LEFT = 3e-2  # where both may be: under a load that lasts beyond Euler's
UNKNOWN_LEFT = 100.0  # with fewer than six modes, of which one gives an eighth of the deflection of six
SHORTEST_STEP = 1e-100  # [s]: nothing moves in less, whose square is no number any more


@dataclass(slots=True)
class BeltDynamics(BeltRest):
    """Rapier belt in motion: a beam of growing length that moves through the guide and pushes the head.

    Between two samples of the inputs the head moves on the quintic that joins them; six modes are integrated
    by Gauss's method of order 6.
    """

    def initialize(self, time: float) -> int:
        """Let the belt rest in equilibrium and forget all extremes and work."""
        if self.has_play() and self.guide_clearance >= self.guide_length:
            return 3
        self.outside = False
        self.held = False
        self.folded = False
        self.lost = False
        self.followed = True
        self.too_long = False
        self.largest_deflection = 0.0
        self.largest_at_risk = 0.0
        self.lowest_margin = 1.0
        self.push_work = 0.0
        self.guide_work = 0.0
        self.lost_work = 0.0
        self.energy_through = 0.0
        self.energy_residual = 0.0
        self.sampled_step = 0.0
        self.forget()
        self.remember()
        self.lay_path(0.0)
        if self.path[0] > self.shortest_length:
            self.come_out(0.0)
        return self.show()

    def step(self, time: float, step_size: float) -> int:
        """Move the belt from the last sample of its inputs to this one: out of its guide, on, back into it.

        Where inputs are values at the start of the step, this one is the start of the step.
        """
        if step_size < SHORTEST_STEP:
            return 0
        since = step_size if self.inputs_at_step_end else self.sampled_step
        self.sampled_step = step_size
        jumped = self.jumps(since)
        self.lay_path(since)
        ends_outside = self.length_at(1.0) > self.shortest_length
        share = 0.0
        given_up = False
        if jumped:
            self.go_in()
            share = 1.0
        if not self.outside and ends_outside:
            if share == 0.0 and self.length_at(0.0) < self.shortest_length:
                share = self.crossing()
            self.come_out(share)
        if self.outside and ends_outside:
            self.move(share, 1.0)
        elif self.outside:
            if self.length_at(0.0) > self.shortest_length:
                self.move(0.0, self.crossing())
            given_up = self.lost
            self.go_in()
        self.remember()
        shown = self.show()
        return 2 if given_up else shown

    def jumps(self, since: float) -> bool:
        """Whether the travel jumps over a time since the last sample: whether its rates do not explain it."""
        rates = fabs(self.sampled_velocity) + fabs(self.velocity)
        seconds = fabs(self.sampled_acceleration) + fabs(self.acceleration)
        change = self.travel - self.sampled_travel - 0.5 * since * (self.sampled_velocity + self.velocity)
        return fabs(change) > since * (0.5 * rates + since * seconds) + JUMP

    def crossing(self) -> float:
        """Share of the step at which the free length passes the shortest one."""
        low = 0.0
        high = 1.0
        starts_outside = self.length_at(0.0) > self.shortest_length
        for _ in range(60):
            middle = 0.5 * (low + high)
            if (self.length_at(middle) > self.shortest_length) == starts_outside:
                low = middle
            else:
                high = middle
        return high

    def go_in(self) -> None:
        """Put the belt back into its guide, straight."""
        self.outside = False
        self.held = False
        self.lost = False
        self.forget()

    def come_out(self, share: float) -> None:
        """Put the belt where it comes out in equilibrium under its load, or without it if there is none."""
        self.outside = True
        self.held = False
        self.lost = False
        length = self.length_at(share)
        self.rest(length, self.velocity_at(share), self.acceleration_at(share), self.tension_at(share))
        if not self.at_rest:
            self.rest(length, 0.0, 0.0, 0.0)
        self.look(share)
        if not self.at_rest:
            self.lose()
            return
        if not self.steepness < STEEPEST:
            self.fold(share)
            return
        self.take_extremes(share, 0.0)

    def hold(self) -> None:
        """Stop the belt until it is back in its guide."""
        self.settle()
        self.deflection_rate = 0.0
        self.growth_rate = 0.0
        self.guide_contact = 0
        self.guide_moment = 0.0
        self.energy = 0.0
        self.held = True

    def lose(self) -> None:
        """Hold the belt where its motion could last be followed: what it does from there on is unknown."""
        self.hold()
        self.lost = True
        self.followed = False

    def fold(self, share: float) -> None:
        """Hold the belt as it folded: it counts as bent as far as a belt of its length can be."""
        self.hold()
        self.folded = True
        self.deflection = LARGEST_BEND * self.length_at(share)
        if self.deflection > self.largest_deflection:
            self.largest_deflection = self.deflection
        if self.pushed_at(share) > 0.0 and self.deflection > self.largest_at_risk:
            self.largest_at_risk = self.deflection

    def move(self, start: float, end: float) -> None:
        """Integrate over a part of the step, in equal steps; one that does not settle is halved."""
        if self.held or self.path_step <= 0.0 or self.rests(start):
            return
        self.push_before = self.pushed_at(start)
        size = (end - start) / self.pieces((end - start) * self.path_step)
        self.set_out(start)
        share = start
        halvings = self.halvings if self.halvings < MOST_HALVINGS else MOST_HALVINGS
        reach = 1.0
        while end - share > 1e-12 and halvings <= MOST_HALVINGS and self.sweeps < MOST_SWEEPS:
            taken = self.suited(share, end, size) / 2.0**halvings
            taken = taken if taken < reach else reach
            taken = taken if taken < end - share - 1e-12 else end - share
            if not self.advance(share, taken):
                halvings = halvings + 1
                continue
            before = self.before_switch(share, taken)
            shortest = SHORTEST_SHARE * size
            if before < 1.0 and taken > shortest:
                reach = before * taken if before * taken > shortest else shortest
                continue
            self.account(share, taken)
            energy = self.energy_at(share + taken)
            missing = energy - self.energy - self.step_push - self.step_guide + self.step_loss
            error = fabs(missing) / (fabs(energy) + fabs(self.energy) + self.step_through + LEAST_ENERGY)
            if error > BALANCED and halvings < MOST_HALVINGS:
                halvings = halvings + 1
                continue
            if error > UNBALANCED:
                break
            if error < EASY * BALANCED and halvings > 0:
                halvings = halvings - 1
            share = share + taken
            reach = 1.0
            self.go_on()
            self.gauss_step = taken * self.path_step
            self.sums()
            self.energy = energy
            self.energy_residual = self.energy_residual + missing
            self.lean_or_leave(share)
            self.look(share)
            self.take_extremes(share, taken * self.path_step)
            if not self.steepness < STEEPEST:
                self.fold(share)
                return
        self.halvings = halvings
        if end - share > 1e-12:
            self.lose()

    def lean_or_leave(self, share: float) -> None:
        """See to the contact in the guide, and count as work there what a change of it takes."""
        contact = self.guide_contact
        self.note_gap(share)
        if self.guide_contact == contact:
            return
        before = self.energy
        self.energy = self.energy_at(share)
        self.guide_work = self.guide_work + self.energy - before
        self.energy_through = self.energy_through + fabs(self.energy - before)

    def pieces(self, duration: float) -> int:
        """Number of equal steps of the integration over a time."""
        if not duration > LARGEST_STEP:
            return 1
        if duration < MOST_STEPS * LARGEST_STEP:
            return 1 + int(duration / LARGEST_STEP * (1.0 - 1e-9))
        return MOST_STEPS

    def set_out(self, share: float) -> None:
        """Make ready for the integration from a share of the step on."""
        self.sweeps = 0
        self.try_modes()
        self.sums()
        self.lean(self.length_at(share))
        self.note_gap(share)
        self.energy = self.energy_at(share)

    def follows(self, length: float) -> bool:
        """Whether six modes can follow the bow of a belt of that free length."""
        return self.bow_of != 1 or length <= MOST_WAVES * self.bow_length

    def suited(self, share: float, end: float, size: float) -> float:
        """Share of the step over which the free length changes by a twentieth, or a given smaller one."""
        length = self.length_at(share)
        ahead = share + size if share + size < end else end
        change = fabs(self.length_at(ahead) - length)
        if self.length_at(ahead) < length:
            length = self.length_at(ahead)
        if change <= GROWTH * length or length < 0.5 * self.shortest_length:
            return size
        return size * GROWTH * length / change

    def look(self, share: float) -> None:
        """Find where the belt is farthest from its line, and how steep and bent it is."""
        length = self.length_at(share)
        velocity = self.velocity_at(share)
        self.try_modes()
        (_d, _k, guide, head, guide_rate, head_rate, _by_length, _head_by_length, _second, _head_second) = (
            self.ends(length, velocity)
        )
        a1, a2, a3, a4, a5, a6 = end_shape(guide, head, *self.mode)
        place, farthest, steepest, bend = shape_extremes(length, a1, a2, a3, a4, a5, a6, guide, head)
        a1, a2, a3, a4, a5, a6 = end_shape(guide_rate, head_rate, *self.mode_rate)
        rate, _first, _twice = shape_at(place, a1, a2, a3, a4, a5, a6, guide_rate, head_rate)
        self.last_deflection = self.deflection
        self.last_rate = self.deflection_rate
        self.deflection = fabs(farthest)
        self.deflection_rate = rate if farthest >= 0.0 else -rate
        self.deflection_place = (1.0 - place) * length
        self.steepness = steepest
        self.bending_strain = 0.5 * self.thickness * bend

    def take_extremes(self, share: float, duration: float) -> None:
        """Bring the largest deflections up to a share of the step, on the cubic from the last look.

        What is too long for its modes does not count.
        """
        if not self.follows(self.length_at(share)):
            self.too_long = True
            self.push_before = self.pushed_at(share)
            return
        self.largest_deflection = highest_so_far(
            self.largest_deflection,
            duration,
            self.last_deflection,
            self.last_rate,
            self.deflection,
            self.deflection_rate,
        )
        pushed = self.pushed_at(share)
        value = self.deflection
        rate = self.deflection_rate
        part = 1.0
        if pushed <= 0.0 and self.push_before > 0.0:
            part = self.push_before / (self.push_before - pushed)
            value, rate = met(
                part, duration, self.last_deflection, self.last_rate, self.deflection, self.deflection_rate
            )
        if pushed > 0.0 or self.push_before > 0.0:
            self.largest_at_risk = highest_so_far(
                self.largest_at_risk, part * duration, self.last_deflection, self.last_rate, value, rate
            )
        self.push_before = pushed

    def show(self) -> int:
        """Outputs at the end of the step."""
        self.free_length, _second = self.joined_at(1.0)
        self.compression = self.head_mass * self.acceleration_at(1.0) + self.tension_at(1.0)
        if self.outside and not self.held:
            self.try_modes()
            self.found_a = self.rates_at(1.0)
            turn, wave = buckling(self.clamped())
            critical = turn / self.free_length
            own = 0.5 * self.belt_mass * self.acceleration_at(1.0) * self.free_length
            excess = self.compression + own - self.stiffness * critical * critical
            self.growth_rate = (
                wave / self.free_length * sqrt(excess / self.belt_mass) if excess > 0.0 else 0.0
            )
            self.show_ends()
        self.deflection_known = not self.lost and (not self.outside or self.follows(self.free_length))
        self.deflection_error = self.left() * self.largest_deflection
        self.margin_error = self.deflection_error / self.allowed_deflection
        self.margin = 1.0 - self.deflection / self.allowed_deflection
        self.lowest_margin = 1.0 - self.largest_deflection / self.allowed_deflection
        if self.held:
            return 2 if self.lost else 1
        return 0

    def left(self) -> float:
        """Share of the largest deflection by which deflections may be off with any steps."""
        if self.modes < 6:
            return UNKNOWN_LEFT
        if self.guide_end != CALIBRATED and self.head_end == GUIDED:
            return MOST_LEFT
        pushed_out = self.compression > 0.0 and self.velocity > 0.0
        return LEFT if pushed_out and not self.may_clamp() else MORE_LEFT

    def show_ends(self) -> None:
        """Shortening of the belt, and the moment by which its guide keeps it from turning."""
        length = self.free_length
        (
            d,
            _k,
            _guide,
            _head,
            _guide_rate,
            _head_rate,
            _guide_by_length,
            _head_by_length,
            _guide_second,
            _head_second,
        ) = self.ends(length, 0.0)
        (
            _f1,
            _f2,
            _f3,
            _f4,
            _f5,
            _f6,
            _g1,
            _g2,
            _g3,
            _g4,
            _g5,
            _g6,
            self.shortening,
            _rate,
            _second,
            _by_length,
            _energy,
            _growth,
            force,
            pull,
        ) = self.bend(length, 0.0)
        bending = self.stiffness * (6.0 * d / (length * length * length) - force)
        self.guide_moment = length * (bending - self.compression * pull)
