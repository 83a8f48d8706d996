"""The claims of a page: the rules as WebAssembly, and the question that each claim asks them."""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from ..cosim.claims.claim import Claim
from ..cosim.claims.judging import FIELDS, Form, Table, beside, number_of
from ..cosim.composed import Composed
from ..cosim.dependence import Dependence, Method
from ..cosim.estimates import coarseness, counts
from ..cosim.planning.requested import SHAFT_ANGLE, Requested
from ..cosim.scenes.scene import Scene
from ..cosim.standard import standard
from ..fmi.native.libraries import module_of
from ..fmi.native.sources import code_of
from ..traces import Trace, Verdict
from ..traces.plotting import curve_of

Proven = tuple[Mapping[int, str], Mapping[str, tuple[float, float]]]


def claims(
    scene: Scene, ends: Iterable[Scene], trace: Trace, verdicts: Sequence[Verdict], proven: Proven
) -> dict[str, Any]:
    """Return the data with which the script judges: the signals of the rules, and a row for each claim.

    Args:
        scene: the scene that is run
        ends: the scene with each value that is varied at either end of its range
        trace: the run that the page holds
        verdicts: those on that run
        proven: what to say of claims that are proven, by their numbers, and the ranges in SI, by keys
    """
    table, requested = Table(), Requested(scene)
    number_of(table, trace, SHAFT_ANGLE)
    dependence = Dependence(requested, requested.claims)
    unshown = [dependence.unshown(each) for each in ends]
    composed = Composed(requested, requested.claims)
    rated = composed.unrated
    left = [_not_live(each, rated & {*each.signals(requested)}) for each in requested.claims]
    sampled = [
        _on_samples(claim, method, verdict, trace) if number in composed.claims and not why else verdict
        for number, (claim, method, verdict, why) in enumerate(
            zip(requested.claims, dependence.methods, verdicts, left, strict=True)
        )
    ]
    asked = zip(requested.claims, dependence.methods, sampled, left, strict=True)
    rows = [
        _claim(claim, method, verdict, trace, table, why)
        | {"unshown": next((each[number] for each in unshown if number in each), "")}
        | {"counts": counts(trace, verdict), "proven": proven[0].get(number, "")}
        for number, (claim, method, verdict, why) in enumerate(asked)
    ]
    signals = [
        {"name": name, "about": trace.description(name), "beside": beside(table, name)} for name in table
    ]
    about = {"proven": proven[1], "fields": FIELDS, "signals": signals, "coarseness": coarseness(scene)}
    return {**about, "claims": rows}


def rules() -> bytes:
    """The rules as a module of WebAssembly. Raises LoomfmuError if it cannot be built."""
    source = standard().RULES
    return module_of(source.name, code_of(source))


def _on_samples(claim: Claim, method: Method, verdict: Verdict, trace: Trace) -> Verdict:
    """Return what the samples tell, as in a page, of a claim that the run judged by more than these."""
    found = claim.judge(trace)
    spread = method.factors[0] * abs(found.worst - verdict.worst)
    if not math.isfinite(spread):
        return found
    return claim.settled(trace, found, spread, method.floor, method.scatter, claim.noise)


def _not_live(claim: Claim, rated: Collection[str]) -> str:
    """Return why the page does not judge a claim; `rated` are signals whose rates the run computes."""
    return claim.not_live or "".join(f"the page does not compute the rate of {each}" for each in rated)


def _claim(
    claim: Claim, method: Method, verdict: Verdict, trace: Trace, table: Table, not_live: str
) -> dict[str, Any]:
    """Return one claim: its question, the forms of its verdict, the instances that it reads, its verdict.

    Of the numerical error the script has the part that differs between resolutions, `spread`, with what the
    run says of it: the rest it takes from the signals. It leaves out a claim that it would judge otherwise.
    """
    question, read = claim.question(trace), Table()
    forms = [_form(form, verdict, trace) for form in question.forms]
    if not_live:
        native = {"holds": verdict.holds, "decided": verdict.decided, "worst": verdict.worst}
        return {"not_live": not_live, "forms": forms, "parts": [], "noise": 0.0, "native": native}
    for name in (SHAFT_ANGLE, *question.signals, *(form.signal for form in question.forms)):
        number_of(read, trace, name)
    parameters = [each for each in question.numbers if isinstance(each, str)]
    remark = verdict.note.removeprefix(claim.judge(trace).note).removeprefix("; ")
    return {
        "question": question.written(trace, lambda signal: number_of(table, trace, signal)),
        "forms": forms,
        "parts": sorted({name.partition(".")[0] for name in (*read, *parameters)}),
        "words": question.words,
        "noise": claim.noise,
        "share": method.floor,
        "scatter": method.scatter,
        "native": {
            "holds": verdict.holds,
            "decided": verdict.decided,
            "worst": verdict.worst,
            "estimated": not math.isnan(verdict.spread),
            "spread": 0.0 if math.isnan(verdict.spread) else verdict.spread,
            "remark": remark.removesuffix(verdict.unsettled).removesuffix("; "),
            "unsettled": verdict.unsettled,
        },
    }


def _form(form: Form, verdict: Verdict, trace: Trace) -> dict[str, Any]:
    """Return the signal of a verdict, its sense, and the unit and factor of its values."""
    unit, display = form.unit
    shown = replace(verdict, unit=unit, display_unit=display)
    return {
        "signal": form.signal,
        "curve": curve_of(trace, form.signal),
        "sense": form.sense,
        "drawn": form.judges(trace),
        "factor": shown.displayed(1.0),
        "unit": "" if shown.label == "1" else shown.label,
    }
