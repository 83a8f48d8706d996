"""The commands that take traces, with their arguments: `show`, `report`, `diagram`, `plot`, `compare`."""

import argparse
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING

from .. import units
from ..display import printed
from ..display.printed import say
from ..errors import LoomfmuError
from ..files import check_target
from .shared import TRACE, argument, command, ending, flag, force, pairs, print_verdicts, revolutions, share

if TYPE_CHECKING:
    from ..traces import Trace


@command(TRACE)
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


@command(
    argument("traces", "FILE.h5", "the trace; others are laid over it", nargs="+", type=ending(".h5")),
    argument("--output", "FILE.html", "beside the first trace by default"),
    force("FILE.html even if it is not a report"),
)
def report(options: argparse.Namespace) -> int:
    """Write a trace as a page to look at (HTML)."""
    from ..report import write
    from ..traces.damage import check

    for path in options.traces:
        check(Path(path))
    say(f"written: {write(options.traces, options.output, options.force)}")
    return 0


@command(
    TRACE,
    argument(
        "--revolution",
        "N",
        "counted from 1; that of the worst failure by default, or the last whole one",
        type=int,
    ),
    flag("--round", "as rings around the shaft"),
    argument("--output", "FILE.svg|png|pdf", "FILE_diagram.svg beside the trace by default"),
    force("the picture even if loomfmu did not draw it"),
)
def diagram(options: argparse.Namespace) -> int:
    """Draw the timing diagram of a trace (SVG, PNG or PDF)."""
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


@command(
    TRACE,
    argument(
        "names",
        "SIGNAL",
        "signals such as belt.margin; other traces (MORE.h5) before them are laid over the first",
        nargs="+",
    ),
    argument("--over", None, "the shaft's angle if a shaft turns, by default", choices=("angle", "time")),
    flag("--fold", "lay the revolutions over one another"),
    argument(
        "--ylim",
        "LOW..HIGH",
        "the range that is drawn, with its unit, such as 0..1 or 0mm..5mm; by default around the bound",
    ),
    argument("--from", "X", "where the axis begins: 90deg, or 20ms over time", dest="start"),
    argument("--to", "X", "where the axis ends", dest="end"),
    argument("--revolution", "N", "the only one to draw, counted from 1", type=int),
    argument("--output", "FILE.png|svg|pdf", "FILE_plot.png beside the trace by default"),
    force("the picture even if loomfmu did not draw it"),
)
def plot(options: argparse.Namespace) -> int:
    """Plot signals of a trace (PNG, SVG or PDF)."""
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


@command(
    argument("first", "A.h5"),
    argument("second", "B.h5"),
    argument(
        "--tolerance",
        "SHARE|NAME=VALUE",
        "what may differ, as a share of each signal's largest magnitude (1e-9), such as 0.1%%; or, for"
        " one signal, an amount with its unit, such as belt.free_length=0.1mm",
        action="append",
        default=[],
    ),
    argument(
        "--ignore", "NAME", "leave signals and values out, such as 'motor.*'", action="append", default=[]
    ),
    argument(
        "--over",
        None,
        "compare at equal shaft angles or at equal times; shaft angles by default if the shafts turn",
        choices=("angle", "time"),
    ),
    flag("--all", "list all signals that differ, not only those that do so most"),
    argument("--report", "FILE.html", "also write a page that shows B over A"),
    force("FILE.html even if it is not a report"),
    statuses="0 equal within the tolerance; 1 they differ; 2 bad input.",
)
def compare(options: argparse.Namespace) -> int:
    """Report what differs between two traces, where first and by how much."""
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
