"""BeltMonitor: the stability of the rapier belt outside its guide."""

from dataclasses import dataclass
from math import fabs, inf, pi
from typing import ClassVar

from ..declaring.declarations import auxiliary, input_, output, parameter
from ..declaring.variables import EXTREMES, MIXED, Problem, Terminal
from ..physics.belt import (
    NO_LIMIT,
    critical_force,
    elastica_deflection,
    length_factor,
    length_factor_slope,
    margin,
    speed_limit,
    weft_load,
)
from ..physics.numerics.motion import (
    above_noise,
    bent,
    bump_noise,
    bumps,
    expected_bump,
    joined_rate,
    joined_value,
    sample_noise,
)
from ..physics.shaft import carried, too_far
from .quantities import BENDING_STIFFNESS, CLEARANCE, HEAD_LENGTH, HEAD_MASS, LENGTH, RATIO, TURNING
from .shaft_driven import TOO_FAR, ShaftDriven
from .shared_declarations import head_acceleration, head_travel, head_velocity, yarn_tension
from .terminals import HEAD

# Time [s] and shaft angle [rad] below which two samples are one: their squares would underflow
SHORTEST = 1e-15
NEAREST = 1e-9  # share of a way below which golden sections no longer part two places
MARGIN, LIMIT, DEFLECTION = 0, 1, 2  # of which an extreme is searched


@dataclass(frozen=True)
class Way:
    """Way of the head between two samples: step, rate at its start and second rate by the share of it [m]."""

    step: float
    rate: float
    a0: float
    a1: float
    a2: float
    a3: float


@dataclass(slots=True)
class BeltMonitor(ShaftDriven):
    """Stability monitor of the rapier belt: margin against buckling, safe speed, deflection.

    Between two samples of its inputs the head moves on the quintic that joins them, so the lowest
    margin and the lowest speed limit are those of the continuous curve. A step of more than an eighth
    of a revolution is not joined up: of it only the samples count.
    """

    problems: ClassVar[tuple[Problem, ...]] = (
        Problem(
            "guide_clearance = {guide_clearance}: above 1 mm replace the belt or slow the loom down",
            warning=True,
        ),
        TOO_FAR,
    )
    keeps: ClassVar[str] = EXTREMES
    origin: ClassVar[str] = MIXED
    longest_turn: ClassVar[float] = inf
    windows: ClassVar[tuple[str, ...]] = ("free_length", "axial_force")
    terminals: ClassVar[tuple[Terminal, ...]] = (
        *ShaftDriven.terminals,
        HEAD.of("travel", "velocity", "acceleration"),
    )

    bending_stiffness: float = parameter(BENDING_STIFFNESS, 0.25, "Bending stiffness EI of the belt")
    head_mass: float = parameter(HEAD_MASS, 0.1105, "Mass of rapier head and rigid section of the belt")
    head_length: float = parameter(HEAD_LENGTH, 0.550, "Length of head and rigid section")
    idle_travel: float = parameter(HEAD_LENGTH, 0.243, "Travel of the head before it leaves the guide")
    prescribe_length_factor: bool = parameter(
        "1", False, "Use prescribed_length_factor instead of deriving it from guide_clearance"
    )
    prescribed_length_factor: float = parameter(
        RATIO.within(0.1, 2.0),
        0.8,
        "Column length factor, used if prescribe_length_factor is true",
        when="prescribe_length_factor",
    )
    taker: bool = parameter(
        "1", False, "The head takes the weft over and draws it out; otherwise it brings the weft in"
    )
    travel: float = head_travel()
    velocity: float = head_velocity()
    acceleration: float = head_acceleration(398.0)
    yarn_tension: float = yarn_tension()
    guide_clearance: float = input_(
        CLEARANCE,
        0.3e-3,
        "Clearance of the belt in its guide; grows with wear",
        unless="prescribe_length_factor",
    )
    free_length: float = output(
        LENGTH,
        "Length of the belt between guide and head; negative while inside the guide",
        nominal=1.0,
    )
    inertia_force: float = output("N", "Inertia force of the head on the belt", nominal=100.0)
    axial_force: float = output(
        "N",
        "Compression of the belt: inertia force and weft tension",
        nominal=100.0,
    )
    critical_force: float = output(
        "N",
        "Critical load of the free section; inside the guide, that of a section of 1 mm",
        nominal=100.0,
    )
    length_factor: float = output("1", "Column length factor in use", follows="guide_clearance")
    margin: float = output("1", "Margin against buckling, 1 - compression / critical load")
    lowest_margin: float = output("1", "Lowest margin so far, on the continuous curve", lowest_of="margin")
    speed_limit: float = output(
        TURNING,
        "Shaft speed at which the belt would just buckle here; 95493 rev/min if it cannot",
        nominal=100.0,
    )
    lowest_speed_limit: float = output(
        TURNING, "Lowest speed limit so far, on the continuous curve", nominal=100.0, lowest_of="speed_limit"
    )
    deflection: float = output(
        LENGTH, "Largest deflection of the buckled belt, exact elastica", nominal=5e-3, brief=True
    )
    at_risk: bool = output("1", "The belt is outside its guide and in compression", start=False)
    largest_deflection: float = output(
        LENGTH, "Largest deflection so far, on the continuous curve", nominal=5e-3, highest_of="deflection"
    )
    buckled: bool = output("1", "The belt has buckled at least once", start=False, lowest_of="margin")

    acceleration_rate: float = auxiliary("m/s3", "Rate of the acceleration between the last two samples")
    bend_rate: float = auxiliary("m/s", "Rate of the second derivative by shaft angle between the samples")
    factor_clearance: float = auxiliary("m", "Clearance for which length_factor was computed")
    factor_slope: float = auxiliary("1/m", "Slope of length_factor at that clearance")
    sampled_time: float = auxiliary("s", "Time of the last sample of the inputs")
    sampled_travel: float = auxiliary("m", "Travel at the last sample")
    sampled_velocity: float = auxiliary("m/s", "Velocity at the last sample")
    sampled_acceleration: float = auxiliary("m/s2", "Acceleration at the last sample")
    sampled_force: float = auxiliary("N", "Weft tension at the last sample")
    sampled_clearance: float = auxiliary("m", "Guide clearance at the last sample")
    sampled_angle: float = auxiliary("rad", "Shaft angle at the last sample")
    sampled_slope: float = auxiliary("m", "Travel by shaft angle at the last sample, first derivative")
    sampled_bend: float = auxiliary("m", "Travel by shaft angle at the last sample, second derivative")
    sampled_turning: bool = auxiliary("1", "The shaft was turning at the last sample", start=False)
    bump_by_time: float = auxiliary("m", "Bump of the rate by time over the last step")
    bump_time: float = auxiliary("s", "Duration of the last step, if it was interpolated", minimum=0.0)
    bump_by_angle: float = auxiliary("m", "Bump of the rate by shaft angle over the last step")
    bump_angle: float = auxiliary("rad", "Shaft angle of the last step, if it was interpolated")
    joined_angle: float = auxiliary("rad", "Shaft angle of the current sample")
    joined_slope: float = auxiliary("m", "First derivative by shaft angle at the current sample")
    joined_bend: float = auxiliary("m", "Second derivative by shaft angle at the current sample")
    joined_turning: bool = auxiliary("1", "The shaft is turning at the current sample", start=False)

    def initialize(self, time: float) -> int:
        """Take the first sample and forget all extremes."""
        self.factor_clearance = -1.0
        self.lowest_margin = 1e300
        self.lowest_speed_limit = NO_LIMIT
        self.largest_deflection = 0.0
        self.buckled = False
        self.acceleration_rate = 0.0
        self.bend_rate = 0.0
        self.bump_time = 0.0
        self.bump_angle = 0.0
        self.use_clearance()
        self.take_sample(time, 0.0)
        if too_far(self.joined_angle):
            return 2
        self.remember(time)
        self.judge(0.0)
        return self.show(0.0)

    def step(self, time: float, step_size: float) -> int:
        """Judge the way from the last sample of the inputs to this one and show the belt's state."""
        self.use_clearance()
        at = time + step_size if self.inputs_at_step_end else time
        self.take_sample(time, step_size if self.inputs_at_step_end else 0.0)
        if too_far(self.joined_angle):
            return 2
        duration = at - self.sampled_time
        self.judge(duration)
        if duration > SHORTEST:
            self.acceleration_rate = (self.acceleration - self.sampled_acceleration) / duration
            self.bend_rate = (self.joined_bend - self.sampled_bend) / duration
        self.remember(at)
        return self.show(0.0 if self.inputs_at_step_end else step_size)

    def use_clearance(self) -> None:
        """Find the length factor if the clearance has changed."""
        if self.prescribe_length_factor:
            self.length_factor = self.prescribed_length_factor
        elif self.guide_clearance != self.factor_clearance:
            self.length_factor = length_factor(self.guide_clearance)
            self.factor_slope = length_factor_slope(self.guide_clearance)
            self.factor_clearance = self.guide_clearance
        else:
            # nothing, but its derivative by the clearance is something
            self.length_factor += self.factor_slope * (self.guide_clearance - self.factor_clearance)

    def take_sample(self, time: float, lead: float) -> None:
        """Derivatives of the travel by the shaft angle, from its rates and the shaft's."""
        angle, speed, acceleration = self.shaft(time, lead)
        self.joined_angle = angle
        self.joined_turning = fabs(speed) > 1e-6
        self.joined_slope = 0.0
        self.joined_bend = 0.0
        if self.joined_turning:
            self.joined_slope = self.velocity / speed
            self.joined_bend = (self.acceleration - self.joined_slope * acceleration) / (speed * speed)

    def remember(self, time: float) -> None:
        """Make the present sample the last one."""
        self.sampled_time = time
        self.sampled_travel = self.travel
        self.sampled_velocity = self.velocity
        self.sampled_acceleration = self.acceleration
        self.sampled_force = self.yarn_tension
        self.sampled_clearance = self.guide_clearance
        self.sampled_angle = self.joined_angle
        self.sampled_slope = self.joined_slope
        self.sampled_bend = self.joined_bend
        self.sampled_turning = self.joined_turning

    def shape_at(self, which: int, way: Way, share: float) -> float:
        """Margin, speed limit or reversed deflection at a share of the way from the last sample."""
        travel, second = joined_value(self.sampled_travel, way.rate, way.a0, way.a1, way.a2, way.a3, share)
        second = second / (way.step * way.step)
        tension = self.sampled_force + share * (self.yarn_tension - self.sampled_force)
        rate = joined_rate(way.rate, way.a0, way.a1, way.a2, way.a3, share)
        tension = weft_load(tension, rate / fabs(way.step), self.taker)
        factor = self.length_factor
        if self.sampled_clearance != self.guide_clearance and not self.prescribe_length_factor:
            clearance = self.sampled_clearance + share * (self.guide_clearance - self.sampled_clearance)
            factor = length_factor(clearance)
        elif not self.prescribe_length_factor:
            factor += self.factor_slope * (1.0 - share) * (self.sampled_clearance - self.guide_clearance)
        free_length = travel - self.idle_travel - self.head_length
        if which == LIMIT:
            return speed_limit(free_length, second, factor, self.bending_stiffness, self.head_mass, tension)
        here = margin(free_length, self.head_mass * second + tension, factor, self.bending_stiffness)
        return here if which == MARGIN else -elastica_deflection(1.0 - here, free_length)

    def way_between(self, limit: bool, step: float) -> Way:
        """The way of the head from the last sample to this one.

        Where the samples come so close that the bump of the value drowns in their rounding, it is taken
        from how the bump of the rate has changed since the step before.
        """
        rate = step * (self.sampled_slope if limit else self.sampled_velocity)
        end_rate = step * (self.joined_slope if limit else self.velocity)
        second = step * step * (self.sampled_bend if limit else self.sampled_acceleration)
        end_second = step * step * (self.joined_bend if limit else self.acceleration)
        by_rate, by_value = bumps(self.sampled_travel, rate, second, self.travel, end_rate, end_second)
        place = (self.joined_angle if limit else self.sampled_time) / step
        rates = fabs(rate) + fabs(end_rate)
        rate_noise, value_noise = bump_noise(
            sample_noise(fabs(self.sampled_travel) + fabs(self.travel), rates, place),
            sample_noise(rates, fabs(second) + fabs(end_second), place),
        )
        by_rate = above_noise(by_rate, 0.0, rate_noise)
        if limit:
            expected = expected_bump(self.bump_by_angle, self.bump_angle, by_rate, step)
            self.bump_by_angle = by_rate
            self.bump_angle = step
        else:
            expected = expected_bump(self.bump_by_time, self.bump_time, by_rate, step)
            self.bump_by_time = by_rate
            self.bump_time = step
        by_value = above_noise(by_value, expected, value_noise)
        a0, a1, a2, a3 = bent(second, end_second, by_rate, by_value)
        return Way(step, rate, a0, a1, a2, a3)

    def search_between(self, limit: bool, duration: float) -> None:
        """Bring extremes up to the way from the last sample: of the speed limit, or of margin and deflection.

        The way is known by shaft angle for the limit, by time for the others. What is farther above the
        lowest value so far, and above 0, than five values differ is not searched.
        """
        step = self.joined_angle - self.sampled_angle if limit else duration
        way = self.way_between(limit, step)
        if limit:
            lowest, _place = self.lowest_of(LIMIT, way, 0.0, 1.0, self.lowest_speed_limit)
            if lowest < self.lowest_speed_limit:
                self.lowest_speed_limit = lowest
            return
        above = self.lowest_margin if self.lowest_margin > 0.0 else 0.0
        lowest, place = self.lowest_of(MARGIN, way, 0.0, 1.0, above)
        if lowest < self.lowest_margin:
            self.lowest_margin = lowest
        if lowest < 0.0:
            # a belt is deflected while its margin is negative, which may be a tiny part of the step
            start = self.edge(way, place, 0.0)
            end = self.edge(way, place, 1.0)
            most, _place = self.lowest_of(DEFLECTION, way, start, end, 0.0)
            if -most > self.largest_deflection:
                self.largest_deflection = -most

    def edge(self, way: Way, inside: float, end: float) -> float:
        """Share of the way towards an end up to which the margin stays negative."""
        if self.shape_at(MARGIN, way, end) < 0.0:
            return end
        outside = end
        for _ in range(50):
            middle = 0.5 * (inside + outside)
            if self.shape_at(MARGIN, way, middle) < 0.0:
                inside = middle
            else:
                outside = middle
        return inside

    def lowest_of(self, which: int, way: Way, low: float, high: float, bar: float) -> tuple[float, float]:
        """Lowest value between two shares of the way, and its share.

        Five values find the neighbourhood, golden sections the place: the value at a minimum is then exact to
        rounding. It is not searched where the five values are farther above `bar` than they differ.
        """
        quarter = 0.25 * (high - low)
        nearest = 1e300
        farthest = -1e300
        at = 0
        for number in range(5):
            value = self.shape_at(which, way, low + quarter * number)
            if value < nearest:
                nearest = value
                at = number
            if value > farthest:
                farthest = value
        place = low + quarter * at
        if nearest - (farthest - nearest) >= bar:
            return nearest, place
        if at == 0 or at == 4:
            inward = NEAREST * (high - low) if at == 0 else NEAREST * (low - high)
            if self.shape_at(which, way, place + inward) >= nearest:  # it rises from the end
                return nearest, place
        left = low + quarter * (at - 1) if at > 0 else low
        right = low + quarter * (at + 1) if at < 4 else high
        value, share = self.golden(which, way, left, right)
        if value < nearest:
            return value, share
        return nearest, place

    def golden(self, which: int, way: Way, low: float, high: float) -> tuple[float, float]:
        """Lowest value between two shares of the way about one minimum, and its share."""
        golden = 0.6180339887498949
        left = high - golden * (high - low)
        right = low + golden * (high - low)
        at_left = self.shape_at(which, way, left)
        at_right = self.shape_at(which, way, right)
        for _ in range(40):
            if at_left < at_right:
                high = right
                right = left
                at_right = at_left
                left = high - golden * (high - low)
                at_left = self.shape_at(which, way, left)
            else:
                low = left
                left = right
                at_left = at_right
                right = low + golden * (high - low)
                at_right = self.shape_at(which, way, right)
        if at_left < at_right:
            return at_left, left
        return at_right, right

    def judge(self, duration: float) -> None:
        """Bring the lowest margin and speed limit up to the present sample."""
        guide = self.idle_travel + self.head_length
        weft = weft_load(self.yarn_tension, self.velocity, self.taker)
        force = self.head_mass * self.acceleration + weft
        here = margin(self.travel - guide, force, self.length_factor, self.bending_stiffness)
        if here < self.lowest_margin:
            self.lowest_margin = here
        deflection = elastica_deflection(1.0 - here, self.travel - guide)
        if deflection > self.largest_deflection:
            self.largest_deflection = deflection
        if self.joined_turning:
            limit = speed_limit(
                self.travel - guide,
                self.joined_bend,
                self.length_factor,
                self.bending_stiffness,
                self.head_mass,
                weft,
            )
            if limit < self.lowest_speed_limit:
                self.lowest_speed_limit = limit
        turn = fabs(self.joined_angle - self.sampled_angle)
        outside = self.travel > guide or self.sampled_travel > guide
        near = duration > SHORTEST and outside and turn <= 0.25 * pi
        sampled_weft = weft_load(self.sampled_force, self.sampled_velocity, self.taker)
        sampled_force = self.head_mass * self.sampled_acceleration + sampled_weft
        if near and (force > 0.0 or sampled_force > 0.0):
            self.search_between(False, duration)
        elif duration > SHORTEST:
            self.bump_time = 0.0
        pushed = self.joined_bend > 0.0 or self.sampled_bend > 0.0
        if near and pushed and self.joined_turning and self.sampled_turning and turn > SHORTEST:
            self.search_between(True, duration)
        elif duration > SHORTEST:
            self.bump_angle = 0.0
        if self.lowest_margin < 0.0:
            self.buckled = True

    def show(self, lead: float) -> int:
        """Outputs at the end of the step, the inputs carried over `lead` if they hold at its start."""
        travel = carried(self.travel, self.velocity, self.acceleration, lead)
        travel = travel + self.acceleration_rate * lead * lead * lead / 6.0
        bend = self.joined_bend + self.bend_rate * lead
        self.free_length = travel - self.idle_travel - self.head_length
        self.inertia_force = self.head_mass * (self.acceleration + self.acceleration_rate * lead)
        velocity = carried(self.velocity, self.acceleration, self.acceleration_rate, lead)
        weft = weft_load(self.yarn_tension, velocity, self.taker)
        self.axial_force = self.inertia_force + weft
        self.critical_force = critical_force(
            self.free_length if self.free_length > 1e-3 else 1e-3, self.length_factor, self.bending_stiffness
        )
        self.margin = margin(self.free_length, self.axial_force, self.length_factor, self.bending_stiffness)
        self.speed_limit = NO_LIMIT
        if self.joined_turning:
            self.speed_limit = speed_limit(
                self.free_length, bend, self.length_factor, self.bending_stiffness, self.head_mass, weft
            )
        self.deflection = elastica_deflection(1.0 - self.margin, self.free_length)
        self.at_risk = self.free_length > 0.0 and self.axial_force > 0.0
        return 1 if self.guide_clearance > 1e-3 and not self.prescribe_length_factor else 0
