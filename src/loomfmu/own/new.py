"""A folder for a mechanism of your own: component, test, README and scene, ready to run."""

import keyword
import re
import secrets
import shutil
import sys
from collections.abc import Collection
from importlib.metadata import packages_distributions
from pathlib import Path

from .. import mechanism
from ..components import COMPONENTS
from ..errors import LoomfmuError
from ..files import ANY, cannot_write, check_target, put, write_file

NAME = re.compile("[A-Z][A-Za-z0-9]*")
TEMPLATE = Path(__file__).with_name("template")
# file names that Windows keeps for devices
DEVICES = (
    "con",
    "prn",
    "aux",
    "nul",
    *(f"{port}{place}" for port in ("com", "lpt") for place in range(1, 10)),
)
MODULES = ("loomfmu", "conftest")  # not among the installed packages where this one is run from a checkout
FILES = ("eccentric.py", "test_eccentric.py", "README.md", "eccentric.toml")


def new(name: str, of_scenes: Collection[str], directory: Path = Path()) -> list[Path]:
    """Write the folder of a mechanism called `name`, such as PickingCam, into a directory; returns the files.

    `of_scenes` are names that mean something else in a scene.
    Raises LoomfmuError for a name that cannot be used or a folder that exists; nothing has been written then.
    """
    own = _file_name(name, of_scenes)
    folder = directory / own
    if folder.exists() or folder.is_symlink():
        raise LoomfmuError(f"{folder} already exists; nothing was written")
    check_target(folder, ANY)
    partial = directory / f".{own}.{secrets.token_hex(4)}.partial"
    targets = {file: file.replace("eccentric", own) for file in FILES}
    try:
        for file, target in targets.items():
            text = (TEMPLATE / file).read_text(encoding="utf-8")
            text = text.replace("Eccentric", name).replace("eccentric", own)
            write_file(partial / target, text.encode(), ANY)
        put(partial, folder)
    except OSError as error:
        raise cannot_write(folder, error) from None
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    return [folder / target for target in targets.values()]


def _file_name(name: str, of_scenes: Collection[str]) -> str:
    """The name of a component's file, instance and folder: PickingCam -> picking_cam."""
    own = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()
    if not NAME.fullmatch(name) or keyword.iskeyword(name):
        raise LoomfmuError(
            f"{name!r} is not a class name such as PickingCam: letters and digits, a capital first"
        )
    reason = ""
    if name in COMPONENTS:
        reason = "it is one of loomfmu's components"
    elif name in mechanism.__all__:
        reason = "loomfmu.mechanism has this name"
    elif own in of_scenes:
        reason = f"scenes use the name {own} themselves"
    elif keyword.iskeyword(own):
        reason = f"{own} is a Python keyword"
    elif own in DEVICES:
        reason = f"Windows cannot have a file {own}.py"
    elif own.startswith("test_"):
        reason = f"pytest would take {own}.py for tests"
    elif own in (*MODULES, *sys.stdlib_module_names) or own in packages_distributions():
        reason = f"{own} is already a Python module"
    if reason:
        raise LoomfmuError(f"{name}: {reason}; choose another name")
    return own
