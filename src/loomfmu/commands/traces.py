"""The commands that take traces: `show`, `report`, `diagram`, `plot`, `compare`."""

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
from .options import pairs, share
from .printing import print_verdicts, revolutions

if TYPE_CHECKING:
    from ..traces import Trace


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


def report(options: argparse.Namespace) -> int:
    """Write traces as a page."""
    from ..report import write
    from ..traces.damage import check

    for path in options.traces:
        check(Path(path))
    say(f"written: {write(options.traces, options.output, options.force)}")
    return 0


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
    over, fold, force, ylim = options.over, options.fold, options.force, options.ylim
    say(f"written: {pictures.plot(traces, signals, output, over, fold, force, ylim)}")
    return 0


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
