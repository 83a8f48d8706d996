"""The head of the files of sweeps and searches: the scene, its fixed values and its variables."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from ..cosim.importing.built import Flavour, check_flavour
from ..cosim.reading import checked_claims
from ..cosim.reading import read as read_scene
from ..cosim.scenes.notes import check_effect
from ..cosim.scenes.scene import Scene
from ..cosim.scenes.settings import text as text_in
from ..cosim.scenes.settings import toml
from ..errors import LoomfmuError, suggestion, within
from ..files import text_of
from .axes import Axis, flattened
from .varied import Varied, varied

Parsed = TypeVar("Parsed")

HEAD = ("title", "scene", "flavour", "set")  # keys of every such file


@dataclass(frozen=True)
class Header:
    """The scene that a file names, read with the values that stay; `path` is that of the scene.

    `name` and `text` are the file's own.
    """

    title: str
    name: str
    text: str
    path: Path
    scene: Scene
    flavour: Flavour
    fixed: dict[str, Any]


def read(
    path: Path, what: str, keys: Sequence[str], parse: Callable[[Header, dict[str, Any]], Parsed]
) -> Parsed:
    """Read a file; `keys` are all that it may have, `what` names its kind, and `parse` reads the rest.

    Raises LoomfmuError naming the file and what is wrong, before anything runs.
    """
    text = text_of(path)
    with within(path):
        tables = toml(text, what)
        for key in tables:
            if key not in keys:
                raise LoomfmuError(f"{key} is unknown{suggestion(key, keys)}")
        return parse(_header(text, tables, path, what), tables)


def _header(text: str, tables: dict[str, Any], path: Path, what: str) -> Header:
    """The head of a file."""
    if not isinstance(tables.get("scene"), str):
        raise LoomfmuError(f'a {what} must name its scene: scene = "loom.toml", relative to the {what} file')
    flavour = tables.get("flavour", "native")
    check_flavour(flavour)
    scene_path = _path_named(path, tables["scene"])
    fixed = flattened(tables.get("set", {}), "set")
    scene = checked_claims(read_scene(scene_path, fixed)).scene
    title = text_in(tables, "title", path.stem)
    return Header(title, path.stem, text, scene_path, scene, flavour, fixed)


def _path_named(path: Path, name: str) -> Path:
    """Return the path of a file that another one names; relative to the current folder if both are."""
    place = path.parent / name
    return place.resolve() if place.is_absolute() else Path(os.path.relpath(place.resolve()))


def variables(head: Header, tables: Mapping[str, Mapping[str, Any]]) -> dict[str, Varied]:
    """Return the variables, by table and key as in "grid.shaft.speed". None sets what another one sets."""
    taken = {target: "set" for key in head.fixed for target in varied(head.scene, key).targets}
    found: dict[str, Varied] = {}
    for where, keys in tables.items():
        for key in keys:
            with within(where):
                each = found[f"{where}.{key}"] = varied(head.scene, key)
            for target in each.targets:
                if target in taken:
                    raise LoomfmuError(f"{where}.{key} sets {target}, which {taken[target]} already sets")
                taken[target] = f"{where}.{key}"
    for where, each in found.items():
        check_effect(head.scene.instances, each.targets, taken, f"{where.partition('.')[0]}: ")
    return found


def check_by_scene(head: Header, axes: Sequence[Axis]) -> None:
    """Let the scene judge, one by one, the values that nothing else can."""
    for axis in axes:
        if axis.varied.needs_scene:
            values = [axis.values.min(), axis.values.max()] if axis.sampled else axis.values
            for value in np.asarray(values).tolist():
                setting = dict.fromkeys(axis.varied.targets, axis.varied.setting(value))
                read_scene(head.path, head.fixed | setting)
