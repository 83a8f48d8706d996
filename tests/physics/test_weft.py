"""Weft yarn: capstan, drag, momentum and stretch one by one, and a yielding brake in 50 digits."""

from math import cos, exp, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference import MP

from loomfmu.physics.weft import (
    along,
    capstan_gain,
    drag_per_length,
    drawing_limit,
    eased,
    moving_load,
    moving_load_rate,
    quintic,
    relaxed_force,
    stretch_force,
    unstretched_length,
)

shares = st.floats(0.0, 1.0)
forces = st.floats(0.0, 5.0)


@given(st.floats(0.0, 1.0), st.lists(st.floats(0.0, 3.0), min_size=1, max_size=5))
def test_eyes_multiply_the_tension(friction, angles):
    one_by_one = 1.0
    for angle in angles:
        one_by_one *= capstan_gain(friction, angle)
    assert capstan_gain(friction, sum(angles)) == pytest.approx(one_by_one, rel=1e-14)  # roundings
    assert capstan_gain(friction, angles[0]) == pytest.approx(exp(friction * angles[0]), rel=1e-15)


def test_drag_is_the_friction_on_the_yarns_surface():
    surface = pi * 0.2e-3 * 2.0
    assert moving_load(2.0, 20.0, 0.0, 0.0, drag_per_length(0.04, 0.2e-3)) == pytest.approx(
        0.04 * 0.5 * 1.2 * 20.0**2 * surface, rel=1e-14
    )


def over_eyes(tension, density, speed, friction, angles, corners):
    """Tension behind eyes, by the balance of forces and momentum of the yarn at each of many small corners.

    The eye pushes outwards along the bisector, and friction acts across it, backwards.
    Where it would have to pull, it lets go.
    """
    for angle in angles:
        turn = angle / corners
        coming, going = np.array([1.0, 0.0]), np.array([cos(turn), sin(turn)])
        push = (coming - going) / np.linalg.norm(going - coming)
        eye = push + friction * np.array([push[1], -push[0]])  # on the yarn, for 1 N of pressure
        for _ in range(corners):
            # T2 t2 - T1 t1 + N eye = q v^2 (t2 - t1)
            momentum = density * speed**2 * (going - coming)
            after, pressure = np.linalg.solve(np.array([going, eye]).T, momentum + tension * coming)
            tension = after if pressure > 0.0 else tension
    return tension


@settings(max_examples=100, deadline=None)
@given(
    st.floats(0.0, 1.0),
    st.floats(1e-6, 1e-4),
    st.floats(0.0, 80.0),
    st.floats(0.0, 4.0),
    st.floats(0.0, 0.5),
    st.lists(st.floats(0.1, 2.0), min_size=1, max_size=4),
)
def test_running_yarn_over_eyes_by_its_momentum(before, density, speed, unwinding, friction, angles):
    limit, _rate = drawing_limit(
        capstan_gain(friction, sum(angles)), before, unwinding * density, density, 0.0, 0.0, speed, 0.0
    )
    start = before + unwinding * density * speed**2
    # (1 + f) / (1 - f) with f = mu tan(turn / 2) at each corner: its logarithm is off by
    # mu (1 + mu^2) turn^3 / 12, in 400 turns of 0.02 by at most 1.7e-4
    assert limit == pytest.approx(
        over_eyes(start, density, speed, friction, angles, 100), rel=2e-4, abs=1e-4 * density * speed**2
    )


@given(st.floats(-50.0, 50.0), st.floats(-5e3, 5e3), st.floats(-1e6, 1e6), st.floats(0.1, 5.0))
def test_rates_of_limit_and_load(speed, acceleration, jerk, length):
    def moved(t):
        return (
            MP.mpf(length) + speed * t + acceleration * t**2 / 2 + MP.mpf(jerk) * t**3 / 6,
            MP.mpf(speed) + acceleration * t + MP.mpf(jerk) * t**2 / 2,
            MP.mpf(acceleration) + jerk * t,
        )

    _limit, rate = drawing_limit(1.5, 0.1, 5e-5, 3e-5, 0.2, 4.0, speed, acceleration)
    exact = MP.diff(lambda t: 1.5 * (0.3 + 2e-5 * moved(t)[1] ** 2 + 4 * t) + 3e-5 * moved(t)[1] ** 2, 0)
    assert rate == pytest.approx(float(exact), rel=1e-12, abs=1e-12)
    exact = MP.diff(lambda t: moved(t)[0] * (3e-5 * moved(t)[2] + 1.5e-5 * moved(t)[1] ** 2), 0)
    size = 3e-5 * (abs(speed * acceleration) + length * abs(jerk) + abs(speed) ** 3 + 1.0)
    found = moving_load_rate(length, speed, acceleration, jerk, 3e-5, 1.5e-5)
    assert abs(found - float(exact)) <= 1e-13 * size * (1.0 + length)  # roundings of the terms


@given(st.floats(1e-3, 1e4), st.floats(0.5, 5.0), forces)
def test_stretch_and_its_inverse(stiffness, length, force):
    unstretched = unstretched_length(stiffness, length, force)
    assert unstretched <= length
    # the strain is a difference of lengths, each with a rounding
    assert stretch_force(stiffness, length, unstretched) == pytest.approx(
        force, abs=4e-16 * (stiffness + force)
    )


@given(st.floats(1e-6, 1e3), st.floats(1e-6, 1.0), forces, forces, shares, st.tuples(*[st.floats(-2, 2)] * 4))
def test_yielding_brake_is_exact(duration, retardation, force, limit, low, cubic):
    h = (limit, *cubic[1:])
    decay = duration / retardation
    high = 0.5 * (1.0 + low)

    def curve(u):
        return h[0] + u * (h[1] + u * (h[2] + u * MP.mpf(h[3])))

    # F = sum of (-1/z)^k H^(k) + c exp(-z u), with the derivatives of a cubic
    z = MP.mpf(decay)

    def settled(u):
        return sum((-1 / z) ** k * MP.diff(curve, u, k) for k in range(4))

    exact = settled(MP.mpf(high)) + (force - settled(MP.mpf(low))) * MP.exp(-z * (MP.mpf(high) - low))
    if decay < 1e-6:
        return  # the closed form above cancels; `thread_force` itself is tested there
    size = force + sum(map(abs, h))
    assert abs(relaxed_force(force, decay, low, high, list(h)) - exact) <= 4e-15 * size


def test_a_yarn_without_viscosity_is_at_the_limit():
    assert relaxed_force(0.0, 1e300, 0.0, 1.0, [2.0, 0.5, 0.0, 0.0]) == pytest.approx(2.5, rel=1e-14)


@given(forces, forces, shares)
def test_program_does_not_overshoot(start, end, share):
    value, slope = eased(start, end, share)
    assert min(start, end) - 1e-15 <= value <= max(start, end) + 1e-15
    assert slope * (end - start) >= 0.0
    assert eased(start, end, 0.0) == (start, 0.0)


@given(st.tuples(*[st.floats(-2.0, 2.0)] * 6))
def test_quintic_meets_both_samples(ends):
    curve = quintic(*ends, 0.0)
    assert along(0.0, curve)[:3] == ends[:3]
    for found, exact in zip(along(1.0, curve), ends[3:], strict=False):
        # sixty roundings of what is joined, or what is taken for its noise
        assert found == pytest.approx(exact, abs=60 * 1.8e-15 * 12.0)
