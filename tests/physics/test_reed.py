"""Reed: the two linkages, their limits and margins."""

from math import atan2, cos, fabs, hypot, pi, sin

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from reference import MP, Jet
from reference import atan2 as jet_atan2
from reference import cos as jet_cos
from reference import sin as jet_sin
from reference import sqrt as jet_sqrt

from loomfmu.physics.linkage import four_bar
from loomfmu.physics.reed import (
    dead_centre,
    in_line_margin,
    reed_motion,
    rod_margin,
    smallest_transmission_angle,
    transmission_angle,
)

angle = st.floats(-7.0, 7.0)
length = st.floats(0.05, 1.0)
place = st.floats(-1.0, 1.0)
way = st.sampled_from([-1, 1])
swing = st.floats(0.05, 1.5)


@st.composite
def crank_rockers(draw):
    """Crank, coupler, rocker, place of the pivot: the crank turns over, at least 0.02 m clear."""
    crank = draw(st.floats(0.01, 0.3))
    # any two of the others are together longer than the third and the crank
    one, two, three = (draw(st.floats(0.01, 0.3)) for _ in range(3))
    coupler, rocker, frame = crank + one + two, crank + two + three, crank + three + one
    towards = draw(angle)
    return crank, coupler, rocker, frame * cos(towards), frame * sin(towards)


# Kinematics


@given(crank_rockers(), way, st.booleans())
def test_dead_centre_is_an_end_of_the_swing(linkage, assembly, extended):
    crank, coupler, rocker, x, y = linkage
    at = dead_centre(crank, coupler, rocker, x, y, assembly, extended)
    chi, first, _second = four_bar(at, 1.0, 0.0, crank, coupler, rocker, x, y, assembly)
    assert abs(first) < 1e-12  # rounding, magnified by a dead point 0.01 m off
    pin = hypot(x + rocker * cos(chi), y + rocker * sin(chi))
    assert pin == pytest.approx(coupler + (crank if extended else -crank), abs=1e-13)


def test_dead_centre_beyond_closing_is_no_domain_error():
    assert dead_centre(0.1, 0.2, 0.1, 1.0, 0.0, 1, True) == 0.0
    assert dead_centre(0.1, 0.2, 2.0, 1.0, 0.0, 1, True) == pytest.approx(-pi)


@given(length, length, st.floats(0.0, 1.0))
def test_transmission_angle_closes_the_triangle(coupler, rocker, share):
    low, high = fabs(coupler - rocker), coupler + rocker
    distance = low + share * (high - low)
    found = transmission_angle(distance, coupler, rocker)
    assert 0.0 <= found <= pi / 2
    square = coupler**2 + rocker**2 - distance**2
    # the cosine to rounding of squares up to 4, over a product of at least 0.005
    assert 2 * coupler * rocker * cos(found) == pytest.approx(abs(square), abs=1e-14)


@given(crank_rockers())
def test_smallest_transmission_angle_agrees_with_a_search(linkage):
    crank, coupler, rocker, x, y = linkage
    towards = atan2(y, x)  # the grid holds both places where crank and frame lie in line
    distances = [
        hypot(crank * cos(towards + k * pi / 360) - x, crank * sin(towards + k * pi / 360) - y)
        for k in range(720)
    ]
    searched = min(transmission_angle(distance, coupler, rocker) for distance in distances)
    found = smallest_transmission_angle(crank, coupler, rocker, hypot(x, y))
    assert found == pytest.approx(searched, abs=1e-13)  # rounding, 0.01 m off the dead point


@given(angle, st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), length, length, place)
def test_reed_motion_is_exact(chi, first, second, arm, rod, height):
    assume(rod - abs(height - arm * sin(chi)) > 0.02)
    exact = Jet(chi, first, second)
    across, drop = arm * jet_cos(exact), Jet(height) - arm * jet_sin(exact)
    reach = jet_sqrt(Jet(MP.mpf(rod) ** 2) - drop * drop)
    position = across + reach
    slope = jet_atan2(drop, reach)
    found = reed_motion(chi, first, second, arm, rod, height)
    # rounding, magnified by the nearness to the rod's dead point: up to 1 / (0.02 * 2) on each derivative
    assert abs(found[0] - position.value) < 1e-14
    assert abs(found[1] - position.first) < 1e-13 * (1 + abs(position.first))
    assert abs(found[2] - position.second) < 1e-12 * (1 + abs(position.second))
    assert abs(found[3] - slope.value) < 1e-13


@given(angle, st.floats(0.01, 1.5), length, length, place)
def test_rod_margin_agrees_with_a_search(middle, half, arm, rod, height):
    count = 400
    drops = [abs(height - arm * sin(middle + half * k / count)) for k in range(-count, count + 1)]
    found = rod_margin(middle, half, arm, rod, height)
    # the search can only overlook what is worse, by at most half a step's bend
    assert found <= rod - max(drops) + 1e-12
    assert found >= rod - max(drops) - 0.5 * arm * (half / count) ** 2 - 1e-12


@given(angle, st.floats(0.01, 1.5), length, length, place)
def test_arm_and_rod_in_line_agree_with_a_search(middle, half, arm, rod, height):
    assume(rod_margin(middle, half, arm, rod, height) > 0.01)
    assume(abs(arm - rod) > 1e-4)  # a reed that hardly moves, see the next test
    count = 400
    slopes = [
        reed_motion(middle + half * k / count, 1.0, 0.0, arm, rod, height)[1]
        for k in range(-count, count + 1)
    ]
    found = in_line_margin(middle, half, arm, rod, height)
    assume(abs(found) > 2 * half / count)  # what lies between the ends of the grid and the swing
    assert (min(slopes) < 0.0 < max(slopes)) == (found < 0.0)


def test_a_line_out_of_reach_has_no_angle_in_line():
    assert in_line_margin(1.0, 0.1, 0.1, 0.2, 0.5) == pi - 0.1


def test_equal_arm_and_rod_on_the_pivots_height():
    # while the arm points away from the reed, the reed stands over the pivot
    assert in_line_margin(pi, 0.1, 0.3, 0.3, 0.0) < 0.0
    assert in_line_margin(1.0, 0.1, 0.3, 0.3, 0.0) == pytest.approx(0.9)
