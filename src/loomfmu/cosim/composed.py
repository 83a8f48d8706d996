"""Claims on what follows from the time alone: judged on the mechanisms' own functions, not between samples.

Mechanisms without a memory, in turn, are one function of the time. Dual numbers give its value and its slope
at any time, and these a cubic from one time to the next, with what it may be off by. Where a claim's worst
value may lie, the step is divided until that is rounding. What is left is the error of the verdict.
"""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from ..components import COMPONENTS
from ..declaring.upstream import sources_of, upstream
from ..declaring.variables import AT_STEP_END, MOTION, NOTHING
from ..errors import LoomfmuError
from ..traces import Signals, Verdict
from .claims.arguments import TURN
from .claims.claim import Claim
from .claims.conditions import remembers
from .composition import SHARE, Composition
from .estimates import MOST_VALUES, undecided
from .master.grid import period
from .planning.requested import SHAFT_ANGLE, Movements, Requested, output_port
from .scenes.graph import step_order
from .scenes.scene import Scene
from .tangents import Tangents

FEWEST = 2  # steps, which show a slope of rates
SHOWN = 180.0  # steps in a revolution, which show where extremes may lie
ROOM = 4096  # samples more than four times those that are there at first: as a rule they suffice
MOST = 200_000  # samples: only what is rounding everywhere, such as a sum that is always 0, asks for more


class Composed:
    """The claims of a scene that are judged so; `judged` judges them on a run."""

    def __init__(self, requested: Requested, claims: Sequence[Claim]):
        self._scene, self._requested, self._movements = requested.scene, requested, Movements(requested)
        self.claims = {number: each for number, each in enumerate(claims) if self._follows(each)}
        wanted = requested.needed(self.claims.values(), ()) if self.claims else ()
        self._latches = {name: found for name in wanted if (found := self._held(name))}
        bases = [base for base, _sign in self._latches.values()]
        owners = {name.partition(".")[0] for name in wanted}
        self._needed = upstream(owners, self._sources)
        shown = [each for base in bases for each in self._windows(base)]
        self._signals = [
            name
            for name in dict.fromkeys([*wanted, *bases, *shown])
            if name not in self._latches and self._is_smooth(name)
        ]
        try:
            self._tangents = Tangents(self._scene, self._signals) if self.claims else None
        except LoomfmuError:  # without native FMUs
            self.claims = {}

    @property
    def unrated(self) -> set[str]:
        """The signals of these claims of which nothing else tells between samples."""
        names = {name for claim in self.claims.values() for name in claim.signals(self._requested)}
        ports = {name: output_port(self._scene, name, "claim") for name in names}
        return {name for name, port in ports.items() if not (port.rate or any(port.beside))}

    @property
    def needed(self) -> Collection[str]:
        """The instances on which these claims depend."""
        return self._needed

    def composition(self, scene: Scene, run: Signals, room: int) -> Composition:
        """Return what C takes to place so many samples of a run, or of rows, at which they are judged."""
        assert self._tangents is not None and not self._tangents.driven
        windows = {base: self._windows(base) for base, _sign in self._latches.values()}
        return Composition(
            self.claims, self._tangents, self._signals, self._latches, windows, scene, run, room
        )

    # ---- what follows from the time

    def _follows(self, claim: Claim) -> bool:
        """Return whether all that a claim judges follows from the time, by mechanisms of the package."""
        scene, extremes = self._scene, [name for name, _sign in claim.extremes()]
        if not extremes or scene.start_time:
            return False
        signals = claim.signals(self._requested)
        owners = {each.partition(".")[0] for each in self._requested.needed([claim], ())}
        needed = upstream(owners, self._sources)
        components = [scene.instances[name].fmu.component for name in needed]
        if not all(each and COMPONENTS.owns(each) and each.keeps != MOTION for each in components):
            return False
        if any(each.instance in needed for each in scene.drives) or needed & (self._looped | self._late):
            return False
        sources = [".".join(wire.source) for wire in scene.wires if wire.sink[0] in needed]
        whole = getattr(claim, "window", None) is None
        held = {each for each in signals if whole and each in extremes and self._held(each)}
        return all(each in held or self._is_smooth(each) for each in signals) and not any(
            self._remembers(each) for each in sources
        )

    @cached_property
    def _sources(self) -> Mapping[str, set[str]]:
        return sources_of((wire.source[0], wire.sink[0]) for wire in self._scene.wires)

    @cached_property
    def _looped(self) -> set[str]:
        """The instances that take values of the step before."""
        _order, lagged = step_order(self._scene.instances, self._scene.wires)
        return {wire.sink[0] for wire in lagged}

    @cached_property
    def _late(self) -> set[str]:
        """The instances whose inputs are those of the start of each step."""
        return {
            name
            for name, each in self._scene.instances.items()
            if AT_STEP_END in each.fmu.ports and not each.start(AT_STEP_END)
        }

    def _variable(self, signal: str) -> Any:
        instance, _, variable = signal.partition(".")
        facts = self._scene.instances[instance].fmu.facts
        return facts.variables[variable] if facts else None

    def _remembers(self, signal: str) -> bool:
        component = self._scene.instances[signal.partition(".")[0]].fmu.component
        return component is None or (component.keeps != NOTHING and remembers(self._variable(signal)))

    def _is_smooth(self, signal: str) -> bool:
        """Return whether an output is a real number that samples show."""
        variable, port = self._variable(signal), output_port(self._scene, signal, "claim")
        known = port.causality == "output" and port.kind == "Real" and not any(port.beside[:2])
        return known and variable is not None and not variable.brief and not self._remembers(signal)

    def _held(self, signal: str) -> tuple[str, float] | None:
        """Return the output of which this one holds the lowest values, or with -1 the highest ones."""
        variable = self._variable(signal)
        if variable is None:
            return None
        for base, sign in ((variable.lowest_of, 1.0), (variable.highest_of, -1.0)):
            name = f"{signal.partition('.')[0]}.{base}"
            if base and variable.type is float and self._is_smooth(name):
                return name, sign
        return None

    def _windows(self, signal: str) -> list[str]:
        """Return the outputs that are all positive where the extremes of an output lie."""
        instance = signal.partition(".")[0]
        component = self._scene.instances[instance].fmu.component
        return [f"{instance}.{each}" for each in component.windows] if component else []

    # ---- verdicts

    def judged(self, scene: Scene, run: Signals, wanted: Iterable[int]) -> dict[int, Verdict]:
        """Judge the wanted ones of the claims on a run of this scene, which differs in values alone."""
        claims = {number: self.claims[number] for number in wanted if number in self.claims}
        if not claims:
            return {}
        steps = self._steps(scene, run)
        if steps * len(self._signals) > MOST_VALUES:
            why = "numerical error not estimated: the run is too long"
            return {number: undecided(claim.judge(run), why) for number, claim in claims.items()}
        asked = np.array([number in claims for number in self.claims])
        most = max(MOST, 2 * steps)
        for room in sorted({min(4 * steps + ROOM, most), most}):
            composition = self.composition(scene, run, room)
            samples, off = composition.placed(steps, asked)
            if composition.struct.complete:
                break  # else what is left is the error
        left = dict(zip(self.claims, off, strict=True))
        return {
            number: claim.settled(samples, claim.judge(samples), 0.0, SHARE, 0.0, float(left[number]))
            for number, claim in claims.items()
        }

    def _steps(self, scene: Scene, run: Signals) -> int:
        """Return how many equal steps show how all mechanisms move."""
        movements, end = self._movements, float(run.time[-1])
        longest = [movements.longest_step(scene, name)[0] for name in self._needed]
        speeds = (movements.mean_speed(scene, name) for name in self._needed if not self._by_main_shaft(name))
        own = min((TURN / abs(speed) for speed in speeds if speed), default=math.inf)
        return int(self.steps(end, min(period(scene), own), longest))

    @property
    def by_main_shaft(self) -> bool:
        """Return whether all that these claims depend on moves with the main shaft."""
        return all(self._by_main_shaft(name) for name in self._needed)

    def _by_main_shaft(self, name: str) -> bool:
        moved = self._movements.angles(name) == (SHAFT_ANGLE,) or f"{name}.angle" == SHAFT_ANGLE
        return moved and self._scene.step is None

    def steps(self, end: Any, of_period: Any, longest: Sequence[float]) -> Any:
        """Return the number of equal steps to an end, or to several, that show how mechanisms move."""
        shortest = np.minimum(of_period / SHOWN, min((each for each in longest if each), default=np.inf))
        with np.errstate(over="ignore"):
            return np.ceil(np.clip(end / shortest, FEWEST, MOST_VALUES))
