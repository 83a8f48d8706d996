"""The condition that a claim states of all shaft angles says what the claim says of a run."""

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from scene_texts import claim, wires

import loomfmu
from loomfmu.cosim.claims.conditions import Condition, Sometime, Spans, Sum, names_of
from loomfmu.cosim.reading import requested
from loomfmu.cosim.scenes.scene import parse
from loomfmu.studies.proving.chain import Chain
from loomfmu.studies.proving.decisions import value_of

LOOM = """
revolutions = 2
steps_per_revolution = 1440
[loom]
machine = "WL680-3600"
both_rapiers = true
weave = "10/01/11/00"
reed = true
locks = true
[shaft]
speed = "600 rev/min"
"""
APART = 2e-3  # of a bound, from where the verdict changes: more than the angles looked at leave unseen
ANGLES = 7201


@pytest.mark.parametrize(
    ("bound", "table"),
    [
        ("bound", {"kind": "lowest_margin"}),
        ("bound", {"kind": "below", "signal": "weft.travel", "window": ["30 deg", "100 deg"]}),
        ("bound", {"kind": "above", "signal": "weft.travel", "window": ["60 deg", "150 deg"]}),
        ("bound", {"kind": "below", "signal": "abs(2 * heald_1.lift - heald_2.lift - 10 mm)"}),
        ("bound", {"kind": "above", "signal": "min(weft.travel, -3 * heald_1.lift)"}),
        ("at_least", {"kind": "dwell", "heald": "heald_1"}),
        ("at_least", {"kind": "clear_shed", "heald": "heald_1", "clearance": "6 mm"}),
        ("tolerance", {"kind": "dwell_contains", "heald": "heald_1", "angles": ["140 deg", "222 deg"]}),
        ("head_height", {"kind": "rapier_in_open_shed"}),
        ("head_height", {"kind": "rapier_in_open_shed", "healds": ["heald_3"]}),  # always above
        ("head_height", {"kind": "rapier_in_open_shed", "healds": ["heald_4"]}),  # always below
        ("clearance", {"kind": "reed_clear_of_rapier"}),
        ("at_most", {"kind": "transfer_speed"}),
        ("transfer.needed_overlap", {"kind": "transfer_in_time", "window": ["170 deg", "190 deg"]}),
    ],
    ids=lambda given: given["kind"] if isinstance(given, dict) else "",
)
def test_a_condition_holds_where_the_claim_does(bound: str, table: dict[str, Any]) -> None:
    first = _found(bound, table, 0.05)[1]
    verdicts = []
    for share in (1.0 - APART, 1.0 + APART):
        holds, _worst, conditions, chain = _found(bound, table, share * first)
        verdicts.append(holds)
        assert _hold(conditions, chain) == holds
    assert verdicts[0] != verdicts[1]


@pytest.mark.parametrize("fraction", [-5.0, 0.01, 5.0])
def test_a_lift_far_beyond_an_end_of_the_stroke_is_near_none(fraction: float) -> None:
    """It was proven to dwell where it stood at five strokes below the lower end."""
    cut = {f"heald_1__lift_{each}": False for each in ("fraction", "rate", "acceleration")}
    heald = (
        f"[heald_1]\nfollow_lift = true\nlift_fraction = {fraction}\nlift_rate = 0\n[wires]\n{wires(**cut)}"
    )
    text = LOOM + heald + claim("dwell_contains", heald="heald_1", angles=["140 deg"], tolerance=0.05)
    asked = requested(parse(text, "loom"), None, "native")
    conditions = asked.claims[0].conditions(asked)
    assert _hold(conditions, Chain(asked.scene, names_of(conditions), {})) == (fraction == 0.01)


def _found(bound: str, table: dict[str, Any], value: float) -> tuple[bool, float, Any, Chain]:
    """Whether a claim holds in a run with this bound, its worst value, its conditions, their mechanisms."""
    own = "." not in bound
    arguments = table | ({bound: value} if own else {})
    scene = parse(LOOM + claim(arguments.pop("kind"), **arguments), "loom")
    asked = requested(scene, None if own else {bound: value}, "native")
    (verdict,) = loomfmu.evaluate(asked.scene, errors="none").claims
    conditions = asked.claims[0].conditions(asked)
    return verdict.holds, verdict.worst, conditions, Chain(asked.scene, names_of(conditions), {})


def _hold(conditions: tuple[Condition, ...], chain: Chain) -> bool:
    @cache
    def numbers(span: tuple[float, float]) -> tuple[Any, Any]:
        boxes = np.repeat(np.linspace(*span, ANGLES)[:, None, None], 2, axis=2)
        return chain.numbers(boxes), boxes

    def values(form: Sum, span: tuple[float, float]) -> Any:
        found, boxes = numbers(span)
        return value_of(form, chain, found, boxes).middle.mean(axis=-1)

    return all(_holds(each, values, (0.0, 4.0 * math.pi)) for each in conditions)


def _holds(condition: Condition, values: Callable[..., Any], run: tuple[float, float]) -> bool:
    if isinstance(condition, Spans):
        return all(_shortest(values(form, run)) >= condition.at_least for form in condition.insides)
    spans = condition.ranges(*run)
    if isinstance(condition, Sometime):
        return all(values(condition.form, span).max() >= 0.0 for span in spans)
    highest = (np.max([values(form, span) for form in condition.any_of], axis=0) for span in spans)
    return all(each.min() >= 0.0 for each in highest)


def _shortest(values: Any) -> float:
    """The shortest span [rad] in which values are not negative, of those between the ends of the run."""
    changes = np.flatnonzero(np.diff((values >= 0.0).astype(int)))
    rising = [place for place in changes if values[place] < 0.0]
    falling = [place for place in changes if values[place] >= 0.0 and (rising and place > rising[0])]
    spans = [end - start for start, end in zip(rising, falling, strict=False)]
    return min(spans, default=math.inf) * 4.0 * math.pi / (ANGLES - 1)
