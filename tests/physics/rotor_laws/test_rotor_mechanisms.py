"""Slotted levers and non-circular gears: as the source has them, closed, and never turning back."""

from itertools import pairwise
from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference import MP

from loomfmu.physics.rotor_laws.mechanisms import (
    gear_speed_extremes,
    noncircular_gears,
    slotted_lever,
    slotted_levers,
    slotted_levers_place,
)
from loomfmu.physics.rotor_laws.rotor import (
    HARMONIC_ENDS,
    SLOPED_LINE,
    SLOPED_SINE,
    UNIFORM,
    highest_rates,
    rotor_law,
)

LEVERS = [(0.1, 0.1, 0.04), (0.08, 0.15, 0.05), (0.2, 0.1, 0.08), (0.1, 0.1, 0.0)]
GEARS = [(-0.27, -0.13, -0.05, -0.025), (0.0, 0.0, 0.0, 0.0), (0.2, -0.3, 0.1, 0.15)]
PLACES = (-0.5, 0.0, 0.1, 1.0, 2.0, 3.0, pi, 3.5, 5.0, 6.2)

radius = st.floats(0.05, 0.5)
share = st.floats(0.0, 0.95)
harmonic = st.integers(-1000, 1000).map(lambda thousandths: thousandths / 1000)
any_angle = st.floats(-10.0, 10.0)


def speed_1_12(alpha, r, b, e, angle):
    """The output speed of (1.12) over the input's; `angle` makes the angle of the lever from x and y."""
    p = angle(r * MP.sin(alpha), r * MP.cos(alpha) - e)
    one = (r * r - r * e * MP.cos(alpha)) / (r * r - 2 * r * e * MP.cos(alpha) + e * e)
    return one * (b * b - b * e * MP.cos(p)) / (b * b + e * e - 2 * b * e * MP.cos(p))


# Slotted levers


@pytest.mark.no_cover
@pytest.mark.parametrize(("r", "b", "e"), LEVERS)
def test_levers_have_the_speed_of_1_12(r, b, e):
    exact = [MP.mpf(value) for value in (r, b, e)]

    def speed(x):
        return speed_1_12(x + MP.pi, *exact, MP.atan2)  # the source's slow point lies at alpha = pi

    angles = [MP.mpf(0)]  # from the first place on, each piece integrated once
    for low, high in pairwise(PLACES):
        piece, uncertain = MP.quad(speed, [low, high], error=True)
        assert uncertain < 1e-20
        angles.append(angles[-1] + piece)
    for x, angle in zip(PLACES, angles, strict=True):
        value, first, second = MP.taylor(speed, MP.mpf(x), 2)
        angle -= angles[PLACES.index(0.0)]
        found = slotted_levers(x, r, b, e)
        # some twenty roundings; the derivatives reach 8, 27 and 500, from radii of up to 5 to 1
        assert abs(found[0] - angle) < 1e-14
        assert abs(found[1] - value) < 1e-13
        assert abs(found[2] - first) < 1e-12
        assert abs(found[3] - 2 * second) < 2e-11


@given(radius, radius, share, any_angle)
def test_levers_close_and_are_symmetric(r, b, part, x):
    e = part * min(r, b)
    here = slotted_levers(x, r, b, e)
    # x + 2 pi is rounded to 2e-15; the speed is up to 400 and the derivatives grow by 40 each
    scale = np.array([1.0, 40.0, 1600.0, 64000.0]) * highest_speed(r, b, e)
    on = np.array(slotted_levers(x + 2.0 * pi, r, b, e)) - (2.0 * pi, 0.0, 0.0, 0.0)
    assert np.all(abs(on - here) < 1e-13 * scale)
    back = np.array(slotted_levers(-x, r, b, e)) * (-1.0, 1.0, -1.0, 1.0)
    assert np.all(back == np.array(here))


def highest_speed(r, b, e):
    return r * b / ((r - e) * (b - e))


@given(radius, radius, share, any_angle)
def test_levers_turn_fastest_opposite_the_slow_point(r, b, part, x):
    e = part * min(r, b)
    speed = slotted_levers(x, r, b, e)[1]
    lowest = r * b / ((r + e) * (b + e))
    assert slotted_levers(0.0, r, b, e)[1] == pytest.approx(lowest, rel=1e-14)  # rounding
    # pi itself is rounded, to 1e-16, where the speed is stationary; its terms cancel to 1 - part
    assert slotted_levers(pi, r, b, e)[1] == pytest.approx(highest_speed(r, b, e), rel=1e-12)
    assert lowest * (1.0 - 1e-14) <= speed <= highest_speed(r, b, e) * (1.0 + 1e-12)


@given(radius, radius, share, any_angle)
def test_levers_found_from_their_angle(r, b, part, x):
    e = part * min(r, b)
    angle, speed, _second, _third = slotted_levers(x, r, b, e)
    # the angle is rounded to 2e-15, and the slowest rotor turns at a quarter of the shaft's speed; near
    # the quarter turns of the levers the arc sine is steep by up to 1 / sqrt(1 - part^2) = 3.2, twice
    assert slotted_levers_place(angle, r, b, e) == pytest.approx(x, abs=1e-13 * max(1.0, 1.0 / speed))


@given(st.floats(-10.0, 10.0), radius, share)
def test_one_lever_is_the_angle_of_its_pin(x, q, part):
    e = part * q
    pin = np.exp(1j * x) * q + e  # from the eccentric, which lies on the side of the slow point
    found = slotted_lever(x, q, e)[0]
    # rounding, magnified by 1 / (1 - part) where the pin comes near
    assert np.exp(1j * found) == pytest.approx(pin / abs(pin), abs=1e-13)


# Gears


@pytest.mark.parametrize("harmonics", GEARS)
def test_gears_are_those_of_1_13(harmonics):
    exact = [MP.mpf(value) for value in harmonics]

    def angle(x):
        return x + sum(a / k * MP.sin(k * x) for k, a in enumerate(exact, start=1))

    for x in PLACES:
        taylor = MP.taylor(angle, MP.mpf(x), 3)
        for order, factorial in enumerate((1, 1, 2, 6)):
            # a few roundings of terms up to 6, 1, 1 and 4
            assert abs(noncircular_gears(x, *harmonics)[order] - factorial * taylor[order]) < 1e-14


@given(harmonic, harmonic, harmonic, harmonic, any_angle)
def test_gears_close_and_are_symmetric(a1, a2, a3, a4, x):
    here = np.array(noncircular_gears(x, a1, a2, a3, a4))
    on = np.array(noncircular_gears(x + 2.0 * pi, a1, a2, a3, a4)) - (2.0 * pi, 0.0, 0.0, 0.0)
    # x + 2 pi is rounded to 2e-15, times the next derivative: up to 5, 10, 30 and 100
    assert np.all(abs(on - here) < (2e-14, 4e-14, 1e-13, 4e-13))
    assert np.all(np.array(noncircular_gears(-x, a1, a2, a3, a4)) * (-1, 1, -1, 1) == here)


@given(harmonic, harmonic, harmonic, harmonic)
def test_no_minimum_of_the_gears_speed_is_missed(a1, a2, a3, a4):
    lowest, highest = gear_speed_extremes(a1, a2, a3, a4)
    series = np.polynomial.Chebyshev([1.0, a1, a2, a3, a4])  # cos k x = T_k(cos x)
    places = series.deriv().roots()
    inside = places.real[(abs(places.imag) < 1e-6) & (abs(places.real) < 1.0)]
    speeds = series(np.concatenate([[-1.0, 1.0], inside]))
    # roots good to 1e-7 at worst, two that fall together, where the speed is flat; and rounding
    assert lowest == pytest.approx(speeds.min(), abs=1e-13)
    assert highest == pytest.approx(speeds.max(), abs=1e-13)


# Peaks of the modulator's laws


@pytest.mark.parametrize("law", [UNIFORM, HARMONIC_ENDS, SLOPED_LINE, SLOPED_SINE])
@pytest.mark.parametrize("reduction", [0.0, 0.3, 0.7, 1.0])
def test_peaks_of_the_modulators_laws(law, reduction):
    speed, acceleration, jerk = highest_rates(law, reduction)
    grid = np.linspace(0.0, 2.0 * pi, 14401)  # holds pi/8 and all its multiples
    rates = np.array([rotor_law(law, float(x), reduction) for x in grid])
    assert speed == pytest.approx(rates[:, 1].max(), abs=1e-14)  # rounding: the crests are on the grid
    assert acceleration == pytest.approx(abs(rates[:, 2]).max(), abs=1e-14)
    # chords of an acceleration that is smooth between its knots: below the largest slope by (4 h)^2 / 6
    chords = abs(np.diff(rates[:, 2])).max() / (grid[1] - grid[0])
    assert chords == pytest.approx(jerk, rel=1e-6, abs=1e-12)
