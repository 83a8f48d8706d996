"""The possible explanations of the measured dwells, against a calculation of their own each."""

from math import degrees, pi

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from loomfmu.components.dobby.drive import DobbyDrive
from loomfmu.validation import dwells, rotor


def test_constant_low_speed_is_the_measured_dwell_at_small_reductions():
    uniform = degrees(rotor.drive("uniform").dwell_angle)
    for z, measured in ((0.3, 80.0), (0.4, 95.0)):
        assert uniform / (1.0 - z) == pytest.approx(measured, abs=1.3)  # deg: within 1.3 %


@pytest.mark.no_cover
@pytest.mark.parametrize("reduction", [0.3, 0.7])
def test_elastic_frame_against_an_integration(reduction):
    frequency, damping = 3.0, 0.1
    drive = DobbyDrive(law=3, speed_reduction=reduction, slow_point=0.0, speed=1.0)
    drive.initialize(0.0)

    def motion(x, state):
        drive.step(x, 0.0)
        pull = frequency**2 * (drive.lift_fraction - state[0])
        return state[1], pull - 2.0 * damping * frequency * state[1]

    # the start fades with exp(-d n x): to 1e-16 after 40 turns
    end = 40.0 * pi
    begun = solve_ivp(motion, (0.0, 4.0 * end), (0.0, 0.0), rtol=1e-10, atol=1e-12).y[:, -1]
    run = solve_ivp(motion, (0.0, 4.0 * pi), begun, rtol=1e-11, atol=1e-13, dense_output=True)
    top = float(run.sol(2.0 * pi)[0])

    def off(x):
        return abs(float(run.sol(x)[0]) - top) - rotor.TOLERANCE

    grid = np.linspace(0.0, pi, 2000)
    after = next(x for x in grid if off(2.0 * pi + x) > 0.0)
    before = next(x for x in grid if off(2.0 * pi - x) > 0.0)
    late = brentq(lambda x: off(2.0 * pi + x), after - grid[1], after)
    early = brentq(lambda x: off(2.0 * pi - x), before - grid[1], before)
    found = dict(zip(dwells.measured(), dwells.of_elasticity(frequency, damping), strict=True))[reduction]
    # lines between points 0.35 deg apart, on a curve that bends by 1 / turn^2: some 1e-2 deg at the flattest
    assert found == pytest.approx(degrees(late + early), abs=0.03)


def test_play_does_not_explain_the_dwells():
    assert dwells.rms(dwells.of_play(dwells.fitted_play())) > 9.0
    assert dwells.rms(dwells.of_plateau(90.0, 40.9)) < 2.1  # deg, with nothing fitted
