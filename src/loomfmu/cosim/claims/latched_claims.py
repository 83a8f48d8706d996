"""Claims on extremes that a component itself finds on its continuous curve, and keeps."""

import math

import numpy as np

from ... import units
from ...traces import Signals, Verdict
from .arguments import Name, Quantity, argument
from .claim import AT_MOST, FORCE, LANDINGS, LENGTH, NOTHING, VELOCITY, Claim, Landings
from .latches import reached

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
        worst, time = float(trace[latch][-1]), reached(trace, latch, trace[f"{self.belt}.margin"])
        note = NO_RISK if worst >= 1.0 else ""
        return self.verdict(trace, "lowest margin", latch, self.bound, worst, time, note)

    def landings(self, trace: Signals) -> Landings:
        return Landings([], [(f"{self.belt}.lowest_margin", 1.0)])


class BeltDeflection(Claim):
    """The belt in motion is never deflected farther than that."""

    at_most: float = argument(Quantity("m", "mm", low=0.0))
    belt: str = argument(Name(), "belt_motion")

    needs = (
        "belt.deflection",
        "belt.largest_deflection",
        "belt.largest_at_risk",
        "belt.folded",
        "belt.too_long",
    )
    sense, unit, grid = AT_MOST, LENGTH, NOTHING

    def judge(self, trace: Signals) -> Verdict:
        latch = f"{self.belt}.largest_deflection"
        worst, time = float(trace[latch][-1]), reached(trace, latch, -trace[f"{self.belt}.deflection"])
        pushed = units.show(float(trace[f"{self.belt}.largest_at_risk"][-1]), "mm")
        notes = [f"while the head was pushed: {pushed}"]
        if trace[f"{self.belt}.folded"][-1]:
            notes.append("the belt folded")
        if trace[f"{self.belt}.too_long"][-1]:
            notes.append("free lengths above 5 times bow_length do not count")
        text = "largest deflection"
        return self.verdict(trace, text, latch, self.at_most, worst, time, *notes)


class PeakLoad(Claim):
    """The force that a damper's carrier puts on its frame never exceeds a bound."""

    damper: str = argument(Name())
    at_most: float = argument(Quantity("N", low=0.0))

    needs = ("damper.transmitted_force", "damper.peak_load")
    sense, unit, grid = AT_MOST, FORCE, NOTHING

    def judge(self, trace: Signals) -> Verdict:
        latch, force = f"{self.damper}.peak_load", trace[f"{self.damper}.transmitted_force"]
        worst, time = float(trace[latch][-1]), reached(trace, latch, -np.abs(force))
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
