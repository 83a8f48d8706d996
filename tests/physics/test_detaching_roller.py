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

RADIUS, TOP_RADIUS = 12.5e-3, 12.25e-3
INERTIA, TOP_INERTIA = 135.64e-6, 33.98e-6
NIP_LOAD, FRICTION = 300.0, 0.33
SPEED = 10 * pi  # 300 nips a minute
KNOTS = [0.0, 1.5, 6.0, 11.0, 18.4, 25.0, 38.0, 40.0]


def top_torque(inertia_torque):
    """M12 that belongs to an M13."""
    return top_roller_torque(inertia_torque / INERTIA, RADIUS, TOP_RADIUS, TOP_INERTIA)


# Published numbers, Tables 1 and 2


@pytest.mark.parametrize(("inertia_torque", "printed"), [(1.18, 0.31), (-0.53, -0.14)])
def test_published_top_roller_torques(inertia_torque, printed):
    # printed to 0.01 N m; so is M13, of which it is 0.26
    assert top_torque(inertia_torque) == pytest.approx(printed, abs=7e-3)


def test_erratum_the_valleys_have_lost_their_signs():
    # with the valley as printed, +0.53 N m, the roller would never be braked: in one nip of 0.2 s it would
    # gain at least 780 rad/s, and so in the next
    assert 0.53 / INERTIA * 0.2 > 780.0
    # M12 and M13 follow one acceleration: with the same sign on both valleys their ratio holds
    assert pytest.approx(1.18 / 0.53, rel=0.01) == 0.31 / 0.14


def test_erratum_the_inertias_are_in_kg_m2():
    # printed kg mm2: the acceleration behind 1.18 N m would be a million times larger
    assert pytest.approx(8699.5, abs=0.05) == 1.18 / INERTIA
    rim = 1.18 / INERTIA * RADIUS  # 109 m/s2 at the web
    assert 10.0 < rim < 1000.0


def test_published_drafting_torque():
    # with the valley of M12, 0.14 N m, it is at most 0.689; printed 0.68 asks for M12 = -0.12 at 23.8
    at_most = drafting_force(1.0, FRICTION, NIP_LOAD, -0.14 / RADIUS) * RADIUS
    assert at_most == pytest.approx(0.689, abs=5e-4)
    asked = drafting_force(1.0, FRICTION, NIP_LOAD, -0.1225 / RADIUS) * RADIUS
    assert asked == pytest.approx(0.68, abs=5e-4)


def test_erratum_the_front_torque_is_not_the_sum():
    # M2 = M12 + M13: the printed peak 1.36 and valley 0.61 are both 9 % less than their parts
    assert 1.18 + top_torque(1.18) == pytest.approx(1.488, abs=5e-4)
    assert pytest.approx(1.096, abs=5e-4) == (0.31 + 1.18) / 1.36
    assert pytest.approx(1.098, abs=5e-4) == (0.14 + 0.53) / 0.61


@pytest.mark.parametrize(
    ("nips", "peak", "machine"), [(300, 2.73, 21.84), (400, 4.85, 38.80), (500, 7.57, 60.56)]
)
def test_published_peaks_grow_with_the_square_of_the_speed(nips, peak, machine):
    # at 18.4 hardly any fibre is drafted yet; printed to 0.01 N m
    assert peak == pytest.approx(2.73 * (nips / 300) ** 2, abs=0.02)
    assert machine == pytest.approx(8 * peak, abs=5e-3)


def test_published_valleys_ask_for_a_share_of_fibres():
    # M = 2 (M12 + M13) + M11: one part goes with the square of the speed, the friction's not; two unknowns
    # meet three printed valleys to their last digit
    growing, constant = 1.157, 0.157
    for nips, valley in ((300, -1.0), (400, -1.9), (500, -3.06)):
        assert constant - growing * (nips / 300) ** 2 == pytest.approx(valley, abs=5e-3)
    share = constant / (0.5 * FRICTION * NIP_LOAD * RADIUS)
    assert share == pytest.approx(0.254, abs=5e-4)
    assert assumed_fibre_share(26.1) == pytest.approx(share, abs=6e-3)


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
