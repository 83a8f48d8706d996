"""Driven shaft: the exact solution in 200 digits, energy, and sums that lose nothing."""

from fractions import Fraction
from math import fsum

import mpmath
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from loomfmu.physics.driven_shaft import bulge_for, driven_motion, response, summed, work_of

MP = mpmath.mp.clone()
MP.dps = 200  # the closed form divides by k^2: with k h / J = 1e-18 it cancels 54 digits

torques = st.one_of(st.just(0.0), st.floats(-1e3, -1e-3), st.floats(1e-3, 1e3))
decades = st.floats(-9.0, 3.0)


def moved(net, rise, duration, inertia, slope):
    """Change of velocity and angle beyond that at the initial velocity, under a load on a straight line."""
    gained, more, _second, _third = driven_motion(0.0, net, rise, 0.0, response(duration, inertia, slope))
    return gained, more * duration


def solved(net, rise, duration, inertia, slope):
    """Velocity gained `v` and its integral: the solution of `J v' = N0 - dT t / h - k v`, `v(0) = 0`."""
    n, s, h, j, k = (MP.mpf(x) for x in (net, rise, duration, inertia, slope))
    s = s / h  # N m/s
    if k == 0:
        return (n * h - s * h**2 / 2) / j, (n * h**2 / 2 - s * h**3 / 6) / j
    b = -s / k  # v = a (1 - exp(-k t / J)) + b t
    a = (n - j * b) / k
    decay = MP.exp(-k * h / j)
    return a * (1 - decay) + b * h, a * h + b * h**2 / 2 - a * j / k * (1 - decay)


def agree(net, rise, duration, inertia, slope):
    found = moved(net, rise, duration, inertia, slope)
    wanted = solved(net, rise, duration, inertia, slope)
    # the motor's and the load's part are each right to rounding; their difference is to that of either
    parts = [solved(*each, duration, inertia, slope) for each in ((net, 0.0), (0.0, rise))]
    for value, exact, first, second in zip(found, wanted, *parts, strict=True):
        # 1e-300 is a step that adds nothing, 3e-15 some ten roundings and those of the moments
        assert abs(value - exact) <= 3e-15 * (abs(first) + abs(second)) + MP.mpf("1e-300")


@given(torques, torques, decades, decades, st.one_of(st.just(0.0), decades.map(lambda power: 10.0**power)))
def test_the_solution_is_exact_for_every_step_inertia_and_slope(net, rise, duration, inertia, slope):
    agree(net, rise, 10.0**duration, 10.0**inertia, slope)


@pytest.mark.parametrize("decay", [1e-18, 1e-9, 1e-3, 0.5, 2.999999, 3.0, 3.000001, 40.0, 1e3, 1e9, 1e18])
def test_no_decay_is_special(decay):
    # a series below 3 and a recursion above meet without a seam; exp(-1e3) is nought
    for net, rise in ((1.0, 0.0), (0.0, 1.0), (3.0, -2.0), (5.0, 5.0)):
        agree(net, rise, 0.5, 2.0, 4.0 * decay)


def test_a_step_of_no_length_moves_nothing():
    assert moved(5.0, 3.0, 0.0, 2.0, 40.0) == (0.0, 0.0)


# Loads on a parabola

FINE = mpmath.mp.clone()
FINE.dps = 60  # the particular part cancels 24 digits


def along(share, velocity, net, rise, bulge, duration, inertia, slope):
    """Velocity after a share of a step, in 60 digits: a polynomial and a decay."""
    u, h, j, k = FINE.mpf(share), FINE.mpf(duration), FINE.mpf(inertia), FINE.mpf(slope)
    n0, n1, n2 = FINE.mpf(net), -FINE.mpf(rise) - 6 * FINE.mpf(bulge), 6 * FINE.mpf(bulge)
    if k == 0:
        return velocity + h / j * (n0 * u + n1 * u**2 / 2 + n2 * u**3 / 3)
    z = k * h / j
    c2 = n2 / k
    c1 = (n1 - 2 * c2 * k / z) / k
    c0 = (n0 - c1 * k / z) / k
    return velocity + c0 + c1 * u + c2 * u**2 - c0 * FINE.exp(-z * u)


@settings(max_examples=10, deadline=None)  # quadratures in 60 digits
@given(
    st.floats(-50.0, 50.0),
    torques,
    torques,
    torques,
    st.floats(-5.0, 0.0),
    st.floats(0.0, 2.0),
    st.sampled_from([0.0, 0.1, 40.0]),
)
def test_motion_and_work_are_exact_for_a_load_on_a_parabola(velocity, net, rise, bulge, size, mass, slope):
    step = (10.0**size, 10.0**mass, slope)
    gained, more, second, third = driven_motion(velocity, net, rise, bulge, response(*step))

    def at(share):
        return along(share, FINE.mpf(velocity), net, rise, bulge, *step)

    # a polynomial and a decay by exp(-40) at most, on 8 pieces: exact to 1e-17
    pieces = FINE.linspace(0, 1, 9)
    largest = abs(velocity) + step[0] / step[1] * (abs(net) + abs(rise) + 6.0 * abs(bulge))
    assert abs(velocity + gained - at(1)) <= 1e-14 * largest  # some ten roundings
    assert (
        abs(velocity + more - FINE.quad(at, pieces, method="gauss-legendre", maxdegree=4)) <= 1e-14 * largest
    )
    start = 17.0

    def power(u):
        return (start + FINE.mpf(rise) * u + 6 * FINE.mpf(bulge) * u * (1 - u)) * at(u)

    work = work_of(start, rise, bulge, step[0], velocity + more, second, third)
    torque = start + abs(rise) + 12.0 * abs(bulge)
    assert (
        abs(work - step[0] * FINE.quad(power, pieces, method="gauss-legendre", maxdegree=4))
        <= 1e-14 * step[0] * largest * torque
    )


@given(st.floats(5.0, 60.0), torques, torques, st.floats(-5.0, -2.0), st.sampled_from([0.0, 40.0]))
def test_the_bulge_makes_torques_do_a_known_work(velocity, net, rise, size, slope):
    duration, inertia, start, wanted = 10.0**size, 2.0, 7.0, 0.3
    for way in (1.0, -1.0):
        by = response(duration, inertia, slope)
        given = (way * start, way * rise, way * velocity, way * net, way * rise, duration, by)
        bulge = bulge_for(wanted, *given)
        gained, more, second, third = driven_motion(way * velocity, way * net, way * rise, bulge, by)
        work = work_of(way * start, way * rise, bulge, duration, way * velocity + more, second, third)
        if way * (velocity * way + gained) > 0.0 and abs(gained) < velocity:
            # rounding of the work of either part
            assert work == pytest.approx(
                wanted, abs=1e-12 * duration * velocity * (abs(rise) + abs(bulge) + 8.0)
            )
    assert (
        bulge_for(1.0, 7.0, 0.0, 0.0, 0.0, 0.0, 0.1, response(0.1, 2.0, 0.0)) == 0.0
    )  # at rest a torque does no work


def test_work_that_cannot_be_done_stops_at_what_can():
    # to give away more than it has would need the root of a negative number
    assert bulge_for(1e6, 0.0, 0.0, 1.0, 0.0, 0.0, 0.1, response(0.1, 2.0, 0.0)) > 0.0


# Sums


@given(st.floats(-1e9, 1e9), st.floats(-1e-7, 1e-7), st.floats(-1e9, 1e9))
def test_what_a_sum_leaves_over_is_its_rounding(value, rest, change):
    total, left = summed(value, rest, change)
    assert Fraction(total) + Fraction(left) == Fraction(value) + Fraction(change + rest)  # exactly


@given(st.lists(st.floats(0.0, 1.0), min_size=1, max_size=200), st.floats(0.0, 1e6))
def test_many_sums_are_as_good_as_one(changes, start):
    value, rest = start, 0.0
    for change in changes:
        value, rest = summed(value, rest, change)
    exact = fsum([start, *changes])
    # the sum rounded once; what is left over is itself rounded, 200 times to 1e-16 of 1
    assert value == pytest.approx(exact, rel=2.3e-16, abs=3e-14)
    assert value + rest == pytest.approx(exact, rel=2.3e-16)
