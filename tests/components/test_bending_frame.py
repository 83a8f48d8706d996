"""A frame that bends, as a HealdDamper whose carrier never meets its stops: against a beam of many points."""

from math import pi

import numpy as np
import pytest

from loomfmu.components import HealdDamper

FIRST = 2.0 * pi * 48.41  # rad/s, the first mode
MASS, LENGTH, POINTS, DAMPING = 15.0, 3.6, 200, 0.02
BENDING = {
    "carrier_mass": 8.0 / pi**2 * MASS,
    "spring_stiffness": 8.0 / pi**2 * MASS * FIRST**2 / 4.0,
    "damping_ratio": DAMPING,
}


def beam(omega):
    """Bending in the middle and force on both ends, complex, of a beam whose ends swing with 1 m/s2.

    The equation of the beam itself by differences, with damping in proportion to its stiffness; no modes.
    """
    step = LENGTH / POINTS
    across = np.diag(np.full(POINTS - 1, -2.0)) + np.eye(POINTS - 1, k=1) + np.eye(POINTS - 1, k=-1)
    stiff = (FIRST * LENGTH**2 / pi**2) ** 2 * np.linalg.matrix_power(across / step**2, 2)
    system = stiff * (1.0 + 2j * DAMPING / FIRST * omega) - omega**2 * np.eye(POINTS - 1)
    bent = np.linalg.solve(system, -np.ones(POINTS - 1))
    return bent[POINTS // 2 - 1], MASS * (1.0 - omega**2 * bent.sum() / POINTS)


def swung(omega, periods=60, steps=24):
    """The same of the carrier, and of what is left of the frame, at the end of many periods."""
    carrier = HealdDamper(inputs_at_step_end=True, acceleration=1.0, lift=-1.0 / omega**2, **BENDING)
    assert carrier.initialize(0.0) == 0
    step = 2.0 * pi / omega / steps
    seen = []
    for n in range(1, periods * steps + 1):
        turn = omega * n * step
        carrier.lift = -np.cos(turn) / omega**2
        carrier.velocity, carrier.acceleration = np.sin(turn) / omega, np.cos(turn)
        assert carrier.step((n - 1) * step, step) == 0
        seen.append((carrier.displacement, -carrier.transmitted_force))
    assert carrier.stop_contacts == 0
    phases = np.exp(-1j * 2.0 * pi * np.arange(1, steps + 1) / steps)
    displacement, force = 2.0 * phases @ np.array(seen[-steps:]) / steps
    return 4.0 / pi * displacement, force + (1.0 - 8.0 / pi**2) * MASS


@pytest.mark.parametrize("share", [0.1, 0.33, 0.7, 0.95])
def test_middle_and_ends_of_a_bending_frame_are_those_of_a_beam(share):
    (bent, force), (middle, ends) = (of(share * FIRST) for of in (beam, swung))
    # the third mode bends the middle back by 1/243 of the first mode's static part and has 9 % of the mass
    static = 4.0 / pi / FIRST**2
    assert abs(middle - bent) < 1.1 / 243.0 * static + 1e-4 * abs(bent)
    assert abs(ends - force) < 0.002 * abs(force)
