"""Heald damper's mathematics: exact propagation, stops, and the search for turns and changes of contact."""

import itertools
from math import acos, asin, cos, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference import MP

from loomfmu.physics.damper import Swing, propagate, stop_damping_ratio
from loomfmu.physics.damper_search import (
    LEVEL,
    SLOPE,
    Gauge,
    Stop,
    contact_change,
    first_change,
    gauge_at,
    next_turn,
    rate_bounds,
    safe_stride,
)

unit = st.floats(-1.0, 1.0)
share = st.floats(0.0, 1.0)


def exponential(position, rate, stiffness, damping, drive, duration):
    """State after a duration by the matrix exponential in 50 digits, the powers of time as states."""
    matrix = MP.zeros(6)
    matrix[0, 1] = 1
    matrix[1, 0], matrix[1, 1] = -MP.mpf(stiffness), -MP.mpf(damping)
    for power, coefficient in enumerate(drive):
        matrix[1, 2 + power] = MP.mpf(coefficient)
        if power:
            matrix[2 + power, 1 + power] = power
    state = MP.matrix([position, rate, 1, 0, 0, 0])
    state = MP.expm(matrix * MP.mpf(duration), method="taylor") * state
    return state[0], state[1]


@settings(max_examples=40)
@given(unit, unit, share, share, st.tuples(unit, unit, unit, unit), st.floats(1e-6, 10.0))
def test_propagation_is_the_matrix_exponential(z, w, elastic, viscous, shares, duration):
    # sqrt(k) t and c t up to 1, the drive in units of a displacement over the step
    v, k, c = w / duration, (elastic / duration) ** 2, viscous / duration
    drive = [size / duration ** (2 + power) for power, size in enumerate(shares)]
    exact = exponential(z, v, k, c, drive, duration)
    found = propagate(Swing(z, v, k, c, *drive), duration)
    # every term of the series is at most the sum of what enters: about 8 roundings of it
    scale = abs(z) + abs(w) + sum(map(abs, shares))
    assert abs(found[0] - exact[0]) <= 1e-15 * scale + 1e-300
    assert abs(found[1] - exact[1]) * duration <= 2e-15 * scale + 1e-300


def test_no_duration_changes_nothing():
    assert propagate(Swing(0.3, -0.2, 1e9, 1e9, 1.0, 1.0, 1.0, 1.0), 0.0) == (0.3, -0.2)


@pytest.mark.parametrize("restitution", [0.15, 0.2, 0.3, 0.5, 0.7, 0.9, 0.99])
def test_stop_throws_back_with_its_restitution(restitution):
    ratio = MP.mpf(stop_damping_ratio(restitution))
    root = MP.sqrt(1 - ratio**2)

    def depth(t):
        return MP.exp(-ratio * t) * MP.sin(root * t) / root

    def press(t):
        return depth(t) + 2 * ratio * MP.diff(depth, t)

    # the force vanishes once on the way out, between the deepest point and the free surface
    deepest = MP.atan2(root, ratio) / root
    end = MP.findroot(press, (deepest, MP.pi / root), solver="anderson")
    # bisected to rounding; the speed left varies with the ratio by at most 2
    assert abs(-MP.diff(depth, end) - restitution) < 1e-14


FREE, UPPER, LOWER, LET_GO, LET_GO_BELOW = 0, 1, -1, 2, -2


@pytest.mark.parametrize(
    ("contact", "position", "rate", "then"),
    [
        (FREE, 0.009, 5.0, None),
        (FREE, 0.011, 5.0, UPPER),
        (FREE, -0.011, -5.0, LOWER),
        (UPPER, 0.011, 1.0, None),  # pressing on
        (UPPER, 0.011, -0.05, None),  # going out, still pressed
        (UPPER, 0.011, -0.2, LET_GO),  # the dashpot would have to pull
        (LOWER, -0.011, 0.2, LET_GO_BELOW),
        (LET_GO, 0.011, -0.2, None),
        (LET_GO, 0.0099, -0.2, FREE),
        (LET_GO, 0.011, 0.0, UPPER),  # turned round before it was out
        (LET_GO_BELOW, -0.011, 0.0, LOWER),
        (LET_GO_BELOW, -0.0099, 0.1, FREE),
    ],
)
def test_contact_rules(contact, position, rate, then):
    # a carrier without forces, over a time in which it goes nowhere
    swing = Swing(position, rate, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    time, found = contact_change(contact, Stop(0.01, 1000.0, 10.0), swing, 0.0, 0.0, 1e-9)
    assert (time, found) == ((1e-9, contact) if then is None else (0.0, then))


def test_of_two_changes_the_first_one_counts():
    # z = 0.5 + 2 t - 4 t^2 beyond 0.7 at (5 - sqrt 5) / 20, and back within; later below -0.7
    swing = Swing(0.5, 2.0, 0.0, 0.0, -8.0, 0.0, 0.0, 0.0)
    found = contact_change(0, Stop(0.7, 1.0, 0.0), swing, 8.0, 0.0, 1.0)
    assert found == (pytest.approx((5 - sqrt(5)) / 20, abs=1e-15), UPPER)
    found = contact_change(0, Stop(0.76, 1.0, 0.0), swing, 8.0, 0.0, 1.0)
    assert found == (pytest.approx((10 + sqrt(604)) / 40, abs=1e-15), LOWER)


def passes(level, z, v, duration, start=0.0):
    """Where an undamped oscillator of frequency 1 first passes a level upwards."""
    bend = sqrt(z**2 + v**2)
    swing = Swing(z, v, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    return first_change(Gauge(LEVEL, level, 0.0, 0.0, 1.0, 0.0), swing, -1.0, bend, start, duration)


def turns(k, c, z, v, drive, duration):
    """All times at which the load `k z + c z'` turns round."""
    swing = Swing(z, v, k, c, *drive)
    _a, jerk, snap = rate_bounds(swing, duration)
    found, time = [], 0.0
    while len(found) < 6:
        time = next_turn(Gauge(SLOPE, 0.0, 0.0, 0.0, k, c), swing, k * jerk + c * snap, time, duration)
        if time < 0.0:
            break
        found.append(time)
    return found


@pytest.mark.parametrize("level", [0.05, 0.3, 0.5, 0.8])
def test_located_stop(level):
    # z = sin t reaches the level; the search ends on its far side
    found = passes(level, 0.0, 1.0, 1.0)
    assert found == pytest.approx(asin(level), abs=2e-15)  # rounding of the bracket, 1 wide
    assert sin(found) >= level - 1e-16


@pytest.mark.parametrize("above", [0.1, 1e-3, 1e-6, 1e-9, 1e-12])
def test_what_lasts_a_moment_is_not_missed(above):
    # z = sin(t + 1.0) is beyond the level around its summit alone; a crossing is known to the rounding of the
    # level over the speed there
    level = 1.0 - above
    found = passes(level, sin(1.0), cos(1.0), 0.8)
    assert found == pytest.approx(asin(level) - 1.0, abs=1e-15 / sqrt(above))
    assert passes(1.0 + above, sin(1.0), cos(1.0), 0.8) == -1.0


def test_located_turn():
    # z = sin(t + asin 0.6)
    assert turns(1.0, 0.0, 0.6, 0.8, (0.0, 0.0, 0.0, 0.0), 1.0) == [pytest.approx(acos(0.6), abs=2e-15)]
    (found,) = turns(1.0, 0.5, 0.6, 0.8, (0.0, 0.0, 0.0, 0.0), 0.5)
    swing = Swing(0.6, 0.8, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0)
    value, _slope = gauge_at(Gauge(SLOPE, 0.0, 0.0, 0.0, 1.0, 0.5), swing, found)
    assert value == pytest.approx(0.0, abs=1e-15)


@given(st.lists(st.floats(0.05, 0.95), min_size=1, max_size=3), st.floats(0.0, 0.3), st.floats(0.0, 0.3))
def test_every_turn_of_a_piece_is_found(wanted, elastic, viscous):
    # z'(t) is the polynomial with these zeros; the drive follows from it and has to be a cubic in t
    wanted = sorted(set(wanted))
    k, c = elastic**2 if len(wanted) < 3 else 0.0, viscous
    rate = np.polynomial.Polynomial.fromroots(wanted)
    position = rate.integ()
    drive = [0.0] * 4
    for part, factor in ((rate.deriv(), 1.0), (rate, c), (position, k)):
        for power, coefficient in enumerate(part.coef if factor else ()):
            drive[power] += factor * coefficient
    swing = Swing(0.0, rate(0.0), k, c, *drive)
    _a, jerk, _snap = rate_bounds(swing, 1.0)
    found, time = [], 0.0
    while len(found) < 6:
        time = next_turn(Gauge(SLOPE, 0.0, 0.0, 0.0, 1.0, 0.0), swing, jerk, time, 1.0)
        if time < 0.0:
            break
        found.append(time)
    # zeros closer than that are one to rounding: the rate between them is no larger than 1e-16
    if all(b - a > 1e-7 for a, b in itertools.pairwise(wanted)):
        assert len(found) == len(wanted)
        for time, exact in zip(found, wanted, strict=True):
            steep = abs(rate.deriv()(exact))
            assert time == pytest.approx(exact, abs=2e-15 / steep)  # rounding of the rate, over its slope


@given(unit, unit, share, share, st.tuples(unit, unit, unit, unit), share)
def test_bounds_hold_all_along(z, v, own, part, shares, at):
    duration, damping = 1.0, 0.5 * own * part
    stiffness = (0.5 * own * (1.0 - part)) ** 2
    u0, u1, u2, u3 = shares
    swing = Swing(z, v, stiffness, damping, *shares)
    bounds = rate_bounds(swing, duration)
    z, v = propagate(swing, at)
    a = u0 + at * (u1 + at * (u2 + at * u3)) - stiffness * z - damping * v
    j = u1 + at * (2 * u2 + at * 3 * u3) - stiffness * v - damping * a
    s = 2 * u2 + 6 * at * u3 - stiffness * a - damping * j
    for value, bound in zip((a, j, s), bounds, strict=True):
        assert abs(value) <= bound + 1e-15  # rounding


@given(st.floats(-1.0, 0.0), unit, share, share)
def test_nothing_happens_within_a_safe_stride(value, slope, bend, at):
    stride = min(safe_stride(value, slope, bend), 1e3)
    t = at * stride
    assert value + slope * t + 0.5 * bend * t * t <= 1e-12 * (1.0 + abs(slope) * t + bend * t * t)  # rounding


def test_located_where_there_is_no_slope():
    # at the start at rest on the level, which it leaves by t^2 / 2, or passing just before the end
    assert 0.0 <= passes(-1.0, -1.0, 0.0, 1.0) <= 2e-8
    assert passes(sin(0.5), 0.0, 1.0, 0.5 + 1e-12) == pytest.approx(0.5, abs=2e-15)


@given(st.floats(0.01, 0.99), st.floats(0.2, 0.95))
def test_located_release_of_an_elastic_stop(depth, share):
    # pressing on an undamped stop the carrier moves on a circle and is let go at its surface
    z, v = 1.0 + depth, -sqrt(1.0 - depth**2) * share
    swing = Swing(z, v, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    found, then = contact_change(1, Stop(1.0, 1.0, 0.0), swing, 1.0, 1.0, pi / 2)
    amplitude = sqrt(depth**2 + v**2)
    exact = acos(0.0) - acos(depth / amplitude)  # depth(t) = amplitude cos(t + phase)
    # the force is a difference of two lengths of 1: rounding over the speed at the surface
    assert found == pytest.approx(exact, abs=1e-14 / amplitude)
    assert then == 2
    assert depth * cos(found) + v * sin(found) <= 1e-14
