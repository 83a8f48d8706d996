"""The arguments of the command `loomfmu`, and its help."""

import argparse
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from .printed import complain, say
from .version import __version__

ABOUT = (
    "Simulate the mechanisms of a weaving loom as FMUs over the main shaft's angle, and check claims about"
    ' them, such as "the rapier belt does not buckle".'
)
STATUSES = (
    "Exit status: 0 all claims hold; 1 a claim fails or is undecided; 2 bad input or a failed FMU;"
    " 130 interrupted."
)


class _Parser(argparse.ArgumentParser):
    """Every command takes `--debug`; errors are printed like all other messages."""

    def __init__(self, **named: Any) -> None:
        super().__init__(**named)
        # suppressed: else the default of a command would replace a `--debug` before it
        self.add_argument("--debug", action="store_true", default=argparse.SUPPRESS, help="show tracebacks")

    def error(self, message: str) -> NoReturn:
        self.print_usage(sys.stderr)
        complain(f"{self.prog}: error: {message}")
        sys.exit(2)


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        say(f"loomfmu {__version__}")
        parser.exit()


def with_negative(arguments: Sequence[str]) -> list[str]:
    """Arguments in which negative values belong to their options, which argparse takes for options.

    >>> with_negative(["limit", "--from", "-0.15mm", "--live"])
    ['limit', '--from=-0.15mm', '--live']
    """
    found: list[str] = []
    for each in arguments:
        if found and re.fullmatch(r"--[a-z-]+", found[-1]) and re.match(r"-\.?\d", each):
            found[-1] += f"={each}"
        else:
            found.append(each)
    return found


def parser() -> argparse.ArgumentParser:
    """The parser; `command` is the name of the command."""
    parser = _Parser(prog="loomfmu", description=ABOUT, epilog=STATUSES)
    parser.set_defaults(debug=False)
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for add in (
        _run,
        _show,
        _report,
        _page,
        _diagram,
        _plot,
        _compare,
        _sweep,
        _limit,
        _tolerances,
        _optimize,
        _fit,
        _list,
        _init,
        _new,
        _build,
        _export,
        _cache,
        _validate,
    ):
        add(commands)
    return parser


def _run(commands: Any) -> None:
    run = commands.add_parser("run", help="simulate a scene, record a trace and check the claims")
    _add_scene(run)
    _add_set(run)
    run.add_argument("--output", metavar="FILE.h5", help="trace file; results/SCENE.h5 by default")
    flavour = run.add_mutually_exclusive_group()
    flavour.add_argument(
        "--live", action="store_true", help="use live FMUs (Python) instead of native ones (compiled)"
    )
    flavour.add_argument("--native", action="store_true", help=argparse.SUPPRESS)  # which it does anyway
    run.add_argument("--report", action="store_true", help="also write a page to look at, beside the trace")
    run.add_argument("--explain", action="store_true", help="report skipped FMUs, outputs and steps")
    _add_force(run, "FILE.h5 even if it is not a trace")


def _show(commands: Any) -> None:
    show = commands.add_parser("show", help="summarise a trace")
    show.add_argument("trace", metavar="FILE.h5")


def _report(commands: Any) -> None:
    report = commands.add_parser("report", help="write a trace as a page to look at (HTML)")
    report.add_argument("traces", nargs="+", metavar="FILE.h5", help="the trace; others are laid over it")
    report.add_argument("--output", metavar="FILE.html", help="beside the first trace by default")
    _add_force(report, "FILE.html even if it is not a report")


def _page(commands: Any) -> None:
    page = commands.add_parser("page", help="write a scene as a page in which its FMUs run (HTML)")
    page.add_argument("scene", metavar="SCENE.toml")
    page.add_argument(
        "--vary", action="append", default=[], metavar="INSTANCE.VARIABLE=LOW..HIGH",
        help="what the page has a slider for, such as shaft.speed=400rpm..800rpm (repeatable); without a"
        " range 20 %% around the scene's value, or its choices; the shaft's speed by default",
    )  # fmt: skip
    _add_set(page)
    page.add_argument("--output", metavar="FILE.html", help="results/SCENE_page.html by default")
    _add_force(page, "FILE.html even if it is not such a page")


def _diagram(commands: Any) -> None:
    diagram = commands.add_parser("diagram", help="draw the timing diagram of a trace (SVG, PNG or PDF)")
    diagram.add_argument("trace", metavar="FILE.h5")
    diagram.add_argument(
        "--revolution", type=int, metavar="N", help="counted from 1; the last whole one by default"
    )
    diagram.add_argument("--round", action="store_true", help="as rings around the shaft")
    diagram.add_argument(
        "--output", metavar="FILE.svg|png|pdf", help="FILE_diagram.svg beside the trace by default"
    )
    _add_force(diagram, "the picture even if it is not one")


def _plot(commands: Any) -> None:
    plot = commands.add_parser("plot", help="plot signals of a trace (PNG, SVG or PDF)")
    plot.add_argument("trace", metavar="FILE.h5")
    plot.add_argument(
        "names", nargs="+", metavar="SIGNAL",
        help="signals such as belt.margin; other traces (MORE.h5) before them are laid over the first",
    )  # fmt: skip
    plot.add_argument(
        "--over", choices=("angle", "time"), help="the shaft's angle if a shaft turns, by default"
    )
    plot.add_argument("--fold", action="store_true", help="lay the revolutions over one another")
    plot.add_argument(
        "--output", metavar="FILE.png|svg|pdf", help="FILE_plot.png beside the trace by default"
    )
    _add_force(plot, "the picture even if it is not one")


def _compare(commands: Any) -> None:
    compare = commands.add_parser(
        "compare", help="report what differs between two traces, where first and by how much",
        epilog="Exit status: 0 equal within the tolerance; 1 they differ; 2 bad input.",
    )  # fmt: skip
    compare.add_argument("first", metavar="A.h5")
    compare.add_argument("second", metavar="B.h5")
    compare.add_argument(
        "--tolerance", action="append", default=[], metavar="SHARE|NAME=VALUE",
        help="what may differ, as a share of each signal's largest magnitude (1e-9), such as 0.1%%; or, for"
        " one signal, an amount with its unit, such as belt.free_length=0.1mm",
    )  # fmt: skip
    compare.add_argument(
        "--ignore", action="append", default=[], metavar="NAME",
        help="leave signals and values out, such as 'motor.*'",
    )  # fmt: skip
    compare.add_argument(
        "--over", choices=("angle", "time"),
        help="compare at equal shaft angles or at equal times; shaft angles by default if the shafts turn",
    )  # fmt: skip
    compare.add_argument(
        "--all", action="store_true", help="list all signals that differ, not only those that do so most"
    )
    compare.add_argument("--report", metavar="FILE.html", help="also write a page that shows B over A")
    _add_force(compare, "FILE.html even if it is not a report")


def _sweep(commands: Any) -> None:
    sweep = commands.add_parser("sweep", help="run a scene with many combinations of values")
    sweep.add_argument("sweep", metavar="SWEEP.toml")
    _add_place(sweep, "SWEEP")


def _limit(commands: Any) -> None:
    limit = commands.add_parser(
        "limit", help="find the values at which claims begin to fail",
        epilog="Exit status: 0 all claims hold in some range; 1 in none; 2 bad input or a failed FMU.",
    )  # fmt: skip
    _add_scene(limit)
    limit.add_argument(
        "--vary", action="append", required=True, metavar="INSTANCE.VARIABLE[=LOW..HIGH]",
        help="what is varied, such as shaft.speed or shaft.speed=300rpm..900rpm; a second one gives the"
        " limits of the first at values of the second",
    )  # fmt: skip
    limit.add_argument(
        "--from",
        dest="from_",
        metavar="LOW",
        help="where the range of the first --vary begins, with its unit",
    )
    limit.add_argument(
        "--to", metavar="HIGH", help="where it ends; by default half to twice the scene's value"
    )
    limit.add_argument(
        "--points", type=int, metavar="N", help="values of the first that are tried first (41)"
    )
    limit.add_argument("--rows", type=int, metavar="N", help="values of the second that are taken (11)")
    _add_set(limit)
    limit.add_argument(
        "--output", metavar="FILE.csv|svg|png|pdf", help="also write the limits as a table or a picture"
    )
    _add_force(limit, "the file even if it is not such a table or picture")


def _tolerances(commands: Any) -> None:
    tolerances = commands.add_parser(
        "tolerances", help="find the worst case of every claim within tolerances",
        epilog="Exit status: 0 all hold in their worst cases; 1 a claim fails or is undecided;"
        " 2 bad input or a failed FMU.",
    )  # fmt: skip
    _add_scene(tolerances)
    tolerances.add_argument(
        "--vary", action="append", default=[], metavar="INSTANCE.VARIABLE=LOW..HIGH",
        help="a tolerance, such as belt.guide_clearance=0.2mm..0.5mm (repeatable); those of the scene's"
        " [tolerances] by default",
    )  # fmt: skip
    _add_set(tolerances)
    tolerances.add_argument("--picture", metavar="FILE.svg|png|pdf", help="also draw the worst cases")
    _add_force(tolerances, "the picture even if it is not one")


def _optimize(commands: Any) -> None:
    optimize = commands.add_parser(
        "optimize", help="find the best design within ranges and choices, all claims met",
        epilog="Exit status: 0 a design was found; 1 none meets all claims; 2 bad input or a failed FMU.",
    )  # fmt: skip
    optimize.add_argument("study", metavar="STUDY.toml")
    _add_place(optimize, "STUDY")


def _fit(commands: Any) -> None:
    fit = commands.add_parser("fit", help="find parameters of a scene from measured curves")
    _add_scene(fit)
    fit.add_argument(
        "data", metavar="DATA.csv|h5",
        help="columns with units, such as shaft_angle [deg],heald_1.displacement [mm]; or a trace",
    )  # fmt: skip
    fit.add_argument(
        "--vary", action="append", required=True, metavar="INSTANCE.VARIABLE[=LOW..HIGH]",
        help="a parameter to find, such as damper_1.spring_stiffness=1N/mm..20N/mm (repeatable)",
    )  # fmt: skip
    fit.add_argument(
        "--signal", action="append", default=[], metavar="SIGNAL",
        help="what is fitted of the data (repeatable); all columns of a table by default",
    )  # fmt: skip
    _add_set(fit)
    fit.add_argument("--output", metavar="FILE.toml", help="also write the scene with the fitted values")
    fit.add_argument("--picture", metavar="FILE.svg|png|pdf", help="also draw measured and computed curves")
    _add_force(fit, "these files even if they are not a scene and a picture")


def _list(commands: Any) -> None:
    listing = commands.add_parser("list", help="list FMUs, machines, heads and example scenes")
    listing.add_argument(
        "name",
        nargs="?",
        metavar="NAME",
        help="describe this FMU, FILE.fmu, FILE.py[:CLASS], machine or rapier head",
    )


def _init(commands: Any) -> None:
    init = commands.add_parser("init", help="write an example scene and a sweep of it")
    init.add_argument(
        "directory", nargs="?", type=Path, default=Path(), metavar="DIR",
        help="folder to write to; the current one by default",
    )  # fmt: skip
    init.add_argument("--all", action="store_true", help="write every example scene")


def _new(commands: Any) -> None:
    new = commands.add_parser("new", help="write a folder for a mechanism of your own, ready to run")
    new.add_argument("name", metavar="NAME", help="class name, such as PickingCam")
    new.add_argument(
        "--output", type=Path, default=Path(), metavar="DIR",
        help="where to put the folder; the current folder by default",
    )  # fmt: skip


def _build(commands: Any) -> None:
    build = commands.add_parser("build", help="build FMUs")
    build.add_argument(
        "names", nargs="*", metavar="NAME",
        help="an FMU, or FILE.py[:CLASS] for one of your own; all FMUs by default",
    )  # fmt: skip
    build.add_argument(
        "--output", type=Path, metavar="DIR",
        help="build/fmus by default; build/native or build/native_fmi3 for native FMUs",
    )  # fmt: skip
    build.add_argument("--native", action="store_true", help="build native FMUs: in C, without Python")
    _add_platform(build)
    build.add_argument(
        "--fmi", type=int, choices=(2, 3), default=2, help="FMI version of native FMUs; 2 by default"
    )
    _add_force(build, "third-party FMUs in DIR")


def _export(commands: Any) -> None:
    export = commands.add_parser(
        "export", help="write a scene as one FMU, or as a system package (SSP), for other tools"
    )
    export.add_argument("scene", metavar="SCENE.toml")
    file = export.add_mutually_exclusive_group(required=True)
    file.add_argument(
        "--fmu", type=Path, metavar="FILE.fmu",
        help="write one native FMU: all mechanisms wired inside, without delay between them",
    )  # fmt: skip
    file.add_argument(
        "--ssp", type=Path, metavar="FILE.ssp", help="write a system package: one FMU for each mechanism"
    )
    _add_set(export)
    export.add_argument("--fmi", type=int, choices=(2, 3), help="FMI version of FILE.fmu; 2 by default")
    export.add_argument(
        "--flavour", choices=("live", "native"),
        help="kind of FMUs in FILE.ssp; native by default if they can be built",
    )  # fmt: skip
    _add_platform(export)
    _add_force(export, "the file even if loomfmu did not write it")


def _cache(commands: Any) -> None:
    cache = commands.add_parser("cache", help="show location and size of the cache of built FMUs")
    cache.add_argument("--clear", action="store_true", help="empty it; FMUs are built again when needed")


def _validate(commands: Any) -> None:
    validate = commands.add_parser("validate", help="compare published and computed values")
    validate.add_argument(
        "--output", type=Path, default=Path("results"), metavar="DIR",
        help="folder for the report; results by default",
    )  # fmt: skip
    _add_force(validate, "files in DIR that are not part of such a report")


def _add_platform(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--platform", metavar="NAME[,NAME]",
        help="platforms of native FMUs: linux64,win64,darwin64; all by default",
    )  # fmt: skip


def _add_scene(command: argparse.ArgumentParser) -> None:
    command.add_argument("scene", metavar="SCENE", help="a scene (.toml) or a system package (.ssp)")


def _add_place(command: argparse.ArgumentParser, name: str) -> None:
    command.add_argument("--output", metavar="DIR", help=f"folder for the results; results/{name} by default")
    command.add_argument(
        "--processes", type=int, metavar="N", help="worker processes on this machine; one per core by default"
    )
    command.add_argument(
        "--scheduler", metavar="ADDRESS", help="run on a dask cluster, such as tcp://host:8786"
    )
    command.add_argument(
        "--restart", action="store_true", help="discard earlier results in DIR and run everything again"
    )


def _add_set(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--set", action="append", default=[], metavar="INSTANCE.VARIABLE=VALUE", dest="overrides",
        help="override a value of the scene, such as shaft.speed=685rpm",
    )  # fmt: skip


def _add_force(command: argparse.ArgumentParser, what: str) -> None:
    command.add_argument("--force", action="store_true", help=f"replace {what}")
