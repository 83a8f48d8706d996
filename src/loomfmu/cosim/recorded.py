"""The trace of a run: where it may be written, its blocks, its verdicts and its final name."""

import os
import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime
from pathlib import Path

from ..declaring.variables import ALONE
from ..display import printed
from ..display.progress import progress as progress_bar
from ..errors import LoomfmuError, why
from ..files import LONGEST_STEM, cannot_write, check_target, digest, short_stem
from ..traces import PARTIAL, TRACE, Channel, Early, Trace, TraceWriter, Verdict, partial_of
from ..traces.disk import check_room, largest, size_text
from ..traces.places import abandoned
from .master.master import Interrupted
from .planning.plan import Plan
from .provenance import groups, scene_file, texts
from .scenes.scene import Scene, files_of

LONG_RUN = 20_000  # steps from which a progress bar is shown
LARGE_TRACE = 300_000_000  # bytes from which its size is reported before the run
UNSAFE = re.compile(r"[^A-Za-z0-9_.,=+-]")  # in the name of a file, on any system and in a shell
LONGEST = 80  # characters of the values in the name of a file


def usual_path(scene: Scene, ending: str = ".h5") -> Path:
    """Return the default path of a scene's results; each set of changed values has its own.

    Such as `results/wl680_3600_shaft.speed=700rpm.h5`. Names and values that are too long end with a digest.
    """
    given = ",".join(f"{key}={value}" for key, value in sorted(texts(scene.overrides).items()))
    plain = re.sub(r"(?<=\d)\s+(?=[^\s\d])", "", given)  # between a number and its unit
    shown = UNSAFE.sub("-", re.sub(r"\s", "", plain))[:LONGEST]
    if shown != plain:
        shown += f"-{digest(given)}"
    name = short_stem(scene.name, LONGEST_STEM - len(shown) - 1)
    return Path("results") / f"{name}{shown and '_'}{shown}{ending}"


def own_path(scene: Scene, report: bool) -> Path:
    """Return the default path of a scene's trace.

    Where the trace of another scene has it, a digest of the path of this scene keeps them apart; with
    `report`, a line says so.
    """
    path = usual_path(scene)
    ours = scene_file(scene, path.parent)
    try:
        with Trace(path) as trace:
            theirs = str(trace.attributes.get("scene_file", ours))
    except (LoomfmuError, OSError):  # there is none, or a file of another kind
        return path
    if theirs == ours:
        return path
    own = path.with_stem(f"{path.stem}-{digest(ours)}")
    if report:
        other = f", {os.path.normpath(path.parent / theirs)}" if theirs else ""
        printed.complain(f"{path}: it is the trace of another scene{other}; the new one is {own}")
    return own


def written_at(path: Path) -> str:
    """Return when a file was written, such as 2026-03-01 14:05:09, or an empty text if there is none."""
    try:
        return str(datetime.fromtimestamp(int(path.stat().st_mtime)))
    except OSError:
        return ""


@contextmanager
def kept_readable(writer: TraceWriter, path: Path) -> Iterator[None]:
    """Whatever ends the run early: what was written stays readable, and the message says where it is."""
    try:
        yield
    except Interrupted:
        kept = path.with_name(writer.abandon("interrupted").name)
        raise KeyboardInterrupt(f"interrupted; {writer.rows} samples are in {kept}") from None
    except OSError as error:
        kept = path.with_name(writer.abandon("failed").name)
        raise LoomfmuError(f"{path}: cannot be written ({why(error)}); see {kept}") from None
    except BaseException:
        writer.abandon("failed")
        raise


def finish(
    judge: Callable[[Trace], tuple[Verdict, ...]], writer: TraceWriter, path: Path, early: Early
) -> tuple[tuple[Verdict, ...], Trace]:
    """Judge the trace, store the verdicts with it and give it its final name.

    `early` is how an FMU ended the run early, if one did.
    """
    try:
        writer.seal()
        with Trace(writer.partial) as trace:
            trace.rows = writer.rows  # asking every signal of the file takes its time
            trace.cut_short = early.cut_short
            verdicts = judge(trace)
        return verdicts, writer.complete([verdict.as_dict() for verdict in verdicts], early)
    except OSError as error:
        raise cannot_write(path, error) from None
    except LoomfmuError as error:
        kept = path.with_name(writer.abandon("unjudged").name)
        raise LoomfmuError(f"{error}; the trace is kept in {kept}") from None


def target_of(plan: Plan, path: Path, overwrite: bool, report: bool) -> Path:
    """The absolute path of the trace, since an FMU may change the working directory.

    Refuses, before the run, a trace that may not be written there or does not fit, and reports a large one.
    """
    inputs = files_of(plan.scene)
    check_target(path, TRACE, inputs, overwrite)
    check_target(partial_of(path), PARTIAL, inputs, overwrite)
    size = largest(plan.grid.steps + 1, len(plan.signals) + len(plan.scene.connectors))
    if report and size > LARGE_TRACE:
        printed.complain(f"{path}: the trace takes up to {size_text(size)}; record = [...] keeps less")
    interrupted = [partial_of(path)] if partial_of(path).exists() else []
    for left in (*interrupted, *abandoned(path)) if report else ():
        how = "an interrupted run" if left in interrupted else "a killed process"
        printed.complain(f"{left}: left by {how}; deleted when this run is complete")
    try:
        check_room(path, size)
        return path.absolute()
    except OSError as error:
        raise cannot_write(path, error) from None


def writer_of(
    plan: Plan, channels: list[Channel], path: Path, target: Path, about: dict[str, str | float]
) -> TraceWriter:
    """Return a writer of the trace, with the file begun; `about` are the attributes of the run.

    A connector of a package's system is written as the signal that it is.
    """
    signals = {channel.signal: channel for channel in channels}
    named = [
        replace(signals[signal], instance=owner, variable=name, rate=None, beside=ALONE)
        for (owner, _, name), signal in (
            (each.partition("."), signal) for each, signal in plan.scene.connectors.items()
        )
        if signal in signals
    ]
    try:
        return TraceWriter(target, about, [*channels, *named], groups(plan), plan.grid.steps + 1)
    except OSError as error:
        raise cannot_write(path, error) from None


@contextmanager
def progress_of(plan: Plan, wanted: bool) -> Iterator[Callable[[int], None]]:
    """A progress bar for a long run; call it with the number of steps done."""
    shown = 0

    def reached(step: int) -> None:
        nonlocal shown
        advance(step - shown)
        shown = step

    long = plan.grid.steps >= LONG_RUN
    with progress_bar(plan.scene.name, plan.grid.steps, wanted=wanted and long) as advance:
        yield reached
