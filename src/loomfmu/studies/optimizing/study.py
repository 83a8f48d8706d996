"""A study file, read and checked against its scene: what is wanted, what may vary, which claims must hold."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from math import prod
from pathlib import Path
from typing import Any

from ... import units
from ...cosim.claims.expressions import Expression, is_expression
from ...cosim.claims.measures import measure, signal_in
from ...cosim.importing.fmus import Port
from ...cosim.planning.requested import output_port
from ...cosim.scenes.scene import Scene
from ...cosim.scenes.settings import read_table
from ...errors import LoomfmuError, listed, shown, suggestion
from ...sweeps.axes import Range, flattened, grid_axis, range_of, whole
from ...sweeps.header import HEAD, Header, check_by_scene, read, variables
from ...sweeps.varied import Keyed, Value, shown_unit, varied
from ..cases import Case
from .cases import cases_of

WAYS = {"minimise": 1.0, "maximise": -1.0}  # what a goal is multiplied by to be made small
KEYS = (*HEAD, *WAYS, "safety", "except", "ranges", "choices", "cases", "tolerances", "search")
USUAL = {"runs": 2000, "seed": 1, "points": 11}  # of the search
SEARCH = {key: partial(whole, low=low) for key, low in {"runs": 50, "seed": 0, "points": 3}.items()}
MOST_GOALS = 3


@dataclass(frozen=True)
class Variable(Keyed):
    """A variable of a study: in a `range` of real numbers, or among `options`."""

    range: Range | None
    options: Sequence[Value] = ()

    @property
    def last(self) -> float:
        """The largest number that stands for a value; the smallest is 0."""
        return 1.0 if self.range else len(self.options) - 1.0

    def value(self, number: float) -> Value:
        """The value that a number stands for: a share of the range, or which option."""
        if self.range is None:
            return self.options[round(number)]
        return float(self.range.at(number))

    @property
    def text(self) -> str:
        """The allowed values, in words."""
        if self.range is None and not isinstance(self.options, range):
            return " | ".join(map(self.varied.show, self.options))
        ends = (self.range.low, self.range.high) if self.range else (self.options[0], self.options[-1])
        return " to ".join(map(self.varied.show, ends))


@dataclass(frozen=True)
class Goal:
    """A quantity to minimise (`sign` 1) or to maximise (-1).

    `place` is its number among the variables, the claims or the signals of a study, as `kind` says.
    """

    name: str
    sign: float
    kind: str
    place: int
    unit: str = "1"
    display: str = "1"

    @property
    def shown_unit(self) -> str:
        """The unit that people read it in."""
        return shown_unit(self.unit, self.display)

    @property
    def words(self) -> str:
        """The goal in words."""
        way = "smallest" if self.sign > 0.0 else "largest"
        return f"{way} {'distance of ' if self.kind == 'claim' else ''}{self.name}"


@dataclass(frozen=True)
class Study(Header):
    """A search for the best design: a scene, its variables, goals, and the claims' distances from their
    bounds.

    `required` says of each claim whether it must hold; `shares` and `amounts` are those distances: as a share
    of its bound, and in its unit. Each design is run in all `cases`, and the worst counts; without any it is
    run once.
    """

    variables: tuple[Variable, ...]
    goals: tuple[Goal, ...]
    measures: tuple[str, ...]
    required: tuple[bool, ...]
    shares: tuple[float, ...]
    amounts: tuple[str, ...]
    search: dict[str, int]
    cases: tuple[Case, ...] = ()

    @cached_property
    def continuous(self) -> list[int]:
        """The places of the variables that have a range of real numbers."""
        return [place for place, variable in enumerate(self.variables) if variable.range]

    @property
    def combinations(self) -> int:
        """Number of combinations of options."""
        return prod(len(variable.options) for variable in self.variables if not variable.range)

    @property
    def enumerable(self) -> bool:
        """Return whether only options vary, so few of them that a search can run every combination."""
        return not self.continuous and self.combinations <= self.search["runs"]

    @property
    def wanted(self) -> str:
        """The claims that must hold, in words."""
        free = [
            f"'{name}'"
            for name, needed in zip(names_of(self.scene), self.required, strict=True)
            if not needed
        ]
        return f"all claims but {listed(free)}" if free else "all claims"

    @property
    def notes(self) -> tuple[str, ...]:
        """The warnings for the user."""
        doubts = (doubt for variable in self.variables if variable.range for doubt in variable.range.doubts)
        return (*self.scene.notes, *doubts, *(doubt for case in self.cases for doubt in case.doubts))

    @property
    def situations(self) -> tuple[Case, ...]:
        """The cases in which a design is run, one without a name if the study states none."""
        return self.cases or (Case(""),)

    def setting(self, values: Sequence[Value]) -> dict[str, Any]:
        """Return the settings of the scene for values of the variables."""
        return {
            target: variable.varied.setting(value)
            for variable, value in zip(self.variables, values, strict=True)
            for target in variable.varied.targets
        }

    def written(self, values: Sequence[Value]) -> dict[str, Any]:
        """The values by their keys, as a scene is written with them."""
        pairs = zip(self.variables, values, strict=True)
        return {each.key: each.varied.setting(value) for each, value in pairs}


def load(path: Path) -> Study:
    """Read a study file. Raises LoomfmuError naming the file and what is wrong, before anything runs."""
    return read(path, "study", KEYS, _parse)


def _parse(head: Header, tables: dict[str, Any]) -> Study:
    found = _variables(head, tables)
    goals = _goals(head.scene, tables, found)
    required = required_of(head.scene, tables.get("except", []))
    shares, amounts = safety_of(head.scene, tables.get("safety", 0.0), required)
    taken = {target for each in found for target in each.varied.targets}
    taken |= {target for key in head.fixed for target in varied(head.scene, key).targets}
    signals = tuple(goal.name for goal in goals if goal.kind == "signal")
    return Study(
        **vars(head),
        variables=tuple(found),
        goals=tuple(goals),
        measures=signals,
        required=required,
        shares=shares,
        amounts=amounts,
        search=USUAL | read_table(tables.get("search", {}), "search", SEARCH),
        cases=cases_of(head, tables, taken),
    )


def _variables(head: Header, tables: dict[str, Any]) -> list[Variable]:
    """Return the variables, ranges first."""
    ranges, choices = (flattened(tables.get(name, {}), name) for name in ("ranges", "choices"))
    known = variables(head, {"ranges": ranges, "choices": choices})
    for where, each in known.items():
        if "." not in where.partition(".")[2] and each.targets == (each.key,):
            raise LoomfmuError(f"{where} belongs to the run, not to the design; fix it in [set]")
    found = []
    for key, given in ranges.items():
        each = known[f"ranges.{key}"]
        span = range_of(each, given, "ranges", lists="choices")
        whole_numbers = each.kind == "Integer"
        options = range(int(span.low), int(span.high) + 1) if whole_numbers else ()
        found.append(Variable(each, None if whole_numbers else span, options))
    axes = [grid_axis(known[f"choices.{key}"], given, "choices") for key, given in choices.items()]
    check_by_scene(head, axes)
    for axis in axes:
        if len(axis.values) < 2:
            raise LoomfmuError(f"choices.{axis.key} has one value; fix it in [set], or give several")
        found.append(Variable(axis.varied, None, tuple(axis.values.tolist())))
    if not found:
        raise LoomfmuError(
            'nothing may vary: give ranges in [ranges], such as "shaft.speed" = ["400 rpm", "800 rpm"]'
        )
    return found


def _goals(scene: Scene, tables: dict[str, Any], known: Sequence[Variable]) -> list[Goal]:
    goals: list[Goal] = []
    signals = 0
    for way, sign in WAYS.items():
        given = tables.get(way, [])
        for name in [given] if isinstance(given, str) else given if isinstance(given, list) else [given]:
            if not isinstance(name, str) or not name:
                raise LoomfmuError(f"{way} = {shown(name)} is not a name such as {way} = 'shaft.speed'")
            if any(goal.name == name for goal in goals):
                raise LoomfmuError(f"{way}: {name} is already a goal")
            goals.append(_goal(scene, way, name, sign, known, signals))
            signals += goals[-1].kind == "signal"
    if not goals:
        raise LoomfmuError("there is no goal: write maximise = ..., such as maximise = 'shaft.speed'")
    if len(goals) > MOST_GOALS:
        raise LoomfmuError(f"{len(goals)} goals; the limit is {MOST_GOALS}")
    return goals


def _goal(scene: Scene, way: str, name: str, sign: float, known: Sequence[Variable], signals: int) -> Goal:
    """A goal: a variable, a claim by its name, or what an output is worth."""
    keys = [each.key for each in known]
    if name in keys:
        each = known[keys.index(name)].varied
        if each.kind == "Text":
            raise LoomfmuError(f"{way} = {name!r} is a choice; a goal must be a number")
        return Goal(name, sign, "variable", keys.index(name), each.unit, each.display)
    claims = [str(claim.get("name")) for claim in scene.claims]
    if name in claims:
        return Goal(name, sign, "claim", claims.index(name))
    signal = signal_in(name)
    owner, _, variable = signal.rpartition(".")
    settable = scene.instances[owner].fmu.ports.get(variable) if owner in scene.instances else None
    if settable and settable.causality == "parameter":
        raise LoomfmuError(f"{way}: {signal} is a parameter; put it into [ranges]")
    try:
        return Goal(name, sign, "signal", signals, *_units_of(scene, way, name))
    except LoomfmuError as error:
        if is_expression(signal):
            raise
        near = suggestion(name, [*keys, *(claim for claim in claims if claim != "None")])
        raise LoomfmuError(f"{error}; or a variable of [ranges] or a claim{near}") from None


def _units_of(scene: Scene, way: str, name: str) -> tuple[str, str]:
    """Return the unit of what is measured, and the one that people read it in. Raises LoomfmuError."""

    def port(signal: str) -> Port:
        return output_port(scene, signal, way)

    signal = measure(name, lambda each: port(each).unit, f"{way}: ").signal
    if isinstance(signal, Expression):
        return signal.unit, signal.display(lambda each: port(each).display)
    if name != signal and port(signal).kind == "Boolean":
        raise LoomfmuError(f"{way}: {signal} is not a number; a goal must be one")
    return port(signal).unit, port(signal).display


def names_of(scene: Scene) -> list[str]:
    """Return the study's names of the claims of its scene."""
    return [str(claim.get("name") or f"claim_{number + 1}") for number, claim in enumerate(scene.claims)]


def _check_claim(name: Any, names: Sequence[str], where: str) -> None:
    if name not in names:
        known = suggestion(str(name), names)
        raise LoomfmuError(f"{where}: the scene has no claim {shown(name)}{known}")


def required_of(scene: Scene, given: Any) -> tuple[bool, ...]:
    """Return which claims must hold: all but those that are named."""
    if not isinstance(given, list):
        raise LoomfmuError(f"except = {shown(given)} must be a list of claims by their names")
    names = names_of(scene)
    for name in given:
        _check_claim(name, names, "except")
    return tuple(name not in given for name in names)


def safety_of(
    scene: Scene, given: Any, required: Sequence[bool]
) -> tuple[tuple[float, ...], tuple[str, ...]]:
    """Return the distances of claims from their bounds: shares of bounds, and amounts in claims' units."""
    names = names_of(scene)
    if not scene.claims and given:
        raise LoomfmuError(f"safety = {shown(given)}, but the scene has no claims")
    free = [name for name, needed in zip(names, required, strict=True) if not needed]
    table = given if isinstance(given, dict) else {name: given for name in names if name not in free}
    for name in table:
        _check_claim(name, names, "safety")
        if name in free:
            raise LoomfmuError(
                f"safety.{name!r}: except says that this claim may fail; leave out one of them"
            )
    shares, amounts = [], []
    for name in names:
        share, amount = _distance(table.get(name, 0.0), name if isinstance(given, dict) else "")
        shares.append(share)
        amounts.append(amount)
    return tuple(shares), tuple(amounts)


def _distance(given: Any, name: str) -> tuple[float, str]:
    where = f"safety.{name!r}" if name else "safety"
    try:
        share, amount = units.parse(given, "1"), ""
    except units.UnitError as error:
        if not isinstance(given, str) or not name:
            raise LoomfmuError(f"{where}: {error}; give a share of the bound, such as '2 %'") from None
        share, amount = 0.0, given
    if units.is_plain(given) and share > 1.0:
        raise LoomfmuError(f'{where} = {share:g} is {share:.0%} of the bound; write "{share:g} %"')
    if not 0.0 <= share < 1000.0:
        raise LoomfmuError(f"{where} = {share:g} is outside [0, 1000]")
    return share, amount
