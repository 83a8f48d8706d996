"""Claims: assertions on a recorded run, each judged to a verdict.

`judge(trace, kind="above", signal="belt.margin", bound=0.0)` returns a `Verdict`, which is true if the claim
holds: `assert judge(...)`. Scenes state the same as `[[claims]]` tables, with units. Each kind is one class.

Values between the samples count: a signal whose rate is recorded follows the cubic that joins its samples,
and if the rate's rate is recorded, too, the quintic of value, velocity and acceleration. If no rate is
recorded, the verdict's note says so. A claim still holds if only the curve between two samples passes the
bound, and by no more than it may be off there; the note says so.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING, fields
from typing import Any, ClassVar

from ... import units
from ...errors import LoomfmuError, shown, suggestion
from ...traces import Signals, Verdict
from ..standard import standard
from .arguments import Bound, Edges, Flag, Name, Window, argument
from .claim import AT_LEAST, AT_MOST, LANDINGS, Claim
from .conditions import Condition, Unprovable, above, present
from .judging import Form, Question, needs_shaft
from .movers import Wired

# ---- claims on any signal: it stays on one side of a bound


class Bounded(Claim, kind=False):
    """A signal stays on one side of a bound: over the whole run, or in a window of shaft angles.

    The bound is a quantity, or the name of a parameter of the run, such as "shaft.speed". With `at_samples`
    the samples alone are judged; otherwise a claim that holds at all samples of a signal whose values between
    them are not known is undecided.
    """

    signal: str = argument(Name())
    bound: float | str = argument(Bound())
    window: Window | None = argument(Edges("rad", "deg", usual=1.5), None)
    at_samples: bool = argument(Flag(), False)

    grid = LANDINGS
    text: ClassVar[str]

    def signals(self, scene: Wired) -> list[str]:
        return [self.signal]

    def parameter_owners(self) -> list[str]:
        return [self.bound.partition(".")[0]] if isinstance(self.bound, str) else []

    def question(self, trace: Signals) -> Question:
        text, window = self.text + " at the samples" * self.at_samples, [0.0, 0.0, 0.0, 0.0]
        if self.window:
            needs_shaft(trace)
            text += f" {self.window.words}"
            window = [1.0, self.window.start, self.window.width, self.window.end]
        a_speed = isinstance(self.bound, str) and trace.unit(self.signal) == "rad/s"
        if isinstance(self.bound, str):
            check_speed(self.bound, trace.parameter(self.bound), trace.unit(self.signal))
        form = Form(text, self.signal, (trace.unit(self.signal), trace.display(self.signal)), self.sense)
        numbers = [self.bound, float(self.at_samples), *window, float(a_speed)]
        return Question("bounded", [form], [self.signal], numbers)

    def extremes(self) -> list[tuple[str, float]]:
        return [(self.signal, self.sense)]

    def conditions(self, run: Wired) -> tuple[Condition, ...]:
        signal = present(self.signal, run, self.sense)
        if self.window and signal != self.signal:
            raise Unprovable(f"{self.signal} holds what was before the window")
        return (above(signal, self.bound, self.sense, self.window),)


class Above(Bounded):
    """A signal stays at or above a bound."""

    text, sense = "lowest value", AT_LEAST


class Below(Bounded):
    """A signal stays at or below a bound."""

    text, sense = "highest value", AT_MOST


def check_speed(parameter: str, value: float, unit: str) -> None:
    """Refuse a negative speed as a bound: signals that are limits of speed are never negative."""
    if unit == "rad/s" and value < 0.0:
        raise LoomfmuError(
            f"claim: bound {parameter} = {units.show(value, 'rev/min')} is negative, but a limit of speed"
            f' is positive; write the speed itself, such as bound = "{units.show(-value, "rev/min")}"'
        )


# ---- claims of a scene


def kinds() -> Mapping[str, type[Claim]]:
    """Return the class of each kind of claim, those on the standard machine included."""
    standard()
    return Claim.kinds


def read(table: Mapping[str, Any], unit_of: Callable[[str], str]) -> Claim:
    """The claim that a table of a scene states. `unit_of` gives the unit of a signal.

    Raises:
        LoomfmuError: what is unknown, missing, or cannot be read or compared
    """
    kind = table.get("kind")
    if not isinstance(kind, str) or kind not in kinds():
        raise LoomfmuError(f"claim kind = {kind!r} is unknown{suggestion(str(kind), kinds())}")
    where = place_of(table)
    arguments = kinds()[kind].declared()
    for name in table:
        if name not in arguments and name != "kind":
            raise LoomfmuError(f"{where} has no {name!r}{suggestion(name, arguments)}")
    values = {}
    for each in fields(kinds()[kind]):
        value = table.get(each.name)
        if each.name not in table and each.default is MISSING:
            raise LoomfmuError(f"{where} needs {each.name!r}")
        if value is not None or each.default is MISSING:
            values[each.name] = arguments[each.name].read(
                value, f"{where}: {each.name}", lambda: unit_of(table["signal"])
            )
    return kinds()[kind](**values)


def place_of(table: Mapping[str, Any]) -> str:
    """Return what messages call a claim of a scene: by its name, or by its kind if it has none."""
    return f"claim {shown(table.get('name') or table.get('kind'))}"


def name_of(table: Mapping[str, Any]) -> str:
    """Return the name of a claim of a scene: its own, or its kind."""
    return str(table.get("name") or table["kind"])


def called(table: Mapping[str, Any], verdict: Verdict) -> str:
    """Return the name of a verdict's claim in tables: its own name, or its kind and signal."""
    return str(table.get("name") or f"{verdict.claim} ({verdict.signal})")


def angles_in(table: Mapping[str, Any]) -> list[str]:
    """The arguments in a claim's table that are shaft angles."""
    arguments = kinds()[table["kind"]].declared()
    return [name for name in table if name != "kind" and arguments[name].unit == "rad"]


def doubts(table: Mapping[str, Any]) -> Iterator[str]:
    """Numbers of a claim's table that were probably meant in another unit."""
    for name, declared in kinds()[table["kind"]].declared().items():
        if name in table:
            yield from declared.doubts(table[name], f"{place_of(table)}: {name}")
