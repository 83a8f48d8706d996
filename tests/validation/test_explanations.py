"""The possible explanations of numbers that are not reproduced: they say what they claim, no more."""

import math

import pytest

from loomfmu.physics.belt_wrap import restraint_load
from loomfmu.validation import belt, warp, wrap


def test_another_idle_travel_gives_the_published_speeds_but_not_table_1():
    # with the published idle travel it is that of loom.safe_speed, which brackets by a grid instead
    speed, load, start = belt.with_idle_travel("WL450-4000", 0.356, 0.8)
    own = belt.safe("WL450-4000", "G6300 left", 0.8)
    assert speed == pytest.approx(belt.rpm(own), rel=1e-12)  # a minimum, found to 1e-12
    # the angle of a minimum is good to 1.5e-8, the root of rounding, and the load falls by 10 times that
    assert load == pytest.approx(own.critical_force, rel=1e-6)
    assert start == pytest.approx(own.window[0], abs=1e-12)
    for factor, rpm, newton in ((0.8, 475, 73), (0.9, 420, 57), (1.0, 378, 46)):
        speed, load, start = belt.with_idle_travel("WL450-4000", 0.386, factor)
        assert speed == pytest.approx(rpm, rel=0.005)
        assert load == pytest.approx(newton, rel=0.02)  # the report's own limit for calculations
        assert math.degrees(start) > 90.0  # published: 89


def test_clearance_errors_give_the_measured_loads():
    errors = wrap.clearance_errors()
    assert max(abs(error) for error in errors.values()) < 0.041  # mm
    # means of three loads that differ by a per cent: good to the square of that
    found = restraint_load(0.25, 0.430, 1e-3 * (0.1 + errors["430.0", "0.1"]))
    assert found == pytest.approx((50.68 + 50.62 + 50.82) / 3.0, rel=1e-4)


def test_offset_and_stiffness_give_the_measured_maxima():
    offset, stiffness = warp.fitted_to_maxima()
    assert warp.maxima(shed_offset=1e-3 * offset, thread_stiffness=stiffness) == pytest.approx(
        (76.6, 26.2), abs=1e-6
    )  # the solver's tolerance
    assert offset == pytest.approx(15.4, abs=0.05)
