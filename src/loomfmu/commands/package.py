"""The commands on what the package holds, with their arguments: FMUs, examples, mechanisms, the cache."""

import argparse
import shlex
import shutil
from pathlib import Path

from ..display.printed import complain, say
from ..errors import LoomfmuError
from .shared import PLATFORM, argument, command, flag, force, platforms


@command(
    argument(
        "names", "NAME", "an FMU, or FILE.py[:CLASS] for one of your own; all FMUs by default", nargs="*"
    ),
    argument(
        "--output",
        "DIR",
        "build/fmus by default; build/native or build/native_fmi3 for native FMUs",
        type=Path,
    ),
    flag("--native", "build native FMUs: in C, without Python"),
    PLATFORM,
    argument("--fmi", None, "FMI version of native FMUs; 2 by default", type=int, choices=(2, 3), default=2),
    force("third-party FMUs in DIR"),
)
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
        count = f"{len(built)} native FMU{'s' * (len(built) != 1)}"
        complain(f"building {count} for {', '.join(built_for)}; the first time takes about a minute for each")
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


@command(
    argument(
        "name", "NAME", "describe this FMU, FILE.fmu, FILE.py[:CLASS], machine or rapier head", nargs="?"
    )
)
def list_(options: argparse.Namespace) -> int:
    """List FMUs, machines, heads and example scenes."""
    from .. import catalogue

    width = shutil.get_terminal_size().columns
    lines = catalogue.details(options.name, width) if options.name else catalogue.overview()
    say(*(part for line in lines for part in line.split("\n")))
    return 0


@command(
    argument(
        "directory",
        "DIR",
        "folder to write to; the current one by default",
        nargs="?",
        type=Path,
        default=Path(),
    ),
    flag("--all", "write every example scene"),
)
def init(options: argparse.Namespace) -> int:
    """Write an example scene and a sweep of it."""
    from .. import catalogue
    from ..extras import install, installed

    written = catalogue.start(options.directory, everything=options.all)
    say(*written, "")
    if missing := [extra for extra in ("sweep", "plot") if not installed(extra)]:
        say(f"sweeps and their maps also need: {install(*missing)}")
    first = options.directory / catalogue.STARTERS[0]
    say(f"next: {shlex.join(['loomfmu', 'run', str(first)])}")
    return 0


@command(
    argument("name", "NAME", "class name, such as PickingCam"),
    argument(
        "--output", "DIR", "where to put the folder; the current folder by default", type=Path, default=Path()
    ),
)
def new(options: argparse.Namespace) -> int:
    """Write a folder for a mechanism of your own, ready to run."""
    from ..cosim.scenes.instances import TAKEN
    from ..cosim.scenes.settings import KEYS
    from ..loom.standard_loom import COMPONENT_OF
    from ..own.new import new as write

    written = write(options.name, (*KEYS, *TAKEN, *COMPONENT_OF), options.output)
    say(*written, "")
    say(f"next: cd {shlex.quote(str(written[0].parent))} && loomfmu run {written[-1].name}")
    return 0


@command(flag("--clear", "empty it; FMUs are built again when needed"))
def cache(options: argparse.Namespace) -> int:
    """Show location and size of the cache of built FMUs."""
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
