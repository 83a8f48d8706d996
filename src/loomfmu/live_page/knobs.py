"""The sliders of a page: parameters of a scene, each with its range or its choices."""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import combinations

from .. import units
from ..cosim.importing.fmus import Port, Value
from ..cosim.reading import read
from ..cosim.scenes.instance_tables import overridden
from ..cosim.scenes.notes import check_effect
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
    `units` are the factors of those that an address may give it in. `doubts` warn of ends that were
    probably meant in another unit.
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
    units: Mapping[str, float] = field(default_factory=dict)
    doubts: tuple[str, ...] = ()


@dataclass(frozen=True)
class Marks:
    """Limits along a knob while the others have the scene's values.

    All claims hold in `ranges`, in percent of the knob's range; `texts` say where each claim holds.
    """

    ranges: tuple[tuple[float, float], ...]
    texts: tuple[str, ...]


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
    for one, two in combinations(found.values(), 2):
        if both := set(one.targets) & set(two.targets):
            raise LoomfmuError(f"--vary {one.key} and --vary {two.key} both set {min(both)}; leave out one")
    return list(found.values())


def ends_of(scene: Scene, varied: Iterable[Knob]) -> Iterator[Scene]:
    """Yield the scene with each knob at either end of its range, or at each choice, if it can be run."""
    for knob in varied:
        for value in [choice for choice, _name in knob.choices] or (knob.low, knob.high):
            with suppress(LoomfmuError):
                yield read(scene, scene.overrides | {knob.key: value})


def _knob(scene: Scene, known: set[str], key: str, wanted: str) -> Knob:
    where = f"--vary {key}"
    if "." not in key:
        raise LoomfmuError(f"{where}: {FORM}")
    if key.startswith("loom.") and "loom" not in scene.instances:
        raise LoomfmuError(f"{where}: keys of [loom] cannot be varied; {FORM}")
    port, targets = _port(scene, known, key, where)
    name, _, variable = targets[0].partition(".")
    started = scene.instances[name].effective()[variable]
    choices = _choices(port)
    low, high, doubts = (0, 1, ()) if choices else _range(port, key, wanted, float(started), where)
    _check_alone(scene, key, targets, choices[started == choices[0][0]][0] if choices else low, where)
    if choices:
        if wanted:
            raise LoomfmuError(f"{where}={wanted}: {key} has choices, not a range; write --vary {key}")
        return Knob(key, port.description, targets, float(started), choices=choices)
    shown = "" if port.display == "1" else port.display
    return Knob(
        key,
        port.description,
        targets,
        float(started),
        float(low),
        float(high),
        shown,
        units.unit(port.display).factor,
        port.kind == "Integer",
        units=units.alike(port.display),
        doubts=doubts,
    )


def _port(scene: Scene, known: set[str], key: str, where: str) -> tuple[Port, tuple[str, ...]]:
    """The variable that a key stands for, and all that it sets."""
    try:
        pairs = overridden(scene.instances, key)
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
    check_effect(scene.instances, [".".join(pairs[0])], where=f"{where}: ")
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
        return replace(whole, title="", parts=tuple(parts), experiment=(0.0, 0.0))

    if rest(other) != rest(system(scene)):
        raise LoomfmuError(f"{where}: {key} changes more of the scene than this value; use loomfmu run --set")


def _choices(port: Port) -> tuple[tuple[int, str], ...]:
    if port.kind == "Boolean":
        return ((0, "no"), (1, "yes"))
    return tuple(zip(port.numbers, port.choices, strict=True))


def _range(
    port: Port, key: str, wanted: str, start: float, where: str
) -> tuple[Value, Value, tuple[str, ...]]:
    """Both ends, in SI and within the limits of the variable, and what is odd about them."""
    doubts: list[str] = []
    if not wanted:
        if not start:
            raise LoomfmuError(f"{where}: {key} is 0, so there is no range around it; write {key}=LOW..HIGH")
        ends = sorted((start * (1.0 - AROUND), start * (1.0 + AROUND)))
        if port.minimum is not None:
            ends = [max(end, port.minimum) for end in ends]
        if port.maximum is not None:
            ends = [min(end, port.maximum) for end in ends]
        low, high = (float(round(end)) if port.kind == "Integer" else end for end in ends)
    else:
        first, last = units.ends_of(wanted)
        if not (first and last):
            raise LoomfmuError(f"{where}={wanted}: not a range; {FORM}")
        low, high = (port.value(end, where) for end in (first, last))
        doubts = [_read_as(port, end, where) for end in (first, last) if units.is_plain(end)]
    if not low < high:
        order = "the lower end comes first" if low > high else "both ends are equal"
        raise LoomfmuError(f"{where}={wanted}: the range is empty; {order}")
    if not (low <= start <= high or any(math.isclose(start, end) for end in (low, high))):
        own, *limits = (units.show(each, port.display) for each in (start, float(low), float(high)))
        raise LoomfmuError(
            f"{where}={wanted}: the scene's own value, {own}, is outside {' to '.join(limits)};"
            f" widen the range, or start inside it with --set {key}={first}"
        )
    return low, high, tuple(filter(None, doubts))


def _read_as(port: Port, end: str, where: str) -> str:
    """Return the value that a number without unit is read as, or an empty text if it cannot be mistaken."""
    if port.display in ("1", port.unit):
        return ""
    value = float(end)
    read_as = f"is read as {units.show(value, port.unit)} = {units.show(value, port.display)}"
    return port.doubt(end, where) or f"{where} = {end} {read_as}"
