"""Numerical errors of verdicts: the run is judged again on coarser steps.

Discretisation errors shrink with the steps: what is missed between samples, the coupling, inputs that a
component knows only at the samples. So the change from coarser runs tells how far the finest one may be off.
The coarser steps are no multiples of the finer ones: an event at a fixed angle, such as a jump of a cam's
velocity, would lie at the same share of a step in all of them, and equal errors would look like none.
"""

import math
import re
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import chain
from typing import NamedTuple

import numpy as np

from ..errors import LoomfmuError
from ..traces import Signals, Verdict
from .claims.claim import Claim
from .claims.movers import whole_turn
from .dependence import Count, Dependence, Judged, Method
from .importing.process import AVAILABLE
from .master.grid import Grid, uniform
from .scenes.instances import altered
from .scenes.scene import Scene

MOST_VALUES = 50_000_000  # that half of a run may have: it is kept in memory

NO_VALUE = "coarser steps give no value: take more steps"
WELL_KNOWN = 180.0  # steps in a revolution, with which numbers are known to their method's `near`
SHARES = (0.62, 0.38, 0.24)  # of the steps: powers of the golden ratio are farthest from fractions
LONGER = 2.0  # times as long as a run is another that shows whether motions have settled
BLOWN = 0.5  # of the size of a signal: what blows that other steps count otherwise may change
SETTLING = 0.5  # of the distance from the bound: nearer, a longer run may fail


class Longer(NamedTuple):
    """A run on the coarsest steps that goes on for longer, such as "4 revolutions".

    `values` are the worst ones of the claims, NaN for those that depend on no motion that could settle.
    """

    length: str
    values: Sequence[float]


@dataclass(frozen=True)
class Coarser:
    """Coarser runs, judged: `wanted` are the claims, counted from 0.

    Without runs `why` says why. `longer` tells of a longer run.
    """

    wanted: Collection[int]
    runs: tuple[Judged, ...] = ()
    why: str = ""
    longer: Longer | None = None


class Estimates:
    """Errors of the verdicts on one scene, by what its claims depend on.

    `run` runs it, with other values, on any grid, and keeps so many `signals`. `deciders` are the claims
    whose numbers decide by their signs what other claims judge: the places of both.
    """

    def __init__(
        self,
        dependence: Dependence,
        run: Callable[[Scene, Grid], Signals],
        signals: int,
        deciders: Mapping[int, int],
    ):
        self.claims, self._dependence = dependence.claims, dependence
        self._run, self._signals, self._deciders = run, signals, deciders
        # what is kept of a run, beside what claims need, to tell whether steps are short enough
        self.shown = (*self._dependence.counters, *self.angles, *self._dependence.curves)
        self.methods = self._dependence.methods

    @property
    def own_claims(self) -> range:
        """The claims of the scene, counted from 0: all but those that only decide others."""
        return range(len(self.claims) - len(self._deciders))

    @property
    def moved(self) -> Mapping[str, Collection[str]]:
        """The instances that steps may be too long for, each with the signals of the angles that move it."""
        return self._dependence.angles

    @property
    def angles(self) -> list[str]:
        """The signals of all angles whose speeds matter."""
        return list(dict.fromkeys(chain.from_iterable(self._dependence.angles.values())))

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
        whole = scene.periods >= 1.0 or scene.step is not None
        moving = [number for number in wanted if whole and number in self._dependence.unsettled]
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
        counted = {each: Count(trace.time, trace[each]) for each in counters if each in trace}
        return Judged(
            worst, counted, {angle: _fastest(trace, angle) for angle in self.angles if angle in trace}
        )

    def of(
        self,
        scene: Scene,
        trace: Signals,
        verdicts: Sequence[Verdict],
        coarser: Coarser,
        exact: Collection[int],
    ) -> tuple[Verdict, ...]:
        """The verdicts, with the errors of those that were judged on coarser steps, too.

        Those that are `exact` are by the mechanisms' own functions: no steps are too long for them.
        """
        found = list(verdicts)
        for number, curve in self._dependence.cornered.items():
            found[number] = replace(found[number], between=curve.judge(trace).between)
        runs = [self.judged(trace, ()), *coarser.runs]
        unshown = self._dependence.unshown(scene, runs, exact)
        for number, why in self._dependence.differing(runs).items():
            if abs(found[number].distance) <= BLOWN * _scale(scene, found[number]):
                unshown.setdefault(number, why)
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
            if coarser.longer and number not in unshown and not counts(trace, found[number]):
                length, values = coarser.longer
                found[number] = _settled(
                    found[number], coarser.runs[-1].worst[number], values[number], length
                )
        for number, name in self._dependence.foreign.items():
            if found[number].decided and not coarser.why:
                found[number] = _noted(
                    found[number], f"{name} may do more within a step than it shows at its ends"
                )
        for number, decider in self._deciders.items():
            value = found[decider]
            if not math.isnan(value.error) and not abs(value.worst) > value.error:
                about = f"{value.signal}, {value.shown(value.worst, 4)}, numerical error {value.shown_error}"
                unshown.setdefault(number, f"decided by the sign of {about}")
        for number, why in unshown.items():
            found[number] = undecided(found[number], why)
        return tuple(found)


def coarseness(scene: Scene) -> float:
    """The factor by which errors may be larger than with steps with which numbers are well known."""
    return max(1.0, WELL_KNOWN / scene.steps_per_period) ** 2


def _fastest(trace: Signals, angle: str) -> float:
    """The highest mean speed of a shaft in any step [rad/s]."""
    speed = np.max(np.abs(np.diff(trace[angle])) / np.diff(trace.time), initial=0.0)
    return float(speed) * math.tau / (whole_turn(trace.unit(angle)) or math.tau)


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
        return undecided(verdict, NO_VALUE)
    spread = max(factor * abs(worst - value) for factor, value in zip(method.factors, coarser, strict=True))
    if counts(trace, verdict):  # which is off by whole numbers
        spread = math.ceil(max(spread, method.miscounted * worst))
    return claim.settled(trace, verdict, spread, method.floor, method.scatter, claim.noise)


def counts(trace: Signals, verdict: Verdict) -> bool:
    """Return whether a verdict's number is a whole one."""
    return verdict.signal in trace and trace[verdict.signal].dtype.kind in "iu"


def _settled(verdict: Verdict, coarsest: float, longer: float, length: str) -> Verdict:
    """The verdict, with a note where the longer run comes at least half as near to the bound.

    What is left to settle shrinks with each repeat, so a motion that has come less near stays within. A
    change that is smaller than what coarse steps change shows nothing.
    """
    change = longer - coarsest
    later, worse = verdict.worst + change, -verdict.sense * change
    fails, by_steps = verdict.decided and not verdict.holds, abs(verdict.worst - coarsest)
    if fails or not worse > max(verdict.error, by_steps, (1.0 - SETTLING) * verdict.distance):
        return verdict
    unsettled = f"not settled: about {verdict.shown(later, 4)} in a run of {length}"
    return replace(_noted(verdict, unsettled), unsettled=unsettled)


def _scale(scene: Scene, verdict: Verdict) -> float:
    """The largest of a verdict's numbers and what is usual for its signal: a bound may be near 0."""
    return max(abs(verdict.bound), abs(verdict.worst), usual(scene, verdict.signal, verdict.unit))


def usual(scene: Scene, signal: str, unit: str) -> float:
    """Return the usual size of a signal that a verdict in a unit names, or the largest of several."""
    named = (each.partition(".") for each in re.findall(r"\w+\.\w+", signal))
    ports = (
        scene.instances[name].fmu.ports.get(variable)
        for name, _, variable in named
        if name in scene.instances
    )
    return max(
        (port.nominal or float(unit == "1") for port in ports if port and port.unit == unit), default=0.0
    )


def _noted(verdict: Verdict, note: str) -> Verdict:
    return replace(verdict, note="; ".join(filter(None, (verdict.note, note))))


def undecided(verdict: Verdict, why: str) -> Verdict:
    """The verdict without a decision, and why."""
    noted = _noted(verdict, why)
    return replace(noted, error=math.inf, spread=math.inf, decided=False, holds=False)


def _unknown(verdict: Verdict, why: str) -> Verdict:
    """A verdict whose error is not known: what holds is undecided."""
    return undecided(verdict, why) if verdict.holds else _noted(verdict, why)


def _coarser(scene: Scene, grid: Grid, share: float) -> Grid | None:
    """Return equal steps, about a share of the scene's number; None where that is not fewer."""
    coarse = uniform(scene, share)
    return coarse if coarse.steps < grid.steps else None
