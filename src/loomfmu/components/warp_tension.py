"""WarpTension: the tension of the warp threads that a heald frame lifts."""

from dataclasses import dataclass
from math import inf
from typing import ClassVar

from ..declaring.declarations import at_step_end, input_, output, state
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
from .terminals import FRAME
from .threads import Threads


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
    lift: float = input_(
        "m", 0.098, "Lift of the frame", display="mm", nominal=0.1, rate="velocity", minimum=-1e3, maximum=1e3
    )
    velocity: float = input_(
        "m/s", 0.0, "Velocity of the frame", rate="acceleration", minimum=-1e9, maximum=1e9
    )
    acceleration: float = input_(
        "m/s2", 0.0, "Acceleration of the frame", nominal=10.0, minimum=-1e15, maximum=1e15
    )
    extension: float = output("m", "Extension of a thread by the shed", display="mm", nominal=0.01)
    tension: float = output("N", "Tension of a thread", display="cN", nominal=0.5)
    highest_tension: float = output(
        "N",
        "Highest tension so far, on the continuous curve",
        display="cN",
        nominal=0.5,
        highest_of="tension",
    )
    lowest_tension: float = output(
        "N", "Lowest tension so far, on the continuous curve", display="cN", nominal=0.5, lowest_of="tension"
    )
    mean_tension: float = output("N", "Mean tension so far", display="cN", nominal=0.5)
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
    slack: bool = output("1", "The thread is slack", start=False, variability="discrete")
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

    def curve(
        self, duration: float, extension: float, rate: float, second: float
    ) -> tuple[float, float, float, float]:
        """Second rate of the extension by the share of the way from the last sample to this one."""
        return joined(
            self.sampled_extension,
            duration * self.sampled_rate,
            duration * duration * self.sampled_second,
            extension,
            duration * rate,
            duration * duration * second,
        )

    def drive(
        self, duration: float, extension: float, a0: float, a1: float, a2: float, a3: float
    ) -> list[float]:
        """Return the drive of a thread from the last sample to this one, see `thread_drive`."""
        return thread_drive(
            self.thread_stiffness,
            self.creep_rate * duration,
            self.sampled_extension,
            extension,
            a0,
            a1,
            a2,
            a3,
        )

    def work(
        self,
        duration: float,
        p: list[float],
        a0: float,
        a1: float,
        a2: float,
        a3: float,
        low: float,
        force: float,
        high: float,
        end: float,
    ) -> float:
        """Work that stretches all threads over a part of the way: while taut, their power is a quintic."""
        decay = self.relaxation_rate * duration
        rate = duration * self.sampled_rate
        slack_at = -self.pretension
        start = low
        stop = high
        if (force - slack_at) * (end - slack_at) < 0.0:
            passed = thread_locate(False, slack_at, self.sampled_force, decay, p, low, high)
            start = passed if force < slack_at else low
            stop = high if force < slack_at else passed
        power, growth, bend = thread_power(
            self.pretension, force if start == low else slack_at, decay, p, rate, a0, a1, a2, a3, start
        )
        end_power, end_growth, end_bend = thread_power(
            self.pretension, end if stop == high else slack_at, decay, p, rate, a0, a1, a2, a3, stop
        )
        return self.thread_count * joined_area(
            stop - start, power, growth, bend, end_power, end_growth, end_bend
        )

    def follow(self, duration: float, extension: float, rate: float, second: float) -> None:
        """Bring force, extremes and mean from the last sample to this one.

        Where the force may turn more than once on the way, each eighth of it is looked at.
        """
        a0, a1, a2, a3 = self.curve(duration, extension, rate, second)
        p = self.drive(duration, extension, a0, a1, a2, a3)
        decay = self.relaxation_rate * duration
        panels = 1 if turns_once(p) else 8
        low = 0.0
        force = self.sampled_force
        area = 0.0
        total = 0.0
        for panel in range(panels):
            high = (panel + 1) / panels
            end, end_area = thread_force(self.sampled_force, decay, p, high)
            total = total + self.panel_area(decay, p, low, force, area, high, end, end_area)
            self.sampled_work = self.sampled_work + self.work(
                duration, p, a0, a1, a2, a3, low, force, high, end
            )
            low = high
            force = end
            area = end_area
        self.sampled_force = force
        if duration > 0.0:
            self.elapsed = self.elapsed + duration
            self.mean_tension = self.mean_tension + (total - self.mean_tension) * duration / self.elapsed

    def panel_area(
        self,
        decay: float,
        p: list[float],
        low: float,
        force: float,
        area: float,
        high: float,
        end: float,
        end_area: float,
    ) -> float:
        """Integral of the tension over a piece of the way on which the force turns at most once."""
        growth = thread_growth(force, decay, p, low)
        if growth * thread_growth(end, decay, p, high) < 0.0:
            # it gets no farther than it would at the rate of the start
            tension = self.pretension + force
            bound = tension + growth * (high - low)
            if bound > self.highest_tension or bound < self.lowest_tension or bound * tension < 0.0:
                turn = thread_locate(True, 0.0, self.sampled_force, decay, p, low, high)
                there, there_area = thread_force(self.sampled_force, decay, p, turn)
                before = self.piece_area(decay, p, low, force, area, turn, there, there_area)
                return before + self.piece_area(decay, p, turn, there, there_area, high, end, end_area)
        return self.piece_area(decay, p, low, force, area, high, end, end_area)

    def piece_area(
        self,
        decay: float,
        p: list[float],
        low: float,
        force: float,
        area: float,
        high: float,
        end: float,
        end_area: float,
    ) -> float:
        """Integral of the tension over a piece on which it passes zero at most once; notes its end."""
        tension = self.pretension + force
        end_tension = self.pretension + end
        self.note(end_tension)
        if tension <= 0.0 and end_tension <= 0.0:
            return 0.0
        if tension < 0.0 or end_tension < 0.0:
            passed = thread_locate(False, -self.pretension, self.sampled_force, decay, p, low, high)
            _force, passed_area = thread_force(self.sampled_force, decay, p, passed)
            if tension < 0.0:
                return self.pretension * (high - passed) + end_area - passed_area
            return self.pretension * (passed - low) + passed_area - area
        return self.pretension * (high - low) + end_area - area

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
            a0, a1, a2, a3 = self.curve(lead, extension, rate, second)
            p = self.drive(lead, extension, a0, a1, a2, a3)
            start = force
            force, _area = thread_force(force, self.relaxation_rate * lead, p, 1.0)
            self.frame_work = self.sampled_work + self.work(lead, p, a0, a1, a2, a3, 0.0, start, 1.0, force)
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
