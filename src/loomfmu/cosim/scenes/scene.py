"""Scenes: what is simulated, for how long, what is recorded and what is claimed of it."""

import contextlib
import fnmatch
import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ... import files
from ...errors import LoomfmuError, within
from ..claims import own_claims
from ..importing.fmus import Value
from ..importing.process import AVAILABLE
from . import notes
from .graph import Drive, Wire, usual_coupling
from .instance_tables import overridden, read
from .instances import Instance
from .settings import KEYS, LAGGED, Times, replaced, settings_of, texts_in, toml
from .tolerances import ends_of
from .wiring import drives_of, wires_of


@dataclass(repr=False)
class Scene:
    """A scene, checked against the FMUs it uses: every name is known, every value in SI and in bounds.

    A period is a revolution of the main shaft, or a second in a scene that runs by seconds and has a `step`:
    the run takes `periods` of them, from `start_time` [s] on. `coupling` is how loops are closed.
    With an `accuracy` a run chooses its steps. `file` or the system package `package` is what it was read
    from, `package_sha256` is the package's, `texts` are those of the other files that its text names,
    `overrides` the values that differ from it, `notes` what the user is to be warned of. `tolerances` are the
    ends between which values may lie, or tables of their distributions, as the scene states them. `isolated`
    says whether FMUs run in processes of their own; by default third-party ones do.
    `connectors` are the outputs of a package's system, as a trace calls them, and the signals that they are.
    A call of such an FMU may take `step_timeout`, and a whole run `run_timeout` [s]. Where an FMU `may_end`
    the run early, claims are judged on what there is.
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
    tolerances: dict[str, Any] = field(default_factory=dict)
    step: float | None = None
    start_time: float = 0.0
    coupling: str = LAGGED
    accuracy: float | None = None
    isolated: bool | None = None
    may_end: bool = False
    step_timeout: float = 60.0
    run_timeout: float = 86400.0
    file: Path | None = None
    package: Path | None = None
    notes: tuple[str, ...] = ()
    overrides: dict[str, Any] = field(default_factory=dict)
    texts: dict[str, str] = field(default_factory=dict)
    package_sha256: str = ""
    connectors: dict[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<Scene {self.name}: {len(self.instances)} instances, {len(self.claims)} claims>"

    def isolates(self, name: str) -> bool:
        """Return whether an instance runs in a process of its own."""
        instance = self.instances[name]
        stated = self.isolated if instance.isolated is None else instance.isolated
        return AVAILABLE and not instance.fmu.trusted if stated is None else stated

    def check_step_timeout(self) -> None:
        """Refuse a `step_timeout` in a scene with no FMU that it could stop."""
        stoppable = (
            self.isolates(name) or instance.fmu.flavour == "live" for name, instance in self.instances.items()
        )
        if self.step_timeout != Scene.step_timeout and not any(stoppable):
            raise LoomfmuError(
                f"step_timeout = {self.step_timeout:g} s cannot stop native FMUs in this process;"
                " set isolated = true, or run live ones (--live)"
            )

    @property
    def unprotected(self) -> list[str]:
        """The instances that run in this process and whose FMUs were given as files: they may end it."""
        return [
            name
            for name, instance in self.instances.items()
            if not (instance.fmu.built or self.isolates(name))
        ]

    @property
    def times(self) -> Times:
        """Its duration and its steps."""
        return Times(self.periods, self.steps_per_period, self.step)

    @property
    def doubts(self) -> set[str]:
        """Warnings of values that were probably meant in another unit."""
        found = {doubt for instance in self.instances.values() for doubt in instance.doubts.values()}
        return found - {""}

    @property
    def speed(self) -> float:
        """Mean speed of the main shaft [rad/s]."""
        speed = _speed(self.instances)
        assert speed is not None, "a scene without a shaft has steps of its own"
        return speed

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

    @property
    def extent(self) -> float:
        """The `periods` of these whole steps, from which the given ones may be off by rounding."""
        return self.steps / self.steps_per_period


def load(path: str | Path, overrides: dict[str, Any] | None = None) -> Scene:
    """Read a scene from a TOML file. Raises LoomfmuError naming the file and what is wrong."""
    path = Path(path)
    text = files.text_of(path)
    with within(path):
        return parse(text, path.stem, overrides, path.parent, path)


def parse(
    text: str,
    name: str = "scene",
    overrides: dict[str, Any] | None = None,
    directory: str | Path = ".",
    file: Path | None = None,
) -> Scene:
    """A scene from its text; `overrides` are values such as {"shaft.speed": "685 rpm"}.

    `directory` is where the files that the scene names are looked for, `file` what its text was read from.
    """
    tables = toml(text, "scene")
    for key in replaced(overrides or {}):
        tables.pop(key, None)
    given = read(tables, overrides or {}, Path(directory))
    wires = wires_of(given.instances, tables)
    scene = assemble(
        tables,
        given.instances,
        wires,
        given.keys,
        name=name,
        text=text,
        directory=Path(directory),
        file=file,
        overrides=dict(overrides or {}),
        texts=given.texts,
    )
    scene.texts |= own_claims.texts(scene.claims, scene.directory)
    if not {"loom", "claims"} & set(tables) and not set(tables) - set(KEYS):
        raise LoomfmuError("the scene is empty: add [loom] for a standard loom, or tables such as [weft]")
    return scene


def files_of(scene: Scene) -> list[Path]:
    """The file of a scene, and what it names: FMUs, weaves, every text that is the name of a file."""
    found = [path for path in (scene.file, scene.package) if path is not None]
    found += [instance.fmu.path for instance in scene.instances.values() if not instance.fmu.built]
    found += [scene.directory / name for name in scene.texts]
    tables = {} if scene.package is not None else toml(scene.text)
    for _place, text in (*texts_in(tables), *texts_in(scene.overrides)):
        with contextlib.suppress(OSError, ValueError):  # most texts cannot be a file's name
            if (scene.directory / text).is_file():
                found.append(scene.directory / text)
    return found


def check_free(scene: Scene, keys: Iterable[tuple[str, str]]) -> None:
    """Refuse values for inputs that have another source; `keys` are pairs of instance and key."""
    wired = {wire.sink: ".".join(wire.source) for wire in scene.wires}
    driven = {(drive.instance, drive.variable) for drive in scene.drives}
    for owner, key in keys:
        sink = (owner, scene.instances[owner].fmu.name_of(key))
        if sink in wired:
            cut = f'; to set it, cut the wire: [wires] "{".".join(sink)}" = false'
            raise LoomfmuError(
                f"{owner}.{key} cannot be set, it is wired to {wired[sink]}"
                f"{cut if scene.package is None else ' in the package'}"
            )
        if sink in driven:
            raise LoomfmuError(
                f"{owner}.{key} cannot be set, it is driven along a table; to set it, remove it from [inputs]"
            )


def assemble(
    tables: dict[str, Any],
    instances: dict[str, Instance],
    wires: list[Wire],
    keys: Iterable[tuple[str, str]],
    **origin: Any,
) -> Scene:
    """A scene of wired instances, with what else the tables of its text say, checked.

    `keys` are the values that its text and `--set` give, as instance and key; `origin` are fields that say
    what it was read from.
    """
    speed = _speed(instances)
    drives = drives_of(instances, wires, tables.get("inputs", {}))
    for drive in drives:
        instances[drive.instance].follow(drive.variable)
    _ask_for_locals(tables.get("record"), instances)
    outputs = (f"{name}.{variable}" for name, each in instances.items() for variable in each.fmu.outputs)
    fields = settings_of(tables, origin["name"], dict.fromkeys(outputs), speed)
    if fields["coupling"] is None:
        trusted = all(instance.fmu.trusted for instance in instances.values())
        fields["coupling"] = usual_coupling(instances, wires, trusted)
    scene = Scene(instances=instances, wires=wires, drives=drives, **fields, **origin)
    _check_single(scene)
    _check_tolerances(scene)
    check_free(scene, keys)
    found = notes.of_scene(tables, scene.directory, instances, wires, drives, keys, scene.periods)
    scene.notes = (*scene.notes, *found)
    return scene


def _ask_for_locals(patterns: Any, instances: Mapping[str, Instance]) -> None:
    """Let locals that are recorded be outputs: by name, or by a pattern that fits no output of their FMU."""
    for pattern in map(str, patterns) if isinstance(patterns, list) else ():
        owner, _, variable = pattern.partition(".")
        for each in (instances[name] for name in fnmatch.filter(instances, owner)):
            inner = each.fmu.inner
            found = [variable] if variable in inner else fnmatch.filter(inner, variable)
            if variable in found or not fnmatch.filter(each.fmu.outputs, variable):
                each.fmu = each.fmu.with_outputs(found)


def differing(one: Scene, other: Scene) -> Iterator[tuple[str, str, Value, Value]]:
    """Yield what start values differ between two scenes of one wiring: instance, variable, both values."""
    for name, each in one.instances.items():
        moved = other.instances[name]
        for variable in {*each.values, *moved.values}:
            before, after = each.start(variable), moved.start(variable)
            if before != after:
                yield name, variable, before or 0.0, after or 0.0


def _speed(instances: Mapping[str, Instance]) -> float | None:
    """The mean speed of the main shaft [rad/s], if there is one that has a speed."""
    shaft = instances.get("shaft")
    if shaft is None or "speed" not in shaft.fmu.ports:
        return None
    return float(shaft.start("speed") or 0.0)


def _check_single(scene: Scene) -> None:
    """Refuse a second instance in this process of what a process can have one of."""
    found: dict[str, str] = {}
    for name, instance in scene.instances.items():
        if not instance.fmu.single or scene.isolates(name):
            continue
        if instance.fmu.sha256 in found:
            raise LoomfmuError(
                f"{found[instance.fmu.sha256]} and {name}: a process can hold only one instance of"
                f" {instance.fmu.path} (canBeInstantiatedOnlyOncePerProcess); set isolated = true"
            )
        found[instance.fmu.sha256] = name


def _check_tolerances(scene: Scene) -> None:
    """Refuse tolerances of what `--set` cannot set either, and ends that are not among its values."""
    for key, given in scene.tolerances.items():
        with within("tolerances"):
            pairs = overridden(scene.instances, key)
            if not pairs[0][0]:
                raise LoomfmuError(f"{key} cannot have a tolerance, only parameters and inputs can")
            check_free(scene, pairs)
            ends = ends_of(given)
            for owner, variable in pairs if ends else ():
                probe = Instance(owner, scene.instances[owner].fmu)
                found = []
                for end in ends or ():
                    probe.set(variable, end)
                    found.append(probe.values.get(probe.fmu.name_of(variable), 0.0))
                if ends and all(isinstance(each, float) for each in found) and not found[0] < found[1]:
                    raise LoomfmuError(f"{key}: the range from {ends[0]} to {ends[1]} is empty")
