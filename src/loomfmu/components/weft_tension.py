"""WeftTension: the weft yarn from its package over brake and guide eyes to the rapier head."""

from dataclasses import dataclass

from ..physics.shaft import carried
from ..physics.weft import capstan_gain, drag_per_length, snatch_tension, unstretched_length
from .weft_way import NEAREST, PEAK, PLACE, POINT, SLACK, TURN, YIELD, WeftWay

SHORTEST = 1e-15  # s: two samples that are closer are one, since the squares of their distance underflow
STILL = 1e-11  # m: a way between two samples that rounding may have made
PARTS = 4  # of the way between two samples: in each the tension turns once at most
MOST_POINTS = 24  # of the brake's program in a part: all of them, and more than steps should be long
MOST_CHANGES = 3  # of the brake in a part, between holding the yarn and letting it through


@dataclass(slots=True)
class WeftTension(WeftWay):
    """Weft tension: yarn drawn by the rapier heads over brake and eyes, with its mass, drag and stretch.

    Between two samples of its inputs head and shaft move on the quintics that join them. On each part of that
    way the limit at which the brake lets yarn through runs on a cubic, for which the yarn's force is exact.
    """

    def initialize(self, time: float) -> int:
        """Thread the yarn: drawn steadily if a head carries it, else waiting for the giver."""
        self.gain = capstan_gain(self.friction, self.wrap_angle)
        self.drag = drag_per_length(self.air_friction, self.yarn_diameter)
        if not self.take_sample(time, 0.0):
            return 1
        self.inward = self.velocity >= 0.0
        self.length_offset = self.supply_length - self.pick_up_travel
        if not self.inward:  # how far the giver brought it is not known: to here
            self.length_offset = self.length_offset + 2.0 * self.travel
        self.unstretched = self.supply_length
        if self.travel > self.pick_up_travel:
            self.unstretched = unstretched_length(
                self.yarn_stiffness, self.length_at(self.travel), self.new_limit
            )
        self.slack_so_far = 0.0
        self.longest_slack = 0.0
        self.highest_snatch = 0.0
        self.pending = 0.0
        self.acceleration_rate = 0.0
        self.followed = True
        self.turning = 0
        self.watch_shaft()
        self.remember(time)
        self.show()
        self.highest_tension = self.tension
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Follow the yarn from the last sample of the inputs to this one and show its state."""
        lead = step_size if self.inputs_at_step_end else 0.0
        if not self.take_sample(time, lead):
            return 1
        duration = step_size if self.inputs_at_step_end else self.pending
        self.watch_shaft()
        self.follow(duration)
        if duration > SHORTEST:
            self.acceleration_rate = (self.acceleration - self.sampled_acceleration) / duration
        self.pending = step_size
        self.remember(time + lead)
        if self.inputs_at_step_end:
            self.show()
            return 0
        return self.show_ahead(time, step_size)

    def take_sample(self, time: float, lead: float) -> bool:
        """The inputs and what they make the brake do; false if the shaft is too far."""
        self.new_travel = self.travel
        self.new_velocity = self.velocity
        self.new_acceleration = self.acceleration
        return self.set_brake(time, lead)

    def watch_shaft(self) -> None:
        """Notice a shaft that turns back while a head carries the weft: what follows is not a pick."""
        way = 1 if self.new_speed > 0.0 else (-1 if self.new_speed < 0.0 else 0)
        held = self.sampled_travel > self.pick_up_travel or self.new_travel > self.pick_up_travel
        if held and way * self.turning < 0:
            self.followed = False
        if way != 0:
            self.turning = way

    def remember(self, time: float) -> None:
        """Make the new sample the last one."""
        self.sampled_time = time
        self.sampled_travel = self.new_travel
        self.sampled_velocity = self.new_velocity
        self.sampled_acceleration = self.new_acceleration
        self.sampled_angle = self.new_angle
        self.sampled_speed = self.new_speed
        self.sampled_change = self.new_change

    def follow(self, duration: float) -> None:
        """Bring the yarn from the last sample to the new one, in parts between points of the program."""
        if duration <= SHORTEST:
            return
        self.prepare(duration)
        low = 0.0
        for part in range(PARTS):
            for count in range(MOST_POINTS + 1):
                high = (part + 1) / PARTS
                if count < MOST_POINTS and self.passes_point(low, high):
                    before = self.place_at(low) > self.next_point
                    high = self.crossing(POINT, before, False, 0.0, 0.0, low, high)
                self.brake_part(low, high)
                self.follow_part(low, high)
                low = high
                if low >= (part + 1) / PARTS:
                    break

    def follow_part(self, low: float, high: float) -> None:
        """Bring the yarn over a part of the way, in which the head may turn once."""
        at_low = self.velocity_at(low)
        at_high = self.velocity_at(high)
        if (at_low < 0.0 and at_high > 0.0) or (at_low > 0.0 and at_high < 0.0):
            turn = self.crossing(TURN, at_low > 0.0, False, 0.0, 0.0, low, high)
            self.follow_one_way(low, turn)
            low = turn
        self.follow_one_way(low, high)

    def follow_one_way(self, low: float, high: float) -> None:
        """Bring the yarn over a part of the way in one direction: waiting, taken up, carried or released."""
        start = self.travel_at(low)
        self.face(self.velocity_at(0.5 * (low + high)), start)
        held = start > self.pick_up_travel
        holds = self.travel_at(high) > self.pick_up_travel
        passed = low
        if held != holds:
            passed = self.crossing(PLACE, held, False, 0.0, 0.0, low, high)
        if holds and not held:
            self.take_up(self.travel_at(passed))
            self.snatch(self.velocity_at(passed) / self.way_time)
        if holds:
            self.draw(passed, high)
        elif held:
            self.draw(low, passed)
        if not holds:
            self.slack_so_far = 0.0

    def face(self, velocity: float, travel: float) -> None:
        """Turn to the head's direction: a giver begins a new pick, a taker goes on with the giver's yarn.

        A way so short that rounding may have made it shows no direction.
        """
        if velocity > STILL and not self.inward:
            self.inward = True
            self.length_offset = self.supply_length - self.pick_up_travel
            self.take_up(travel)
        elif velocity < -STILL and self.inward:
            self.inward = False
            self.length_offset = self.length_offset + 2.0 * travel

    def take_up(self, travel: float) -> None:
        """Hand the head yarn that is straight and unstretched."""
        self.unstretched = self.length_at(travel)
        self.slack_so_far = 0.0

    def snatch(self, speed: float) -> None:
        """Keep the tension of the wave that a head sends along yarn at rest."""
        tension = snatch_tension(self.yarn_stiffness, self.linear_density, speed)
        if tension > self.highest_snatch:
            self.highest_snatch = tension

    def draw(self, low: float, high: float) -> None:
        """Bring the yarn over a part of the way on which a head draws it in one direction.

        The brake holds or lets yarn through; it changes over where the tension of held yarn passes the limit.
        """
        start = low
        force = self.force_at(False, start, 0.0, start)
        passing = self.surplus_at(False, start, force, start) > 0.0
        for change in range(MOST_CHANGES + 1):
            end = high
            if change < MOST_CHANGES:
                end = self.change_over(passing, start, force, high)
            self.watch(passing, start, end)
            force = self.force_at(passing, start, force, end)
            if passing:
                self.unstretched = unstretched_length(
                    self.yarn_stiffness, self.length_at(self.travel_at(end)), force
                )
            if end >= high:
                break
            start = end
            passing = not passing

    def change_over(self, passing: bool, start: float, force: float, high: float) -> float:
        """Where the brake first changes between holding and letting through on a part, or its end."""
        if (self.surplus_at(passing, start, force, high) > 0.0) != passing:
            return self.crossing(YIELD, passing, passing, start, force, start, high)
        at_start = self.surplus_rate_at(passing, start, force, start)
        at_high = self.surplus_rate_at(passing, start, force, high)
        if (at_start < 0.0 and at_high > 0.0) if passing else (at_start > 0.0 and at_high < 0.0):
            nearest = self.crossing(NEAREST, not passing, passing, start, force, start, high)
            if (self.surplus_at(passing, start, force, nearest) > 0.0) != passing:
                return self.crossing(YIELD, passing, passing, start, force, start, nearest)
        return high

    def watch(self, passing: bool, low: float, high: float) -> None:
        """Keep the highest tension and the slack on a part of the way, divided where the tension turns."""
        at_low = self.tension_at(passing, low)
        at_high = self.tension_at(passing, high)
        rate = self.tension_rate_at(passing, low)
        if rate * self.tension_rate_at(passing, high) < 0.0:
            turn = self.crossing(PEAK, rate > 0.0, passing, 0.0, 0.0, low, high)
            between = self.tension_at(passing, turn)
            self.note(passing, low, at_low, turn, between)
            low = turn
            at_low = between
        self.note(passing, low, at_low, high, at_high)

    def note(self, passing: bool, low: float, at_low: float, high: float, at_high: float) -> None:
        """Keep the highest tension and the slack where the tension rises or falls throughout."""
        if at_low > self.highest_tension:
            self.highest_tension = at_low
        if at_high > self.highest_tension:
            self.highest_tension = at_high
        taut = at_low > 0.0
        passed = low if taut else high
        if taut != (at_high > 0.0):
            passed = self.crossing(SLACK, taut, passing, 0.0, 0.0, low, high)
        hanging = 0.0 if taut else self.slack_so_far + self.way_time * (passed - low)
        self.hang(hanging)
        if at_high > 0.0:
            self.slack_so_far = 0.0
        elif taut:
            self.hang(self.way_time * (high - passed))

    def hang(self, duration: float) -> None:
        """Keep the time without tension, and the longest one."""
        self.slack_so_far = duration
        if duration > self.longest_slack:
            self.longest_slack = duration

    def show(self) -> None:
        """Outputs at the new sample."""
        self.carried = self.new_travel > self.pick_up_travel
        self.length = self.supply_length
        self.strain = 0.0
        self.eye_tension = 0.0
        self.inertia_force = 0.0
        self.drag_force = 0.0
        if self.carried:
            speed = self.new_velocity if self.inward else -self.new_velocity
            acceleration = self.new_acceleration if self.inward else -self.new_acceleration
            self.length = self.length_at(self.new_travel)
            self.strain = (self.length - self.unstretched) / self.unstretched
            held = self.yarn_stiffness * (self.strain + self.retardation_time * speed / self.unstretched)
            self.eye_tension = held if held < self.new_limit else self.new_limit
            self.inertia_force = self.linear_density * self.length * acceleration
            self.drag_force = self.drag * self.length * speed * speed
        tension = self.eye_tension + self.inertia_force + self.drag_force
        self.slack = self.carried and tension <= 0.0
        self.tension = tension if tension > 0.0 else 0.0

    def show_ahead(self, time: float, lead: float) -> int:
        """Outputs at the end of the step, the inputs carried over it; what the yarn keeps stays as it is."""
        inward = self.inward
        offset = self.length_offset
        unstretched = self.unstretched
        highest = self.highest_tension
        snatch = self.highest_snatch
        longest = self.longest_slack
        hanging = self.slack_so_far
        rise = self.acceleration_rate * lead
        self.new_travel = carried(self.travel, self.velocity, self.acceleration + rise / 3.0, lead)
        self.new_velocity = self.velocity + (self.acceleration + 0.5 * rise) * lead
        self.new_acceleration = self.acceleration + rise
        if not self.set_brake(time, lead):
            return 1
        self.follow(lead)
        self.show()
        self.inward = inward
        self.length_offset = offset
        self.unstretched = unstretched
        self.highest_tension = highest
        self.highest_snatch = snatch
        self.longest_slack = longest
        self.slack_so_far = hanging
        return 0
