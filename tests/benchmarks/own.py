"""Our master as a configuration: it runs a scene, with or without a trace."""

import math
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import perf_counter
from types import ModuleType
from typing import Any

import numpy as np
from children import Timing
from numpy.typing import NDArray
from records import ROOT

import loomfmu
from loomfmu.cosim import prepared
from loomfmu.cosim.importing import fmus
from loomfmu.cosim.master.master import Master
from loomfmu.cosim.scenes import scene as scenes
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.traces import ROWS

DEMO = ROOT / "sims" / "wl680_3600.toml"
# all counts of steps divide this one, and a step is a whole number of nanoseconds, as libcosim counts them
FINEST = 11520
SPEED = 2.0 * math.pi / (FINEST * 8680e-9)  # rad/s: 600.04 rev/min

ENGINES = {"Python": False, "C": True}  # what makes the calls of a step, and the option that chooses it

Signals = dict[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Source:
    """Where a scene comes from, as it is handed to another process."""

    text: str
    overrides: dict[str, Any] = field(default_factory=dict)
    judged: bool = False  # whether it keeps its claims

    def scene(self, steps: int = 1440, turns: float = 1.0) -> Scene:
        """So many revolutions of it, with so many steps in each."""
        whole = max(1, round(turns * steps)) / steps  # a run has whole steps
        given = {"steps_per_revolution": steps, "revolutions": whole} | self.overrides
        scene = scenes.parse(self.text, "benchmark", given)
        return scene if self.judged else replace(scene, claims=[])


def demo(judged: bool = False, **overrides: Any) -> Source:
    """The demonstration loom."""
    return Source(DEMO.read_text(encoding="utf-8"), {"shaft.speed": SPEED} | overrides, judged)


def with_fmus(scene: Scene, flavour: str) -> Scene:
    """The scene with all FMUs of that flavour."""
    given = {
        name: replace(each, fmu=fmus.of_component(each.fmu.name, flavour))
        for name, each in scene.instances.items()
    }
    return replace(scene, instances=given)


def unrecorded(*_block: Any) -> None:
    """Takes a block of samples and forgets it."""


class StopWatch:
    """Times a function of a module while it is called from there."""

    def __init__(self, module: ModuleType, name: str):
        self.module, self.name = module, name
        self.seconds = 0.0

    def __enter__(self) -> "StopWatch":
        self._original = getattr(self.module, self.name)
        setattr(self.module, self.name, self._timed)
        return self

    def __exit__(self, *_: Any) -> None:
        setattr(self.module, self.name, self._original)

    def _timed(self, *arguments: Any) -> Any:
        start = perf_counter()
        try:
            return self._original(*arguments)
        finally:
            self.seconds += perf_counter() - start


class Ours:
    """A scene under our master, all of it recorded to HDF5."""

    def __init__(self, directory: Path, source: Source, flavour: str):
        self.directory, self.source, self.flavour = directory, source, flavour
        self.run(source.scene())  # FMUs are built and their instances kept

    def run(self, scene: Scene, kept: tuple[str, ...] = ()) -> Any:
        """Run a scene; its result. All signals are kept."""
        return loomfmu.run(scene, output=self.directory / "trace.h5", flavour=self.flavour)

    def time(self, steps: int, turns: float) -> Timing:
        """Seconds for all but the steps, and for a revolution of them with its recording."""
        scene = self.source.scene(steps, turns)
        start = perf_counter()
        with StopWatch(prepared, "record") as stepping:
            self.run(scene)
        whole = perf_counter() - start
        return Timing(whole - stepping.seconds, stepping.seconds / turns)

    def signals(self, names: tuple[str, ...], steps: int) -> Signals:
        """Signals along their times, in one revolution."""
        trace = self.run(self.source.scene(steps), names).trace
        found = {name: np.asarray(trace[name], dtype=float) for name in names}
        return {"time": trace.time, **found}

    def explained(self, steps: int) -> str:
        """What a run of one revolution says that it leaves out."""
        result = self.run(self.source.scene(steps))
        return "; ".join(result.skipped)


class Judged(Ours):
    """The claims of a scene judged from memory: nothing is run or written that they do not need."""

    def run(self, scene: Scene, kept: tuple[str, ...] = ()) -> Any:
        """Run a scene and keep some signals; its result."""
        return loomfmu.evaluate(scene, flavour=self.flavour, values=kept, errors="none")

    def time(self, steps: int, turns: float) -> Timing:
        """Seconds to set up, and for a revolution with its judging: from a run of so many and one of one."""
        whole, one = self._timed(steps, turns), self._timed(steps, 1.0)
        turn = (whole - one) / (turns - 1.0)
        return Timing(one - turn, turn)

    def _timed(self, steps: int, turns: float) -> float:
        scene = self.source.scene(steps, turns)
        start = perf_counter()
        self.run(scene)
        return perf_counter() - start


class Stepped(Ours):
    """A scene under our master with all FMUs that it names, its samples dropped; the steps alone are timed.

    `engine` names what makes the calls.
    """

    def __init__(self, directory: Path, source: Source, flavour: str, engine: str):
        self.compiled = ENGINES[engine]
        super().__init__(directory, source, flavour)

    def run(self, scene: Scene, kept: tuple[str, ...] = ()) -> float:
        """Run a scene; seconds for its steps. No signal is kept."""
        with Master(with_fmus(scene, self.flavour), compiled=self.compiled) as master:
            master.initialize()
            start = perf_counter()
            master.run(ROWS, unrecorded, unrecorded)
            return perf_counter() - start

    def time(self, steps: int, turns: float) -> Timing:
        """Seconds to set up, and for a revolution."""
        start = perf_counter()
        duration = self.run(self.source.scene(steps, turns))
        return Timing(perf_counter() - start - duration, duration / turns)
