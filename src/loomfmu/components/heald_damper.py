"""HealdDamper: the heald carrier on springs inside its frame."""

from dataclasses import dataclass
from math import fabs, sqrt

from ..physics.damper import propagate, stop_damping_ratio
from ..physics.damper_search import contact_change, larger, next_turn, rate_bounds
from ..physics.numerics.motion import above_noise, bent, bump_noise, bumps, largest_between, sample_noise
from .damper_variables import DamperVariables

# Time [s] below which two samples are one: the squares and cubes of shorter steps would underflow
SHORTEST = 1e-15
# Pieces of motion in one step: some 10 us each in Python
MOST_PIECES = 10000
# Largest acceleration [m/s2] of a frame at rest: some hundred roundings of the motion of a loom, and little
# enough for one that turns once in a quarter of an hour. Against less than that no ratio can be told.
RESTING = 1e-12
MOST_TURNS = 6  # of a load in one piece: four, and two by rounding where it starts at one
MOST_CONTACTS = 2147483647  # counted: what an FMI integer holds


@dataclass(slots=True)
class HealdDamper(DamperVariables):
    """Heald-frame damper: the carrier on four springs, free between two stops, driven by its frame.

    Exact between two samples of the inputs, whatever the step: the frame moves on the quintic that
    joins them, contacts with the stops are located inside the step. Unconnected, it answers a steady
    acceleration of the frame.
    """

    def check(self) -> int:
        """Whether the carrier starts between its stops."""
        if fabs(self.start_displacement) > self.free_travel:
            return 2
        return 0

    def initialize(self, time: float) -> int:
        """Place the carrier and forget all peaks."""
        problem = self.check()
        if problem != 0:
            return problem
        self.damping = 2.0 * self.damping_ratio * sqrt(4.0 * self.spring_stiffness * self.carrier_mass)
        self.stop_damping = (
            2.0 * stop_damping_ratio(self.stop_restitution) * sqrt(self.stop_stiffness * self.carrier_mass)
        )
        self.displacement = self.start_displacement
        self.rate = self.start_rate
        self.contact = 0
        self.stop_contacts = 0
        self.peak_load = 0.0
        self.peak_carrier = 0.0
        self.peak_frame = fabs(self.acceleration)
        self.largest_lift = fabs(self.lift)
        self.remember()
        self.show(self.acceleration, self.warp_force)
        self.show_energies(0.0)
        return 0

    def remember(self) -> None:
        """Keep the present inputs as the last sample."""
        self.sampled_lift = self.lift
        self.sampled_velocity = self.velocity
        self.sampled_acceleration = self.acceleration
        self.sampled_force = self.warp_force

    def step(self, time: float, step_size: float) -> int:
        """Move the carrier over the step and show its state."""
        if step_size <= 0.0:
            return 0
        a0 = self.acceleration
        a1 = 0.0
        a2 = 0.0
        a3 = 0.0
        load = self.warp_force
        load_rate = 0.0
        if self.inputs_at_step_end and step_size > SHORTEST:
            a0, a1, a2, a3 = self.frame_between(time, step_size)
            load = self.sampled_force
            load_rate = (self.warp_force - self.sampled_force) / step_size
        elif fabs(self.acceleration) > self.peak_frame:
            self.peak_frame = fabs(self.acceleration)
        problem = self.move(step_size, a0, a1, a2, a3, load, load_rate)
        self.remember()
        self.show(self.acceleration, self.warp_force)
        self.show_energies(0.0 if self.inputs_at_step_end else step_size)
        return problem

    def frame_between(self, time: float, h: float) -> tuple[float, float, float, float]:
        """Acceleration of the frame from the last sample to this one, a cubic in the time since then.

        What moves the carrier is the whole quintic: integrated, it meets the samples, noise and all. The
        frame's largest acceleration is read off the curve, and there the noise is left out.
        """
        rate = h * self.sampled_velocity
        end_rate = h * self.velocity
        second = h * h * self.sampled_acceleration
        end_second = h * h * self.acceleration
        by_rate, by_value = bumps(self.sampled_lift, rate, second, self.lift, end_rate, end_second)
        if fabs(self.lift) > self.largest_lift:
            self.largest_lift = fabs(self.lift)
        # no bump is larger than that: most steps cannot hold the largest acceleration
        reach = fabs(second) if fabs(second) > fabs(end_second) else fabs(end_second)
        if reach + 0.25 * fabs(by_rate) + 0.1 * fabs(by_value) > self.peak_frame * h * h:
            self.note_frame(second, end_second, by_rate, by_value, fabs(rate) + fabs(end_rate), time / h, h)
        a0, a1, a2, a3 = bent(second, end_second, by_rate, by_value)
        square = h * h
        return a0 / square, a1 / (square * h), a2 / (square * square), a3 / (square * square * h)

    def note_frame(
        self, second: float, end_second: float, by_rate: float, by_value: float, rates: float, place: float,
        h: float,
    ) -> None:  # fmt: skip
        """Keep the largest acceleration of the frame, read off the curve without its noise."""
        rate_noise, value_noise = bump_noise(
            sample_noise(2.0 * self.largest_lift, rates, place),
            sample_noise(rates, fabs(second) + fabs(end_second), place),
        )
        a0, a1, a2, a3 = bent(
            second, end_second, above_noise(by_rate, 0.0, rate_noise), above_noise(by_value, 0.0, value_noise)
        )
        frame = largest_between(a0, a1, a2, a3) / (h * h)
        if frame > self.peak_frame:
            self.peak_frame = frame

    def on_stop(self) -> float:
        """1 or -1 while the carrier presses on the upper or lower stop, else 0."""
        if self.contact == 1 or self.contact == -1:
            return 1.0 * self.contact
        return 0.0

    def move(
        self, duration: float, a0: float, a1: float, a2: float, a3: float, load: float, load_rate: float
    ) -> int:
        """Move the carrier piece by piece: short against its own motion, one contact each."""
        mass = self.carrier_mass
        elapsed = 0.0
        pieces = 0
        own = sqrt(4.0 * self.spring_stiffness / mass) + self.damping / mass
        if own * duration > 0.5 * MOST_PIECES:
            return 1  # it would need more even if it never met a stop
        while elapsed < duration:
            pieces = pieces + 1
            if pieces > MOST_PIECES:
                return 1
            side = self.on_stop()
            stiffness = (4.0 * self.spring_stiffness + side * side * self.stop_stiffness) / mass
            damping = (self.damping + side * side * self.stop_damping) / mass
            preload = side * self.stop_stiffness * self.free_travel / mass
            piece = duration - elapsed
            rest = piece
            own = sqrt(stiffness) + damping
            if own * piece > 0.5:
                piece = 0.5 / own
            weight = load + load_rate * elapsed
            changed = self.move_piece(
                stiffness, damping, preload,
                preload + weight / mass - (a0 + elapsed * (a1 + elapsed * (a2 + elapsed * a3))),
                load_rate / mass - (a1 + elapsed * (2.0 * a2 + elapsed * 3.0 * a3)),
                -(a2 + 3.0 * a3 * elapsed),
                -a3,
                weight, load_rate, piece,
            )  # fmt: skip
            if changed >= rest:
                elapsed = duration
            else:
                elapsed = elapsed + changed
        return 0

    def move_piece(
        self, stiffness: float, damping: float, preload: float,
        u0: float, u1: float, u2: float, u3: float, load: float, load_rate: float, piece: float,
    ) -> float:  # fmt: skip
        """Move over one piece, or up to the change of contact within it; the time that took."""
        position = self.displacement
        rate = self.rate
        acceleration = u0 - stiffness * position - damping * rate
        jerk = u1 - stiffness * rate - damping * acceleration
        most_acceleration, most_jerk, most_snap = rate_bounds(
            acceleration, jerk, stiffness, damping, u2, u3, piece
        )
        taken = piece
        farthest = fabs(position) + piece * (fabs(rate) + 0.5 * piece * most_acceleration)
        before = self.contact
        if before != 0 or farthest >= self.free_travel:
            taken, self.contact = contact_change(
                before, position, rate, stiffness, damping, u0, u1, u2, u3,
                self.free_travel, self.stop_stiffness, self.stop_damping, most_acceleration, most_jerk, piece,
            )  # fmt: skip
            if before == 0 and self.contact != 0 and self.stop_contacts < MOST_CONTACTS:
                self.stop_contacts = self.stop_contacts + 1
        self.displacement, self.rate = propagate(position, rate, stiffness, damping, u0, u1, u2, u3, taken)
        first = stiffness * position + damping * rate - preload
        last = stiffness * self.displacement + damping * self.rate - preload
        # the curve lies no farther than that beyond the line between its ends
        bulge = 0.125 * taken * taken * (stiffness * most_acceleration + damping * most_jerk)
        bend = stiffness * most_jerk + damping * most_snap
        if self.carrier_mass * (larger(first, last) + bulge) > self.peak_load:
            self.note_turns(
                0.0, bend, position, rate, stiffness, damping, preload, u0, u1, u2, u3, load, load_rate, taken
            )
        pull = load / self.carrier_mass
        growth = load_rate / self.carrier_mass
        if larger(pull - first, pull + growth * taken - last) + bulge > self.peak_carrier:
            self.note_turns(
                growth, bend, position, rate, stiffness, damping, preload, u0, u1, u2, u3, load, load_rate,
                taken,
            )  # fmt: skip
        return taken

    def note_turns(
        self, growth: float, bend: float, position: float, rate: float, stiffness: float, damping: float,
        preload: float, u0: float, u1: float, u2: float, u3: float, load: float, load_rate: float,
        taken: float,
    ) -> None:  # fmt: skip
        """Keep the loads at the ends of a piece and where the transmitted one, less a growing one, turns.

        Its slope is a sum of five functions, which has four zeros at most on so short a piece.
        """
        self.note_load(self.carrier_mass * (stiffness * position + damping * rate - preload), load)
        transmitted = self.carrier_mass * (stiffness * self.displacement + damping * self.rate - preload)
        self.note_load(transmitted, load + load_rate * taken)
        turn = 0.0
        for _ in range(MOST_TURNS):
            turn = next_turn(
                growth, stiffness, damping, bend, position, rate, stiffness, damping, u0, u1, u2, u3,
                turn, taken,
            )  # fmt: skip
            if turn < 0.0:
                break
            z, v = propagate(position, rate, stiffness, damping, u0, u1, u2, u3, turn)
            transmitted = self.carrier_mass * (stiffness * z + damping * v - preload)
            self.note_load(transmitted, load + load_rate * turn)

    def note_load(self, transmitted: float, load: float) -> None:
        """Keep the largest transmitted force and carrier acceleration."""
        if fabs(transmitted) > self.peak_load:
            self.peak_load = fabs(transmitted)
        carrier = fabs(load - transmitted) / self.carrier_mass
        if carrier > self.peak_carrier:
            self.peak_carrier = carrier

    def show(self, acceleration: float, load: float) -> None:
        """Outputs that follow from the carrier's state."""
        side = self.on_stop()
        self.spring_force = 4.0 * self.spring_stiffness * self.displacement
        self.stop_force = (
            side
            * side
            * (
                self.stop_stiffness * (self.displacement - side * self.free_travel)
                + self.stop_damping * self.rate
            )
        )
        self.transmitted_force = self.spring_force + self.damping * self.rate + self.stop_force
        self.note_load(self.transmitted_force, load)
        self.carrier_acceleration = (load - self.transmitted_force) / self.carrier_mass
        self.acceleration_ratio = 0.0
        if self.peak_frame > RESTING:
            self.acceleration_ratio = self.peak_carrier / self.peak_frame

    def show_energies(self, lead: float) -> None:
        """Energies of the carrier's state, the frame's velocity carried over `lead`."""
        side = self.on_stop()
        pressed = side * side * (self.displacement - side * self.free_travel)
        velocity = self.velocity + self.acceleration * lead + self.rate
        self.kinetic_energy = 0.5 * self.carrier_mass * velocity * velocity
        self.potential_energy = (
            2.0 * self.spring_stiffness * self.displacement * self.displacement
            + 0.5 * self.stop_stiffness * pressed * pressed
        )
        self.dissipated_power = (self.damping + side * side * self.stop_damping) * self.rate * self.rate
