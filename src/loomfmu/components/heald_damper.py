"""HealdDamper: the heald carrier on springs inside its frame."""

from dataclasses import dataclass
from math import fabs, inf, sqrt
from typing import ClassVar

from ..declaring.declarations import at_step_end, input_, output, parameter, state
from ..declaring.variables import MIXED, Problem, Terminal
from ..physics.damper import (
    Piece,
    Ride,
    Swing,
    drive_at,
    load_at,
    power_of_frame,
    propagate,
    ride_on,
    stop_damping_ratio,
)
from ..physics.damper_search import SLOPE, Gauge, Stop, contact_change, larger, next_turn, rate_bounds
from ..physics.hung_warp import Warp, force_after, pulled, settled_load, warp_load, warp_stiffness
from ..physics.numerics.motion import (
    above_noise,
    bent,
    bump_noise,
    bumps,
    joined_area,
    largest_between,
    sample_noise,
)
from ..physics.shaft import carried
from ..physics.warp import thread_extension
from .quantities import LENGTH, LOAD, MASS, RATIO, STIFFNESS, VELOCITY
from .shared_declarations import frame_acceleration, frame_lift, frame_velocity
from .terminals import CARRIER, FRAME
from .threads import Threads

# Pieces of motion in one step, and attempts at one: some 10 us each in Python, up to 600 with threads
MOST_PIECES = 10000
# A piece is short against the motion of the carrier: by as much, and with threads by as much, whose load
# is a cubic along it
SHORT = 0.5
SHORT_WITH_THREADS = 0.05
MOST_HALVINGS = 60  # of a piece that is too long for threads so stiff
MOST_TURNS = 6  # of a load in one piece: four, and two by rounding where it starts at one
MOST_CONTACTS = 2147483647  # counted: what an FMI integer holds
# Time [s] below which two samples are one: the squares and cubes of shorter steps would underflow
SHORTEST = 1e-15
# Largest acceleration [m/s2] of a frame at rest: some hundred roundings of the motion of a loom, and little
# enough for one that turns once in a quarter of an hour. Against less than that no ratio can be told.
RESTING = 1e-12


@dataclass(slots=True)
class HealdDamper(Threads):
    """Heald-frame damper: the carrier on four springs, free between two stops, driven by its frame.

    Exact between two samples of the inputs, whatever the step: the frame moves on the quintic that
    joins them, contacts with the stops are located inside the step. Unconnected, it answers a steady
    acceleration of the frame.
    """

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
        MASS.within(1e-3, 1e3, nominal=10.0),
        7.5,
        "Mass of the heald carrier with its healds (assumed: half of the published 15 kg)",
    )
    spring_stiffness: float = parameter(
        STIFFNESS.within(0.0, 1e12, nominal=1e4), 5960.0, "Stiffness of one of the four springs"
    )
    damping_ratio: float = parameter(
        RATIO.within(0.0, 100.0),
        0.05,
        "Damping ratio of the suspension, relative to critical (assumed: none published)",
    )
    free_travel: float = parameter(
        LENGTH.within(0.0, 1.0, nominal=0.01), 0.015, "Free travel of the carrier to either side"
    )
    stop_stiffness: float = parameter(
        STIFFNESS.within(1.0, 1e12, nominal=1e6), 2e6, "Stiffness of a stop (assumed: none published)"
    )
    stop_restitution: float = parameter(
        RATIO.within(0.15, 1.0), 0.5, "Coefficient of restitution of a stop (assumed)"
    )
    start_displacement: float = parameter(
        LENGTH.within(-1.0, 1.0), 0.0, "Displacement of the carrier at the start"
    )
    start_rate: float = parameter(VELOCITY.within(-1e3, 1e3), 0.0, "Rate of the displacement at the start")
    inputs_at_step_end: bool = at_step_end()
    lift: float = frame_lift(0.0)
    velocity: float = frame_velocity()
    acceleration: float = frame_acceleration(10.0)
    warp_force: float = input_(
        LOAD, 0.0, "Further load on the carrier, upwards, such as a warp model of your own"
    )
    displacement: float = output(
        LENGTH, "Displacement of the carrier in its frame", nominal=0.01, rate="rate"
    )
    rate: float = output("m/s", "Rate of the displacement")
    spring_force: float = output("N", "Force of the four springs on the frame", nominal=100.0)
    stop_force: float = output("N", "Force of the carrier on a stop", nominal=1000.0)
    transmitted_force: float = output(
        "N", "Force of the carrier on the frame: springs, damping, stops", nominal=1000.0
    )
    carrier_lift: float = output(
        LENGTH,
        "Lift of the carrier, that of its frame and its displacement",
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

    def check(self) -> int:
        """Check that the carrier starts between its stops."""
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
        self.frame_work = 0.0
        self.peak_load = 0.0
        self.peak_carrier = 0.0
        self.peak_frame = fabs(self.acceleration)
        self.largest_lift = fabs(self.lift)
        extension, _rate, _second = thread_extension(
            self.lift + self.eye_offset() + self.displacement, 0.0, 0.0, self.front_length, self.back_length
        )
        self.thread_force = self.thread_count * self.thread_stiffness * extension
        self.remember()
        self.show(0.0)
        self.show_energies()
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
        lift = self.lift
        velocity = self.velocity
        load = self.warp_force
        load_rate = 0.0
        if self.inputs_at_step_end and step_size > SHORTEST:
            a0, a1, a2, a3 = self.frame_between(time, step_size)
            lift = self.sampled_lift
            velocity = self.sampled_velocity
            load = self.sampled_force
            load_rate = (self.warp_force - self.sampled_force) / step_size
        elif fabs(self.acceleration) > self.peak_frame:
            self.peak_frame = fabs(self.acceleration)
        ride = Ride(lift, velocity, a0, a1, a2, a3)
        problem = self.move(step_size, ride, load, load_rate)
        self.remember()
        self.show(0.0 if self.inputs_at_step_end else step_size)
        self.show_energies()
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
        self,
        second: float,
        end_second: float,
        by_rate: float,
        by_value: float,
        rates: float,
        place: float,
        h: float,
    ) -> None:
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

    def eye_offset(self) -> float:
        """Height of the eyes above the warp line less the lift of their carrier."""
        return self.shed_offset - 0.5 * self.stroke

    def on_stop(self) -> float:
        """1 or -1 while the carrier presses on the upper or lower stop, else 0."""
        if self.contact == 1 or self.contact == -1:
            return 1.0 * self.contact
        return 0.0

    def warp(self) -> Warp:
        """The threads, all together."""
        return Warp(
            self.thread_count * self.pretension,
            self.thread_count * self.thread_stiffness,
            self.creep_rate,
            self.relaxation_rate,
            self.front_length,
            self.back_length,
        )

    def move(self, duration: float, ride: Ride, load: float, load_rate: float) -> int:
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
            rest = duration - elapsed
            now = ride_on(ride, elapsed)
            own = self.quickness(stiffness, damping, now.lift)
            piece = short / own if own * rest > short else rest
            weight = load + load_rate * elapsed
            swing = Swing(
                self.displacement,
                self.rate,
                stiffness,
                damping,
                preload + weight / mass - now.a0,
                load_rate / mass - now.a1,
                -now.a2,
                -now.a3,
            )
            changed, halvings = self.move_with_threads(swing, preload, now, weight, load_rate, piece)
            if halvings > MOST_HALVINGS:
                return 1  # however short, a piece never settles
            pieces = pieces + halvings
            elapsed = duration if changed >= rest else elapsed + changed
        return 0

    def quickness(self, stiffness: float, damping: float, lift: float) -> float:
        """Rate at which the carrier moves by itself with its threads [1/s]: a piece is short against it."""
        if self.thread_count == 0:
            return sqrt(stiffness) + damping
        warp = self.warp()
        threads = warp_stiffness(warp, self.thread_force, lift + self.eye_offset() + self.displacement)
        return sqrt(stiffness + threads / self.carrier_mass) + damping + self.relaxation_rate

    def move_with_threads(
        self, swing: Swing, preload: float, ride: Ride, load: float, load_rate: float, piece: float
    ) -> tuple[float, int]:
        """Move carrier and threads over one piece, or up to the change of contact in it.

        Returns:
            the time it took [s], and how often the piece was halved, more than `MOST_HALVINGS` if in vain
        """
        mass = self.carrier_mass
        if self.thread_count == 0:
            alone = Piece(swing, preload, load, load_rate, 0.0, 0.0)
            taken = self.move_piece(alone, piece)
            self.take_work(alone, ride, taken)
            return taken, 0
        warp = self.warp()
        force = self.thread_force
        eyes = Ride(ride.lift + self.eye_offset(), ride.velocity, ride.a0, ride.a1, ride.a2, ride.a3)
        taken = piece
        d0, d1, d2, d3, settled = settled_load(warp, force, mass, swing, eyes, taken)
        halvings = 0
        while not settled and halvings < MOST_HALVINGS:
            halvings = halvings + 1
            taken = 0.5 * taken
            d0, d1, d2, d3, settled = settled_load(warp, force, mass, swing, eyes, taken)
        if not settled:
            return taken, MOST_HALVINGS + 1
        stiffness = swing.stiffness
        damping = swing.damping
        acceleration = swing.drive + ride.a0 + d0 / mass - stiffness * swing.position - damping * swing.rate
        together = Piece(pulled(swing, mass, d0, d1, d2, d3), preload, load + d0, load_rate + d1, d2, d3)
        taken = self.move_piece(together, taken)
        self.take_work(together, ride, taken)
        end = ride_on(eyes, taken)
        second = end.a0 + drive_at(together.swing, taken)
        self.thread_force = force_after(
            warp,
            force,
            eyes.lift + swing.position,
            ride.velocity + swing.rate,
            acceleration,
            end.lift + self.displacement,
            end.velocity + self.rate,
            second - stiffness * self.displacement - damping * self.rate,
            taken,
        )
        return taken, halvings

    def move_piece(self, piece: Piece, duration: float) -> float:
        """Move over one piece, or up to the change of contact within it; the time that took."""
        swing = piece.swing
        stiffness = swing.stiffness
        damping = swing.damping
        most_acceleration, most_jerk, most_snap = rate_bounds(swing, duration)
        taken = duration
        farthest = fabs(swing.position) + duration * (fabs(swing.rate) + 0.5 * duration * most_acceleration)
        before = self.contact
        if before != 0 or farthest >= self.free_travel:
            stop = Stop(self.free_travel, self.stop_stiffness, self.stop_damping)
            taken, self.contact = contact_change(before, stop, swing, most_acceleration, most_jerk, duration)
            if before == 0 and self.contact != 0 and self.stop_contacts < MOST_CONTACTS:
                self.stop_contacts = self.stop_contacts + 1
        self.displacement, self.rate = propagate(swing, taken)
        first = stiffness * swing.position + damping * swing.rate - piece.preload
        last = stiffness * self.displacement + damping * self.rate - piece.preload
        # the curve lies no farther than that beyond the line between its ends
        bulge = 0.125 * taken * taken * (stiffness * most_acceleration + damping * most_jerk)
        bend = stiffness * most_jerk + damping * most_snap
        mass = self.carrier_mass
        if mass * (larger(first, last) + bulge) > self.peak_load:
            self.note_turns(piece, False, bend, taken)
        load_bend = 2.0 * fabs(piece.load_2) + 6.0 * fabs(piece.load_3) * taken
        bulge = bulge + 0.125 * taken * taken * load_bend / mass
        if larger(piece.load / mass - first, load_at(piece, taken) / mass - last) + bulge > self.peak_carrier:
            self.note_turns(piece, True, bend + 6.0 * fabs(piece.load_3) / mass, taken)
        return taken

    def take_work(self, piece: Piece, ride: Ride, taken: float) -> None:
        """Add the work of the frame on the carrier over a piece: its power runs on a quintic there."""
        mass = self.carrier_mass
        swing = piece.swing
        t = taken
        power, growth, bend = power_of_frame(mass, piece.preload, swing, ride.velocity, ride.a0, ride.a1)
        end = Swing(
            self.displacement,
            self.rate,
            swing.stiffness,
            swing.damping,
            drive_at(swing, t),
            swing.drive_1 + t * (2.0 * swing.drive_2 + t * 3.0 * swing.drive_3),
            swing.drive_2,
            swing.drive_3,
        )
        end_power, end_growth, end_bend = power_of_frame(
            mass,
            piece.preload,
            end,
            ride.velocity + t * (ride.a0 + t * (ride.a1 / 2.0 + t * (ride.a2 / 3.0 + t * ride.a3 / 4.0))),
            ride.a0 + t * (ride.a1 + t * (ride.a2 + t * ride.a3)),
            ride.a1 + t * (2.0 * ride.a2 + t * 3.0 * ride.a3),
        )
        self.frame_work = self.frame_work + joined_area(
            t, power, growth, bend, end_power, end_growth, end_bend
        )

    def note_turns(self, piece: Piece, of_carrier: bool, bend: float, taken: float) -> None:
        """Keep the loads at the ends of a piece and where the transmitted one, or the carrier's sum, turns.

        Its slope is a sum of six functions at most, which has few zeros on so short a piece.
        """
        swing = piece.swing
        share = 1.0 / self.carrier_mass if of_carrier else 0.0
        self.note_place(piece, swing.position, swing.rate, 0.0)
        self.note_place(piece, self.displacement, self.rate, taken)
        slope = Gauge(
            SLOPE,
            share * piece.load_1,
            share * 2.0 * piece.load_2,
            share * 3.0 * piece.load_3,
            swing.stiffness,
            swing.damping,
        )
        turn = 0.0
        for _ in range(MOST_TURNS):
            turn = next_turn(slope, swing, bend, turn, taken)
            if turn < 0.0:
                break
            z, v = propagate(swing, turn)
            self.note_place(piece, z, v, turn)

    def note_place(self, piece: Piece, position: float, rate: float, time: float) -> None:
        """Keep the loads at a place of a piece."""
        swing = piece.swing
        pressed = swing.stiffness * position + swing.damping * rate - piece.preload
        self.note_load(self.carrier_mass * pressed, load_at(piece, time))

    def note_load(self, transmitted: float, load: float) -> None:
        """Keep the largest transmitted force and carrier acceleration."""
        if fabs(transmitted) > self.peak_load:
            self.peak_load = fabs(transmitted)
        carrier = fabs(load - transmitted) / self.carrier_mass
        if carrier > self.peak_carrier:
            self.peak_carrier = carrier

    def show(self, lead: float) -> None:
        """Outputs that follow from the carrier's state, the inputs carried over `lead`."""
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
        self.carrier_lift = carried(self.lift, self.velocity, self.acceleration, lead) + self.displacement
        self.carrier_velocity = self.velocity + self.acceleration * lead + self.rate
        self.warp_load = self.threads_load()
        load = self.warp_force + self.warp_load
        self.note_load(self.transmitted_force, load)
        self.carrier_acceleration = (load - self.transmitted_force) / self.carrier_mass
        self.acceleration_ratio = 0.0
        if self.peak_frame > RESTING:
            self.acceleration_ratio = self.peak_carrier / self.peak_frame

    def threads_load(self) -> float:
        """Load of the threads on the carrier as it is shown."""
        if self.thread_count == 0:
            return 0.0
        warp = self.warp()
        height = self.carrier_lift + self.eye_offset()
        load, _rate = warp_load(warp, self.thread_force, height, self.carrier_velocity)
        return load

    def show_energies(self) -> None:
        """Energies of the carrier's state; those of its threads are outputs of `WarpTension`."""
        side = self.on_stop()
        pressed = side * side * (self.displacement - side * self.free_travel)
        self.kinetic_energy = 0.5 * self.carrier_mass * self.carrier_velocity * self.carrier_velocity
        self.potential_energy = (
            2.0 * self.spring_stiffness * self.displacement * self.displacement
            + 0.5 * self.stop_stiffness * pressed * pressed
        )
        self.dissipated_power = (self.damping + side * side * self.stop_damping) * self.rate * self.rate
