"""Running a scene: co-simulate, record, judge."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import LoomfmuError, suggestion
from ..traces import ROWS, Channel, Trace, TraceWriter
from . import scene as scenes
from . import ssp_read
from .claims import check, check_values, judge, names_parameter, signals_of
from .fmus import Fmu, Port, of_component
from .master import Interrupted, Master
from .scene import Scene
from .verdict import Verdict

LONG_RUN = 20_000  # steps from which a progress bar is shown
ANGLES = frozenset(("window", "angles", "at_least"))  # arguments of claims that need a shaft


@dataclass(frozen=True)
class Result:
    """A finished run: its trace, the verdicts on its claims, and what the FMUs warned of."""

    scene: Scene
    path: Path
    claims: tuple[Verdict, ...]
    warnings: tuple[str, ...]

    @property
    def holds(self) -> bool:
        """Whether every claim holds."""
        return all(self.claims)

    @cached_property
    def trace(self) -> Trace:
        """The recorded trace: `result.trace["belt.margin"]` are the signal's values in SI."""
        return Trace(self.path)


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
    place = "" if isinstance(scene, Scene) else f"{scene}: "
    scene = _in_flavour(_read(scene, set), flavour)
    path = Path(output) if output is not None else Path("results") / f"{scene.name}.h5"
    if not path.name or path.is_dir():
        raise LoomfmuError(f"{path}: cannot be written (it is a directory)")
    try:
        check_claims(scene)
    except LoomfmuError as error:
        raise LoomfmuError(f"{place}{error}") from None
    with Master(scene) as master:
        master.initialize()
        if master.interrupted:
            raise KeyboardInterrupt("interrupted before the first step")
        writer = _writer(scene, master, path)
        try:
            with _bar(scene, progress) as advance:
                master.run(ROWS, _recorder(scene, master, writer), advance)
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
    return Result(scene, path, _finish(scene, writer), warnings)


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


def _finish(scene: Scene, writer: TraceWriter) -> tuple[Verdict, ...]:
    """Seal the trace, judge it, store the verdicts and give it its final name."""
    try:
        writer.seal("complete")
        with Trace(writer.partial) as trace:
            verdicts = tuple(judge(trace, **claim) for claim in scene.claims)
        writer.complete([verdict.as_dict() for verdict in verdicts])
    except OSError as error:
        raise LoomfmuError(f"{writer.path}: cannot be written ({error.strerror or error})") from None
    except LoomfmuError as error:
        raise LoomfmuError(f"{error}; the trace is kept in {writer.partial}") from None
    return verdicts


def check_claims(scene: Scene) -> None:
    """Refuse a claim that cannot be judged before the run, not after it."""
    for claim in scene.claims:
        kind = claim.get("kind")
        arguments = {key: value for key, value in claim.items() if key not in ("kind", "name")}
        check(kind, arguments)
        for angle in ANGLES.intersection(arguments):
            if "shaft" not in scene.instances:
                raise LoomfmuError(f"claim {kind!r}: {angle} is a shaft angle, and the scene has no shaft")
        for signal in signals_of(claim, scene.instances):
            _output(scene, signal, f"claim {kind!r}")
        check_values(str(kind), arguments, lambda signal: _output(scene, signal, "claim").unit)
        if names_parameter("bound", arguments.get("bound")):
            _check_parameter(scene, arguments["bound"], arguments["signal"])


def _check_parameter(scene: Scene, name: str, signal: str) -> None:
    """A parameter that bounds a signal is one of the scene, in the signal's unit."""
    instance, _, variable = name.partition(".")
    ports = scene.instances[instance].fmu.ports if instance in scene.instances else {}
    known = [f"{instance}.{port.name}" for port in ports.values() if port.causality == "parameter"]
    if name not in known:
        raise LoomfmuError(f"claim: bound = {name!r} is no parameter{suggestion(name, known)}")
    wanted, given = _output(scene, signal, "claim").unit, ports[variable].unit
    if given != wanted:
        raise LoomfmuError(f"claim: bound {name} is in {given}, {signal} in {wanted}")


def _output(scene: Scene, signal: str, where: str) -> Port:
    """The output, or the input driven by the scene, that a signal names."""
    instance, _, variable = signal.partition(".")
    if instance not in scene.instances:
        hint = suggestion(instance, scene.instances)
        raise LoomfmuError(f"{where}: there is no instance {instance!r}{hint}")
    ports = scene.instances[instance].fmu.ports
    outputs = [port.name for port in ports.values() if port.causality == "output"]
    outputs += [drive.variable for drive in scene.drives if drive.instance == instance]
    if variable not in outputs:
        raise LoomfmuError(f"{where}: {instance} has no output {variable!r}{suggestion(variable, outputs)}")
    return ports[variable]


def _recorded(scene: Scene) -> list[str]:
    """What the scene records, what its claims need, and the rates of that."""
    wanted = [
        *(["shaft.angle"] if "shaft" in scene.instances else []),
        *scene.record,
        *(f"{drive.instance}.{drive.variable}" for drive in scene.drives),
        *(s for claim in scene.claims for s in signals_of(claim, scene.instances)),
    ]
    names: dict[str, None] = {}
    for signal in wanted:
        while signal and signal not in names:
            names[signal] = None
            port = _output(scene, signal, "record")
            rate = port.rate if port.causality == "output" else None
            signal = f"{signal.split('.')[0]}.{rate}" if rate else ""
    return list(names)


def _writer(scene: Scene, master: Master, path: Path) -> TraceWriter:
    channels = []
    for signal in _recorded(scene):
        port = _output(scene, signal, "record")
        instance, variable = signal.split(".")
        kind, slot = master.slots[instance, variable]
        meanings = ("no", "yes") if kind == "Boolean" else port.choices
        channels.append(
            Channel(
                instance=instance,
                variable=variable,
                unit=port.unit,
                display=port.display,
                description=port.description,
                column=slot,
                real=kind == "Real",
                rate=port.rate,
                meanings=meanings,
                first_flag=port.first_choice if port.choices else 0,
            )
        )
    fmus = _fmus(scene)
    attributes = {
        "title": scene.title,
        "scene": scene.text,
        "software": f"loomfmu {version('loomfmu')}",
        **(
            {"steps_per_revolution": str(scene.steps_per_revolution)}
            if scene.step is None
            else {"step": f"{scene.step!r} s"}
        ),
        **{f"fmu_{name}_version": fmu.version for name, fmu in sorted(fmus.items())},
        **{f"fmu_{name}_sha256": fmu.sha256 for name, fmu in sorted(fmus.items())},
    }
    parameters = {
        name: {
            port.name: instance.values.get(port.name, port.start or 0)
            for port in instance.fmu.ports.values()
            if port.causality == "parameter"
        }
        for name, instance in scene.instances.items()
    }
    try:
        return TraceWriter(path, attributes, channels, parameters)
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


def _recorder(
    scene: Scene, master: Master, writer: TraceWriter
) -> Callable[[NDArray[np.float64], NDArray[np.float64], NDArray[np.int32]], None]:
    """What takes the master's blocks to the trace."""
    _kind, column = master.slots.get(("shaft", "angle"), ("", -1))

    def write(times: NDArray[np.float64], reals: NDArray[np.float64], integers: NDArray[np.int32]) -> None:
        angle = reals[:, column] if column >= 0 else np.zeros(len(times))  # a scene without shaft
        writer.append(times, angle, reals, integers)

    return write


@contextmanager
def _bar(scene: Scene, wanted: bool) -> Iterator[Callable[[int], None]]:
    """A progress bar, where one is wanted, the run is long and somebody is looking."""
    if not wanted or scene.steps < LONG_RUN or not sys.stderr.isatty():
        yield lambda _step: None
        return
    from rich.console import Console
    from rich.progress import Progress

    with Progress(console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task(scene.name, total=scene.steps)
        yield lambda step: bar.update(task, completed=step)
