"""Limits proven: up to the limits that runs show, and no farther."""

import math

import pytest

import loomfmu
from loomfmu.cosim.scenes.scene import Scene
from loomfmu.design import loom as design
from loomfmu.errors import LoomfmuError
from loomfmu.studies.limits.limit_tables import show


def test_ranges_are_proven_up_to_the_closed_form_and_fail_beyond(
    loom: Scene, capsys: pytest.CaptureFixture[str]
) -> None:
    found = loomfmu.limit(loom, vary="shaft.speed=640rpm..660rpm", points=3, prove=True)
    margin, safe, *steady, count = found.claims
    # margin = 1 - (speed / safe speed)^2, as both are at the angle of the highest force
    closed = math.sqrt(0.9) * design.safe_speed("WL680-3600", clearance=0.3e-3).speed
    (part,) = margin.proven
    assert part.low == found.span.low
    # the bisection ends 1e-10 of the limit below it; the run's own limit is off by its steps, 1e-8 of it
    assert closed * (1.0 - 1e-8) < part.high < closed * (1.0 + 1e-12)
    assert closed < part.fails_above < closed * (1.0 + 1e-6)
    assert safe.proven and all(each.proven[0].high == found.span.high for each in steady)
    assert not count.proven and "depends on the run so far" in count.unproven
    show(found)
    said = capsys.readouterr().out
    assert "proven: margin, from 640 to 646.81644" in said and "it fails at 646.8164" in said
    assert "not proven: count (belt.buckled depends on the run so far)" in said


def test_the_ends_of_a_range_are_proven_to_their_last_digit(loom: Scene) -> None:
    found = loomfmu.limit(loom, vary="shaft.speed=500.00004rpm..510rpm", points=3, prove=True)
    assert "proven: safe speed, from 500.00004 to 510 rev/min" in " ".join(found._repr_html_().split())


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        ("shaft.start_angle=0deg..10deg", "all shaft angles are proven"),
        (["shaft.speed", "belt.guide_clearance=0.2mm..0.4mm"], "over one variable"),
    ],
)
def test_what_cannot_be_proven_over_is_refused(loom: Scene, vary: str | list[str], message: str) -> None:
    with pytest.raises(LoomfmuError, match=message):
        loomfmu.limit(loom, vary=vary, points=3, prove=True)
