"""Running a scene: co-simulate, record, judge."""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ..errors import LoomfmuError, path_of, shown, suggestion
from ..files import cannot_write, check_target
from ..traces import PARTIAL, TRACE, Recording, Trace, TraceWriter, partial_of
from ..traces.disk import check_room, largest, size_text
from .claims.claims import judge
from .claims.verdict import Verdict
from .importing.fmus import FLAVOURS
from .importing.slave import Ended
from .master.grid import Grid, uniform
from .master.master import Interrupted, Master
from .planning.plan import Plan, channels, in_memory, record
from .planning.pruning import prune
from .planning.requested import checked_claims, judged_by, output_port, recorded, shaft_angle, with_rates
from .planning.windows import window_grid
from .provenance import attributes, groups
from .scenes import scene as scenes
from .scenes.scene import WINDOWS, Scene
from .scenes.scene_files import files_of
from .ssp import read as ssp_read

LONG_RUN = 20_000  # steps from which a progress bar is shown
SUFFIXES = ("", ".h5", ".hdf5", ".hdf")  # of a trace: another one would say that it is something else
LARGE_TRACE = 300_000_000  # bytes from which its size is told before the run


@dataclass(frozen=True, repr=False)
class _Judged:
    """A finished run: the verdicts on its claims, what the FMUs warned of, and what was left out.

    It is true where all claims hold. `skipped` are lines that say what was not run or not read and why, and
    what that saved; `steps` is the number of communication steps. `ended` tells which FMU ended it
    before its time, and when.
    """

    scene: Scene
    claims: tuple[Verdict, ...]
    warnings: tuple[str, ...]
    skipped: tuple[str, ...]
    steps: int
    ended: str = field(default="", kw_only=True)

    @property
    def holds(self) -> bool:
        """Whether every claim holds."""
        return all(self.claims)

    def __bool__(self) -> bool:
        return self.holds

    def __repr__(self) -> str:
        failing = [verdict for verdict in self.claims if not verdict]
        said = f"{len(failing)} of {len(self.claims)} claims fail" if failing else "all claims hold"
        if not self.claims:
            said = "no claims"
        listed = "".join(f"\n  {verdict}" for verdict in failing)
        return f"<{type(self).__name__} {self.scene.name}: {said}{':' * bool(failing)}{listed}>"


@dataclass(frozen=True, repr=False)
class Result(_Judged):
    """A finished run with its trace on disk: `trace["belt.margin"]` are the signal's values in SI.

    `path` is where the trace was written. `trace` stays that of this run when another one is written there.
    """

    path: Path
    trace: Trace = field(repr=False, compare=False)


@dataclass(frozen=True, repr=False)
class Evaluation(_Judged):
    """A finished run whose trace is in memory: `trace["belt.margin"]` are the signal's values in SI."""

    trace: Recording


def run(
    scene: str | Path | Scene,
    *,
    set: dict[str, Any] | None = None,  # the command's own word
    output: str | Path | None = None,
    progress: bool = False,
    flavour: str = "live",
    overwrite: bool = False,
) -> Result:
    """Co-simulate a scene, record it to HDF5 and judge its claims.

    Args:
        scene: path of a scene file or of a system package (.ssp), or a scene that was read before
        set: values that differ from the scene's, such as {"shaft.speed": "685 rpm"}; numbers are SI
        output: path of the trace; `results/<scene>.h5` below the current directory by default
        progress: tell how large a large trace will be, and show a progress bar on a long run, if standard
            error is a terminal
        flavour: "live" or "native" FMUs
        overwrite: replace a file at `output` that is not a trace

    Raises:
        LoomfmuError: bad input, or an FMU that failed; one line that names what and where
        KeyboardInterrupt: Ctrl-C; what was written stays readable beside the final name, as `.partial`
    """
    scene = _checked(scene, set, flavour)
    path = path_of(output, "output") if output is not None else Path("results") / f"{scene.name}.h5"
    signals = recorded(scene)
    plan = Plan(scene, prune(scene, signals), _grid(scene, signals))
    _check_target(plan, path, overwrite, progress)
    with plan.master() as master:
        master.initialize()
        if master.interrupted.value:
            raise KeyboardInterrupt("interrupted before the first step")
        writer = _writer(plan, master, path, flavour)
        try:
            with _bar(plan, progress) as advance:
                record(master, writer, advance)
            if master.interrupted.value:
                raise Interrupted
        except Interrupted:
            kept = writer.abandon("interrupted")
            raise KeyboardInterrupt(f"interrupted; {writer.rows} samples are in {kept}") from None
        except OSError as error:
            kept = writer.abandon("failed")
            raise LoomfmuError(f"{path}: cannot be written ({error.strerror or error}); see {kept}") from None
        except BaseException:
            writer.abandon("failed")
            raise
        warnings = (*scene.notes, *master.warnings())
    ended = _told(master.ended)
    verdicts = _finish(scene, writer, ended)
    skipped = explained(plan)
    return Result(scene, verdicts, warnings, skipped, master.steps, path, Trace(path), ended=ended)


def evaluate(
    scene: str | Path | Scene,
    *,
    set: dict[str, Any] | None = None,
    flavour: str = "live",
    values: Sequence[str] = (),
) -> Evaluation:
    """Co-simulate what the claims of a scene need, and judge them; nothing is written.

    Args:
        scene, set, flavour: as for `run`; what the scene would record is left out
        values: further signals to keep

    Raises:
        LoomfmuError: bad input, or an FMU that failed; one line that names what and where
        KeyboardInterrupt: Ctrl-C
    """
    if not isinstance(values, list | tuple) or not all(isinstance(signal, str) for signal in values):
        raise LoomfmuError(f'values = {shown(values)} is not a list such as ["belt.margin"]')
    scene = _checked(scene, set, flavour)
    wanted = list(dict.fromkeys([*with_rates(scene, [*shaft_angle(scene), *values]), *judged_by(scene)]))
    grid = _grid(scene, wanted)
    found = in_memory(scene, wanted, grid)
    verdicts = tuple(judge(found.recording, **claim) for claim in scene.claims)
    warnings = (*scene.notes, *found.warnings)
    return Evaluation(
        scene, verdicts, warnings, explained(found.plan), found.steps, found.recording,
        ended=_told(found.ended),
    )  # fmt: skip


def _checked(scene: str | Path | Scene, overrides: dict[str, Any] | None, flavour: str) -> Scene:
    """A scene that is ready to be run. Raises LoomfmuError naming the file and what is wrong."""
    if flavour not in FLAVOURS:
        raise LoomfmuError(f"there is no flavour {shown(flavour)}{suggestion(str(flavour), FLAVOURS)}")
    if overrides is not None and not (
        isinstance(overrides, Mapping) and all(isinstance(key, str) for key in overrides)
    ):
        raise LoomfmuError(
            f'set = {shown(overrides)} is not a dictionary such as {{"shaft.speed": "685 rpm"}}'
        )
    scene = scene if isinstance(scene, Scene) else path_of(scene, "scene")
    place = "" if isinstance(scene, Scene) else f"{scene}: "
    scene = _in_flavour(_read(scene, overrides), flavour)
    try:
        for name, instance in scene.instances.items():
            if not instance.fmu.built:  # one that is built waits until it is needed
                instance.fmu.check_platform(name)
        return checked_claims(scene)
    except LoomfmuError as error:
        raise LoomfmuError(f"{place}{error}") from None


def _grid(scene: Scene, signals: Sequence[str]) -> Grid:
    return window_grid(scene, signals) if scene.grid == WINDOWS else uniform(scene)


def explained(plan: Plan) -> tuple[str, ...]:
    """What a run leaves out and why, and what that saves."""
    kept, whole = len(plan.pruned.scene.instances), len(plan.scene.instances)
    taken, usual = plan.grid.steps, plan.scene.steps
    lines = [*plan.pruned.skipped, *plan.grid.notes]
    done, full = kept * taken + plan.grid.scouted, whole * usual
    if not done:
        saved = "none left"
    elif done == full:
        saved = "all of them"
    else:
        saved = f"{full / done:.3g} times fewer" if done < full else f"{100 * (done / full - 1):.2g} % more"
    return (
        *lines,
        f"{kept} of {whole} FMUs, {taken} steps where equal ones would be {usual}:"
        f" {done} steps of FMUs instead of {full}, {saved}",
    )


def _read(scene: str | Path | Scene, overrides: dict[str, Any] | None) -> Scene:
    """A scene from its file or its system package, with other values if there are any."""
    if isinstance(scene, Scene):
        if not overrides:
            return scene
        if scene.package is None:
            made = scenes.parse(scene.text, scene.name, overrides, scene.directory)
            return replace(made, file=scene.file)
        scene = scene.package
    if Path(scene).suffix.lower() == ".ssp":
        return ssp_read.load(scene, overrides)
    return scenes.load(scene, overrides)


def _in_flavour(scene: Scene, flavour: str) -> Scene:
    """The scene with all FMUs that it does not bring itself of that flavour: they have the same variables."""
    if flavour == "live":
        return scene
    if scene.package is not None:
        raise LoomfmuError(f"{scene.package}: a system package brings its own FMUs; its flavour is settled")
    instances = {
        name: replace(instance, fmu=instance.fmu.in_flavour(flavour))
        for name, instance in scene.instances.items()
    }
    return replace(scene, instances=instances)


def _told(ended: Ended | None) -> str:
    """Which FMU ended the run before its time, and when."""
    return f"{ended.name} at {ended.time:.9g} s" if ended else ""


def _finish(scene: Scene, writer: TraceWriter, ended: str) -> tuple[Verdict, ...]:
    """Seal the trace, judge it, store the verdicts and give it its final name."""
    try:
        writer.seal("complete", ended)
        with Trace(writer.partial) as trace:
            verdicts = tuple(judge(trace, **claim) for claim in scene.claims)
        writer.complete([verdict.as_dict() for verdict in verdicts])
    except OSError as error:
        raise cannot_write(writer.path, error) from None
    except LoomfmuError as error:
        raise LoomfmuError(f"{error}; the trace is kept in {writer.partial}") from None
    return verdicts


def _check_target(plan: Plan, path: Path, overwrite: bool, told: bool) -> None:
    """Refuse, before the run, a trace that may not be written there or does not fit; tell of a large one."""
    inputs = files_of(plan.scene)
    check_target(path, TRACE, inputs, overwrite)
    if path.suffix.lower() not in SUFFIXES:
        raise LoomfmuError(f"{path}: a trace is HDF5 and takes the name {path.with_suffix('.h5').name}")
    check_target(partial_of(path), PARTIAL, inputs, overwrite)
    kinds = [output_port(plan.scene, signal, "record").kind for signal in plan.signals]
    size = largest(plan.grid.steps + 1, kinds.count("Real"), len(kinds) - kinds.count("Real"))
    if told and size > LARGE_TRACE:
        print(f"{path}: the trace takes up to {size_text(size)}; record = [...] keeps less", file=sys.stderr)
    try:
        check_room(partial_of(path), size)
    except OSError as error:
        raise cannot_write(path, error) from None


def _writer(plan: Plan, master: Master, path: Path, flavour: str) -> TraceWriter:
    try:
        return TraceWriter(path, attributes(plan, flavour), channels(plan, master), groups(plan))
    except OSError as error:
        raise cannot_write(path, error) from None


@contextmanager
def _bar(plan: Plan, wanted: bool) -> Iterator[Callable[[int], None]]:
    """A progress bar, where one is wanted, the run is long and somebody is looking."""
    if not wanted or plan.grid.steps < LONG_RUN or not sys.stderr.isatty():
        yield lambda _step: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(plan.scene.name, total=plan.grid.steps)
        yield lambda step: bar.update(task, completed=step)
