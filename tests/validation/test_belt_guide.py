"""The length factor of a guide with free play: against an integration of the belt, and its ends."""

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from loomfmu.validation.belt_guide import (
    ALLOWED,
    CLAMPED,
    PLACES,
    deflection,
    length_factor,
    length_factor_in_motion,
)


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
