"""WarpTension: the tension of the warp threads that a heald frame lifts."""

from dataclasses import dataclass
from math import inf
from typing import ClassVar

from ..declaring.declarations import at_step_end, output, state
from ..declaring.variables import MIXED, Terminal
from ..physics.numerics.motion import joined, joined_area
from ..physics.shaft import carried
from ..physics.warp import (
    eye_pull,
    thread_drive,
    thread_extension,
    thread_force,
    thread_growth,
    thread_locate,
    turns_once,
)
from ..physics.warp_energy import thread_energy, thread_power
from .quantities import LENGTH, TENSION
from .shared_declarations import frame_acceleration, frame_lift, frame_velocity
from .terminals import FRAME
from .threads import Threads


@dataclass(frozen=True)
class Way:
    """The way of a thread between two samples, by the share of it.

    Force at its start [N], `decay` and right side of its law, see `thread_force`; rate of the extension at
    its start, and its second rate as from `joined` [m].
    """

    force: float
    decay: float
    rate: float
    second: list[float]
    drive: list[float]


@dataclass(frozen=True)
class Place:
    """A share of the way, with the force there and its integral up to it [N]."""

    share: float
    force: float
    area: float


def place_at(way: Way, share: float) -> Place:
    """The place at a share of the way."""
    force, area = thread_force(way.force, way.decay, way.drive, share)
    return Place(share, force, area)


@dataclass(slots=True)
class WarpTension(Threads):
    """Warp tension: viscoelastic threads, stretched by the shed, and their load on the heald carrier.

    Exact between two samples of the inputs, whatever the step: the extension runs on the quintic that
    joins them, extremes and mean are those of the continuous curve. A thread carries no compression: the
    law goes on below zero, the tension stays at zero and `slack` tells so. Unconnected, the thread of a
    raised frame relaxes.
    """

    terminals: ClassVar[tuple[Terminal, ...]] = (FRAME.of("lift", "velocity", "acceleration"),)
    origin: ClassVar[str] = MIXED
    accuracy: ClassVar[str] = "sixth order in the step, by the curve of its frame between samples"
    longest_turn: ClassVar[float] = inf

    inputs_at_step_end: bool = at_step_end()
    lift: float = frame_lift(0.098)
    velocity: float = frame_velocity()
    acceleration: float = frame_acceleration(0.0)
    extension: float = output(LENGTH, "Extension of a thread by the shed", nominal=0.01)
    tension: float = output(TENSION, "Tension of a thread", nominal=0.5)
    highest_tension: float = output(
        TENSION, "Highest tension so far, on the continuous curve", nominal=0.5, highest_of="tension"
    )
    lowest_tension: float = output(
        TENSION, "Lowest tension so far, on the continuous curve", nominal=0.5, lowest_of="tension"
    )
    mean_tension: float = output(TENSION, "Mean tension so far", nominal=0.5)
    frame_load: float = output("N", "Load of the warp on the heald carrier, positive upwards", nominal=100.0)
    potential_energy: float = output(
        "J", "Energy stored in all threads, from the closed shed at pretension", nominal=10.0
    )
    dissipated_power: float = output(
        "W",
        "Power that creep, relaxation and slack take from all threads; negative where creep returns it",
        nominal=10.0,
    )
    frame_work: float = output(
        "J", "Work that has stretched all threads so far: that of frame_load, reversed", nominal=10.0
    )
    slack: bool = output("1", "The thread is slack", start=False)
    elapsed: float = state("s", "Time covered by the extremes and the mean", minimum=0.0)
    pending: float = state("s", "Time from the last sample of the inputs to the next", minimum=0.0)
    sampled_extension: float = state("m", "Extension at the last sample")
    sampled_rate: float = state("m/s", "Rate of the extension at the last sample")
    sampled_second: float = state("m/s2", "Second rate of the extension at the last sample")
    sampled_force: float = state("N", "Force of the thread above its pretension at the last sample")
    sampled_work: float = state("J", "Work that had stretched all threads at the last sample")

    def initialize(self, time: float) -> int:
        """Stretch the threads at once to where their eyes are, and forget all extremes."""
        extension, rate, second = self.sample(0.0)
        self.sampled_force = self.thread_stiffness * extension
        self.sampled_work = 0.0
        self.remember(extension, rate, second)
        self.elapsed = 0.0
        self.pending = 0.0
        self.mean_tension = self.pretension + self.sampled_force
        self.highest_tension = self.mean_tension
        self.lowest_tension = self.mean_tension
        self.show(0.0)
        return 0

    def step(self, time: float, step_size: float) -> int:
        """Follow the threads from the last sample of the inputs to this one and show their state."""
        extension, rate, second = self.sample(0.0)
        if self.inputs_at_step_end:
            self.follow(step_size, extension, rate, second)
        else:
            self.follow(self.pending, extension, rate, second)
        self.remember(extension, rate, second)
        self.pending = step_size
        self.show(0.0 if self.inputs_at_step_end else step_size)
        return 0

    def sample(self, lead: float) -> tuple[float, float, float]:
        """Extension of a thread and its rates, the inputs carried over `lead`."""
        lift = carried(self.lift, self.velocity, self.acceleration, lead)
        return thread_extension(
            lift - 0.5 * self.stroke + self.shed_offset,
            self.velocity + self.acceleration * lead,
            self.acceleration,
            self.front_length,
            self.back_length,
        )

    def remember(self, extension: float, rate: float, second: float) -> None:
        """Make the present sample the last one."""
        self.sampled_extension = extension
        self.sampled_rate = rate
        self.sampled_second = second

    def way(self, duration: float, extension: float, rate: float, second: float) -> Way:
        """The way from the last sample to this one."""
        start_rate = duration * self.sampled_rate
        a0, a1, a2, a3 = joined(
            self.sampled_extension,
            start_rate,
            duration * duration * self.sampled_second,
            extension,
            duration * rate,
            duration * duration * second,
        )
        creep = self.creep_rate * duration
        p = thread_drive(self.thread_stiffness, creep, self.sampled_extension, extension, a0, a1, a2, a3)
        return Way(self.sampled_force, self.relaxation_rate * duration, start_rate, [a0, a1, a2, a3], list(p))

    def work(self, way: Way, low: Place, high: Place) -> float:
        """Work that stretches all threads over a part of the way: while taut, their power is a quintic."""
        slack_at = -self.pretension
        start = low.share
        stop = high.share
        if (low.force - slack_at) * (high.force - slack_at) < 0.0:
            passed = thread_locate(False, slack_at, way.force, way.decay, way.drive, low.share, high.share)
            start = passed if low.force < slack_at else start
            stop = stop if low.force < slack_at else passed
        force = low.force if start == low.share else slack_at
        power, growth, bend = thread_power(
            self.pretension, force, way.decay, way.drive, way.rate, way.second, start
        )
        force = high.force if stop == high.share else slack_at
        end_power, end_growth, end_bend = thread_power(
            self.pretension, force, way.decay, way.drive, way.rate, way.second, stop
        )
        return self.thread_count * joined_area(
            stop - start, power, growth, bend, end_power, end_growth, end_bend
        )

    def follow(self, duration: float, extension: float, rate: float, second: float) -> None:
        """Bring force, extremes and mean from the last sample to this one.

        Where the force may turn more than once on the way, each eighth of it is looked at.
        """
        way = self.way(duration, extension, rate, second)
        panels = 1 if turns_once(way.drive) else 8
        low = Place(0.0, way.force, 0.0)
        total = 0.0
        for panel in range(panels):
            high = place_at(way, (panel + 1) / panels)
            total = total + self.panel_area(way, low, high)
            self.sampled_work = self.sampled_work + self.work(way, low, high)
            low = high
        self.sampled_force = low.force
        if duration > 0.0:
            self.elapsed = self.elapsed + duration
            self.mean_tension = self.mean_tension + (total - self.mean_tension) * duration / self.elapsed

    def panel_area(self, way: Way, low: Place, high: Place) -> float:
        """Integral of the tension over a piece of the way on which the force turns at most once."""
        growth = thread_growth(low.force, way.decay, way.drive, low.share)
        if growth * thread_growth(high.force, way.decay, way.drive, high.share) < 0.0:
            # it gets no farther than it would at the rate of the start
            tension = self.pretension + low.force
            bound = tension + growth * (high.share - low.share)
            if bound > self.highest_tension or bound < self.lowest_tension or bound * tension < 0.0:
                turn = place_at(
                    way, thread_locate(True, 0.0, way.force, way.decay, way.drive, low.share, high.share)
                )
                before = self.piece_area(way, low, turn)
                return before + self.piece_area(way, turn, high)
        return self.piece_area(way, low, high)

    def piece_area(self, way: Way, low: Place, high: Place) -> float:
        """Integral of the tension over a piece on which it passes zero at most once; notes its end."""
        tension = self.pretension + low.force
        end_tension = self.pretension + high.force
        self.note(end_tension)
        if tension <= 0.0 and end_tension <= 0.0:
            return 0.0
        if tension < 0.0 or end_tension < 0.0:
            slack_at = -self.pretension
            passed = place_at(
                way, thread_locate(False, slack_at, way.force, way.decay, way.drive, low.share, high.share)
            )
            if tension < 0.0:
                return self.pretension * (high.share - passed.share) + high.area - passed.area
            return self.pretension * (passed.share - low.share) + passed.area - low.area
        return self.pretension * (high.share - low.share) + high.area - low.area

    def note(self, tension: float) -> None:
        """Keep the highest and the lowest tension."""
        carried_tension = tension if tension > 0.0 else 0.0
        if carried_tension > self.highest_tension:
            self.highest_tension = carried_tension
        if carried_tension < self.lowest_tension:
            self.lowest_tension = carried_tension

    def show(self, lead: float) -> None:
        """Outputs at the end of the step, the inputs carried over `lead` if they hold at its start."""
        force = self.sampled_force
        self.extension = self.sampled_extension
        rate = self.sampled_rate
        self.frame_work = self.sampled_work
        if lead > 0.0:
            extension, rate, second = self.sample(lead)
            way = self.way(lead, extension, rate, second)
            start = Place(0.0, force, 0.0)
            end = place_at(way, 1.0)
            self.frame_work = self.sampled_work + self.work(way, start, end)
            force = end.force
            self.extension = extension
        tension = self.pretension + force
        self.slack = tension < 0.0
        self.tension = 0.0 if self.slack else tension
        stored, taken = thread_energy(
            force, self.extension, self.thread_stiffness, self.creep_rate, self.relaxation_rate
        )
        self.potential_energy = self.thread_count * (stored + self.pretension * self.extension)
        self.dissipated_power = self.thread_count * (taken + (self.tension - tension) * rate)
        height = carried(self.lift, self.velocity, self.acceleration, lead)
        height = height - 0.5 * self.stroke + self.shed_offset
        pull = eye_pull(height, self.front_length, self.back_length)
        self.frame_load = -self.thread_count * self.tension * pull
