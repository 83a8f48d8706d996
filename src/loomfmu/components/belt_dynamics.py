"""BeltDynamics: the rapier belt between guide and head in motion, its bow amplified by the push."""

from dataclasses import dataclass
from math import fabs, sqrt

from ..physics.belt import LARGEST_BEND
from ..physics.belt_bending import LEAST_SQUARE, bent_belt
from ..physics.belt_ends import buckling, end_shape
from ..physics.belt_guide import before_switch, has_play, leans_on, next_contact, switched
from ..physics.belt_modes import Bow
from ..physics.belt_motion import accelerations, ends_at, energy_at
from ..physics.belt_moving import (
    Belt,
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
from .belt_dynamics_variables import BeltDynamicsVariables

CALIBRATED = 1  # guide: pinned, with a stiffness that makes up for it
GUIDED = 2  # head: it cannot turn
JUMP = 1e-6  # m, that a standing head may be off
MOST_SWEEPS = 10000  # over the stages of the integration in one step; both strokes of a loom need fewer
MOST_HALVINGS = 13
SHORTEST_SHARE = 5e-3  # of an integration step: it goes that far at least, however contact comes and goes
BALANCED = 2.5e-10  # of the energy: what an integration step may leave unexplained, if it can be halved
UNBALANCED = 1e-6  # of the energy: a step that leaves more, however short, cannot be followed
EASY = 1e-3  # of that: then the next step may be twice as long
LEAST_ENERGY = 1e-15  # J: below, rounding and not the step is at fault
STEEPEST = sqrt(1.0 - 2.0 * LEAST_SQUARE)  # sine of the slope at which the belt counts as folded: 72 degrees
MOST_WAVES = 5.0  # half waves of its own bow that a free belt may have: six modes cannot follow more
LEFT = 2.5e-4  # of the largest deflection: what six modes and the integration leave under the push
MORE_LEFT = 1e-2  # later, when the belt swings on and comes back, or where an end may be clamped
MOST_LEFT = 3e-2  # where both may be: under a load that lasts beyond Euler's
UNKNOWN_LEFT = 100.0  # with fewer than six modes, of which one gives an eighth of the deflection of six
SHORTEST_STEP = 1e-100  # [s]: nothing moves in less, whose square is no number any more


@dataclass(slots=True)
class BeltDynamics(BeltDynamicsVariables):
    """Rapier belt in motion: a beam of growing length that moves through the guide and pushes the head.

    Between two samples of the inputs the head moves on the quintic that joins them; six modes are integrated
    by Gauss's method of order 6.
    """

    def initialize(self, time: float) -> int:
        """Let the belt rest in equilibrium and forget all extremes and work."""
        if self.guide_end != CALIBRATED and self.guide_clearance >= self.guide_length:
            return 3
        self.folded = False
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
        return Belt(
            self.head_mass,
            self.belt_mass,
            2.0 * self.belt_mass * self.damping,
            self.bending_stiffness / (factor * factor),
            Bow(self.bow_of, self.bow, self.bow_length),
            self.guide_offset,
            self.guide_length,
            self.guide_clearance,
            self.guide_end != CALIBRATED,
            self.head_end == GUIDED,
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
        self.mode = [0.0] * 6
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
            if error > BALANCED and halvings < MOST_HALVINGS:
                halvings = halvings + 1
                continue
            if error > UNBALANCED:
                break
            if error < EASY * BALANCED and halvings > 0:
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
            load = self.take_extremes(belt, at, stages.duration, last, last_rate, load)
            if not self.steepness < STEEPEST:
                self.fold(belt, at)
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
        self.largest_deflection = highest_so_far(
            self.largest_deflection, duration, last, last_rate, value, rate
        )
        part = 1.0
        if load <= 0.0 and load_before > 0.0:
            part = load_before / (load_before - load)
            value, rate = met(part, duration, last, last_rate, value, rate)
        if load > 0.0 or load_before > 0.0:
            self.largest_at_risk = highest_so_far(
                self.largest_at_risk, part * duration, last, last_rate, value, rate
            )
        return load

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
        self.deflection_known = not self.lost and (not self.outside or self.follows(self.free_length))
        self.deflection_error = self.left(may_clamp(belt)) * self.largest_deflection
        self.margin_error = self.deflection_error / self.allowed_deflection
        self.margin = 1.0 - self.deflection / self.allowed_deflection
        self.lowest_margin = 1.0 - self.largest_deflection / self.allowed_deflection
        if self.held:
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
        if self.guide_end != CALIBRATED and self.head_end == GUIDED:
            return MOST_LEFT
        pushed_out = self.compression > 0.0 and self.velocity > 0.0
        return LEFT if pushed_out and not may_clamp else MORE_LEFT
