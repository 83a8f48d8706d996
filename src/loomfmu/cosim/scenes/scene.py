"""Scenes: what is simulated, for how long, what is recorded and what is claimed of it."""

import fnmatch
import math
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ... import units
from ...errors import LoomfmuError, shown, suggestion
from ...files import text_of
from ..importing.process import AVAILABLE
from . import standard_loom
from .drives import Drive
from .graph import Wire
from .instances import (
    COARSE,
    ISOLATED,
    KEYS,
    TIMES,
    Instance,
    instance,
    instance_tables,
    mixed,
    override,
    own_texts,
    truth,
)
from .wiring import drives_of, wires_of

ROUNDING = 1e-9  # of a duration: one that is off by more than that from whole steps is refused
LAGGED, ITERATED = COUPLINGS = ("lagged", "iterated")
UNIFORM, WINDOWS = GRIDS = ("uniform", "windows")


@dataclass(repr=False)
class Scene:
    """A scene, checked against the FMUs it uses: every name is known, every value in SI and in bounds.

    A period is a revolution of the main shaft, or a second in a scene that runs by seconds and has a `step`:
    the run takes `periods` of them. `coupling` is how loops are closed, `grid` where the steps are, with
    `coarse_steps_per_revolution` outside of the windows that the claims look into. `file` or the system
    package `package` is what it was read from, `package_sha256` is the package's, `texts` are those of the
    other files that its text names, `overrides` the values that differ from it, `notes` what the user is to
    be warned of. `isolated` says whether FMUs run in processes of their own; by default third-party ones do.
    A call of such an FMU may take `step_timeout`, and a whole run `run_timeout` [s].
    """

    title: str
    description: str
    name: str
    text: str
    directory: Path
    periods: float
    steps_per_period: float
    instances: dict[str, Instance]
    wires: list[Wire]
    drives: list[Drive]
    record: list[str]
    claims: list[dict[str, Any]]
    step: float | None = None
    coupling: str = LAGGED
    grid: str = UNIFORM
    coarse_steps_per_revolution: int = 24
    isolated: bool | None = None
    step_timeout: float = 60.0
    run_timeout: float = 86400.0
    file: Path | None = None
    package: Path | None = None
    notes: tuple[str, ...] = ()
    overrides: dict[str, Any] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)
    package_sha256: str = ""

    def __repr__(self) -> str:
        return f"<Scene {self.name}: {len(self.instances)} instances, {len(self.claims)} claims>"

    def isolates(self, name: str) -> bool:
        """Whether an instance runs in a process of its own."""
        instance = self.instances[name]
        stated = self.isolated if instance.isolated is None else instance.isolated
        return AVAILABLE and not instance.fmu.ours if stated is None else stated

    @property
    def speed(self) -> float:
        """Mean speed of the main shaft [rad/s]."""
        shaft = self.instances["shaft"]
        return float(shaft.values.get("speed", shaft.fmu.ports["speed"].start or 0.0))

    @property
    def step_size(self) -> float:
        """Communication step [s]: a revolution at mean speed in `steps_per_revolution` equal steps."""
        if self.step is not None:
            return self.step
        return 2.0 * math.pi / (abs(self.speed) * self.steps_per_period)

    @property
    def steps(self) -> int:
        """Number of communication steps."""
        return round(self.periods * self.steps_per_period)


def load(path: str | Path, overrides: dict[str, Any] | None = None) -> Scene:
    """Read a scene from a TOML file. Raises LoomfmuError naming the file and what is wrong."""
    path = Path(path)
    text = text_of(path)
    try:
        return replace(parse(text, path.stem, overrides, path.parent), file=path)
    except LoomfmuError as error:
        raise LoomfmuError(f"{path}: {error}") from None


def parse(
    text: str,
    name: str = "scene",
    overrides: dict[str, Any] | None = None,
    directory: str | Path = ".",
) -> Scene:
    """A scene from its text; `overrides` are values such as {"shaft.speed": "685 rpm"}.

    `directory` is where the files that the scene names are looked for.
    """
    tables = toml(text)
    texts = standard_loom.resolve(tables, Path(directory))
    given = instance_tables(tables, Path(directory))
    for key, value in (overrides or {}).items():
        override(tables, given, key, value, Path(directory))
    instances = {name: instance(name, table, Path(directory)) for name, table in given.items()}
    wires = wires_of(instances, tables.get("wires", {}))
    for each in wires:
        instances[each.sink[0]].follow(each)
    scene = assemble(tables, instances, wires, name, text, Path(directory))
    texts |= own_texts(given.values(), Path(directory))
    scene = replace(scene, overrides=dict(overrides or {}), texts=texts)
    if not {"loom", "claims"} & set(tables) and not set(tables) - set(KEYS):
        raise LoomfmuError("the scene is empty: add [loom] for a standard loom, or tables such as [weft]")
    for owner, table in given.items():
        for key in table:
            check_free(scene, owner, key)
    return scene


def check_free(scene: Scene, instance: str, key: str) -> None:
    """Refuse a value for an input that has another source: an input has one."""
    name = f"{instance}.{key}"
    variable = scene.instances[instance].fmu.name_of(key)
    for each in scene.wires:
        if each.sink == (instance, variable):
            cut = f'; to set it, cut the wire: [wires] "{instance}.{variable}" = false'
            raise LoomfmuError(
                f"{name} cannot be set, it is wired to {'.'.join(each.source)}"
                f"{cut if scene.package is None else ' in the package'}"
            )
    if any((each.instance, each.variable) == (instance, variable) for each in scene.drives):
        raise LoomfmuError(
            f"{name} cannot be set, it is driven along a table; to set it, take it out of [inputs]"
        )


def toml(text: str) -> dict[str, Any]:
    """The tables of a scene's text."""
    try:
        return tomllib.loads(text)
    except ValueError as error:  # also for an integer that has more digits than Python reads
        raise LoomfmuError(f"not valid TOML: {error}") from None


def assemble(
    tables: dict[str, Any], instances: dict[str, Instance], wires: list[Wire], name: str, text: str,
    directory: Path,
) -> Scene:  # fmt: skip
    """A scene of wired instances, with what else the tables of its text say."""
    seconds = _by_seconds(tables)
    if seconds is not None:
        duration, step = seconds
        turns, steps = duration, 1.0 / step
    else:
        turns = _number(tables.get("revolutions", 1), "revolutions", 1e-9, 1e9)
        most = tables.get("steps_per_revolution", 1440)
        steps = int(_number(most, "steps_per_revolution", 1, 1e9, whole=True))
    drives = drives_of(instances, wires, tables.get("inputs", {}))
    scene = Scene(
        title=str(tables.get("title", name)),
        description=str(tables.get("description", "")).strip(),
        name=name,
        text=text,
        directory=directory,
        periods=turns,
        steps_per_period=steps,
        instances=instances,
        wires=wires,
        drives=drives,
        record=_record(instances, tables.get("record", ["*"])),
        claims=_claims(tables.get("claims", [])),
        step=seconds[1] if seconds is not None else None,
        coupling=_choice(tables, "coupling", COUPLINGS),
        grid=_choice(tables, "grid", GRIDS),
        coarse_steps_per_revolution=int(
            _number(tables.get(COARSE, Scene.coarse_steps_per_revolution), COARSE, 1, 1e9, whole=True)
        ),
        isolated=truth(tables[ISOLATED], ISOLATED) if ISOLATED in tables else None,
        step_timeout=_seconds(tables.get("step_timeout", Scene.step_timeout), "step_timeout", 1e-3),
        run_timeout=_seconds(tables.get("run_timeout", Scene.run_timeout), "run_timeout", 1e-3),
        notes=tuple(_notes(instances, wires, drives, turns)),
    )
    _check_single(scene)
    _check_time(scene)
    return scene


def _notes(
    instances: dict[str, Instance], wires: list[Wire], drives: list[Drive], end: float
) -> Iterable[str]:
    """What a user is to be warned of; `end` is where the run ends, as the tables of drives count it."""
    for drive in drives:
        if drive.periods[0] >= end:
            name, start = f"inputs.{drive.instance}.{drive.variable}", drive.periods[0]
            yield f"{name} begins at {start:g}, after the end at {end:g}: its first value holds all the time"
    yield from mixed(instances)
    fed = {wire.sink for wire in wires} | {(drive.instance, drive.variable) for drive in drives}
    for name, each in instances.items() if "shaft" in instances else ():
        inputs = standard_loom.shaft_inputs(each.fmu.component, each.fmu.ports)
        if inputs and not any((name, variable) in fed for variable in inputs):
            yield f"{name} turns at a speed of its own: none of its shaft inputs is wired to the shaft"
        if not inputs and each.fmu.component and standard_loom.turns_alone(each.fmu.component):
            yield f"{name} turns at a speed of its own: {each.fmu.name} has no terminal SHAFT"
    doubts = [doubt for each in instances.values() for doubt in each.doubts.values()]
    yield from filter(None, (*doubts, *(each.doubt for each in drives)))


def _check_single(scene: Scene) -> None:
    """Refuse a second instance in this process of what a process can have one of."""
    found: dict[str, str] = {}
    for name, each in scene.instances.items():
        if not each.fmu.single or scene.isolates(name):
            continue
        if each.fmu.sha256 in found:
            raise LoomfmuError(
                f"{found[each.fmu.sha256]} and {name}: a process can have one instance only of"
                f" {each.fmu.path} (canBeInstantiatedOnlyOncePerProcess); set isolated = true"
            )
        found[each.fmu.sha256] = name


def _by_seconds(tables: dict[str, Any]) -> tuple[float, float] | None:
    """Duration and step of a scene that runs by seconds [s]."""
    given = [key for key in TIMES if key in tables]
    if not {"duration", "step"} & set(given):
        return None
    if set(given) != {"duration", "step"}:
        raise LoomfmuError(
            f"{' and '.join(given)}: a scene runs either by duration and step,"
            " or by revolutions and steps_per_revolution"
        )
    return _seconds(tables["duration"], "duration", 1e-12), _seconds(tables["step"], "step", 1e-12)


def _seconds(given: Any, key: str, low: float) -> float:
    """A time within bounds [s]."""
    try:
        value = units.parse(given, "s")
    except units.UnitError as error:
        raise LoomfmuError(f"{key}: {error}") from None
    return _number(value, key, low, 1e9)


def _check_time(scene: Scene) -> None:
    """Refuse a scene that has no step, or whose duration is none."""
    shaft = scene.instances.get("shaft")
    if scene.step is not None:
        if scene.steps < 1:
            raise LoomfmuError(
                f"duration = {scene.periods:g} s in steps of {scene.step:g} s is less than one step"
            )
        _check_whole(scene, "duration", " s", f"{scene.step:g} s")
        return
    if shaft is None or "speed" not in shaft.fmu.ports:
        raise LoomfmuError(
            'there is no shaft whose speed sets the step: say duration = "2 s" and step = "1 ms"'
        )
    if scene.speed == 0.0:
        raise LoomfmuError("shaft.speed = 0 rev/min: the shaft's speed sets the step, it may not be 0")
    if scene.steps < 1:
        raise LoomfmuError(
            f"revolutions = {scene.periods:g} at {scene.steps_per_period} steps each is less than one step"
        )
    _check_whole(scene, "revolutions", "", f"1/{scene.steps_per_period:g} revolution")


def _check_whole(scene: Scene, key: str, unit: str, step: str) -> None:
    """Refuse a duration that does not end with a step: the run would be shorter or longer."""
    wanted = scene.periods * scene.steps_per_period
    if abs(wanted - scene.steps) > ROUNDING * wanted:
        fitting = [n / scene.steps_per_period for n in (math.floor(wanted), math.ceil(wanted)) if n]
        raise LoomfmuError(
            f"{key} = {scene.periods:.10g}{unit} is {wanted:.7g} steps of {step}, not a whole number of"
            f" steps; these would fit: {' or '.join(f'{each:.10g}{unit}' for each in fitting)}"
        )


def _choice(tables: dict[str, Any], key: str, known: tuple[str, ...]) -> str:
    """One of some words; the first one by default."""
    given = tables.get(key, known[0])
    if given not in known:
        raise LoomfmuError(f"{key} = {given!r} is unknown{suggestion(str(given), known)}")
    return str(given)


def _number(given: Any, where: str, low: float, high: float, whole: bool = False) -> float:
    """A plain number within bounds."""
    try:
        value = float(given if not isinstance(given, bool) else "")
    except (TypeError, ValueError):
        raise LoomfmuError(f"{where} = {shown(given)} is not a number") from None
    except OverflowError:
        raise LoomfmuError(f"{where} = {shown(given)} is outside [{low:g}, {high:g}]") from None
    if not low <= value <= high:
        raise LoomfmuError(f"{where} = {value:g} is outside [{low:g}, {high:g}]")
    if whole and value != int(value):
        raise LoomfmuError(f"{where} = {value:g} is not a whole number")
    return value


def _record(instances: dict[str, Instance], patterns: Any) -> list[str]:
    """The outputs that match one of the patterns, in the order of the scene."""
    if not isinstance(patterns, list):
        raise LoomfmuError(f'record = {patterns!r} is not a list such as ["belt.*", "weft.travel"]')
    outputs = list(_outputs(instances.values()))
    wanted: set[str] = set()
    for pattern in patterns:
        matched = fnmatch.filter(outputs, str(pattern))
        if not matched and (outputs or pattern != "*"):
            raise LoomfmuError(f"record: no output is called {pattern!r}{suggestion(str(pattern), outputs)}")
        wanted.update(matched)
    return [output for output in outputs if output in wanted]


def _outputs(instances: Iterable[Instance]) -> Iterable[str]:
    for each in instances:
        for port in each.fmu.ports.values():
            if port.causality == "output":
                yield f"{each.name}.{port.name}"


def _claims(tables: Any) -> list[dict[str, Any]]:
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise LoomfmuError("claims are written as [[claims]] tables")
    return tables
