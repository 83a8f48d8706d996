"""Belt on its wheel: stiffness, lever arm and load against the published tables."""

from math import cos, degrees, tan

import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference import MP

from loomfmu.machines import table
from loomfmu.physics.belt_wrap import bending_moment, cantilever_stiffness, lever_arm, restraint_load

diameter = st.floats(0.05, 2.0)
clearance = st.floats(1e-6, 0.01)


@given(diameter, clearance)
def test_lever_arm_closes_the_triangle(wheel, gap):
    # (7): a third of the arm and the wheel's radius are the legs, radius and clearance the hypotenuse
    exact = 3 * MP.sqrt((MP.mpf(wheel) / 2 + gap) ** 2 - (MP.mpf(wheel) / 2) ** 2)
    assert lever_arm(wheel, gap) == pytest.approx(float(exact), rel=1e-15)


@given(diameter, clearance, st.floats(1e-3, 10.0))
def test_load_bends_the_belt_to_the_wheel(wheel, gap, stiffness):
    # (3) and (4): moment over stiffness is the curvature of the wheel
    load, arm = restraint_load(stiffness, wheel, gap), lever_arm(wheel, gap)
    assert load * arm / stiffness == pytest.approx(2.0 / wheel, rel=1e-15)
    assert bending_moment(stiffness, wheel) == pytest.approx(load * arm, rel=1e-15)


@given(st.floats(1e-3, 10.0), st.floats(0.05, 0.5), st.floats(1e-3, 10.0))
def test_cantilever_gives_its_stiffness_back(force, reach, stiffness):
    deflection = force * reach**3 / (3 * stiffness)  # (1)
    assert cantilever_stiffness(force, reach, deflection) == pytest.approx(stiffness, rel=1e-15)


def test_range_of_the_small_angle():
    # the docstring: at an end slope of 0.2 the tangent is 1.4 % larger than the angle
    assert tan(0.2) / 0.2 == pytest.approx(1.014, abs=5e-4)
    # over the published tests it stays below 7 deg
    slopes = [
        lever_arm(1e-3 * float(row["D_mm"]), 0.5e-3) / (1e-3 * float(row["D_mm"]))
        for row in table("belt_wrap_theory")
    ]
    assert max(degrees(slope) for slope in slopes) < 7.0
    assert cos(max(slopes)) > 0.99
