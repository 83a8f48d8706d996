"""A scene as a run takes it: read, in the flavour of its FMUs, with claims that can be judged."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from ..errors import LoomfmuError, listed, path_of, shown, suggestion, within
from .claims.bounded import Bounded, check_speed
from .claims.claim import Claim
from .claims.claims import angles_in, doubts, place_of
from .importing.built import check_flavour
from .importing.process import AVAILABLE
from .planning.requested import Requested, output_port, parameter_of
from .scenes import scene as scenes
from .scenes.scene import Scene
from .scenes.wiring import left_out

MOST = 5  # names that a warning lists


def checked(scene: str | Path | Scene, overrides: dict[str, Any] | None, flavour: str) -> Scene:
    """A scene that is ready to be run. Raises LoomfmuError naming the file and what is wrong."""
    return requested(scene, overrides, flavour).scene


def requested(scene: str | Path | Scene, overrides: dict[str, Any] | None, flavour: str) -> Requested:
    """A scene that is ready to be run, and what is asked of it. Raises LoomfmuError as `checked`."""
    check_flavour(flavour)
    check_set(overrides)
    scene = scene if isinstance(scene, Scene) else path_of(scene, "scene")
    place = "" if isinstance(scene, Scene) else f"{scene}: "
    scene = in_flavour(read(scene, overrides), flavour)
    try:
        for name, instance in scene.instances.items():
            if not instance.fmu.built:  # one that is built waits until it is needed
                instance.fmu.check_platform(name)
        scene.check_step_timeout()
        return checked_claims(scene)
    except LoomfmuError as error:
        raise LoomfmuError(f"{place}{error}") from None


def drawn(scene: Scene) -> Scene:
    """A scene that also records what only drawings of its mechanisms need, of those that it records."""
    instances, record = dict(scene.instances), dict.fromkeys(scene.record)
    for name in dict.fromkeys(signal.partition(".")[0] for signal in scene.record):
        fmu = instances[name].fmu
        if fmu.component and fmu.component.drawn:
            instances[name] = replace(instances[name], fmu=fmu.with_outputs(fmu.component.drawn))
            record |= {f"{name}.{each}": None for each in fmu.component.drawn}
    return replace(scene, instances=instances, record=[*record])


def protected(scene: Scene) -> Scene:
    """A scene whose FMUs cannot end this process, for what must come to an end. Raises LoomfmuError."""
    if AVAILABLE and scene.unprotected:
        names = listed(scene.unprotected)
        raise LoomfmuError(f"{names} could end this process before all runs are done; set isolated = true")
    return scene


def read(scene: str | Path | Scene, overrides: dict[str, Any] | None) -> Scene:
    """A scene from its file or its system package, with other values if there are any."""
    if isinstance(scene, Scene):
        if not overrides:
            return scene
        if scene.package is None:
            made = scenes.parse(scene.text, scene.name, overrides, scene.directory)
            return replace(made, file=scene.file)
        scene = scene.package
    if Path(scene).suffix.lower() == ".ssp":
        from .ssp import read as ssp_read  # most scenes are not packages

        return ssp_read.load(scene, overrides)
    return scenes.load(scene, overrides)


def in_flavour(scene: Scene, flavour: str) -> Scene:
    """The scene with all FMUs that it does not bring itself of that flavour: they have the same variables.

    Where no native one is available it is a live one, and a note says so.
    """
    if scene.package is not None and flavour == "live":
        raise LoomfmuError(
            f"{scene.package}: a system package brings its own FMUs, so no flavour can be chosen"
        )
    instances = {
        name: replace(instance, fmu=instance.fmu.in_flavour(flavour))
        for name, instance in scene.instances.items()
    }
    if flavour == "live":
        return replace(scene, instances=instances)
    notes = dict.fromkeys((*scene.notes, *_fallbacks(scene)))  # a scene may come here twice
    return replace(scene, instances=instances, notes=tuple(notes))


def _fallbacks(scene: Scene) -> list[str]:
    """One line for each reason why FMUs of a scene are live ones."""
    found: dict[str, dict[str, None]] = {}
    for instance in scene.instances.values():
        if reason := instance.fmu.no_native:
            found.setdefault(reason, {})[instance.fmu.name] = None
    return [f"running live FMUs of {listed(names)}, not native ones: {why}" for why, names in found.items()]


def check_set(overrides: Any) -> None:
    """Refuse what does not name values by their keys."""
    if overrides is not None and not (
        isinstance(overrides, Mapping) and all(isinstance(key, str) for key in overrides)
    ):
        raise LoomfmuError(
            f'set = {shown(overrides)} is not a dictionary such as {{"shaft.speed": "685 rpm"}}'
        )


# ---- claims


def checked_claims(scene: Scene) -> Requested:
    """A scene with a note on each number of a claim that was probably meant in another unit.

    Refuses, before the run, a claim that could not be judged after it.
    """
    notes = [*scene.notes, *_unrecorded(scene)]
    requested = Requested(scene)
    wired = {".".join(wire.sink) for wire in scene.wires}
    known = {name: each.fmu.facts for name, each in scene.instances.items() if each.fmu.facts}
    for table, claim in zip(scene.claims, requested.claims, strict=True):
        where = place_of(table)
        for angle in angles_in(claim, table) if "shaft" not in scene.instances else ():
            raise LoomfmuError(f"{where}: {angle} is a shaft angle, but the scene has no shaft")
        for signal in claim.signals(requested):
            port = output_port(scene, signal, where)
            notes += [
                f"{where}: {signal} leaves out {source}, because {sink} is not wired;"
                f' set "{sink}" = "{source}" in [wires] and coupling = "iterated"'
                for sink, source in left_out(known, wired, signal).items()
            ]
            alike = isinstance(claim, Bounded) and port.unit == claim.unit_in(requested)
            if isinstance(claim, Bounded) and alike and not isinstance(claim.bound, str):
                notes.append(port.doubt(table["bound"], f"{where} of {signal}: bound"))
        check_bounds(requested, scene, [claim])
        notes += doubts(claim, table)
    requested.scene = replace(scene, notes=tuple(dict.fromkeys(note for note in notes if note)))
    return requested


def check_bounds(requested: Requested, scene: Scene, claims: Iterable[Claim]) -> None:
    """Refuse parameters that cannot bound the signal of a claim, or that rule it out."""
    for claim in claims:
        claim.check_parameters(partial(parameter_of, scene))
        if isinstance(claim, Bounded) and isinstance(claim.bound, str):
            with within(claim.place):
                _check_parameter(scene, claim.bound, claim.signal, claim.unit_in(requested))


def _unrecorded(scene: Scene) -> Iterator[str]:
    """A warning for each FMU that has outputs, but none that can be recorded."""
    for name, instance in scene.instances.items():
        fmu = instance.fmu
        if fmu.unsupported and not any(port.causality == "output" for port in fmu.ports.values()):
            listed = ", ".join([*fmu.unsupported[:MOST], *["..."] * (len(fmu.unsupported) > MOST)])
            yield f"{name}: nothing recorded; none of its outputs is a scalar number or a Boolean: {listed}"


def _check_parameter(scene: Scene, name: str, signal: str, wanted: str) -> None:
    """A parameter that bounds a signal is one of the scene, in the signal's unit."""
    instance, _, variable = name.partition(".")
    ports = scene.instances[instance].fmu.ports if instance in scene.instances else {}
    if variable not in ports or ports[variable].causality != "parameter":
        known = [f"{instance}.{port.name}" for port in ports.values() if port.causality == "parameter"]
        raise LoomfmuError(f"bound = {name!r} is not a parameter{suggestion(name, known)}")
    value = scene.instances[instance].effect(variable)
    if value is None:
        raise LoomfmuError(f"bound = {name!r} has no effect in this scene, as {instance} does not use it")
    given = ports[variable].unit
    if given != wanted:
        raise LoomfmuError(f"bound {name} is in {given}, but {signal} is in {wanted}")
    check_speed(name, float(value), wanted)
