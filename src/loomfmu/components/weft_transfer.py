"""WeftTransfer: where the heads of both rapiers meet, and how fast they pass each other."""

from dataclasses import dataclass
from math import inf
from typing import ClassVar

from ..declaring.declarations import at_step_end, indicator, output, parameter
from ..declaring.variables import NOTHING, Component, Terminal
from ..physics.shaft import carried
from .quantities import DISTANCE, LENGTH, TRAVEL
from .shared_declarations import head_acceleration, head_travel, head_velocity
from .terminals import GIVER, TAKER

BRINGS, TAKES = "the head that brings the weft", "the head that takes the weft"


@dataclass(slots=True)
class WeftTransfer(Component):
    """Weft transfer: overlap of the giver's and the taker's head in mid-shed, closing velocity, hand-over."""

    keeps: ClassVar[str] = NOTHING
    longest_turn: ClassVar[float] = inf
    terminals: ClassVar[tuple[Terminal, ...]] = (
        GIVER.of("giver_travel", "giver_velocity", "giver_acceleration"),
        TAKER.of("taker_travel", "taker_velocity", "taker_acceleration"),
    )

    separation: float = parameter(
        TRAVEL.within(0.0, 100.0),
        4.086,
        "Distance between the tips of the heads at their outer dead centres (identified)",
    )
    needed_overlap: float = parameter(
        DISTANCE, 0.04, "Overlap that the hooks need to hand the weft over (assumed: none is published)"
    )
    inputs_at_step_end: bool = at_step_end()
    giver_travel: float = head_travel(2.0953, BRINGS, "giver_", "weft")
    giver_velocity: float = head_velocity(BRINGS, "giver_", "weft")
    giver_acceleration: float = head_acceleration(0.0, BRINGS, "weft")
    taker_travel: float = head_travel(2.0953, TAKES, "taker_", "weft_2")
    taker_velocity: float = head_velocity(TAKES, "taker_", "weft_2")
    taker_acceleration: float = head_acceleration(0.0, TAKES, "weft_2")
    overlap: float = output(
        LENGTH,
        "How far the heads have passed each other; negative while they are apart",
        rate="closing_velocity",
    )
    closing_velocity: float = output(
        "m/s",
        "Velocity of the heads relative to each other, positive while they approach",
        nominal=10.0,
        rate="closing_acceleration",
    )
    closing_acceleration: float = output(
        "m/s2", "Acceleration of the heads relative to each other", nominal=1000.0
    )
    offset: float = output(
        LENGTH,
        "Middle between the tips of the heads, from mid-shed towards the taker's side",
        rate="offset_velocity",
    )
    offset_velocity: float = output("m/s", "Rate of offset")
    engaged: bool = output("1", "The overlap is at least needed_overlap", start=False)
    engaged_event: float = indicator("m", "Passes zero where the hand-over begins or ends")

    def initialize(self, time: float) -> int:
        """Place the heads."""
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Follow both heads: a function of their motion alone."""
        lead = 0.0 if self.inputs_at_step_end else step_size
        giver = carried(self.giver_travel, self.giver_velocity, self.giver_acceleration, lead)
        taker = carried(self.taker_travel, self.taker_velocity, self.taker_acceleration, lead)
        giver_velocity = self.giver_velocity + self.giver_acceleration * lead
        taker_velocity = self.taker_velocity + self.taker_acceleration * lead
        self.overlap = giver + taker - self.separation
        self.closing_velocity = giver_velocity + taker_velocity
        self.closing_acceleration = self.giver_acceleration + self.taker_acceleration
        self.offset = 0.5 * (giver - taker)
        self.offset_velocity = 0.5 * (giver_velocity - taker_velocity)
        self.engaged_event = self.overlap - self.needed_overlap
        self.engaged = self.overlap >= self.needed_overlap
        return 0
