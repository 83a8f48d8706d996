"""What a search for the best design found: as data, and as the words in which people read it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from ... import notebook, units
from ...cosim.claims.claims import called
from ...errors import listed
from ...sweeps.varied import Value
from ...traces import Verdict
from .study import Goal, Study

HEADINGS = ("", "best", "may be", "")
CLAIMS = ("verdict", "claim", "worst", "bound", "distance", "")


@dataclass(frozen=True)
class Best:
    """A best design: the values (SI) of what varies by their keys, its goals, and the verdicts on its claims.

    `binding` names what keeps it from being better: claims that are as near to their bounds as they may be,
    and values that are at an end of their range. `scene` is the file that has it.
    """

    values: dict[str, Value]
    goals: tuple[float, ...]
    verdicts: tuple[Verdict, ...]
    binding: tuple[str, ...]
    scene: Path


@dataclass(frozen=True, repr=False)
class Optimum:
    """The best designs of a study: one, or several goals' front; true if there is one. A search, not a proof.

    `front` has them in the order of the first goal. `runs` counts the designs that were tried, `ran` those
    that were run now and not before, `allowed` those that meet all claims, `failed` those that could not be
    run; `nowhere` says which claims no design meets, or from which none keeps the safety distance; `constant`
    are goals that are the same in all designs. Values are in SI.
    """

    study: Study = field(repr=False)
    front: tuple[Best, ...]
    runs: int
    ran: int
    allowed: int
    failed: int
    nowhere: tuple[str, ...]
    constant: tuple[str, ...]
    path: Path
    picture: Path | None
    warnings: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.front)

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
        """What keeps the first design from being better."""
        return self.front[0].binding if self.front else ()

    @property
    def scene(self) -> Path | None:
        """The file of the first design."""
        return self.front[0].scene if self.front else None

    def __str__(self) -> str:
        return " ".join(conclusion(self))

    def __repr__(self) -> str:
        return f"<Optimum of {self.study.title}: {self}>"

    def _repr_html_(self) -> str:
        tables = [notebook.table(*front_table(self))] if len(self.study.goals) > 1 else []
        if len(self.study.goals) == 1 and self.front:
            (best,) = self.front
            tables = [
                notebook.table(HEADINGS, value_rows(self, best)),
                notebook.table(CLAIMS, claim_rows(self, best)),
            ]
        return notebook.block(self.study.title, *tables, *map(notebook.line, conclusion(self)))


# ---- in words


def shown_goal(goal: Goal, best: Best, place: int) -> str:
    """A goal of a design with its unit."""
    value = best.goals[place]
    if goal.kind == "claim":
        return best.verdicts[goal.place].shown_distance
    if goal.display != "1":
        return units.show(value, goal.display)
    return f"{value:.7g}" + ("" if goal.unit == "1" else f" {goal.unit}")


def value_rows(found: Optimum, best: Best) -> list[tuple[str, ...]]:
    """A row for each goal and each variable, below `HEADINGS`."""
    goals: list[tuple[str, ...]] = [
        (goal.words, shown_goal(goal, best, place), "", "goal")
        for place, goal in enumerate(found.study.goals)
    ]
    return goals + [
        (
            each.key, each.varied.show(best.values[each.key]), each.text,
            "binds" if each.range and each.key in best.binding else "",
        )
        for each in found.study.variables
    ]  # fmt: skip


def claim_rows(found: Optimum, best: Best) -> list[tuple[str, ...]]:
    """A row for each claim, below `CLAIMS`."""
    return [
        (
            each.word, each.claim, each.shown(each.worst), each.shown(each.bound), each.shown_distance,
            "binds" if called(claim, each) in best.binding else "",
        )
        for claim, each in zip(found.study.scene.claims, best.verdicts, strict=True)
    ]  # fmt: skip


def front_table(found: Optimum) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Headings and a row for each design of a front."""
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
    ]  # fmt: skip
    return headings, rows


def conclusion(found: Optimum) -> Iterator[str]:
    """What was found, in sentences."""
    if not found.front:
        yield f"None of the {found.runs} designs that were tried meets all claims."
        for claim in found.nowhere:
            yield f"No design {claim}."
    elif len(found.study.goals) == 1:
        (best,) = found.front
        goal = found.study.goals[0]
        yield f"{goal.words[0].upper()}{goal.words[1:]}: {shown_goal(goal, best, 0)}."
        keys = [each.key for each in found.study.variables]
        names = " and ".join(
            f"the end of the range of {each}" if each in keys else f"'{each}'" for each in best.binding
        )
        if names:
            yield f"It is limited by {names}."
        elif not found.constant and found.study.continuous:
            yield "No claim and no end of a range limits it."
    else:
        count = len(found.front)
        yield (
            f"{count} designs of which none is better than another in all goals."
            if count > 1
            else "One design is best in all goals."
        )
    for name in found.constant:
        yield f"The goal '{name}' is the same in all designs: nothing that varies changes it."
    if undecided := _undecided(found):
        names = listed([f"'{name}'" for name in undecided])
        share = 2.0 * max(undecided.values())  # the error may be another one there
        yield (
            f"Nearer to the bound than the numerical error, so undecided: {names};"
            f' safety = "{100.0 * share:.1g} %" in the study keeps off it.'
        )
    if found.failed:
        yield f"{found.failed} of {found.runs} designs could not be run."


def _undecided(found: Optimum) -> dict[str, float]:
    """The claims that are undecided in a best design, with their largest errors as shares of the bound."""
    errors: dict[str, float] = {}
    for best in found.front:
        for claim, each in zip(found.study.scene.claims, best.verdicts, strict=True):
            if not each.decided:
                name, share = called(claim, each), each.error / abs(each.bound or each.worst or 1.0)
                errors[name] = max(share, errors.get(name, 0.0))
    return errors
