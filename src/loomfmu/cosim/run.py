"""Running a scene: co-simulate, record, judge."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any

from .. import printed
from ..errors import LoomfmuError, path_of, shown, suggestion, why
from ..files import cannot_write, check_target
from ..traces import PARTIAL, TRACE, Trace, TraceWriter, Verdict, partial_of
from ..traces.disk import check_room, largest, size_text
from .claims.claims import judge
from .importing.fmus import FLAVOURS, Flavour
from .master.grid import Grid, uniform
from .master.master import Interrupted, Master
from .planning.plan import Plan, build_needed, channels, ended_text, explained, in_memory, record
from .planning.pruning import prune
from .planning.requested import checked_claims, judged_by, output_port, recorded, shaft_angle, with_rates
from .planning.windows import window_grid
from .provenance import attributes, groups
from .results import Evaluation, Result
from .scenes import scene as scenes
from .scenes.scene import WINDOWS, Scene
from .scenes.scene_files import files_of

LONG_RUN = 20_000  # steps from which a progress bar is shown
SUFFIXES = ("", ".h5", ".hdf5", ".hdf")  # of a trace: any other belongs to other kinds of files
LARGE_TRACE = 300_000_000  # bytes from which its size is reported before the run


def run(
    scene: str | Path | Scene,
    *,
    set: dict[str, Any] | None = None,  # the command's own word
    output: str | Path | None = None,
    progress: bool = False,
    flavour: Flavour = "native",
    overwrite: bool = False,
) -> Result:
    """Co-simulate a scene, record it to HDF5 and judge its claims.

    Args:
        scene: path of a scene file or a system package (.ssp), or a scene that was read before
        set: values that differ from the scene's, such as {"shaft.speed": "685 rpm"}; numbers are SI
        output: path of the trace; `results/<scene>.h5` below the current directory by default
        progress: report the size of a large trace beforehand and show a progress bar for a long run, if
            standard error is a terminal
        flavour: "native" or "live" FMUs; live ones also where no native one is available, with a warning
        overwrite: replace a file at `output` that is not a trace

    Raises:
        LoomfmuError: bad input, or an FMU that failed; one line that names what and where
        KeyboardInterrupt: Ctrl-C; what was written stays readable in a file that the message names
    """
    scene = checked(scene, set, flavour)
    path = path_of(output, "output") if output is not None else Path("results") / f"{scene.name}.h5"
    signals = recorded(scene)
    pruned = prune(scene, signals)
    build_needed(pruned.scene, report=progress)
    plan = Plan(scene, pruned, _grid(scene, signals))
    target = _target(plan, path, overwrite, progress)
    with plan.stepped() as master:
        if master.interrupted.value:
            raise KeyboardInterrupt("interrupted before the first step")
        writer = _writer(plan, master, path, target, flavour)
        with _kept(writer, path), _bar(plan, progress) as advance:
            begun = perf_counter()
            record(master, writer, advance)
            seconds = perf_counter() - begun
            if master.interrupted.value:
                raise Interrupted
        # while the instances are still there: one that crashes when it is freed takes nothing with it
        verdicts, trace = _finish(scene, writer, path, ended_text(master.ended))
        warnings = (*scene.notes, *master.warnings())
    return Result(
        scene, verdicts, warnings, explained(plan), master.steps, path, trace,
        ended=ended_text(master.ended), seconds=seconds,
    )  # fmt: skip


def evaluate(
    scene: str | Path | Scene,
    *,
    set: dict[str, Any] | None = None,
    flavour: Flavour = "native",
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
    scene = checked(scene, set, flavour)
    wanted = list(dict.fromkeys([*with_rates(scene, [*shaft_angle(scene), *values]), *judged_by(scene)]))
    grid = _grid(scene, wanted)
    found = in_memory(scene, wanted, grid)
    verdicts = tuple(judge(found.recording, **claim) for claim in scene.claims)
    warnings = (*scene.notes, *found.warnings)
    return Evaluation(
        scene, verdicts, warnings, explained(found.plan), found.steps, found.recording,
        ended=ended_text(found.ended),
    )  # fmt: skip


def checked(scene: str | Path | Scene, overrides: dict[str, Any] | None, flavour: str) -> Scene:
    """A scene that is ready to be run, with these values and FMUs of this flavour.

    Raises LoomfmuError naming the file and what is wrong.
    """
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
        from .ssp import read as ssp_read

        return ssp_read.load(scene, overrides)
    return scenes.load(scene, overrides)


def _in_flavour(scene: Scene, flavour: str) -> Scene:
    """The scene with all FMUs that it does not bring itself of that flavour: they have the same variables.

    Where no native one is available it is a live one, and a note says so.
    """
    if scene.package is not None and flavour == "live":
        raise LoomfmuError(
            f"{scene.package}: a system package brings its own FMUs, so no flavour can be chosen"
        )
    instances = {
        name: replace(instance, fmu=instance.fmu.in_flavour(flavour))
        for name, instance in scene.instances.items()
    }
    if flavour == "live":
        return replace(scene, instances=instances)
    notes = dict.fromkeys((*scene.notes, *_fallbacks(scene)))  # a scene may come here twice
    return replace(scene, instances=instances, notes=tuple(notes))


def _fallbacks(scene: Scene) -> list[str]:
    """One line for each reason why FMUs of a scene are live ones."""
    found: dict[str, dict[str, None]] = {}
    for instance in scene.instances.values():
        if reason := instance.fmu.no_native:
            found.setdefault(reason, {})[instance.fmu.name] = None
    return [
        f"running live FMUs of {', '.join(names)}, not native ones: {why}" for why, names in found.items()
    ]


@contextmanager
def _kept(writer: TraceWriter, path: Path) -> Iterator[None]:
    """Whatever ends the run early: what was written stays readable, and the message says where it is."""
    try:
        yield
    except Interrupted:
        kept = path.with_name(writer.abandon("interrupted").name)
        raise KeyboardInterrupt(f"interrupted; {writer.rows} samples are in {kept}") from None
    except OSError as error:
        kept = path.with_name(writer.abandon("failed").name)
        raise LoomfmuError(f"{path}: cannot be written ({why(error)}); see {kept}") from None
    except BaseException:
        writer.abandon("failed")
        raise


def _finish(scene: Scene, writer: TraceWriter, path: Path, ended: str) -> tuple[tuple[Verdict, ...], Trace]:
    """Judge the trace, store the verdicts with it and give it its final name."""
    try:
        writer.seal()
        with Trace(writer.partial) as trace:
            trace.rows = writer.rows  # asking every signal of the file takes its time
            verdicts = tuple(judge(trace, **claim) for claim in scene.claims)
        return verdicts, writer.complete([verdict.as_dict() for verdict in verdicts], ended)
    except OSError as error:
        raise cannot_write(path, error) from None
    except LoomfmuError as error:
        kept = path.with_name(writer.abandon("unjudged").name)
        raise LoomfmuError(f"{error}; the trace is kept in {kept}") from None


def _target(plan: Plan, path: Path, overwrite: bool, report: bool) -> Path:
    """The absolute path of the trace, since an FMU may change the working directory.

    Refuses, before the run, a trace that may not be written there or does not fit, and reports a large one.
    """
    inputs = files_of(plan.scene)
    check_target(path, TRACE, inputs, overwrite)
    if path.suffix.lower() not in SUFFIXES:
        raise LoomfmuError(f"{path}: a trace is an HDF5 file; name it {path.with_suffix('.h5').name}")
    check_target(partial_of(path), PARTIAL, inputs, overwrite)
    kinds = [output_port(plan.scene, signal, "record").kind for signal in plan.signals]
    size = largest(plan.grid.steps + 1, kinds.count("Real"), len(kinds) - kinds.count("Real"))
    if report and size > LARGE_TRACE:
        printed.complain(f"{path}: the trace takes up to {size_text(size)}; record = [...] keeps less")
    try:
        check_room(path, size)
        return path.absolute()
    except OSError as error:
        raise cannot_write(path, error) from None


def _writer(plan: Plan, master: Master, path: Path, target: Path, flavour: str) -> TraceWriter:
    try:
        return TraceWriter(target, attributes(plan, flavour), channels(plan, master), groups(plan))
    except OSError as error:
        raise cannot_write(path, error) from None


@contextmanager
def _bar(plan: Plan, wanted: bool) -> Iterator[Callable[[int], None]]:
    """A progress bar for a long run; call it with the number of steps done."""
    shown = 0

    def reached(step: int) -> None:
        nonlocal shown
        advance(step - shown)
        shown = step

    long = plan.grid.steps >= LONG_RUN
    with printed.progress(plan.scene.name, plan.grid.steps, wanted=wanted and long) as advance:
        yield reached
