"""What BeltDynamics knows of its belt at any instant of a step: its path, its load, what moves its modes."""

from dataclasses import dataclass

from ..physics.belt import weft_load
from ..physics.belt_modes import dot, same, summed
from ..physics.belt_motion import accelerations
from ..physics.numerics.motion import joined, joined_rate, joined_value, met
from .belt_guide import CALIBRATED, TOUCHING, BeltGuide

HALVINGS = 50  # of an integration step: then the place is known to rounding


@dataclass(slots=True)
class BeltPath(BeltGuide):
    """Free length, velocity and load over a step, and the accelerations of the modes."""

    def lay_path(self, duration: float) -> None:
        """The free length over a time, from the last sample of the inputs to this one."""
        guide = self.idle_travel + self.head_length
        square = duration * duration
        self.path_step = duration
        factor = self.length_factor if self.guide_end == CALIBRATED else 1.0
        self.stiffness = self.bending_stiffness / (factor * factor)
        if duration > 0.0:
            a0, a1, a2, a3 = joined(
                self.sampled_travel,
                duration * self.sampled_velocity,
                square * self.sampled_acceleration,
                self.travel,
                duration * self.velocity,
                square * self.acceleration,
            )
            start = self.sampled_travel - guide
            self.path = (start, duration * self.sampled_velocity, a0, a1, a2, a3)
            self.start_tension = self.sampled_tension
        else:
            self.path = (self.travel - guide, 0.0, 0.0, 0.0, 0.0, 0.0)
            self.start_tension = self.yarn_tension

    def joined_at(self, share: float) -> tuple[float, float]:
        """Free length at a share of the step, negative inside the guide, and its second derivative by it."""
        start, rate = self.path[0], self.path[1]
        return joined_value(start, rate, self.path[2], self.path[3], self.path[4], self.path[5], share)

    def length_at(self, share: float) -> float:
        """Free length at a share of the step, at least half of the shortest one."""
        length, _second = self.joined_at(share)
        least = 0.5 * self.shortest_length
        return length if length > least else least

    def velocity_at(self, share: float) -> float:
        """Velocity of the belt at a share of the step."""
        if self.path_step <= 0.0:
            return self.velocity
        rate = joined_rate(self.path[1], self.path[2], self.path[3], self.path[4], self.path[5], share)
        return rate / self.path_step

    def acceleration_at(self, share: float) -> float:
        """Acceleration of the belt at a share of the step."""
        if self.path_step <= 0.0:
            return self.acceleration
        _length, second = self.joined_at(share)
        return second / (self.path_step * self.path_step)

    def tension_at(self, share: float) -> float:
        """Compression by the weft at a share of the step."""
        tension = self.start_tension + share * (self.yarn_tension - self.start_tension)
        return weft_load(tension, self.velocity_at(share), self.taker)

    def pushed_at(self, share: float) -> float:
        """Compression of a straight belt in its middle at a share of the step."""
        pushed = self.head_mass + 0.5 * self.belt_mass * self.length_at(share)
        return pushed * self.acceleration_at(share) + self.tension_at(share)

    def second_rates(
        self, length: float, velocity: float, acceleration: float, tension: float
    ) -> tuple[float, float, float, float, float, float]:
        """Accelerations of the modes in their trial place; the compression is then that at the head."""
        b1, b2, b3, b4, b5, b6 = self.bow_moments(length)
        e, h, e_by_length, h_by_length, e_second, h_second = self.end_bow(length)
        return self.bowed_rates(
            length,
            velocity,
            acceleration,
            tension,
            b1,
            b2,
            b3,
            b4,
            b5,
            b6,
            e,
            h,
            e_by_length,
            h_by_length,
            e_second,
            h_second,
        )

    def bowed_rates(
        self,
        length: float,
        velocity: float,
        acceleration: float,
        tension: float,
        b1: float,
        b2: float,
        b3: float,
        b4: float,
        b5: float,
        b6: float,
        e: float,
        h: float,
        e_by_length: float,
        h_by_length: float,
        e_second: float,
        h_second: float,
    ) -> tuple[float, float, float, float, float, float]:
        """As `second_rates`, with `bow_moments` and `end_bow`."""
        a1, a2, a3, a4, a5, a6, load = accelerations(  # type: ignore[call-arg]
            *self.trial,  # type: ignore[arg-type]
            *self.trial_rate,
            length,
            velocity,
            acceleration,
            tension,
            self.head_mass,
            self.belt_mass,
            2.0 * self.belt_mass * self.damping,
            self.stiffness,
            self.guide_offset,
            self.clamped(),
            self.turn(length),
            self.turn_by_length(),
            self.modes,
            b1,
            b2,
            b3,
            b4,
            b5,
            b6,
            e,
            h,
            e_by_length,
            h_by_length,
            e_second,
            h_second,
        )
        self.compression = load
        return a1, a2, a3, a4, a5, a6

    def rates_at(self, share: float) -> tuple[float, float, float, float, float, float]:
        """Accelerations of the modes in their trial place at a share of the step."""
        return self.second_rates(
            self.length_at(share),
            self.velocity_at(share),
            self.acceleration_at(share),
            self.tension_at(share),
        )

    def scaled_end_bow(self, length: float) -> tuple[float, float, float, float, float, float]:
        """As `end_bow`, by the relative length: all amplitudes."""
        e, h, e_by_length, h_by_length, e_second, h_second = self.end_bow(length)
        square = length * length
        return e, h, length * e_by_length, length * h_by_length, square * e_second, square * h_second

    def stage_rates(
        self,
        share: float,
        b1: float,
        b2: float,
        b3: float,
        b4: float,
        b5: float,
        b6: float,
        e: float,
        h: float,
        e_growth: float,
        h_growth: float,
        e_second: float,
        h_second: float,
    ) -> tuple[float, float, float, float, float, float]:
        """As `rates_at`, with `bow_moments` and `scaled_end_bow`, which only the length changes."""
        length = self.length_at(share)
        square = length * length
        return self.bowed_rates(
            length,
            self.velocity_at(share),
            self.acceleration_at(share),
            self.tension_at(share),
            b1,
            b2,
            b3,
            b4,
            b5,
            b6,
            e,
            h,
            e_growth / length,
            h_growth / length,
            e_second / square,
            h_second / square,
        )

    def note_gap(self, share: float) -> None:
        """Let the belt lean on its guide, or let it go, where it is about to; keep its slope there."""
        if not self.has_play():
            return
        length = self.length_at(share)
        velocity = self.velocity_at(share)
        turn, rate = self.free_slope(length, velocity)
        side = self.side(turn)
        gap, growth = self.gap(turn, rate, length, velocity, side)
        near = TOUCHING * self.mode_sum
        if gap < -near or (gap <= near and growth < 0.0):
            contact = side if self.guide_contact == 0 else 0
            self.switch(length, velocity, contact)
            turn, rate = self.free_slope(length, velocity)
        self.last_slope = turn
        self.last_slope_rate = rate

    def switch(self, length: float, velocity: float, contact: int) -> None:
        """Begin or end contact in the guide: the end of the belt, which has no mass, changes its speed.

        So does the head, which lags by the shortening; its momentum goes to the modes.
        """
        _g1, _g2, _g3, _g4, _g5, _g6, before = self.lag(length, velocity)
        self.guide_contact = contact
        self.gauss_step = 0.0
        g1, g2, g3, g4, g5, g6, rate = self.lag(length, velocity)
        heavy = 2.0 * self.head_mass / (self.belt_mass * length)
        square = dot(g1, g2, g3, g4, g5, g6, g1, g2, g3, g4, g5, g6)
        push = heavy * (before - rate) / (1.0 + heavy * square)
        self.trial_rate = summed(push, g1, g2, g3, g4, g5, g6, *self.trial_rate)
        self.mode_rate = same(*self.trial_rate)

    def before_switch(self, share: float, taken: float) -> float:
        """Share of an integration step, now in the trial place, after which contact in the guide changes."""
        if not self.has_play():
            return 1.0
        length = self.length_at(share + taken)
        velocity = self.velocity_at(share + taken)
        turn, rate = self.free_slope(length, velocity)
        side = self.side(turn)
        end, end_rate = self.gap(turn, rate, length, velocity, side)
        if end >= -TOUCHING * self.mode_sum:
            return 1.0
        start, start_rate = self.gap(
            self.last_slope, self.last_slope_rate, self.length_at(share), self.velocity_at(share), side
        )
        start = start if start > 0.0 else 0.0  # it stands at the stop, to rounding
        low = 0.0
        high = 1.0
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            gap, _slope = met(middle, taken * self.path_step, start, start_rate, end, end_rate)
            if gap > 0.0:
                low = middle
            else:
                high = middle
        return high
