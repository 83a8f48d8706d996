"""The best designs found: as data, and in words."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from ... import units
from ...cosim.claims.claims import called
from ...display import notebook
from ...display.printed import brief, digits
from ...errors import listed
from ...sweeps.varied import Value
from ...traces import Verdict
from .binding import Limit
from .study import Goal, Study

HEADINGS = ("", "best", "range", "")
CLAIMS = ("verdict", "claim", "worst", "bound", "distance", "")


@dataclass(frozen=True)
class Best:
    """A best design: the values (SI) of what varies by their keys, its goals, and the verdicts on its claims.

    `errors` are the numerical ones of its goals; `indifferent` has the ranges of values in which it is as
    good, each alone. `limits` are what keeps it from being better: claims that are as near to their bounds as
    they may be, and values that are at an end of their range. `scene` is the file that has it.
    """

    values: dict[str, Value]
    goals: tuple[float, ...]
    errors: tuple[float, ...]
    verdicts: tuple[Verdict, ...]
    limits: tuple[Limit, ...]
    indifferent: dict[str, tuple[float, float]]
    scene: Path

    @property
    def binding(self) -> tuple[str, ...]:
        """The names of what keeps it from being better."""
        return tuple(each.name for each in self.limits)


@dataclass(frozen=True, repr=False)
class Optimum:
    """The best designs of a study: one, or several goals' front; true if there is one. A search, not a proof.

    `front` has them in the order of the first goal. `runs` counts the designs that were tried, `ran` those
    that were run now and not before, `allowed` those that meet all claims; `failed` says why others could not
    be run; `nowhere` says which claims no design meets, or from which none keeps the safety distance;
    `constant` are goals that are the same in all designs. Values are in SI.
    """

    study: Study = field(repr=False)
    front: tuple[Best, ...]
    runs: int
    ran: int
    allowed: int
    failed: tuple[str, ...]
    nowhere: tuple[str, ...]
    constant: tuple[str, ...]
    path: Path
    picture: Path | None
    warnings: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.front)

    @property
    def holds(self) -> bool:
        """Return whether there is a best design, and in each of them all claims hold that must.

        The search goes up to the bounds, so a claim that binds may be undecided there.
        """
        required = self.study.required
        return bool(self.front) and all(
            verdict or not needed
            for best in self.front
            for verdict, needed in zip(best.verdicts, required, strict=True)
        )

    @property
    def values(self) -> dict[str, Value]:
        """Those of the first design, by their keys; empty without one."""
        return self.front[0].values if self.front else {}

    @property
    def goal(self) -> float:
        """The first goal of the first design; NaN without one."""
        return self.front[0].goals[0] if self.front else math.nan

    @property
    def verdicts(self) -> tuple[Verdict, ...]:
        """Those on the first design."""
        return self.front[0].verdicts if self.front else ()

    @property
    def binding(self) -> tuple[str, ...]:
        """The limits that bind the first design."""
        return self.front[0].binding if self.front else ()

    @property
    def scene(self) -> Path | None:
        """The file of the first design."""
        return self.front[0].scene if self.front else None

    def __str__(self) -> str:
        return " ".join(conclusion(self))

    def __repr__(self) -> str:
        return notebook.warned(f"<Optimum of {self.study.title}: {self}>", self.warnings)

    def _repr_html_(self) -> str:
        if len(self.study.goals) > 1:
            tables = [front_table(self)]
        else:
            tables = [table for best in self.front for table in best_tables(self, best)]
        shown = (notebook.table(*table) for table in tables)
        lines = map(notebook.line, conclusion(self))
        return notebook.block(self.study.title, *shown, *lines, warnings=self.warnings)


# ---- in words


def shown_goal(goal: Goal, best: Best, place: int) -> str:
    """A goal of a design with its unit."""
    if goal.kind == "claim":
        return best.verdicts[goal.place].shown_distance
    value, error = (
        each / units.unit(goal.display).factor for each in (best.goals[place], best.errors[place])
    )
    return _shown(goal, best.goals[place], digits(value, error))


def shown_error(goal: Goal, best: Best, place: int) -> str:
    """The numerical error of a goal with its unit; an empty text where it is a value that was chosen."""
    error = best.errors[place]
    if goal.kind == "variable":
        return ""
    if not math.isfinite(error):
        return "error unknown"
    shown = best.verdicts[goal.place].shown_error if goal.kind == "claim" else _shown(goal, error, 1)
    return f"error {shown}"


def _shown(goal: Goal, value: float, figures: int = 7) -> str:
    """A value of a goal with its unit."""
    unit = "" if goal.shown_unit == "1" else f" {goal.shown_unit}"
    return f"{brief(value / units.unit(goal.display).factor, figures)}{unit}"


def shown_gain(found: Optimum, best: Best, limit: Limit) -> str:
    """Return the gain from relaxing a limit by 1 %, in the goal's unit, or an empty text if unknown."""
    if not math.isfinite(limit.gain):
        return ""
    if not limit.gain > 0.0:
        return "nothing alone"
    (goal,), (value,) = found.study.goals, best.goals
    gain = -goal.sign * limit.gain * abs(value)
    text = best.verdicts[goal.place].shown(gain) if goal.kind == "claim" else _shown(goal, gain, 3)
    return f"about {text if text.startswith('-') else f'+{text}'}"


def _note(found: Optimum, best: Best, key: str | int) -> str:
    """Return a table's note on a variable, by its name, or on a claim, by its number."""
    if isinstance(key, int) and not found.study.required[key]:
        return "may fail"
    for limit in best.limits:
        if key == (limit.name if limit.claim is None else limit.claim):
            gain, way = shown_gain(found, best, limit), "wider" if limit.claim is None else "looser"
            return f"binds; 1 % {way}: {gain}" if gain else "binds"
    if key in best.indifferent:
        varied = {each.key: each.varied for each in found.study.variables}[str(key)]
        return f"indifferent from {' to '.join(map(varied.show, best.indifferent[str(key)]))}"
    return ""


Table = tuple[tuple[str, ...], list[tuple[str, ...]]]  # headings and rows


def best_tables(found: Optimum, best: Best) -> tuple[Table, Table]:
    """The goals and variables of a design, and its claims."""
    return (HEADINGS, value_rows(found, best)), (CLAIMS, _claim_rows(found, best))


def value_rows(found: Optimum, best: Best) -> list[tuple[str, ...]]:
    """A row for each goal and each variable, below `HEADINGS`."""
    rows: list[tuple[str, ...]] = []
    for place, goal in enumerate(found.study.goals):
        note = "; ".join(filter(None, ("goal", shown_error(goal, best, place))))
        rows.append((goal.words, shown_goal(goal, best, place), "", note))
    for each in found.study.variables:
        value = each.varied.show(best.values[each.key])
        rows.append((each.key, value, each.text, _note(found, best, each.key)))
    return rows


def _claim_rows(found: Optimum, best: Best) -> list[tuple[str, ...]]:
    """A row for each claim, below `CLAIMS`."""
    return [
        (
            each.word,
            each.claim,
            each.shown_worst,
            each.shown(each.bound),
            each.shown_distance,
            "; ".join(filter(None, (_case(found, each), _note(found, best, number)))),
        )
        for number, each in enumerate(best.verdicts)
    ]


def _case(found: Optimum, verdict: Verdict) -> str:
    """The case in which a claim is worst."""
    return verdict.note.partition(";")[0] if found.study.cases else ""


def front_table(found: Optimum) -> Table:
    """The designs of a front."""
    study = found.study
    goals = [goal.name for goal in study.goals]
    others = [each for each in study.variables if each.key not in goals]
    headings = (*(goal.words for goal in study.goals), *(each.key for each in others), "binding")
    rows = [
        (
            *(shown_goal(goal, best, place) for place, goal in enumerate(study.goals)),
            *(each.varied.show(best.values[each.key]) for each in others),
            ", ".join(best.binding) or "-",
        )
        for best in found.front
    ]
    return headings, rows


def conclusion(found: Optimum) -> Iterator[str]:
    """Yield the conclusion, in sentences."""
    if not found.front:
        yield f"None of the {found.runs} designs that were tried meets {found.study.wanted}."
        for claim in found.nowhere:
            yield f"No design {claim}."
    elif len(found.study.goals) == 1:
        (best,) = found.front
        goal = found.study.goals[0]
        error = shown_error(goal, best, 0)
        known = f" ({error})" if error else ""
        cases = len(found.study.cases)
        worst = f", in the worst of {cases} cases" if cases else ""
        yield f"{goal.words[0].upper()}{goal.words[1:]}: {shown_goal(goal, best, 0)}{known}{worst}."
        if best.limits:
            yield f"It is limited by {' and '.join(map(_in_words, best.limits))}."
            yield from _gains(found, best)
        elif not found.constant and found.study.continuous:
            beside = "; designs that cannot be run may" if found.failed else ""
            yield f"No claim and no end of a range limits it{beside}."
    else:
        count = len(found.front)
        yield (
            f"{count} designs of which none is better than another in all goals."
            if count > 1
            else "One design is best in all goals."
        )
    for name in found.constant:
        yield f"The goal '{name}' is the same in all designs: nothing that varies changes it."
    longer = {each.claim: each.unsettled for best in found.front for each in best.verdicts if each.unsettled}
    yield from (f"'{claim}' is {unsettled}." for claim, unsettled in longer.items())
    undecided = _undecided(found)
    near = {name: each for name, each in undecided.items() if math.isfinite(each.error)}
    yield from (f"Undecided: '{name}' ({undecided[name].note})." for name in undecided if name not in near)
    if near:
        names = listed([f"'{name}'" for name in near])
        shares = (each.error / abs(each.bound or each.worst or 1.0) for each in near.values())
        share = 2.0 * max(shares)  # the error may be another one there
        shared = all(each.bound for each in near.values())
        keeps = f'safety = "{100.0 * share:.1g} %"' if shared else "a distance for each in [safety]"
        yield (
            f"Nearer to the bound than the numerical error, so undecided: {names};"
            f" {keeps} in the study keeps off it."
        )
    if found.failed:
        reason, others = found.failed[0], len(set(found.failed)) - 1
        more = f", and {others} other reason{'s' * (others > 1)}" if others else ""
        yield f"{len(found.failed)} of {found.runs} designs could not be run ({reason}{more})."


def _in_words(limit: Limit, of: str = "the end of the range of ") -> str:
    return f"{of}{limit.name}" if limit.claim is None else f"'{limit.name}'"


def _gains(found: Optimum, best: Best) -> Iterator[str]:
    """Yield the gain from relaxing each limit, in a sentence."""
    gains = [(_in_words(each, "the range of "), shown_gain(found, best, each)) for each in best.limits]
    if known := [f"{name} is worth {gain}" for name, gain in gains if gain]:
        yield f"Relaxed by 1 %, {listed(known)}."


def _undecided(found: Optimum) -> dict[str, Verdict]:
    """Return the claims that are undecided in a best design, each with its verdict of the largest error."""
    worst: dict[str, Verdict] = {}
    for best in found.front:
        verdicts = zip(found.study.scene.claims, best.verdicts, found.study.required, strict=True)
        for claim, each, needed in verdicts:
            if needed and not each.decided:
                name = called(claim, each)
                worst[name] = max(worst.get(name, each), each, key=lambda verdict: verdict.error)
    return worst
