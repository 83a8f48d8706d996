"""HealdPlay: a heald in its play between the bars of its carrier, and its blows."""

from dataclasses import dataclass
from math import fabs, inf
from typing import ClassVar

from ..declaring.declarations import at_step_end, input_, output, parameter, state
from ..declaring.variables import Component, Problem, Terminal
from ..physics.heald_play import distance, until_bar, until_free
from ..physics.numerics.motion import joined, moved_on
from .quantities import GRAVITY, LENGTH, LOAD, MASS, RATIO, VELOCITY
from .shared_declarations import frame_acceleration, frame_lift, frame_velocity
from .terminals import FRAME

MOST_FLIGHTS = 10000  # in one step
LEAST_TIME = 1e-12  # of a step, that a flight or a rest takes
MOST_BLOWS = 2147483647  # counted: what an FMI integer holds


@dataclass(slots=True)
class HealdPlay(Component):
    """Play of a heald: it flies between the bars that carry it, strikes them and rests on them.

    Exact between two samples of the inputs, whatever the step: the bars move on the quintic that joins them,
    and the pull of the thread on a straight line. Its reaction on bars and thread is neglected.
    """

    problems: ClassVar[tuple[Problem, ...]] = (
        Problem(
            "the step spans more than 10,000 blows of the heald; use a smaller step or raise least_speed"
        ),
    )
    terminals: ClassVar[tuple[Terminal, ...]] = (FRAME.of("lift", "velocity", "acceleration"),)
    accuracy: ClassVar[str] = "second order in the step, by the pull of the thread between samples"
    longest_turn: ClassVar[float] = inf
    bounces: ClassVar[str] = "blows"

    play: float = parameter(
        LENGTH.within(1e-9, 1.0, nominal=0.001),
        0.002,
        "Play of the heald's loops on the bars, from end to end (assumed: none published)",
    )
    heald_mass: float = parameter(
        MASS.within(1e-6, 10.0, nominal=0.01), 0.003, "Mass of a heald (assumed: none published)"
    )
    restitution: float = parameter(
        RATIO.within(0.0, 0.99), 0.5, "Coefficient of restitution of a blow (assumed)"
    )
    least_speed: float = parameter(
        VELOCITY.within(1e-9, 100.0, nominal=0.001),
        0.001,
        "Speed below which a heald stays on the bar and no blow is counted (assumed)",
    )
    gravity: float = parameter(GRAVITY, 9.80665, "Gravity")
    thread_count: int = parameter(
        "1",
        1260,
        "Number of threads that share warp_load, one to a heald",
        minimum=1,
        maximum=1000000,
        source="warp_#.thread_count",
    )
    inputs_at_step_end: bool = at_step_end()
    lift: float = frame_lift(0.0, "the bars that carry the heald")
    velocity: float = frame_velocity("the bars")
    acceleration: float = frame_acceleration(-20.0, "the bars")
    warp_load: float = input_(
        LOAD, 0.0, "Load of all threads on their healds, positive upwards", source="warp_#.frame_load"
    )
    displacement: float = output(LENGTH, "Displacement of the heald in its play", nominal=0.001, rate="rate")
    rate: float = output("m/s", "Rate of the displacement")
    travel: float = output(LENGTH, "Way of the heald in its play so far", nominal=0.1, so_far=True)
    blows: int = output("1", "Blows of the heald on the bars so far", start=0, so_far=True)
    blow_velocity: float = output("m/s", "Velocity of the last blow", variability="discrete", nominal=0.1)
    hardest_blow: float = output(
        "m/s",
        "Largest velocity of a blow so far",
        variability="discrete",
        nominal=0.1,
        so_far=True,
        error="unseen_blow",
    )
    unseen_blow: float = output(
        "m/s",
        "Largest velocity that a blow may have had so far without being counted: least_speed until"
        " a blow is counted",
        variability="discrete",
        nominal=0.001,
        so_far=True,
    )
    largest_impulse: float = output(
        "N.s", "Largest impulse of a blow so far", variability="discrete", nominal=0.001, so_far=True
    )
    total_impulse: float = output(
        "N.s", "Impulse of all blows so far", variability="discrete", nominal=0.01, so_far=True
    )
    side: int = state(
        "1", "1 or -1 while it rests on the upper or lower bar, else 0", start=0, minimum=-1, maximum=1
    )
    sampled_lift: float = state("m", "Lift at the last sample of the inputs")
    sampled_velocity: float = state("m/s", "Velocity at the last sample")
    sampled_acceleration: float = state("m/s2", "Acceleration at the last sample")
    sampled_load: float = state("N", "Load at the last sample")

    def initialize(self, time: float) -> int:
        """Let the heald rest on the bar that it is pressed on, and forget all blows."""
        self.side = 1 if self.pulled(self.warp_load) > self.acceleration else -1
        self.displacement = 0.5 * self.play * self.side
        self.rate = 0.0
        self.travel = 0.0
        self.blows = 0
        self.blow_velocity = 0.0
        self.hardest_blow = 0.0
        self.unseen_blow = self.least_speed
        self.largest_impulse = 0.0
        self.total_impulse = 0.0
        self.remember()
        return 0

    def remember(self) -> None:
        """Keep the present inputs as the last sample."""
        self.sampled_lift = self.lift
        self.sampled_velocity = self.velocity
        self.sampled_acceleration = self.acceleration
        self.sampled_load = self.warp_load

    def pulled(self, load: float) -> float:
        """Acceleration that thread and weight give a free heald."""
        return load / (self.thread_count * self.heald_mass) - self.gravity

    def step(self, time: float, step_size: float) -> int:
        """Move the heald over the step."""
        if step_size <= 0.0:
            return 0
        h = step_size
        q0 = self.pulled(self.warp_load) - self.acceleration
        q1 = 0.0
        q2 = 0.0
        q3 = 0.0
        if self.inputs_at_step_end:
            a0, a1, a2, a3 = joined(
                self.sampled_lift,
                h * self.sampled_velocity,
                h * h * self.sampled_acceleration,
                self.lift,
                h * self.velocity,
                h * h * self.acceleration,
            )
            start = self.pulled(self.sampled_load)
            square = h * h
            q0 = start - a0 / square
            q1 = (self.pulled(self.warp_load) - start) / h - a1 / (square * h)
            q2 = -a2 / (square * square)
            q3 = -a3 / (square * square * h)
        problem = self.move(h, q0, q1, q2, q3)
        self.remember()
        return problem

    def move(self, duration: float, q0: float, q1: float, q2: float, q3: float) -> int:
        """Flight by flight and rest by rest, to the end of the step."""
        elapsed = 0.0
        for _ in range(MOST_FLIGHTS):
            rest = duration - elapsed
            b0 = q0 + elapsed * (q1 + elapsed * (q2 + elapsed * q3))
            b1 = q1 + elapsed * (2.0 * q2 + elapsed * 3.0 * q3)
            b2 = q2 + 3.0 * q3 * elapsed
            if self.side != 0:
                taken = until_free(self.side, b0, b1, b2, q3, rest)
                if taken < rest:
                    self.side = 0
            else:
                taken = self.fly(b0, b1, b2, q3, rest)
            if taken >= rest:
                return 0
            # a rest that rounding ends at once would go on for ever
            elapsed = elapsed + (taken if taken > LEAST_TIME * duration else LEAST_TIME * duration)
        return 1

    def fly(self, q0: float, q1: float, q2: float, q3: float, rest: float) -> float:
        """Fly to the next bar, or to the end of the step; the time that takes."""
        position = self.displacement
        rate = self.rate
        taken, bar = until_bar(position, rate, q0, q1, q2, q3, 0.5 * self.play, rest)
        self.travel = self.travel + distance(position, rate, q0, q1, q2, q3, taken)
        self.displacement, self.rate, _acceleration = moved_on(position, rate, q0, q1, q2, q3, taken)
        if bar != 0:
            self.strike(bar)
        return taken

    def strike(self, bar: int) -> None:
        """Return from a bar, or stay on it if the blow is too weak."""
        speed = fabs(self.rate)
        self.displacement = 0.5 * self.play * bar
        self.rate = -self.restitution * self.rate
        if speed < self.least_speed:
            self.side = bar
            self.rate = 0.0
            return
        if self.blows < MOST_BLOWS:
            self.blows = self.blows + 1
        impulse = (1.0 + self.restitution) * self.heald_mass * speed
        self.blow_velocity = speed
        self.total_impulse = self.total_impulse + impulse
        if speed > self.hardest_blow:
            self.hardest_blow = speed
            self.unseen_blow = 0.0
            self.largest_impulse = impulse
