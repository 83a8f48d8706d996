"""Warnings about a loom."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from ..cosim.scenes.graph import Wire
from ..cosim.scenes.instances import Instance, members, stem
from ..errors import listed
from . import standard_loom

# of a rapier: what loads the shaft, but does not change how the head moves
LOADS_OF_RAPIER = ("moving_mass", "wheel_inertia", "belt_mass", "belt_length")


def mirrored(instances: Mapping[str, Instance], wires: Iterable[Wire]) -> Iterable[str]:
    """Warnings where the weft takes the taker to move as the giver does, but it does not."""
    feeds = {wire.sink: wire.source[0] for wire in wires}
    yarns = [name for name, instance in instances.items() if instance.fmu.name == "WeftTension"]
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
    shared = [name for name, port in one.fmu.ports.items() if port.causality == "parameter"]
    return [
        name
        for name in shared
        if name in other.fmu.ports and name not in LOADS_OF_RAPIER and one.start(name) != other.start(name)
    ]


def added(tables: dict[str, Any], directory: Path) -> Iterable[str]:
    """Warnings about numbered tables that add a mechanism to a standard loom, perhaps by a slip."""
    loom = standard_loom.instances_of(tables["loom"], directory) if "loom" in tables else {}
    for name in tables if loom else ():
        kind = stem(name)
        fitting = standard_loom.FITTED_TO.get(kind, kind)
        carrier = fitting + name.removeprefix(kind)
        known = kind in standard_loom.COMPONENT_OF and kind != name and name not in loom
        fitted = carrier != name and carrier in {*loom, *tables}
        if not known or fitted or {"component", "fmu"} & tables[name].keys():
            continue
        there = members(kind, loom) or [kind] * (kind in loom)
        if carrier == name and not there:  # it is the only one
            continue
        beside = f"beside {listed(there)}" if there else f"which has no {carrier}"
        both = "set loom.both_rapiers = true for the taker's, or " if "weft" in (kind, fitting) else ""
        meant = f'write component = "{standard_loom.COMPONENT_OF[kind]}" if it is meant'
        yield f"[{name}] adds a {kind.replace('_', ' ')} to the loom, {beside}; {both}{meant}"
