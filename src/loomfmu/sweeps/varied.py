"""The key of a sweep: the values of the scene that it sets, with their type and unit."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

from .. import units
from ..cosim.importing.fmus import Port
from ..cosim.scenes.instance_tables import overridden, unit_of
from ..cosim.scenes.instances import TOLERANCE, Instance
from ..cosim.scenes.scene import Scene, check_free
from ..cosim.scenes.settings import STEPS, TIMES, truth
from ..errors import LoomfmuError, listed, within
from ..machines import TAKERS, named
from ..own.declared import FILES, ISOLATED, PARAMETER_SETS

Value = float | int | bool | str

SECONDS = ("duration", "step")
COUNTS = (STEPS,)


def shown_unit(unit: str, display: str) -> str:
    """The unit that people read values in; one that is an FMU's alone has no other to be shown in."""
    return unit if display == "1" else display


def labelled(words: str, unit: str) -> str:
    """Words with a unit in brackets, if there is one."""
    return words if unit == "1" else f"{words} [{unit}]"


@dataclass(frozen=True)
class Varied:
    """A key of a sweep. `targets` are the keys of the scene that take its value, in SI; `read` checks one.

    `kind` is Real, Integer, Boolean or Text. `needs_scene` are those whose values only the scene can judge.
    `doubt` warns of a value that was probably meant in another unit; the text is empty otherwise.
    """

    key: str
    targets: tuple[str, ...]
    kind: str
    unit: str
    display: str
    description: str
    read: Callable[[Any], Value]
    needs_scene: bool = False
    doubt: Callable[[Any], str] = lambda _given: ""

    @property
    def shown_unit(self) -> str:
        """The unit that people read it in."""
        return shown_unit(self.unit, self.display)

    def setting(self, value: Value) -> Value:
        """A value as it is set in the scene: it was read and checked already."""
        return units.Si(value) if self.kind == "Real" else value

    def show(self, value: Value) -> str:
        """A value as people read it."""
        if self.kind == "Real" and self.display in units.UNITS:
            return units.show(float(value), self.display)
        return str(value)


@dataclass(frozen=True)
class Keyed:
    """A key that varies, with what its subclasses say of its values."""

    varied: Varied

    @property
    def key(self) -> str:
        """The key in files and in scenes."""
        return self.varied.key


def varied(scene: Scene, key: str) -> Varied:
    """Return the values that a key sets in a scene. Raises LoomfmuError, naming the nearest known key."""
    pairs = overridden(scene.instances, key)
    if not pairs[0][0]:
        return _of_scene(key)
    found = [_variable(scene, key, instance, variable) for instance, variable in pairs]
    if any((each.kind, each.unit) != (found[0].kind, found[0].unit) for each in found):
        raise LoomfmuError(f"{key} differs in type or unit between {listed(name for name, _ in pairs)}")
    targets = tuple(f"{instance}.{variable}" for instance, variable in pairs)
    first = found[0]
    return replace(first, targets=targets)


def _published(key: str, kind: str) -> Varied:
    """The name of a published machine or head."""

    def read(given: Any) -> str:
        named(kind, given)
        return str(given)

    return Varied(key, (), "Text", "1", "1", f"Published {kind}", read, needs_scene=True)


def _of_scene(key: str) -> Varied:
    """One of the scene's own keys."""
    about = key.replace("_", " ")
    if key not in TIMES:
        return Varied(key, (key,), "Text", "1", "1", about, _text(key), needs_scene=True)
    unit = "s" if key in SECONDS else "1"

    def read(given: Any) -> Value:
        with within(key):
            value = units.parse(given, unit)
        if not math.isfinite(value):
            raise LoomfmuError(f"{key} = {value} is not finite")
        if key in COUNTS and value != int(value):
            raise LoomfmuError(f"{key} = {value:g} is not a whole number")
        return int(value) if key in COUNTS else value

    kind = "Integer" if key in COUNTS else "Real"
    return Varied(key, (key,), kind, unit, unit, about, read, needs_scene=True)


def _variable(scene: Scene, key: str, instance: str, variable: str) -> Varied:
    """A parameter of an instance, the start of an input, or a name that an instance goes by."""
    fmu = scene.instances[instance].fmu
    if fmu.ours and variable in TAKERS:
        return _published(key, variable)
    name = fmu.name_of(variable)
    if name not in fmu.ports and (variable in (*PARAMETER_SETS, *FILES) or unit_of(variable)):
        return Varied(key, (key,), "Text", "1", "1", variable, _text(key), needs_scene=True)
    if name not in fmu.ports and variable == ISOLATED:
        about = "Whether it runs in a process of its own"
        return Varied(
            key, (key,), "Boolean", "1", "1", about, lambda given: truth(given, key), needs_scene=True
        )
    if name not in fmu.ports and variable == TOLERANCE and not fmu.ours:
        about, number = "Relative tolerance of its solver", lambda given: units.parse(given, "1")
        return Varied(key, (key,), "Real", "1", "1", about, number, needs_scene=True)
    if array := fmu.elements(variable):
        raise LoomfmuError(f"{key} is an array; vary one of its elements, such as {instance}.{array[0].name}")
    check_free(scene, [(instance, variable)])

    def read(given: Any) -> Value:
        probe = Instance(instance, fmu)
        probe.set(variable, given)
        value = probe.values[name]
        port = fmu.ports[name]
        return port.choice(value) if port.choices else value

    if name not in fmu.ports or fmu.ports[name].causality not in ("parameter", "input"):
        read(0)  # says what is wrong
    port = fmu.ports[name]

    def doubt(given: Any) -> str:
        return port.doubt(given, f"{instance}.{variable}")

    return Varied(key, (key,), _kind(port), port.unit, port.display, port.description, read, doubt=doubt)


def _kind(port: Port) -> str:
    return "Text" if port.choices else port.kind


def _text(key: str) -> Callable[[Any], str]:
    def read(given: Any) -> str:
        if not isinstance(given, str):
            raise LoomfmuError(f"{key} = {given!r} is not a name in quotes")
        return given

    return read
