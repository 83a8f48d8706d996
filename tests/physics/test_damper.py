"""Heald damper's mathematics: exact propagation, stops, and the search for a change of contact."""

from math import acos, asin, cos, pi, sin, sqrt

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference import MP

from loomfmu.physics.damper import (
    CONTACT_CHANGE,
    LOAD_RATE,
    RATE,
    contact_change,
    design_stiffness,
    locate,
    next_contact,
    propagate,
    stop_damping_ratio,
    watched,
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
    found = propagate(z, v, k, c, *drive, duration)
    # every term of the series is at most the sum of what enters: about 8 roundings of it
    scale = abs(z) + abs(w) + sum(map(abs, shares))
    assert abs(found[0] - exact[0]) <= 1e-15 * scale + 1e-300
    assert abs(found[1] - exact[1]) * duration <= 2e-15 * scale + 1e-300


@given(unit, unit, st.floats(0.1, 0.9))
def test_two_pieces_make_one_whole(z, v, first_part):
    k, c, drive = 0.8, 0.3, (0.3, -0.5, 0.7, -0.2)
    first = propagate(z, v, k, c, *drive, first_part)
    # the drive from there on, expanded about the later time
    u0, u1, u2, u3 = drive
    later = (
        u0 + first_part * (u1 + first_part * (u2 + first_part * u3)),
        u1 + first_part * (2 * u2 + first_part * 3 * u3), u2 + 3 * first_part * u3, u3,
    )  # fmt: skip
    both = propagate(*first, k, c, *later, 1.0 - first_part)
    assert both == pytest.approx(propagate(z, v, k, c, *drive, 1.0), abs=5e-15)  # a few roundings


def test_no_duration_changes_nothing():
    assert propagate(0.3, -0.2, 1e9, 1e9, 1.0, 1.0, 1.0, 1.0, 0.0) == (0.3, -0.2)


def test_published_stiffness_of_a_spring():
    # T = 5040 * 0.76 / 4 N, m = 15 kg, a = 40 m/s2, S = 0.015 m
    stiffness = design_stiffness(5040 * 0.76 / 4, 15.0, 40.0, 0.015)
    assert stiffness == pytest.approx(5960.0, rel=1e-12)  # the source's own round figure
    # erratum: that is 5.96 N/mm; the printed 59.6 N/mm would be another spring
    assert stiffness != pytest.approx(59.6e3, rel=0.5)


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
        (UPPER, 0.0099, -0.2, FREE),  # both at once
        (LET_GO, 0.011, -0.2, None),
        (LET_GO, 0.0099, -0.2, FREE),
        (LET_GO, 0.011, 0.0, UPPER),  # turned round before it was out
        (LET_GO_BELOW, -0.011, 0.0, LOWER),
        (LET_GO_BELOW, -0.0099, 0.1, FREE),
    ],
)
def test_contact_rules(contact, position, rate, then):
    case = (contact, position, rate, 0.01, 1000.0, 10.0)
    assert (contact_change(*case) > 0.0) == (then is not None)
    if then is not None:
        assert next_contact(*case) == then


def oscillator(what, contact, z, v, duration, travel=1.0):
    """Where an undamped oscillator of frequency 1 changes."""
    return locate(what, contact, z, v, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, travel, 1.0, 0.0, duration)


@pytest.mark.parametrize("level", [0.05, 0.3, 0.5])
def test_located_stop(level):
    # z = sin t reaches the level; the search ends on its far side
    found = oscillator(CONTACT_CHANGE, 0, 0.0, 1.0, 1.0, level)
    assert found == pytest.approx(asin(level), abs=2e-15)  # rounding of the bracket, 1 wide
    assert sin(found) >= level - 1e-16


def test_located_turn_and_largest_load():
    assert oscillator(RATE, 0, 0.6, 0.8, 1.0) == pytest.approx(acos(0.6), abs=2e-15)  # sin(t + asin 0.6)
    # the load k z + c z' is largest where k z' + c z'' = 0
    k, c = 1.0, 0.5
    found = locate(LOAD_RATE, 0, 0.6, 0.8, k, c, 0.0, 0.0, 0.0, 0.0, 9.0, 1.0, 0.0, 1.0)
    z, v = propagate(0.6, 0.8, k, c, 0.0, 0.0, 0.0, 0.0, found)
    assert watched(LOAD_RATE, 0, z, v, -k * z - c * v, k, c, 9.0, 1.0, 0.0) == pytest.approx(0.0, abs=1e-15)


def test_located_where_a_jump_leaves_no_slope():
    # watched quantities that touch the end of the bracket, or change within one rounding of it
    assert oscillator(RATE, 0, 1.0, 0.0, 1.0) <= 1.0
    assert oscillator(CONTACT_CHANGE, 0, 0.0, 1.0, asin(0.5), 0.5) == pytest.approx(pi / 6, abs=2e-15)


@given(st.floats(0.01, 0.99), st.floats(0.2, 0.95))
def test_located_release_of_an_elastic_stop(depth, share):
    # pressing on an undamped stop the carrier moves on a circle and is let go at its surface
    z, v = 1.0 + depth, -sqrt(1.0 - depth**2) * share
    stiffness, preload = 1.0, 1.0
    found = locate(CONTACT_CHANGE, 1, z, v, stiffness, 0.0, preload, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, pi / 2)
    amplitude = sqrt(depth**2 + v**2)
    exact = acos(0.0) - acos(depth / amplitude)  # depth(t) = amplitude cos(t + phase)
    # the force is a difference of two lengths of 1: rounding over the speed at the surface
    assert found == pytest.approx(exact, abs=1e-14 / amplitude)
    assert depth * cos(found) + v * sin(found) <= 1e-14
