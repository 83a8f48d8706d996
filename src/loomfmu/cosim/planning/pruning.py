"""Pruning: the parts that a run leaves out, found backwards from the requested signals.

An instance that no requested signal depends on is not run, an output that is not read is not fetched, and a
main shaft of constant speed needs no FMU: its angle is a product, and what follows it can turn by itself.
Third-party FMUs always run: they may be there for what they do, such as to log or to send.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace

from ...components.shaft_driven import FOLLOWED, FOLLOWING, ShaftDriven
from ...declaring.upstream import sources_of, upstream
from ..claims.claim import Claim
from ..importing.fmus import Value
from ..master.signals import ConstantShaft
from ..scenes.instances import Instance, altered
from ..scenes.scene import Scene


@dataclass(frozen=True)
class Pruned:
    """A scene with only what some signals need.

    `fetched` are the outputs to read from the FMUs, `shafts` the shafts that need no FMU, `turning` the shaft
    whose motion an instance computes by itself, `skipped` lines that say what was left out and why.
    """

    scene: Scene
    signals: tuple[str, ...]
    fetched: frozenset[tuple[str, str]]
    shafts: dict[str, ConstantShaft]
    turning: dict[str, str]
    skipped: tuple[str, ...]

    def of(self, scene: Scene) -> "Pruned":
        """The same of this scene, which differs in values alone."""
        shafts = {name: _constant(scene.instances[name]) for name in self.shafts}
        instances = {
            name: _turning(scene.instances[name], shafts.get(self.turning.get(name, "")))
            for name in self.scene.instances
        }
        left = altered(scene, instances=instances, wires=self.scene.wires, drives=self.scene.drives)
        return altered(self, scene=left, shafts=shafts)


def prune(scene: Scene, signals: Iterable[str], keep_shafts: bool = False) -> Pruned:
    """The scene with only what these signals need; `keep_shafts` leaves in shafts of constant speed."""
    signals = tuple(signals)
    turning = () if keep_shafts else scene.instances.items()
    shafts = {name: _constant(each) for name, each in turning if _is_constant(scene, name)}
    wires = [wire for wire in scene.wires if wire.source[0] not in shafts]
    requested = {signal.split(".")[0] for signal in signals} - set(shafts)
    third_party = {name for name, each in scene.instances.items() if not each.fmu.trusted}
    needed = upstream(requested | third_party, sources_of((w.source[0], w.sink[0]) for w in wires))
    wires = [wire for wire in wires if wire.sink[0] in needed]
    like = {wire.sink[0]: wire.source[0] for wire in scene.wires if wire.source[0] in shafts}
    instances = {
        name: _turning(each, shafts.get(like.get(name, "")))
        for name, each in scene.instances.items()
        if name in needed
    }
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
        turning=like,
        skipped=tuple(_skipped(scene, instances, fetched, shafts)),
    )


class Effective:
    """The start values of every instance that runs, and of those whose parameters the claims need.

    What has no effect is left out: an instance's own speed if it follows a shaft, an input that is wired.
    """

    def __init__(self, scene: Scene, claims: Iterable[Claim], kept: Pruned):
        self._instances, self._running, self._shafts = scene.instances, kept.scene.instances, kept.shafts
        self._fed, self._read = _fed(scene), {name for claim in claims for name in claim.parameter_owners()}

    def of(self, scene: Scene, kept: Pruned) -> "Effective":
        """The same of this scene, which differs in values alone."""
        return altered(self, _instances=scene.instances, _running=kept.scene.instances)

    def value(self, name: str, variable: str) -> Value | None:
        """A start value; None where there is none that has an effect."""
        each = self._instance(name)
        return each.effect(variable, self._fed.get(name, ())) if each else None

    def groups(self) -> dict[str, dict[str, Value]]:
        """All of them, by their instances."""
        found = {name: self._instance(name) for name in self._instances}
        return {name: each.effective(self._fed.get(name, ())) for name, each in found.items() if each}

    def _instance(self, name: str) -> Instance | None:
        if name in self._running or name not in self._instances:
            return self._running.get(name)
        return self._instances[name] if name in self._shafts or name in self._read else None


def _fed(scene: Scene) -> dict[str, set[str]]:
    """The inputs of each instance that have a source."""
    found: dict[str, set[str]] = {}
    for name, variable in [
        *(wire.sink for wire in scene.wires),
        *((d.instance, d.variable) for d in scene.drives),
    ]:
        found.setdefault(name, set()).add(variable)
    return found


def _is_constant(scene: Scene, name: str) -> bool:
    """Return whether an instance is a main shaft of constant speed that only mechanisms follow."""
    shaft = scene.instances[name]
    if shaft.fmu.component is None or not shaft.fmu.component.unsteady:
        return False
    if any(shaft.values.get(variable, 0.0) != 0.0 for variable in shaft.fmu.component.unsteady):
        return False
    return all(
        _follows(scene, sink, name) for sink in {w.sink[0] for w in scene.wires if w.source[0] == name}
    )


def _follows(scene: Scene, name: str, shaft: str) -> bool:
    """Return whether an instance takes nothing from others but the motion of the shaft."""
    follower = scene.instances[name]
    taken = {wire.sink[1]: wire.source for wire in scene.wires if wire.sink[0] == name}
    wanted = {sink: (shaft, variable) for sink, variable in FOLLOWED.items()}
    from_shaft = {sink: source for sink, source in taken.items() if source[0] == shaft}
    fmu = follower.fmu
    turnable = (
        issubclass(fmu.component or ShaftDriven, ShaftDriven) and follower.values.get(FOLLOWING) is True
    )
    return fmu.trusted and turnable and from_shaft == wanted


def _constant(shaft: Instance) -> ConstantShaft:
    return ConstantShaft(*(float(shaft.start(name) or 0.0) for name in ("speed", "start_angle")))


def _turning(instance: Instance, shaft: ConstantShaft | None) -> Instance:
    """An instance; if it follows a shaft that is left out, it turns by itself instead."""
    if shaft is None:
        return instance
    own = {FOLLOWING: False, "speed": shaft.speed, "start_angle": shaft.start_angle}
    return altered(instance, values=instance.values | own)


def _skipped(
    scene: Scene, kept: dict[str, Instance], fetched: set[tuple[str, str]], shafts: dict[str, ConstantShaft]
) -> Iterable[str]:
    """Lines on what was left out, and why."""
    for name, instance in scene.instances.items():
        kind = instance.fmu.name
        if name in shafts:
            yield f"{name} ({kind}): not run; its speed is constant, so its angle needs no FMU"
        elif name not in kept:
            yield f"{name} ({kind}): not run; nothing that is recorded or claimed depends on it"
        else:
            outputs = [port.name for port in instance.fmu.ports.values() if port.causality == "output"]
            unread = [variable for variable in outputs if (name, variable) not in fetched]
            if unread:
                yield f"{name}: {len(unread)} of {len(outputs)} outputs not read: {', '.join(unread)}"
