"""The base class of claims: its arguments, its signals and how it is judged."""

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from typing import ClassVar, NamedTuple, dataclass_transform

from ...traces import Signals, Verdict
from . import shaft
from .arguments import Argument, Name, argument, argument_of
from .curves import Doubt, Stretch, Unknown
from .extremes import COARSE_NOTE
from .lifted import Wired, repeat_of
from .validity import gaps, off_by, unknown_note

AT_LEAST, AT_MOST = 1, -1

# units of what is judged: that of the numbers, and the one that people read them in
ONE, PERCENT, ANGLE = ("1", "1"), ("1", "%"), ("rad", "deg")
LENGTH, FORCE, SPEED, POWER = ("m", "mm"), ("N", "N"), ("rad/s", "rev/min"), ("W", "kW")
VELOCITY = ("m/s", "m/s")

# What a claim needs of the window grid: all equal steps, steps that land where `landings` says, or nothing,
# since its component finds what is judged on its own continuous curve.
EVERY_STEP, LANDINGS, NOTHING = "every step", "landings", "nothing"


class Landings(NamedTuple):
    """Times and extremes on which steps of the window grid land for a claim.

    `times` are known to be looked at [s]; of each signal in `extremes` the lowest values count, or with -1
    the highest ones.
    """

    times: list[float]
    extremes: list[tuple[str, float]]


@dataclass_transform(frozen_default=True, kw_only_default=True, field_specifiers=(argument,))
@dataclass(frozen=True, kw_only=True)
class Claim(ABC):
    """A claim with its arguments in SI. Each subclass is a kind, called in scenes by its name in snake_case.

    `name` is what its verdict calls it. A kind states which signals it `needs` as "argument.variable", the
    argument being one that names an instance, and in `reads` the instances of which it needs parameters
    alone; whether what it judges is to be `AT_LEAST` or `AT_MOST` its bound, and the `unit` of both; and what
    it needs of the window `grid`, which is every step unless it says otherwise. `noise` is what its number
    may be off by with any steps, in its unit. `final` says whether it fails once its bound is passed,
    whatever the rest of a run would show.
    """

    name: str = argument(Name(), "")

    kinds: ClassVar[dict[str, type["Claim"]]] = {}
    needs: ClassVar[tuple[str, ...]] = ()
    reads: ClassVar[tuple[str, ...]] = ()
    sense: ClassVar[int] = AT_LEAST
    unit: ClassVar[tuple[str, str]] = ONE
    grid: ClassVar[str] = EVERY_STEP
    noise: ClassVar[float] = 0.0
    final: ClassVar[bool] = True

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

    def check(self, parameter: Callable[[str], float]) -> None:  # noqa: B027 - most kinds have no such limits
        """Refuse what the parameters of its instances, NaN where unknown, rule out before the run."""

    @abstractmethod
    def judge(self, trace: Signals) -> Verdict:
        """Return the verdict on a run."""

    def unseen(self, trace: Signals) -> str:
        """Return what the run lacks for a judgement, or an empty text if it is complete.

        A claim on a loom takes a whole revolution.
        """
        return shaft.short(trace)

    def repeat(self, trace: Signals) -> int:
        """Return the revolutions after which the weave that it depends on repeats; 1 without frames."""
        owners = {signal.partition(".")[0] for signal in self.signals(trace)}
        return math.lcm(*(repeat_of(each, trace) for each in owners))

    def unresolved(self, trace: Signals, verdict: Verdict) -> float:
        """Return the error of a verdict that runs on other steps may not show."""
        return self.left_by_model(trace, verdict)

    def left_by_model(self, trace: Signals, verdict: Verdict) -> float:
        """Return the model's own error, on any steps, as the error output of the judged signal states it."""
        return off_by(trace, verdict, self.within(trace)) if _judges(trace, verdict) else 0.0

    def within(self, trace: Signals) -> list[Stretch] | None:
        """The stretches of time that are judged; None for the whole run."""
        return None

    def landings(self, trace: Signals) -> Landings:
        """Return where steps of the window grid must land, as a coarse run of its signals shows."""
        return Landings([], [])

    def verdict(
        self,
        trace: Signals,
        text: str,
        signal: str,
        bound: float,
        worst: float,
        time: float,
        *notes: str,
        holds: bool | None = None,
        unit: tuple[str, str] | None = None,
        sense: int | None = None,
        unknown: Sequence[Stretch] | None = None,
    ) -> Verdict:
        """The verdict, with the place on the shaft at its time.

        Unless `holds` says so, the worst value decides. Without one, NaN, a claim is undecided. So is one
        that holds as far as its signal is known, where this is `unknown` in some stretches of time, by
        default those of the whole run, where the samples are too far apart, and where a note is a `Doubt`;
        and one that does not fail, or may not in the end, where the run was cut short or shows too little.
        """
        turning = shaft.angle(trace)
        if turning is not None and shaft.too_coarse(turning):
            notes = (*notes, COARSE_NOTE)
        if holds is None:
            holds = self.sense * worst >= self.sense * bound
        unknown = gaps(trace, signal) if unknown is None else unknown
        if unknown:
            notes = (Doubt(unknown_note(trace, signal, unknown[0])), *notes)
        short = trace.cut_short or self.unseen(trace) or shaft.unwoven(trace, self.repeat(trace))
        open_ = bool(short) and (holds or not self.final)
        kind = Doubt if holds else Unknown
        doubted = any(isinstance(note, kind) for note in notes) and (holds or not self.final)
        decided = not (math.isnan(worst) or doubted or open_)
        if not decided:
            notes = (short, *notes)
        if not decided and (unknown or open_) and not math.isnan(worst):
            worst, time = math.nan, math.nan
        angle, revolution = math.nan, None
        if turning is not None and math.isfinite(time):
            angle, revolution = shaft.place(turning, time)
        note = "; ".join(dict.fromkeys(note for note in notes if note))
        claim = f"{self.name}: {text}" if self.name else text
        return Verdict(
            claim,
            signal,
            bool(holds) and decided,
            bound,
            worst,
            *(unit or self.unit),
            time,
            angle,
            revolution,
            note,
            sense=sense or self.sense,
            error=math.nan if decided else math.inf,
            decided=decided,
        )


def _judges(trace: Signals, verdict: Verdict) -> bool:
    """Return whether the verdict's number is a value of its signal, which may only name where to look."""
    return verdict.signal in trace and verdict.unit == trace.unit(verdict.signal)
