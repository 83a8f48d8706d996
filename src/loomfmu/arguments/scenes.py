"""The arguments of the commands that take a scene."""

import argparse
from pathlib import Path
from typing import Any

from .shared import add_force, add_platform, add_scene, add_set, ending


def run(commands: Any) -> None:
    """Arguments of `run`."""
    run = commands.add_parser("run", help="simulate a scene, record a trace and check the claims")
    add_scene(run)
    add_set(run)
    run.add_argument(
        "--output",
        metavar="FILE.h5",
        help="trace file; results/SCENE.h5 by default, with the values of --set results/SCENE_VALUES.h5",
    )
    flavour = run.add_mutually_exclusive_group()
    flavour.add_argument(
        "--live", action="store_true", help="use live FMUs (Python) instead of native ones (compiled)"
    )
    flavour.add_argument("--native", action="store_true", help=argparse.SUPPRESS)  # which it does anyway
    run.add_argument("--report", action="store_true", help="also write a page to look at, beside the trace")
    run.add_argument("--explain", action="store_true", help="report skipped FMUs, outputs and steps")
    add_force(run, "FILE.h5 even if it is not a trace")


def page(commands: Any) -> None:
    """Arguments of `page`."""
    page = commands.add_parser("page", help="write a scene as a page in which its FMUs run (HTML)")
    page.add_argument("scene", type=ending(".toml"), metavar="SCENE.toml")
    page.add_argument(
        "--vary",
        action="append",
        default=[],
        metavar="INSTANCE.VARIABLE=LOW..HIGH",
        help="what the page has a slider for, such as shaft.speed=400rpm..800rpm (repeatable); without a"
        " range 20 %% around the scene's value, or its choices; the shaft's speed by default",
    )
    add_set(page)
    page.add_argument(
        "--output",
        metavar="FILE.html",
        help="results/SCENE_page.html by default, with the values of --set in its name",
    )
    add_force(page, "FILE.html even if it is not such a page")


def export(commands: Any) -> None:
    """Arguments of `export`."""
    export = commands.add_parser(
        "export", help="write a scene as one FMU, or as a system package (SSP), for other tools"
    )
    export.add_argument("scene", type=ending(".toml"), metavar="SCENE.toml")
    file = export.add_mutually_exclusive_group(required=True)
    file.add_argument(
        "--fmu",
        type=Path,
        metavar="FILE.fmu",
        help="write one native FMU: all mechanisms wired inside, without delay between them",
    )
    file.add_argument(
        "--ssp", type=Path, metavar="FILE.ssp", help="write a system package: one FMU for each mechanism"
    )
    add_set(export)
    export.add_argument("--fmi", type=int, choices=(2, 3), help="FMI version of FILE.fmu; 2 by default")
    export.add_argument(
        "--flavour",
        choices=("live", "native"),
        help="kind of FMUs in FILE.ssp; native by default if they can be built",
    )
    add_platform(export)
    add_force(export, "the file even if loomfmu did not write it")
