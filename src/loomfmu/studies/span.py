"""The variable that a study varies, and its range."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from .. import units
from ..cosim.importing.fmus import Port
from ..cosim.scenes.notes import check_effect
from ..cosim.scenes.scene import Scene
from ..display.printed import rounded
from ..errors import LoomfmuError, shown, within
from ..sweeps.varied import Keyed, Varied, varied

SENSIBLE = 10.0  # times the scene's value: bounds that are farther apart say nothing about a range
FOUND = 1e-9  # of a value: limits are found to that
AROUND = 2.0  # from the scene's value divided by it to the scene's value times it
FORM = "write it as INSTANCE.VARIABLE or INSTANCE.VARIABLE=LOW..HIGH, such as shaft.speed=300rpm..900rpm"


@dataclass(frozen=True)
class Span(Keyed):
    """A variable of a scene from `low` to `high` in SI; `source` says where its range comes from.

    `value` is the scene's own value, `doubts` warn of ends that were probably meant in another unit.
    """

    low: float
    high: float
    value: float
    source: str
    doubts: tuple[str, ...] = ()

    @property
    def unit(self) -> str:
        """The unit that people read it in, or that of its FMU if loomfmu does not know that."""
        return self.varied.shown_unit

    @property
    def factor(self) -> float:
        """The factor from that unit to SI."""
        return units.unit(self.varied.display).factor

    def at(self, share: float) -> float:
        """The value at a share of the range, 0 to 1; its ends exactly."""
        return float(min(max(self.low + share * (self.high - self.low), self.low), self.high))

    def setting(self, value: float) -> dict[str, Any]:
        """Return the setting of the value in a prepared scene."""
        return {self.key: self.varied.setting(value)}

    def points(self, count: int) -> list[float]:
        """Equally spaced values, both ends included."""
        return [self.low, *np.linspace(self.low, self.high, count)[1:-1].tolist(), self.high]

    def number(self, value: float, inwards: float = 0.0) -> str:
        """A value in the unit that people read it in, without the unit.

        The end of a range is rounded `inwards`: to no less, for 1, or to no more, for -1.
        """
        shown = value / self.factor
        text = f"{shown:.7g}"
        if inwards * (float(text) - shown) < -FOUND * abs(shown):
            return f"{float(rounded(shown, inwards > 0.0, 7)):.7g}"
        return text

    def show(self, value: float, inwards: float = 0.0) -> str:
        """A value with its unit."""
        return self.number(value, inwards) + ("" if self.unit == "1" else f" {self.unit}")

    @property
    def text(self) -> str:
        """The range as text."""
        return f"{self.number(self.low)} to {self.show(self.high)}"

    def exact_number(self, value: float) -> str:
        """A value as `number` gives it, with all digits."""
        return units.exact(value, self.varied.display)

    @property
    def exact(self) -> str:
        """The range as text with all digits of its ends."""
        low, high = map(self.exact_number, (self.low, self.high))
        return f"{low} to {high}" + ("" if self.unit == "1" else f" {self.unit}")


def span_of(scene: Scene, text: str, from_: Any = None, to: Any = None, option: str = "vary") -> Span:
    """Return the variable that `option` names, over the given range, `from_` to `to`, or a usual one.

    Raises LoomfmuError for what cannot be varied, or not over that range.
    """
    if not isinstance(text, str):
        raise LoomfmuError(f"{option} = {shown(text)} is not a variable such as 'shaft.speed'")
    key, equals, wanted = (part.strip() for part in text.partition("="))
    if equals:
        with within(f"{option} {key}"):
            first, last = units.ends_of(wanted)
        if not (first and last):
            raise LoomfmuError(f"{option} {text}: {shown(wanted)} is not a range; {FORM}")
        if from_ is not None or to is not None:
            raise LoomfmuError(f"{option} {text}: the range is given twice; leave out from and to")
        from_, to = first, last
    variable = varied(scene, key)
    port, value = port_of(scene, variable)
    check_effect(scene.instances, variable.targets)
    given = [None if each is None else float(variable.read(each)) for each in (from_, to)]
    usual = _usual(variable, port, value) if None in given else []
    source = _source(given, [text for _end, text in usual])
    if any(units.is_plain(each) for each in (from_, to)) and variable.unit not in ("1", variable.display):
        source += f"; numbers without a unit are {variable.unit}"
    low, high = (usual[place][0] if each is None else each for place, each in enumerate(given))
    doubts = tuple(filter(None, (variable.doubt(each) for each in (from_, to) if each is not None)))
    span = Span(variable, low, high, value, source, doubts)
    if not low < high:
        where = f" ({source}); give both ends" if None in given else ""
        raise LoomfmuError(f"{key}: the range from {span.show(low)} to {span.show(high)} is empty{where}")
    return span


def warnings_of(spans: Sequence[Span], of_run: Sequence[str]) -> tuple[str, ...]:
    """Return the warnings of a study: on the ends of its ranges, then those of its scene; each once."""
    return tuple(dict.fromkeys((*(doubt for span in spans for doubt in span.doubts), *of_run)))


def set_twice(spans: Sequence[Keyed]) -> tuple[Keyed, Keyed, str] | None:
    """The first two that set the same variable of an instance, and that variable; None where none do."""
    for one, other in combinations(spans, 2):
        if both := {*one.varied.targets} & {*other.varied.targets}:
            return one, other, min(both)
    return None


def port_of(scene: Scene, variable: Varied) -> tuple[Port, float]:
    """The variable in its FMU and its value in the scene. Raises LoomfmuError for what has no real values."""
    key = variable.key
    if variable.needs_scene or not variable.targets or "." not in variable.targets[0]:
        raise LoomfmuError(f"{key} cannot be varied here: only parameters and inputs of instances can")
    if variable.kind != "Real":
        raise LoomfmuError(f"{key} is not a real number; run a sweep over its values")
    owner, _, name = variable.targets[0].partition(".")
    instance = scene.instances[owner]
    port = instance.fmu.ports[instance.fmu.name_of(name)]
    found = instance.values.get(port.name, port.start)
    return port, float(found or 0.0)


def _usual(variable: Varied, port: Port, value: float) -> list[tuple[float, str]]:
    """The ends of the range where none are given, and where each comes from."""
    low, high = port.minimum, port.maximum
    lowest, highest = (-math.inf if low is None else low), (math.inf if high is None else high)
    bounds = (lowest, "its lower bound"), (highest, "its upper bound")
    if highest - lowest <= SENSIBLE * abs(value):
        return [*bounds]
    if not value:
        raise LoomfmuError(f"{variable.key} is 0 in this scene, so there is no usual range: give from and to")
    own = f"the scene's {variable.show(value)}"
    ends = sorted([(value / AROUND, f"half {own}"), (value * AROUND, f"twice {own}")])
    return [min(max(each, bounds[0]), bounds[1]) for each in ends]


def _source(given: Sequence[float | None], usual: Sequence[str]) -> str:
    """Return the origin of both ends of a range, in words."""
    if not usual:
        return "given"
    if any(each is not None for each in given):
        low, high = (text if each is None else "given" for each, text in zip(given, usual, strict=True))
        return f"lower end {low}, upper end {high}"
    first, _, own = usual[0].partition(" ")
    shared = usual[1].endswith(f" {own}")  # half and twice the same value
    return f"{first if shared else usual[0]} to {usual[1]}"
