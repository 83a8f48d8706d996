"""The command `loomfmu`."""

import argparse
import atexit
import gc
import json
import math
import os
import shlex
import shutil
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from signal import SIG_IGN, SIGINT, signal
from time import perf_counter
from typing import TYPE_CHECKING, Any

from . import printed, units
from .arguments import parser
from .errors import LoomfmuError, described, why
from .files import check_target
from .printed import complain, say

BEGUN = perf_counter()  # when the command started
atexit.register(gc.freeze)  # last of all: Python ends without a search for garbage, 60 ms of a run

if TYPE_CHECKING:
    from .cosim.results import Result
    from .traces import Trace, Verdict


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command and return its exit status."""
    options = argparse.Namespace(debug=False)
    # numpy starts a thread for each core, which takes 40 ms; nothing here has matrices for so many
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

    def command() -> int:
        parser().parse_args(arguments, options)
        return COMMANDS[options.command](options)

    return _status(command, options)


def _status(command: Callable[[], int], options: argparse.Namespace) -> int:
    """The exit status of a command; whatever goes wrong becomes one line."""
    try:
        status = command()
        _flush()
        return status
    except BrokenPipeError:  # the reader of our output has gone, as `head` does
        _drop_output()
        return 141
    except (Exception, KeyboardInterrupt) as error:
        interrupted = isinstance(error, KeyboardInterrupt)
        if interrupted and threading.current_thread() is threading.main_thread():
            signal(SIGINT, SIG_IGN)  # another Ctrl-C changes nothing any more
        if options.debug:
            printed.complain_of(error)
        complain(f"loomfmu: {_reason(error)}")
        return 130 if interrupted else 2


def _flush() -> None:
    """Write what was printed. Raises LoomfmuError where standard output takes nothing more."""
    try:
        if sys.stdout is not None:  # closed by whoever started this process
            sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as error:
        raise LoomfmuError(f"standard output: {error.strerror}") from None


def _drop_output() -> None:
    """Let Python end without another try to write what it could not."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _reason(error: BaseException) -> str:
    """What went wrong, in one line."""
    if isinstance(error, LoomfmuError):
        return str(error)
    if isinstance(error, OSError):
        return (f"{error.filename}: " if error.filename else "") + why(error)
    if isinstance(error, KeyboardInterrupt):
        return str(error) or "interrupted"
    if isinstance(error, MemoryError):
        return "out of memory"
    what = described(error)
    return f"{what} (a bug in loomfmu; please report it with the output of --debug)"


def _pairs(texts: Sequence[str], option: str = "--set") -> dict[str, Any]:
    """The values by their names, as an option gives them."""
    pairs: dict[str, Any] = {}
    for text in texts:
        key, equals, value = text.partition("=")
        if not equals:
            raise LoomfmuError(f"{option} {text}: not of the form INSTANCE.VARIABLE=VALUE")
        key = key.strip()
        if key in pairs:
            raise LoomfmuError(f"{option} {key} is given twice: {pairs[key]} and {value.strip()}")
        pairs[key] = value.strip()
    return pairs


def _export(options: argparse.Namespace) -> int:
    from .cosim import whole
    from .cosim.scenes import scene
    from .cosim.ssp import export as ssp

    if options.fmu and options.flavour:
        raise LoomfmuError("--flavour is for --ssp: one FMU of a whole scene is always native")
    if options.ssp and options.fmi:
        raise LoomfmuError("--fmi is for --fmu: a system package holds FMUs of FMI 2.0")
    platforms = _platforms(options)
    loaded = scene.load(options.scene, _pairs(options.overrides))
    if options.fmu:
        warnings = whole.export(loaded, options.fmu, platforms, options.fmi or 2, options.force)
    else:
        warnings = ssp.export(loaded, options.ssp, options.flavour, platforms, options.force)
    for warning in warnings:
        complain(f"warning: {warning}")
    say(options.fmu or options.ssp)
    return 0


def _run(options: argparse.Namespace) -> int:
    from .cosim.master.guards import supervised
    from .cosim.reading import checked

    if options.report:
        from . import report

        report.check()  # before the run, not after it
    options.scene = checked(options.scene, _pairs(options.overrides), "live" if options.live else "native")
    if unprotected := options.scene.unprotected:
        return supervised(lambda: _status(lambda: _run_here(options), options), unprotected)
    return _run_here(options)


def _run_here(options: argparse.Namespace) -> int:
    """Run a scene that was read, in this process, and print what came of it."""
    from .cosim.run import run

    result = run(
        options.scene, output=options.output, progress=True,
        flavour="live" if options.live else "native", overwrite=options.force,
    )  # fmt: skip
    # before anything is printed: the reader of our output may have had enough
    page = _page_of(result.trace, result.path, options.force) if options.report else None
    for warning in result.warnings:
        complain(f"warning: {warning}")
    scene = result.scene
    if result.ended:
        say(f"{scene.title}: ended by {result.ended}, {result.steps} steps")
    elif scene.step is None:
        turned, speed = result.trace.turned_otherwise(scene.periods), units.show(scene.speed, "rev/min")
        count = f"{scene.periods:g} nominal" if turned else f"{scene.periods:g}"
        parts = f"{_revolutions(count)} at {speed}", turned, f"{result.steps} steps"
        say(f"{scene.title}: {', '.join(filter(None, parts))}")
    else:
        say(f"{scene.title}: {scene.periods:g} s in {scene.steps} steps of {scene.step:g} s")
    if result.chosen:
        say(result.chosen)
    if options.explain:
        say("skipped:", *(f"  {line}" for line in result.skipped))
    _print_verdicts(result.claims)
    if scene.description and not scene.overrides:  # it is about the values that the scene has
        say(*scene.description.splitlines(), "")
    _print_pace(result)
    command = "loomfmu"
    if Path(sys.argv[0]).name == command and shutil.which(command) != shutil.which(sys.argv[0]):
        command = sys.argv[0]  # it is not on the PATH, or another one is
    path = str(result.path)
    summary = [command, "show", *(["--"] if path.startswith("-") else []), path]
    say(f"trace: {path}    summary: {shlex.join(summary)}")
    if page:
        say(f"report: {page}")
    return 0 if result.holds else 1


def _page_of(trace: "Trace", path: Path, overwrite: bool) -> Path:
    from . import report

    return report.write([trace], path.with_suffix(".html"), overwrite)


def _print_pace(result: "Result") -> None:
    """How fast the steps were, with FMUs of which flavour, and how long the command took until now."""
    flavours = {each.fmu.flavour for each in result.scene.instances.values()} - {""}
    pace = f"{1e6 * result.seconds / result.steps:.3g} us each" if result.steps else "none"
    kind = f"{' and '.join(sorted(flavours, reverse=True))} FMUs".lstrip()
    say(f"{result.steps} steps with {kind}, {pace}; {perf_counter() - BEGUN:.2f} s in total")


def _limit(options: argparse.Namespace) -> int:
    from .studies.limits import command

    return command.run(options, _pairs(options.overrides))


def _tolerances(options: argparse.Namespace) -> int:
    from .studies.tolerances import command

    return command.run(options, _pairs(options.overrides))


def _optimize(options: argparse.Namespace) -> int:
    from .studies.optimizing import command

    return command.run(options)


def _fit(options: argparse.Namespace) -> int:
    from .studies.fitting import command

    return command.run(options, _pairs(options.overrides))


def _sweep(options: argparse.Namespace) -> int:
    from .sweeps.run import sweep

    found = sweep(
        options.sweep, processes=options.processes, output=options.output, scheduler=options.scheduler,
        restart=options.restart, progress=True,
    )  # fmt: skip
    from .sweeps.report import show

    for warning in found.warnings:
        complain(f"warning: {warning}")
    show(found)
    return 0 if found.holds and not found.untraced else 1


def _build(options: argparse.Namespace) -> int:
    from concurrent.futures import ThreadPoolExecutor
    from functools import partial

    from . import catalogue
    from .fmi import builder
    from .fmi.native.builder import build_native

    built = catalogue.components(options.names)
    if not options.native and (options.platform or options.fmi != 2):
        raise LoomfmuError("--platform and --fmi are for native FMUs: add --native")
    platforms = _platforms(options)
    if options.native:
        output = options.output or Path("build/native" if options.fmi == 2 else "build/native_fmi3")
        build = partial(
            build_native, directory=output, platforms=platforms, fmi=options.fmi, overwrite=options.force
        )
    else:
        build = partial(
            builder.build, directory=options.output or Path("build/fmus"), overwrite=options.force
        )
    with ThreadPoolExecutor() as pool:  # compilers run side by side
        for path in pool.map(build, built):
            say(path)
    return 0


def _platforms(options: argparse.Namespace) -> tuple[str, ...]:
    """The platforms that were chosen, all by default. Raises LoomfmuError for one that is not known."""
    from .fmi.native.platforms import PLATFORMS, check_platforms

    return check_platforms(tuple(options.platform.split(",") if options.platform else PLATFORMS))


def _list(options: argparse.Namespace) -> int:
    from . import catalogue

    width = shutil.get_terminal_size().columns
    lines = catalogue.details(options.name, width) if options.name else catalogue.overview()
    say(*(part for line in lines for part in line.split("\n")))
    return 0


def _init(options: argparse.Namespace) -> int:
    from . import catalogue

    written = catalogue.start(options.directory, everything=options.all)
    say(*written, "")
    say('sweeps and their maps need two extras: pip install "loomfmu[sweep,plot]"')
    first = options.directory / catalogue.STARTERS[0]
    say(f"next: {shlex.join(['loomfmu', 'run', str(first)])}")
    return 0


def _new(options: argparse.Namespace) -> int:
    from .new import new

    written = new(options.name, options.output)
    say(*written, "")
    say(f"next: cd {shlex.quote(str(written[0].parent))} && loomfmu run {written[-1].name}")
    return 0


def _validate(options: argparse.Namespace) -> int:
    from .validation import plots, report

    for path in report.write(options.output, options.force):
        say(path)
    if not plots.available():
        complain('no plots: matplotlib is not installed; pip install "loomfmu[plot]"')
    return 0


def _cache(options: argparse.Namespace) -> int:
    from .fmi.cache import cache_directory
    from .fmi.cache_entries import clear, contents

    if options.clear:
        clear()
    found = contents()
    size, entries = sum(each.size for each in found), sum(each.entries for each in found)
    say(f"{cache_directory()}: {size / 1e6:.1f} MB, {entries} entries")
    for each in found:
        say(f"  {each.kind:8}  {each.size / 1e6:8.1f} MB  {each.entries:6} entries")
    return 0


def _show(options: argparse.Namespace) -> int:
    from .traces import Trace
    from .traces.damage import check

    check(Path(options.trace))
    try:
        with Trace(options.trace) as trace:
            _summarise(trace)
            return 0 if trace.status == "complete" and trace.judged and all(trace.verdicts) else 1
    except Exception as error:
        if isinstance(error, LoomfmuError | OSError) and not isinstance(error, units.UnitError):
            raise
        # whole for HDF5, but not what we write
        raise LoomfmuError(f"{options.trace}: the file is damaged ({error})") from error


def _report(options: argparse.Namespace) -> int:
    from .report import write
    from .traces.damage import check

    for path in options.traces:
        check(Path(path))
    say(write(options.traces, options.output, options.force))
    return 0


def _page(options: argparse.Namespace) -> int:
    from .live_page import write

    def warn(warning: str) -> None:
        complain(f"warning: {warning}")

    given = _pairs(options.overrides)
    say(write(options.scene, options.vary, options.output, given, options.force, warn))
    return 0


def _diagram(options: argparse.Namespace) -> int:
    from .report import diagram
    from .traces import Trace
    from .traces.damage import check

    path = Path(options.trace)
    check(path)
    output = Path(options.output) if options.output else path.with_name(f"{path.stem}_diagram.svg")
    with Trace(path) as trace:
        say(diagram.write(trace, output, options.revolution, options.round, options.force))
    return 0


def _plot(options: argparse.Namespace) -> int:
    from .report import pictures
    from .traces import Trace
    from .traces.damage import check

    more = [name for name in options.names if name.endswith(".h5") or Path(name).is_file()]
    paths = [Path(name) for name in (options.trace, *more)]
    for path in paths:
        check(path)
    signals = [name for name in options.names if name not in more]
    output = Path(options.output) if options.output else None
    traces = [Trace(path) for path in paths]
    say(pictures.plot(traces, signals, output, options.over, options.fold, options.force))
    return 0


def _compare(options: argparse.Namespace) -> int:
    from .traces import compare
    from .traces.comparing import TOLERANCE
    from .traces.comparison import MOST
    from .traces.damage import check

    amounts = [text for text in options.tolerance if "=" in text]
    shares = [text for text in options.tolerance if "=" not in text]
    if len(shares) > 1:
        raise LoomfmuError(f"--tolerance is given twice: {shares[0]} and {shares[1]}")
    inputs = [Path(path) for path in (options.first, options.second)]
    for path in inputs:
        check(path)
    if options.report:  # before anything is printed
        from . import report

        report.check()
        check_target(Path(options.report), report.REPORT, inputs, options.force)
    found = compare(
        options.first, options.second, ignore=options.ignore, over=options.over,
        tolerance=_share(shares[0]) if shares else TOLERANCE,
        absolute=_pairs(amounts, "--tolerance"),
    )  # fmt: skip
    found.show(None if options.all else MOST)
    if options.report:
        say(f"report: {report.write(inputs, options.report, options.force, comparison=found)}")
    return 0 if found else 1


def _share(text: str) -> float:
    """The share that --tolerance gives."""
    try:
        return units.parse(text, "1")
    except units.UnitError as error:
        wanted = "write a share such as 0.1%, or NAME=AMOUNT such as belt.free_length=0.1mm"
        raise LoomfmuError(f"--tolerance {text}: {error}; {wanted}") from None


def _summarise(trace: "Trace") -> None:
    """Print what a trace says of the run, its signals, and the verdicts."""
    attributes = trace.attributes
    ended = f", ended by {trace.ended_by}" * bool(trace.ended_by)
    status = trace.status if trace.status != "running" else "running, or killed"
    say(f"{attributes['title']} ({attributes['software']}, {status}{ended})")
    if "command" in attributes:
        say(f"run by: {attributes['command']}")
    for key, value in json.loads(attributes.get("set", "{}")).items():
        say(f"differs from the scene: {key} = {value}")
    turned = (trace.shaft_angle[-1] - trace.shaft_angle[0]) / (2 * math.pi) if trace.rows else 0.0
    end = trace.time[-1] if trace.rows else 0.0
    say(f"{trace.rows} samples over {end:.6g} s, {_revolutions(f'{turned:.4g}')}", "")
    rows = [("signal", *(f"{word:>12}" for word in ("lowest", "highest", "last")), "unit")]
    for name in trace:
        values = trace.read(name)  # one at a time: a long run does not fit in memory
        if len(values):
            factor, unit = trace.displayed(name)
            values = values / factor
            shown = (f"{value:12.6g}" for value in (values.min(), values.max(), values[-1]))
            rows.append((printed.safe(name), *shown, unit))
    say(*printed.in_columns(rows), *_unknown(trace), "")
    if trace.judged:
        _print_verdicts(trace.verdicts)
    else:
        say("claims not judged: the run did not finish")


def _unknown(trace: "Trace") -> list[str]:
    """Lines on the signals that are not known at all samples, by the signals that say so."""
    vouching: dict[str, list[str]] = {}
    for name in trace:
        if flag := trace.validity(name):
            vouching.setdefault(flag, []).append(printed.safe(name))
    no = {flag: trace.rows - int(trace.read(flag).sum()) for flag in vouching}
    return [
        f"{printed.safe(flag)} is no at {no[flag]} of {trace.rows} samples; not known there: "
        + ", ".join(names)
        for flag, names in vouching.items()
        if no[flag]
    ]


def _revolutions(count: str) -> str:
    return f"{count} revolution" + "s" * (count != "1")


def _print_verdicts(verdicts: "Sequence[Verdict]") -> None:
    """The verdicts as a table."""
    if not verdicts:
        say("no claims")
        return
    from .traces.verdict import HEADINGS

    rows = [verdict.row for verdict in verdicts]
    entries = []
    for word, claim, name, worst, bound, distance, error, place, note in rows:
        away = f" ({distance})" if distance != "-" else ""
        away += f", error {error}" if error != "-" else ""
        at = f", at {place}" if place != "-" else ""
        entry = f"{word}  {claim}", f"({name})", f"{worst}, bound {bound}{away}{at}"
        entries.append((*entry, f"({note})") if note else entry)
    printed.show(HEADINGS, rows, entries)


COMMANDS = {
    "run": _run,
    "export": _export,
    "sweep": _sweep,
    "limit": _limit,
    "tolerances": _tolerances,
    "optimize": _optimize,
    "fit": _fit,
    "build": _build,
    "list": _list,
    "init": _init,
    "new": _new,
    "show": _show,
    "report": _report,
    "page": _page,
    "diagram": _diagram,
    "plot": _plot,
    "compare": _compare,
    "cache": _cache,
    "validate": _validate,
}


if __name__ == "__main__":
    sys.exit(main())
