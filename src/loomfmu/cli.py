"""The command `loomfmu`.

Exit status: 0 all claims hold; 1 a claim failed; 2 bad input or a failed FMU; 130 interrupted.
"""

import argparse
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from . import units
from .errors import LoomfmuError, suggestion


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status."""
    options = _parser().parse_args(arguments)
    try:
        return int(options.command(options))
    except LoomfmuError as error:
        print(f"loomfmu: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"loomfmu: {error.filename or ''}: {error.strerror or error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt as error:
        print(f"loomfmu: {error or 'interrupted'}", file=sys.stderr)
        return 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="loomfmu", description=(__doc__ or "").split("\n\n")[1].strip())
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    run = commands.add_parser("run", help="co-simulate a scene, record it and judge its claims")
    run.add_argument("scene", metavar="SCENE.toml")
    run.add_argument(
        "--set", action="append", default=[], metavar="INSTANCE.VARIABLE=VALUE", dest="overrides",
        help="a value that differs from the scene's, such as shaft.speed=685rpm",
    )  # fmt: skip
    run.add_argument("--output", metavar="FILE.h5", help="the trace; results/SCENE.h5 by default")
    run.set_defaults(command=_run)

    build = commands.add_parser("build", help="build FMUs")
    build.add_argument("names", nargs="*", metavar="NAME", help="all by default")
    build.add_argument("--output", type=Path, default=Path("build/fmus"), metavar="DIR")
    build.set_defaults(command=_build)

    listing = commands.add_parser("list", help="list the FMUs, machines and rapier heads there are")
    listing.set_defaults(command=_list)

    show = commands.add_parser("show", help="summarise a trace")
    show.add_argument("trace", metavar="FILE.h5")
    show.set_defaults(command=_show)
    return parser


def _run(options: argparse.Namespace) -> int:
    from .cosim.run import run

    overrides: dict[str, Any] = {}
    for text in options.overrides:
        key, equals, value = text.partition("=")
        if not equals:
            raise LoomfmuError(f"--set {text}: not of the form INSTANCE.VARIABLE=VALUE")
        overrides[key.strip()] = value.strip()
    result = run(options.scene, set=overrides, output=options.output, progress=True)
    for warning in result.warnings:
        print(f"warning: {warning}", file=sys.stderr)
    scene = result.scene
    print(
        f"{scene.title}: {scene.revolutions:g} revolutions at {units.show(scene.speed, 'rev/min')},"
        f" {scene.steps_per_revolution} steps each"
    )
    _print_verdicts([verdict.as_dict() for verdict in result.claims])
    if scene.description:
        print(f"{scene.description}\n")
    print(f"trace: {result.path}    summary: loomfmu show {result.path}")
    return 0 if result.holds else 1


def _build(options: argparse.Namespace) -> int:
    from .components import COMPONENTS
    from .fmi import builder

    for name in options.names:
        if name not in COMPONENTS:
            raise LoomfmuError(f"there is no FMU {name!r}{suggestion(name, COMPONENTS)}")
    for name in options.names or COMPONENTS:
        print(builder.build(name, options.output))
    return 0


def _list(_options: argparse.Namespace) -> int:
    from .components import COMPONENTS
    from .machines import HEADS, MACHINES
    from .variables import variables_of

    for name, component in COMPONENTS.items():
        print(f"{name}: {(component.__doc__ or '').splitlines()[0]}")
        for causality in ("input", "output"):
            names = [v.name for v in variables_of(component) if v.causality == causality]
            print(f"    {causality}s: {', '.join(names) or 'none'}")
        for variable in variables_of(component):
            if variable.choices:
                print(f"    {variable.name}: {', '.join(variable.choices)}")
    print(f"machines: {', '.join(MACHINES)}")
    print(f"heads: {', '.join(HEADS)}")
    return 0


def _show(options: argparse.Namespace) -> int:
    from .traces import Trace

    with Trace(options.trace) as trace:
        attributes = trace.attributes
        print(f"{attributes['title']} ({attributes['software']}, {trace.status})")
        turned = (trace.shaft_angle[-1] - trace.shaft_angle[0]) / (2 * math.pi) if trace.rows else 0.0
        end = trace.time[-1] if trace.rows else 0.0
        print(f"{trace.rows} samples over {end:.6g} s, {turned:.4g} revolutions")
        width = max((len(signal) for signal in trace), default=0)
        print(f"\n{'signal':{width}}  {'lowest':>12}  {'highest':>12}  {'last':>12}  unit")
        for signal in trace:
            values = trace[signal]
            if len(values):
                display = trace.display(signal)
                values = values / units.unit(display).factor
                shown = "  ".join(f"{value:12.6g}" for value in (values.min(), values.max(), values[-1]))
                print(f"{signal:{width}}  {shown}  {display}")
        print()
        _print_verdicts(trace.verdicts)
        return 0 if trace.status == "complete" and all(v["holds"] for v in trace.verdicts) else 1


def _print_verdicts(verdicts: Sequence[dict[str, Any]]) -> None:
    """The verdicts as a table."""
    if not verdicts:
        print("no claims")
        return
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD)
    for heading in ("verdict", "claim", "signal", "worst", "bound", "time", "angle", "rev."):
        table.add_column(heading, overflow="fold")
    for verdict in verdicts:
        placed = verdict["time"] is not None
        table.add_row(
            "holds" if verdict["holds"] else "[bold red]FAILS[/]",
            verdict["claim"] + (f" ({verdict['note']})" if verdict["note"] else ""),
            verdict["signal"],
            "-" if verdict["worst"] is None else units.show(verdict["worst"], verdict["unit"]),
            units.show(verdict["bound"], verdict["unit"]),
            f"{verdict['time']:.6g} s" if placed else "-",
            f"{math.degrees(verdict['angle']):.3f} deg" if placed else "-",
            str(verdict["revolution"]) if placed else "-",
        )
    Console(width=None if sys.stdout.isatty() else 150).print(table)


if __name__ == "__main__":
    sys.exit(main())
