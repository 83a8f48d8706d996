"""Dependence of claims on FMUs, and what follows for the errors of their verdicts.

The FMUs upstream of a claim say by which method its error is estimated, and whether steps show what they do.
"""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from ..components import COMPONENTS
from ..declaring.upstream import sources_of, upstream
from ..declaring.variables import EXTREMES, MOTION
from ..errors import listed
from ..traces.signals import Floats, Integers
from .claims.bounded import Bounded
from .claims.claim import Claim
from .claims.expressions import is_expression
from .claims.movers import movers_of
from .master.grid import SAME, contradicted, passed_by, period
from .planning.requested import Movements, Requested
from .scenes.graph import Wire, step_order
from .scenes.scene import Scene
from .scenes.settings import ITERATED, MOST_STEPS

# of the longest step that shows how a mechanism moves: a shaft's ripple takes 16 steps; of 8, three are left
# to the coarsest run
TOO_LONG = 2.0


class Method(NamedTuple):
    """Factors by which the changes from coarser runs give the error of the finest one.

    The estimate is the largest of `factors` times the change from each of the `SHARES` of the steps: two of
    them may be small by chance. `floor` is a share of the value, below which rounding, and what iterations
    leave, hide the order; `scatter` a share of how far the signal has moved since the start, which changes by
    so much whatever the steps. A count is off by the share `miscounted` of it at least, rounded up. Numbers
    farther from their bound than the share `near` of it are not estimated where only near ones are: it is far
    above what errors are with a few dozen steps in a revolution.
    """

    factors: tuple[float, float, float]
    floor: float
    near: float
    scatter: float = 0.0
    miscounted: float = 0.0


# Between the samples of what depends on the present alone the order is four or more where rates are known,
# and two at a kink: the changes are 6, 47 and 300, or 1.6, 6 and 16 times the error.
PRESENT = Method((3.0, 0.5, 0.06), floor=1e-12, near=0.01)
# An extreme that a component holds is found beyond what it takes for noise of its samples: up to 2e-9 of it
# was missed beside steep tables, whatever the steps.
HELD = PRESENT._replace(floor=4e-9)
# What has a memory loses its order to two where it hits a stop or a thread goes slack: then the changes are
# 1.6, 6 and 16 times the error.
MEMORY = Method((6.0, 2.0, 0.7), floor=1e-8, near=0.1)
# Each blow makes a difference larger, by no order of the steps: one more or less changes all that follow, so
# that no number is far from a bound.
BOUNCING = MEMORY._replace(factors=(12.0, 4.0, 2.0), near=math.inf, miscounted=0.05)
# A loop that carries values of the step before is of order one: the changes are 0.6, 1.6 and 3 times it.
LAGGED = MEMORY._replace(factors=(12.0, 4.0, 2.0))

# The curve of a mechanism of one's own may have a corner at its extreme: what is held there is of order one.
CORNER = LAGGED._replace(floor=HELD.floor)


class Count(NamedTuple):
    """A number of blows so far [1] over time [s], each of shape (samples,)."""

    time: Floats
    blows: Integers

    def follows(self, finer: "Count") -> bool:
        """Return whether each blow of a run on finer steps comes here, too, within a step of it."""
        step = float(np.max(np.diff(self.time), initial=0.0)) * (1.0 + SAME)
        earliest, latest = finer.until(self.time - step), finer.until(self.time + step)
        return bool(np.all((earliest <= self.blows) & (self.blows <= latest)))

    def until(self, time: Floats) -> Integers:
        """The blows so far at times that need be no samples."""
        return self.blows[np.maximum(np.searchsorted(self.time, time, side="right") - 1, 0)]


class Judged(NamedTuple):
    """A run, judged: the worst values of the claims, NaN where there is none, its blows, and its speeds.

    `counted` has the blows by the signal that counts them, `speeds` the highest mean speed in any step
    [rad/s] by the signal of a shaft's angle.
    """

    worst: Sequence[float]
    counted: Mapping[str, Count]
    speeds: Mapping[str, float]


class Dependence:
    """The FMUs that the claims of one scene depend on, and what follows for the errors of their verdicts."""

    def __init__(self, requested: Requested, claims: Sequence[Claim]):
        self._scene, self.claims = requested.scene, claims
        self._requested, self._movements = requested, Movements(requested)

    @cached_property
    def _upstream(self) -> list[set[str]]:
        """The instances on which the signals of each claim depend."""
        signals = (claim.signals(self._requested) for claim in self.claims)
        owners = ({signal.partition(".")[0] for signal in each} for each in signals)
        return [set(upstream(owner, self._sources)) for owner in owners]

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
        """Return whether some loop through a wire is of our own FMUs alone."""
        ours = {name for name, instance in self._scene.instances.items() if instance.fmu.trusted}
        sources = {name: source & ours for name, source in self._sources.items() if name in ours}
        return wire.sink[0] in upstream([wire.source[0]], sources) and wire.source[0] in ours

    @cached_property
    def memories(self) -> list[set[str]]:
        """The kinds of memory of the FMUs that each claim depends on."""
        return [
            {MOTION if each is None else each.keeps for each in self._components(names)}
            for names in self._upstream
        ]

    @cached_property
    def unsettled(self) -> set[int]:
        """The claims, counted from 0, on what a longer run may change.

        Mechanisms of the package without a memory repeat with the shaft and the weave.
        """
        return {
            number
            for number, names in enumerate(self._upstream)
            if MOTION in self.memories[number]
            or not all(map(COMPONENTS.owns, self._components(names)))
            or len(movers_of(names, self._requested)) > 1
        }

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
        for names, memories in zip(self._upstream, self.memories, strict=True):
            components = self._components(names)
            held = HELD if all(map(COMPONENTS.owns, components)) else CORNER
            method = MEMORY if MOTION in memories else held if EXTREMES in memories else PRESENT
            method = LAGGED if self._lagged else method
            method = BOUNCING if any(component and component.bounces for component in components) else method
            found.append(
                method._replace(
                    scatter=max(component.scatter if component else 0.0 for component in components)
                )
            )
        return found

    @cached_property
    def cornered(self) -> dict[int, Bounded]:
        """Claims on the curves of which mechanisms of one's own hold extremes, by the claims on these.

        How far a curve may be off beside its samples, as at a corner, may not show in coarser runs.
        """
        found = dict[int, Bounded]()
        for number, claim in enumerate(self.claims):
            if not isinstance(claim, Bounded) or is_expression(claim.signal) or claim.window:
                continue
            name, _, held = claim.signal.partition(".")
            fmu = self._scene.instances[name].fmu
            known = fmu.facts.extremes if fmu.facts and not COMPONENTS.owns(fmu.component) else {}
            base, sign = known.get(held, (held, 0.0))
            if base != held and sign == claim.sense:
                rated = bool(fmu.ports[base].rate)
                found[number] = replace(claim, signal=f"{name}.{base}", at_samples=not rated)
        return found

    @property
    def curves(self) -> list[str]:
        """The signals of these curves, with their rates."""
        return self._requested.with_rates(claim.signal for claim in self.cornered.values())

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
        """The claims that depend on blows that these runs, the finest first, do not share, and why.

        Equal numbers do not suffice: a blow that is missed may be made up for by another one later.
        """
        found = dict[int, str]()
        for counter, numbers in self.counters.items():
            counts = [run.counted[counter] for run in runs if counter in run.counted]
            totals = {int(count.blows[-1]) for count in counts}
            if len(totals) > 1:
                how = f"is {listed(map(str, sorted(totals)), 'or')}"
            elif not all(count.follows(counts[0]) for count in counts[1:]):
                how = "counts blows at other times"
            else:
                continue
            found |= dict.fromkeys(numbers, f"{counter} {how} with other steps; take more steps")
        return found

    @cached_property
    def _passing(self) -> list[str]:
        """The instances upstream of claims that some steps may be too long for."""
        names = dict.fromkeys(name for each in self._upstream for name in sorted(each))
        return [name for name in names if self._movements.may_pass_by(name)]

    def _components(self, names: Collection[str]) -> list[Any]:
        return [self._scene.instances[name].fmu.component for name in names]

    @cached_property
    def angles(self) -> dict[str, set[str]]:
        """The signals of the angles by which instances move for which steps may be too long."""
        return {name: {*self._movements.angles(name)} for name in self._passing}

    def unshown(
        self, scene: Scene, runs: Sequence[Judged] = (), exact: Collection[int] = ()
    ) -> dict[int, str]:
        """The claims, counted from 0, of which coarser runs say nothing, and why; `runs` show speeds.

        Steps of the run do not matter for those that are `exact`.
        """
        found = dict[int, str]()
        passed = passed_by(scene) | contradicted(scene)
        speeds = {
            name: max(
                (run.speeds[angle] for run in runs for angle in angles & run.speeds.keys()), default=None
            )
            for name, angles in self.angles.items()
        }
        shown = {name: self._movements.longest_step(scene, name, speeds[name]) for name in self._passing}
        for number, names in enumerate(self._upstream):
            longest, why = min((shown[name] for name in names if name in shown), default=(math.inf, ""))
            if not longest:
                found[number] = f"{why}, so that no steps are known to show its outputs"
            elif number not in exact and scene.step_size > TOO_LONG * longest * (1.0 + SAME):
                found[number] = f"the steps are too long: {why}; {_enough(scene, TOO_LONG * longest)}"
            elif row := next((passed[name] for name in names if name in passed), ""):
                found[number] = row
            elif wire := next((wire for wire in self._avoidable if wire.sink[0] in names), None):
                found[number] = f'{wire} carries the value of the step before; set coupling = "{ITERATED}"'
        return found


def _enough(scene: Scene, longest: float) -> str:
    """Steps that would be short enough."""
    if scene.step is not None:
        return f"set step = {longest:.2g} s or less"
    steps = period(scene) / longest - SAME
    if steps > MOST_STEPS:
        return "more than any that a scene can have are needed"
    return f"set steps_per_revolution = {math.ceil(steps)} or more"
