"""Scenes that were prepared: what does not depend on values is done once, for as many runs as are wanted."""

from __future__ import annotations

import threading
from collections import OrderedDict
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from functools import cached_property, partial
from pathlib import Path
from time import perf_counter
from typing import Any, Literal, NamedTuple, get_args

from ..errors import LoomfmuError, path_of, shown, suggestion
from ..traces import Early, Recording, Signals, TraceWriter, Verdict
from ..traces.verdict import remarked
from . import accuracy
from .claims import judging
from .claims.claim import Claim
from .claims.measures import measure
from .composed import Composed
from .dependence import Dependence
from .estimates import Coarser, Estimates
from .importing import pool
from .importing.fmus import Flavour
from .many import Many, Rows
from .master.grid import Grid, uniform
from .master.master import Interrupted, Master
from .planning.plan import InMemory, Plan, Stepping, build_needed, early_end, explained, record
from .planning.requested import Requested, output_port
from .provenance import attributes
from .reading import check_bounds, check_set, requested
from .recorded import finish, kept_readable, own_path, progress_of, target_of, writer_of, written_at
from .results import Evaluation, Result
from .rows import RowsInC
from .scenes.instances import altered
from .scenes.scene import Scene
from .scenes.values import Values
from .standard import error_bars
from .tangents import Direction, Tangents, seeds_of

Errors = Literal["all", "near", "none"]  # which verdicts get an estimate of their numerical error
Move = tuple[Mapping[str, Any], float]  # settings, and the change of the value that they make
Notes = Callable[[tuple[Verdict, ...]], tuple[Verdict, ...]]  # verdicts with more in their notes
KINDS = {"Real": float, "Integer": int, "Boolean": bool}
MOST_PATTERNS = 8  # that are kept ready, such as one for each machine


class Derived(NamedTuple):
    """The verdicts of a run, on its claims and then its measures, and its derivatives in some directions.

    `judged` judges a recording as the run was.
    """

    verdicts: tuple[Verdict, ...]
    early: Early
    directions: list[Direction]
    judged: Callable[[Signals], tuple[Verdict, ...]]
    recording: Recording


class Pattern:
    """A scene that is read, wired and planned, for runs that differ in values alone."""

    def __init__(self, requested: Requested, values: Sequence[str], measures: Sequence[Claim] = ()):
        self.scene, self.claims, self._requested = requested.scene, requested.claims, requested
        deciding = {number: requested.decider(claim) for number, claim in enumerate(self.claims)}
        # a yes-or-no output is as sure as the number whose sign it is, which is estimated with the claims
        deciders = {number: measure(signal, requested.unit) for number, signal in deciding.items() if signal}
        self._all = [*self.claims, *measures, *deciders.values()]
        if self._all:
            judging.library()  # before the run, which could not be judged without
        needed = requested.needed(self._all, values)
        self._steppings: dict[tuple[str, ...], Stepping] = {}
        first = len(self.claims) + len(measures)
        places = {number: first + place for place, number in enumerate(deciders)}
        self._measured = slice(len(self.claims), first)
        self._estimates = Estimates(Dependence(requested, self._all), self._on, len(needed), places)
        self.judged = tuple(dict.fromkeys([*needed, *self._estimates.shown]))
        self.values = Values(self.scene)
        self._steps = 0  # in a revolution, as they were chosen last

    @cached_property
    def _composed(self) -> Composed:
        return Composed(self._requested, self._all)

    @cached_property
    def rows(self) -> RowsInC:
        """The same for many values at once."""
        stepping = partial(self.stepping, self.judged)
        return RowsInC(self._requested, self._all, self._estimates, self._composed, stepping, self.values)

    def stepping(self, signals: Sequence[str]) -> Stepping:
        """Return the stepping of the scene with only the parts that these signals need."""
        key = tuple(signals)
        if key not in self._steppings:
            self._steppings[key] = Stepping(self._requested, key)
        return self._steppings[key]

    def with_values(self, values: Mapping[str, Any], overrides: dict[str, Any]) -> Scene | None:
        """The scene with other values, out of all its overrides; None where it must be read anew.

        Raises LoomfmuError for a value that is not possible.
        """
        scene = self.values.set(values, overrides)
        if scene is not None:
            check_bounds(self._requested, scene, self.claims)
        return scene

    def _in_memory(self, scene: Scene, grid: Grid) -> InMemory:
        return self.stepping(self.judged).in_memory(scene, grid)

    @cached_property
    def _estimating(self) -> Stepping:
        """The stepping of what claims need whose errors coarser steps show."""
        needed = self._requested.needed([self._all[number] for number in self._by_steps], ())
        return self.stepping(list(dict.fromkeys([*needed, *self._estimates.shown])))

    def _on(self, scene: Scene, grid: Grid) -> Signals:
        return self._estimating.in_memory(scene, grid).recording

    def _judged(self, trace: Signals) -> tuple[Verdict, ...]:
        return tuple(claim.judge(trace) for claim in self._all)

    def _verdicts(self, scene: Scene, trace: Signals) -> tuple[Verdict, ...]:
        """The verdicts on a run, with the errors of those that need no other one."""
        return self._exact(scene, trace, self._judged(trace), self._composed.claims)

    def _exact(
        self, scene: Scene, trace: Signals, verdicts: tuple[Verdict, ...], wanted: Iterable[int]
    ) -> tuple[Verdict, ...]:
        """The verdicts, those wanted by the mechanisms' own functions where they are judged so."""
        known = self._composed.judged(scene, trace, wanted)
        return tuple(known.get(number, each) for number, each in enumerate(verdicts))

    @property
    def _by_steps(self) -> list[int]:
        """The claims, counted from 0, whose errors coarser steps show."""
        return [number for number in range(len(self._all)) if number not in self._composed.claims]

    def _estimated(self, scene: Scene, coarser: Coarser, trace: Signals) -> tuple[Verdict, ...]:
        verdicts, exact = self._verdicts(scene, trace), self._composed.claims
        return self._estimates.of(scene, trace, verdicts, coarser, exact)[: len(self.claims)]

    def evaluate(self, scene: Scene, errors: Errors = "all") -> Evaluation:
        """Run what the claims of the scene need, and judge them."""
        scene, known, chosen = self._with_steps(scene, errors)
        grid = uniform(scene)
        found = self._in_memory(scene, grid)
        run = found.recording
        verdicts = self._judged(run)
        near = self._estimates.near(scene, run, verdicts)
        wanted = {"all": {*range(len(verdicts))}, "near": near, "none": set[int]()}[errors]
        # only rows of which few are near a bound do with less, and not on the steps that an accuracy chose
        every = scene.accuracy is not None or errors != "near"
        exact = {n for n in self._composed.claims if every or n in near or not verdicts[n].decided}
        verdicts = self._exact(scene, run, verdicts, exact)
        coarser = known or self._estimates.coarser(scene, grid, wanted.intersection(self._by_steps))
        verdicts = self._estimates.of(scene, run, verdicts, coarser, exact)
        return Evaluation(
            scene,
            verdicts[: len(self.claims)],
            (*scene.notes, *found.warnings),
            (*explained(found.plan), *self.rows.explained),
            found.steps,
            found.recording,
            verdicts[self._measured],
            frozenset(near),
            early=found.early,
            chosen=chosen,
        )

    @cached_property
    def tangents(self) -> Tangents:
        """Its components with dual numbers. Raises LoomfmuError where there are none."""
        return Tangents(self.scene, self.judged)

    def derived(self, scene: Scene, moved: Sequence[tuple[Scene, float]]) -> Derived:
        """Run what the claims need, with derivatives towards scenes that differ by a change of a value."""
        scene, _known, _chosen = self._with_steps(scene, "none")
        grid = uniform(scene)
        run = self._in_memory(scene, grid)
        directions = [
            self.tangents.along(scene, grid, seeds_of(scene, other, change), run.recording)
            for other, change in moved
        ]
        verdicts = self._verdicts(scene, run.recording)
        return Derived(verdicts, run.early, directions, self._judged, run.recording)

    def _with_steps(self, scene: Scene, errors: Errors = "all") -> tuple[Scene, Coarser | None, str]:
        """The scene with steps that reach its accuracy, what coarser ones gave, and a line that says so.

        Without errors the steps are those that were chosen last: a search compares runs on the same ones.
        """
        if scene.accuracy is None:
            return scene, None, ""
        if errors == "none" and self._steps:
            return altered(scene, steps_per_period=self._steps), None, ""
        choice = accuracy.fewest_steps(scene, self._estimates, self._by_steps, self._tried)
        self._steps = int(choice.scene.steps_per_period)
        return choice

    def _tried(self, scene: Scene) -> tuple[Signals, Sequence[Verdict]]:
        trace = self._in_memory(scene, uniform(scene)).recording
        return trace, self._verdicts(scene, trace)

    def _coarser(self, scene: Scene, grid: Grid) -> Coarser:
        return self._estimates.coarser(scene, grid, self._by_steps)

    def run(
        self,
        scene: Scene,
        path: Path,
        flavour: str,
        overwrite: bool,
        progress: bool,
        notes: Callable[[], Notes],
    ) -> Result:
        """Run the scene, record it to a file, and judge its claims.

        `notes` finds, once the steps are chosen, what to note with the verdicts.
        """
        scene, coarser, chosen = self._with_steps(scene)
        noted = notes()
        needed = self._requested.needed(self._all, self._requested.recorded)
        signals = list(dict.fromkeys([*needed, *self._estimates.shown]))
        stepping = self.stepping(signals)
        plan = stepping.plan(scene, uniform(scene))
        build_needed(plan.pruned.scene, report=progress)
        target = target_of(plan, path, overwrite, progress)
        replaced = written_at(target)
        about = attributes(plan, flavour, target.parent)  # paths hold before an FMU changes the directory
        if coarser is None and any(instance.fmu.component is None for instance in scene.instances.values()):
            # coarser steps first: what an FMU leaves behind, such as a log, is that of the run itself
            coarser = self._coarser(scene, plan.grid)
        with ExitStack() as instances:
            master = instances.enter_context(stepping.stepped(plan))
            if master.interrupted.value:
                raise KeyboardInterrupt("interrupted before the first step")
            writer = writer_of(plan, stepping.channels, path, target, about)
            with kept_readable(writer, path):
                seconds = _recorded(master, writer, plan, progress)
                steps, early = master.steps, early_end(plan, master.ended)
                warnings = (*scene.notes, *master.warnings())
                if coarser is None:
                    instances.close()  # coarser runs may be stepped by the same master
                    try:
                        coarser = self._coarser(scene, plan.grid)
                    except KeyboardInterrupt:
                        raise Interrupted from None
            # third-party instances are still there: one that crashes when it is freed takes nothing with it
            judge = partial(self._estimated, scene, coarser)
            verdicts, trace = finish(lambda trace: noted(judge(trace)), writer, path, early)
        return Result(
            scene,
            verdicts,
            warnings,
            (*explained(plan), *self.rows.explained),
            steps,
            path,
            trace,
            early=early,
            seconds=seconds,
            chosen=chosen,
            replaced=replaced,
        )


def _recorded(master: Master, writer: TraceWriter, plan: Plan, progress: bool) -> float:
    """Step an initialized master to the end and record it; return the time that took [s]."""
    with progress_of(plan, progress) as advance:
        begun = perf_counter()
        record(master, writer, advance)
        seconds = perf_counter() - begun
    if master.interrupted.value:
        raise Interrupted
    return seconds


class Prepared:
    """A scene that was prepared by `loomfmu.prepare`, to be run with as many values as are wanted.

    Values that change what was prepared, such as a machine, a pattern or a component, are prepared when they
    first come. Results stay valid after the next run. Threads take turns. `close`, or the end of a `with`
    statement, frees the instances; a copy in another process is prepared there.
    """

    def __init__(
        self,
        scene: str | Path | Scene,
        overrides: dict[str, Any] | None,
        flavour: Flavour,
        values: Sequence[str],
        measures: Sequence[str] = (),
    ):
        if not isinstance(values, list | tuple) or not all(isinstance(signal, str) for signal in values):
            raise LoomfmuError(f'values = {shown(values)} is not a list such as ["belt.margin"]')
        self._values, self._flavour = tuple(values), flavour
        self._measures = tuple(measures)
        self._base = self._new(requested(scene, overrides, flavour))
        self._patterns: OrderedDict[str, Pattern] = OrderedDict()
        self._turn = threading.Lock()

    @property
    def scene(self) -> Scene:
        """The scene with the values that it was prepared with."""
        return self._base.scene

    def __repr__(self) -> str:
        return f"<Prepared {self.scene.name}: {len(self.scene.claims)} claims>"

    def evaluate(self, set: dict[str, Any] | None = None, *, errors: Errors = "all") -> Evaluation:
        """Run what the claims need with these values, and judge them; as `loomfmu.evaluate`.

        Estimating errors takes three more runs, on 62, 38 and 24 % of the steps: "near" estimates only
        those of counts and of verdicts within 1 % of their bounds, or 10 % where a mechanism has a memory;
        "none", for searches, does without.
        """
        _check_errors(errors)
        with self._turn:
            pattern, scene = self._ready(set)
            try:
                return pattern.evaluate(scene, errors)
            except MemoryError:
                too_many = f"{scene.steps + 1} samples do not fit in memory"
                raise LoomfmuError(f"{scene.name}: {too_many}; take fewer revolutions or steps") from None

    def evaluate_many(self, values: Mapping[str, Any], *, errors: Errors = "near") -> Rows:
        """Run and judge many rows: as `evaluate` with each of them, to the last bit, but far sooner.

        `values` has a sequence for each key, such as {"shaft.speed": speeds}, with one value for each row;
        numbers are in SI. A row that cannot be run says why in `errors` of the result. Errors are estimated
        as by `evaluate`: of all verdicts, which takes as long as row by row, of those "near" their bounds, or
        none.
        """
        _check_errors(errors)
        many, measured = Many(values), len(self._measures)
        kinds = {signal: KINDS[output_port(self.scene, signal, "values").kind] for signal in self._values}

        def ready(settings: dict[str, Any]) -> tuple[RowsInC, Scene]:
            pattern, scene = self._ready(settings)
            return pattern.rows, scene

        with self._turn:
            if errors != "all" and not measured:
                many.run_in_c(ready, self._base.rows.takes, self._values, errors == "near")
        return many.judged(
            self.scene, self._base.claims, kinds, lambda settings: self.evaluate(settings, errors=errors)
        )

    @property
    def has_derivatives(self) -> bool:
        """Return whether `derived` can derive its runs: no loops, and native FMUs of ours alone."""
        try:
            return bool(self._base.tangents)
        except LoomfmuError:
            return False

    def derived(self, set: Mapping[str, Any], moves: Sequence[Move]) -> Derived:
        """Run what the claims need with these values, and derive it by some of them.

        Each move is a change of one of the values, with the settings after it. Raises LoomfmuError where
        values have no derivatives, or FMUs.
        """
        with self._turn:
            return self._derived(set, *self._ready(dict(set)), moves)

    def _derived(
        self, given: Mapping[str, Any], pattern: Pattern, scene: Scene, moves: Sequence[Move]
    ) -> Derived:
        return pattern.derived(scene, [(self._ready({**given, **to})[1], change) for to, change in moves])

    def run(
        self,
        set: dict[str, Any] | None = None,
        *,
        output: str | Path | None = None,
        progress: bool = False,
        overwrite: bool = False,
        remarks: Mapping[int, str] | None = None,
    ) -> Result:
        """Run with these values, record and judge; as `loomfmu.run`."""
        with self._turn:
            pattern, scene = self._ready(set)
            path = own_path(scene, progress) if output is None else path_of(output, "output")
            notes = partial(self._notes, set or {}, pattern, scene, remarks or {})
            return pattern.run(scene, path, self._flavour, overwrite, progress, notes)

    def _notes(
        self, given: Mapping[str, Any], pattern: Pattern, scene: Scene, remarks: Mapping[int, str]
    ) -> Notes:
        """Return what adds remarks to verdicts, and their error bars where a scene has tolerances."""
        if not (scene.tolerances and scene.claims):
            return partial(remarked, remarks=remarks)
        barred = error_bars(scene, partial(self._derived, given, pattern, scene), len(scene.claims))
        return lambda verdicts: barred(remarked(verdicts, remarks))

    def close(self) -> None:
        """Free the instances; a later run makes new ones."""
        with self._turn:
            self._patterns.clear()
            pool.free([(instance.fmu, name) for name, instance in self.scene.instances.items()])

    def __enter__(self) -> Prepared:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce__(self) -> tuple[Any, ...]:
        return Prepared, (self.scene, None, self._flavour, self._values, self._measures)

    def _new(self, asked: Requested) -> Pattern:
        return Pattern(asked, self._values, [measure(each, asked.unit) for each in self._measures])

    def _ready(self, given: dict[str, Any] | None) -> tuple[Pattern, Scene]:
        """Return pattern and scene for these values. Raises LoomfmuError for a value that is not possible."""
        check_set(given)
        if not given:
            return self._base, self.scene
        before = self.scene.overrides
        overrides = {key: value for key, value in before.items() if key not in given} | given
        values = {key: value for key, value in given.items() if self._base.values.targets(key)}
        # a pattern that was read with some values serves for other ones of the same variables
        key = repr(({name: each for name, each in overrides.items() if name not in values}, sorted(values)))
        pattern = self._base if len(values) == len(given) else self._patterns.get(key)
        scene = pattern.with_values(values, overrides) if pattern else None
        if pattern is None or scene is None:
            pattern = self._new(requested(self.scene, overrides, self._flavour))
            scene = pattern.scene
            for doubt in scene.doubts - self.scene.doubts:  # nobody reads the warnings of each run
                raise LoomfmuError(f"{doubt}, else the unit as well")
        if len(values) < len(given):
            self._patterns[key] = pattern
            self._patterns.move_to_end(key)
        if len(self._patterns) > MOST_PATTERNS:
            self._patterns.popitem(last=False)
        return pattern, scene


def _check_errors(errors: Any) -> None:
    """Refuse what does not say which errors are estimated."""
    if errors not in get_args(Errors):
        raise LoomfmuError(f"errors = {shown(errors)} is unknown{suggestion(str(errors), get_args(Errors))}")
