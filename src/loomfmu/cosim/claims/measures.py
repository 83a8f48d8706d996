"""Measures of a run by one signal: an extreme, a mean, a value at an angle, or an output that holds it.

Each is a claim without a bound: its verdict has the number as the worst value, with its numerical error.
"""

import math
import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ... import units
from ...errors import LoomfmuError
from ...traces import Signals, Verdict
from .arguments import Name, Quantity, argument
from .bounded import Above, Below, Bounded
from .claim import Claim
from .expression_claims import AboveExpression, BelowExpression
from .expressions import UnitOf, is_expression
from .expressions import read as read_expression
from .judging import Form, Question, needs_shaft, run_of
from .movers import Wired

FORMS = "'highest {0}', 'lowest {0}', 'mean {0}' or '{0} at 90 deg'"
_FORM = re.compile(r"(?:(highest|lowest|mean)\s+)?(.+?)(?:\s+at\s+(.+))?")


class Measure(Claim, kind=False):
    """A number that a signal gives; NaN where the signal is not known in part of the run."""

    signal: str = argument(Name())

    def signals(self, scene: Wired) -> list[str]:
        return [self.signal]

    def question(self, trace: Signals) -> Question:
        value, time = self.of(trace)
        value = value if _known(trace, [self.signal]) else math.nan
        form = Form("", self.signal, (trace.unit(self.signal), trace.display(self.signal)), self.sense)
        return Question("given", [form], [self.signal], [0.0, value, time, 1.0])

    def of(self, trace: Signals) -> tuple[float, float]:
        """The number, and its time where it has one. Raises LoomfmuError where the signal gives none."""
        raise NotImplementedError


class _Extreme(Claim, kind=False):
    """The highest or lowest value of a signal or an expression, between the samples, too."""

    def judge(self, trace: Signals) -> Verdict:
        found = super().judge(trace)
        return found if _known(trace, self.signals(trace)) else replace(found, worst=math.nan)


class _Highest(_Extreme, Below, kind=False):
    """The highest value of a signal."""


class _Lowest(_Extreme, Above, kind=False):
    """The lowest value of a signal."""


class _HighestOfExpression(_Extreme, BelowExpression, kind=False):
    """The highest value of an expression."""


class _LowestOfExpression(_Extreme, AboveExpression, kind=False):
    """The lowest value of an expression."""


EXTREMES: dict[str, tuple[type[Below | Above], type[BelowExpression | AboveExpression]]] = {
    "highest": (_Highest, _HighestOfExpression),
    "lowest": (_Lowest, _LowestOfExpression),
}


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


def _known(trace: Signals, signals: Sequence[str]) -> bool:
    """Return whether signals are known throughout the run."""
    flags = {flag for each in signals if (flag := trace.validity(each))}
    return all(np.all(trace[flag]) for flag in flags)


def signal_in(text: str) -> str:
    """The signal, or the expression, that a measure is of; an empty text for what is none."""
    found = _FORM.fullmatch(text.strip())
    return found.group(2) if found else ""


def measure(text: str, unit_of: UnitOf, where: str = "") -> Measure | Bounded:
    """The measure that a text such as "highest belt.deflection" states. Raises LoomfmuError."""
    found = _FORM.fullmatch(text.strip())
    way, signal, angle = found.groups() if found else (None, "", None)
    expressed = is_expression(signal)
    if (way and angle) or (not expressed and (not signal or " " in signal)):
        raise LoomfmuError(f"{where}{text!r} is not one of {FORMS.format('SIGNAL')}")
    if expressed and way not in EXTREMES:
        raise LoomfmuError(f"{where}{text!r}: of an expression, write 'highest ...' or 'lowest ...'")
    if angle:
        try:
            return At(signal=signal, angle=units.parse(angle, "rad"))
        except units.UnitError as error:
            raise LoomfmuError(f"{where}{text!r}: {error}") from None
    if way in EXTREMES:
        kind = EXTREMES[way][expressed]
        of = read_expression(signal, unit_of, where.removesuffix(": ") or "measure") if expressed else signal
        return kind(signal=of, bound=0.0, window=None, at_samples=False)
    return Mean(signal=signal) if way else Held(signal=signal)
