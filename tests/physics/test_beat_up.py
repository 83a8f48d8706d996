"""Beat-up: the balance of forces at the fell, by a root search, and the work that a pick takes."""

from math import log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq

from loomfmu.physics.beat_up import fell_displacement, weaving_resistance

LEAST, REACH = 0.3e-3, 2e-3
spacings = st.floats(0.31e-3, 1.9e-3)
resistances, stiffnesses = st.floats(1e-3, 10.0), st.floats(1e3, 1e7)


@given(resistances, stiffnesses, spacings, st.floats(0.0, 0.05))
def test_the_fell_is_where_both_springs_and_the_pick_are_in_balance(resistance, stiffness, spacing, behind):
    farthest = weaving_resistance(spacing, resistance, LEAST, REACH) / stiffness
    rest = spacing + behind - farthest - LEAST  # of the pick beyond the least spacing, with the fell at rest

    def excess(pressed):
        """Force of the springs less the resistance, for a pick that far beyond the least spacing."""
        return stiffness * (pressed - rest) - weaving_resistance(LEAST + pressed, resistance, LEAST, REACH)

    found, _slope = fell_displacement(behind, False, resistance, stiffness, LEAST, spacing, REACH)
    wanted = 0.0
    if rest < REACH - LEAST:
        low = resistance / (stiffness * (farthest + REACH) + 2.0 * resistance / LEAST)
        wanted = brentq(excess, min(low, 1e-12), REACH - LEAST, xtol=1e-18, rtol=1e-14) - rest
    # the reference subtracts lengths of up to 1 m
    assert found == pytest.approx(wanted, abs=1e-15 * (1.0 + abs(rest)) * 4.0, rel=1e-9)


@given(resistances, stiffnesses, spacings)
def test_a_pick_takes_the_work_of_its_resistance(resistance, stiffness, spacing):
    parameters = resistance, stiffness, LEAST, spacing, REACH
    farthest, _slope = fell_displacement(0.0, False, *parameters)
    assert farthest == pytest.approx(
        weaving_resistance(spacing, resistance, LEAST, REACH) / stiffness, rel=1e-9
    )
    touches = farthest + REACH - spacing  # behind the front limit

    def work(back, end):
        def part(u):  # most of it close to the front
            return 3.0 * u * u * end * fell_displacement(end * u**3, back, *parameters)[0]

        return stiffness * quad(part, 0.0, 1.0, epsrel=1e-11, limit=200)[0]

    given, returned = work(False, touches), work(True, farthest)
    assert returned == pytest.approx(0.5 * stiffness * farthest**2, rel=1e-9)
    clear, left = REACH - LEAST, spacing - LEAST
    taken = resistance * (log(clear / left) - (clear - left) / clear)
    # what the springs store and give back is the larger part where they are soft
    assert given - returned == pytest.approx(taken, rel=1e-5, abs=1e-7 * returned)


def test_the_force_is_continuous_where_the_pick_touches_and_at_the_front():
    parameters = 0.2, 5e5, LEAST, 0.5e-3, REACH
    places = np.linspace(0.0, 5e-3, 200001)
    forth, back = (
        np.array([fell_displacement(place, way, *parameters) for place in places]) for way in (False, True)
    )
    for moved, slope in (forth.T, back.T):  # the slope is that of the displacement, but for its corners
        assert np.median(np.abs(np.gradient(moved, -places) - slope)) < 1e-7
    forth, back = forth[:, 0], back[:, 0]
    assert forth[0] == pytest.approx(back[0], rel=1e-12)
    # no more than the springs' slope over a part of the way
    assert max(np.abs(np.diff(forth)).max(), np.abs(np.diff(back)).max()) <= (places[1] - places[0]) * 1.001
    assert forth[-1] == back[-1] == 0.0
