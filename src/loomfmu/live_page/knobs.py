"""What can be varied on a page: parameters of a scene, each over a range or over its choices."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from .. import units
from ..cosim.importing.fmus import Port, Value
from ..cosim.reading import read
from ..cosim.scenes.overrides import components, overridden
from ..cosim.scenes.scene import Scene
from ..cosim.whole import system
from ..errors import LoomfmuError
from ..fmi.system.system import System

USUAL = "shaft.speed"  # what is varied where nothing is named
AROUND = 0.2  # of the scene's value, to either side, where no range is given
FORM = "write --vary INSTANCE.VARIABLE=LOW..HIGH, such as shaft.speed=400rpm..800rpm"


@dataclass(frozen=True)
class Knob:
    """A parameter that a page varies: all of `targets` at once, values in SI, shown as multiples of `factor`.

    `choices` are (value, name); without them it lies between `low` and `high`, in whole numbers if `whole`.
    """

    key: str
    about: str
    targets: tuple[str, ...]
    start: float
    low: float = 0.0
    high: float = 1.0
    unit: str = ""
    factor: float = 1.0
    whole: bool = False
    choices: tuple[tuple[int, str], ...] = ()


def knobs(scene: Scene, parameters: Iterable[str], vary: Sequence[str]) -> list[Knob]:
    """The knobs of a page whose run takes these parameters; the shaft's speed by default.

    Raises LoomfmuError for what cannot be varied, or not over that range.
    """
    known, found = set(parameters), dict[str, Knob]()
    for text in vary or [USUAL] * (USUAL in known):
        key, _, wanted = (part.strip() for part in text.partition("="))
        if key in found:
            raise LoomfmuError(f"--vary {key} is given twice")
        found[key] = _knob(scene, known, key, wanted)
    return list(found.values())


def _knob(scene: Scene, known: set[str], key: str, wanted: str) -> Knob:
    where = f"--vary {key}"
    if "." not in key:
        raise LoomfmuError(f"{where}: {FORM}")
    port, targets = _port(scene, known, key, where)
    name, _, variable = targets[0].partition(".")
    started = scene.instances[name].effective().get(variable)
    if started is None:
        raise LoomfmuError(f"{where}: {key} has no effect in this scene")
    choices = _choices(port)
    low, high = (0, 1) if choices else _range(port, key, wanted, float(started), where)
    _check_alone(scene, key, targets, choices[started == choices[0][0]][0] if choices else low, where)
    if choices:
        if wanted:
            raise LoomfmuError(f"{where}={wanted}: {key} has choices, not a range; write --vary {key}")
        return Knob(key, port.description, targets, float(started), choices=choices)
    shown = "" if port.display == "1" else port.display
    return Knob(
        key, port.description, targets, float(started), float(low), float(high), shown,
        units.unit(port.display).factor, port.kind == "Integer",
    )  # fmt: skip


def _port(scene: Scene, known: set[str], key: str, where: str) -> tuple[Port, tuple[str, ...]]:
    """The variable that a key stands for, and all that it sets."""
    try:
        pairs = overridden(scene.instances, key, components(scene.instances))
        ports = [scene.instances[name].fmu.port(each, name) for name, each in pairs]
    except LoomfmuError as error:
        raise LoomfmuError(f"--vary {error}") from None
    if any(port.causality not in ("parameter", "input") for port in ports):
        raise LoomfmuError(f"{where}: {key} is computed and cannot be set")
    sources = {wire.sink: ".".join(wire.source) for wire in scene.wires}
    for pair in pairs:
        if pair in sources:
            cut = f'to vary it, cut the wire: [wires] "{".".join(pair)}" = false'
            raise LoomfmuError(f"{where}: {key} gets its values from {sources[pair]}; {cut}")
    targets = tuple(f"{name}.{each}" for name, each in pairs if f"{name}.{each}" in known)
    if not targets:
        raise LoomfmuError(f"{where}: {key} has no effect on what this scene records")
    return ports[0], targets


def _check_alone(scene: Scene, key: str, targets: Sequence[str], value: Value, where: str) -> None:
    """Refuse what changes more of a scene than the page can: it sets the targets alone."""
    other = system(read(scene, scene.overrides | {key: value}))

    def rest(whole: System) -> System:
        parts = (
            replace(part, values={k: v for k, v in part.values.items() if f"{part.name}.{k}" not in targets})
            for part in whole.parts
        )
        return replace(whole, parts=tuple(parts), experiment=(0.0, 0.0))

    if rest(other) != rest(system(scene)):
        raise LoomfmuError(f"{where}: {key} changes more of the scene than this value; use loomfmu run --set")


def _choices(port: Port) -> tuple[tuple[int, str], ...]:
    if port.kind == "Boolean":
        return ((0, "no"), (1, "yes"))
    return tuple(zip(port.numbers, port.choices, strict=True))


def _has_no_unit(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _range(port: Port, key: str, wanted: str, start: float, where: str) -> tuple[Value, Value]:
    """Both ends, in SI and within the limits of the variable."""
    if not wanted:
        if not start:
            raise LoomfmuError(f"{where}: {key} is 0, so there is no range around it; {FORM}")
        ends = sorted((start * (1.0 - AROUND), start * (1.0 + AROUND)))
        if port.minimum is not None:
            ends = [max(end, port.minimum) for end in ends]
        if port.maximum is not None:
            ends = [min(end, port.maximum) for end in ends]
        low, high = (float(round(end)) if port.kind == "Integer" else end for end in ends)
    else:
        first, _, last = (end.strip() for end in wanted.partition(".."))
        if not (first and last):
            raise LoomfmuError(f"{where}={wanted}: not a range; {FORM}")
        for end in (first, last):
            if port.display != "1" and _has_no_unit(end):
                unit = f"write the unit of both ends, such as {end}{port.display}"
                raise LoomfmuError(f"{where}={wanted}: {end} has no unit; {unit}")
        low, high = (port.value(end, where) for end in (first, last))
    if not low < high:
        order = "the lower end comes first" if low > high else "both ends are equal"
        raise LoomfmuError(f"{where}={wanted}: the range is empty; {order}")
    return low, high
