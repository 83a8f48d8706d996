"""Claims on any signal: it stays on one side of a bound."""

import math
from collections.abc import Iterable
from dataclasses import replace
from typing import ClassVar

from ... import units
from ...errors import LoomfmuError
from ...traces import Signals, Verdict
from . import shaft
from .arguments import Bound, Edges, Name, Window, argument
from .claim import AT_LEAST, AT_MOST, LANDINGS, Claim, Landings
from .curves import Stretch, motion_of
from .extremes import Extreme, lowest
from .latches import beyond_found, latched
from .validity import gaps, known_within


class Bounded(Claim, kind=False):
    """A signal stays on one side of a bound: over the whole run, or in a window of shaft angles.

    The bound is a quantity, or the name of a parameter of the run, such as "shaft.speed".
    """

    signal: str = argument(Name())
    bound: float | str = argument(Bound())
    window: Window | None = argument(Edges("rad", "deg", usual=1.5), None)

    grid = LANDINGS
    text: ClassVar[str]

    def signals(self, instances: Iterable[str]) -> list[str]:
        return [self.signal]

    def parameter_owners(self) -> list[str]:
        return [self.bound.partition(".")[0]] if isinstance(self.bound, str) else []

    def judge(self, trace: Signals) -> Verdict:
        limit = self._limit(trace)
        unit = (trace.unit(self.signal), trace.display(self.signal))
        text, (within, unknown) = self.text, self._known(trace)
        nowhere = within == []
        if self.window is not None:
            text += f" {self.window.words}"
            if nowhere and not unknown:
                reason = "the run never enters that window"
                return self.verdict(trace, text, self.signal, limit, math.nan, math.nan, reason, unit=unit)
        motion = motion_of(trace, self.signal)
        worst = Extreme(math.nan, math.nan) if nowhere else lowest(motion, self.sense, within)
        worst, note = latched(trace, self.signal, self.sense, worst, within)
        found = self.verdict(
            trace, text, self.signal, limit, worst.value, worst.time, note, worst.note,
            holds=nowhere or self.sense * worst.sure >= self.sense * limit, unit=unit, unknown=unknown,
        )  # fmt: skip
        if found and found.distance < 0.0:
            doubt = found.displayed(motion.doubt_at(worst.time))
            label = "" if found.label == "1" else f" {found.label}"
            note = f"passes the bound only between samples, where the curve may be off by {doubt:.1e}{label}"
            return replace(found, note="; ".join(filter(None, (found.note, note))))
        return found

    def between(self, trace: Signals, verdict: Verdict) -> float:
        found = Extreme(verdict.worst, verdict.time)
        return beyond_found(trace, self.signal, self.sense, found, self.within(trace))

    def within(self, trace: Signals) -> list[Stretch] | None:
        return self._known(trace)[0]

    def _known(self, trace: Signals) -> tuple[list[Stretch] | None, list[Stretch]]:
        """When the signal is judged, None for the whole run, and when it is not known."""
        within = None if self.window is None else shaft.times_within(trace, self.window)
        unknown = gaps(trace, self.signal, within)
        return (known_within(trace, unknown, within) if unknown else within), unknown

    def _limit(self, trace: Signals) -> float:
        if not isinstance(self.bound, str):
            return self.bound
        limit = trace.parameter(self.bound)
        check_speed(self.bound, limit, trace.unit(self.signal))
        return limit

    def landings(self, trace: Signals) -> Landings:
        times = [time for edge in self.window or () for time in shaft.times_at(trace, edge)]
        return Landings(times, [(self.signal, self.sense)])


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
            f"claim: bound {parameter} = {units.show(value, 'rev/min')} is negative, but a limit of speed"
            f' is positive; write the speed itself, such as bound = "{units.show(-value, "rev/min")}"'
        )
