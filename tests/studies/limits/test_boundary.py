"""Limits over a second variable: each row is the limit with that value set."""

import math
from pathlib import Path

import pytest

from loomfmu import Boundary, LoomfmuError, limit
from loomfmu.design import loom as design

DEMO = Path(__file__).parents[3] / "sims" / "wl680_3600.toml"
ONE = {"revolutions": 2}


def boundary() -> Boundary:
    vary = ["shaft.speed=300rpm..900rpm", "belt.guide_clearance=0.2mm..0.8mm"]
    found = limit(DEMO, vary=vary, set=ONE, points=5, rows=3)
    assert isinstance(found, Boundary)
    return found


@pytest.mark.slow
def test_each_row_is_the_limit_at_a_value_of_the_second_variable() -> None:
    found = boundary()
    assert found and found.values == pytest.approx([0.2e-3, 0.5e-3, 0.8e-3], rel=1e-15)
    assert (found.values[0], found.values[-1]) == (0.2e-3, 0.8e-3)  # the ends are what was written
    for clearance, row in zip(found.values, found.rows, strict=True):
        safe = design.safe_speed("WL680-3600", clearance=clearance).speed
        (held,) = row.ranges
        assert held.high == pytest.approx(safe * math.sqrt(0.9), rel=1e-9)
        assert held.above == "the belt keeps a margin of 10 %"
        (speed,) = row.claims[1].limits
        assert speed.value == pytest.approx(safe, rel=1e-9)
    single = limit(
        DEMO, vary="shaft.speed=300rpm..900rpm", set=ONE | {"belt.guide_clearance": "0.5 mm"}, points=5
    )
    assert found.rows[1].ranges == single.ranges


def test_a_boundary_is_shown_as_a_table() -> None:
    found = boundary()
    assert repr(found) == (
        "<Boundary of WL680-3600, G6300 left, weave 10/01/10/01; revolutions = 2: shaft.speed at 3 values of"
        " belt.guide_clearance>"
    )
    html = found._repr_html_()
    assert "belt.guide_clearance [mm]" in html and "300 to 679.7492 rev/min" in html


def test_a_value_of_the_second_variable_that_cannot_be_run_is_named() -> None:
    with pytest.raises(LoomfmuError, match=r"^at heald\.stroke = 10 mm: .*claim 'clear_shed' of heald_1"):
        limit(DEMO, vary=["shaft.speed=300rpm..900rpm", "heald.stroke=10mm..98mm"], set=ONE, points=3, rows=2)
