"""Claims on any signal: it stays on one side of a bound.

Values between the samples count: a signal whose rate is recorded follows the cubic that joins its samples,
and if the rate's rate is recorded, too, the quintic of value, velocity and acceleration. If no rate is
recorded, the verdict's note says so. A claim still holds if only the curve between two samples passes the
bound, and by no more than it may be off there; the note says so.
"""

from typing import ClassVar

from ... import units
from ...errors import LoomfmuError, shown, within
from ...traces import Signals
from .arguments import Bound, Edges, Flag, Name, Window, argument
from .claim import AT_LEAST, AT_MOST, Claim
from .conditions import Condition, Unprovable, above, present
from .judging import Form, Question, needs_shaft
from .movers import Wired


class Bounded(Claim, kind=False):
    """A signal stays on one side of a bound: over the whole run, or in a window of shaft angles.

    The bound is a quantity, or the name of a parameter of the run, such as "shaft.speed". With `at_samples`
    the samples alone are judged; otherwise a claim that holds at all samples of a signal whose values between
    them are not known is undecided.
    """

    signal: str = argument(Name())
    bound: float | str = argument(Bound())
    window: Window | None = argument(Edges("rad", "deg", usual=1.5), None)
    at_samples: bool = argument(Flag(), False)

    text: ClassVar[str]

    @property
    def place(self) -> str:
        """Its name in messages."""
        return f"claim {shown(self.name)}" if self.name else f"claim on {self.signal}"

    def signals(self, scene: Wired) -> list[str]:
        return [self.signal]

    def unit_in(self, run: Wired) -> str:
        """Return the unit of what it judges."""
        return run.unit(self.signal)

    def parameter_owners(self) -> list[str]:
        return [self.bound.partition(".")[0]] if isinstance(self.bound, str) else []

    def question(self, trace: Signals) -> Question:
        text, window = self.text + " at the samples" * self.at_samples, [0.0, 0.0, 0.0]
        if self.window:
            needs_shaft(trace)
            text += f" {self.window.words}"
            window = [1.0, self.window.start, self.window.width]
        a_speed = isinstance(self.bound, str) and trace.unit(self.signal) == "rad/s"
        if isinstance(self.bound, str):
            with within(self.place):
                check_speed(self.bound, trace.parameter(self.bound), trace.unit(self.signal))
        form = Form(text, self.signal, (trace.unit(self.signal), trace.display(self.signal)), self.sense)
        numbers = [self.bound, float(self.at_samples), *window, float(a_speed)]
        return Question("bounded", [form], [self.signal], numbers)

    def extremes(self) -> list[tuple[str, float]]:
        return [] if self.at_samples else [(self.signal, self.sense)]

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        signal = present(self.signal, run, self.sense)
        if self.window and signal != self.signal:
            raise Unprovable(f"{self.signal} holds what was before the window")
        return (above(signal, self.bound, self.sense, self.window),)


class Above(Bounded):
    """A signal stays at or above a bound."""

    text, sense = "lowest value", AT_LEAST


class Below(Bounded):
    """A signal stays at or below a bound."""

    text, sense = "highest value", AT_MOST


def check_speed(parameter: str, value: float, unit: str) -> None:
    """Refuse a negative speed as a bound: signals that are limits of speed are never negative."""
    if unit == "rad/s" and value < 0.0:
        raise LoomfmuError(
            f"bound {parameter} = {units.show(value, 'rev/min')} is negative, but a limit of speed"
            f' is positive; write the speed itself, such as bound = "{units.show(-value, "rev/min")}"'
        )
