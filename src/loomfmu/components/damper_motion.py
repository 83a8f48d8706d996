"""How the heald carrier moves over a step: piece by piece, between its stops, with its threads."""

from dataclasses import dataclass
from math import fabs, sqrt

from ..physics.damper import power_of_frame, propagate
from ..physics.damper_search import contact_change, larger, next_turn, rate_bounds
from ..physics.hung_warp import force_after, settled_load, warp_stiffness
from ..physics.numerics.motion import joined_area, moved_on
from .damper_variables import DamperVariables

# Pieces of motion in one step, and attempts at one: some 10 us each in Python, up to 600 with threads
MOST_PIECES = 10000
# A piece is short against the motion of the carrier: by as much, and with threads by as much, whose load
# is a cubic along it
SHORT = 0.5
SHORT_WITH_THREADS = 0.05
MOST_HALVINGS = 60  # of a piece that is too long for threads so stiff
MOST_TURNS = 6  # of a load in one piece: four, and two by rounding where it starts at one
MOST_CONTACTS = 2147483647  # counted: what an FMI integer holds


@dataclass(slots=True)
class DamperMotion(DamperVariables):
    """The carrier's motion from one sample of its inputs to the next."""

    def eye_offset(self) -> float:
        """Height of the eyes above the warp line less the lift of their carrier."""
        return self.shed_offset - 0.5 * self.stroke

    def on_stop(self) -> float:
        """1 or -1 while the carrier presses on the upper or lower stop, else 0."""
        if self.contact == 1 or self.contact == -1:
            return 1.0 * self.contact
        return 0.0

    def move(
        self,
        duration: float,
        lift: float,
        velocity: float,
        a0: float,
        a1: float,
        a2: float,
        a3: float,
        load: float,
        load_rate: float,
    ) -> int:
        """Move the carrier piece by piece: short against its own motion, one contact each."""
        mass = self.carrier_mass
        elapsed = 0.0
        pieces = 0
        short = SHORT if self.thread_count == 0 else SHORT_WITH_THREADS
        own = sqrt(4.0 * self.spring_stiffness / mass) + self.damping / mass
        if own * duration > short * MOST_PIECES:
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
            here, speed, b0 = moved_on(lift, velocity, a0, a1, a2, a3, elapsed)
            b1 = a1 + elapsed * (2.0 * a2 + elapsed * 3.0 * a3)
            b2 = a2 + 3.0 * a3 * elapsed
            own = self.quickness(stiffness, damping, here)
            if own * piece > short:
                piece = short / own
            weight = load + load_rate * elapsed
            changed, halvings = self.move_with_threads(
                stiffness, damping, preload, here, speed, b0, b1, b2, a3, weight, load_rate, piece
            )
            if halvings > MOST_HALVINGS:
                return 1  # however short, a piece never settles
            pieces = pieces + halvings
            if changed >= rest:
                elapsed = duration
            else:
                elapsed = elapsed + changed
        return 0

    def quickness(self, stiffness: float, damping: float, lift: float) -> float:
        """How fast the carrier moves by itself, with its threads [1/s]: a piece is short against that."""
        if self.thread_count == 0:
            return sqrt(stiffness) + damping
        threads = warp_stiffness(
            lift + self.eye_offset() + self.displacement,
            self.thread_force,
            self.thread_count * self.pretension,
            self.thread_count * self.thread_stiffness,
            self.front_length,
            self.back_length,
        )
        return sqrt(stiffness + threads / self.carrier_mass) + damping + self.relaxation_rate

    def move_with_threads(
        self,
        stiffness: float,
        damping: float,
        preload: float,
        lift: float,
        velocity: float,
        a0: float,
        a1: float,
        a2: float,
        a3: float,
        load: float,
        load_rate: float,
        piece: float,
    ) -> tuple[float, int]:
        """Move carrier and threads over one piece, or up to the change of contact in it.

        Returns:
            the time it took [s], and how often the piece was halved, more than `MOST_HALVINGS` if in vain
        """
        mass = self.carrier_mass
        u0 = preload + load / mass - a0
        u1 = load_rate / mass - a1
        position = self.displacement
        rate = self.rate
        if self.thread_count == 0:
            taken = self.move_piece(
                stiffness, damping, preload, u0, u1, -a2, -a3, load, load_rate, 0.0, 0.0, piece
            )
            self.take_work(
                stiffness, damping, preload, position, rate, u0, u1, -a2, -a3, velocity, a0, a1, a2, a3, taken
            )
            return taken, 0
        eyes = lift + self.eye_offset()
        threads = self.thread_count * self.thread_stiffness
        taken = piece
        d0, d1, d2, d3, settled = self.load_of_threads(
            stiffness, damping, u0, u1, eyes, velocity, a0, a1, a2, a3, taken
        )
        halvings = 0
        while not settled and halvings < MOST_HALVINGS:
            halvings = halvings + 1
            taken = 0.5 * taken
            d0, d1, d2, d3, settled = self.load_of_threads(
                stiffness, damping, u0, u1, eyes, velocity, a0, a1, a2, a3, taken
            )
        if not settled:
            return taken, MOST_HALVINGS + 1
        acceleration = u0 + a0 + d0 / mass - stiffness * position - damping * rate
        taken = self.move_piece(
            stiffness,
            damping,
            preload,
            u0 + d0 / mass,
            u1 + d1 / mass,
            d2 / mass - a2,
            d3 / mass - a3,
            load + d0,
            load_rate + d1,
            d2,
            d3,
            taken,
        )
        self.take_work(
            stiffness,
            damping,
            preload,
            position,
            rate,
            u0 + d0 / mass,
            u1 + d1 / mass,
            d2 / mass - a2,
            d3 / mass - a3,
            velocity,
            a0,
            a1,
            a2,
            a3,
            taken,
        )
        end_lift, end_velocity, end_acceleration = moved_on(eyes, velocity, a0, a1, a2, a3, taken)
        drive = (
            u0 + d0 / mass + taken * (u1 + d1 / mass + taken * (d2 / mass - a2 + taken * (d3 / mass - a3)))
        )
        self.thread_force = force_after(
            eyes + position,
            velocity + rate,
            acceleration,
            end_lift + self.displacement,
            end_velocity + self.rate,
            end_acceleration + drive - stiffness * self.displacement - damping * self.rate,
            self.thread_force,
            threads,
            self.creep_rate,
            self.relaxation_rate,
            self.front_length,
            self.back_length,
            taken,
        )
        return taken, halvings

    def load_of_threads(
        self,
        stiffness: float,
        damping: float,
        u0: float,
        u1: float,
        eyes: float,
        velocity: float,
        a0: float,
        a1: float,
        a2: float,
        a3: float,
        piece: float,
    ) -> tuple[float, float, float, float, bool]:
        """What threads add to the load over one piece, by powers of time, and whether it has settled."""
        return settled_load(
            self.displacement,
            self.rate,
            self.thread_force,
            self.carrier_mass,
            stiffness,
            damping,
            u0,
            u1,
            -a2,
            -a3,
            eyes,
            velocity,
            a0,
            a1,
            a2,
            a3,
            self.thread_count * self.pretension,
            self.thread_count * self.thread_stiffness,
            self.creep_rate,
            self.relaxation_rate,
            self.front_length,
            self.back_length,
            piece,
        )

    def move_piece(
        self,
        stiffness: float,
        damping: float,
        preload: float,
        u0: float,
        u1: float,
        u2: float,
        u3: float,
        load: float,
        load_1: float,
        load_2: float,
        load_3: float,
        piece: float,
    ) -> float:
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
                before,
                position,
                rate,
                stiffness,
                damping,
                u0,
                u1,
                u2,
                u3,
                self.free_travel,
                self.stop_stiffness,
                self.stop_damping,
                most_acceleration,
                most_jerk,
                piece,
            )
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
                False,
                bend,
                position,
                rate,
                stiffness,
                damping,
                preload,
                u0,
                u1,
                u2,
                u3,
                load,
                load_1,
                load_2,
                load_3,
                taken,
            )
        mass = self.carrier_mass
        end_load = load + taken * (load_1 + taken * (load_2 + taken * load_3))
        load_bend = 2.0 * fabs(load_2) + 6.0 * fabs(load_3) * taken
        bulge = bulge + 0.125 * taken * taken * load_bend / mass
        if larger(load / mass - first, end_load / mass - last) + bulge > self.peak_carrier:
            self.note_turns(
                True,
                bend + 6.0 * fabs(load_3) / mass,
                position,
                rate,
                stiffness,
                damping,
                preload,
                u0,
                u1,
                u2,
                u3,
                load,
                load_1,
                load_2,
                load_3,
                taken,
            )
        return taken

    def take_work(
        self,
        stiffness: float,
        damping: float,
        preload: float,
        position: float,
        rate: float,
        u0: float,
        u1: float,
        u2: float,
        u3: float,
        velocity: float,
        a0: float,
        a1: float,
        a2: float,
        a3: float,
        taken: float,
    ) -> None:
        """Add the work of the frame on the carrier over a piece: its power runs on a quintic there."""
        mass = self.carrier_mass
        power, growth, bend = power_of_frame(
            mass, stiffness, damping, preload, position, rate, u0, u1, velocity, a0, a1
        )
        t = taken
        end_power, end_growth, end_bend = power_of_frame(
            mass,
            stiffness,
            damping,
            preload,
            self.displacement,
            self.rate,
            u0 + t * (u1 + t * (u2 + t * u3)),
            u1 + t * (2.0 * u2 + t * 3.0 * u3),
            velocity + t * (a0 + t * (a1 / 2.0 + t * (a2 / 3.0 + t * a3 / 4.0))),
            a0 + t * (a1 + t * (a2 + t * a3)),
            a1 + t * (2.0 * a2 + t * 3.0 * a3),
        )
        self.frame_work = self.frame_work + joined_area(
            t, power, growth, bend, end_power, end_growth, end_bend
        )

    def note_turns(
        self,
        of_carrier: bool,
        bend: float,
        position: float,
        rate: float,
        stiffness: float,
        damping: float,
        preload: float,
        u0: float,
        u1: float,
        u2: float,
        u3: float,
        load: float,
        load_1: float,
        load_2: float,
        load_3: float,
        taken: float,
    ) -> None:
        """Keep the loads at the ends of a piece and where the transmitted one, or the carrier's sum, turns.

        Its slope is a sum of six functions at most, which has few zeros on so short a piece.
        """
        mass = self.carrier_mass
        share = 1.0 / mass if of_carrier else 0.0
        self.note_load(mass * (stiffness * position + damping * rate - preload), load)
        transmitted = mass * (stiffness * self.displacement + damping * self.rate - preload)
        self.note_load(transmitted, load + taken * (load_1 + taken * (load_2 + taken * load_3)))
        turn = 0.0
        for _ in range(MOST_TURNS):
            turn = next_turn(
                share * load_1,
                share * 2.0 * load_2,
                share * 3.0 * load_3,
                stiffness,
                damping,
                bend,
                position,
                rate,
                stiffness,
                damping,
                u0,
                u1,
                u2,
                u3,
                turn,
                taken,
            )
            if turn < 0.0:
                break
            z, v = propagate(position, rate, stiffness, damping, u0, u1, u2, u3, turn)
            transmitted = mass * (stiffness * z + damping * v - preload)
            self.note_load(transmitted, load + turn * (load_1 + turn * (load_2 + turn * load_3)))

    def note_load(self, transmitted: float, load: float) -> None:
        """Keep the largest transmitted force and carrier acceleration."""
        if fabs(transmitted) > self.peak_load:
            self.peak_load = fabs(transmitted)
        carrier = fabs(load - transmitted) / self.carrier_mass
        if carrier > self.peak_carrier:
            self.peak_carrier = carrier
