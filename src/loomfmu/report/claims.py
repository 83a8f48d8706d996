"""The verdict at a glance, then each claim with how far it is from its bound, and where."""

from typing import Any

from ..traces import Verdict
from ..traces.verdict import FAILS, UNDECIDED
from ..traces.verdict import outcome as counted
from .section import Section, Subject
from .templates import template


def section(subject: Subject) -> Section:
    """The claims of the first trace."""
    trace = subject.trace
    verdicts = trace.verdicts
    words = {verdict.word for verdict in verdicts} if trace.judged else set()
    return Section(
        "claims", "Claims",
        template("claims.html.j2").render(
            judged=trace.judged,
            outcome=_of_first(outcome(verdicts, trace.judged), subject),
            word="fails" if FAILS in words else "unknown" if UNDECIDED in words or not words else "holds",
            rows=[_row(subject, verdict) for verdict in verdicts],
        ),
        ("claims.js",),
    )  # fmt: skip


def _of_first(text: str, subject: Subject) -> str:
    """The verdict of the first trace, which says so where there are others."""
    return f"In the first trace: {text[0].lower()}{text[1:]}" if len(subject.traces) > 1 else text


def outcome(verdicts: list[Verdict], judged: bool) -> str:
    """The verdict on the run, in a few words."""
    if not judged:
        return "Not judged: the run did not get to its end"
    if not verdicts:
        return "No claims"
    if not all(verdicts):
        return counted(verdicts)
    return "The claim holds" if len(verdicts) == 1 else f"All {len(verdicts)} claims hold"


def _row(subject: Subject, verdict: Verdict) -> dict[str, Any]:
    return {
        "word": verdict.word,
        "mark": "fails" if verdict.word == FAILS else verdict.word,
        "claim": verdict.claim,
        "signal": verdict.signal,
        "worst": verdict.shown(verdict.worst),
        "bound": verdict.shown(verdict.bound),
        "distance": _distance(verdict),
        "error": verdict.shown_error,
        "place": verdict.place,
        "position": subject.position(verdict),
        "note": verdict.note,
    }


def _distance(verdict: Verdict) -> str:
    """How far the worst value is from the bound, negative beyond it, and its share of the bound."""
    text = verdict.shown(verdict.distance)
    if text == "no value" or not verdict.bound:
        return text
    return f"{text} ({verdict.relative_distance:+.1%})"
