"""The verdict at a glance, then each claim with how far it is from its bound, and where."""

from collections.abc import Sequence

from ..traces import Trace, Verdict
from ..traces.comparing import paired
from ..traces.verdict import FAILS, UNDECIDED
from ..traces.verdict import outcome as counted
from .section import Section, Subject, labels
from .templates import template


def outcomes(subject: Subject) -> list[dict[str, str]]:
    """The verdict on the run of each trace, with the label of the trace if there are several."""
    several = len(subject.traces) > 1
    return [
        {
            "label": label if several else "",
            "outcome": (holding if several else outcome)(trace.verdicts, trace.judged),
            "word": _word(trace),
        }
        for label, trace in zip(labels(subject.traces), subject.traces, strict=True)
    ]


def section(subject: Subject) -> Section | None:
    """The claims of every trace: one table with the verdicts side by side; None if there are none."""
    rows = [
        [each if each is None else (each, _distance(each), subject.position(each)) for each in row]
        for row in side_by_side([trace.verdicts for trace in subject.traces])
    ]
    if not rows:
        return None
    html = template("claims.html.j2").render(runs=outcomes(subject), rows=rows)
    return Section("claims", "Claims", html, ("claims.js",), of_one=False)


def side_by_side(runs: Sequence[Sequence[Verdict]]) -> list[list[Verdict | None]]:
    """Return a row for each claim: its verdict in each run, or None where a run does not have the claim."""
    rows: list[list[Verdict | None]] = []
    for number, verdicts in enumerate(runs):
        known = [next(each for each in row if each is not None) for row in rows]
        for place, (_, verdict) in enumerate(paired(known, verdicts)):
            if place == len(rows):
                rows.append([None] * number)
            rows[place].append(verdict)
    return rows


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


def holding(verdicts: list[Verdict], judged: bool) -> str:
    """The number of claims that hold, in a few words, to be read beside other runs."""
    if not judged or all(verdicts):
        return outcome(verdicts, judged).lower()
    return f"{sum(map(bool, verdicts))} of {len(verdicts)} claims hold"


def _distance(verdict: Verdict) -> str:
    """Return the distance of the worst value from the bound, negative beyond it, also as a share of it."""
    text = verdict.known(verdict.distance)
    if text == "no value" or not verdict.bound:
        return text
    return f"{text} ({100.0 * verdict.relative_distance:+.1f} %)"
