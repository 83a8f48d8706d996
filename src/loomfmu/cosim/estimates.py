"""Numerical errors of verdicts: the run is judged again on coarser steps.

Discretisation errors shrink with the steps: what is missed between samples, the coupling, inputs that a
component knows only at the samples. So the change from coarser runs tells how far the finest one may be off.
The coarser steps are no multiples of the finer ones: an event at a fixed angle, such as a jump of a cam's
velocity, would lie at the same share of a step in all of them, and equal errors would look like none.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..errors import LoomfmuError, listed
from ..traces import Signals, Verdict
from ..upstream import sources_of, upstream
from ..variables import EXTREMES, MOTION
from .claims.claim import Claim
from .importing.process import AVAILABLE
from .master.grid import SAME, Grid, passed_by, period, uniform
from .planning.requested import SHAFT_ANGLE, signals_of
from .planning.windows import longest_step
from .scenes.graph import Wire, step_order
from .scenes.instances import altered
from .scenes.keys import ITERATED, WINDOWS
from .scenes.scene import Scene

MOST_VALUES = 50_000_000  # that half of a run may have: it is kept in memory


NO_VALUE = "coarser steps give no value: take more steps"
# of the longest step that shows how a mechanism moves: a shaft's ripple takes 16 steps; of 8, three are left
# to the coarsest run
TOO_LONG = 2.0
WELL_KNOWN = 180.0  # steps in a revolution, with which numbers are known to their method's `near`
SHARES = (0.62, 0.38, 0.24)  # of the steps: powers of the golden ratio are farthest from fractions
LONGER = 2.0  # times as long as a run is another that shows whether motions have settled
SETTLING = 0.5  # of the distance from the bound: nearer, a longer run may fail


class Method(NamedTuple):
    """Factors by which the changes from coarser runs give the error of the finest one.

    The estimate is the largest of `factors` times the change from each of the `SHARES` of the steps: two of
    them may be small by chance. `floor` is a share of the value, below which rounding, and what iterations
    leave, hide the order; `scatter` a share of how far the signal has moved since the start, which changes by
    so much whatever the steps. Numbers farther from their bound than the share `near` of it are not estimated
    where only near ones are: it is far above what errors are with a few dozen steps in a revolution.
    """

    factors: tuple[float, float, float]
    floor: float
    near: float
    scatter: float = 0.0


# Between the samples of what depends on the present alone the order is four or more where rates are known,
# and two at a kink: the changes are 6, 47 and 300, or 1.6, 6 and 16 times the error.
PRESENT = Method((3.0, 0.5, 0.06), floor=1e-12, near=0.01)
# An extreme that a component holds is found beyond what it takes for noise of its samples.
HELD = PRESENT._replace(floor=1e-9)
# What has a memory loses its order to two where it hits a stop or a thread goes slack: then the changes are
# 1.6, 6 and 16 times the error.
MEMORY = Method((6.0, 2.0, 0.7), floor=1e-8, near=0.1)
# A loop that carries values of the step before is of order one: the changes are 0.6, 1.6 and 3 times it.
LAGGED = MEMORY._replace(factors=(12.0, 4.0, 2.0))


class Longer(NamedTuple):
    """A run on the coarsest steps that goes on for longer, such as "4 revolutions".

    `values` are the worst ones of the claims, NaN for those that depend on no motion that could settle.
    """

    length: str
    values: Sequence[float]


class Judged(NamedTuple):
    """The worst values of the claims in a run, NaN where there is none, and what was counted of its blows."""

    worst: Sequence[float]
    counted: Mapping[str, int]


@dataclass(frozen=True)
class Coarser:
    """Coarser runs, judged: `wanted` are the claims, counted from 0.

    Without runs `why` says why. `longer` tells of a longer run.
    """

    wanted: Collection[int]
    runs: tuple[Judged, ...] = ()
    why: str = ""
    longer: Longer | None = None


class Dependence:
    """The FMUs that the claims of one scene depend on, and what follows for the errors of their verdicts."""

    def __init__(self, scene: Scene, claims: Sequence[Claim]):
        self._scene, self.claims = scene, claims

    @cached_property
    def _upstream(self) -> list[set[str]]:
        """The instances on which the signals of each claim depend."""
        signals = (signals_of(self._scene, each) for each in self.claims)
        owners = ({signal.partition(".")[0] for signal in each} for each in signals)
        return [set(upstream(each, self._sources)) for each in owners]

    @cached_property
    def _sources(self) -> dict[str, set[str]]:
        return sources_of((wire.source[0], wire.sink[0]) for wire in self._scene.wires)

    @cached_property
    def _lagged(self) -> list[Wire]:
        """The wires that carry values of the step before."""
        _order, closing = step_order(self._scene.instances, self._scene.wires)
        return [] if self._scene.coupling == ITERATED else closing

    @cached_property
    def _avoidable(self) -> list[Wire]:
        """Those of them whose loops are of our own FMUs, and so could be iterated."""
        return [wire for wire in self._lagged if self._is_ours(wire)]

    def _is_ours(self, wire: Wire) -> bool:
        before = upstream([wire.source[0]], self._sources)
        loop = (name for name in before if wire.sink[0] in upstream([name], self._sources))
        return all(self._scene.instances[name].fmu.trusted for name in loop)

    @cached_property
    def kept(self) -> list[set[str]]:
        """What the FMUs keep that each claim depends on."""
        return [
            {MOTION if each is None else each.keeps for each in self._components(names)}
            for names in self._upstream
        ]

    @cached_property
    def foreign(self) -> dict[int, str]:
        """The claims, counted from 0, that depend on a third-party FMU, and its instance."""
        instances = self._scene.instances
        named = (
            next((name for name in sorted(names) if instances[name].fmu.component is None), "")
            for names in self._upstream
        )
        return {number: name for number, name in enumerate(named) if name}

    @cached_property
    def methods(self) -> list[Method]:
        """The method that estimates each claim's error."""
        found = []
        for names, kept in zip(self._upstream, self.kept, strict=True):
            method = MEMORY if MOTION in kept else HELD if EXTREMES in kept else PRESENT
            method = LAGGED if self._lagged else method
            components = self._components(names)
            scatter = max(each.scatter if each else 0.0 for each in components)
            # a blow more or less changes all that follow: no number is far from a bound
            near = math.inf if any(each and each.bounces for each in components) else method.near
            found.append(method._replace(scatter=scatter, near=near))
        return found

    @cached_property
    def counters(self) -> dict[str, list[int]]:
        """The outputs that count contacts, each of which makes a small difference larger, and the claims."""
        found: dict[str, list[int]] = {}
        for number, names in enumerate(self._upstream):
            for name in sorted(names):
                component = self._scene.instances[name].fmu.component
                if component and component.bounces:
                    found.setdefault(f"{name}.{component.bounces}", []).append(number)
        return found

    def differing(self, runs: Sequence[Judged]) -> dict[int, str]:
        """The claims that depend on contacts of which these runs do not count the same, and why."""
        found = dict[int, str]()
        for counter, numbers in self.counters.items():
            counts = {run.counted[counter] for run in runs if counter in run.counted}
            why = f"{counter} is {listed(map(str, sorted(counts)), 'or')} with other steps; take more"
            found |= dict.fromkeys(numbers if len(counts) > 1 else (), why)
        return found

    def _components(self, names: Collection[str]) -> list[Any]:
        return [self._scene.instances[name].fmu.component for name in names]

    def unshown(self, scene: Scene, fastest: float = 0.0) -> dict[int, str]:
        """The claims, counted from 0, of which coarser runs say nothing, and why.

        `fastest` is the speed of the main shaft in a run, where it is faster than its mean speed [rad/s].
        """
        found = dict[int, str]()
        passed = passed_by(scene)
        shown = {name: longest_step(scene, name, fastest) for name in scene.instances}
        for number, names in enumerate(self._upstream):
            longest, why = min((shown[name] for name in names), default=(math.inf, ""))
            if not longest:
                found[number] = f"{why}, so that no steps are known to show its outputs"
            elif scene.step_size > TOO_LONG * longest * (1.0 + SAME):
                found[number] = f"the steps are too long: {why}; {_enough(scene, TOO_LONG * longest)}"
            elif row := next((passed[name] for name in names if name in passed), ""):
                found[number] = row
            elif wire := next((wire for wire in self._avoidable if wire.sink[0] in names), None):
                found[number] = f'{wire} carries the value of the step before; set coupling = "{ITERATED}"'
        return found


class Estimates:
    """Errors of the verdicts on one scene.

    `run` runs it, with other values, on any grid, and keeps so many `signals`.
    """

    def __init__(
        self, scene: Scene, claims: Sequence[Claim], run: Callable[[Scene, Grid], Signals], signals: int
    ):
        self.claims, self._run, self._signals = claims, run, signals
        self._dependence = Dependence(scene, claims)
        self.counters = tuple(self._dependence.counters)

    def coarser(self, scene: Scene, grid: Grid, wanted: Collection[int]) -> Coarser:
        """Judge some claims, counted from 0, on coarser steps than those of a grid."""
        if not wanted:
            return Coarser(wanted)
        for name, instance in scene.instances.items():
            # one that crashes when it is freed must not take the run with it
            if AVAILABLE and not (instance.fmu.trusted or scene.isolates(name)):
                return Coarser(wanted, why=f"{name} runs in this process; set isolated = true")
        runs = []
        for share in SHARES:
            coarse = _coarser(scene, grid, share)
            if coarse is None:
                return Coarser(wanted, why="it takes too few steps for coarser runs")
            if coarse.steps * self._signals > MOST_VALUES:
                return Coarser(wanted, why="the run is too long")
            try:
                runs.append(self.judged(self._run(scene, coarse), wanted))
            except LoomfmuError as error:
                return Coarser(wanted, why=f"with {share:.0%} of the steps, {error}")
        return Coarser(wanted, tuple(runs), longer=self.longer(scene, wanted))

    def longer(self, scene: Scene, wanted: Collection[int]) -> Longer | None:
        """Judge some claims, counted from 0, on a run that goes on for longer; None where none could settle.

        A part of a revolution is chosen for what it leaves out.
        """
        whole = scene.periods >= 1.0
        moving = [number for number in wanted if whole and MOTION in self._dependence.kept[number]]
        longer = altered(scene, periods=LONGER * scene.periods)
        grid = uniform(longer, SHARES[-1])
        if moving and grid.steps * self._signals <= MOST_VALUES:
            with suppress(LoomfmuError):  # a third-party FMU may refuse: nothing is known then
                values = self.judged(self._run(longer, grid), moving).worst
                return Longer(f"{longer.periods:g} {'revolutions' if scene.step is None else 's'}", values)
        return None

    def near(self, scene: Scene, trace: Signals, verdicts: Sequence[Verdict]) -> set[int]:
        """The verdicts, counted from 0, whose numbers are so near their bounds that an error may matter.

        A count is near any bound: one event more may bring others with it.
        """
        coarse, found = coarseness(scene), set[int]()
        for number, (verdict, method) in enumerate(zip(verdicts, self._dependence.methods, strict=True)):
            near = coarse * method.near * _scale(scene, verdict)
            if counts(trace, verdict) or not abs(verdict.worst - verdict.bound) > near:
                found.add(number)
        return found

    def judged(self, trace: Signals, wanted: Collection[int]) -> Judged:
        """Judge some claims on a run."""
        worst = [
            worst_of(claim.judge(trace), trace) if number in wanted else math.nan
            for number, claim in enumerate(self.claims)
        ]
        counters = self._dependence.counters
        return Judged(worst, {each: int(trace[each][-1]) for each in counters if each in trace})

    def of(
        self, scene: Scene, trace: Signals, verdicts: Sequence[Verdict], coarser: Coarser
    ) -> tuple[Verdict, ...]:
        """The verdicts, with the errors of those that were judged on coarser steps, too."""
        found = list(verdicts)
        unshown = self._dependence.unshown(scene, _fastest(trace))
        unshown |= self._dependence.differing([self.judged(trace, ()), *coarser.runs])
        for number in coarser.wanted:
            if coarser.why:
                found[number] = _unknown(found[number], f"numerical error not estimated: {coarser.why}")
                continue
            found[number] = _estimated(
                found[number],
                self.claims[number],
                trace,
                self._dependence.methods[number],
                [run.worst[number] for run in coarser.runs],
            )
            if coarser.longer and number not in unshown:
                change = coarser.longer.values[number] - coarser.runs[-1].worst[number]
                found[number] = _settled(found[number], change, coarser.longer.length)
        for number, name in self._dependence.foreign.items():
            if found[number].decided and not coarser.why:
                found[number] = _noted(
                    found[number], f"{name} may do more within a step than it shows at its ends"
                )
        for number, why in unshown.items():
            found[number] = _undecided(found[number], why)
        return tuple(found)


def coarseness(scene: Scene) -> float:
    """How many times larger errors may be than with steps with which numbers are well known."""
    return max(1.0, WELL_KNOWN / scene.steps_per_period) ** 2


def _fastest(trace: Signals) -> float:
    """The highest mean speed of the main shaft in any step [rad/s]; 0 where the trace does not show it."""
    if SHAFT_ANGLE not in trace:
        return 0.0
    return float(np.max(np.abs(np.diff(trace[SHAFT_ANGLE])) / np.diff(trace.time), initial=0.0))


def worst_of(verdict: Verdict, trace: Signals) -> float:
    """The worst value of a signal, or the one that its component holds, which may lie between samples."""
    role = "lowest" if verdict.sense > 0 else "highest"
    held = verdict.signal in trace and trace.beside(verdict.signal, role)
    between = verdict.error if held and math.isfinite(verdict.error) else 0.0
    return verdict.worst - verdict.sense * between


def _estimated(
    verdict: Verdict, claim: Claim, trace: Signals, method: Method, coarser: Sequence[float]
) -> Verdict:
    worst = worst_of(verdict, trace)
    if not math.isfinite(worst):
        return verdict
    if not all(map(math.isfinite, coarser)):
        if not math.isfinite(verdict.distance):  # it fails for another reason
            return verdict
        return _undecided(verdict, NO_VALUE)
    spread = max(factor * abs(worst - value) for factor, value in zip(method.factors, coarser, strict=True))
    if counts(trace, verdict):
        spread = math.ceil(spread)  # a count is off by whole numbers
    return claim.settled(trace, verdict, spread, method.floor, method.scatter)


def counts(trace: Signals, verdict: Verdict) -> bool:
    """Return whether a verdict's number is a whole one."""
    return verdict.signal in trace and trace[verdict.signal].dtype.kind in "iu"


def _settled(verdict: Verdict, change: float, length: str) -> Verdict:
    """The verdict, with a note where the longer run comes at least half as near to the bound.

    What is left to settle shrinks with each repeat, so a motion that has come less near stays within.
    """
    later, worse = verdict.worst + change, -verdict.sense * change
    fails = verdict.decided and not verdict.holds
    if fails or not worse > max(verdict.error, (1.0 - SETTLING) * verdict.distance):
        return verdict
    unsettled = f"not settled: about {verdict.shown(later, 4)} in a run of {length}"
    return replace(_noted(verdict, unsettled), unsettled=unsettled)


def _scale(scene: Scene, verdict: Verdict) -> float:
    """The largest of a verdict's numbers and what is usual for its signal: a bound may be near 0."""
    name, _, variable = verdict.signal.partition(".")
    port = scene.instances[name].fmu.ports.get(variable) if name in scene.instances else None
    usual = (port.nominal or float(verdict.unit == "1")) if port else 0.0
    return max(abs(verdict.bound), abs(verdict.worst), usual)


def _noted(verdict: Verdict, note: str) -> Verdict:
    return replace(verdict, note="; ".join(filter(None, (verdict.note, note))))


def _undecided(verdict: Verdict, why: str) -> Verdict:
    noted = _noted(verdict, why)
    return replace(noted, error=math.inf, spread=math.inf, decided=False, holds=False)


def _unknown(verdict: Verdict, why: str) -> Verdict:
    """A verdict whose error is not known: what holds is undecided."""
    return _undecided(verdict, why) if verdict.holds else _noted(verdict, why)


def _enough(scene: Scene, longest: float) -> str:
    """Steps that would be short enough."""
    if scene.step is not None:
        return f"set step = {longest:.2g} s or less"
    return f"set steps_per_revolution = {math.ceil(period(scene) / longest - SAME)} or more"


def _coarser(scene: Scene, grid: Grid, share: float) -> Grid | None:
    """Equal steps, about a share of the scene's; None where a grid of equal steps has no more."""
    coarse = uniform(scene, share)
    return coarse if scene.grid == WINDOWS or coarse.steps < grid.steps else None
