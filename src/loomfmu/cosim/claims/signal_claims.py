"""Claims on any signal: it stays on one side of a bound."""

import math
from typing import ClassVar

from ... import units
from ...errors import LoomfmuError
from ...traces import Signals, Verdict
from . import shaft
from .arguments import Bound, Edges, Flag, Name, Window, argument
from .claim import AT_LEAST, AT_MOST, LANDINGS, Claim, Landings
from .curves import Stretch, advised, motion_of
from .extremes import Extreme, lowest, lowest_sample
from .latches import latched
from .lifted import Wired
from .validity import gaps, known_within

NO_SAMPLE = "no sample lies in that window; take more steps"


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

    grid = LANDINGS
    text: ClassVar[str]

    def signals(self, scene: Wired) -> list[str]:
        return [self.signal]

    def parameter_owners(self) -> list[str]:
        return [self.bound.partition(".")[0]] if isinstance(self.bound, str) else []

    def judge(self, trace: Signals) -> Verdict:
        limit = self._limit(trace)
        (within, unknown), text = self._known(trace), self.text
        text += " at the samples" * self.at_samples + (f" {self.window.words}" if self.window else "")
        found, note = self._extreme(trace, within)
        worst, floor = self.sense * found.value, self.sense * limit
        nowhere = within == [] and bool(unknown)
        verdict = self.verdict(
            trace,
            text,
            self.signal,
            limit,
            found.value,
            found.time,
            note,
            found.note,
            holds=nowhere or self.sense * found.sure >= floor,
            unit=(trace.unit(self.signal), trace.display(self.signal)),
            unknown=unknown,
        )
        if not verdict or self.sense * found.possible >= floor:
            return verdict
        # the bound lies within what the curve between the samples may be off
        off = max(worst - self.sense * found.possible, floor - worst)
        return verdict.estimated(off, off)

    def unresolved(self, trace: Signals, verdict: Verdict) -> float:
        found, _note = self._extreme(trace, self.within(trace))
        sure = found.sure if math.isfinite(found.sure) else found.value
        curve = max(abs(found.value - found.possible), abs(found.value - sure))
        return max(curve, self.left_by_model(trace, verdict))

    def _extreme(self, trace: Signals, within: list[Stretch] | None) -> tuple[Extreme, str]:
        """The worst value, and a note on how it is known."""
        if within == []:
            return Extreme(math.nan, math.nan), ""
        motion = motion_of(trace, self.signal)
        if self.at_samples:
            found = lowest_sample(motion, self.sense, within)
            return found._replace(possible=found.sure), "" if math.isfinite(found.time) else NO_SAMPLE
        found = lowest(motion, self.sense, within)
        extreme, note = latched(trace, self.signal, self.sense, found, within)
        return extreme, advised(note)

    def unseen(self, trace: Signals) -> str:
        return shaft.short(trace) if self.window is None else shaft.unpassed(trace, self.window)

    def within(self, trace: Signals) -> list[Stretch] | None:
        return self._known(trace)[0]

    def _known(self, trace: Signals) -> tuple[list[Stretch] | None, list[Stretch]]:
        """Return the stretches in which the signal is judged, None for all, and those where it is unknown."""
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
