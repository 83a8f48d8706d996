"""The report as one HTML file: its sections in their order, with style and scripts inline."""

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from ..errors import LoomfmuError
from ..files import check_target, short_stem, starts_with, write_file
from ..traces import Comparison, Trace
from .claims import outcomes
from .claims import section as claims
from .diagram import section as diagram
from .drawings import sections as drawings
from .plots import section as plots
from .provenance import section as provenance
from .section import Section, Subject, embedded, labels, spread
from .templates import template, text

MARK = "<!DOCTYPE html>\n<!-- a report of loomfmu -->\n"
PRINT = ", and print the page to PDF in a browser"
REPORT = starts_with("a report of loomfmu", MARK.encode(), suffix=".html", advice=PRINT)
CURSOR_POINTS = 2000  # between which the cursor's time is interpolated


def write(
    traces: Sequence[str | Path | Trace],
    output: str | Path | None = None,
    overwrite: bool = False,
    comparison: Comparison | None = None,
) -> Path:
    """Write the report of a trace, with others laid over it, and return its path.

    Args:
        traces: traces or their files; that with the worst claim is shown in motion
        output: the file; by default beside the first trace, with `.html` for `.h5`, and named after all of
            several, such as `worn_and_new.html`
        overwrite: also replace a file that is not a report
        comparison: what differs between two of them, shown first

    Raises:
        LoomfmuError: a trace cannot be read or has no sample, the file cannot be written, or the extra
            `report` is not installed
    """
    opened = [each if isinstance(each, Trace) else Trace(each) for each in traces]
    if not opened:
        raise LoomfmuError("a report needs a trace: name at least one")
    for trace in opened:
        if not trace.rows:
            raise LoomfmuError(f"{trace.given}: the trace has no samples, so there is nothing to show")
    given = [each.path if isinstance(each, Trace) else Path(each) for each in traces]
    name = short_stem("_and_".join(each.stem for each in given))
    path = Path(output) if output is not None else given[0].with_name(f"{name}.html")
    inputs = [trace.path for trace in opened]
    check_target(path, REPORT, inputs, overwrite)
    with ExitStack() as files:
        for trace in opened:
            files.enter_context(trace)
        content = page(Subject(opened), comparison).encode()
    return write_file(path, content, REPORT, inputs, overwrite)


def page(subject: Subject, comparison: Comparison | None = None) -> str:
    """The whole page. Raises LoomfmuError if the extra `report` is not installed."""
    compared = [] if comparison is None else [_compared(comparison)]
    return assembled(subject, [*compared, *sections(subject)])


def _compared(comparison: Comparison) -> Section:
    """Return the differences between the traces, as a notebook shows them."""
    return Section("comparison", "Comparison", comparison._repr_html_(), of_one=False)


def sections(subject: Subject) -> list[Section]:
    """Return the sections that are not empty, in their order: the whole loom first, its details later."""
    drawn = {each.name: each for each in drawings(subject)}
    whole, details = drawn.get("loom"), drawn.get("motion")
    made = (whole, claims(subject), diagram(subject), details, plots(subject), provenance(subject))
    return [section for section in made if section]


def assembled(
    subject: Subject, sections: Sequence[Section], mark: str = MARK, policy: str = "", heading: str = ""
) -> str:
    """A page of some sections below a heading, by default those of the traces.

    `policy` is what its scripts may do beside running inline.
    """
    trace, several = subject.trace, len(subject.traces) > 1
    runs = [
        {
            "heading": (f"{judged['label']}: " if several else "") + (heading or each.heading),
            "origin": each.origin,
        }
        | judged
        for judged, each in zip(outcomes(subject), subject.traces, strict=True)
    ]
    body: str = template("page.html.j2").render(
        runs=runs,
        software=str(trace.attributes["software"]),
        sections=sections,
        one=_one(subject) if several else "",
        policy=policy,
        style="\n".join([text("style.css"), *(section.style for section in sections)]),
        cursor=text("cursor.js"),
        axis=embedded(_axis(subject)),
    )
    return mark + body


def _one(subject: Subject) -> str:
    """Return which of several traces some sections are of."""
    which = "the trace with the worst claim" if subject.worst is not None else "the first trace"
    return f"Of {labels(subject.traces)[subject.shown]} alone, {which}. The plots show all traces."


def _axis(subject: Subject) -> dict[str, Any]:
    """Return the axis of the cursor: a few positions with their times, and where it starts."""
    places = spread(len(subject.positions), CURSOR_POINTS)
    return {
        "turns": subject.turns,
        "positions": subject.positions[places],
        "times": subject.trace.time[places],
        "start": subject.start,
    }
