"""What the demonstration loom does, to the last digits of a float: belt, heald and damper at any time.

Belt and heald: `reference.Machine` and `reference.Rotor`, in 50 digits. Damper: `damper_reference`, by scipy.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import damper_reference
import neighbours  # noqa: F401  the references of the other tests
import numpy as np
from numpy.typing import NDArray
from own import SPEED
from reference import MP, Machine, Rotor

from loomfmu.components import HealdDamper

SIGNALS = ("belt.margin", "heald_1.lift", "damper_1.displacement")
LENGTH_FACTOR = "0.8"  # at a clearance of 0.3 mm
REDUCTION, TOLERANCE = 0.5, 0.015
STROKE = damper_reference.STROKE


@dataclass(frozen=True)
class Loom:
    """The references for the first revolution at a constant speed [rad/s]."""

    speed: float = SPEED

    @cached_property
    def machine(self) -> Machine:
        return Machine("WL680-3600")

    @cached_property
    def rotor(self) -> Rotor:
        return Rotor("sloped_sine", REDUCTION)

    def margin_at(self, angle: Any) -> Any:
        """Margin against buckling at a shaft angle, equations (7) and (8) of Zhu and Zhou."""
        travel, _slope, bend = self.machine.travel(MP.mpf(angle))
        free = travel - self.machine.guide
        if free <= 0:
            return MP.mpf(1)
        critical = MP.pi**2 * self.machine.stiffness / (MP.mpf(LENGTH_FACTOR) * free) ** 2
        return 1 - self.machine.mass * bend * MP.mpf(self.speed) ** 2 / critical

    @cached_property
    def lowest_margin(self) -> float:
        """Lowest margin of a revolution: both minima, before and behind the transfer, are sought."""
        there = self.machine.worst_angle()
        # the way back is not the mirror image of the way there: the lowest of it by golden sections
        back = _lowest(self.margin_at, 2 * MP.pi - 1.2 * there, 2 * MP.pi - 0.8 * there)
        return float(min(self.margin_at(there), back))

    @cached_property
    def dwell(self) -> float:
        """Dwell of a changing frame [rad]."""
        return float(self.rotor.dwell(TOLERANCE))

    def lift_at(self, angle: Any) -> Any:
        """Lift of frame 1 [m]: raised in the middle of the revolution, where its rotor is slowest."""
        return STROKE * (1 + MP.cos(self.rotor.angle(abs(angle - MP.pi)) / 2)) / 2

    def carried(self, times: NDArray[np.float64]) -> damper_reference.Trace:
        """The damper of a frame that falls where frame 1 rises; it is as stiff upwards as downwards."""
        within = np.minimum(times, 2.0 * math.pi / self.speed)  # the last one may be rounded up
        return damper_reference.Carrier(HealdDamper()).integrate(self.speed, 1, within)

    @cached_property
    def peak_load(self) -> float:
        """Largest force of the carrier on its frame [N]: of samples ever closer, and where a stop jumps."""
        low, high = 0.0, 2.0 * math.pi / self.speed
        for _ in range(3):  # at last 40 ps apart: (w t)^2 / 8 of the force is far below rounding
            times = np.linspace(low, high, 10_001)
            carried = self.carried(times)
            place = int(np.argmax(np.abs(carried.force)))
            low, high = times[place - 1], times[place + 1]
        edges = [force for _time, force in carried.edges]
        return float(np.max(np.abs([carried.force[place], *edges])))

    def along(self, signal: str, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """A signal of `SIGNALS` at times of the first revolution [s]."""
        if signal == "damper_1.displacement":
            return -self.carried(times).displacement
        at = self.margin_at if signal == "belt.margin" else self.lift_at
        return np.array([float(at(MP.mpf(self.speed) * MP.mpf(time))) for time in times])


def _lowest(function: Any, low: Any, high: Any) -> Any:
    """Lowest value between two places with one minimum, by golden sections."""
    golden = (MP.sqrt(5) - 1) / 2
    for _ in range(80):  # 0.618^80 = 2e-17 of the way: its square is all that the value is off
        left, right = high - golden * (high - low), low + golden * (high - low)
        low, high = (low, right) if function(left) < function(right) else (left, high)
    return function((low + high) / 2)
