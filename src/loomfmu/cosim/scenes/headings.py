"""The heading of a run, made of the values that it has, so that values set later keep it true."""

import re
from collections.abc import Collection, Iterable, Iterator
from typing import Any

from ... import machines, units
from ...errors import LoomfmuError, listed, one_line
from ..standard import standard
from .instance_tables import WEAVE, overridden
from .instances import Instance
from .scene import Scene

SPEED = "shaft.speed"
SAID = (*machines.TAKERS, *(f"loom.{kind}" for kind in machines.TAKERS), WEAVE, SPEED)  # by the first words
LONGEST_WEAVE = 48  # letters


def heading(scene: Scene, varied: Collection[str] = ()) -> str:
    """Machine, head, weave and speed, then what else differs from the scene or from the published machine.

    Values of the keys `varied` are left out: they are those of no single run.
    """
    loom = [*_published(scene)] or [scene.name]
    first = ", ".join(filter(None, (*loom, _weave(scene.instances.values()), _speed(scene, varied))))
    changed = _own_values(scene) | {
        key: _shown(scene, key, value) for key, value in scene.overrides.items() if key not in SAID
    }
    rest = ", ".join(f"{key} = {text}" for key, text in changed.items() if key not in varied)
    return one_line(f"{first}; {rest}" if rest else first)


def _published(scene: Scene) -> Iterator[str]:
    """The machines and the heads that instances have, be it by default."""
    for kind in machines.TAKERS:
        names = (
            instance.published.get(kind) or _default(instance, kind) for instance in scene.instances.values()
        )
        if found := dict.fromkeys(filter(None, names)):
            yield listed(found)


def _default(instance: Instance, kind: str) -> str:
    """The one machine or head whose values an instance has that was given none; "" if there is none."""
    if not instance.fmu.ours or instance.fmu.name not in machines.TAKERS[kind]:
        return ""
    same = [name for name in machines.PUBLISHED[kind] if instance.has_published(kind, name)]
    return same[0] if len(same) == 1 else ""


def _own_values(scene: Scene) -> dict[str, str]:
    """The values of a published machine or head that instances do not have."""
    found = {}
    for name, instance in scene.instances.items():
        published = machines.parameters(instance.fmu.name, **instance.published) if instance.published else {}
        for variable, value in published.items():
            own = instance.values.get(variable, value)
            if own != value:
                found[f"{name}.{variable}"] = _quantity(instance, variable)
    return found


def _weave(instances: Iterable[Instance]) -> str:
    """The pegs of all heald frames in the order of their numbers, if there are any."""
    frames = [each for each in instances if each.fmu.ours and "pattern_length" in each.fmu.ports]
    frames.sort(key=lambda each: [int(part) for part in re.findall(r"\d+", each.name)])
    if not frames:
        return ""
    pegs = [standard().pegs({name: frame.start(name) for name in frame.fmu.ports}) for frame in frames]
    text = "/".join(pegs)
    if len(text) > LONGEST_WEAVE:
        text = f"of {len(pegs)} frames and {max(map(len, pegs))} picks"
    return f"weave {text}"


def _speed(scene: Scene, varied: Collection[str]) -> str:
    """The speed of the main shaft; that of a motor without load is nominal."""
    ports = scene.instances["shaft"].fmu.ports if "shaft" in scene.instances else {}
    if "speed" not in ports or SPEED in varied:
        return ""
    loaded = any(port.causality == "input" for port in ports.values())
    return "nominally " * loaded + units.show(scene.speed, "rev/min")


def _shown(scene: Scene, key: str, value: Any) -> str:
    """A value that was set, with its unit even if it was given without one."""
    if isinstance(value, str) and not units.is_plain(value):
        return value
    try:
        name, variable = overridden(scene.instances, key)[0]
        instance = scene.instances[name]
        return _quantity(instance, instance.fmu.name_of(variable))
    except (KeyError, LoomfmuError):  # the scene's own, such as its revolutions
        return f"{value:.9g}" if isinstance(value, float) else str(value)


def _quantity(instance: Instance, variable: str) -> str:
    """A value of an instance in the unit that people read it in."""
    port = instance.fmu.ports[variable]
    value = instance.start(variable)
    if port.kind == "Real" and port.display in units.UNITS:
        return units.show(float(value or 0.0), port.display)
    return str(value)
