"""What became of a claim."""

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from .. import units
from ..traces import Signals

TURN = 2.0 * math.pi


@dataclass(frozen=True)
class Verdict:
    """What became of a claim; true where it holds. Values are in SI, `unit` the one to show them in."""

    claim: str
    signal: str
    holds: bool
    bound: float
    worst: float
    unit: str
    time: float
    angle: float
    revolution: int
    note: str = ""

    def __bool__(self) -> bool:
        return self.holds

    def __str__(self) -> str:
        word = "holds" if self.holds else "FAILS"
        where = ""
        if math.isfinite(self.time):
            angle = f"{math.degrees(self.angle):.3f} deg"
            where = f" at {self.time:.6g} s, {angle} of revolution {self.revolution}"
        note = f" ({self.note})" if self.note else ""
        return (
            f"{word}: {self.claim}: {self.signal} = {units.show(self.worst, self.unit)}{where},"
            f" bound {units.show(self.bound, self.unit)}{note}"
        )

    def as_dict(self) -> dict[str, Any]:
        """The verdict for JSON: what is not finite becomes null."""
        return {
            key: None if isinstance(value, float) and not math.isfinite(value) else value
            for key, value in asdict(self).items()
        }


def verdict(
    trace: Signals, claim: str, signal: str, holds: bool, bound: float, worst: float, unit: str, time: float,
    note: str = "",
) -> Verdict:  # fmt: skip
    """A verdict with the place on the shaft that belongs to its time."""
    angle = float(np.interp(time, trace.time, trace.shaft_angle)) if math.isfinite(time) else math.nan
    turns = math.floor(angle / TURN) if math.isfinite(angle) else 0
    return Verdict(
        claim, signal, bool(holds), bound, worst, unit, time, angle - TURN * turns, turns + 1, note
    )
