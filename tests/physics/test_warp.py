"""Warp thread: geometry, the viscoelastic law in 50 and more digits, and what (3.28) and (3.29) say."""

from itertools import pairwise
from math import exp

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from reference import MP

from loomfmu.physics.numerics.motion import joined
from loomfmu.physics.warp import (
    constant_rate_force,
    fading,
    thread_drive,
    thread_extension,
    thread_force,
    thread_growth,
    thread_locate,
    turns_once,
)

FINE = MP.clone()  # closed forms that cancel: a polynomial over powers of a small decay
FINE.dps = 250

unit = st.floats(-1.0, 1.0)
drives = st.tuples(unit, unit, unit, unit, unit, unit)
decays = st.one_of(st.just(0.0), st.floats(1e-12, 1e-3), st.floats(1e-3, 30.0), st.floats(30.0, 1e6))
lengths = st.floats(0.05, 2.0)
heights = st.floats(-0.3, 0.3) | st.sampled_from([1e-12, 1e-8, 1e-4])  # of a nearly closed shed, too

# Geometry


@given(heights, st.floats(-3.0, 3.0), st.floats(-100.0, 100.0), lengths, lengths)
def test_extension_and_its_rates(height, velocity, acceleration, front, back):
    def exact(t):
        y = MP.mpf(height) + velocity * t + MP.mpf(acceleration) * t * t / 2
        return MP.hypot(front, y) - front + MP.hypot(back, y) - back

    x, rate, second = MP.taylor(exact, 0, 2)
    found = thread_extension(height, velocity, acceleration, front, back)
    # a few roundings of the terms; the extension itself is right to its last digits, however small
    # (1e-40: what fifty digits leave of a difference of lengths)
    assert abs(found[0] - x) <= 1e-15 * abs(x) + 1e-40
    assert abs(found[1] - rate) <= 1e-15 * 2.0 * abs(velocity) + 1e-40
    bend = velocity**2 * (1 / front + 1 / back) + 2 * abs(acceleration)
    assert abs(found[2] - 2 * second) <= 2e-15 * bend + 1e-40


# The law over a step


@pytest.mark.parametrize("decay", [0.0, 1e-9, 1e-3, 0.5, 2.0, 2.999, 3.0, 3.001, 5.0, 20.0, 1e3, 1e6])
def test_moments_of_the_fading_memory(decay):
    kept, *moments = fading(decay)
    assert kept == exp(-decay)
    for k, moment in enumerate(moments):
        exact = MP.hyp1f1(1, k + 2, -MP.mpf(decay)) / (k + 1)
        assert abs(moment - exact) < 4e-15 * exact, k  # the rounding of seven recursions


def polynomial_solution(force, decay, drive, share):
    """Force and its integral: a polynomial that satisfies the law, and a transient that fades."""
    u, z = FINE.mpf(share), FINE.mpf(decay)
    p = [FINE.mpf(each) for each in drive]
    if decay == 0.0:
        gains = [each * u ** (k + 1) / (k + 1) for k, each in enumerate(p)]
        areas = [each * u ** (k + 2) / ((k + 1) * (k + 2)) for k, each in enumerate(p)]
        return force + sum(gains), force * u + sum(areas)
    q = [FINE.mpf(0)] * 7
    for k in reversed(range(6)):
        q[k] = (p[k] - (k + 1) * q[k + 1]) / z
    transient = force - q[0]
    settled = sum(each * u**k for k, each in enumerate(q))
    area = sum(each * u ** (k + 1) / (k + 1) for k, each in enumerate(q))
    return settled + transient * FINE.exp(-z * u), area + transient * (1 - FINE.exp(-z * u)) / z


@given(unit, decays, drives, st.floats(0.0, 1.0))
def test_force_and_its_integral_are_exact(force, decay, drive, share):
    exact, exact_area = polynomial_solution(force, decay, drive, share)
    found, area = thread_force(force, decay, drive, share)
    # (1e-100: what 250 digits leave of powers of a decay of 1e-12)
    # nothing cancels but the terms of the drive themselves; beyond that the rounding of a dozen terms, and
    # of exp(-z u), whose argument is rounded to 1e-16 of itself
    weight = fading(decay * share)[1] * share * sum(map(abs, drive))
    kept = abs(force) * exp(-decay * share) * (1.0 + decay * share)
    assert abs(found - exact) <= 4e-15 * (kept + weight) + 1e-100
    assert abs(area - exact_area) <= 4e-15 * share * (abs(force) * fading(decay * share)[1] + weight) + 1e-100


@given(unit, st.floats(1e-6, 50.0), drives, st.floats(0.0, 1.0))
def test_growth_is_the_derivative(force, decay, drive, share):
    value, _area = polynomial_solution(force, decay, drive, share)
    slope = FINE.diff(lambda u: polynomial_solution(force, decay, drive, u)[0], share)
    found = thread_growth(float(value), decay, drive, share)
    assert abs(found - slope) <= 2e-15 * (sum(map(abs, drive)) + decay * abs(value))  # the terms, rounded


@given(
    st.floats(0.0, 0.01), st.floats(0.0, 0.01), st.tuples(unit, unit, unit, unit), st.floats(0.0, 10.0), unit
)
def test_drive_is_the_right_side_of_the_law(start, end, seconds, creep, share):
    u = MP.mpf(abs(share))
    a = [MP.mpf(each) * 1e-3 for each in seconds]
    rate = MP.mpf(end) - start - (a[0] / 2 + a[1] / 6 + a[2] / 12 + a[3] / 20)

    def x(s):
        return start + s * (rate + s * (a[0] / 2 + s * (a[1] / 6 + s * (a[2] / 12 + s * a[3] / 20))))

    drive = thread_drive(67.0, creep, start, end, *(float(each) for each in a))
    found = sum(p * u**k for k, p in enumerate(drive))
    exact = 67 * (MP.diff(x, u) + MP.mpf(creep) * x(u))
    # terms of up to 67 (0.01 + 0.002) (1 + 10), rounded
    assert abs(found - exact) < 1e-14


def run(extension, rate, second, step, steps, stiffness, creep, relaxation, force=0.0):
    """Force after steps on the quintics that join samples of a given extension."""
    for n in range(steps):
        at, then = n * step, (n + 1) * step
        a = joined(
            extension(at),
            step * rate(at),
            step * step * second(at),
            extension(then),
            step * rate(then),
            step * step * second(then),
        )
        drive = thread_drive(stiffness, creep * step, extension(at), extension(then), *a)
        force, _area = thread_force(force, relaxation * step, drive, 1.0)
    return force


# Exact solutions


@pytest.mark.parametrize("relaxation", [0.0, 1e-6, 0.1, 10.0, 1e3, 1e6])
@pytest.mark.parametrize("creep", [0.0, 5.0, 10.0])
@pytest.mark.parametrize(("step", "steps"), [(1e-9, 50), (1e-3, 50), (0.25, 4), (1.0, 1), (5.0, 3)])
def test_constant_rate(relaxation, creep, step, steps):
    b, v = 67.0, 0.02
    t = step * steps
    force = run(lambda t: v * t, lambda t: v, lambda t: 0.0, step, steps, b, creep, relaxation)
    time, r, n = MP.mpf(t), MP.mpf(relaxation), MP.mpf(creep)
    if relaxation == 0.0:
        exact = b * MP.mpf(v) * (time + n * time**2 / 2)  # nothing is forgotten
    else:
        exact = b * MP.mpf(v) * (n * time / r + (1 - n / r) * -MP.expm1(-r * time) / r)
    # samples v t are rounded: that is a few roundings of b v t in all, however many steps; and each step
    # rounds the force
    assert abs(force - exact) < 5e-16 * b * v * t * (1.0 + creep * t) + 1e-16 * (steps + 10) * exact
    if relaxation >= 0.1 and t >= 1.0:
        assert constant_rate_force(t, v, b, creep, relaxation) == pytest.approx(float(exact), rel=1e-14)


# Turns and levels


@pytest.mark.slow
@given(unit, st.floats(0.0, 20.0), drives)
def test_force_turns_but_once_where_it_is_said_so(force, decay, drive):
    assume(turns_once(drive))
    slopes = []
    for k in range(101):
        value, _area = thread_force(force, decay, drive, k / 100)
        slopes.append(thread_growth(value, decay, drive, k / 100))
    signs = [slope > 0.0 for slope in slopes if abs(slope) > 1e-13]
    assert sum(one != other for one, other in pairwise(signs)) <= 1


@pytest.mark.parametrize("decay", [0.0, 1.0, 50.0, 1e6])
def test_located_level(decay):
    drive = (1.0 + decay, 0.0, 0.0, 0.0, 0.0, 0.0)
    # from 0 towards (1 + z) / z: passes a half of where it gets to
    end, _area = thread_force(0.0, decay, drive, 1.0)
    found = thread_locate(False, 0.5 * end, 0.0, decay, drive, 0.0, 1.0)
    exact = 0.5 if decay == 0.0 else -MP.log(1 - MP.mpf(0.5) * end * decay / (1 + decay)) / decay
    assert abs(found - exact) < 3e-15  # the bracket
    assert thread_force(0.0, decay, drive, found)[0] >= 0.5 * end


@pytest.mark.parametrize("decay", [0.5, 5.0, 500.0])
def test_located_turn(decay):
    # dF/du + z F = u from F = 1: falls, then rises with the drive; turns where F = u / z
    found = thread_locate(True, 0.0, 1.0, decay, [0.0, 1.0, 0.0, 0.0, 0.0, 0.0], 0.0, 3.0)
    z = MP.mpf(decay)
    exact = MP.log(1 + z**2) / z  # F = u/z - 1/z^2 + (1 + 1/z^2) exp(-z u)
    assert abs(found - exact) < 1e-12 * (1 + exact)  # the slope's rounding, z 1e-16, over its own slope
