"""How far the numbers of verdicts may be off: the run is judged again on half and on a quarter of its steps.

All that the steps do to a number shrinks with them: what is missed between samples, what is lost in the
coupling, what a component makes of inputs that it knows only at the samples. So the numbers of coarser runs
tell how far the finest one may be off.
"""

import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ..errors import LoomfmuError
from ..traces import Signals, Verdict
from ..upstream import sources_of, upstream
from ..variables import EXTREMES, MOTION
from .claims.claim import Claim
from .master.grid import Grid, chosen, kinks
from .planning.requested import signals_of
from .scenes.graph import step_order
from .scenes.keys import ITERATED
from .scenes.scene import Scene

MOST_VALUES = 50_000_000  # that half of a run may have: it is kept in memory


class Method(NamedTuple):
    """What the differences between resolutions say about the error of the finest one.

    The estimate is `halved` times the change from all steps to half of them, or `quartered` times the further
    change to a quarter if that is more: it counts where the first one is small by chance. `floor` is a share
    of the value, below which rounding, and what iterations leave, hide the order. Numbers farther from
    their bound than the share `near` of it are not estimated where only near ones are: it is far above what
    errors are with a few dozen steps in a revolution.
    """

    halved: float
    quartered: float
    floor: float
    near: float


# Between the samples of what depends on the present alone the order is four or more where rates are known,
# and two where they are not: differences are 3 times the error or more.
PRESENT = Method(halved=1.0, quartered=1.0 / 16.0, floor=1e-12, near=0.01)
# An extreme that a component holds is found beyond what it takes for noise of its samples.
HELD = Method(halved=1.0, quartered=1.0 / 16.0, floor=1e-9, near=0.01)
# What has a memory loses its order to two where it hits a stop or a thread goes slack, and to one where a
# loop carries values of the step before.
MEMORY = Method(halved=2.0, quartered=1.0 / 4.0, floor=1e-9, near=0.1)


@dataclass(frozen=True)
class Coarser:
    """The worst value of each claim on half and on a quarter of the steps, NaN where there is none.

    `wanted` are the claims, counted from 0, that were judged. Without values `why` says why.
    """

    wanted: Collection[int]
    half: tuple[float, ...] = ()
    quarter: tuple[float, ...] = ()
    why: str = ""


class Estimates:
    """Errors of the verdicts on one scene.

    `run` runs it, with other values, on any grid, and keeps so many `signals`.
    """

    def __init__(
        self, scene: Scene, claims: Sequence[Claim], run: Callable[[Scene, Grid], Signals], signals: int
    ):
        self._scene, self.claims, self._run, self._signals = scene, claims, run, signals

    @cached_property
    def _methods(self) -> list[Method]:
        """How each claim's error is estimated, by what its signals depend on."""
        scene = self._scene
        _order, lagged = step_order(scene.instances, scene.wires)
        delayed = bool(lagged) and scene.coupling != ITERATED
        sources = sources_of((wire.source[0], wire.sink[0]) for wire in scene.wires)
        found = []
        for claim in self.claims:
            owners = {signal.partition(".")[0] for signal in signals_of(scene, claim)}
            components = [scene.instances[name].fmu.component for name in upstream(owners, sources)]
            kept = {MOTION if each is None else each.keeps for each in components}
            found.append(MEMORY if MOTION in kept or delayed else HELD if EXTREMES in kept else PRESENT)
        return found

    def coarser(self, scene: Scene, grid: Grid, wanted: Collection[int]) -> Coarser:
        """What some claims, counted from 0, give on coarser steps than those of a grid."""
        if not wanted:
            return Coarser(wanted)
        for name, instance in scene.instances.items():
            # one that crashes when it is freed must not take the run with it
            if not (instance.fmu.trusted or scene.isolates(name)):
                return Coarser(wanted, why=f"{name} runs in this process; set isolated = true")
        values = []
        for part in ("half", "a quarter"):
            found = _thinned(scene, grid)
            if found is None:
                break
            grid = found
            if grid.steps * self._signals > MOST_VALUES:
                return Coarser(wanted, why="the run is too long")
            try:
                values.append(self.worst(self._run(scene, grid), wanted))
            except LoomfmuError as error:
                if not values:
                    return Coarser(wanted, why=f"with {part} of the steps, {error}")
        if not values:
            return Coarser(wanted, why="its steps cannot be halved")
        return Coarser(wanted, values[0], values[1] if len(values) > 1 else (math.nan,) * len(self.claims))

    def near(self, verdicts: Sequence[Verdict]) -> set[int]:
        """The verdicts, counted from 0, whose numbers are so near their bounds that an error may matter."""
        return {
            number
            for number, (verdict, method) in enumerate(zip(verdicts, self._methods, strict=True))
            if not verdict.bound or abs(verdict.relative_distance) <= method.near
        }

    def worst(self, trace: Signals, wanted: Collection[int]) -> tuple[float, ...]:
        """The worst value of each claim on a run, NaN for those that are not wanted."""
        return tuple(
            claim.judge(trace).worst if number in wanted else math.nan
            for number, claim in enumerate(self.claims)
        )

    def of(self, trace: Signals, verdicts: Sequence[Verdict], coarser: Coarser) -> tuple[Verdict, ...]:
        """The verdicts, with the errors of those that were judged on coarser steps, too."""
        found = list(verdicts)
        for number in coarser.wanted:
            if coarser.why:
                found[number] = _noted(found[number], f"numerical error not estimated: {coarser.why}")
                continue
            found[number] = _estimated(
                found[number], self.claims[number], trace, self._methods[number],
                coarser.half[number], coarser.quarter[number],
            )  # fmt: skip
        return tuple(found)


def _estimated(
    verdict: Verdict, claim: Claim, trace: Signals, method: Method, half: float, quarter: float
) -> Verdict:
    worst = verdict.worst
    if not math.isfinite(worst):
        return verdict
    if not math.isfinite(half):
        if not math.isfinite(verdict.distance):  # it fails for another reason
            return verdict
        note = "half of the steps give no value: take more steps"
        return replace(_noted(verdict, note), decided=False, holds=False)
    changes = [method.halved * abs(worst - half), method.quartered * abs(half - quarter)]
    spread = max(change for change in changes if math.isfinite(change))
    floor = max(claim.noise, method.floor * max(abs(worst), abs(verdict.bound)))
    return verdict.estimated(max(spread, claim.left_by_model(trace, verdict), floor), spread)


def _noted(verdict: Verdict, note: str) -> Verdict:
    return replace(verdict, note="; ".join(filter(None, (verdict.note, note))))


def _thinned(scene: Scene, grid: Grid) -> Grid | None:
    """Every other point of a grid, its last one and its kinks; None where there are none between, or steps
    must be equal and would not be."""
    if grid.points is None and grid.steps % 2 == 0:
        return replace(grid, steps=grid.steps // 2, step_size=2.0 * grid.step_size, rate=0.5 * grid.rate)
    if grid.steps < 2 or any(instance.fmu.fixed_step for instance in scene.instances.values()):
        return None
    points = np.arange(grid.steps + 1) * grid.step_size if grid.points is None else grid.points
    kept = np.append(points[:-2:2], points[-1])  # of an odd number the last step has three
    return chosen(scene, np.union1d(kept, kinks(scene)))
