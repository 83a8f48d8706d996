"""BeltWrap: a function of wheel and clearance alone."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference import MP

from loomfmu.components import BeltWrap


@settings(max_examples=50)
@given(st.floats(1e-9, 1e6), st.floats(1e-3, 10.0), st.floats(1e-6, 0.01), st.floats(0.0, 6.28))
def test_the_wrap_of_a_belt_follows_its_formula_everywhere(stiffness, diameter, clearance, angle):
    wrap = BeltWrap(bending_stiffness=stiffness, wheel_diameter=diameter, wrap_angle=angle)
    assert wrap.initialize(0.0) == 0
    wrap.block_clearance = clearance  # it wears
    assert wrap.step(0.0, 1.0) == 0
    arm = 3 * MP.sqrt(MP.mpf(diameter) * MP.mpf(clearance) + MP.mpf(clearance) ** 2)
    # a few roundings
    assert wrap.lever_arm == pytest.approx(float(arm), rel=1e-15)
    assert wrap.restraint_load == pytest.approx(float(2 * MP.mpf(stiffness) / (diameter * arm)), rel=2e-15)
    assert wrap.bending_moment == pytest.approx(2.0 * stiffness / diameter, rel=1e-15)


@settings(max_examples=100)
@given(st.floats(1e-6, 0.1), st.floats(1e-3, 10.0))
def test_the_outer_face_of_a_wrapped_belt_is_longer_than_its_middle(thickness, diameter):
    wrap = BeltWrap(thickness=thickness, wheel_diameter=diameter)
    assert wrap.initialize(0.0) == 0
    face, middle = (MP.pi * (diameter + layer * MP.mpf(thickness)) for layer in (2, 1))  # of a full turn
    assert wrap.bending_strain == pytest.approx(float((face - middle) / middle), rel=1e-15)


@settings(max_examples=100)
@given(st.floats(1e-6, 0.1), st.floats(1e-4, 1.0), st.floats(1e-3, 10.0), st.floats(1e-3, 1e3))
def test_the_stress_of_a_wrapped_belt_bends_it_to_its_wheel(thickness, width, diameter, stiffness):
    wrap = BeltWrap(thickness=thickness, width=width, wheel_diameter=diameter, bending_stiffness=stiffness)
    assert wrap.initialize(0.0) == 0
    t, b, end = MP.mpf(thickness), MP.mpf(width), MP.mpf(wrap.bending_stress)
    # the stress grows evenly from the middle to the faces; its moment is EI over the radius of the middle
    moment = 2 * MP.quad(lambda y: b * end * y / (t / 2) * y, [0, t / 2])
    assert float(moment) == pytest.approx(float(2 * MP.mpf(stiffness) / (diameter + t)), rel=2e-15)
