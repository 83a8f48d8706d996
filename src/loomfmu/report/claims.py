"""The verdict at a glance, then each claim with how far it is from its bound, and where."""

from ..traces import Trace, Verdict
from ..traces.verdict import FAILS, UNDECIDED
from ..traces.verdict import outcome as counted
from .section import Section, Subject, labels
from .templates import template


def section(subject: Subject) -> Section:
    """The claims of every trace: first all outcomes, then all tables."""
    several = len(subject.traces) > 1
    runs = [
        {
            "label": label if several else "",
            "outcome": outcome(trace.verdicts, trace.judged),
            "word": _word(trace),
            "rows": [(each, _distance(each), subject.position(each)) for each in trace.verdicts],
        }
        for label, trace in zip(labels(subject.traces), subject.traces, strict=True)
    ]
    html = template("claims.html.j2").render(runs=runs)
    return Section("claims", "Claims", html, ("claims.js",), of_first=False)


def _word(trace: Trace) -> str:
    """Return the mark of a trace by its verdicts."""
    words = {verdict.word for verdict in trace.verdicts} if trace.judged else set()
    return "fails" if FAILS in words else "unknown" if UNDECIDED in words or not words else "holds"


def outcome(verdicts: list[Verdict], judged: bool) -> str:
    """The verdict on the run, in a few words."""
    if not judged:
        return "Not judged: the run did not get to its end"
    if not verdicts:
        return "No claims"
    if not all(verdicts):
        return counted(verdicts)
    return "The claim holds" if len(verdicts) == 1 else f"All {len(verdicts)} claims hold"


def _distance(verdict: Verdict) -> str:
    """Return the distance of the worst value from the bound, negative beyond it, also as a share of it."""
    text = verdict.shown(verdict.distance)
    if text == "no value" or not verdict.bound:
        return text
    return f"{text} ({verdict.relative_distance:+.1%})"
