"""Detaching roller: torques and drafting force against the published extremes, and the assumed motion."""

from itertools import pairwise
from math import cos, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from loomfmu.physics.detaching_roller import (
    assumed_fibre_share,
    assumed_motion,
    division_of,
    drafting_force,
    top_roller_torque,
)

RADIUS, INERTIA = 12.5e-3, 135.64e-6
SPEED = 10 * pi  # 300 nips a minute
KNOTS = [0.0, 1.5, 6.0, 11.0, 18.4, 25.0, 38.0, 40.0]


# Equations


@given(st.floats(-1e5, 1e5), st.floats(1e-3, 0.1), st.floats(1e-3, 0.1), st.floats(0.0, 1e-2))
def test_top_roller_torque_is_that_of_rolling_without_slip(acceleration, radius, top_radius, inertia):
    top_acceleration = acceleration * radius / top_radius  # (7)
    force = inertia * top_acceleration / top_radius  # (6)
    found = top_roller_torque(acceleration, radius, top_radius, inertia)
    assert found == pytest.approx(force * radius, rel=1e-15)  # (3)


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0), st.floats(0.0, 1e4), st.floats(-100.0, 100.0))
def test_drafting_force_is_half_of_what_the_nip_holds(share, friction, nip_load, resistance):
    holds = friction * nip_load - resistance  # (16), (17)
    assert drafting_force(share, friction, nip_load, resistance) == pytest.approx(
        share * holds / 2, abs=1e-12
    )


@given(st.floats(-1e4, 1e4))
def test_division_is_the_angle_of_the_nip(angle):
    division = division_of(angle)
    assert 0.0 <= division < 40.0
    # rounding of an angle of up to 1e4 rad
    assert cos(2 * pi * division / 40) == pytest.approx(cos(angle), abs=1e-11)
    assert sin(2 * pi * division / 40) == pytest.approx(sin(angle), abs=1e-11)


def test_division_just_before_a_nip_is_not_forty():
    assert division_of(-1e-20) == 0.0


# The assumed motion


def test_assumed_motion_has_the_published_extremes():
    # (divisions to 0.01; no other division comes near them)
    torque = [assumed_motion(k / 100)[1] * SPEED**2 * INERTIA for k in range(4001)]
    assert max(torque) == pytest.approx(1.18, rel=1e-15)
    assert min(torque) == pytest.approx(-0.53, rel=1e-15)
    assert (torque.index(max(torque)), torque.index(min(torque))) == (1840, 2500)


def test_assumed_motion_comes_to_rest_again():
    for division in (0.0, 1.0, 1.5, 38.0, 39.0, 40.0):
        assert assumed_motion(division) == (0.0, 0.0)
    first, _second = assumed_motion(38.0 - 1e-9)
    assert abs(first) < 1e-9


@pytest.mark.parametrize("division", KNOTS[1:-1])
def test_assumed_motion_is_smooth(division):
    step = 1e-6
    before, after = assumed_motion(division - step), assumed_motion(division + step)
    # second derivatives of at most 9, level at the knots: the difference goes with the square of the step
    assert after[0] == pytest.approx(before[0], abs=20 * step)
    assert after[1] == pytest.approx(before[1], abs=1e-9)


@pytest.mark.parametrize("division", [3.0, 8.0, 14.0, 17.0, 22.0, 25.0, 31.0, 37.5])
def test_velocity_of_the_assumed_motion_is_the_integral_of_its_acceleration(division):
    angle = 2 * pi / 40
    total = 0.0
    for left, right in pairwise(KNOTS):
        if left < division:
            total += quad(lambda at: assumed_motion(at)[1] * angle, left, min(right, division))[0]
    assert assumed_motion(division)[0] == pytest.approx(total, abs=1e-13)


def test_phases_of_the_assumed_motion():
    # back first, then forward faster and farther, then rest: the order that the source describes
    # it runs forward when the fibres arrive at 18
    velocity = [assumed_motion(k / 10)[0] for k in range(401)]
    assert all(v <= 0.0 for v in velocity[:173])
    assert all(v > 0.0 for v in velocity[173:380])
    assert max(velocity) > -min(velocity)
    travel = quad(lambda at: assumed_motion(at)[0] * 2 * pi / 40 * RADIUS, 0.0, 40.0, points=KNOTS[1:-1])[0]
    assert travel == pytest.approx(42.3e-3, abs=5e-5)  # web delivered in a nip; told in the README


def test_assumed_fibre_share():
    shares = [assumed_fibre_share(k / 100) for k in range(4001)]
    assert max(shares) == pytest.approx(1.0, abs=1e-15)
    assert shares.index(max(shares)) == 2380
    assert all(share == 0.0 for share in shares[:1801] + shares[3000:])
    assert all(a < b for a, b in pairwise(shares[1801:2381]))
    assert all(a > b for a, b in pairwise(shares[2380:3000]))
    assert assumed_fibre_share(23.8 - 1e-9) == pytest.approx(assumed_fibre_share(23.8 + 1e-9), abs=1e-8)
