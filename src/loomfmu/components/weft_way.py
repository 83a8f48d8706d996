"""The weft yarn between two samples of its inputs: its motion and its tension."""

from dataclasses import dataclass
from math import fabs

from ..physics.weft import along, moving_load, moving_load_rate, quintic, relaxed_force, stretch_force
from .weft_brake import WeftBrake

SHORTEST_YARN = 1e-3  # m: coarse steps of inputs that do not belong together may leave less
HALVINGS = 52  # of a part of the way: then a share is known to rounding
# what `crossing` looks for: where the head turns round, where it takes or releases the weft, where the brake
# begins or ceases to let yarn through, where it is nearest to that, where the tension is zero, where it is
# highest or lowest, where the shaft passes a point of the brake's program
TURN = 0
PLACE = 1
YIELD = 2
NEAREST = 3
SLACK = 4
PEAK = 5
POINT = 6


@dataclass(slots=True)
class WeftWay(WeftBrake):
    """The yarn on the way from the last sample of the inputs to the new one, by the share u of it.

    `passing` says that the brake lets yarn through, with the elastic force `force` at the share `start`.
    """

    def length_at(self, travel: float) -> float:
        """Length of yarn with the head at a travel: the taker draws on while its travel shrinks."""
        length = self.length_offset + travel if self.inward else self.length_offset - travel
        return length if length > SHORTEST_YARN else SHORTEST_YARN

    def travel_at(self, share: float) -> float:
        """Travel at a share of the way."""
        value, _first, _second, _third = along(share, *self.way)
        return value

    def velocity_at(self, share: float) -> float:
        """Velocity of the head at a share of the way, times the duration of the way."""
        _value, first, _second, _third = along(share, *self.way)
        return first

    def motion_at(self, share: float) -> tuple[float, float, float, float]:
        """Length of yarn at a share of the way, with the speed, acceleration and jerk of the yarn."""
        value, first, second, third = along(share, *self.way)
        h = self.way_time if self.inward else -self.way_time
        return self.length_at(value), first / h, second / (h * fabs(h)), third / (h * h * h)

    def force_at(self, passing: bool, low: float, force: float, share: float) -> float:
        """Elastic force at a share of the way, from that at `low`."""
        if passing:
            limit = list(self.part_limit)
            return relaxed_force(
                force,
                self.way_time / self.retardation_time,
                low - self.part_start,
                share - self.part_start,
                limit,
            )
        return stretch_force(self.yarn_stiffness, self.length_at(self.travel_at(share)), self.unstretched)

    def surplus_at(self, passing: bool, low: float, force: float, share: float) -> float:
        """By how much the tension of yarn that is held exceeds the limit: positive while the brake yields."""
        here = self.force_at(passing, low, force, share)
        length, speed, _acceleration, _jerk = self.motion_at(share)
        viscous = self.retardation_time * (self.yarn_stiffness + here) * speed / length
        return here + viscous - self.limit_at(share)

    def surplus_rate_at(self, passing: bool, low: float, force: float, share: float) -> float:
        """Derivative of `surplus_at` by the share."""
        here = self.force_at(passing, low, force, share)
        length, speed, acceleration, _jerk = self.motion_at(share)
        tau = self.retardation_time
        stretched = (self.yarn_stiffness + here) * speed / length
        change = (self.limit_at(share) - here) / tau if passing else stretched
        viscous = (change * speed + (self.yarn_stiffness + here) * acceleration - stretched * speed) / length
        return self.way_time * (change + tau * viscous) - self.limit_rate_at(share)

    def tension_at(self, passing: bool, share: float) -> float:
        """Tension at the head at a share of the way, negative where the yarn runs ahead of it."""
        length, speed, acceleration, _jerk = self.motion_at(share)
        load = moving_load(length, speed, acceleration, self.linear_density, self.drag)
        if passing:
            return self.limit_at(share) + load
        viscous = self.retardation_time * self.yarn_stiffness * speed / self.unstretched
        return stretch_force(self.yarn_stiffness, length, self.unstretched) + viscous + load

    def tension_rate_at(self, passing: bool, share: float) -> float:
        """Derivative of `tension_at` by the share."""
        length, speed, acceleration, jerk = self.motion_at(share)
        h = self.way_time
        load = h * moving_load_rate(length, speed, acceleration, jerk, self.linear_density, self.drag)
        if passing:
            return self.limit_rate_at(share) + load
        stretch = h * (speed + self.retardation_time * acceleration) / self.unstretched
        return self.yarn_stiffness * stretch + load

    def prepare(self, duration: float) -> None:
        """Join the last sample and the new one."""
        square = duration * duration
        first, second = duration * self.sampled_velocity, square * self.sampled_acceleration
        end_first, end_second = duration * self.new_velocity, square * self.new_acceleration
        self.way_time = duration
        self.way = quintic(
            self.sampled_travel,
            first,
            second,
            self.new_travel,
            end_first,
            end_second,
            self.sampled_time / duration,
        )
        self.prepare_brake(duration)

    def gauge_at(self, kind: int, passing: bool, start: float, force: float, share: float) -> float:
        """What passes zero where `crossing` looks."""
        if kind == TURN:
            return self.velocity_at(share)
        if kind == PLACE:
            return self.travel_at(share) - self.pick_up_travel
        if kind == YIELD:
            return self.surplus_at(passing, start, force, share)
        if kind == NEAREST:
            return self.surplus_rate_at(passing, start, force, share)
        if kind == POINT:
            return self.place_at(share) - self.next_point
        if kind == SLACK:
            return self.tension_at(passing, share)
        return self.tension_rate_at(passing, share)

    def crossing(
        self, kind: int, positive: bool, passing: bool, start: float, force: float, low: float, high: float
    ) -> float:
        """Share of the way between two others at which something passes zero that is `positive` before."""
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            if (self.gauge_at(kind, passing, start, force, middle) > 0.0) == positive:
                low = middle
            else:
                high = middle
        return high
