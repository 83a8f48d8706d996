"""Scenes: what is simulated, for how long, what is recorded and what is claimed of it."""

import fnmatch
import math
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .. import units
from ..errors import LoomfmuError, suggestion
from . import standard_loom
from .drives import Drive, drive, split
from .graph import Wire
from .instances import COARSE, TIMES, Instance, instance, instance_tables, override
from .ports import mismatch

LAGGED, ITERATED = COUPLINGS = ("lagged", "iterated")
UNIFORM, WINDOWS = GRIDS = ("uniform", "windows")


@dataclass
class Scene:
    """A scene, checked against the FMUs it uses: every name is known, every value in SI and in bounds.

    A scene may run by seconds: then `step` is its step, and `revolutions` and `steps_per_revolution` count
    seconds instead of revolutions. `coupling` is how loops are closed, `grid` where the steps are, with
    `coarse_steps_per_revolution` outside of the windows that the claims look into. `package` is the system
    package that it was read from, `notes` what the user is to be warned of.
    """

    title: str
    description: str
    name: str
    text: str
    directory: Path
    revolutions: float
    steps_per_revolution: float
    instances: dict[str, Instance]
    wires: list[Wire]
    drives: list[Drive]
    record: list[str]
    claims: list[dict[str, Any]]
    step: float | None = None
    coupling: str = LAGGED
    grid: str = UNIFORM
    coarse_steps_per_revolution: int = 24
    package: Path | None = None
    notes: tuple[str, ...] = ()

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
        return 2.0 * math.pi / (abs(self.speed) * self.steps_per_revolution)

    @property
    def steps(self) -> int:
        """Number of communication steps."""
        return round(self.revolutions * self.steps_per_revolution)


def load(path: str | Path, overrides: dict[str, Any] | None = None) -> Scene:
    """Read a scene from a TOML file. Raises LoomfmuError naming the file and what is wrong."""
    path = Path(path)
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise LoomfmuError(f"{path}: cannot be read ({getattr(error, 'strerror', None) or error})") from None
    try:
        return parse(text, path.stem, overrides, path.parent)
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
    given = instance_tables(tables, Path(directory))
    for key, value in (overrides or {}).items():
        override(tables, given, key, value)
    instances = {name: instance(name, table, Path(directory)) for name, table in given.items()}
    wires = _wires(instances, given, tables.get("wires", {}))
    for each in wires:
        instances[each.sink[0]].follow(each)
    return assemble(tables, instances, wires, name, text, Path(directory))


def toml(text: str) -> dict[str, Any]:
    """The tables of a scene's text."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise LoomfmuError(f"not valid TOML: {error}") from None


def assemble(
    tables: dict[str, Any], instances: dict[str, Instance], wires: list[Wire], name: str, text: str,
    directory: Path,
) -> Scene:  # fmt: skip
    """A scene of wired instances, with what else the tables of its text say."""
    _check_single(instances)
    seconds = _by_seconds(tables)
    if seconds is not None:
        duration, step = seconds
        turns, steps = duration, 1.0 / step
    else:
        turns = _number(tables.get("revolutions", 1), "revolutions", 1e-9, 1e9)
        most = tables.get("steps_per_revolution", 1440)
        steps = int(_number(most, "steps_per_revolution", 1, 1e9, whole=True))
    scene = Scene(
        title=str(tables.get("title", name)),
        description=str(tables.get("description", "")).strip(),
        name=name,
        text=text,
        directory=directory,
        revolutions=turns,
        steps_per_revolution=steps,
        instances=instances,
        wires=wires,
        drives=_drives(instances, wires, tables.get("inputs", {})),
        record=_record(instances, tables.get("record", ["*"])),
        claims=_claims(tables.get("claims", [])),
        step=seconds[1] if seconds is not None else None,
        coupling=_choice(tables, "coupling", COUPLINGS),
        grid=_choice(tables, "grid", GRIDS),
        coarse_steps_per_revolution=int(
            _number(tables.get(COARSE, Scene.coarse_steps_per_revolution), COARSE, 1, 1e9, whole=True)
        ),
    )
    _check_time(scene)
    return scene


def _check_single(instances: dict[str, Instance]) -> None:
    """Refuse a second instance of what a process can have one of."""
    found: dict[str, str] = {}
    for name, each in instances.items():
        if not each.fmu.single:
            continue
        if each.fmu.sha256 in found:
            raise LoomfmuError(
                f"{found[each.fmu.sha256]} and {name}: a process can have one instance only of"
                f" {each.fmu.path} (canBeInstantiatedOnlyOncePerProcess)"
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
    found = []
    for key in ("duration", "step"):
        try:
            value = units.parse(tables[key], "s")
        except units.UnitError as error:
            raise LoomfmuError(f"{key}: {error}") from None
        found.append(_number(value, key, 1e-12, 1e9))
    return found[0], found[1]


def _check_time(scene: Scene) -> None:
    """Refuse a scene that has no step, or whose duration is none."""
    shaft = scene.instances.get("shaft")
    if scene.step is not None:
        if scene.steps < 1:
            raise LoomfmuError(
                f"duration = {scene.revolutions:g} s in steps of {scene.step:g} s is not one step"
            )
        return
    if shaft is None or "speed" not in shaft.fmu.ports:
        raise LoomfmuError(
            'there is no shaft whose speed sets the step: say duration = "2 s" and step = "1 ms"'
        )
    if scene.speed == 0.0:
        raise LoomfmuError("shaft.speed = 0 rev/min: the shaft's speed sets the step, it may not be 0")
    if scene.steps < 1:
        raise LoomfmuError(
            f"revolutions = {scene.revolutions:g} at {scene.steps_per_revolution} steps each is not one step"
        )


def _wires(instances: dict[str, Instance], given: dict[str, dict[str, Any]], spelt_out: Any) -> list[Wire]:
    """The standard loom's wires where both ends are there, and those that the scene spells out."""
    if not isinstance(spelt_out, dict):
        raise LoomfmuError('wires is no table of "instance.input" = "instance.output"')
    sources: dict[str, str] = {}
    for name, each in instances.items():
        standard = standard_loom.wires(name, each.fmu.name) if each.fmu.ours else {}
        for sink, source in standard.items():
            if source.split(".")[0] in instances and sink not in given[name]:
                sources[f"{name}.{sink}"] = source
    for sink, source in _dotted(spelt_out).items():
        if source is False:
            if sources.pop(sink, None) is None:
                raise LoomfmuError(f"wires: {sink!r} is not wired{suggestion(sink, sources)}")
        else:
            sources[sink] = source
    return [wire(instances, sink, source) for sink, source in sources.items()]


def _dotted(table: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """A TOML table with its keys joined by dots, quoted or not."""
    flat: dict[str, Any] = {}
    for key, value in table.items():
        flat |= _dotted(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return flat


def wire(instances: dict[str, Instance], sink: str, source: Any) -> Wire:
    """A wire whose ends are known, of the right kind and of the same unit."""
    where = f"wire {source} -> {sink}"
    ends = []
    for end, causality in ((sink, "input"), (source, "output")):
        name, _, variable = str(end).partition(".")
        if name not in instances:
            raise LoomfmuError(f"{where}: there is no instance {name!r}{suggestion(name, instances)}")
        fmu = instances[name].fmu
        variable = fmu.name_of(variable)
        fitting = [port.name for port in fmu.ports.values() if port.causality == causality]
        if variable not in fitting:
            raise LoomfmuError(
                f"{where}: {name} has no {causality} {variable!r}{suggestion(variable, fitting)}"
            )
        ends.append((name, variable))
    to, origin = (instances[name].fmu.ports[variable] for name, variable in ends)
    reason = mismatch(str(source), origin, sink, to)
    if reason:
        raise LoomfmuError(f"{where}: {reason}")
    if origin.kind != to.kind:
        raise LoomfmuError(f"{where}: {source} is of type {origin.kind}, {sink} of type {to.kind}")
    return Wire(source=ends[1], sink=ends[0])


def _drives(instances: dict[str, Instance], wires: list[Wire], table: Any) -> list[Drive]:
    """The inputs that the scene drives along tables; an input has one source."""
    if not isinstance(table, dict):
        raise LoomfmuError('inputs is no table of "instance.input" = [[revolution, value], ...]')
    drives = []
    for name, rows in _dotted(table).items():
        owner, variable = split(name, instances)
        if any(each.sink == (owner, variable) for each in wires):
            raise LoomfmuError(f'inputs.{name} is wired already; cut that wire with wires."{name}" = false')
        drives.append(drive(name, instances[owner].fmu.port(variable, f"inputs.{name}"), rows))
    return drives


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
        raise LoomfmuError(f"{where} = {given!r} is not a number") from None
    if not low <= value <= high:
        raise LoomfmuError(f"{where} = {value:g} is outside [{low:g}, {high:g}]")
    if whole and value != int(value):
        raise LoomfmuError(f"{where} = {value:g} is not a whole number")
    return value


def _record(instances: dict[str, Instance], patterns: Any) -> list[str]:
    """The outputs that match one of the patterns, in the order of the scene."""
    if not isinstance(patterns, list):
        raise LoomfmuError(f'record = {patterns!r} is no list such as ["belt.*", "weft.travel"]')
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
