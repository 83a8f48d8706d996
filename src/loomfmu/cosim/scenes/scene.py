"""Scenes: what is simulated, for how long, what is recorded and what is claimed of it."""

import math
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ... import files
from ...errors import LoomfmuError, check_text
from ...own.declared import ISOLATED
from ..importing.ports import Port
from ..importing.process import AVAILABLE
from ..standard import standard
from . import notes, settings
from .drives import Drive
from .graph import Wire
from .instance_tables import instance, instance_tables, own_texts
from .instances import Instance
from .keys import COARSE, GRIDS, KEYS, LAGGED, MAY_END, UNIFORM, check_kind, replaced
from .overrides import components, overridden, override, override_weave
from .tables import choice, number, toml, truth
from .tables import text as text_of
from .times import check_times, seconds, times_of
from .wiring import drives_of, wires_of


@dataclass(repr=False)
class Scene:
    """A scene, checked against the FMUs it uses: every name is known, every value in SI and in bounds.

    A period is a revolution of the main shaft, or a second in a scene that runs by seconds and has a `step`:
    the run takes `periods` of them. `coupling` is how loops are closed, `grid` where the steps are, with
    `coarse_steps_per_revolution` outside of the windows that the claims look into. With an `accuracy` a run
    chooses its steps. `file` or the system package `package` is what it was read from, `package_sha256` is
    the package's, `texts` are those of the other files that its text names, `overrides` the values that
    differ from it, `notes` what the user is to be warned of. `tolerances` are the ends between which values
    may lie, as the scene states them. `isolated` says whether FMUs run in processes of their own; by default
    third-party ones do.
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
    tolerances: dict[str, tuple[Any, Any]] = field(default_factory=dict)
    step: float | None = None
    coupling: str = LAGGED
    grid: str = UNIFORM
    coarse_steps_per_revolution: int = 24
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

    def __repr__(self) -> str:
        return f"<Scene {self.name}: {len(self.instances)} instances, {len(self.claims)} claims>"

    def isolates(self, name: str) -> bool:
        """Return whether an instance runs in a process of its own."""
        instance = self.instances[name]
        stated = self.isolated if instance.isolated is None else instance.isolated
        return AVAILABLE and not instance.fmu.trusted if stated is None else stated

    @property
    def unprotected(self) -> list[str]:
        """The instances that run in this process and whose FMUs were given as files: they may end it."""
        return [name for name, each in self.instances.items() if not (each.fmu.built or self.isolates(name))]

    @property
    def doubts(self) -> set[str]:
        """Warnings of values that were probably meant in another unit."""
        found = {doubt for each in self.instances.values() for doubt in each.doubts.values()}
        return found - {""}

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
    text = files.text_of(path)
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
    check_kind(tables, "scene")
    rest = override_weave(tables, overrides or {})
    texts = standard().resolve(tables, Path(directory))
    given = instance_tables(tables, Path(directory))
    for key in replaced(rest):
        tables.pop(key, None)
    for key, value in rest.items():
        override(tables, given, key, value, Path(directory))
    instances = {name: instance(name, table, Path(directory)) for name, table in given.items()}
    wires = wires_of(instances, tables.get("wires", {}), tables.get("inputs"))
    fed = {each.sink for each in wires}
    for inheriting in instances.values():
        inheriting.inherit(instances, fed)
    for each in wires:
        instances[each.sink[0]].follow(each)
    scene = assemble(tables, instances, wires, name, text, Path(directory))
    texts |= own_texts(given.values(), Path(directory))
    scene = replace(scene, overrides=dict(overrides or {}), texts=texts)
    if not {"loom", "claims"} & set(tables) and not set(tables) - set(KEYS):
        raise LoomfmuError("the scene is empty: add [loom] for a standard loom, or tables such as [weft]")
    keys = [(owner, key) for owner, table in given.items() for key in table]
    check_free(scene, keys)
    doubts = (
        *standard().added(tables, Path(directory)),
        *notes.still(
            instances, tables.get("wires", {}), fed | {(d.instance, d.variable) for d in scene.drives}
        ),
        *notes.without_effect(instances, keys),
    )
    return replace(scene, notes=(*scene.notes, *doubts))


def check_free(scene: Scene, keys: Iterable[tuple[str, str]]) -> None:
    """Refuse values for inputs that have another source; `keys` are pairs of instance and key."""
    wired = {each.sink: ".".join(each.source) for each in scene.wires}
    driven = {(each.instance, each.variable) for each in scene.drives}
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
    name: str,
    text: str,
    directory: Path,
) -> Scene:
    """A scene of wired instances, with what else the tables of its text say."""
    times = times_of(tables)
    drives = drives_of(instances, wires, tables.get("inputs", {}))
    _check_switches(instances, {each.sink for each in wires} | {(d.instance, d.variable) for d in drives})
    scene = Scene(
        title=check_text(text_of(tables, "title", name), "title"),
        description=text_of(tables, "description").strip(),
        name=name,
        text=text,
        directory=directory,
        periods=times.periods,
        steps_per_period=times.steps_per_period,
        instances=instances,
        wires=wires,
        drives=drives,
        record=settings.recorded(instances, tables.get("record", ["*"])),
        claims=settings.claims(tables.get("claims", [])),
        tolerances=settings.tolerances(tables.get("tolerances", {})),
        step=times.step,
        coupling=settings.coupling(tables, instances, wires),
        grid=choice(tables, "grid", GRIDS),
        coarse_steps_per_revolution=int(
            number(tables.get(COARSE, Scene.coarse_steps_per_revolution), COARSE, 1, 1e9, whole=True)
        ),
        accuracy=settings.accuracy(tables, times),
        isolated=truth(tables[ISOLATED], ISOLATED) if ISOLATED in tables else None,
        may_end=truth(tables.get(MAY_END, Scene.may_end), MAY_END),
        step_timeout=seconds(tables.get("step_timeout", Scene.step_timeout), "step_timeout", 1e-3),
        run_timeout=seconds(tables.get("run_timeout", Scene.run_timeout), "run_timeout", 1e-3),
        notes=tuple(notes.of_scene(instances, wires, drives, times.periods)),
    )
    _check_single(scene)
    _check_tolerances(scene)
    check_times(times, scene.speed if "speed" in _shaft_ports(instances) else None)
    return scene


def _shaft_ports(instances: dict[str, Instance]) -> dict[str, Port]:
    return instances["shaft"].fmu.ports if "shaft" in instances else {}


def _check_switches(instances: dict[str, Instance], fed: Collection[tuple[str, str]]) -> None:
    """Refuse to use an input, such as the work of a mechanism, that comes from another instance but has no
    source: its torque would do no work."""
    for name, each in instances.items():
        for switch, sink in each.switched():
            if each.values.get(switch) and (name, sink) not in fed:
                raise LoomfmuError(
                    f"{name}.{switch} = true, but {name}.{sink} is not wired:"
                    f" wire it, or set {name}.{switch} = false"
                )


def _check_single(scene: Scene) -> None:
    """Refuse a second instance in this process of what a process can have one of."""
    found: dict[str, str] = {}
    for name, each in scene.instances.items():
        if not each.fmu.single or scene.isolates(name):
            continue
        if each.fmu.sha256 in found:
            raise LoomfmuError(
                f"{found[each.fmu.sha256]} and {name}: a process can hold only one instance of"
                f" {each.fmu.path} (canBeInstantiatedOnlyOncePerProcess); set isolated = true"
            )
        found[each.fmu.sha256] = name


def _check_tolerances(scene: Scene) -> None:
    """Refuse tolerances of what `--set` cannot set either, and ends that are not among its values."""
    for key, ends in scene.tolerances.items():
        try:
            pairs = overridden(scene.instances, key, components(scene.instances))
            if not pairs[0][0]:
                raise LoomfmuError(f"{key} cannot have a tolerance, only parameters and inputs can")
            check_free(scene, pairs)
            for owner, variable in pairs:
                probe = Instance(owner, scene.instances[owner].fmu)
                found = []
                for end in ends:
                    probe.set(variable, end)
                    found.append(probe.values.get(probe.fmu.name_of(variable), 0.0))
                if all(isinstance(each, float) for each in found) and not found[0] < found[1]:
                    raise LoomfmuError(f"{key}: the range from {ends[0]} to {ends[1]} is empty")
        except LoomfmuError as error:
            raise LoomfmuError(f"tolerances: {error}") from None
