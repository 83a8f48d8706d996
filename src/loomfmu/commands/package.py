"""The commands on what the package holds, with their arguments: FMUs, examples, mechanisms, the cache."""

import argparse
import shlex
import shutil
from pathlib import Path
from typing import Any

from ..display.printed import say
from ..errors import LoomfmuError
from .shared import add_force, add_platform, platforms


def add_build(commands: Any) -> None:
    """Add `build` and its arguments."""
    command = commands.add_parser("build", help="build FMUs")
    command.add_argument(
        "names",
        nargs="*",
        metavar="NAME",
        help="an FMU, or FILE.py[:CLASS] for one of your own; all FMUs by default",
    )
    command.add_argument(
        "--output",
        type=Path,
        metavar="DIR",
        help="build/fmus by default; build/native or build/native_fmi3 for native FMUs",
    )
    command.add_argument("--native", action="store_true", help="build native FMUs: in C, without Python")
    add_platform(command)
    command.add_argument(
        "--fmi", type=int, choices=(2, 3), default=2, help="FMI version of native FMUs; 2 by default"
    )
    add_force(command, "third-party FMUs in DIR")
    command.set_defaults(action=build)


def build(options: argparse.Namespace) -> int:
    """Build FMUs."""
    from concurrent.futures import ThreadPoolExecutor
    from functools import partial

    from .. import catalogue
    from ..fmi import live_fmu
    from ..fmi.native.native_fmu import build_native

    built = catalogue.components(options.names)
    if not options.native and (options.platform or options.fmi != 2):
        raise LoomfmuError("--platform and --fmi are for native FMUs: add --native")
    built_for = platforms(options)
    if options.native:
        output = options.output or Path("build/native" if options.fmi == 2 else "build/native_fmi3")
        write = partial(
            build_native, directory=output, platforms=built_for, fmi=options.fmi, overwrite=options.force
        )
    else:
        write = partial(
            live_fmu.build, directory=options.output or Path("build/fmus"), overwrite=options.force
        )
    with ThreadPoolExecutor() as pool:  # compilers run side by side
        for path in pool.map(write, built):
            say(path)
    return 0


def add_list(commands: Any) -> None:
    """Add `list` and its arguments."""
    command = commands.add_parser("list", help="list FMUs, machines, heads and example scenes")
    command.add_argument(
        "name",
        nargs="?",
        metavar="NAME",
        help="describe this FMU, FILE.fmu, FILE.py[:CLASS], machine or rapier head",
    )
    command.set_defaults(action=list_)


def list_(options: argparse.Namespace) -> int:
    """List FMUs, machines, heads and examples, or describe one."""
    from .. import catalogue

    width = shutil.get_terminal_size().columns
    lines = catalogue.details(options.name, width) if options.name else catalogue.overview()
    say(*(part for line in lines for part in line.split("\n")))
    return 0


def add_init(commands: Any) -> None:
    """Add `init` and its arguments."""
    command = commands.add_parser("init", help="write an example scene and a sweep of it")
    command.add_argument(
        "directory",
        nargs="?",
        type=Path,
        default=Path(),
        metavar="DIR",
        help="folder to write to; the current one by default",
    )
    command.add_argument("--all", action="store_true", help="write every example scene")
    command.set_defaults(action=init)


def init(options: argparse.Namespace) -> int:
    """Write the examples."""
    from .. import catalogue
    from ..extras import install, installed

    written = catalogue.start(options.directory, everything=options.all)
    say(*written, "")
    if missing := [extra for extra in ("sweep", "plot") if not installed(extra)]:
        say(f"sweeps and their maps also need: {install(*missing)}")
    first = options.directory / catalogue.STARTERS[0]
    say(f"next: {shlex.join(['loomfmu', 'run', str(first)])}")
    return 0


def add_new(commands: Any) -> None:
    """Add `new` and its arguments."""
    command = commands.add_parser("new", help="write a folder for a mechanism of your own, ready to run")
    command.add_argument("name", metavar="NAME", help="class name, such as PickingCam")
    command.add_argument(
        "--output",
        type=Path,
        default=Path(),
        metavar="DIR",
        help="where to put the folder; the current folder by default",
    )
    command.set_defaults(action=new)


def new(options: argparse.Namespace) -> int:
    """Write a folder for a mechanism of the user's own."""
    from ..cosim.scenes.instances import TAKEN
    from ..cosim.scenes.settings import KEYS
    from ..loom.standard_loom import COMPONENT_OF
    from ..own.new import new as write

    written = write(options.name, (*KEYS, *TAKEN, *COMPONENT_OF), options.output)
    say(*written, "")
    say(f"next: cd {shlex.quote(str(written[0].parent))} && loomfmu run {written[-1].name}")
    return 0


def add_cache(commands: Any) -> None:
    """Add `cache` and its arguments."""
    command = commands.add_parser("cache", help="show location and size of the cache of built FMUs")
    command.add_argument("--clear", action="store_true", help="empty it; FMUs are built again when needed")
    command.set_defaults(action=cache)


def cache(options: argparse.Namespace) -> int:
    """Show the cache of built FMUs, or empty it."""
    from ..cache.directory import cache_directory
    from ..cache.entries import clear, contents

    if options.clear:
        clear()
    found = contents()
    size, entries = sum(each.size for each in found), sum(each.entries for each in found)
    say(f"{cache_directory()}: {size / 1e6:.1f} MB, {entries} entries")
    for each in found:
        say(f"  {each.kind:8}  {each.size / 1e6:8.1f} MB  {each.entries:6} entries")
    return 0
