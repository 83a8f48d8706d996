"""The commands that take traces, with their arguments: `show`, `report`, `diagram`, `plot`, `compare`."""

import argparse
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .. import units
from ..display import printed
from ..display.printed import say
from ..errors import LoomfmuError
from ..files import check_target
from .printing import print_verdicts, revolutions
from .shared import add_force, ending, pairs, share

if TYPE_CHECKING:
    from ..traces import Trace


def add_show(commands: Any) -> None:
    """Add `show` and its arguments."""
    command = commands.add_parser("show", help="summarise a trace")
    command.add_argument("trace", type=ending(".h5"), metavar="FILE.h5")
    command.set_defaults(action=show)


def show(options: argparse.Namespace) -> int:
    """Summarise a trace."""
    from ..traces import Trace
    from ..traces.damage import check

    check(Path(options.trace))
    try:
        with Trace(options.trace) as trace:
            _summarise(trace)
            whole = trace.status == "complete" and not trace.cut_short
            return 0 if whole and trace.judged and all(trace.verdicts) else 1
    except Exception as error:
        if isinstance(error, LoomfmuError | OSError) and not isinstance(error, units.UnitError):
            raise
        # whole for HDF5, but not what we write
        raise LoomfmuError(f"{options.trace}: the file is damaged ({error})") from error


def _summarise(trace: "Trace") -> None:
    """Print what a trace says of the run, its signals, and the verdicts."""
    attributes = trace.attributes
    ended = f", ended by {trace.ended_by}" * bool(trace.ended_by)
    status = {"running": "running, or killed"}.get(trace.status, trace.status)
    status = "cut short" if trace.cut_short else status
    say(f"{trace.heading} ({attributes['software']}, {status}{ended})", trace.origin)
    if trace.cut_short:
        say(printed.safe(trace.cut_short))
    if "command" in attributes:
        say(f"run by: {attributes['command']}")
    for key, value in json.loads(attributes.get("set", "{}")).items():
        say(f"differs from the scene: {key} = {value}")
    turned = (trace.shaft_angle[-1] - trace.shaft_angle[0]) / (2 * math.pi) if trace.rows else 0.0
    end = trace.time[-1] if trace.rows else 0.0
    say(f"{trace.rows} samples over {end:.6g} s, {revolutions(f'{turned:.4g}')}", "")
    rows = [("signal", *(f"{word:>12}" for word in ("lowest", "highest", "last")), "unit")]
    for name in trace:
        values = trace.read(name)  # one at a time: a long run does not fit in memory
        if len(values):
            factor, unit = trace.displayed(name)
            values = values / factor
            shown = (f"{value:12.6g}" for value in (values.min(), values.max(), values[-1]))
            rows.append((printed.safe(name), *shown, unit))
    say(*printed.in_columns(rows), *_unknown(trace), *(_off(trace) if trace.rows else ()), "")
    if trace.judged:
        print_verdicts(trace.verdicts)
    else:
        say("claims not judged: the run did not finish")


def _beside(trace: "Trace", role: str) -> dict[str, list[str]]:
    """The signals that say more of others in a role of `Beside`, each with these."""
    found: dict[str, list[str]] = {}
    for name in trace:
        if beside := trace.beside(name, role):
            found.setdefault(beside, []).append(printed.safe(name))
    return found


def _off(trace: "Trace") -> list[str]:
    """Lines on the signals that may be off whatever the steps, by the signals that say so."""
    lines = []
    for error, names in _beside(trace, "error").items():
        factor, unit = trace.displayed(error)
        most = f"{trace.read(error).max() / factor:.2g}" + ("" if unit == "1" else f" {unit}")
        lines.append(
            f"with any steps, these may be off by up to {most} ({printed.safe(error)}): {', '.join(names)}"
        )
    return lines


def _unknown(trace: "Trace") -> list[str]:
    """Lines on the signals that are not known at all samples, by the signals that say so."""
    vouching = _beside(trace, "valid_if")
    no = {flag: trace.rows - int(trace.read(flag).sum()) for flag in vouching}
    return [
        f"{printed.safe(flag)} is false at {no[flag]} of {trace.rows} samples; not known there: "
        + ", ".join(names)
        for flag, names in vouching.items()
        if no[flag]
    ]


def add_report(commands: Any) -> None:
    """Add `report` and its arguments."""
    command = commands.add_parser("report", help="write a trace as a page to look at (HTML)")
    command.add_argument(
        "traces", nargs="+", type=ending(".h5"), metavar="FILE.h5", help="the trace; others are laid over it"
    )
    command.add_argument("--output", metavar="FILE.html", help="beside the first trace by default")
    add_force(command, "FILE.html even if it is not a report")
    command.set_defaults(action=report)


def report(options: argparse.Namespace) -> int:
    """Write traces as a page."""
    from ..report import write
    from ..traces.damage import check

    for path in options.traces:
        check(Path(path))
    say(f"written: {write(options.traces, options.output, options.force)}")
    return 0


def add_diagram(commands: Any) -> None:
    """Add `diagram` and its arguments."""
    command = commands.add_parser("diagram", help="draw the timing diagram of a trace (SVG, PNG or PDF)")
    command.add_argument("trace", type=ending(".h5"), metavar="FILE.h5")
    command.add_argument(
        "--revolution",
        type=int,
        metavar="N",
        help="counted from 1; that of the worst failure by default, or the last whole one",
    )
    command.add_argument("--round", action="store_true", help="as rings around the shaft")
    command.add_argument(
        "--output", metavar="FILE.svg|png|pdf", help="FILE_diagram.svg beside the trace by default"
    )
    add_force(command, "the picture even if loomfmu did not draw it")
    command.set_defaults(action=diagram)


def diagram(options: argparse.Namespace) -> int:
    """Draw the timing diagram of a trace."""
    from ..report import diagram as timing
    from ..traces import Trace
    from ..traces.damage import check

    path = Path(options.trace)
    check(path)
    output = Path(options.output) if options.output else path.with_name(f"{path.stem}_diagram.svg")
    with Trace(path) as trace:
        drawn = timing.write(trace, output, options.revolution, options.round, options.force)
    say(f"written: {drawn}")
    return 0


def add_plot(commands: Any) -> None:
    """Add `plot` and its arguments."""
    command = commands.add_parser("plot", help="plot signals of a trace (PNG, SVG or PDF)")
    command.add_argument("trace", type=ending(".h5"), metavar="FILE.h5")
    command.add_argument(
        "names",
        nargs="+",
        metavar="SIGNAL",
        help="signals such as belt.margin; other traces (MORE.h5) before them are laid over the first",
    )
    command.add_argument(
        "--over", choices=("angle", "time"), help="the shaft's angle if a shaft turns, by default"
    )
    command.add_argument("--fold", action="store_true", help="lay the revolutions over one another")
    command.add_argument(
        "--ylim",
        metavar="LOW..HIGH",
        help="the range that is drawn, with its unit, such as 0..1 or 0mm..5mm; by default around the bound",
    )
    command.add_argument(
        "--from", dest="start", metavar="X", help="where the axis begins: 90deg, or 20ms over time"
    )
    command.add_argument("--to", dest="end", metavar="X", help="where the axis ends")
    command.add_argument("--revolution", type=int, metavar="N", help="the only one to draw, counted from 1")
    command.add_argument(
        "--output", metavar="FILE.png|svg|pdf", help="FILE_plot.png beside the trace by default"
    )
    add_force(command, "the picture even if loomfmu did not draw it")
    command.set_defaults(action=plot)


def plot(options: argparse.Namespace) -> int:
    """Plot signals of traces."""
    from ..report import pictures
    from ..traces import Trace
    from ..traces.damage import check

    more = [name for name in options.names if name.endswith(".h5") or Path(name).is_file()]
    paths = [Path(name) for name in (options.trace, *more)]
    for path in paths:
        check(path)
    signals = [name for name in options.names if name not in more]
    output = Path(options.output) if options.output else None
    traces = [Trace(path) for path in paths]
    axis = {key: getattr(options, key) for key in ("over", "fold", "ylim", "start", "end", "revolution")}
    say(f"written: {pictures.plot(traces, signals, output, overwrite=options.force, **axis)}")
    return 0


def add_compare(commands: Any) -> None:
    """Add `compare` and its arguments."""
    command = commands.add_parser(
        "compare",
        help="report what differs between two traces, where first and by how much",
        epilog="Exit status: 0 equal within the tolerance; 1 they differ; 2 bad input.",
    )
    command.add_argument("first", metavar="A.h5")
    command.add_argument("second", metavar="B.h5")
    command.add_argument(
        "--tolerance",
        action="append",
        default=[],
        metavar="SHARE|NAME=VALUE",
        help="what may differ, as a share of each signal's largest magnitude (1e-9), such as 0.1%%; or, for"
        " one signal, an amount with its unit, such as belt.free_length=0.1mm",
    )
    command.add_argument(
        "--ignore",
        action="append",
        default=[],
        metavar="NAME",
        help="leave signals and values out, such as 'motor.*'",
    )
    command.add_argument(
        "--over",
        choices=("angle", "time"),
        help="compare at equal shaft angles or at equal times; shaft angles by default if the shafts turn",
    )
    command.add_argument(
        "--all", action="store_true", help="list all signals that differ, not only those that do so most"
    )
    command.add_argument("--report", metavar="FILE.html", help="also write a page that shows B over A")
    add_force(command, "FILE.html even if it is not a report")
    command.set_defaults(action=compare)


def compare(options: argparse.Namespace) -> int:
    """Report what differs between two traces."""
    from ..traces import comparing
    from ..traces.comparison import MOST
    from ..traces.damage import check

    amounts = [text for text in options.tolerance if "=" in text]
    shares = [text for text in options.tolerance if "=" not in text]
    if len(shares) > 1:
        raise LoomfmuError(f"--tolerance is given twice: {shares[0]} and {shares[1]}")
    inputs = [Path(path) for path in (options.first, options.second)]
    for path in inputs:
        check(path)
    if options.report:  # before anything is printed
        from .. import report

        report.check()
        check_target(Path(options.report), report.REPORT, inputs, options.force)
    found = comparing.compare(
        options.first,
        options.second,
        ignore=options.ignore,
        over=options.over,
        tolerance=share(shares[0]) if shares else comparing.TOLERANCE,
        absolute=pairs(amounts, "--tolerance"),
    )
    found.show(None if options.all else MOST)
    if options.report:
        say(f"report: {report.write(inputs, options.report, options.force, comparison=found)}")
    return 0 if found else 1
