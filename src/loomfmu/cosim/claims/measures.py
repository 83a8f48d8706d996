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
from . import shaft
from .arguments import Name, Quantity, argument
from .claim import Claim
from .curves import motion_of
from .lifted import Wired
from .signal_claims import Above, Below
from .validity import gaps

FORMS = "'highest {0}', 'lowest {0}', 'mean {0}' or '{0} at 90 deg'"
_FORM = re.compile(r"(?:(highest|lowest|mean)\s+)?([^\s]+)(?:\s+at\s+(.+))?")


class Measure(Claim, kind=False):
    """A number that a signal gives; NaN where the signal is not known in part of the run."""

    signal: str = argument(Name())

    def signals(self, scene: Wired) -> list[str]:
        return [self.signal]

    def judge(self, trace: Signals) -> Verdict:
        value, time = self.of(trace)
        value = math.nan if gaps(trace, self.signal) else value
        unit = (trace.unit(self.signal), trace.display(self.signal))
        return self.verdict(trace, "", self.signal, 0.0, value, time, holds=True, unit=unit, unknown=())

    def of(self, trace: Signals) -> tuple[float, float]:
        """The number, and its time where it has one. Raises LoomfmuError where the signal gives none."""
        raise NotImplementedError


class Highest(Below, kind=False):
    """The highest value of a signal, between the samples, too."""

    def judge(self, trace: Signals) -> Verdict:
        found = super().judge(trace)
        return replace(found, worst=math.nan) if gaps(trace, self.signal) else found


class Lowest(Above, kind=False):
    """The lowest value of a signal, between the samples, too."""

    def judge(self, trace: Signals) -> Verdict:
        found = super().judge(trace)
        return replace(found, worst=math.nan) if gaps(trace, self.signal) else found


class Mean(Measure, kind=False):
    """The mean of a signal over the time of the run."""

    def of(self, trace: Signals) -> tuple[float, float]:
        motion = motion_of(trace, self.signal)
        intervals = np.arange(len(motion.time) - 1)
        # the mean of a polynomial is that of its Bernstein points
        total = float(np.sum(np.mean(motion.points(intervals), axis=0) * motion.length(intervals)))
        return total / float(motion.time[-1] - motion.time[0]), math.nan


class At(Measure, kind=False):
    """The value of a signal where the shaft last stands at an angle of its revolution."""

    angle: float = argument(Quantity("rad", "deg"))

    def of(self, trace: Signals) -> tuple[float, float]:
        times = shaft.times_at(trace, self.angle)
        if not times:
            where = units.show(self.angle, "deg")
            raise LoomfmuError(f"{self.signal} at {where}: the shaft does not pass this angle; run longer")
        return motion_of(trace, self.signal).at(times[-1]), times[-1]


class Held(Measure, kind=False):
    """The final value of an output that is constant or holds an extreme: it goes one way alone."""

    def of(self, trace: Signals) -> tuple[float, float]:
        values = np.asarray(trace[self.signal], dtype=float)
        steps = np.diff(values)
        if not (np.all(steps >= 0.0) or np.all(steps <= 0.0)):
            raise LoomfmuError(
                f"{self.signal} rises and falls in the run, so that its final value says little; write"
                f" {FORMS.format(self.signal)}"
            )
        return float(values[-1]), math.nan


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
