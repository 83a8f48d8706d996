"""Warnings about a scene."""

from collections.abc import Container, Iterable, Sequence
from pathlib import Path
from typing import Any

from ... import machines
from ...errors import LoomfmuError, listed
from . import standard_loom
from .drives import Drive
from .graph import Wire
from .instances import Instance

# of a rapier: what loads the shaft, but does not change how the head moves
LOADS_OF_RAPIER = ("moving_mass", "wheel_inertia", "belt_mass", "belt_length")


def of_scene(
    instances: dict[str, Instance], wires: list[Wire], drives: list[Drive], end: float
) -> Iterable[str]:
    """Warnings about a scene; `end` is where the run ends, as the tables of drives count it."""
    for drive in drives:
        if drive.periods[0] >= end:
            name, start = f"inputs.{drive.instance}.{drive.variable}", drive.periods[0]
            yield f"{name} begins at {start:g}, after the end at {end:g}: its first value holds throughout"
    yield from _mixed(instances, wires)
    fed = {wire.sink for wire in wires} | {(drive.instance, drive.variable) for drive in drives}
    for name, each in instances.items() if "shaft" in instances else ():
        inputs = standard_loom.shaft_inputs(each.fmu.component, each.fmu.ports)
        if inputs and not any((name, variable) in fed for variable in inputs):
            yield f"{name} runs at its own constant speed: its shaft inputs are not wired to the shaft"
        if not inputs and each.fmu.component and standard_loom.turns_alone(each.fmu.component):
            yield f"{name} runs at its own constant speed: {each.fmu.name} has no terminal SHAFT"
    yield from _loads(instances, wires)
    yield from _mirrored(instances, wires)
    doubts = [doubt for each in instances.values() for doubt in each.doubts.values()]
    yield from filter(None, (*doubts, *(each.doubt for each in drives)))


def _mixed(instances: dict[str, Instance], wires: list[Wire]) -> list[str]:
    """Warnings where the instances of a loom are not all of one machine, or those of a rapier of one head."""
    notes, moved_by = [], {wire.sink: wire.source[0] for wire in wires}
    for kind, takers in machines.TAKERS.items():
        groups: dict[str, list[Instance]] = {}
        for name, each in instances.items():
            if each.fmu.ours and each.fmu.name in takers:
                rapier = moved_by.get((name, "travel"), name) if kind == "head" else ""
                groups.setdefault(rapier, []).append(each)
        notes += [note for fitted in groups.values() if (note := _mixture(kind, fitted))]
    return notes


def _mixture(kind: str, fitted: list[Instance]) -> str:
    """A warning where some instances do not have the same machine or head; none where they do."""
    names = dict.fromkeys(each.published[kind] for each in fitted if kind in each.published)
    differing = [
        each for each in fitted if kind not in each.published and not all(_is(each, kind, n) for n in names)
    ]
    if len(names) < 2 and not differing:
        return ""
    shown = [f"{each.name} has {each.published[kind]}" for each in fitted if kind in each.published]
    shown += [f"{each.name} has its own values" for each in differing]
    return f"the loom mixes {kind}s: {listed(shown)}; {kind} = NAME sets all of them"


def _is(each: Instance, kind: str, name: str) -> bool:
    """Return whether an instance has a published machine's or head's values without naming it."""
    wanted = machines.parameters(each.fmu.name, **{kind: name})
    return all(each.values.get(key, each.fmu.ports[key].start) == value for key, value in wanted.items())


def _loads(instances: dict[str, Instance], wires: list[Wire]) -> Iterable[str]:
    """Warnings about mechanisms that load the shaft more than once, or not at all."""
    sinks: dict[tuple[str, str], dict[str, list[str]]] = {}  # of each output, by their instances
    for wire in wires:
        sinks.setdefault(wire.source, {}).setdefault(wire.sink[0], []).append(".".join(wire.sink))
    for name, each in instances.items():
        torque = standard_loom.gathers(each.fmu.component) if each.fmu.component else ""
        if not torque:
            continue
        for other, mechanism in instances.items():
            wired = sinks.get((other, torque), {})
            loads = wired.get(name, [])
            if len(loads) > 1:
                yield f"{other}.{torque} loads {name} {len(loads)} times: {listed(loads)}; keep one wire"
            port = mechanism.fmu.ports.get(torque)
            if port and port.causality == "output" and not wired:
                yield f"{other} does not load {name}: {other}.{torque} is not wired"


def _mirrored(instances: dict[str, Instance], wires: list[Wire]) -> Iterable[str]:
    """Warnings where the weft takes the taker to move as the giver does, but it does not."""
    feeds = {wire.sink: wire.source[0] for wire in wires}
    yarns = [name for name, each in instances.items() if each.fmu.name == "WeftTension"]
    for transfer in instances:
        giver, taker = (feeds.get((transfer, f"{head}_travel"), "") for head in ("giver", "taker"))
        if giver not in instances or taker not in instances:
            continue
        differing = _unlike(instances[taker], instances[giver])
        for yarn in yarns if differing else ():
            if feeds.get((yarn, "travel")) == giver:
                yield (
                    f"{yarn} follows {giver} on both ways, but {taker} moves differently: it has its own"
                    f" {listed(differing)}; after the hand-over the tension is that of a taker like {giver}"
                )


def _unlike(one: Instance, other: Instance) -> list[str]:
    """The parameters by which two rapiers move differently."""

    def value(each: Instance, name: str) -> float | None:
        return each.values.get(name, each.fmu.ports[name].start)

    shared = [name for name, port in one.fmu.ports.items() if port.causality == "parameter"]
    return [
        name
        for name in shared
        if name in other.fmu.ports and name not in LOADS_OF_RAPIER and value(one, name) != value(other, name)
    ]


def added(tables: dict[str, Any], directory: Path) -> Iterable[str]:
    """Warnings about numbered tables that add a mechanism to a standard loom, perhaps by a slip."""
    loom = standard_loom.loom(tables["loom"], directory) if "loom" in tables else {}
    for name in tables if loom else ():
        stem = standard_loom.stem(name)
        fitting = standard_loom.FITTED_TO.get(stem, stem)
        carrier = fitting + name.removeprefix(stem)
        known = stem in standard_loom.COMPONENT_OF and stem != name and name not in loom
        fitted = carrier != name and carrier in {*loom, *tables}
        if not known or fitted or {"component", "fmu"} & tables[name].keys():
            continue
        there = standard_loom.members(stem, loom) or [stem] * (stem in loom)
        if carrier == name and not there:  # it is the only one
            continue
        beside = f"beside {listed(there)}" if there else f"which has no {carrier}"
        both = "set loom.both_rapiers = true for the taker's, or " if "weft" in (stem, fitting) else ""
        meant = f'write component = "{standard_loom.COMPONENT_OF[stem]}" if it is meant'
        yield f"[{name}] adds a {stem.replace('_', ' ')} to the loom, {beside}; {both}{meant}"


def still(
    instances: dict[str, Instance], wires: dict[str, Any], fed: Container[tuple[str, str]]
) -> Iterable[str]:
    """Warnings about mechanisms whose motion is cut off and has no other source or value."""
    for name, each in instances.items():
        for inputs in standard_loom.motions(each.fmu.component) if each.fmu.component else ():
            cut = all(wires.get(f"{name}.{key}") is False for key in inputs)
            if cut and not any((name, key) in fed or key in each.values for key in inputs):
                yield f"{name} does not move: {listed(inputs)} are cut and have no value"


def without_effect(instances: dict[str, Instance], keys: Iterable[tuple[str, str]]) -> Iterable[str]:
    """Warnings about values that a scene gives, but that another value switches off."""
    return (note for _, note in _switched_off(instances, keys))


def check_effect(
    instances: dict[str, Instance], targets: Sequence[str], others: Container[str] = (), where: str = ""
) -> None:
    """Refuse to vary what another value switches off; `others` vary as well, and may switch it on."""
    pairs = [(owner, key) for owner, _, key in (each.partition(".") for each in targets) if key]
    off = [note for switch, note in _switched_off(instances, pairs) if switch not in others]
    if off and len(off) == len(targets):
        raise LoomfmuError(where + off[0])


def _switched_off(
    instances: dict[str, Instance], keys: Iterable[tuple[str, str]]
) -> Iterable[tuple[str, str]]:
    """The switches of values without effect, each with what to do."""
    for owner, key in keys:
        switch, wanted = instances[owner].switched_off(instances[owner].fmu.name_of(key))
        if switch:
            name = f"{owner}.{switch}"
            yield name, f"{owner}.{key} has no effect: set {name} = {wanted}"
