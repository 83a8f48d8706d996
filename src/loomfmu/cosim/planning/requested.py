"""The signals that a run is requested to give: those recorded and those that claims need, checked first."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from ... import units
from ...errors import LoomfmuError, suggestion
from ..claims.claims import UNITS, check, check_speed, check_values, names_parameter, signals_of
from ..importing.fmus import Port
from ..scenes.scene import Scene

ANGLES = frozenset(("window", "angles", "at_least"))  # arguments of claims that need a shaft
SHAFT_ANGLE = "shaft.angle"
# arguments of claims that people write in another unit than SI: that unit, and a usual value in SI
USUAL = {
    "window": ("deg", 1.5),
    "at_least": ("deg", 1.5),
    "clearance": ("mm", 0.03),
    "head_height": ("mm", 0.03),
}


def output_port(scene: Scene, signal: str, where: str) -> Port:
    """The output, or the input driven by the scene, that a signal names."""
    instance, _, variable = signal.partition(".")
    if instance not in scene.instances:
        hint = suggestion(instance, scene.instances)
        raise LoomfmuError(f"{where}: there is no instance {instance!r}{hint}")
    ports = scene.instances[instance].fmu.ports
    outputs = [port.name for port in ports.values() if port.causality == "output"]
    outputs += [drive.variable for drive in scene.drives if drive.instance == instance]
    if variable not in outputs:
        raise LoomfmuError(f"{where}: {instance} has no output {variable!r}{suggestion(variable, outputs)}")
    return ports[variable]


def checked_claims(scene: Scene) -> Scene:
    """The scene, with a note where a claim's number was probably meant in another unit.

    Refuses a claim that cannot be judged before the run, not after it.
    """
    doubts: list[str] = []
    for claim in scene.claims:
        kind = claim.get("kind")
        arguments = {key: value for key, value in claim.items() if key not in ("kind", "name")}
        check(kind, arguments)
        for angle in ANGLES.intersection(arguments):
            if "shaft" not in scene.instances:
                raise LoomfmuError(f"claim {kind!r}: {angle} is a shaft angle, and the scene has no shaft")
        for signal in signals_of(claim, scene.instances):
            output_port(scene, signal, f"claim {kind!r}")
        check_values(str(kind), arguments, lambda signal: output_port(scene, signal, "claim").unit)
        if names_parameter("bound", arguments.get("bound")):
            _check_parameter(scene, arguments["bound"], arguments["signal"])
        doubts += filter(None, _doubts(scene, f"claim {kind!r}", arguments))
    return replace(scene, notes=tuple(dict.fromkeys((*scene.notes, *doubts))))


def _doubts(scene: Scene, where: str, arguments: dict[str, Any]) -> Iterator[str]:
    """What is odd about the numbers of a claim that have no unit, or empty texts."""
    bound = arguments.get("bound")
    if "signal" in arguments and not names_parameter("bound", bound):
        signal = arguments["signal"]
        yield output_port(scene, signal, where).doubt(bound, f"{where} of {signal}: bound")
    for name in USUAL.keys() & arguments.keys():
        given, (display, usual) = arguments[name], USUAL[name]
        for quantity in given if isinstance(given, list | tuple) else [given]:
            said = quantity is not None and units.doubt(quantity, UNITS[name], display, usual)
            yield f"{where}: {name} = {quantity} {said}" if said else ""


def _check_parameter(scene: Scene, name: str, signal: str) -> None:
    """A parameter that bounds a signal is one of the scene, in the signal's unit."""
    instance, _, variable = name.partition(".")
    ports = scene.instances[instance].fmu.ports if instance in scene.instances else {}
    known = [f"{instance}.{port.name}" for port in ports.values() if port.causality == "parameter"]
    if name not in known:
        raise LoomfmuError(f"claim: bound = {name!r} is no parameter{suggestion(name, known)}")
    if variable not in scene.instances[instance].effective():
        raise LoomfmuError(f"claim: bound = {name!r} has no effect in this scene: {instance} does not use it")
    wanted, given = output_port(scene, signal, "claim").unit, ports[variable].unit
    if given != wanted:
        raise LoomfmuError(f"claim: bound {name} is in {given}, {signal} in {wanted}")
    check_speed(name, float(scene.instances[instance].effective()[variable]), wanted)


def judged_by(scene: Scene) -> list[str]:
    """The signals that the scene's claims need, and the rates of these."""
    return with_rates(scene, [s for claim in scene.claims for s in signals_of(claim, scene.instances)])


def shaft_angle(scene: Scene) -> list[str]:
    """The signal of the shaft's angle, along which everything is told; none in a scene without a shaft."""
    return [SHAFT_ANGLE] if "shaft" in scene.instances else []


def recorded(scene: Scene) -> list[str]:
    """What the scene records, what its claims need, and the rates of that."""
    driven = [f"{drive.instance}.{drive.variable}" for drive in scene.drives]
    wanted = with_rates(scene, [*shaft_angle(scene), *scene.record, *driven])
    return list(dict.fromkeys([*wanted, *judged_by(scene)]))


def with_rates(scene: Scene, wanted: Sequence[str]) -> list[str]:
    """Signals, each followed by its rate, if it has one that is an output, and so on."""
    names: dict[str, None] = {}
    for signal in wanted:
        while signal and signal not in names:
            names[signal] = None
            port = output_port(scene, signal, "record")
            rate = port.rate if port.causality == "output" else None
            signal = f"{signal.split('.')[0]}.{rate}" if rate else ""
    return list(names)
