"""Claims on the loom's drive: the motor's power, how evenly the shaft turns, where the energy goes."""

from collections.abc import Sequence
from itertools import chain
from typing import NamedTuple

from ..cosim.claims.arguments import Name, Quantity, argument
from ..cosim.claims.claim import AT_MOST, ONE, PERCENT, POWER, Claim
from ..cosim.claims.judging import Question, needs_shaft
from ..cosim.claims.movers import Wired
from ..errors import LoomfmuError
from ..physics.rotor_laws.shed_cam import SPLINE_CAM
from ..traces import Signals

BOOKS = tuple(  # of the shaft, in the order in which energy_rule.h takes them
    f"shaft.{each}"
    for each in ("velocity", "acceleration", "motor_work", "load_work", "other_work", "kinetic_energy")
)
# what a mechanism calls the work that it has taken from the shaft, its torque, and the part of it whose work
# it does not know
WORK, TORQUE, PASSED = "shaft_work", "shaft_torque", "passed_torque"


class MotorPower(Claim):
    """The motor never delivers more than that power."""

    at_most: float = argument(Quantity("W", "kW", low=0.0))
    motor: str = argument(Name(), "shaft")

    needs = ("motor.motor_power",)
    sense, unit = AT_MOST, POWER

    def question(self, trace: Signals) -> Question:
        signal = f"{self.motor}.motor_power"
        return Question("power", [self.form("motor power", signal)], [signal], [self.at_most])


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

    def question(self, trace: Signals) -> Question:
        needs_shaft(trace)
        form, numbers = self.form("speed fluctuation", "shaft.velocity"), [self.at_most, self.skip]
        return Question("fluctuation", [form], ["shaft.velocity"], numbers)


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
        of_loads = (name for name in scene if name.partition(".")[2] in (WORK, TORQUE, PASSED))
        return ["shaft.angle", *BOOKS, *of_loads]

    def question(self, trace: Signals) -> Question:
        needs_shaft(trace)
        loads = _loads(trace)
        torques = [each.torque for each in loads]
        forms = [self.form("missing energy", name) for name in ("shaft.motor_work", *torques)]
        signals = [*BOOKS, *chain.from_iterable(each.signals for each in loads)]
        numbers = [self.at_most, SPLINE_CAM, *chain.from_iterable((each.counts, each.law) for each in loads)]
        words = "\n".join(chain.from_iterable((each.torque, each.number) for each in loads))
        return Question("energy", forms, signals, numbers, words)


class Load(NamedTuple):
    """A mechanism on the shaft: its torque, the number of its input there, and what tells of its work.

    `signals` are its torque, its work and the part of its torque that does no such work, empty for none;
    `counts` tells whether the shaft takes its work, and `law` is that of its drive, both as numbers or as
    parameters.
    """

    torque: str
    number: str
    signals: Sequence[str]
    counts: float | str
    law: float | str


def _loads(trace: Signals) -> list[Load]:
    """The mechanisms on the shaft, by its wires; a trace without wires has all that state their work."""
    if not trace.wires:
        owners = [signal.partition(".")[0] for signal in trace if signal.endswith(f".{WORK}")]
        return [_load(trace, "", *(f"{owner}.{each}" for each in (TORQUE, WORK, PASSED))) for owner in owners]
    inputs = ((sink.rpartition("_"), torque) for sink, torque in trace.wires.items())
    return [
        _load(
            trace,
            number,
            torque,
            trace.wires.get(f"shaft.work_{number}", ""),
            trace.wires.get(f"shaft.passed_torque_{number}", ""),
        )
        for (name, _, number), torque in inputs
        if name == "shaft.torque"
    ]


def _load(trace: Signals, number: str, torque: str, work: str, passed: str) -> Load:
    use, owner = f"shaft.use_work_{number}", torque.partition(".")[0]
    drive = trace.wires.get(f"{owner}.lift_slope", "").partition(".")[0]
    signals = (torque if work else "", work, passed if passed in trace else "")
    counts = (use if work or _has(trace, use) else 0.0) if number else 1.0
    return Load(torque, number, signals, counts, f"{drive}.law" if _has(trace, f"{drive}.law") else -1.0)


def _has(trace: Signals, parameter: str) -> bool:
    """Return whether the trace has a parameter of the run."""
    try:
        trace.parameter(parameter)
    except LoomfmuError:
        return False
    return True
