"""A scene as a run takes it: read, in the flavour of its FMUs, with claims that can be judged."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from ..errors import LoomfmuError, listed, path_of, shown
from .importing.built import check_flavour
from .importing.process import AVAILABLE
from .planning.requested import Requested, checked_claims
from .scenes import scene as scenes
from .scenes.scene import Scene


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
