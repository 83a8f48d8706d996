"""The text of a scene with other values in it, for any folder: comments and order stay."""

import os
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from .. import units
from ..cosim.scenes import scene as scenes
from ..cosim.scenes.instance_tables import overridden
from ..cosim.scenes.scene import Scene
from ..cosim.scenes.settings import replaced
from ..errors import LoomfmuError
from ..extras import need
from ..files import Kind, check_target, digest, write_file
from ..loom import weave
from ..machines import TAKERS
from ..own import load

FILE_KEYS = {"fmu", "component", "weave", "kind", "measured"}  # of a table that may name a file


MARK = "# written by loomfmu; it is replaced only as long as nobody edits it: "  # and a digest of the rest


def unedited(path: Path) -> bool:
    """Return whether a file is a scene as it was written here."""
    first, _newline, rest = path.read_bytes().partition(b"\n")
    return first.decode(errors="replace") == MARK + digest(rest.decode(errors="replace"))


KIND = Kind("a scene that loomfmu wrote and nobody edited", unedited)


def quantity(value: float, unit: str, display: str) -> str | float:
    """A value in SI as a scene states it: in the display unit where that gives the same bits, else in SI.

    >>> quantity(0.0003, "m", "mm"), quantity(0.5, "1", "1")
    ('0.3 mm', 0.5)
    """
    if unit == "1" and display == "1":
        return float(value)
    shown = value / units.unit(display).factor
    for text in (f"{shown:.12g} {display}", f"{shown!r} {display}"):
        if units.parse(text, unit) == value:
            return text
    return f"{value!r} {unit}" if unit != "1" else float(value)


def check(scene: Scene) -> Path:
    """The file that a scene was read from. Raises LoomfmuError for one that cannot be written again."""
    _tomlkit()
    if scene.file is None:
        raise LoomfmuError(
            f"{scene.name}: only scenes read from a TOML file can be written with other values"
        )
    return scene.file


def write(
    scene: Scene, values: Mapping[str, Any], path: Path, overwrite: bool = False, description: str = ""
) -> Path:
    """Write a scene's text with these values, those that it was read with among them, and return its path.

    Raises LoomfmuError as `text_for`, and for a file that may not be written.
    """
    inputs = [check(scene)]
    check_target(path, KIND, inputs, overwrite)
    text = text_for(scene, values, path, description)
    return write_file(path, f"{MARK}{digest(text)}\n{text}".encode(), KIND, inputs, overwrite)


def text_for(scene: Scene, values: Mapping[str, Any], path: Path, description: str = "") -> str:
    """A scene's text with these values, those that it was read with among them, as it stands at a path.

    It is read again first: it must be the same scene with the same values. The files that it names are then
    named as they are found from that path. A `description` replaces the scene's own, which may not hold with
    other values.

    Raises:
        LoomfmuError: not from a TOML file, values that the scene cannot be written with, or no
            `loomfmu[study]`
    """
    check(scene)
    every = {**scene.overrides, **values}
    expected = scenes.parse(scene.text, scene.name, every, scene.directory)
    text = rewritten(scene, every, description)
    again = scenes.parse(text, path.stem, None, scene.directory)
    for name, each in expected.instances.items():
        if again.instances[name].effective() != each.effective():
            raise LoomfmuError(f"{path}: the values of {name} cannot be written to this scene")
    return _moved(text, scene.directory, path.parent)


def _moved(text: str, directory: Path, folder: Path) -> str:
    """Return a scene's text whose paths from a directory are written as paths from a folder."""
    document = _tomlkit().parse(text)
    for table in (*document.values(), *document.get("claims", ()), *document.get("tolerances", {}).values()):
        for key in FILE_KEYS & set(table if isinstance(table, dict) else ()):
            if (file := _file(key, table[key])) and not Path(file).is_absolute():
                table[key] = _path(directory / file, folder) + table[key][len(file) :]
    return str(document.as_string())


def _file(key: str, given: Any) -> str:
    """Return the file that a value of a table names, or an empty text."""
    if key in ("component", "kind"):
        return load.split(given)[0] if load.is_file(given) else ""
    return given if key in ("fmu", "measured") or weave.is_wif(given) else ""


def _path(file: Path, folder: Path) -> str:
    """Return the path of a file from a folder, or the whole path if there is none, as between two drives."""
    try:
        return Path(os.path.relpath(file.resolve(), folder.resolve())).as_posix()
    except ValueError:
        return file.resolve().as_posix()


def rewritten(scene: Scene, values: Mapping[str, Any], description: str = "") -> str:
    """The scene's text with values as `--set` takes them, and with another description if there is one."""
    tomlkit = _tomlkit()
    document = tomlkit.parse(scene.text)
    if description:
        document["description"] = tomlkit.string(description, multiline="\n" in description)
    for key in replaced(values):
        document.pop(key, None)
    for key, value in values.items():
        for table, variable, written in _places(scene, key, value):
            owner = document.setdefault(table, tomlkit.table()) if table else document
            owner[variable] = written
    return str(document.as_string())


def _places(scene: Scene, key: str, value: Any) -> list[tuple[str, str, Any]]:
    """Return the places of a `--set` key in a scene's text: tables, variables and their new values."""
    owner, _, variable = key.rpartition(".")
    if (variable in TAKERS and owner in ("", "loom")) or owner == "loom":
        return [("loom", variable, value)]
    found = overridden(scene.instances, key)
    if not isinstance(value, units.Si):  # as somebody wrote it
        return [(name, each, value if name else _number(value)) for name, each in found]
    ports = [scene.instances[name].fmu.port(each, name) for name, each in found]
    return [
        (name, each, quantity(float(value), port.unit, port.display))
        for (name, each), port in zip(found, ports, strict=True)
    ]


def _number(given: Any) -> Any:
    """A number for a text such as "90" of a command line; what is not one stays as it is."""
    for kind in (int, float) if isinstance(given, str) else ():
        with suppress(ValueError):
            return kind(given)
    return given


def _tomlkit() -> Any:
    need("writing a scene", "study")
    import tomlkit

    return tomlkit
