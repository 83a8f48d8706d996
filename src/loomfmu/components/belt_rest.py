"""How BeltDynamics starts: the shape of its belt at rest, and whether it is at rest."""

from dataclasses import dataclass
from math import cos, fabs, pi, sin

from ..physics.belt_ends import at_ends, reactions
from ..physics.belt_modes import bow_at, dot, first_modes, summed
from .belt_integration import BeltIntegration

REPEATS = 200  # until the belt is in equilibrium
RESTED = 1e-9  # of the modes: what the last repeat may change
AT_REST = 1e-11  # of the accelerations by bending: what rounding leaves of them in equilibrium


@dataclass(slots=True)
class BeltRest(BeltIntegration):
    """The belt at rest, or as it only follows the growth of its length."""

    def rest(self, length: float, speed: float, acceleration: float, tension: float) -> None:
        """Look for the shape that only follows the growth of the free length."""
        self.forget()
        self.at_rest = False
        pushed = (self.head_mass + 0.5 * self.belt_mass * length) * acceleration + tension
        thrown = self.belt_mass * speed * speed
        if pushed + thrown > 0.8 * pi * pi * self.stiffness / (length * length):
            return
        for _ in range(REPEATS):
            if self.at_rest:
                return
            self.try_modes()
            self.lean(length)
            self.mode_rate = (
                speed * self.lengthened(0, length) * self.mode[0],
                speed * self.lengthened(1, length) * self.mode[1],
                speed * self.lengthened(2, length) * self.mode[2],
                speed * self.lengthened(3, length) * self.mode[3],
                speed * self.lengthened(4, length) * self.mode[4],
                speed * self.lengthened(5, length) * self.mode[5],
            )
            self.try_modes()
            self.found_a = self.second_rates(length, speed, acceleration, tension)
            self.sums()
            before = self.mode_sum
            self.found_a = (
                self.unbalanced(0, length, speed, acceleration),
                self.unbalanced(1, length, speed, acceleration),
                self.unbalanced(2, length, speed, acceleration),
                self.unbalanced(3, length, speed, acceleration),
                self.unbalanced(4, length, speed, acceleration),
                self.unbalanced(5, length, speed, acceleration),
            )
            self.let_go(length)
            if self.clamped() != 0:
                self.hold_still(length, pushed)
            self.mode = (
                self.mode[0] + self.yielded(0, length, pushed),
                self.mode[1] + self.yielded(1, length, pushed),
                self.mode[2] + self.yielded(2, length, pushed),
                self.mode[3] + self.yielded(3, length, pushed),
                self.mode[4] + self.yielded(4, length, pushed),
                self.mode[5] + self.yielded(5, length, pushed),
            )
            self.sums()
            if not self.mode_sum < length:
                self.forget()
                return
            self.at_rest = fabs(self.mode_sum - before) <= RESTED * before

    def unbalanced(self, place: int, length: float, speed: float, acceleration: float) -> float:
        """Acceleration of a mode, now `found_a`, beyond that of the growing length."""
        by_length = self.lengthened(place, length)
        wanted = speed * speed * (by_length - 1.0 / length) + acceleration
        return self.found_a[place] - wanted * by_length * self.mode[place]

    def yielded(self, place: int, length: float, pushed: float) -> float:
        """Change of a mode by which its acceleration `found_a` would vanish."""
        wave = (place + 1) * pi / length
        stiff = wave * wave * (self.stiffness * wave * wave - pushed)
        return self.belt_mass * self.found_a[place] / stiff

    def let_go(self, length: float) -> None:
        """Add to the accelerations `found_a` what the mass of the head, by its lag, takes from them."""
        g1, g2, g3, g4, g5, g6, _rate = self.lag(length, 0.0)
        lag = 2.0 * self.head_mass / (self.belt_mass * length) * dot(g1, g2, g3, g4, g5, g6, *self.found_a)
        self.found_a = summed(lag, g1, g2, g3, g4, g5, g6, *self.found_a)

    def hold_still(self, length: float, pushed: float) -> None:
        """Take from the accelerations `found_a` the share of the moments at the clamped ends."""
        odd, odd_yield, even, even_yield = 0.0, 0.0, 0.0, 0.0
        for place in range(self.modes):
            wave = (place + 1) * pi
            slope = wave * self.yielded(place, length, pushed)
            share = wave / length
            stiff = share * share * (self.stiffness * share * share - pushed)
            if place % 2 == 0:
                odd, odd_yield = odd + slope, odd_yield + self.belt_mass * wave * wave / stiff
            else:
                even, even_yield = even + slope, even_yield + self.belt_mass * wave * wave / stiff
        weight = 12.0 * self.stiffness / (self.belt_mass * length * length * length * length)
        odd, even = reactions(self.clamped(), weight, odd_yield, even_yield, odd, even)
        a1, a2, a3, a4, a5, a6 = at_ends(-odd, -even)
        a1, a2, a3, a4, a5, a6 = summed(1.0, a1, a2, a3, a4, a5, a6, *self.found_a)
        self.found_a = first_modes(self.modes, a1, a2, a3, a4, a5, a6)

    def lengthened(self, place: int, length: float) -> float:
        """Change of a mode at rest by the free length, over the mode; not counted if an end is clamped."""
        if self.clamped() != 0:
            return 0.0
        turned = pi * length / self.bow_length
        moment, slope = bow_at(
            place + 1, self.bow_of, self.bow, self.bow_length, length, cos(turned), sin(turned)
        )
        if moment == 0.0:
            return 0.0
        return slope / moment + 3.0 / length

    def rests(self, share: float) -> bool:
        """Whether the belt is in equilibrium on a path that stands still."""
        moves = fabs(self.path[1]) + fabs(self.path[2]) + fabs(self.path[3]) + fabs(self.path[4])
        moves = moves + fabs(self.path[5]) + fabs(self.yarn_tension - self.start_tension)
        self.sums()
        if moves != 0.0 or self.rate_sum != 0.0:
            return False
        self.try_modes()
        self.found_a = self.rates_at(share)
        length = self.length_at(share)
        wave = pi / length
        bending = self.stiffness / self.belt_mass * wave * wave * wave * wave
        found = fabs(self.found_a[0]) + fabs(self.found_a[1]) + fabs(self.found_a[2])
        found = found + fabs(self.found_a[3]) + fabs(self.found_a[4]) + fabs(self.found_a[5])
        return found <= AT_REST * bending * self.mode_sum

    def forget(self) -> None:
        """Straighten the belt."""
        self.mode = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.settle()
        self.deflection = 0.0
        self.deflection_rate = 0.0
        self.deflection_place = 0.0
        self.bending_strain = 0.0
        self.shortening = 0.0
        self.growth_rate = 0.0
        self.guide_contact = 0
        self.guide_moment = 0.0
        self.energy = 0.0
        self.steepness = 0.0
        self.last_deflection = 0.0
        self.last_rate = 0.0
        self.push_before = 0.0
        self.sums()

    def settle(self) -> None:
        """Stop the motion of the modes, and forget what the last integration step tried."""
        self.mode_rate = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.trial = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.trial_rate = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.gauss_step = 0.0
        self.halvings = 0
        self.load_a = 0.0
        self.load_b = 0.0
        self.load_c = 0.0
        self.gauss_a = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.gauss_b = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.gauss_c = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.found_a = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.found_b = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.found_c = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

    def remember(self) -> None:
        """Keep the present inputs as the last sample."""
        self.sampled_travel = self.travel
        self.sampled_velocity = self.velocity
        self.sampled_acceleration = self.acceleration
        self.sampled_tension = self.yarn_tension
