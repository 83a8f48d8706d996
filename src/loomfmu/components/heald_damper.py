"""HealdDamper: the heald carrier on springs inside its frame."""

from dataclasses import dataclass
from math import fabs, sqrt

from ..physics.damper import stop_damping_ratio
from ..physics.hung_warp import warp_load
from ..physics.numerics.motion import above_noise, bent, bump_noise, bumps, largest_between, sample_noise
from ..physics.shaft import carried
from ..physics.warp import thread_extension
from .damper_motion import DamperMotion

# Time [s] below which two samples are one: the squares and cubes of shorter steps would underflow
SHORTEST = 1e-15
# Largest acceleration [m/s2] of a frame at rest: some hundred roundings of the motion of a loom, and little
# enough for one that turns once in a quarter of an hour. Against less than that no ratio can be told.
RESTING = 1e-12


@dataclass(slots=True)
class HealdDamper(DamperMotion):
    """Heald-frame damper: the carrier on four springs, free between two stops, driven by its frame.

    Exact between two samples of the inputs, whatever the step: the frame moves on the quintic that
    joins them, contacts with the stops are located inside the step. Unconnected, it answers a steady
    acceleration of the frame.
    """

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
        problem = self.move(step_size, lift, velocity, a0, a1, a2, a3, load, load_rate)
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
        load, _rate = warp_load(
            self.carrier_lift + self.eye_offset(),
            self.carrier_velocity,
            self.thread_force,
            self.thread_count * self.pretension,
            self.thread_count * self.thread_stiffness,
            self.creep_rate,
            self.relaxation_rate,
            self.front_length,
            self.back_length,
        )
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
