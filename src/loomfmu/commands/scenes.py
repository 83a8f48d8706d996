"""The commands that take a scene, with their arguments: `run`, `page`, `export`."""

import argparse
import shlex
import shutil
import sys
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from ..display.printed import complain, say, warn
from ..errors import LoomfmuError
from .shared import (
    PLATFORM,
    PROVE,
    SCENE,
    SCENE_FILE,
    SET,
    argument,
    command,
    flag,
    force,
    one_of,
    pairs,
    platforms,
    print_unproven,
    print_verdicts,
    proofs_of,
    revolutions,
    vary,
)
from .status import BEGUN, status_of

if TYPE_CHECKING:
    from ..cosim.results import Result
    from ..traces import Trace


@command(
    SCENE,
    SET,
    argument(
        "--output",
        "FILE.h5",
        "trace file; results/SCENE.h5 by default, with the values of --set results/SCENE_VALUES.h5",
    ),
    one_of(
        flag("--live", "use live FMUs (Python) instead of native ones (compiled)"),
        flag("--native", argparse.SUPPRESS),  # which it does anyway
    ),
    flag("--report", "also write a page to look at, beside the trace"),
    PROVE,
    flag("--explain", "report skipped FMUs, outputs and steps"),
    force("FILE.h5 even if it is not a trace"),
)
def run(options: argparse.Namespace) -> int:
    """Simulate a scene, record a trace and check the claims."""
    from ..cosim.master.guards import supervised
    from ..cosim.reading import checked, drawn

    if options.report:
        from .. import report

        report.check()  # before the run, not after it
    options.scene = checked(options.scene, pairs(options.overrides), "live" if options.live else "native")
    if options.report:
        options.scene = drawn(options.scene)
    if unprotected := options.scene.unprotected:
        return supervised(lambda: status_of(lambda: _run_here(options), options), unprotected)
    return _run_here(options)


def _run_here(options: argparse.Namespace) -> int:
    """Run a scene that was read, in this process, and print what came of it."""
    from ..cosim.run import run as run_scene

    proofs = proofs_of(options.scene, options.prove)
    result = run_scene(
        options.scene,
        remarks=None if proofs is None else proofs.remarks,
        output=options.output,
        progress=True,
        flavour="live" if options.live else "native",
        overwrite=options.force,
    )
    # before anything is printed: the reader of our output may have had enough
    page = _page_of(result.trace, result.path, options.force) if options.report else None
    warn(result.warnings)
    _print_title(result)
    if result.chosen:
        say(result.chosen)
    if options.explain:
        heading = ["skipped:"] * (len(result.skipped) > 1)  # the last line counts what ran
        say(*heading, *(f"  {line}" for line in result.skipped))
    print_verdicts(result.claims)
    print_unproven(proofs)
    scene = result.scene
    if scene.description and not scene.overrides:  # it is about the values that the scene has
        say(*scene.description.splitlines(), "")
    _print_pace(result)
    if result.replaced:
        say(f"replaced: the trace of this name written at {result.replaced}")
    _print_trace(str(result.path))
    if page:
        say(f"report: {page}")
    return 0 if result.holds else 1


def _print_title(result: "Result") -> None:
    """Print the heading of a run and how far it went."""
    scene = result.scene
    try:
        heading, origin = result.trace.heading, result.trace.origin
        turned = result.trace.turned_otherwise(scene.periods)
    except LoomfmuError:  # the run is whole, whatever has become of its file
        heading, origin, turned = scene.title, "another run has replaced its trace meanwhile", ""
    if result.ended:
        say(f"{heading}: ended by {result.ended}, {result.steps} steps")
    elif scene.step is None:
        count = f"{scene.periods:g} nominal" if turned else f"{scene.periods:g}"
        parts = revolutions(count), turned, f"{result.steps} steps"
        say(f"{heading}: {', '.join(filter(None, parts))}")
    else:
        say(f"{heading}: {scene.periods:g} s in {scene.steps} steps of {scene.step:g} s")
    say(origin)


def _print_trace(path: str) -> None:
    """Print the path of the trace and the command that summarises it."""
    command = "loomfmu"
    if Path(sys.argv[0]).name == command and shutil.which(command) != shutil.which(sys.argv[0]):
        command = sys.argv[0]  # it is not on the PATH, or another one is
    summary = [command, "show", *(["--"] if path.startswith("-") else []), path]
    say(f"trace: {path}    summary: {shlex.join(summary)}")


def _page_of(trace: "Trace", path: Path, overwrite: bool) -> Path:
    from .. import report

    return report.write([trace], path.with_suffix(".html"), overwrite)


def _print_pace(result: "Result") -> None:
    """Print the time of a step, the flavour of the FMUs and the duration of the command so far."""
    flavours = {each.fmu.flavour for each in result.scene.instances.values()} - {""}
    pace = f"{1e6 * result.seconds / result.steps:.3g} us each" if result.steps else "none"
    kind = f"{' and '.join(sorted(flavours, reverse=True))} FMUs".lstrip()
    say(f"{result.steps} steps with {kind}, {pace}; {perf_counter() - BEGUN:.2f} s in total")


@command(
    SCENE_FILE,
    one_of(
        argument(
            "--fmu",
            "FILE.fmu",
            "write one native FMU: all mechanisms wired inside, without delay between them",
            type=Path,
        ),
        argument("--ssp", "FILE.ssp", "write a system package: one FMU for each mechanism", type=Path),
        required=True,
    ),
    SET,
    argument("--fmi", None, "FMI version of the FMUs; 2 by default", type=int, choices=(2, 3)),
    argument(
        "--flavour",
        None,
        "kind of FMUs in FILE.ssp; native by default if they can be built",
        choices=("live", "native"),
    ),
    flag(
        "--connectors",
        "give the system in FILE.ssp connectors, as fmucontainer needs; libcosim and ecos reject them",
    ),
    PLATFORM,
    force("the file even if loomfmu did not write it"),
)
def export(options: argparse.Namespace) -> int:
    """Write a scene as one FMU, or as a system package (SSP), for other tools."""
    from ..cosim import whole
    from ..cosim.scenes import scene
    from ..cosim.ssp import export as ssp

    if options.fmu and options.flavour:
        raise LoomfmuError("--flavour is for --ssp: one FMU of a whole scene is always native")
    if options.fmu and options.connectors:
        raise LoomfmuError("--connectors is for --ssp: one FMU of a whole scene has variables instead")
    built_for = platforms(options)
    loaded = scene.load(options.scene, pairs(options.overrides))
    if options.flavour != "live" and sys.stderr.isatty():
        complain(f"building in C for {', '.join(built_for)}; the first time takes some minutes")
    if options.fmu:
        warnings = whole.export(loaded, options.fmu, built_for, options.fmi or 2, options.force)
    else:
        flavour, fmi = options.flavour, options.fmi or 2
        warnings = ssp.export(loaded, options.ssp, flavour, built_for, options.force, fmi, options.connectors)
    warn(warnings)
    say(f"written: {options.fmu or options.ssp}")
    return 0


@command(
    SCENE_FILE,
    vary(
        "what the page has a slider for, such as shaft.speed=400rpm..800rpm (repeatable); without a range"
        " 20 %% around the scene's value, or its choices; the shaft's speed by default"
    ),
    SET,
    argument(
        "--output", "FILE.html", "results/SCENE_page.html by default, with the values of --set in its name"
    ),
    PROVE,
    flag("--limits", "mark on each slider where the claims hold; this takes some 50 runs for each"),
    force("FILE.html even if it is not such a page"),
)
def page(options: argparse.Namespace) -> int:
    """Write a scene as a page in which its FMUs run (HTML)."""
    from ..live_page import write

    def warn(warning: str) -> None:
        complain(f"warning: {warning}")

    given = pairs(options.overrides)
    proofs = proofs_of(options.scene, options.prove, given)
    proven = ({}, {}) if proofs is None else (proofs.remarks, proofs.ranges)
    marked: Any = None
    if options.limits:  # the search loads much
        from ..studies.limits.marks import marks as marked
    written = write(
        options.scene, options.vary, options.output, given, options.force, warn, proven=proven, marks=marked
    )
    print_unproven(proofs)
    say(f"written: {written}")
    return 0
