"""Warnings about a scene."""

from collections.abc import Container, Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from ... import machines
from ...components.terminals import SHAFT
from ...errors import LoomfmuError, listed
from ..importing.conversions import SAME
from ..standard import standard
from .graph import Drive, Wire
from .instances import Instance


def of_scene(
    tables: dict[str, Any],
    directory: Path,
    instances: dict[str, Instance],
    wires: list[Wire],
    drives: list[Drive],
    keys: Iterable[tuple[str, str]],
    end: float,
) -> Iterator[str]:
    """Warnings about a scene, whose `keys` are the values that it gives, as instance and key.

    `end` is where the run ends, as the tables of drives count it.
    """
    for drive in drives:
        if drive.periods[0] >= end:
            name, start = f"inputs.{drive.instance}.{drive.variable}", drive.periods[0]
            yield f"{name} begins at {start:g}, after the end at {end:g}: its first value holds throughout"
    yield from _unitless(instances, wires)
    yield from _mixed(instances, wires)
    fed = {wire.sink for wire in wires} | {(drive.instance, drive.variable) for drive in drives}
    for name, each in instances.items() if "shaft" in instances else ():
        inputs = each.fmu.shaft_inputs
        if inputs and not any((name, variable) in fed for variable in inputs):
            yield f"{name} runs at its own constant speed: its shaft inputs are not wired to the shaft"
        if each.fmu.facts and each.fmu.facts.turns_alone and not any(sink == name for sink, _input in fed):
            yield f"{name} runs at its own constant speed: {each.fmu.name} has no terminal SHAFT"
    yield from _loads(instances, wires)
    yield from standard().mirrored(instances, wires)
    doubts = [doubt for instance in instances.values() for doubt in instance.doubts.values()]
    yield from filter(None, (*doubts, *(each.doubt for each in drives)))
    yield from standard().added(tables, directory)
    yield from _still(instances, tables.get("wires", {}), fed)
    yield from (note for _, note in _switched_off(instances, keys))


def _unitless(instances: dict[str, Instance], wires: list[Wire]) -> Iterator[str]:
    """One warning that names all wires with a unit at one end alone."""
    found: list[str] = []
    lacking: tuple[str, str] = ("", "")
    for wire in wires:
        ends = {end: instances[end[0]].fmu.ports[end[1]].stated for end in (wire.source, wire.sink)}
        known = next(filter(None, ends.values()), None)
        if known and None in ends.values() and wire.conversion == SAME:
            lacking = next(end for end, unit in ends.items() if unit is None)
            found.append(f"{wire} in {known.name}")
    if found:
        yield (
            f"values pass unchanged on wires with a unit at one end only: {listed(found)}; state the others"
            f' in [units], as "{".".join(lacking)}" = "...", or by --set {".units.".join(lacking)}=...'
        )


def _mixed(instances: dict[str, Instance], wires: list[Wire]) -> list[str]:
    """Warnings where the instances of a loom are not all of one machine, or those of a rapier of one head."""
    notes, moved_by = [], {wire.sink: wire.source[0] for wire in wires}
    for kind, takers in machines.TAKERS.items():
        groups: dict[str, list[Instance]] = {}
        for name, instance in instances.items():
            if instance.fmu.ours and instance.fmu.name in takers:
                rapier = moved_by.get((name, "travel"), name) if kind == "head" else ""
                groups.setdefault(rapier, []).append(instance)
        notes += [note for fitted in groups.values() if (note := _mixture(kind, fitted))]
    return notes


def _mixture(kind: str, fitted: list[Instance]) -> str:
    """A warning where some instances do not have the same machine or head; none where they do."""
    names = dict.fromkeys(each.published[kind] for each in fitted if kind in each.published)
    differing = [
        each
        for each in fitted
        if kind not in each.published and not all(each.has_published(kind, name) for name in names)
    ]
    if len(names) < 2 and not differing:
        return ""
    shown = [f"{each.name} has {each.published[kind]}" for each in fitted if kind in each.published]
    shown += [f"{each.name} has its own values" for each in differing]
    return f"the loom mixes {kind}s: {listed(shown)}; {kind} = NAME sets all of them"


def _loads(instances: dict[str, Instance], wires: list[Wire]) -> Iterable[str]:
    """Warnings about mechanisms that load the shaft more than once, or not at all."""
    sinks: dict[tuple[str, str], dict[str, list[str]]] = {}  # of each output, by their instances
    for wire in wires:
        sinks.setdefault(wire.source, {}).setdefault(wire.sink[0], []).append(".".join(wire.sink))
    for name, instance in instances.items():
        torque = instance.fmu.facts.gathers if instance.fmu.facts else ""
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


def _still(
    instances: dict[str, Instance], wires: dict[str, Any], fed: Container[tuple[str, str]]
) -> Iterable[str]:
    """Warnings about mechanisms whose motion is cut off and has no other source or value."""
    followed = standard().SOURCES.keys() - {SHAFT.name}
    for name, instance in instances.items():
        motions = (
            [end for end in instance.fmu.facts.taken if end.name in followed] if instance.fmu.facts else []
        )
        for inputs in (end.variables for end in motions):
            cut = all(wires.get(f"{name}.{key}") is False for key in inputs)
            if cut and not any((name, key) in fed or key in instance.values for key in inputs):
                yield f"{name} does not move: {listed(inputs)} are cut and have no value"


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
