"""Heald frame: motion from the rotor, turns and pegs."""

from math import cos, pi

import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference import MP

from loomfmu.physics.heald import lift_fraction, peg, slow_points_passed


@given(st.floats(-7.0, 7.0), st.floats(-60.0, 60.0), st.floats(-1e3, 1e3))
def test_rates_belong_to_the_lift(angle, velocity, acceleration):
    def lift(t):
        return (1 - MP.cos((angle + velocity * t + acceleration * t**2 / 2) / 2)) / 2

    exact = MP.taylor(lift, 0, 2)
    found = lift_fraction(angle, velocity, acceleration)
    # a few roundings of the terms: velocity 60, velocity^2 3600, acceleration 1000
    assert abs(found[0] - exact[0]) < 1e-15
    assert abs(found[1] - exact[1]) < 1e-14
    assert abs(found[2] - 2 * exact[2]) < 1e-12


@given(st.floats(-1e6, 1e6))
def test_slow_points_are_whole_turns(angle):
    turns = slow_points_passed(angle)
    # an angle of 1e6 is rounded to 1e-10
    assert -1e-9 <= angle - 2 * pi * turns <= 2 * pi + 1e-9
    assert cos(angle) == pytest.approx(cos(angle - 2 * pi * turns), abs=1e-9)


@given(st.integers(0, 65535))
def test_pegs_are_the_bits_of_the_word(word):
    assert sum(peg(word, pick) << pick for pick in range(16)) == word
