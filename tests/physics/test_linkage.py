"""Linkage: closure, exact derivatives, and the checks that tell whether it closes over a whole turn."""

from math import acos, cos, hypot, pi, sin

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from reference import ALL_MACHINES, MP, Jet, machine, sector_angle

from loomfmu.physics.linkage import (
    four_bar,
    four_bar_margin,
    spherical_margin,
    spherical_rocker,
    weft_motion,
    wrapped,
)

angle = st.floats(-7.0, 7.0)
arc = st.floats(0.1, 3.0)
cone = st.floats(0.01, 1.5)
length = st.floats(0.05, 1.0)
place = st.floats(-1.0, 1.0)
way = st.sampled_from([-1, 1])


def sector(weft: dict, theta: float) -> tuple[float, float, float]:
    """`weft_motion` of a machine; without a four-bar its lengths are not used."""
    bars = [weft.get(f"{bar}_length", 1.0) for bar in ("crank", "coupler", "output")]
    return weft_motion(
        theta + weft["crank_phase"],
        weft["rocker_angle"],
        weft["crank_cone"],
        weft["rocker_offset"],
        weft["planar_linkage"],
        *bars,
        weft.get("pivot_x", 0.0),
        weft.get("pivot_y", 0.0),
        weft.get("assembly", 1),
    )


@pytest.mark.parametrize("name", ALL_MACHINES)
def test_the_reference_is_right(name):
    # mpmath differentiates the plain closed form numerically, at twice the working precision
    weft = machine(name).weft
    for theta in (MP.mpf("0.3"), MP.mpf("1.7"), MP.mpf("4.4")):
        jet = machine(name).sector(theta)
        for order, value in ((1, jet.first), (2, jet.second)):
            numeric = MP.diff(lambda t: sector_angle(weft, Jet(t)).value, theta, order)
            # 50 digits, less those that a second difference costs
            assert abs(numeric - value) < 1e-30


@given(st.floats(-1.0, 1.0), cone, angle)
def test_spherical_linkage_closes(arc_share, crank_cone, theta):
    rocker = acos(arc_share * cos(crank_cone))
    alpha, _first, _second = spherical_rocker(theta, rocker, crank_cone)
    # equation (1)
    residual = cos(rocker) - cos(crank_cone) * cos(alpha) + sin(crank_cone) * sin(alpha) * cos(theta)
    assert abs(residual) < 2e-15  # rounding of three terms of size 1


@given(arc, cone)
def test_spherical_margin_agrees_with_a_search(rocker, crank_cone):
    turns = [k * pi / 1800 for k in range(3601)]
    closes = min(hypot(cos(crank_cone), sin(crank_cone) * cos(t)) for t in turns) - abs(cos(rocker))
    # the grid holds pi/2, where the distance is least: both are the same number, up to rounding
    assert spherical_margin(rocker, crank_cone) == pytest.approx(closes, abs=1e-15)


@given(angle, length, length, place, place, st.floats(0.001, 0.999), way)
def test_four_bar_keeps_the_length_of_its_coupler(psi, crank, output, x, y, coupler_share, assembly):
    distance = hypot(crank * cos(psi) - x, crank * sin(psi) - y)
    assume(distance > 0.05)
    # between the two lengths that put it in one line with the output bar
    shortest = abs(distance - output)
    coupler = shortest + coupler_share * (distance + output - shortest)
    chi, _first, _second = four_bar(psi, 1.0, 0.0, crank, coupler, output, x, y, assembly)
    rod = hypot(crank * cos(psi) - x - output * cos(chi), crank * sin(psi) - y - output * sin(chi))
    # rounding of squared lengths up to 6 m2 in the cosine rule, over the shortest distance of 0.05 m
    assert rod**2 == pytest.approx(coupler**2, abs=1e-13)


@given(angle, st.floats(0.0, 6.2), length, length, length, place, place)
def test_four_bar_margin_agrees_with_a_search(low, swing, crank, coupler, output, x, y):
    count = 2000
    distances = [
        hypot(crank * cos(psi) - x, crank * sin(psi) - y)
        for psi in (low + swing * k / count for k in range(count + 1))
    ]
    searched = min(min(distances) - abs(coupler - output), coupler + output - max(distances))
    found = four_bar_margin(low, low + swing, crank, coupler, output, x, y)
    # the distance changes by at most `crank` per radian, so the grid misses half a step of that at most;
    # it can only overlook what is worse
    assert found <= searched + 1e-12
    assert found >= searched - 0.5 * crank * swing / count - 1e-12


@given(
    angle,
    st.floats(-1.0, 1.0),
    st.floats(0.05, 1.4),
    st.floats(-3.0, 3.0),
    length,
    length,
    place,
    place,
    st.floats(0.0, 1.0),
    way,
)
def test_derivatives_of_any_linkage_are_exact(
    theta, arc_share, crank_cone, offset, crank, output, x, y, coupler_share, assembly
):
    # a spherical linkage 0.05 away from its dead point at least
    rocker = acos(arc_share * (cos(crank_cone) - 0.05))
    alpha, _first, _second = spherical_rocker(theta, rocker, crank_cone)
    # a coupler that closes the triangle here, 0.02 away from its dead points at least
    distance = hypot(crank * cos(alpha + offset) - x, crank * sin(alpha + offset) - y)
    assume(distance > 0.05)
    shortest, longest = abs(distance - output) + 0.02, distance + output - 0.02
    coupler = shortest + coupler_share * (longest - shortest)
    weft = {
        "rocker_angle": rocker,
        "crank_cone": crank_cone,
        "crank_phase": 0.0,
        "rocker_offset": offset,
        "planar_linkage": True,
        "crank_length": crank,
        "coupler_length": coupler,
        "output_length": output,
        "pivot_x": x,
        "pivot_y": y,
        "assembly": assembly,
    }
    exact = sector_angle(weft, Jet(theta, 1))
    found = sector(weft, theta)
    # rounding of 1e-16, magnified by the nearness to the dead points: up to (1 / 0.02)^2 on each derivative
    assert abs(found[0] - exact.value) < 1e-13
    assert abs(found[1] - exact.first) < 1e-12 * (1 + abs(exact.first))
    assert abs(found[2] - exact.second) < 1e-11 * (1 + abs(exact.first) ** 2 + abs(exact.second))


@pytest.mark.parametrize("rocker", [0.9, pi - 0.9])
def test_spherical_linkage_beyond_its_dead_point_is_no_domain_error(rocker):
    # |cos(rocker)| > cos(cone): the arc cosine's argument is cut at 1 and at -1
    alpha, _first, _second = spherical_rocker(0.5 * pi + 1e-3, rocker, 1.0)
    assert alpha == pytest.approx(0.0 if rocker < 1.0 else pi, abs=2e-3)


def test_without_a_four_bar_the_rocker_is_the_sector_gear():
    bars = (0.5, False, 0.1, 0.2, 0.1, 0.2, 0.0, 1)
    assert weft_motion(0.7, 1.2, 0.5, *bars) == spherical_rocker(0.7, 1.2, 0.5)


@given(st.floats(-3 * pi + 1e-9, 3 * pi - 1e-9))
def test_wrapped_is_the_same_angle(value):
    inside = wrapped(value)
    assert -pi <= inside <= pi
    assert cos(inside) == pytest.approx(cos(value), abs=5e-15)  # rounding of an angle up to 3 pi
    assert sin(inside) == pytest.approx(sin(value), abs=5e-15)
