"""The files that a scene is read from."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .keys import toml
from .scene import Scene


def files_of(scene: Scene) -> list[Path]:
    """The file of a scene, and what it names: FMUs, weaves, every text that is the name of a file."""
    found = [path for path in (scene.file, scene.package) if path is not None]
    found += [instance.fmu.path for instance in scene.instances.values() if not instance.fmu.built]
    found += [scene.directory / name for name in scene.texts]
    tables = {} if scene.package is not None else toml(scene.text)
    for text in _texts([tables, scene.overrides]):
        with contextlib.suppress(OSError, ValueError):  # most texts cannot be a file's name
            if (scene.directory / text).is_file():
                found.append(scene.directory / text)
    return found


def _texts(value: Any) -> Iterator[str]:
    """All texts in tables and lists."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for each in value.values() if isinstance(value, dict) else value:
            yield from _texts(each)
