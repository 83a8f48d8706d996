"""What the demonstration loom does, to more digits than a float has: belt, heald and damper at any time.

Belt: `reference.Machine`. Heald: the corrected sloped sine integrated by hand. Both in 30 or more digits.
"""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import damper_reference
import mpmath
import neighbours  # noqa: F401  the references of the other tests
import numpy as np
from exact_damper import Carrier
from own import SPEED
from reference import Machine, Rotor

from loomfmu.components import HealdDamper

MP = mpmath.mp.clone()
MP.dps = 30
SIGNALS = ("belt.margin", "heald_1.lift", "damper_1.displacement")
LENGTH_FACTOR = "0.8"  # at a clearance of 0.3 mm
REDUCTION, TOLERANCE = 0.5, 0.015
STROKE = 0.098  # m


class Frame:
    """Heald frame 1 in plain weave, raised at even picks, at a constant shaft speed from angle 0.

    Its rotor follows the sloped sine, equations (3.19) to (3.24) of Korolev in corrected form: the
    acceleration is `4 eta sin 4x` up to pi/8 and then `eta (8 (pi - x)/7 - sin(8 (x - pi/8)/7)) 4/pi`,
    integrated twice by hand. It is slowest at half a turn of the shaft.
    """

    def __init__(self, speed: float = SPEED):
        self.speed = MP.mpf(speed)
        self.end = MP.pi / 8
        # closing, S(pi) = pi, gives the gain
        self.gain = MP.mpf(1)
        self.gain = REDUCTION * MP.pi / (self._half(MP.pi)[0] - (1 - REDUCTION) * MP.pi)

    def _half(self, x: Any) -> tuple[Any, Any, Any]:
        """Rotor angle over the first half turn with its derivatives, for the present gain."""
        slow = MP.mpf(1) - REDUCTION
        inside = min(x, self.end)
        first = slow + self.gain * (1 - MP.cos(4 * inside)) / 4
        angle = slow * inside + self.gain * (inside - MP.sin(4 * inside) / 4) / 4
        if x <= self.end:
            return angle, first, self.gain * MP.sin(4 * x)
        y, reach, wave = x - self.end, 7 * MP.pi / 8, MP.mpf(8) / 7
        # acceleration (wave (reach - y) - sin(wave y)) / pi
        scale = self.gain / MP.pi
        second = scale * (wave * (reach - y) - MP.sin(wave * y))
        added = scale * (wave * (reach * y - y**2 / 2) - (1 - MP.cos(wave * y)) / wave)
        way = scale * (wave * (reach * y**2 / 2 - y**3 / 6) - (y - MP.sin(wave * y) / wave) / wave)
        return angle + first * y + way, first + added, second

    def rotor(self, x: Any) -> tuple[Any, Any, Any]:
        """Rotor angle over a turn from the slow point, with its derivatives."""
        if x <= MP.pi:
            return self._half(x)
        angle, first, second = self._half(2 * MP.pi - x)
        return 2 * MP.pi - angle, first, -second

    def motion(self, time: Any) -> tuple[Any, Any]:
        """Lift and acceleration [m, m/s2]."""
        x = self.speed * time - MP.pi
        turns = MP.floor(x / (2 * MP.pi))
        angle, first, second = self.rotor(x - 2 * MP.pi * turns)
        first, second = first * self.speed, second * self.speed**2
        cosine, sine = MP.cos_sin(angle / 2)
        share = (1 - cosine) / 2
        bend = cosine * first**2 / 8 + sine * second / 4
        # in pick -1, before the first slow point, it rises towards pick 0
        rises = int(turns) % 2 != 0
        return STROKE * (share if rises else 1 - share), STROKE * (bend if rises else -bend)

    def knots(self) -> list[Any]:
        """Times in the first revolution at which the law goes from one piece to the next."""
        return [(MP.pi + side * self.end) / self.speed for side in (-1, 0, 1)]


@dataclass(frozen=True)
class Loom:
    """The references for the first revolution at a constant speed [rad/s]."""

    speed: float = SPEED

    @cached_property
    def machine(self) -> Machine:
        return Machine("WL680-3600")

    @cached_property
    def carrier(self) -> Carrier:
        """The damper of frame 1, integrated over the revolution."""
        frame = Frame(self.speed)
        return Carrier(lambda time: frame.motion(time)[1], frame.knots(), 2 * MP.pi / frame.speed)

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
        return float(Rotor("sloped_sine", REDUCTION).dwell(TOLERANCE))

    @cached_property
    def peak_load(self) -> float:
        """Largest force of the carrier on its frame [N]."""
        return float(self.carrier.peak_load)

    def apart(self, places: int) -> float:
        """Largest difference of the damper's displacement from that of another integration [m]."""
        turn = 2.0 * math.pi / self.speed
        times = np.linspace(0.0, turn, places + 1)
        found = damper_reference.Carrier(HealdDamper()).integrate(self.speed, 1, times)
        # its frame falls where this one rises; the damper is as stiff upwards as downwards
        return max(
            abs(self.at("damper_1.displacement", time) + other)
            for time, other in zip(times, found.displacement, strict=True)
        )

    def at(self, signal: str, time: float) -> float:
        """A signal of `SIGNALS` at a time of the first revolution [s]."""
        if signal == "belt.margin":
            return float(self.margin_at(MP.mpf(self.speed) * MP.mpf(time)))
        if signal == "heald_1.lift":
            return float(Frame(self.speed).motion(MP.mpf(time))[0])
        return float(self.carrier.at(MP.mpf(time)))


def _lowest(function: Any, low: Any, high: Any) -> Any:
    """Lowest value between two places with one minimum, by golden sections."""
    golden = (MP.sqrt(5) - 1) / 2
    for _ in range(80):  # 0.618^80 = 2e-17 of the way: its square is all that the value is off
        left, right = high - golden * (high - low), low + golden * (high - low)
        low, high = (low, right) if function(left) < function(right) else (left, high)
    return function((low + high) / 2)
