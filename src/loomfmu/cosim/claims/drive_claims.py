"""Claims on the loom's drive: the motor's power, how evenly the shaft turns, where the energy goes."""

import math
from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from ...traces import Signals, Verdict
from . import shaft
from .arguments import TURN, Name, Quantity, argument
from .claim import AT_MOST, ONE, PERCENT, POWER, Claim
from .curves import Motion, Stretch

WORK = "shaft_work"  # what a mechanism calls the work that it has taken from the shaft


class MotorPower(Claim):
    """The motor never delivers more than that power."""

    at_most: float = argument(Quantity("W", "kW", low=0.0))
    motor: str = argument(Name(), "shaft")

    needs = ("motor.motor_power",)
    sense, unit = AT_MOST, POWER

    def judge(self, trace: Signals) -> Verdict:
        signal = f"{self.motor}.motor_power"
        power = Motion(trace, signal)
        most = power.lowest(-1.0)
        notes = (power.note, most.note)
        return self.verdict(trace, "motor power", signal, self.at_most, most.value, most.time, *notes)


class SpeedFluctuation(Claim):
    """In each revolution the shaft's highest and lowest velocity differ by no more than a share of the mean.

    Revolutions are counted from where the run starts. The first `skip` of them, such as those of a start-up,
    are left out.
    """

    at_most: float = argument(Quantity("1", "%", low=0.0))
    skip: float = argument(Quantity("1", low=0.0), 0.0)

    sense, unit = AT_MOST, PERCENT

    def signals(self, instances: Iterable[str]) -> list[str]:
        return ["shaft.angle", "shaft.velocity"]

    def judge(self, trace: Signals) -> Verdict:
        text, signal = "speed fluctuation", "shaft.velocity"
        velocity, turning = Motion(trace, signal), shaft.needed_angle(trace)
        times = shaft.times_at(trace, float(turning.values[0][0]))
        worst, time, notes = math.nan, math.nan, [velocity.note]
        for start, end in list(pairwise(times))[math.ceil(self.skip) :]:
            low, high = (velocity.lowest(sign, [Stretch(start, end)]) for sign in (1.0, -1.0))
            fluctuation = (high.value - low.value) * (end - start) / TURN
            notes += [low.note, high.note]
            if not fluctuation <= worst:
                worst, time = fluctuation, low.time
        if math.isnan(worst):
            notes.append("the run has no whole revolution to judge")
        return self.verdict(trace, text, signal, self.at_most, worst, time, *notes)


class EnergyBalance(Claim):
    """What the motor delivers is found again: in the shaft, in its mechanisms and in torques from outside.

    What is judged is the largest share that is missing at any sample since the start: of the work that the
    shaft and its loads exchange in a revolution, to and fro. A run whose torques are a step late does not
    balance.
    """

    at_most: float = argument(Quantity("1", low=0.0), 1e-9)

    needs = ()
    sense, unit = AT_MOST, ONE

    def signals(self, instances: Iterable[str]) -> list[str]:
        books = ("motor_work", "load_work", "other_work", "kinetic_energy")
        return ["shaft.angle", *(f"shaft.{each}" for each in books), f"*.{WORK}"]

    def judge(self, trace: Signals) -> Verdict:
        taken = [np.asarray(trace[signal]) for signal in trace if signal.endswith(f".{WORK}")]
        stored = np.sum([trace["shaft.kinetic_energy"], *taken], axis=0)
        missing = trace["shaft.motor_work"] - trace["shaft.other_work"] - (stored - stored[0])
        turned = abs(float(np.ptp(shaft.needed_angle(trace).values[0]))) / TURN
        through = float(np.sum(np.abs(np.diff(trace["shaft.load_work"])))) / max(turned, 1.0)
        place = int(np.argmax(np.abs(missing)))
        share = abs(float(missing[place])) / through if through > 0.0 else math.nan
        note = "" if through > 0.0 else "the shaft does no work in this run"
        time, signal = float(trace.time[place]), "shaft.motor_work"
        return self.verdict(trace, "energy missing", signal, self.at_most, share, time, note)
