"""Computed curves at the places of measured ones."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...errors import LoomfmuError
from ...traces import Signals
from .measured import Measured

Floats = NDArray[np.float64]
TURN = 2.0 * math.pi
ROUNDING = 1e-9  # of a turn, of the time, or of the largest value
EXACT = 1e-4  # of the largest value: an interpolation as good needs no word
COARSE = 0.1  # of the difference from the measurement: an error of the interpolation as large is noted
UNEXPLAINED = 0.3  # share of the variation that may remain
REFINED = 15.0  # a cubic's error at every second sample, less that at all of them, in errors at all


@dataclass(frozen=True)
class Compared:
    """A signal (SI) at the places where it was measured, shape (n,): measured and computed.

    `drift` is what the computed one changes by along the places, per rad or per s.
    """

    signal: str
    unit: str
    factor: float
    along: Floats
    measured: Floats
    computed: Floats
    drift: Floats
    interpolation: float

    @property
    def rms(self) -> float:
        """Root mean square of the difference."""
        return float(np.sqrt(np.mean((self.computed - self.measured) ** 2)))

    @property
    def share(self) -> float:
        """The difference as a share of the measured values' standard deviation; 0 or inf of constants."""
        spread, least = float(np.std(self.measured)), ROUNDING * float(np.max(np.abs(self.measured)))
        if spread > least:
            return self.rms / spread
        return 0.0 if self.rms <= least else math.inf

    @property
    def explained(self) -> bool:
        """Return whether enough of the measurement is explained for the fit to be of use."""
        return self.share <= UNEXPLAINED

    @property
    def note(self) -> str:
        """Return a warning about the interpolation between samples, or an empty text."""
        if self.interpolation <= max(COARSE * self.rms, EXACT * float(np.max(np.abs(self.measured)))):
            return ""
        off, rest = (f"{value / self.factor:.2g} {self.unit}" for value in (self.interpolation, self.rms))
        return f"{self.signal}: interpolation is off by {off} where {rest} remain; take more steps"


def compared(data: Measured, run: Signals, offset: float = 0.0) -> list[Compared]:
    """The measured curves beside those of a run, by cubic splines through its samples.

    The `offset` is added to the places, [rad] or [s]. Raises LoomfmuError where the run does not reach what
    was measured.
    """
    from scipy.interpolate import CubicSpline

    axis = run.shaft_angle if data.over == "shaft_angle" else run.time
    if data.over == "shaft_angle" and not run.turns:
        raise LoomfmuError(
            f"{data.path}: it is measured over the shaft angle, but {run.standing} in this scene"
        )
    places = _places(data, axis, offset)
    found = []
    for signal, values in data.columns.items():
        here = np.isfinite(values)
        curve = CubicSpline(axis, run[signal])
        fine, drift = curve(places[here]), curve(places[here], 1)
        coarse = CubicSpline(axis[::2], run[signal][::2])(places[here]) if len(axis) > 8 else fine
        off = float(np.sqrt(np.mean((fine - coarse) ** 2))) / REFINED if here.any() else 0.0
        factor, unit = run.displayed(signal)
        found.append(Compared(signal, unit, factor, data.along[here], values[here], fine, drift, off))
    return found


LONGER = "let it go on for longer"


def _places(data: Measured, axis: Floats, offset: float) -> Floats:
    """Return the measured places on the run's own axis."""
    places, one, unit = data.along, 1.0, "s"
    if data.over == "shaft_angle":
        one, unit = math.radians(1.0), "deg"
        low, high = float(np.min(places)), float(np.max(places))
        # angles within a revolution: the last whole one, in which what was at rest at the start has settled;
        # one before it may be another pick of the weave
        turns = math.floor(axis[-1] / TURN + ROUNDING) - 1
        if low >= 0.0 and high <= TURN * (1.0 + ROUNDING) and TURN * (turns + ROUNDING) >= axis[0]:
            places = TURN * turns + places
    slack = ROUNDING * max(abs(axis[0]), abs(axis[-1]))
    for shift in (offset, *data.shifts):  # all that the fit may try, before it does
        if places.min() + shift < axis[0] - slack or places.max() + shift > axis[-1] + slack:
            measured = f"{places.min() / one:.6g} to {places.max() / one:.6g} {unit}"
            moved = f", with an offset of {shift / one:.6g} {unit}" if shift else ""
            before = places.min() + shift < axis[0] - slack
            raise LoomfmuError(
                f"{data.path}: measured from {measured}{moved}, but the run goes from {axis[0] / one:.6g} to"
                f" {axis[-1] / one:.6g} {unit}; {'leave out what is before it' if before else LONGER}"
            )
    return np.asarray(np.clip(places + offset, axis[0], axis[-1]))
