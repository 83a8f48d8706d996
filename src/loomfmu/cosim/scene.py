"""Scenes: what is simulated, for how long, what is recorded and what is claimed of it."""

import fnmatch
import math
import re
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from .. import machines
from ..errors import LoomfmuError, suggestion
from . import fmus, standard_loom
from .drives import Drive, drive, split
from .fmus import Fmu, Value
from .graph import Wire

KEYS = (
    "title",
    "description",
    "revolutions",
    "steps_per_revolution",
    "record",
    "loom",
    "wires",
    "inputs",
    "claims",
)
PARAMETER_SETS = ("machine", "head", "pattern", "component")
NAME = re.compile("[A-Za-z][A-Za-z0-9_]*")
TAKEN = ("time", "shaft_angle")  # what a trace has beside its instances


@dataclass
class Instance:
    """One FMU of a scene with the values that are set at its start (SI)."""

    name: str
    fmu: Fmu
    values: dict[str, Value] = field(default_factory=dict)


@dataclass
class Scene:
    """A scene, checked against the FMUs it uses: every name is known, every value in SI and in bounds."""

    title: str
    description: str
    name: str
    text: str
    directory: Path
    revolutions: float
    steps_per_revolution: int
    instances: dict[str, Instance]
    wires: list[Wire]
    drives: list[Drive]
    record: list[str]
    claims: list[dict[str, Any]]

    @property
    def speed(self) -> float:
        """Mean speed of the main shaft [rad/s]."""
        shaft = self.instances["shaft"]
        return float(shaft.values.get("speed", shaft.fmu.ports["speed"].start or 0.0))

    @property
    def step_size(self) -> float:
        """Communication step [s]: a revolution at mean speed in `steps_per_revolution` equal steps."""
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
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise LoomfmuError(f"not valid TOML: {error}") from None
    given = _instance_tables(tables, Path(directory))
    for key, value in (overrides or {}).items():
        _override(tables, given, key, value)
    instances = {instance: _instance(instance, table) for instance, table in given.items()}
    wires = _wires(instances, given, tables.get("wires", {}))
    for wire in wires:
        _follow(instances[wire.sink[0]], wire)
    scene = Scene(
        title=str(tables.get("title", name)),
        description=str(tables.get("description", "")).strip(),
        name=name,
        text=text,
        directory=Path(directory),
        revolutions=_number(tables.get("revolutions", 1), "revolutions", 1e-9, 1e9),
        steps_per_revolution=int(
            _number(tables.get("steps_per_revolution", 1440), "steps_per_revolution", 1, 1e9, whole=True)
        ),
        instances=instances,
        wires=wires,
        drives=_drives(instances, wires, tables.get("inputs", {})),
        record=_record(instances, tables.get("record", ["*"])),
        claims=_claims(tables.get("claims", [])),
    )
    if scene.speed == 0.0:
        raise LoomfmuError("shaft.speed = 0 rev/min: the shaft's speed sets the step, it may not be 0")
    if scene.steps < 1:
        raise LoomfmuError(
            f"revolutions = {scene.revolutions:g} at {scene.steps_per_revolution} steps each is not one step"
        )
    return scene


def _instance_tables(tables: dict[str, Any], directory: Path) -> dict[str, dict[str, Any]]:
    """The table of each instance: the standard loom's, then what the scene says of each."""
    loom = tables.get("loom")
    if loom is not None and not isinstance(loom, dict):
        raise LoomfmuError(f"loom = {loom!r} is no table")
    given = {"shaft": {}} if loom is None else standard_loom.loom(loom, directory)
    groups: list[str] = []
    for key, table in tables.items():
        if key in KEYS:
            continue
        if not isinstance(table, dict):
            raise LoomfmuError(f"{key} is unknown{suggestion(key, KEYS)}")
        siblings = [] if "component" in table else [name for name in tables if name != key]
        if key not in given and _members(key, [*given, *siblings]):
            groups.append(key)
            continue
        known = standard_loom.COMPONENT_OF
        if key not in given and "component" not in table and standard_loom.stem(key) not in known:
            hint = suggestion(key, dict.fromkeys([*KEYS, *given, *known]))
            raise LoomfmuError(f'[{key}] is unknown and has no component = "..." of its own{hint}')
        if not NAME.fullmatch(key):
            raise LoomfmuError(f"instance name {key!r} is not letters, digits and _, a letter first")
        if key in TAKEN:
            raise LoomfmuError(f"instance name {key!r} is taken: a trace has its own {key}")
        given[key] = given.get(key, {}) | table
    for key in groups:  # a table for all members says less than a member's own
        for member in _members(key, given):
            given[member] = given[member] | tables[key] | tables.get(member, {})
    return given


def _members(key: str, given: Iterable[str]) -> list[str]:
    """The numbered instances that a name without number stands for."""
    if key in given:
        return []
    return [name for name in given if standard_loom.stem(name) == key]


def _override(tables: dict[str, Any], given: dict[str, dict[str, Any]], key: str, value: Any) -> None:
    """Let one value of the scene be another."""
    instance, dot, variable = key.partition(".")
    if not dot:
        if key not in ("revolutions", "steps_per_revolution"):
            known = ["revolutions", "steps_per_revolution", *(f"{name}." for name in given)]
            raise LoomfmuError(f"{key!r} cannot be set{suggestion(key, known)}")
        tables[key] = value
        return
    members = [instance] if instance in given else _members(instance, given)
    if not members:
        raise LoomfmuError(f"{key}: the scene has no instance {instance!r}{suggestion(instance, given)}")
    for member in members:
        given[member] = given[member] | {variable: value}


def _instance(name: str, table: dict[str, Any]) -> Instance:
    """An instance with its values checked and in SI."""
    for key in ("component", "machine", "head"):
        if not isinstance(table.get(key, ""), str):
            raise LoomfmuError(f"{name}.{key} = {table[key]!r} is not a name in quotes")
    component = table.get("component", standard_loom.COMPONENT_OF.get(standard_loom.stem(name)))
    fmu = fmus.of_component(str(component))
    if name == "shaft" and fmu.name != "MainShaft":
        raise LoomfmuError(f"shaft.component = {component!r}: the shaft of a scene is a MainShaft")
    values: dict[str, Value] = dict(
        machines.parameters(fmu.name, machine=table.get("machine"), head=table.get("head"))
    )
    if "pattern" in table:
        values |= standard_loom.pattern(table["pattern"], f"{name}.pattern")
    for key, given in table.items():
        if key in PARAMETER_SETS:
            if key == "pattern" and fmu.name != "HealdFrame":
                raise LoomfmuError(f"{name}.pattern: only a HealdFrame has a pattern")
            continue
        if key not in fmu.ports:
            settable = [port.name for port in fmu.ports.values() if port.causality in ("parameter", "input")]
            raise LoomfmuError(f"{name}.{key} is unknown{suggestion(key, [*settable, *PARAMETER_SETS])}")
        port = fmu.ports[key]
        if port.causality not in ("parameter", "input"):
            kind = "an output" if port.causality == "output" else "a state"
            raise LoomfmuError(f"{name}.{key} is {kind} of {fmu.name} and cannot be set")
        values[key] = port.value(given, f"{name}.{key}")
    if "inputs_at_step_end" in fmu.ports:
        values.setdefault("inputs_at_step_end", True)  # the master works in dependency order
    return Instance(name, fmu, values)


def _wires(instances: dict[str, Instance], given: dict[str, dict[str, Any]], spelt_out: Any) -> list[Wire]:
    """The standard loom's wires where both ends are there, and those that the scene spells out."""
    if not isinstance(spelt_out, dict):
        raise LoomfmuError('wires is no table of "instance.input" = "instance.output"')
    sources: dict[str, str] = {}
    for name, instance in instances.items():
        for sink, source in standard_loom.wires(name, instance.fmu.name).items():
            if source.split(".")[0] in instances and sink not in given[name]:
                sources[f"{name}.{sink}"] = source
    for sink, source in _dotted(spelt_out).items():
        if source is False:
            if sources.pop(sink, None) is None:
                raise LoomfmuError(f"wires: {sink!r} is not wired{suggestion(sink, sources)}")
        else:
            sources[sink] = source
    return [_wire(instances, sink, source) for sink, source in sources.items()]


def _dotted(table: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """A TOML table with its keys joined by dots, quoted or not."""
    flat: dict[str, Any] = {}
    for key, value in table.items():
        flat |= _dotted(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return flat


def _wire(instances: dict[str, Instance], sink: str, source: Any) -> Wire:
    """A wire whose ends are known, of the right kind and of the same unit."""
    where = f"wire {source} -> {sink}"
    ends = []
    for end, causality in ((sink, "input"), (source, "output")):
        instance, _, variable = str(end).partition(".")
        if instance not in instances:
            raise LoomfmuError(f"{where}: there is no instance {instance!r}{suggestion(instance, instances)}")
        ports = instances[instance].fmu.ports
        fitting = [port.name for port in ports.values() if port.causality == causality]
        if variable not in fitting:
            raise LoomfmuError(
                f"{where}: {instance} has no {causality} {variable!r}{suggestion(variable, fitting)}"
            )
        ends.append((instance, variable))
    to, origin = (instances[name].fmu.ports[variable] for name, variable in ends)
    if origin.unit != to.unit:
        raise LoomfmuError(f"{where}: {source} is in {origin.unit}, {sink} in {to.unit}")
    if origin.kind != to.kind:
        raise LoomfmuError(f"{where}: {source} is of type {origin.kind}, {sink} of type {to.kind}")
    return Wire(source=ends[1], sink=ends[0])


def _drives(instances: dict[str, Instance], wires: list[Wire], table: Any) -> list[Drive]:
    """The inputs that the scene drives along tables; an input has one source."""
    if not isinstance(table, dict):
        raise LoomfmuError('inputs is no table of "instance.input" = [[revolution, value], ...]')
    drives = []
    for name, rows in _dotted(table).items():
        instance, variable = split(name, instances)
        if any(wire.sink == (instance, variable) for wire in wires):
            raise LoomfmuError(f'inputs.{name} is wired already; cut that wire with wires."{name}" = false')
        drives.append(drive(name, instances[instance].fmu.port(variable, f"inputs.{name}"), rows))
    return drives


def _follow(instance: Instance, wire: Wire) -> None:
    """A mechanism whose shaft angle is wired follows it, and a frame the lift of its dobby."""
    switch = {"shaft_angle": "follow_shaft", "lift_fraction": "follow_lift"}.get(wire.sink[1], "")
    if switch in instance.fmu.ports:
        instance.values.setdefault(switch, True)


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
    outputs = [
        f"{name}.{port.name}"
        for name, instance in instances.items()
        for port in instance.fmu.ports.values()
        if port.causality == "output"
    ]
    wanted: set[str] = set()
    for pattern in patterns:
        matched = fnmatch.filter(outputs, str(pattern))
        if not matched:
            raise LoomfmuError(f"record: no output is called {pattern!r}{suggestion(str(pattern), outputs)}")
        wanted.update(matched)
    return [output for output in outputs if output in wanted]


def _claims(tables: Any) -> list[dict[str, Any]]:
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise LoomfmuError("claims are written as [[claims]] tables")
    return tables
