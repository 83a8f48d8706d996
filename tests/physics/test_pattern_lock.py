"""Pattern lock: the pawl's engagement, its spring, its friction, and the source's slips."""

from math import radians

import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference import MP

from loomfmu.physics.pattern_lock import (
    UNLIMITED_TIME,
    available_time,
    engagement,
    largest_bend,
    pawl_inertia,
    release_time,
    torque_speed_limit,
)

SPAN = radians(75)
MASS, LENGTH, WIDTH = 0.170, 0.16, 0.03
STIFFNESS, ARM, FORCE, TURN = 2500.0, 0.05, 20.0, 0.215625
INERTIA = pawl_inertia(MASS, LENGTH, WIDTH)

# The engagement


@given(st.floats(0.0, 1.0), st.floats(0.01, 6.0), st.floats(0.0, 1.0))
def test_engagement_and_its_derivatives(share, span, turn):
    x = span * share

    def exact(at):
        return MP.mpf(turn) * (at / MP.mpf(span) - MP.sin(2 * MP.pi * at / MP.mpf(span)) / (2 * MP.pi))

    value, first, second = MP.taylor(exact, MP.mpf(x), 2)
    found = engagement(x, span, turn)
    # a few roundings: of the terms of 1, and of an argument of up to 2 pi
    assert abs(found[0] - value) < 1e-15
    assert abs(found[1] - first) < 2e-15 / span + 1e-40
    assert abs(found[2] - 2 * second) < 2e-14 / span**2 + 1e-40


@given(st.floats(0.01, 6.0), st.floats(0.01, 1.0))
def test_pawl_rests_at_both_ends(span, turn):
    assert engagement(-1.0, span, turn) == engagement(0.0, span, turn) == (0.0, 0.0, 0.0)
    assert engagement(span, span, turn) == engagement(7.0, span, turn) == (turn, 0.0, 0.0)


@pytest.mark.parametrize("turn", [radians(12), 0.216, 1.0])
def test_largest_bend_is_that_of_the_law(turn):
    quarter = engagement(0.25 * SPAN, SPAN, turn)[2]
    assert quarter == pytest.approx(largest_bend(SPAN, turn), rel=1e-15)  # rounding
    bends = [abs(engagement(SPAN * k / 1000, SPAN, turn)[2]) for k in range(1001)]
    assert max(bends) <= quarter * (1.0 + 1e-15)


@pytest.mark.parametrize("stiffness", [0.0, 1.0, 2500.0, 1e6])
@pytest.mark.parametrize("force", [1e-6, 20.0, 1e4])
def test_speed_limit_is_where_the_contact_force_just_vanishes(force, stiffness):
    # M - I phi'' w^2 in fifty digits: nowhere below 0 at the limit, and 0 where it is least
    limit = MP.mpf(torque_speed_limit(INERTIA, SPAN, TURN, force, stiffness, ARM))

    def left(share):
        wave = 2 * MP.pi * share
        angle = MP.mpf(TURN) * (share - MP.sin(wave) / (2 * MP.pi))
        torque = MP.mpf(ARM) * (force + MP.mpf(stiffness) * MP.mpf(ARM) * (MP.mpf(TURN) - angle))
        needed = MP.mpf(INERTIA) * 2 * MP.pi * MP.mpf(TURN) / MP.mpf(SPAN) ** 2 * MP.sin(wave) * limit**2
        return (torque - needed) / torque

    shares = [MP.mpf(k) / 400 for k in range(1, 400)]
    least = min(shares, key=left)
    step = MP.mpf(1) / 400
    place = MP.findroot(lambda share: MP.diff(left, share), (least - step / 7, least + step / 7), tol=1e-30)
    assert abs(place - least) < 2 * step
    assert abs(left(place)) < 1e-13  # rounding of a dozen operations
    assert all(left(share) > -1e-13 for share in shares)


@pytest.mark.no_cover
@pytest.mark.parametrize("force", [0.0, 1e-3, 20.0, 1e5])
def test_release_with_preload_by_energy(force):
    # I phi'^2 / 2 is the work of the spring, so the time is the integral of d phi / phi'; with phi = phi0 v^2
    # the root at the start is gone
    turn, arm, stiffness = MP.mpf(TURN), MP.mpf(ARM), MP.mpf(STIFFNESS)

    def pace(v):
        work = arm * (force + stiffness * arm * turn) - stiffness * arm**2 * turn * v * v / 2  # over phi
        return 2 * MP.sqrt(MP.mpf(INERTIA) * turn / (2 * work))

    exact = MP.quad(pace, [0, 0.5, 1])
    found = release_time(INERTIA, TURN, force, STIFFNESS, ARM)
    assert found == pytest.approx(float(exact), rel=2e-15)  # rounding


@given(st.floats(0.0, 7.0), st.floats(0.0, 1e4))
def test_time_that_is_left_is_bounded(angle, speed):
    left = available_time(angle, speed)
    assert 0.0 <= left <= UNLIMITED_TIME
    assert left == UNLIMITED_TIME or left * speed == pytest.approx(angle, rel=1e-15)  # rounding
