"""Rotor laws: closed, smooth, symmetric, and as the source found them on its loom."""

from math import pi

import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference import MP, Rotor

from loomfmu.physics.rotor_laws.rotor import (
    HARMONIC_ENDS,
    SLOPED_LINE,
    SLOPED_SINE,
    UNIFORM,
    dwell_angle,
    rotor_law,
)

LAWS = {
    "uniform": UNIFORM,
    "harmonic_ends": HARMONIC_ENDS,
    "sloped_line": SLOPED_LINE,
    "sloped_sine": SLOPED_SINE,
}
REDUCTIONS = (0.3, 0.4, 0.5, 0.6, 0.7)
every_law = pytest.mark.parametrize("law", LAWS)

law_of_choice = st.sampled_from(list(LAWS.values()))
turn = st.floats(0.0, 2.0 * pi)
reduction_of_choice = st.floats(0.0, 1.0)


@every_law
@pytest.mark.parametrize("reduction", [0.3, 0.7, 1.0])
def test_laws_are_the_integrals_of_their_acceleration(law, reduction):
    exact = Rotor(law, reduction)
    for x in (0.0, 0.1, pi / 8, 0.5, pi / 4, 1.0, 2.0, 3.0, pi):
        at = MP.mpf(x)
        found = rotor_law(LAWS[law], x, reduction)
        # a dozen terms of size 1..10, rounded
        assert abs(found[0] - exact.angle(at)) < 1e-14
        assert abs(found[1] - exact.velocity(at)) < 1e-14
        assert abs(found[2] - exact.acceleration(at)) < 1e-14


@given(law_of_choice, reduction_of_choice)
def test_laws_close(law, reduction):
    angle, first, second = rotor_law(law, 2.0 * pi, reduction)
    # both ends come from the same formula
    assert angle == 2.0 * pi
    start = rotor_law(law, 0.0, reduction)
    assert (first, second) == (start[1], -start[2])
    assert rotor_law(law, pi, reduction)[0] == pytest.approx(pi, abs=1e-14)  # rounding of a dozen terms


@given(law_of_choice, turn, reduction_of_choice)
def test_laws_are_symmetric(law, x, reduction):
    angle, first, second = rotor_law(law, x, reduction)
    other, other_first, other_second = rotor_law(law, 2.0 * pi - x, reduction)
    # 2 pi - x is itself rounded, to 4e-16, and the laws bend by up to 4 z
    assert angle + other == pytest.approx(2.0 * pi, abs=1e-14)
    assert first == pytest.approx(other_first, abs=1e-14)
    assert second == pytest.approx(-other_second, abs=2e-14)


@pytest.mark.few(16)
@pytest.mark.no_cover
@every_law
@pytest.mark.parametrize("reduction", REDUCTIONS)
@pytest.mark.parametrize("tolerance", [1e-6, 0.015, 0.1, 0.5])
def test_dwell_angles(law, reduction, tolerance):
    exact = Rotor(law, reduction).dwell(tolerance)
    # S is known to 1e-15 and rises there with 0.3 at least: 1e-14 in theory
    assert abs(dwell_angle(LAWS[law], reduction, tolerance) - exact) < 1e-13


@every_law
def test_dwell_of_a_rotor_that_stops(law):
    # at full reduction the velocity is 0 at the slow point, and Newton's step has to be kept in bounds
    for tolerance in (1e-9, 1e-3, 0.25):
        exact = Rotor(law, 1.0).dwell(tolerance)
        # S grows with the third power of the angle there: it is flat, and x less certain than S
        assert abs(dwell_angle(LAWS[law], 1.0, tolerance) - exact) < 1e-11
