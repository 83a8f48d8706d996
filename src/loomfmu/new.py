"""A folder for a mechanism of one's own: component, test, README and scene, which run at once."""

import keyword
import re
import secrets
import shutil
import sys
from importlib.metadata import packages_distributions
from pathlib import Path

from .components import COMPONENTS
from .cosim.scenes.instances import KEYS, TAKEN
from .cosim.scenes.standard_loom import COMPONENT_OF
from .errors import LoomfmuError
from .files import ANY, cannot_write, check_target, write_file

NAME = re.compile("[A-Z][A-Za-z0-9]*")
TEMPLATE = Path(__file__).with_name("template")
FILES = ("eccentric.py", "test_eccentric.py", "README.md", "eccentric.toml")


def new(name: str, directory: Path = Path()) -> list[Path]:
    """Write the folder of a mechanism called `name`, such as PickingCam, into a directory; the files written.

    Raises LoomfmuError for a name that cannot be used or a folder that exists; nothing has been written then.
    """
    own = _file_name(name)
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
        partial.rename(folder)
    except OSError as error:
        raise cannot_write(folder, error) from None
    finally:
        shutil.rmtree(partial, ignore_errors=True)
    return [folder / target for target in targets.values()]


def _file_name(name: str) -> str:
    """The name of a component's file, instance and folder: PickingCam -> picking_cam."""
    own = re.sub(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", "_", name).lower()
    if not NAME.fullmatch(name) or keyword.iskeyword(name):
        raise LoomfmuError(
            f"{name!r} is not a class name such as PickingCam: letters and digits, a capital first"
        )
    if name in COMPONENTS:
        raise LoomfmuError(f"{name} is the name of one of loomfmu's components: choose another")
    if own in (*KEYS, *TAKEN, *COMPONENT_OF):
        raise LoomfmuError(f"{name}: scenes use the name {own} themselves: choose another")
    if own in sys.stdlib_module_names or own in packages_distributions():
        raise LoomfmuError(f"{name}: {own} is a Python module already: choose another")
    return own
