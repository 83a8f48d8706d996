"""The base class of claims: its arguments, its signals and the question that it asks of a run."""

import re
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import ClassVar, dataclass_transform

from ...traces import Signals, Verdict
from .arguments import Argument, Name, argument, argument_of
from .conditions import Condition, Unprovable
from .judging import Form, Question, run_of
from .movers import Wired

AT_LEAST, AT_MOST = 1, -1

# units of what is judged: that of the numbers, and the one that people read them in
ONE, PERCENT, ANGLE = ("1", "1"), ("1", "%"), ("rad", "deg")
LENGTH, FORCE, SPEED, POWER = ("m", "mm"), ("N", "N"), ("rad/s", "rev/min"), ("W", "kW")
VELOCITY = ("m/s", "m/s")


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(argument,))
@dataclass(frozen=True, kw_only=True)
class Claim(ABC):
    """A claim with its arguments in SI. Each subclass is a kind, called in scenes by its name in snake_case.

    `name` is what its verdict calls it. A kind states which signals it `needs` as "argument.variable", the
    argument being one that names an instance, and in `reads` the instances of which it needs parameters
    alone; whether what it judges is to be `AT_LEAST` or `AT_MOST` its bound, and the `unit` of both. `noise`
    is what its number may be off by with any steps, in its unit. The rules by which it is judged are in C.
    `not_live` says why a page in which the scene runs does not judge it, if so.
    """

    name: str = argument(Name(), "")

    kinds: ClassVar[dict[str, type["Claim"]]] = {}
    needs: ClassVar[tuple[str, ...]] = ()
    reads: ClassVar[tuple[str, ...]] = ()
    sense: ClassVar[int] = AT_LEAST
    unit: ClassVar[tuple[str, str]] = ONE
    noise: ClassVar[float] = 0.0
    not_live: ClassVar[str] = ""

    def __init_subclass__(cls, kind: bool = True) -> None:
        dataclass(frozen=True, kw_only=True)(cls)
        if kind:
            cls.kinds[re.sub("(?<=.)(?=[A-Z])", "_", cls.__name__).lower()] = cls

    @classmethod
    def declared(cls) -> dict[str, Argument]:
        """Its arguments as they were declared."""
        return {each.name: argument_of(each) for each in fields(cls)}

    def signals(self, scene: Wired) -> list[str]:
        """The signals that must be recorded for it, in a scene with these outputs and wires."""
        needed = [need.partition(".") for need in self.needs]
        return [f"{getattr(self, owner)}.{variable}" for owner, _, variable in needed]

    def parameter_owners(self) -> list[str]:
        """The instances whose parameters it needs, beside those of its signals."""
        return [getattr(self, owner) for owner in self.reads]

    def check_parameters(self, parameter: Callable[[str], float]) -> None:  # noqa: B027 - most kinds have no such limits
        """Refuse what the parameters of its instances, NaN where unknown, rule out before the run."""

    @abstractmethod
    def question(self, trace: Signals) -> Question:
        """Return the rule by which it is judged, with the signals and numbers that this takes of a run."""

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        """Return what must be so at every shaft angle. Raises Unprovable where more than that matters."""
        raise Unprovable("what it judges depends on the run so far, not on the shaft angle alone")

    def form(self, text: str, signal: str) -> Form:
        """Return a verdict's form with this text on a signal, in the claim's own unit."""
        return Form(text, signal, self.unit, self.sense)

    def judge(self, trace: Signals) -> Verdict:
        """Return the verdict on a run."""
        return run_of(trace).verdict(trace, self.question(trace), self.name)

    def settled(
        self, trace: Signals, verdict: Verdict, spread: float, share: float, scatter: float, noise: float
    ) -> Verdict:
        """Return its verdict with the numerical error, of which `spread` differs between resolutions.

        Changes below `noise`, below that share of the value, or below `scatter` times how far the signal has
        moved since the start, do not show the order of an error.
        """
        return run_of(trace).settled(trace, self.question(trace), verdict, spread, noise, share, scatter)

    def left_by_model(self, trace: Signals, verdict: Verdict) -> float:
        """Return the model's own error, on any steps, as the error output of the judged signal states it."""
        return run_of(trace).model_error(trace, self.question(trace), verdict)

    def extremes(self) -> list[tuple[str, float]]:
        """Return the signals whose lowest values are all that it judges, or with -1 the highest ones."""
        return []

    def motions(self, run: Signals) -> list[tuple[Signals, str, float]]:
        """Return these signals of a run, each with the run that has it."""
        return [(run, signal, sense) for signal, sense in self.extremes()]
