"""Claims on extremes that a component itself finds on its continuous curve, and keeps."""

import math

import numpy as np

from ... import units
from ...traces import Signals, Verdict
from .arguments import Name, Quantity, argument
from .claim import AT_MOST, FORCE, LANDINGS, LENGTH, NOTHING, VELOCITY, Claim, Landings
from .curves import Floats

ALIKE = 1e-8  # of the largest value: latched extremes that coarse steps alone tell apart; names places only
CLAMPED_END = 1e-2  # of the deflection: what six modes leave where an end of the belt may be clamped
NO_RISK = "the belt is never at risk in this run"


class LowestMargin(Claim):
    """The belt's margin against buckling never falls below a bound."""

    bound: float = argument(Quantity("1"))
    belt: str = argument(Name(), "belt")

    needs = ("belt.margin", "belt.lowest_margin")
    grid = LANDINGS
    noise = 3e-9  # of the critical force: what the monitor takes for noise of its samples

    def judge(self, trace: Signals) -> Verdict:
        latch = f"{self.belt}.lowest_margin"
        worst, time = float(trace[latch][-1]), _reached(trace, latch, trace[f"{self.belt}.margin"])
        note = NO_RISK if worst >= 1.0 else ""
        return self.verdict(trace, "lowest margin", latch, self.bound, worst, time, note)

    def landings(self, trace: Signals) -> Landings:
        return Landings([], [(f"{self.belt}.lowest_margin", 1.0)])


class BeltDeflection(Claim):
    """The belt in motion is never deflected farther than that."""

    at_most: float = argument(Quantity("m", "mm", low=0.0))
    belt: str = argument(Name(), "belt_motion")

    needs = (
        "belt.deflection", "belt.largest_deflection", "belt.largest_at_risk", "belt.folded", "belt.too_long",
    )  # fmt: skip
    sense, unit, grid = AT_MOST, LENGTH, NOTHING
    resolved = 1e-4  # six modes and the integration steps inside, which the steps of a run do not show

    def judge(self, trace: Signals) -> Verdict:
        latch = f"{self.belt}.largest_deflection"
        worst, time = float(trace[latch][-1]), _reached(trace, latch, -trace[f"{self.belt}.deflection"])
        pushed = units.show(float(trace[f"{self.belt}.largest_at_risk"][-1]), "mm")
        notes = [f"while the head was pushed: {pushed}"]
        if trace[f"{self.belt}.folded"][-1]:
            notes.append("the belt folded")
        if trace[f"{self.belt}.too_long"][-1]:
            notes.append("free lengths above 5 times bow_length do not count")
        text = "largest deflection"
        return self.verdict(trace, text, latch, self.at_most, worst, time, *notes)

    def unresolved(self, trace: Signals, verdict: Verdict) -> float:
        """The modes leave more where an end of the belt may be clamped."""
        ends = (trace.parameter(f"{self.belt}.{end}") for end in ("guide_end", "head_end"))
        share = CLAMPED_END if any(end > 1.0 for end in ends) else 0.0
        return max(super().unresolved(trace, verdict), share * verdict.worst)


class PeakLoad(Claim):
    """The force that a damper's carrier puts on its frame never exceeds a bound."""

    damper: str = argument(Name())
    at_most: float = argument(Quantity("N", low=0.0))

    needs = ("damper.transmitted_force", "damper.peak_load")
    sense, unit, grid = AT_MOST, FORCE, NOTHING

    def judge(self, trace: Signals) -> Verdict:
        latch, force = f"{self.damper}.peak_load", trace[f"{self.damper}.transmitted_force"]
        worst, time = float(trace[latch][-1]), _reached(trace, latch, -np.abs(force))
        return self.verdict(trace, "peak load", latch, self.at_most, worst, time)


class StopContacts(Claim):
    """A damper's carrier touches its stops no more often than that; the place is that of the last contact."""

    damper: str = argument(Name())
    at_most: float = argument(Quantity("1", low=0.0))

    needs = ("damper.stop_contacts",)
    sense, grid = AT_MOST, NOTHING

    def judge(self, trace: Signals) -> Verdict:
        counter = f"{self.damper}.stop_contacts"
        counted = trace[counter]
        worst = float(counted[-1])
        time = float(trace.time[np.argmax(counted == counted[-1])]) if worst > 0.0 else math.nan
        return self.verdict(trace, "stop contacts", counter, self.at_most, worst, time)


class HealdBlows(Claim):
    """No blow of a heald in its play is faster than that; the place is that of the hardest one."""

    play: str = argument(Name())
    at_most: float = argument(Quantity("m/s", low=0.0))

    needs = ("play.hardest_blow", "play.blows")
    sense, unit, grid = AT_MOST, VELOCITY, NOTHING

    def judge(self, trace: Signals) -> Verdict:
        latch = f"{self.play}.hardest_blow"
        hardest, blows = trace[latch], int(trace[f"{self.play}.blows"][-1])
        worst = float(hardest[-1])
        time = float(trace.time[np.argmax(hardest == worst)]) if blows else math.nan
        return self.verdict(
            trace, "hardest blow", latch, self.at_most, worst, time, f"{blows} blow{'s' * (blows != 1)}"
        )


def _reached(trace: Signals, latch: str, followed: Floats) -> float:
    """When a latched extreme was reached, as well as the samples show it.

    The latch gives the step. Within it, the time is the vertex of the parabola through the lowest samples of
    what the latch follows.

    Args:
        latch: the signal that keeps the extreme
        followed: samples of what it follows, with a sign by which the extreme is the lowest
    """
    time, latched = trace.time, trace[latch]
    largest = max(float(followed.max()), -float(followed.min()))
    step = int(np.argmax(np.abs(latched - latched[-1]) <= ALIKE * largest))
    if step == 0:
        return float(time[0])
    lowest = step if followed[step] <= followed[step - 1] else step - 1
    if not 0 < lowest < len(time) - 1:
        return float(time[lowest])
    (t0, t1, t2), (y0, y1, y2) = (each[lowest - 1 : lowest + 2].tolist() for each in (time, followed))
    before, after = (y1 - y0) / (t1 - t0), (y2 - y1) / (t2 - t1)
    if after <= before:
        return float(t1)
    turn = 0.5 * (t0 + t1) - 0.5 * before * (t2 - t0) / (after - before)
    return float(min(max(turn, time[step - 1]), time[step]))
