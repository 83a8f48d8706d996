"""What a run can leave out, found backwards from the requested signals.

An instance that no requested signal depends on is not run, an output that is not read is not fetched, and a
main shaft of constant speed needs no FMU: its angle is a product, and what follows it can turn by itself.
FMUs of other makers always run: they may be there for what they do, such as to log or to send.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from ..claims.claims import parameters_of
from ..importing.fmus import Value
from ..master.constant_shaft import ConstantShaft
from ..scenes.graph import Wire
from ..scenes.instances import Instance
from ..scenes.scene import Scene
from ..scenes.standard_loom import FOLLOWED


@dataclass(frozen=True)
class Pruned:
    """A scene with only what some signals need.

    `fetched` are the outputs to be read from the FMUs, `shafts` the shafts that need none, `skipped` lines
    that say what was left out and why.
    """

    scene: Scene
    signals: tuple[str, ...]
    fetched: frozenset[tuple[str, str]]
    shafts: dict[str, ConstantShaft]
    skipped: tuple[str, ...]


def prune(scene: Scene, signals: Iterable[str]) -> Pruned:
    """The scene with only what these signals need."""
    signals = tuple(signals)
    shafts = {name: _constant(each) for name, each in scene.instances.items() if _is_constant(scene, name)}
    wires = [wire for wire in scene.wires if wire.source[0] not in shafts]
    requested = {signal.split(".")[0] for signal in signals} - set(shafts)
    theirs = {name for name, each in scene.instances.items() if not each.fmu.ours}
    needed = _upstream(requested | theirs, wires)
    wires = [wire for wire in wires if wire.sink[0] in needed]
    instances = {name: _turning(scene, name, shafts) for name in scene.instances if name in needed}
    fetched = {wire.source for wire in wires}
    for signal in signals:
        instance, _, variable = signal.partition(".")
        if instance in instances and instances[instance].fmu.ports[variable].causality == "output":
            fetched.add((instance, variable))
    drives = [drive for drive in scene.drives if drive.instance in needed]
    return Pruned(
        scene=replace(scene, instances=instances, wires=wires, drives=drives),
        signals=signals,
        fetched=frozenset(fetched),
        shafts=shafts,
        skipped=tuple(_told(scene, instances, fetched, shafts)),
    )


def effective(scene: Scene, kept: Pruned) -> dict[str, dict[str, Value]]:
    """The values at the start of every instance that runs, and of those whose parameters the claims read.

    What has no effect is left out: a speed of its own where it follows a shaft, an input that is fed.
    """
    read = {name for claim in scene.claims for name in parameters_of(claim)}
    fed = {wire.sink for wire in scene.wires} | {(d.instance, d.variable) for d in scene.drives}
    found = {}
    for name, instance in scene.instances.items():
        if name in kept.scene.instances or name in kept.shafts or name in read:
            running = kept.scene.instances.get(name, instance)
            found[name] = running.effective({variable for owner, variable in fed if owner == name})
    return found


def _upstream(wanted: set[str], wires: list[Wire]) -> set[str]:
    """Instances and all that they are fed by, near or far."""
    needed, waiting = set(wanted), list(wanted)
    while waiting:
        sink = waiting.pop()
        for wire in wires:
            if wire.sink[0] == sink and wire.source[0] not in needed:
                needed.add(wire.source[0])
                waiting.append(wire.source[0])
    return needed


def _is_constant(scene: Scene, name: str) -> bool:
    """Whether an instance is a main shaft of constant speed that only mechanisms follow."""
    shaft = scene.instances[name]
    if shaft.fmu.component is None or not shaft.fmu.component.unsteady:
        return False
    if any(shaft.values.get(variable, 0.0) != 0.0 for variable in shaft.fmu.component.unsteady):
        return False
    return all(
        _follows(scene, sink, name) for sink in {w.sink[0] for w in scene.wires if w.source[0] == name}
    )


def _follows(scene: Scene, name: str, shaft: str) -> bool:
    """Whether an instance takes nothing from the shaft but the motion that it follows."""
    follower = scene.instances[name]
    taken = {wire.sink[1]: wire.source for wire in scene.wires if wire.sink[0] == name}
    wanted = {sink: (shaft, variable) for sink, variable in FOLLOWED.items()}
    from_shaft = {sink: source for sink, source in taken.items() if source[0] == shaft}
    return follower.fmu.ours and follower.values.get("follow_shaft") is True and from_shaft == wanted


def _constant(shaft: Instance) -> ConstantShaft:
    values = {name: shaft.values.get(name, shaft.fmu.ports[name].start) for name in ("speed", "start_angle")}
    return ConstantShaft(**{name: float(value or 0.0) for name, value in values.items()})


def _turning(scene: Scene, name: str, shafts: dict[str, ConstantShaft]) -> Instance:
    """An instance that turns by itself, if it would follow a shaft that is left out."""
    instance = scene.instances[name]
    shaft = {wire.source[0] for wire in scene.wires if wire.sink[0] == name} & set(shafts)
    if not shaft:
        return instance
    constant = shafts[shaft.pop()]
    own = {"follow_shaft": False, "speed": constant.speed, "start_angle": constant.start_angle}
    return replace(instance, values=instance.values | own)


def _told(
    scene: Scene, kept: dict[str, Instance], fetched: set[tuple[str, str]], shafts: dict[str, ConstantShaft]
) -> Iterable[str]:
    """What was left out, and why."""
    for name, instance in scene.instances.items():
        kind = instance.fmu.name
        if name in shafts:
            yield f"{name} ({kind}): its speed is constant, what follows it turns by itself"
        elif name not in kept:
            yield f"{name} ({kind}): nothing that is recorded or claimed depends on it"
        else:
            outputs = [port.name for port in instance.fmu.ports.values() if port.causality == "output"]
            unread = [variable for variable in outputs if (name, variable) not in fetched]
            if unread:
                share = f"{len(unread)} of {len(outputs)} outputs"
                yield f"{name}: {share} that nobody reads: {', '.join(unread)}"
