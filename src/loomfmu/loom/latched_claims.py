"""Claims on extremes that a component itself finds on its continuous curve, and keeps."""

from ..cosim.claims.arguments import Name, Quantity, argument
from ..cosim.claims.claim import AT_MOST, FORCE, LENGTH, VELOCITY, Claim
from ..cosim.claims.conditions import Condition, above
from ..cosim.claims.judging import Question
from ..cosim.claims.movers import Wired
from ..traces import Signals

AS_IT_IS, NEGATIVE, MAGNITUDE = range(3)  # how the extreme of what a latch follows is its lowest value


class LowestMargin(Claim):
    """The belt's margin against buckling never falls below a bound."""

    bound: float = argument(Quantity("1"))
    belt: str = argument(Name(), "belt")

    needs = ("belt.margin", "belt.lowest_margin")
    noise = 3e-9  # of the critical force: what the monitor takes for noise of its samples

    def question(self, trace: Signals) -> Question:
        latch = f"{self.belt}.lowest_margin"
        signals = [latch, f"{self.belt}.margin"]
        return Question("margin", [self.form("lowest margin", latch)], signals, [self.bound, AS_IT_IS])

    def extremes(self) -> list[tuple[str, float]]:
        return [(f"{self.belt}.lowest_margin", 1.0)]

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        return (above(f"{self.belt}.margin", self.bound),)


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
    sense, unit = AT_MOST, LENGTH

    def question(self, trace: Signals) -> Question:
        names = ("largest_deflection", "deflection", "largest_at_risk", "folded", "too_long")
        signals = [f"{self.belt}.{name}" for name in names]
        form = self.form("largest deflection", signals[0])
        return Question("deflection", [form], signals, [self.at_most, NEGATIVE])


class PeakLoad(Claim):
    """The force that a damper's carrier puts on its frame never exceeds a bound."""

    damper: str = argument(Name())
    at_most: float = argument(Quantity("N", low=0.0))

    needs = ("damper.transmitted_force", "damper.peak_load")
    sense, unit = AT_MOST, FORCE

    def question(self, trace: Signals) -> Question:
        latch = f"{self.damper}.peak_load"
        signals = [latch, f"{self.damper}.transmitted_force"]
        return Question("held", [self.form("peak load", latch)], signals, [self.at_most, MAGNITUDE])


class StopContacts(Claim):
    """A damper's carrier touches its stops no more often than that; the place is that of the last contact."""

    damper: str = argument(Name())
    at_most: float = argument(Quantity("1", low=0.0))

    needs = ("damper.stop_contacts",)
    sense = AT_MOST

    def question(self, trace: Signals) -> Question:
        counter = f"{self.damper}.stop_contacts"
        return Question("contacts", [self.form("stop contacts", counter)], [counter], [self.at_most])


class HealdBlows(Claim):
    """No blow of a heald in its play is faster than that; the place is that of the hardest one."""

    play: str = argument(Name())
    at_most: float = argument(Quantity("m/s", low=0.0))

    needs = ("play.hardest_blow", "play.blows")
    sense, unit = AT_MOST, VELOCITY

    def question(self, trace: Signals) -> Question:
        latch = f"{self.play}.hardest_blow"
        signals = [latch, f"{self.play}.blows"]
        return Question("blows", [self.form("hardest blow", latch)], signals, [self.at_most])
