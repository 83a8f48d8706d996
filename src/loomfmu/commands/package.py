"""The commands on what the package brings: `build`, `list`, `init`, `new`, `cache`."""

import argparse
import shlex
import shutil
from pathlib import Path

from ..display.printed import say
from ..errors import LoomfmuError
from .options import platforms


def build(options: argparse.Namespace) -> int:
    """Build FMUs."""
    from concurrent.futures import ThreadPoolExecutor
    from functools import partial

    from .. import catalogue
    from ..fmi import builder
    from ..fmi.native.builder import build_native

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
            builder.build, directory=options.output or Path("build/fmus"), overwrite=options.force
        )
    with ThreadPoolExecutor() as pool:  # compilers run side by side
        for path in pool.map(write, built):
            say(path)
    return 0


def list_(options: argparse.Namespace) -> int:
    """List FMUs, machines, heads and examples, or describe one."""
    from .. import catalogue

    width = shutil.get_terminal_size().columns
    lines = catalogue.details(options.name, width) if options.name else catalogue.overview()
    say(*(part for line in lines for part in line.split("\n")))
    return 0


def init(options: argparse.Namespace) -> int:
    """Write the examples."""
    from .. import catalogue
    from ..extras import install, installed

    written = catalogue.start(options.directory, everything=options.all)
    say(*written, "")
    if not (installed("sweep") and installed("plot")):
        say(f"sweeps and their maps need two extras: {install('sweep', 'plot')}")
    first = options.directory / catalogue.STARTERS[0]
    say(f"next: {shlex.join(['loomfmu', 'run', str(first)])}")
    return 0


def new(options: argparse.Namespace) -> int:
    """Write a folder for a mechanism of the user's own."""
    from ..cosim.scenes.keys import KEYS, TAKEN
    from ..loom.standard_loom import COMPONENT_OF
    from ..own.new import new as write

    written = write(options.name, (*KEYS, *TAKEN, *COMPONENT_OF), options.output)
    say(*written, "")
    say(f"next: cd {shlex.quote(str(written[0].parent))} && loomfmu run {written[-1].name}")
    return 0


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
