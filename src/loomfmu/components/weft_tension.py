"""WeftTension: the weft yarn from its package over brake and guide eyes to the rapier head."""

from dataclasses import dataclass
from math import floor, inf, pi
from typing import ClassVar

from ..declaring.arrays import array
from ..declaring.declarations import auxiliary, output, parameter, state
from ..declaring.variables import Problem, Terminal
from ..physics.belt import on_way_in
from ..physics.shaft import carried, too_far
from ..physics.weft import capstan_gain, drag_per_length, quintic, snatch_tension, unstretched_length
from ..physics.weft_way import (
    PEAK,
    PLACE,
    POINT,
    PROGRAM_POINTS,
    SLACK,
    TURN,
    Brake,
    Drawn,
    Part,
    Way,
    Yarn,
    braking,
    change_over,
    crossing,
    force_at,
    length_at,
    limit_for,
    next_point,
    part_of,
    passage,
    place_at,
    surplus_at,
    tension_at,
    tension_rate_at,
    travel_at,
    velocity_at,
)
from .quantities import ANGLE, DISTANCE, DURATION, FORCE, LENGTH, RATIO, TENSION, YARN_FORCE
from .shaft_driven import TOO_FAR, ShaftDriven
from .shared_declarations import head_acceleration, head_travel, head_velocity
from .terminals import HEAD

FOLLOWED = "followed"  # what says when other outputs are known

SHORTEST = 1e-15  # s: two samples that are closer are one, since the squares of their distance underflow
STILL = 1e-11  # m: a way between two samples that rounding may have made
PARTS = 4  # of the way between two samples: in each the tension turns once at most
MOST_POINTS = 24  # of the brake's program in a part: all of them, and more than steps should be long
MOST_CHANGES = 3  # of the brake in a part, between holding the yarn and letting it through


@dataclass(frozen=True)
class Sample:
    """A sample of the inputs: head [m, m/s, m/s2], shaft [rad, rad/s, rad/s2], limit of eye_tension [N]."""

    travel: float
    velocity: float
    acceleration: float
    angle: float
    speed: float
    change: float
    limit: float


@dataclass(slots=True)
class WeftTension(ShaftDriven):
    """Weft tension: yarn drawn by the rapier heads over brake and eyes, with its mass, drag and stretch.

    Between two samples of its inputs head and shaft move on the quintics that join them. On each part of that
    way the limit at which the brake lets yarn through runs on a cubic, for which the yarn's force is exact.
    """

    problems: ClassVar[tuple[Problem, ...]] = (TOO_FAR,)
    terminals: ClassVar[tuple[Terminal, ...]] = (
        *ShaftDriven.terminals,
        HEAD.of("travel", "velocity", "acceleration"),
    )
    accuracy: ClassVar[str] = (
        "exact at samples while the brake yields, fourth order in the step while it holds"
    )
    longest_turn: ClassVar[float] = inf

    linear_density: float = parameter(
        "kg/m",
        30e-6,
        "Linear density of the yarn (assumed)",
        display="tex",
        minimum=0.0,
        maximum=1.0,
        nominal=1e-5,
    )
    yarn_stiffness: float = parameter(
        FORCE.within(1e-6, 1e6, nominal=100.0),
        75.0,
        "Tensile stiffness EA of the yarn, force per strain (assumed)",
    )
    retardation_time: float = parameter(
        DURATION.within(1e-9, 1.0, nominal=1e-4),
        1e-4,
        "Retardation time of the yarn, viscosity over stiffness (assumed)",
    )
    yarn_diameter: float = parameter(
        LENGTH.within(0.0, 0.01, nominal=1e-4), 0.2e-3, "Diameter of the yarn, for its air drag (assumed)"
    )
    air_friction: float = parameter(
        RATIO.within(0.0, 10.0, nominal=0.1),
        0.04,
        "Coefficient of friction in air along the yarn, for its circumference (assumed)",
    )
    supply_tension: float = parameter(YARN_FORCE, 0.05, "Tension at the package without speed (assumed)")
    unwinding_factor: float = parameter(
        RATIO.within(0.0, 100.0),
        1.0,
        "Unwinding tension over that of the yarn's momentum; above 1 with a balloon (assumed)",
    )
    brake_force: float = parameter(
        YARN_FORCE, 0.2, "Force of the yarn brake, where brake_program is 1 (assumed)"
    )
    brake_program: tuple[float, ...] = array(
        parameter(
            RATIO.within(0.0, 1e3),
            1.0,
            f"Share of brake_force at a shaft angle of {point * 360 // PROGRAM_POINTS} deg",
        )
        for point in range(PROGRAM_POINTS)
    )
    friction: float = parameter(
        RATIO.within(0.0, 2.0), 0.2, "Coefficient of friction between yarn and guide eyes (assumed)"
    )
    wrap_angle: float = parameter(
        ANGLE.within(0.0, 20.0), 0.5 * pi, "Sum of the wrap angles of all guide eyes (assumed)"
    )
    supply_length: float = parameter(
        LENGTH.within(1e-2, 100.0), 0.6, "Length of yarn from the brake to where the head takes it (assumed)"
    )
    pick_up_travel: float = parameter(
        DISTANCE, 0.1, "Travel at which the giver takes the weft, and the taker releases it (assumed)"
    )
    travel: float = head_travel()
    velocity: float = head_velocity()
    acceleration: float = head_acceleration()
    tension: float = output(
        TENSION, "Tension of the weft at the head that carries it", nominal=0.5, valid_if=FOLLOWED
    )
    highest_tension: float = output(
        TENSION,
        "Highest tension so far, on the continuous curve, without the snatch",
        nominal=0.5,
        highest_of="tension",
        valid_if=FOLLOWED,
    )
    highest_snatch: float = output(
        TENSION,
        "Tension of the hardest snatch so far, as the giver takes the yarn up",
        nominal=0.5,
        valid_if=FOLLOWED,
        so_far=True,
    )
    longest_slack: float = output(
        DURATION,
        "Longest time so far that the weft was carried without tension",
        nominal=1e-3,
        valid_if=FOLLOWED,
        so_far=True,
    )
    slack: bool = output("1", "The weft is carried without tension", start=False, valid_if=FOLLOWED)
    carried: bool = output("1", "A head carries the weft", start=False)
    followed: bool = output(
        "1", "The shaft never turned back while a head carried the weft", start=True, so_far=True
    )
    length: float = output(
        "m", "Length of yarn from the brake to the head that carries it", valid_if=FOLLOWED
    )
    brake: float = output(TENSION, "Force of the yarn brake at this shaft angle", nominal=0.1)
    eye_tension: float = output(
        TENSION, "Tension of the weft behind the last guide eye", nominal=0.5, valid_if=FOLLOWED
    )
    inertia_force: float = output(
        TENSION,
        "Part of tension that accelerates the yarn between brake and head",
        nominal=0.1,
        valid_if=FOLLOWED,
    )
    drag_force: float = output(
        TENSION, "Part of tension that the air drag takes", nominal=0.1, valid_if=FOLLOWED
    )
    strain: float = output("1", "Strain of the yarn between brake and head", nominal=1e-2, valid_if=FOLLOWED)

    gain: float = auxiliary("1", "Ratio of the tensions after and before all guide eyes")
    drag: float = auxiliary("kg/m2", "Air drag per length and square of the speed")
    pending: float = state("s", "Time from the last sample of the inputs to the next", minimum=0.0)
    inward: bool = state("1", "The head is on its way in, as a giver", start=True)
    length_offset: float = state("m", "Length less the travel on the way in, plus it on the way out")
    unstretched: float = state("m", "Unstretched length from brake to head", start=0.6, minimum=1e-60)
    slack_so_far: float = state("s", "Time without tension up to now", minimum=0.0)
    sampled_time: float = state("s", "Time of the last sample")
    sampled_travel: float = state("m", "Travel at the last sample")
    sampled_velocity: float = state("m/s", "Velocity at the last sample")
    sampled_acceleration: float = state("m/s2", "Acceleration at the last sample")
    sampled_angle: float = state("rad", "Shaft angle at the last sample")
    sampled_speed: float = state("rad/s", "Shaft velocity at the last sample")
    sampled_change: float = state("rad/s2", "Shaft acceleration at the last sample")
    turning: int = state(
        "1", "Direction of the shaft, 1 or -1; 0 before it first turns", start=0, minimum=-1, maximum=1
    )
    acceleration_rate: float = state("m/s3", "Rate of the acceleration between the last two samples")

    def initialize(self, time: float) -> int:
        """Thread the yarn: drawn steadily if a head carries it, else waiting for the giver."""
        self.gain = capstan_gain(self.friction, self.wrap_angle)
        self.drag = drag_per_length(self.air_friction, self.yarn_diameter)
        brake = self.braked()
        now = self.sample(brake, time, 0.0, self.travel, self.velocity, self.acceleration)
        if too_far(now.angle):
            return 1
        self.inward = on_way_in(self.velocity)
        self.length_offset = self.supply_length - self.pick_up_travel
        if not self.inward:  # how far the giver brought it is not known: to here
            self.length_offset = self.length_offset + 2.0 * self.travel
        self.unstretched = self.supply_length
        if self.travel > self.pick_up_travel:
            yarn = self.yarn()
            self.unstretched = unstretched_length(
                self.yarn_stiffness, length_at(yarn, self.travel), now.limit
            )
        self.slack_so_far = 0.0
        self.longest_slack = 0.0
        self.highest_snatch = 0.0
        self.pending = 0.0
        self.acceleration_rate = 0.0
        self.followed = True
        self.turning = 0
        self.watch_shaft(now)
        self.remember(time, now)
        self.show(now)
        self.highest_tension = self.tension
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Follow the yarn from the last sample of the inputs to this one and show its state."""
        lead = step_size if self.inputs_at_step_end else 0.0
        brake = self.braked()
        now = self.sample(brake, time, lead, self.travel, self.velocity, self.acceleration)
        if too_far(now.angle):
            return 1
        duration = step_size if self.inputs_at_step_end else self.pending
        self.watch_shaft(now)
        self.follow(brake, now, duration)
        if duration > SHORTEST:
            self.acceleration_rate = (self.acceleration - self.sampled_acceleration) / duration
        self.pending = step_size
        self.remember(time + lead, now)
        if self.inputs_at_step_end:
            self.show(now)
            return 0
        return self.show_ahead(brake, time, step_size)

    def braked(self) -> Brake:
        """Brake and eyes, as their functions take them."""
        return Brake(
            self.gain,
            self.supply_tension,
            self.unwinding_factor * self.linear_density,
            self.linear_density,
            self.brake_force,
            list(self.brake_program),
        )

    def yarn(self) -> Yarn:
        """The yarn as it is now."""
        return Yarn(
            self.yarn_stiffness,
            self.linear_density,
            self.drag,
            self.retardation_time,
            self.inward,
            self.length_offset,
            self.unstretched,
        )

    def sample(
        self, brake: Brake, time: float, lead: float, travel: float, velocity: float, acceleration: float
    ) -> Sample:
        """A sample of the head's motion, with the shaft's, and what they make the brake do."""
        angle, speed, change = self.shaft(time, lead)
        limit = 0.0
        if not too_far(angle):
            point = floor(angle * PROGRAM_POINTS / (2.0 * pi))
            self.brake, _rate = braking(brake, point, angle, speed)
            limit, _rate = limit_for(brake, point, angle, speed, velocity, acceleration)
        return Sample(travel, velocity, acceleration, angle, speed, change, limit)

    def watch_shaft(self, now: Sample) -> None:
        """Notice a shaft that turns back while a head carries the weft: what follows is not a pick."""
        way = 1 if now.speed > 0.0 else (-1 if now.speed < 0.0 else 0)
        held = self.sampled_travel > self.pick_up_travel or now.travel > self.pick_up_travel
        if held and way * self.turning < 0:
            self.followed = False
        if way != 0:
            self.turning = way

    def remember(self, time: float, now: Sample) -> None:
        """Make the new sample the last one."""
        self.sampled_time = time
        self.sampled_travel = now.travel
        self.sampled_velocity = now.velocity
        self.sampled_acceleration = now.acceleration
        self.sampled_angle = now.angle
        self.sampled_speed = now.speed
        self.sampled_change = now.change

    def way_to(self, now: Sample, duration: float) -> Way:
        """Join the last sample and the new one."""
        square = duration * duration
        place = self.sampled_time / duration
        travel = quintic(
            self.sampled_travel,
            duration * self.sampled_velocity,
            square * self.sampled_acceleration,
            now.travel,
            duration * now.velocity,
            square * now.acceleration,
            place,
        )
        angle = quintic(
            self.sampled_angle,
            duration * self.sampled_speed,
            square * self.sampled_change,
            now.angle,
            duration * now.speed,
            square * now.change,
            place,
        )
        return Way(list(travel), list(angle), duration, now.angle)

    def follow(self, brake: Brake, now: Sample, duration: float) -> None:
        """Bring the yarn from the last sample to the new one, in parts between points of the program."""
        if duration <= SHORTEST:
            return
        way = self.way_to(now, duration)
        low = 0.0
        for quarter in range(PARTS):
            for count in range(MOST_POINTS + 1):
                high = (quarter + 1) / PARTS
                passes, point = next_point(way, low, high)
                if passes and count < MOST_POINTS:
                    high = passage(way, POINT, point, place_at(way, low) > point, low, high)
                part = part_of(brake, way, low, high)
                self.follow_part(way, part, low, high)
                low = high
                if low >= (quarter + 1) / PARTS:
                    break

    def follow_part(self, way: Way, part: Part, low: float, high: float) -> None:
        """Bring the yarn over a part of the way, in which the head may turn once."""
        at_low = velocity_at(way, low)
        at_high = velocity_at(way, high)
        if (at_low < 0.0 and at_high > 0.0) or (at_low > 0.0 and at_high < 0.0):
            turn = passage(way, TURN, 0.0, at_low > 0.0, low, high)
            self.follow_one_way(way, part, low, turn)
            low = turn
        self.follow_one_way(way, part, low, high)

    def follow_one_way(self, way: Way, part: Part, low: float, high: float) -> None:
        """Bring the yarn over a part of the way in one direction: waiting, taken up, carried or released."""
        start = travel_at(way, low)
        self.face(velocity_at(way, 0.5 * (low + high)), start)
        held = start > self.pick_up_travel
        holds = travel_at(way, high) > self.pick_up_travel
        passed = low
        if held != holds:
            passed = passage(way, PLACE, self.pick_up_travel, held, low, high)
        if holds and not held:
            self.take_up(travel_at(way, passed))
            self.snatch(velocity_at(way, passed) / way.time)
        if holds:
            self.draw(way, part, passed, high)
        elif held:
            self.draw(way, part, low, passed)
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
        yarn = self.yarn()
        self.unstretched = length_at(yarn, travel)
        self.slack_so_far = 0.0

    def snatch(self, speed: float) -> None:
        """Keep the tension of the wave that a head sends along yarn at rest."""
        tension = snatch_tension(self.yarn_stiffness, self.linear_density, speed)
        if tension > self.highest_snatch:
            self.highest_snatch = tension

    def draw(self, way: Way, part: Part, low: float, high: float) -> None:
        """Bring the yarn over a part of the way on which a head draws it in one direction.

        The brake holds or lets yarn through; it changes over where the tension of held yarn passes the limit.
        """
        start = low
        yarn = self.yarn()
        held = Drawn(yarn, way, part, False, start, 0.0)
        force = force_at(held, start)
        passing = surplus_at(held, start) > 0.0
        for change in range(MOST_CHANGES + 1):
            yarn = self.yarn()
            drawn = Drawn(yarn, way, part, passing, start, force)
            end = high
            if change < MOST_CHANGES:
                end = change_over(drawn, high)
            self.watch(drawn, start, end)
            force = force_at(drawn, end)
            if passing:
                length = length_at(yarn, travel_at(way, end))
                self.unstretched = unstretched_length(self.yarn_stiffness, length, force)
            if end >= high:
                break
            start = end
            passing = not passing

    def watch(self, drawn: Drawn, low: float, high: float) -> None:
        """Keep the highest tension and the slack on a part of the way, divided where the tension turns."""
        at_low = tension_at(drawn, low)
        at_high = tension_at(drawn, high)
        rate = tension_rate_at(drawn, low)
        if rate * tension_rate_at(drawn, high) < 0.0:
            turn = crossing(drawn, PEAK, rate > 0.0, low, high)
            between = tension_at(drawn, turn)
            self.note(drawn, low, at_low, turn, between)
            low = turn
            at_low = between
        self.note(drawn, low, at_low, high, at_high)

    def note(self, drawn: Drawn, low: float, at_low: float, high: float, at_high: float) -> None:
        """Keep the highest tension and the slack where the tension rises or falls throughout."""
        if at_low > self.highest_tension:
            self.highest_tension = at_low
        if at_high > self.highest_tension:
            self.highest_tension = at_high
        taut = at_low > 0.0
        passed = low if taut else high
        if taut != (at_high > 0.0):
            passed = crossing(drawn, SLACK, taut, low, high)
        hanging = 0.0 if taut else self.slack_so_far + drawn.way.time * (passed - low)
        self.hang(hanging)
        if at_high > 0.0:
            self.slack_so_far = 0.0
        elif taut:
            self.hang(drawn.way.time * (high - passed))

    def hang(self, duration: float) -> None:
        """Keep the time without tension, and the longest one."""
        self.slack_so_far = duration
        if duration > self.longest_slack:
            self.longest_slack = duration

    def show(self, now: Sample) -> None:
        """Outputs at the new sample."""
        self.carried = now.travel > self.pick_up_travel
        self.length = self.supply_length
        self.strain = 0.0
        self.eye_tension = 0.0
        self.inertia_force = 0.0
        self.drag_force = 0.0
        if self.carried:
            speed = now.velocity if self.inward else -now.velocity
            acceleration = now.acceleration if self.inward else -now.acceleration
            yarn = self.yarn()
            self.length = length_at(yarn, now.travel)
            self.strain = (self.length - self.unstretched) / self.unstretched
            held = self.yarn_stiffness * (self.strain + self.retardation_time * speed / self.unstretched)
            self.eye_tension = held if held < now.limit else now.limit
            self.inertia_force = self.linear_density * self.length * acceleration
            self.drag_force = self.drag * self.length * speed * speed
        tension = self.eye_tension + self.inertia_force + self.drag_force
        self.slack = self.carried and tension <= 0.0
        self.tension = tension if tension > 0.0 else 0.0

    def show_ahead(self, brake: Brake, time: float, lead: float) -> int:
        """Outputs at the end of the step, the inputs carried over it; what the yarn keeps stays as it is."""
        inward = self.inward
        offset = self.length_offset
        unstretched = self.unstretched
        highest = self.highest_tension
        snatch = self.highest_snatch
        longest = self.longest_slack
        hanging = self.slack_so_far
        rise = self.acceleration_rate * lead
        now = self.sample(
            brake,
            time,
            lead,
            carried(self.travel, self.velocity, self.acceleration + rise / 3.0, lead),
            self.velocity + (self.acceleration + 0.5 * rise) * lead,
            self.acceleration + rise,
        )
        if too_far(now.angle):
            return 1
        self.follow(brake, now, lead)
        self.show(now)
        self.inward = inward
        self.length_offset = offset
        self.unstretched = unstretched
        self.highest_tension = highest
        self.highest_snatch = snatch
        self.longest_slack = longest
        self.slack_so_far = hanging
        return 0
