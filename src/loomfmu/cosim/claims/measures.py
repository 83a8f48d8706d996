"""Measures of a run by one signal: an extreme, a mean, a value at an angle, or an output that holds it.

Each is a claim without a bound: its verdict has the number as the worst value, with its numerical error.
"""

import math
import re
from dataclasses import replace

import numpy as np

from ... import units
from ...errors import LoomfmuError
from ...traces import Signals, Verdict
from .arguments import Name, Quantity, argument
from .bounded import Above, Below
from .claim import Claim
from .judging import Form, Question, needs_shaft, run_of
from .movers import Wired

FORMS = "'highest {0}', 'lowest {0}', 'mean {0}' or '{0} at 90 deg'"
_FORM = re.compile(r"(?:(highest|lowest|mean)\s+)?([^\s]+)(?:\s+at\s+(.+))?")


class Measure(Claim, kind=False):
    """A number that a signal gives; NaN where the signal is not known in part of the run."""

    signal: str = argument(Name())

    def signals(self, scene: Wired) -> list[str]:
        return [self.signal]

    def question(self, trace: Signals) -> Question:
        value, time = self.of(trace)
        value = value if _known(trace, self.signal) else math.nan
        form = Form("", self.signal, (trace.unit(self.signal), trace.display(self.signal)), self.sense)
        return Question("given", [form], [self.signal], [0.0, value, time, 1.0])

    def of(self, trace: Signals) -> tuple[float, float]:
        """The number, and its time where it has one. Raises LoomfmuError where the signal gives none."""
        raise NotImplementedError


class Highest(Below, kind=False):
    """The highest value of a signal, between the samples, too."""

    def judge(self, trace: Signals) -> Verdict:
        found = super().judge(trace)
        return found if _known(trace, self.signal) else replace(found, worst=math.nan)


class Lowest(Above, kind=False):
    """The lowest value of a signal, between the samples, too."""

    def judge(self, trace: Signals) -> Verdict:
        found = super().judge(trace)
        return found if _known(trace, self.signal) else replace(found, worst=math.nan)


class Mean(Measure, kind=False):
    """The mean of a signal over the time of the run."""

    def of(self, trace: Signals) -> tuple[float, float]:
        points, time = run_of(trace).points(trace, self.signal), trace.time
        # the mean of a polynomial is that of its Bernstein points
        total = float(np.sum(np.mean(points.T, axis=0) * np.diff(time)))
        return total / float(time[-1] - time[0]), math.nan


class At(Measure, kind=False):
    """The value of a signal where the shaft last stands at an angle of its revolution."""

    angle: float = argument(Quantity("rad", "deg"))

    def of(self, trace: Signals) -> tuple[float, float]:
        needs_shaft(trace)
        times = run_of(trace).stands_at(self.angle)
        if not times:
            where = units.show(self.angle, "deg")
            raise LoomfmuError(f"{self.signal} at {where}: the shaft does not pass this angle; run longer")
        return run_of(trace).at(trace, self.signal, times[-1]), times[-1]


class Held(Measure, kind=False):
    """The final value of an output that is constant or holds an extreme: it goes one way alone."""

    def of(self, trace: Signals) -> tuple[float, float]:
        values = np.asarray(trace[self.signal], dtype=float)
        steps = np.diff(values)
        declared = trace.beside(self.signal, "lowest") == self.signal  # its component knows, samples do not
        if not (declared or np.all(steps >= 0.0) or np.all(steps <= 0.0)):
            raise LoomfmuError(
                f"{self.signal} rises and falls in the run, so that its final value says little; write"
                f" {FORMS.format(self.signal)}"
            )
        return float(values[-1]), math.nan


def _known(trace: Signals, signal: str) -> bool:
    """Return whether a signal is known throughout the run."""
    flag = trace.validity(signal)
    return flag is None or bool(np.all(trace[flag]))


def signal_in(text: str) -> str:
    """The signal that a measure is of; an empty text for what is none."""
    found = _FORM.fullmatch(text.strip())
    return found.group(2) if found else ""


def measure(text: str, where: str = "") -> Claim:
    """The measure that a text such as "highest belt.deflection" states. Raises LoomfmuError."""
    found = _FORM.fullmatch(text.strip())
    way, signal, angle = found.groups() if found else (None, "", None)
    if not signal or (way and angle):
        raise LoomfmuError(f"{where}{text!r} is not one of {FORMS.format('SIGNAL')}")
    if angle:
        try:
            return At(signal=signal, angle=units.parse(angle, "rad"))
        except units.UnitError as error:
            raise LoomfmuError(f"{where}{text!r}: {error}") from None
    if way in ("highest", "lowest"):
        return (Highest if way == "highest" else Lowest)(
            signal=signal, bound=0.0, window=None, at_samples=False
        )
    return Mean(signal=signal) if way else Held(signal=signal)
