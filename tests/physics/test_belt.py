"""Belt: length factor, critical load, margin, speed limit and deflection."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference import ALL_MACHINES, MP, machine
from scipy.interpolate import PchipInterpolator

from loomfmu.machines import table
from loomfmu.physics.belt import (
    NO_LIMIT,
    complete_elliptic,
    critical_force,
    elastica_deflection,
    length_factor,
    margin,
    speed_limit,
)

KNOTS = [(1e-3 * float(row["clearance_mm"]), float(row["length_factor"])) for row in table("length_factor")]
STIFFNESS = 0.25
positive = st.floats(1e-3, 3.0)


def test_length_factor_is_the_monotone_cubic_of_the_published_points():
    clearance, factor = zip(*KNOTS, strict=True)
    monotone = PchipInterpolator(clearance, factor)
    for at in np.linspace(0.0, 0.8e-3, 1601):
        # both evaluate the same cubic, in different forms: rounding
        assert length_factor(at) == pytest.approx(float(monotone(at)), abs=1e-14)
    assert length_factor(0.85e-3) == 1.0  # pinned


@pytest.mark.parametrize("name", ALL_MACHINES)
@pytest.mark.parametrize("stroke", ["insertion", "return"])
def test_margin_and_safe_speed_at_the_worst_angle(name, stroke):
    of = machine(name)
    theta = of.worst_angle()
    if stroke == "return":
        theta = 2 * MP.pi - theta
    travel, _slope, bend = of.travel(theta)
    free, mass = travel - of.guide, float(of.mass)
    safe = of.safe_speed(theta, 0.8)
    found = speed_limit(float(free), float(bend), 0.8, STIFFNESS, mass, 0.0)
    # rounding of the inputs to 1e-16, over a free length that is a difference of 2 m and 0.8 m: 1e-14
    assert abs(found / safe - 1) < 1e-10
    force = mass * float(bend) * 50.0**2
    exact = 1 - (50 / safe) ** 2
    assert abs(margin(float(free), force, 0.8, STIFFNESS) / exact - 1) < 1e-10
    assert abs(margin(float(free), mass * float(bend) * found**2, 0.8, STIFFNESS)) < 1e-14  # it just buckles


@given(positive, st.floats(-500.0, 500.0), st.floats(0.5, 1.2))
def test_margin_belongs_to_the_critical_load(free, force, factor):
    critical = critical_force(free, factor, STIFFNESS)
    exact = 1 - MP.mpf(force) * (MP.mpf(factor) * MP.mpf(free)) ** 2 / (MP.pi**2 * MP.mpf("0.25"))
    # a few roundings of the load's share
    assert abs(margin(free, force, factor, STIFFNESS) - exact) < 1e-15 * (1 + abs(force) / critical)
    assert margin(free, critical, factor, STIFFNESS) == pytest.approx(0.0, abs=1e-15)


@given(positive, st.floats(1e-3, 10.0), st.floats(0.5, 1.2), st.floats(-5.0, 5.0))
def test_speed_limit_is_where_the_margin_vanishes(free, slope, factor, tension):
    limit = speed_limit(free, slope, factor, STIFFNESS, 0.11, tension)
    if 0.0 < limit < NO_LIMIT:
        force = 0.11 * slope * limit**2 + tension
        # the spare load is a difference: rounding of its terms
        assert margin(free, force, factor, STIFFNESS) == pytest.approx(0.0, abs=4e-15 * (1 + abs(tension)))
    if limit == 0.0:
        assert margin(free, tension, factor, STIFFNESS) <= 0.0


@pytest.mark.parametrize(
    ("case", "limit"),
    [
        ((-0.1, 1.0, 0.0), NO_LIMIT),  # inside the guide
        ((0.0, 1.0, 0.0), NO_LIMIT),  # at its edge
        ((0.2, 0.0, 0.0), NO_LIMIT),  # the head does not push
        ((0.2, -1.0, 0.0), NO_LIMIT),  # it pulls
        ((1e-6, 1.0, 0.0), NO_LIMIT),  # hardly outside: above what is worth telling
        ((0.2, 1.0, 1e3), 0.0),  # the weft alone buckles the belt
    ],
)
def test_speed_limit_where_there_is_none(case, limit):
    free, slope, tension = case
    assert speed_limit(free, slope, 0.8, STIFFNESS, 0.11, tension) == limit


@given(st.floats(0.0, 0.999999))
def test_complete_elliptic_integral(modulus):
    exact = MP.ellipk(MP.mpf(modulus) ** 2)
    # 1 - k^2 is rounded to 1e-16 and enters the logarithm of K with its reciprocal, 5e5 at most
    assert abs(complete_elliptic(modulus) / exact - 1) < 4e-16 + 1e-16 / (1 - modulus**2)


@pytest.mark.parametrize(
    "ratio", [1.0 + 1e-9, 1.0 + 1e-6, 1.001, (686 / 685) ** 2, 1.1, 2.0, 5.0, 50.0, 130.0, 138.0, 1e3, 1e6]
)
def test_deflection_is_the_exact_elastica(ratio):
    target = MP.pi / 2 * MP.sqrt(MP.mpf(ratio))
    k = MP.mpf(1)  # but for 8 exp(-2 target)
    if target < 45:
        # sought in the logarithm of the complementary parameter: it does not crowd at 1 for high loads
        bracket = (-2 * target, -MP.mpf("1e-12"))
        rest = MP.findroot(
            lambda x: MP.ellipk(1 - MP.exp(x)) - target, bracket, solver="anderson", tol=1e-60, maxsteps=200
        )
        k = MP.sqrt(1 - MP.exp(rest))
    exact = k / target
    # near the critical load k is the square root of a difference to 1: rounding over 1e-9 leaves 1e-7
    slack = 1e-12 + 1e-15 / (ratio - 1.0)
    assert abs(elastica_deflection(ratio, 1.0) / exact - 1) < slack


def test_deflection_is_none_below_the_critical_load_and_bounded_above():
    for ratio in (-math.inf, -3.0, 0.0, 1.0 - 1e-16, 1.0):
        assert elastica_deflection(ratio, 0.2) == 0.0
    for inside in (0.0, -0.0, -5e-324, -0.2):
        assert elastica_deflection(2.0, inside) == 0.0
    # beyond the modulus that a float can tell from 1 the load ratio alone remains: continuous there
    edge = (2 / math.pi * complete_elliptic(1.0 - 1e-15)) ** 2
    below, above = (elastica_deflection(edge * (1 + side), 1.0) for side in (-1e-9, 1e-9))
    assert below == pytest.approx(above, rel=1e-8)
    for ratio in (1e10, 1e100, 1.7e308):  # it folds
        assert elastica_deflection(ratio, 0.2) == pytest.approx(0.4 / math.pi / ratio**0.5, rel=1e-15)
