"""The start of a search: the scene's own design, the claims' distances, the variables that matter."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ... import units
from ...errors import LoomfmuError, within
from ...sweeps.directory import Refused
from ...sweeps.varied import Value
from ...traces import Verdict
from .runs import Design, Limits, Point, Runs
from .study import Study, Variable

BASES = 8  # designs about which a variable must change something
SAME = 1e-12  # of a value: what changes less is the same


def own_point(study: Study) -> Point:
    """The scene's own design; where it is outside a range the nearer end, where unknown the first option."""
    return tuple(_own(study, each) for each in study.variables)


def _own(study: Study, variable: Variable) -> float:
    owner, _, name = variable.varied.targets[0].partition(".")
    instance = study.scene.instances.get(owner)
    port = instance.fmu.ports.get(instance.fmu.name_of(name)) if instance else None
    if instance is None or port is None:
        return 0.0
    value: Value = instance.values.get(port.name, port.start if port.start is not None else 0.0)
    if variable.range is not None:
        return variable.range.share(float(value))
    value = port.choice(float(value)) if port.choices else value
    return float(variable.options.index(value)) if value in variable.options else 0.0


def limits_of(study: Study, verdicts: Sequence[Verdict], path: Path) -> Limits:
    """Return the distances that claims must keep, in the units of the verdicts on the scene's own design.

    Raises LoomfmuError for an amount of another unit, or a share of a bound of 0.
    """
    amounts, scales = [], []
    for verdict, share, amount in zip(verdicts, study.shares, study.amounts, strict=True):
        with within(f"{path}: safety: {verdict.claim}"):
            amounts.append(units.parse(amount, verdict.unit) if amount else 0.0)
        if share and not verdict.bound:
            raise LoomfmuError(
                f"{path}: safety = {share:g} is a share of the bound, and that of {verdict.claim!r} is 0; in"
                f" [safety], give it a distance in {verdict.label}, or leave it out"
            )
        known = (abs(each) for each in (verdict.bound, verdict.worst) if math.isfinite(each))
        scales.append(next(filter(None, known), 1.0))
    return Limits(np.array(study.required), np.array(study.shares), np.array(amounts), np.array(scales))


def check_effects(runs: Runs, points: Sequence[Point], path: Path) -> None:
    """Refuse a variable that changes neither a goal nor a claim. Raises Refused."""
    left = dict(enumerate(runs.study.variables))
    for point in points[:BASES]:
        moved = [
            (place, (*point[:place], number, *point[place + 1 :]))
            for place, each in left.items()
            for number in (0.0, each.last)
        ]
        here, *others = runs.at([point, *(each for _place, each in moved)])
        for (place, _point), other in zip(moved, others, strict=True):
            if not _alike(here, other):
                left.pop(place, None)
        if not left:
            return
    tried = list(runs.designs.values())
    if all(each.error for each in tried):
        raise Refused(f"{path}: none of {len(tried)} designs that were tried can be run ({tried[0].error})")
    for each in left.values():
        raise Refused(
            f"{path}: {'ranges' if each.range else 'choices'}.{each.key} changes neither a goal nor a claim"
            f" ({each.text}); leave it out"
        )


def check_options(runs: Runs, points: Sequence[Point], path: Path) -> None:
    """Refuse a choice with which no design can be run, while others of its kind can. Raises Refused."""
    for place, each in enumerate(runs.study.variables):
        if each.range or isinstance(each.options, range):
            continue
        errors = [
            _error(runs, [(*point[:place], float(number), *point[place + 1 :]) for point in points[:BASES]])
            for number in range(len(each.options))
        ]
        for option, error in zip(each.options, errors, strict=True):
            if error and not all(errors):
                raise Refused(
                    f"{path}: choices.{each.key}: no design with {each.varied.show(option)} can be run"
                    f" ({error}); leave it out"
                )


def _error(runs: Runs, points: Sequence[Point]) -> str:
    """Return why none of these designs can be run, or an empty text if one can. Most often the first can."""
    (first,) = runs.at(points[:1])
    return first.error if first.error and all(each.error for each in runs.at(points)) else ""


def _alike(one: Design, other: Design) -> bool:
    if one.error or other.error:
        return bool(one.error and other.error) or one.values == other.values
    return all(
        np.allclose(a, b, rtol=SAME, atol=0.0, equal_nan=True)
        for a, b in ((one.heights, other.heights), (one.distances, other.distances), (one.room, other.room))
    )
