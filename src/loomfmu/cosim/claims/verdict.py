"""What becomes of a claim: its verdict, with the place on the shaft."""

import math

from ...traces import Signals, Verdict
from . import curves

__all__ = ["ANGLE", "FORCE", "LENGTH", "ONE", "PERCENT", "SPEED", "Verdict", "verdict"]

# units of what is judged: that of the numbers, and the one that people read them in
ONE, PERCENT, ANGLE = ("1", "1"), ("1", "%"), ("rad", "deg")
LENGTH, FORCE, SPEED = ("m", "mm"), ("N", "N"), ("rad/s", "rev/min")


def verdict(
    trace: Signals, claim: str, signal: str, holds: bool, bound: float, worst: float,
    unit: tuple[str, str], time: float, *notes: str,
) -> Verdict:  # fmt: skip
    """A verdict with the place on the shaft that belongs to its time; `unit` as in `ONE`.

    It does not hold on samples that are too far apart to tell how a loom moves.
    """
    shaft = curves.shaft(trace)
    angle, revolution = math.nan, None
    if shaft is not None and math.isfinite(time):
        angle, revolution = curves.on_the_shaft(shaft, time)
    if shaft is not None and curves.too_coarse(shaft):
        holds, notes = False, (*notes, curves.COARSE_NOTE)
    note = "; ".join(dict.fromkeys(note for note in notes if note))
    return Verdict(claim, signal, bool(holds), bound, worst, *unit, time, angle, revolution, note)
