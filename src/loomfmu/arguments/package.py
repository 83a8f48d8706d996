"""The arguments of the commands on what the package holds: FMUs, examples, mechanisms."""

from pathlib import Path
from typing import Any

from .shared import add_force, add_platform


def list_(commands: Any) -> None:
    """Arguments of `list`."""
    listing = commands.add_parser("list", help="list FMUs, machines, heads and example scenes")
    listing.add_argument(
        "name",
        nargs="?",
        metavar="NAME",
        help="describe this FMU, FILE.fmu, FILE.py[:CLASS], machine or rapier head",
    )


def new(commands: Any) -> None:
    """Arguments of `new`."""
    new = commands.add_parser("new", help="write a folder for a mechanism of your own, ready to run")
    new.add_argument("name", metavar="NAME", help="class name, such as PickingCam")
    new.add_argument(
        "--output",
        type=Path,
        default=Path(),
        metavar="DIR",
        help="where to put the folder; the current folder by default",
    )


def build(commands: Any) -> None:
    """Arguments of `build`."""
    build = commands.add_parser("build", help="build FMUs")
    build.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help="an FMU, or FILE.py[:CLASS] for one of your own; all FMUs by default",
    )
    build.add_argument(
        "--output",
        type=Path,
        metavar="DIR",
        help="build/fmus by default; build/native or build/native_fmi3 for native FMUs",
    )
    build.add_argument("--native", action="store_true", help="build native FMUs: in C, without Python")
    add_platform(build)
    build.add_argument(
        "--fmi", type=int, choices=(2, 3), default=2, help="FMI version of native FMUs; 2 by default"
    )
    add_force(build, "third-party FMUs in DIR")


def cache(commands: Any) -> None:
    """Arguments of `cache`."""
    cache = commands.add_parser("cache", help="show location and size of the cache of built FMUs")
    cache.add_argument("--clear", action="store_true", help="empty it; FMUs are built again when needed")


def init(commands: Any) -> None:
    """Arguments of `init`."""
    init = commands.add_parser("init", help="write an example scene and a sweep of it")
    init.add_argument(
        "directory",
        nargs="?",
        type=Path,
        default=Path(),
        metavar="DIR",
        help="folder to write to; the current one by default",
    )
    init.add_argument("--all", action="store_true", help="write every example scene")
