"""Rates of outputs that no output gives: by the equations of their mechanisms, with dual numbers.

An output then has a curve between its samples, as one whose rate is recorded. This is for mechanisms without
a memory, whose outputs follow the shaft: what happens within a step of others may not show at its ends.
"""

from collections.abc import Collection, Iterable, Mapping
from contextlib import suppress

import numpy as np

from ..components import COMPONENTS
from ..declaring.upstream import sources_of, upstream
from ..declaring.variables import NOTHING
from ..errors import LoomfmuError
from ..traces import Signals
from ..traces.extended import Extended
from .claims.bounded import Bounded
from .claims.claim import Claim
from .master.grid import Grid
from .planning.requested import Requested
from .scenes.scene import Scene
from .tangents import Tangents


class Rates:
    """The rates of signals that claims bound, and that have none: of those that no other claim is on."""

    def __init__(self, requested: Requested, claims: Iterable[Claim]):
        self._tangents: Tangents | None = None
        bounded, others = dict[str, None](), set[str]()
        for claim in claims:
            signals = dict.fromkeys(claim.signals(requested))
            if isinstance(claim, Bounded) and not claim.at_samples:
                bounded |= signals
            elif not isinstance(claim, Bounded):
                others |= signals.keys()  # these take a jump of the samples for one, not for a curve
        scene = requested.scene
        sources = sources_of((wire.source[0], wire.sink[0]) for wire in scene.wires)
        self.signals = [each for each in bounded if each not in others and _lacks(scene, sources, each)]
        if self.signals:
            with suppress(LoomfmuError):  # without a compiler, or in a loop
                self._tangents = Tangents(scene, self.signals)

    def added(self, scene: Scene, grid: Grid, run: Signals) -> Signals:
        """Return a run of this scene, which differs in values alone, on a grid, with these rates."""
        if self._tangents is None:
            return run
        found, count = self._tangents.rates(scene, grid), len(run.time)
        made = {
            name: rates[:count]
            for name, (values, rates) in found.items()
            if np.array_equal(values[:count], run[name]) and np.isfinite(rates).all()
        }
        names = {name: f"rate of {name}" for name in made}
        return Extended(run, {names[name]: rates for name, rates in made.items()}, names)


def _lacks(scene: Scene, sources: Mapping[str, Collection[str]], signal: str) -> bool:
    """Return whether an output has no rate, and its equations give one; `sources` feed each instance."""
    owner, _, variable = signal.partition(".")
    port = scene.instances[owner].fmu.ports[variable]
    if port.causality != "output" or port.kind != "Real" or port.rate:
        return False
    needed = upstream([owner], sources)
    components = (scene.instances[name].fmu.component for name in needed)
    follows = all(each is not None and COMPONENTS.owns(each) and each.keeps == NOTHING for each in components)
    return follows and not any(drive.instance in needed for drive in scene.drives)
