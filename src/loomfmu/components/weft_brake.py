"""The brake of the weft between two samples: the limit at which it lets yarn through, by its program."""

from dataclasses import dataclass
from math import fabs, floor, pi

from ..physics.hung_warp import cubic_between
from ..physics.shaft import FARTHEST, too_far
from ..physics.weft import along, drawing_limit, eased, quintic
from .weft_variables import PROGRAM_POINTS, WeftVariables

AT_POINT = 1e-9  # of the way between two points of the program: nearer to one the shaft is there


@dataclass(slots=True)
class WeftBrake(WeftVariables):
    """The brake's limit on the way from the last sample of the inputs to the new one, by the share u of it.

    Head and shaft run on the quintics that join the samples. The way is divided where the shaft passes a
    point of the program, since its second derivative jumps there; on each part the limit runs on a cubic that
    has its value and rate at both ends.
    """

    def set_brake(self, time: float, lead: float) -> bool:
        """Force and limit of the brake at the new sample; false if the shaft is too far."""
        self.new_angle, self.new_speed, self.new_change = self.shaft(time, lead)
        if too_far(self.new_angle):
            return False
        point = floor(self.new_angle * PROGRAM_POINTS / (2.0 * pi))
        self.brake, _rate = self.braking(point, self.new_angle, self.new_speed)
        self.new_limit, _rate = self.limit_for(
            point, self.new_angle, self.new_speed, self.new_velocity, self.new_acceleration
        )
        return True

    def braking(self, point: int, angle: float, speed: float) -> tuple[float, float]:
        """Force of the brake and its rate, between a point of the program and the next one."""
        share, slope = eased(
            self.brake_program[point % PROGRAM_POINTS],
            self.brake_program[(point + 1) % PROGRAM_POINTS],
            angle * PROGRAM_POINTS / (2.0 * pi) - point,
        )
        return self.brake_force * share, self.brake_force * slope * speed * PROGRAM_POINTS / (2.0 * pi)

    def limit_for(
        self, point: int, angle: float, speed: float, velocity: float, acceleration: float
    ) -> tuple[float, float]:
        """Limit of the tension behind the eyes and its rate, for a motion of shaft and head."""
        force, rate = self.braking(point, angle, speed)
        return drawing_limit(
            self.gain,
            self.supply_tension,
            self.unwinding_factor * self.linear_density,
            force,
            rate,
            velocity,
            acceleration,
        )

    def prepare_brake(self, duration: float) -> None:
        """Join the last sample of the shaft and the new one."""
        square = duration * duration
        self.turn = quintic(
            self.sampled_angle,
            duration * self.sampled_speed,
            square * self.sampled_change,
            self.new_angle,
            duration * self.new_speed,
            square * self.new_change,
            self.sampled_time / duration,
        )

    def place_at(self, share: float) -> float:
        """Place of the shaft in the program at a share of the way, in points from 0 deg."""
        angle, _first, _second, _third = along(share, *self.turn)
        if not fabs(angle) <= FARTHEST:  # inputs that do not belong together
            angle = self.new_angle
        return angle * PROGRAM_POINTS / (2.0 * pi)

    def passes_point(self, low: float, high: float) -> bool:
        """Whether the shaft passes points of the program between two shares; `next_point` is the first."""
        start = self.place_at(low)
        end = self.place_at(high)
        way = 1 if end > start else -1
        self.next_point = float(way * (floor(way * start + AT_POINT) + 1))
        return way * (end - self.next_point) > AT_POINT

    def brake_part(self, low: float, high: float) -> None:
        """Join the limits at two shares of the way by a cubic; no point of the program is between them."""
        point = floor(self.place_at(0.5 * (low + high)))
        start, start_rate = self.limit_beside(point, low)
        end, end_rate = self.limit_beside(point, high)
        self.part_start = low
        self.part_limit = cubic_between(
            start, self.way_time * start_rate, end, self.way_time * end_rate, high - low
        )

    def limit_beside(self, point: int, share: float) -> tuple[float, float]:
        """Limit and its rate at a share of the way, between a point of the program and the next one."""
        angle, turned, _second, _third = along(share, *self.turn)
        _travel, first, second, _third = along(share, *self.way)
        h = self.way_time
        return self.limit_for(point, angle, turned / h, first / h, second / (h * h))

    def limit_at(self, share: float) -> float:
        """Limit of the tension behind the eyes at a share of the way."""
        u = share - self.part_start
        return self.part_limit[0] + u * (
            self.part_limit[1] + u * (self.part_limit[2] + u * self.part_limit[3])
        )

    def limit_rate_at(self, share: float) -> float:
        """Derivative of `limit_at` by the share."""
        u = share - self.part_start
        return self.part_limit[1] + u * (2.0 * self.part_limit[2] + 3.0 * u * self.part_limit[3])
