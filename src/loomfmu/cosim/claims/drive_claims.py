"""Claims on the loom's drive: the motor's power, how evenly the shaft turns, where the energy goes."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ...errors import LoomfmuError
from ...physics.rotor_laws.shed_cam import SPLINE_CAM
from ...traces import Signals, Verdict
from . import shaft
from .arguments import TURN, Name, Quantity, argument
from .claim import AT_MOST, ONE, PERCENT, POWER, Claim
from .curves import Floats, Motion, Stretch
from .extremes import lowest
from .lifted import Wired

# what a mechanism calls the work that it has taken from the shaft, its torque, and the part of it whose work
# it does not know
WORK, TORQUE, PASSED = "shaft_work", "shaft_torque", "passed_torque"


class MotorPower(Claim):
    """The motor never delivers more than that power."""

    at_most: float = argument(Quantity("W", "kW", low=0.0))
    motor: str = argument(Name(), "shaft")

    needs = ("motor.motor_power",)
    sense, unit = AT_MOST, POWER

    def judge(self, trace: Signals) -> Verdict:
        signal = f"{self.motor}.motor_power"
        power = Motion(trace, signal)
        most = lowest(power, -1.0)
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

    def signals(self, scene: Wired) -> list[str]:
        return ["shaft.angle", "shaft.velocity"]

    def unseen(self, trace: Signals) -> str:
        return ""  # each revolution is judged by itself, as far as there is one

    def judge(self, trace: Signals) -> Verdict:
        text, signal = "speed fluctuation", "shaft.velocity"
        velocity, turning = Motion(trace, signal), shaft.needed_angle(trace)
        times = shaft.times_at(trace, float(turning.values[0][0]))
        worst, time, notes = math.nan, math.nan, [velocity.note]
        for start, end in list(pairwise(times))[math.ceil(self.skip) :]:
            low, high = (lowest(velocity, sign, [Stretch(start, end)]) for sign in (1.0, -1.0))
            fluctuation = (high.value - low.value) * (end - start) / TURN
            notes += [low.note, high.note]
            if not fluctuation <= worst:
                worst, time = fluctuation, low.time
        if math.isnan(worst):
            notes.append("the run has no whole revolution to judge")
        return self.verdict(trace, text, signal, self.at_most, worst, time, *notes)


@dataclass(frozen=True)
class Load:
    """A mechanism on the shaft: its torque, the work that it states for it, and the part without work."""

    torque: str
    work: str = ""
    passed: str = ""


class EnergyBalance(Claim):
    """The energy that the motor delivers is found again: in the shaft, its mechanisms and outside torques.

    What is judged is the largest share that is missing at any sample since the start: of the work that the
    shaft and its loads exchange in a revolution, to and fro. A run whose torques are a step late does not
    balance. Nor does one with a torque that does not do the work that its mechanism states: the integral of
    torque and velocity must agree with it, as far as the samples show this integral.
    """

    at_most: float = argument(Quantity("1", low=0.0), 1e-9)

    needs = ()
    sense, unit = AT_MOST, ONE
    noise = 1e-12  # of the work that the shaft exchanges: rounding of sums

    def signals(self, scene: Wired) -> list[str]:
        books = ("velocity", "acceleration", "motor_work", "load_work", "other_work", "kinetic_energy")
        of_loads = (name for name in scene if name.partition(".")[2] in (WORK, TORQUE, PASSED))
        return ["shaft.angle", *(f"shaft.{each}" for each in books), *of_loads]

    def unseen(self, trace: Signals) -> str:
        return ""  # it judges the books of the run, however long that is

    def repeat(self, trace: Signals) -> int:
        return 1

    def judge(self, trace: Signals) -> Verdict:
        loads = _loads(trace)
        taken = [np.asarray(trace[load.work]) for load in loads if load.work]
        stored = np.sum([trace["shaft.kinetic_energy"], *taken], axis=0)
        missing = trace["shaft.motor_work"] - trace["shaft.other_work"] - (stored - stored[0])
        turned = abs(float(np.ptp(shaft.needed_angle(trace).values[0]))) / TURN
        through = float(np.sum(np.abs(np.diff(trace["shaft.load_work"])))) / max(turned, 1.0)
        place = int(np.argmax(np.abs(missing)))
        most, signal, time = abs(float(missing[place])), "shaft.motor_work", float(trace.time[place])
        notes = _without_work(trace, loads)
        slip = _slip(trace)
        for load in loads:
            if load.work:
                gap, allowed, at = _gap(trace, load, slip)
                if gap - allowed > most:
                    most, signal, time = gap - allowed, load.torque, at
                    notes = [f"its work is {gap:.3g} J off {load.work}; the steps explain {allowed:.2g} J"]
        if most > self.at_most * through:
            notes.append(_cause(trace, signal))
        unwired = _unwired(trace)
        if unwired:
            notes = [f"shaft.use_{work} = true, but shaft.{work} is not wired" for work in unwired]
        if not through > 0.0:
            notes = ["the shaft does no work in this run"]
        share = most / through if through > 0.0 and not unwired else math.nan
        return self.verdict(trace, "missing energy", signal, self.at_most, share, time, *notes)


def _loads(trace: Signals) -> list[Load]:
    """The mechanisms on the shaft, by its wires; a trace without wires has all that state their work."""
    if not trace.wires:
        owners = [signal.partition(".")[0] for signal in trace if signal.endswith(f".{WORK}")]
        return [Load(*(f"{owner}.{each}" for each in (TORQUE, WORK, PASSED))) for owner in owners]
    found = []
    for sink, torque in trace.wires.items():
        name, _, number = sink.rpartition("_")
        if name == "shaft.torque":
            work, passed = (
                trace.wires.get(f"shaft.{each}_{number}", "") for each in ("work", "passed_torque")
            )
            counts = work and trace.parameter(f"shaft.use_work_{number}")
            found.append(Load(torque, work, passed) if counts else Load(torque))
    return found


def _without_work(trace: Signals, loads: Iterable[Load]) -> list[str]:
    """A note on the torques whose work the shaft does not know."""
    torques = [load.torque for load in loads if not load.work]
    torques += [load.passed for load in loads if load.passed in trace and np.any(trace[load.passed])]
    return [f"work by the torque alone, of second order in the step: {', '.join(torques)}"] if torques else []


def _unwired(trace: Signals) -> list[str]:
    """The works that the shaft counts for a torque although they do not come from its mechanism."""
    numbers = [sink.removeprefix("shaft.torque_") for sink in trace.wires if sink.startswith("shaft.torque_")]
    missing = [f"work_{number}" for number in numbers if f"shaft.work_{number}" not in trace.wires]
    return [work for work in missing if _parameter(trace, f"shaft.use_{work}") == 1.0]


def _cause(trace: Signals, signal: str) -> str:
    """A note on why the balance of a sound scene may fail; none where nothing is known."""
    owner = signal.partition(".")[0]
    if owner != "shaft":
        drive = trace.wires.get(f"{owner}.lift_slope", "").partition(".")[0]
        if _parameter(trace, f"{drive}.law") == SPLINE_CAM:
            return "the velocity of a spline_cam jumps: its impulse is in the work, but in no torque"
        return "take more steps: the gap shrinks if the torque is right"
    if trace["shaft.velocity"][0] == 0.0:
        return "the steps may be too coarse for the start from rest: take more"
    return ""


def _parameter(trace: Signals, name: str) -> float:
    """A parameter of the run; NaN where the trace does not have it."""
    try:
        return trace.parameter(name)
    except LoomfmuError:
        return math.nan


def _slip(trace: Signals) -> float:
    """Return how far the shaft's velocity is from the integral of its acceleration, as a share of it.

    Nothing but rounding for loads whose work is known; of second order in the step for others.
    """
    velocity = np.asarray(trace["shaft.velocity"])
    off = velocity - velocity[0] - _integral(trace.time, np.asarray(trace["shaft.acceleration"]))
    return float(np.max(np.abs(off)) / np.max(np.abs(velocity))) if np.any(velocity) else 0.0


def _gap(trace: Signals, load: Load, slip: float) -> tuple[float, float, float]:
    """Largest difference of the work that a load states from that of its torque, what of it may be due to
    the steps, and its time.

    That is twice what half of the samples change the integral by: about 15 times its error for a torque that
    its samples resolve, but what a blow between two samples does may lie beyond. And a torque belongs to the
    shaft's acceleration, a work to its velocity: where these differ by a share, the work `I w^2 / 2` of a
    mass differs by up to four times this share, `2 I w` times the largest difference.
    """
    torque, time, work = np.asarray(trace[load.torque]), trace.time, np.asarray(trace[load.work])
    if load.passed in trace:
        torque = torque - trace[load.passed]
    power = torque * trace["shaft.velocity"]
    done = _integral(time, power)
    gaps = np.abs(work - work[0] - done)
    halved = np.abs(_integral(time[::2], power[::2]) - done[::2])
    place = int(np.argmax(gaps))
    rest = 4.0 * slip * float(np.ptp(work)) + 1e-12 * float(np.max(np.abs(work)))
    return float(gaps[place]), 2.0 * float(np.max(halved)) + rest, float(time[place])


def _integral(time: Floats, values: Floats) -> Floats:
    """Integral from the start to each sample, of fourth order: trapezoids, corrected by the slopes."""
    if len(time) < 3:
        return np.zeros(len(time))
    slopes, steps = np.gradient(values, time, edge_order=2), np.diff(time)
    pieces = 0.5 * steps * (values[1:] + values[:-1]) - steps * steps / 12.0 * np.diff(slopes)
    return np.concatenate(([0.0], np.cumsum(pieces)))
