"""The length factor of a guide with free play: against an integration of the belt, and its ends."""

import numpy as np
import pytest
from belt_guide_reference import (
    ALLOWED,
    CLAMPED,
    PLACES,
    deflection,
    guide_for,
    length_factor,
    length_factor_in_motion,
    measured,
    sprung_factor,
)
from belt_reference import FiniteElements
from scipy.integrate import solve_bvp
from scipy.linalg import eigh
from validation.computed import belt_guide


@pytest.mark.parametrize("turn", [3.2, 3.8, 4.3])
def test_the_deflection_is_that_of_the_beam_equation(turn):
    clearance, guide, length = 0.5e-3, 0.05, 0.414

    def beam(_x, w):  # in millimetres over the share of the length
        return np.vstack([w[1], w[2], w[3], -turn * turn * w[2]])

    def ends(at_guide, at_head):
        slope = 1e3 * clearance / guide * length
        return np.array([at_guide[0] - 500.0 * clearance, at_guide[1] - slope, at_head[0], at_head[2]])

    x = np.linspace(0.0, 1.0, 81)
    found = solve_bvp(beam, ends, x, np.zeros((4, x.size)), tol=1e-8)
    assert found.success
    expected = 1e-3 * np.abs(found.sol(PLACES)[0]).max()
    assert deflection(turn, clearance, guide, length) == pytest.approx(expected, rel=1e-8)


def test_the_ends_of_the_table():
    assert pytest.approx(4.4934095, abs=1e-7) == CLAMPED  # tan x = x
    assert length_factor(0.0, 0.05, 0.414) == pytest.approx(0.6992, abs=1e-4)
    # hardly any play, and so much that the belt is bent by 2 mm before it leans on both walls
    assert length_factor(1e-7, 0.05, 0.414) == pytest.approx(0.6992, abs=2e-4)
    assert length_factor(1e-3, 0.05, 0.414) == 1.0
    assert deflection(np.pi, 1e-3, 0.05, 0.414) > ALLOWED


def test_it_grows_with_the_clearance():
    found = [length_factor(1e-5 * n, 0.05, 0.414) for n in range(100)]
    assert found == sorted(found)


@pytest.mark.parametrize("case", [(0.3e-3, 0.05, 0.414), (0.5e-3, 0.1, 0.665)])
def test_a_belt_in_motion_has_the_factor_of_statics_under_a_slow_load(case):
    # 2 mm of 414 mm: slopes of 1 % change loads by 1e-4, and the factor by half of it
    assert length_factor_in_motion(*case) == pytest.approx(length_factor(*case), rel=1e-4)


@pytest.mark.parametrize(
    ("clearance", "length", "range_"),
    [  # (8) with the load of Table 2 half a newton up and down
        ("0.30", 0.414, (0.800, 0.818)),
        ("0.30", 0.665, (0.766, 0.810)),
        ("0.50", 0.414, (0.882, 0.907)),
        ("0.50", 0.665, (0.863, 0.926)),
    ],
)
def test_what_was_measured(clearance, length, range_):
    assert measured(f"c_{clearance}", length) == pytest.approx(range_, abs=5e-4)  # digits of the table


def test_no_guide_fits():
    def guides(clearance, length):
        low, high = measured(f"c_{clearance}", length)
        return tuple(guide_for(mu, 1e-3 * float(clearance), length) for mu in (high, low))

    for clearance in ("0.30", "0.50"):  # the shortest and the longest belt require different guides
        assert guides(clearance, 0.414)[1] < guides(clearance, 0.665)[0]
    found = [guides(clearance, 0.414) for clearance in ("0.30", "0.50", "0.75")]  # and so do these clearances
    assert found[0][1] < found[1][0] and found[1][1] < found[2][0]
    shortest, longest = found[1]
    for guide in (shortest, longest):
        low, high = measured("c_0.50", 0.414)
        assert low - 1e-9 < length_factor(0.5e-3, guide, 0.414) < high + 1e-9


@pytest.mark.parametrize("stiffness", [1e-6, 0.5, 2.8, 1e6])
def test_a_spring_in_the_guide_holds_a_belt_as_finite_elements_say(stiffness):
    length = 0.414
    elements = FiniteElements(
        lambda _t: (length, 0.0, 0.0), lambda x, _l: 0.0 * x, stiffness=0.25, elements=20
    )
    bending, squeezed = elements.matrices(length)
    bending[0, 0] += stiffness / length**3  # the first node is the slope at the guide times the length
    load = eigh(bending, squeezed, eigvals_only=True)[0]
    assert sprung_factor(stiffness, length) == pytest.approx(np.pi / length * np.sqrt(0.25 / load), rel=1e-5)


@pytest.mark.parametrize("way", ["deflection", "shape"])
def test_no_guide_fits_the_measured_loads_better_than_the_one_in_the_report(way):
    best = belt_guide.guide(way)

    def off(guide):
        loads = [(column, each) for column in belt_guide.COLUMNS for each in belt_guide.LENGTHS]
        return sum(belt_guide.beyond(belt_guide.with_play(way, guide, *case), *case) ** 2 for case in loads)

    assert off(best) <= min(off(guide) for guide in np.linspace(0.02, 0.1, 41)) + 1e-9
