"""The provenance of a run in its trace: enough to see what was run, and to run it again."""

import hashlib
import json
import os
import shlex
from functools import cache
from pathlib import Path
from typing import Any

from ..commit import commit
from ..fmi.native.libraries import library_of
from .importing.fmus import Fmu
from .importing.ports import Value
from .master import steppers
from .planning.plan import Plan
from .scenes.headings import heading
from .scenes.instances import Instance
from .scenes.scene import Scene
from .standard import standard


def attributes(plan: Plan, flavour: str, folder: Path) -> dict[str, str | float]:
    """The attributes of the root of a trace in a folder.

    `heading` is made of the values of the run, `title` is the scene's own. `files` are the texts of the files
    that the scene names, `set` the values that differ from the scene, as `--set` takes them; `command`
    repeats the run. `duration` and `step` are in s. `commit` is absent where it is not known.
    """
    scene = plan.scene
    fmus = _fmus(plan.pruned.scene)
    return {
        "title": scene.title,
        "heading": heading(scene),
        "scene": scene.text,
        "scene_file": scene_file(scene, folder),
        **({"files": json.dumps(scene.texts)} if scene.texts else {}),
        **({"package_sha256": scene.package_sha256} if scene.package else {}),
        "wires": json.dumps(plan.wires),
        "set": json.dumps(texts(scene.overrides)),
        **({} if scene.package else {"flavour": _flavour(scene, flavour)}),
        **_command(scene, _flavour(scene, flavour)),
        **(
            {"revolutions": scene.periods, "steps_per_revolution": scene.steps_per_period}
            if scene.step is None
            else {"duration": scene.periods, "step": scene.step}
        ),
        **({"commit": commit()} if commit() else {}),
        **({} if scene.accuracy is None else {"accuracy": scene.accuracy}),
        **({"notes": "\n".join(scene.notes)} if scene.notes else {}),
        **{f"fmu_{name}_version": fmu.version for name, fmu in sorted(fmus.items())},
        **{f"fmu_{name}_sha256": fmu.sha256 for name, fmu in sorted(fmus.items())},
        **(_hash(steppers.SOURCE) if _flavour(scene, flavour) == "native" else {}),
        **(_hash(standard().RULES) if scene.claims else {}),
    }


@cache
def _hash(source: Path) -> dict[str, str]:
    """The SHA-256 of the library of a C file that a run uses, if there is one."""
    library = library_of(source)
    return {f"{source.stem}_sha256": hashlib.sha256(library.read_bytes()).hexdigest()} if library else {}


def scene_file(scene: Scene, folder: Path) -> str:
    """Return the path of a scene's file or package from a folder; empty if it was read from neither."""
    source = scene.package or scene.file
    if source is None:
        return ""
    try:
        return Path(os.path.relpath(source.resolve(), folder.resolve())).as_posix()
    except ValueError:  # Windows: on another drive
        return source.resolve().as_posix()


def groups(plan: Plan) -> dict[str, dict[str, Any]]:
    """The attributes of each instance's group: its FMU, its start values in SI, their units and meanings."""
    instances = plan.scene.instances
    return {
        name: _described(instances[name], values) | values for name, values in plan.effective.groups().items()
    }


def _described(instance: Instance, values: dict[str, Value]) -> dict[str, str]:
    ports = {name: instance.fmu.ports[name] for name in values}
    units = {name: port.unit for name, port in ports.items() if port.kind == "Real" and port.has_unit}
    meanings = {name: meaning for name, port in ports.items() if (meaning := port.meaning(values[name]))}
    return {
        "fmu": instance.fmu.name,
        **instance.published,
        "parameter_units": json.dumps(units),
        "parameter_meanings": json.dumps(meanings),
    }


def _flavour(scene: Scene, wanted: str) -> str:
    """The flavour of the FMUs that were built for a scene, which may be another one than was wanted."""
    built = {instance.fmu.flavour for instance in scene.instances.values() if instance.fmu.built}
    return wanted if wanted in built or not built else built.pop()


def _command(scene: Scene, flavour: str) -> dict[str, str]:
    """The command that repeats the run, if its scene was read from a file."""
    source = scene.package or scene.file
    if source is None:
        return {}
    here = Path.cwd()
    words = ["loomfmu", "run", str(source.relative_to(here) if source.is_relative_to(here) else source)]
    for key, text in texts(scene.overrides).items():
        words += ["--set", f"{key}={text}"]
    return {"command": shlex.join([*words, *(["--live"] if flavour == "live" else [])])}


def texts(overrides: dict[str, Any]) -> dict[str, str]:
    """Values that were set, as texts that the command takes, too."""
    return {
        key: value if isinstance(value, str) else json.dumps(value, default=_plain)
        for key, value in overrides.items()
    }


def _plain(value: Any) -> Any:
    """A NumPy number as a Python one."""
    return value.item()


def _fmus(scene: Scene) -> dict[str, Fmu]:
    """The FMUs of a scene by name; if two different ones share a name, the instance's is added."""
    found: dict[str, Fmu] = {}
    for name, instance in scene.instances.items():
        fmu = instance.fmu
        same = found.setdefault(fmu.name, fmu)
        if same.sha256 != fmu.sha256:
            found[f"{fmu.name}_{name}"] = fmu
    return found
