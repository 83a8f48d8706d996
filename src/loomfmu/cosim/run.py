"""Running a scene: co-simulate, record, judge."""

import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ..errors import LoomfmuError, path_of, shown, suggestion
from ..traces import Recording, Trace, TraceWriter
from . import scene as scenes
from . import ssp_read
from .asked import check_claims, judged_by, parameters, recorded, shaft_angle, with_rates
from .claims import judge
from .fmus import FLAVOURS, Fmu, of_component
from .grid import Grid, uniform
from .lean import lean
from .master import Interrupted, Master
from .play import Plan, channels, play, remembered
from .scene import WINDOWS, Scene
from .slave import Ended
from .verdict import Verdict
from .windows import window_grid

LONG_RUN = 20_000  # steps from which a progress bar is shown


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class Result(_Judged):
    """A finished run with its trace on disk: `trace["belt.margin"]` are the signal's values in SI.

    `path` is where the trace was written. `trace` stays that of this run when another one is written there.
    """

    path: Path
    trace: Trace = field(repr=False, compare=False)


@dataclass(frozen=True)
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
) -> Result:
    """Co-simulate a scene, record it to HDF5 and judge its claims.

    Args:
        scene: path of a scene file or of a system package (.ssp), or a scene that was read before
        set: values that differ from the scene's, such as {"shaft.speed": "685 rpm"}; numbers are SI
        output: path of the trace; `results/<scene>.h5` below the current directory by default
        progress: show a progress bar on a long run, if standard error is a terminal
        flavour: "live" or "native" FMUs

    Raises:
        LoomfmuError: bad input, or an FMU that failed; one line that names what and where
        KeyboardInterrupt: Ctrl-C; what was written stays readable beside the final name, as `.partial`
    """
    scene = _checked(scene, set, flavour)
    path = path_of(output, "output") if output is not None else Path("results") / f"{scene.name}.h5"
    if not path.name or path.is_dir():
        raise LoomfmuError(f"{path}: cannot be written (it is a directory)")
    signals = recorded(scene)
    plan = Plan(scene, lean(scene, signals), _grid(scene, signals))
    with plan.master() as master:
        master.initialize()
        if master.interrupted.value:
            raise KeyboardInterrupt("interrupted before the first step")
        writer = _writer(plan, master, path)
        try:
            with _bar(plan, progress) as advance:
                play(master, writer, advance)
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
    found = remembered(scene, wanted, grid)
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
            instance.fmu.check_platform(name)
        check_claims(scene)
    except LoomfmuError as error:
        raise LoomfmuError(f"{place}{error}") from None
    return scene


def _grid(scene: Scene, signals: Sequence[str]) -> Grid:
    return window_grid(scene, signals) if scene.grid == WINDOWS else uniform(scene)


def explained(plan: Plan) -> tuple[str, ...]:
    """What a run leaves out and why, and what that saves."""
    kept, whole = len(plan.lean.scene.instances), len(plan.scene.instances)
    taken, usual = plan.grid.steps, plan.scene.steps
    lines = [*plan.lean.skipped, *plan.grid.notes]
    done, full = kept * taken + plan.grid.scouted, whole * usual
    saved = "none left" if not done else "all of them" if done == full else f"{full / done:.3g} times fewer"
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
            return scenes.parse(scene.text, scene.name, overrides, scene.directory)
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
        name: replace(instance, fmu=of_component(instance.fmu.name, flavour))
        if instance.fmu.built
        else instance
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
        raise LoomfmuError(f"{writer.path}: cannot be written ({error.strerror or error})") from None
    except LoomfmuError as error:
        raise LoomfmuError(f"{error}; the trace is kept in {writer.partial}") from None
    return verdicts


def _writer(plan: Plan, master: Master, path: Path) -> TraceWriter:
    scene = plan.scene
    fmus = _fmus(plan.lean.scene)
    attributes = {
        "title": scene.title,
        "scene": scene.text,
        "software": f"loomfmu {version('loomfmu')}",
        **(
            {"steps_per_revolution": str(scene.steps_per_revolution)}
            if scene.step is None
            else {"step": f"{scene.step!r} s"}
        ),
        "grid": scene.grid,
        **({"notes": "\n".join(scene.notes)} if scene.notes else {}),
        **{f"fmu_{name}_version": fmu.version for name, fmu in sorted(fmus.items())},
        **{f"fmu_{name}_sha256": fmu.sha256 for name, fmu in sorted(fmus.items())},
    }
    try:
        return TraceWriter(path, attributes, channels(plan, master), parameters(scene))
    except OSError as error:
        raise LoomfmuError(f"{path}: cannot be written ({error.strerror or error})") from None


def _fmus(scene: Scene) -> dict[str, Fmu]:
    """The FMUs of a scene by their names; two that bear one name are told apart by an instance's."""
    found: dict[str, Fmu] = {}
    for name, instance in scene.instances.items():
        fmu = instance.fmu
        same = found.setdefault(fmu.name, fmu)
        if same.sha256 != fmu.sha256:
            found[f"{fmu.name}_{name}"] = fmu
    return found


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
