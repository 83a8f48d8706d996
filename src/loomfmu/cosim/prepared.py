"""Scenes that were prepared: what does not depend on values is done once, for as many runs as are wanted."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

from ..errors import LoomfmuError, path_of, shown
from .importing import pool
from .importing.fmus import Flavour
from .master.grid import Grid, uniform
from .master.master import Interrupted
from .planning.plan import InMemory, Stepping, build_needed, ended_text, explained, record
from .planning.requested import check_bounds, claims_of, judged_by, recorded, shaft_angle, with_rates
from .planning.windows import window_grid
from .reading import check_set, checked
from .recorded import bar, finish, kept, target_of, writer_of
from .results import Evaluation, Result
from .scenes.scene import WINDOWS, Scene
from .scenes.values import Values

MOST_PATTERNS = 8  # that are kept ready, such as one for each machine


class Pattern:
    """A scene that is read, wired and planned, for runs that differ in values alone."""

    def __init__(self, scene: Scene, values: Sequence[str]):
        self.scene = scene
        self.values = Values(scene)
        self.claims = claims_of(scene)
        wanted = with_rates(scene, [*shaft_angle(scene), *values])
        self.judged = tuple(dict.fromkeys([*wanted, *judged_by(scene)]))
        self._steppings: dict[tuple[str, ...], Stepping] = {}

    def stepping(self, signals: Sequence[str]) -> Stepping:
        """What runs the scene with only what these signals need."""
        key = tuple(signals)
        if key not in self._steppings:
            self._steppings[key] = Stepping(self.scene, key)
        return self._steppings[key]

    def with_values(self, values: Mapping[str, Any], overrides: dict[str, Any]) -> Scene:
        """The scene with other values, out of all its overrides.

        Raises LoomfmuError for what must be read anew.
        """
        scene = self.values.set(values, overrides)
        check_bounds(scene, self.claims)
        return scene

    def grid(self, scene: Scene, signals: Sequence[str]) -> Grid:
        """The communication points of a run that keeps these signals."""
        if scene.grid != WINDOWS:
            return uniform(scene)
        return window_grid(scene, signals, self._in_memory)

    def _in_memory(self, scene: Scene, signals: Sequence[str], grid: Grid) -> InMemory:
        return self.stepping(signals).in_memory(scene, grid)

    def evaluate(self, scene: Scene) -> Evaluation:
        """Run what the claims of the scene need, and judge them."""
        found = self._in_memory(scene, self.judged, self.grid(scene, self.judged))
        verdicts = tuple(claim.judge(found.recording) for claim in self.claims)
        return Evaluation(
            scene, verdicts, (*scene.notes, *found.warnings), explained(found.plan), found.steps,
            found.recording, ended=ended_text(found.ended),
        )  # fmt: skip

    def run(self, scene: Scene, path: Path, flavour: str, overwrite: bool, progress: bool) -> Result:
        """Run the scene, record it to a file, and judge its claims."""
        signals = recorded(scene)
        stepping = self.stepping(signals)
        plan = stepping.plan(scene, self.grid(scene, signals))
        build_needed(plan.pruned.scene, report=progress)
        target = target_of(plan, path, overwrite, progress)
        with stepping.stepped(plan) as master:
            if master.interrupted.value:
                raise KeyboardInterrupt("interrupted before the first step")
            writer = writer_of(plan, stepping.channels, path, target, flavour)
            with kept(writer, path), bar(plan, progress) as advance:
                begun = perf_counter()
                record(master, writer, advance)
                seconds = perf_counter() - begun
                if master.interrupted.value:
                    raise Interrupted
            # while the instances are still there: one that crashes when it is freed takes nothing with it
            verdicts, trace = finish(self.claims, writer, path, ended_text(master.ended))
            warnings = (*scene.notes, *master.warnings())
        return Result(
            scene, verdicts, warnings, explained(plan), master.steps, path, trace,
            ended=ended_text(master.ended), seconds=seconds,
        )  # fmt: skip


class Prepared:
    """A scene that was prepared by `loomfmu.prepare`, to be run with as many values as are wanted.

    Values that change what was prepared, such as a machine, a pattern or a component, are prepared when they
    first come. Results stay valid after the next run. Threads take turns. `close`, or the end of a `with`
    statement, frees the instances; a copy in another process is prepared there.
    """

    def __init__(
        self, scene: str | Path | Scene, overrides: dict[str, Any] | None, flavour: Flavour,
        values: Sequence[str],
    ):  # fmt: skip
        if not isinstance(values, list | tuple) or not all(isinstance(signal, str) for signal in values):
            raise LoomfmuError(f'values = {shown(values)} is not a list such as ["belt.margin"]')
        self._values, self._flavour = tuple(values), flavour
        self._base = Pattern(checked(scene, overrides, flavour), self._values)
        self._patterns: OrderedDict[str, Pattern] = OrderedDict()
        self._turn = threading.Lock()

    @property
    def scene(self) -> Scene:
        """The scene with the values that it was prepared with."""
        return self._base.scene

    def __repr__(self) -> str:
        return f"<Prepared {self.scene.name}: {len(self.scene.claims)} claims>"

    def evaluate(self, set: dict[str, Any] | None = None) -> Evaluation:
        """Run what the claims need with these values, and judge them; as `loomfmu.evaluate`."""
        with self._turn:
            pattern, scene = self._ready(set)
            try:
                return pattern.evaluate(scene)
            except MemoryError:
                too_many = f"{scene.steps + 1} samples do not fit in memory"
                raise LoomfmuError(f"{scene.name}: {too_many}; take fewer revolutions or steps") from None

    def run(
        self, set: dict[str, Any] | None = None, *, output: str | Path | None = None,
        progress: bool = False, overwrite: bool = False,
    ) -> Result:  # fmt: skip
        """Run with these values, record and judge; as `loomfmu.run`."""
        with self._turn:
            pattern, scene = self._ready(set)
            path = path_of(output, "output") if output is not None else Path("results") / f"{scene.name}.h5"
            return pattern.run(scene, path, self._flavour, overwrite, progress)

    def close(self) -> None:
        """Free the instances; a later run makes new ones."""
        with self._turn:
            self._patterns.clear()
            pool.free([(each.fmu, name) for name, each in self.scene.instances.items()])

    def __enter__(self) -> Prepared:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce__(self) -> tuple[Any, ...]:
        return Prepared, (self.scene, None, self._flavour, self._values)

    def _ready(self, given: dict[str, Any] | None) -> tuple[Pattern, Scene]:
        """What runs the scene with these values. Raises LoomfmuError for a value that cannot be."""
        check_set(given)
        if not given:
            return self._base, self.scene
        before = self.scene.overrides
        overrides = {key: value for key, value in before.items() if key not in given} | given
        values = {key: value for key, value in given.items() if self._base.values.targets(key)}
        try:
            pattern = self._base
            if len(values) < len(given):
                pattern = self._pattern({key: each for key, each in overrides.items() if key not in values})
            return pattern, pattern.with_values(values, overrides)
        except LoomfmuError:  # what was wrong, if anything was, is found where all is read
            pattern = Pattern(checked(self.scene, overrides, self._flavour), self._values)
            return pattern, pattern.scene

    def _pattern(self, overrides: dict[str, Any]) -> Pattern:
        """The scene with other than values; the last ones are kept."""
        key = repr(overrides)
        if key not in self._patterns:
            self._patterns[key] = Pattern(checked(self.scene, overrides, self._flavour), self._values)
        self._patterns.move_to_end(key)
        if len(self._patterns) > MOST_PATTERNS:
            self._patterns.popitem(last=False)
        return self._patterns[key]
