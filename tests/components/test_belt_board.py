"""BeltDynamics under its weight, against closed forms."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from belt_loom import X

from loomfmu.components.belt_dynamics import BeltDynamics

PLAY, GUIDED = 2, 2
GRAVITY = 0.01  # so little that slopes are small
# What the belt is given, its stiffness, whether guide and head are clamped, how well six modes give its sag:
# sines of its odd ones fall with the fifth power of their number; with both ends clamped six are few
ENDS = [
    ({}, 0.25 / 0.64, False, False, 6e-5),
    ({"guide_end": PLAY, "guide_clearance": 0.0}, 0.25, True, False, 6e-5),
    ({"head_end": GUIDED}, 0.25 / 0.64, False, True, 6e-5),
    ({"guide_end": PLAY, "guide_clearance": 0.0, "head_end": GUIDED}, 0.25, True, True, 2e-4),
]


def sag(weight, stiffness, load, length, guide_clamped, head_clamped):
    """Deflection of a beam-column under its weight at places from the head: B u_xxxx + P u_xx = weight.

    u = a + b x + c cos k x + d sin k x + weight x^2 / (2 P), by its ends.
    """
    k, end = sqrt(load / stiffness), length
    at_head = [0.0, 1.0, 0.0, k] if head_clamped else [0.0, 0.0, -k * k, 0.0]
    at_guide = (
        [0.0, 1.0, -k * sin(k * end), k * cos(k * end)]
        if guide_clamped
        else [0.0, 0.0, -k * k * cos(k * end), -k * k * sin(k * end)]
    )
    rows = [[1.0, 0.0, 1.0, 0.0], at_head, [1.0, end, cos(k * end), sin(k * end)], at_guide]
    share = weight / load
    known = [
        0.0,
        0.0 if head_clamped else -share,
        -0.5 * share * end**2,
        -share * end if guide_clamped else -share,
    ]
    a, b, c, d = np.linalg.solve(rows, known)
    x = X * length
    return a + b * x + c * np.cos(k * x) + d * np.sin(k * x) + 0.5 * share * x**2


@pytest.mark.parametrize(("ends", "stiffness", "guide", "head", "within"), ENDS)
@pytest.mark.parametrize("length", [0.1737, 0.5])
@pytest.mark.parametrize("share", [0.01, 0.5, 0.79])
def test_a_belt_sags_under_its_weight_as_a_beam_column(ends, stiffness, guide, head, within, length, share):
    load = share * stiffness * (pi / length) ** 2
    belt = BeltDynamics(gravity=GRAVITY, bow=0.0, **ends)
    belt.travel, belt.yarn_tension = belt.idle_travel + belt.head_length + length, load
    assert belt.initialize(0.0) == 0
    expected = sag(belt.belt_mass * GRAVITY, stiffness, load, length, guide, head)
    assert belt.deflection == pytest.approx(np.abs(expected).max(), rel=within)
    place = length * (1.0 - X[np.abs(expected).argmax()])
    assert belt.deflection_place == pytest.approx(place, abs=0.005 * length)  # of 201 places
