"""Eccentric chain, knives and hooks: against the motion of points, and against the triangles' corners."""

from math import atan2, cos, hypot, pi, sin

import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference import MP

from loomfmu.design.dobby import HOOK_BASE, eccentric_chain, hook_angle
from loomfmu.errors import LoomfmuError


def taken_up(driver, driven, eccentricity, distance, turn):
    """Chain that the driver has taken up when the driven shaft has turned, up to a constant.

    The chain runs from the driven sprocket along the outer tangent on the left to the driver. From a link on
    the driven sprocket to one on the driver there is always as much of it, with n the direction of both
    tangent points from the centres and t the driver's turn: `r2 (n - turn) + strand + r1 (t - n)`.
    """
    x, y = distance + eccentricity * MP.cos(turn), eccentricity * MP.sin(turn)
    apart = MP.sqrt(x * x + y * y)
    normal = MP.atan2(y, x) + MP.acos((driver - driven) / apart)
    return driven * (turn - normal) - MP.sqrt(apart * apart - (driver - driven) ** 2) + driver * normal


@pytest.mark.parametrize(
    ("driver", "driven", "eccentricity", "distance"),
    [(0.06, 0.06, 0.015, 0.6), (0.05, 0.08, 0.03, 0.2), (0.08, 0.05, 0.02, 0.3)],
)
@pytest.mark.parametrize("turn", [0.0, 1.0, 2.5, 4.0])
def test_speed_from_the_chain_that_is_paid_out(driver, driven, eccentricity, distance, turn):
    lengths = [MP.mpf(each) for each in (driver, driven, eccentricity, distance)]
    expected = lengths[0] / MP.diff(lambda at: taken_up(*lengths, at), MP.mpf(turn))
    chain = eccentric_chain(driver, driven, eccentricity, distance)
    assert chain.speed_ratio(turn) == pytest.approx(float(expected), rel=1e-13)


@given(st.floats(0.02, 0.2), st.floats(0.02, 0.2), st.floats(0.0, 0.9))
def test_extremes_bound_every_speed(driver, driven, share):
    chain = eccentric_chain(driver, driven, share * driven, 1.0)
    speeds = [chain.speed_ratio(2.0 * pi * k / 720) for k in range(720)]
    low, high = chain.extremes()
    assert low * (1 - 1e-14) <= min(speeds) and max(speeds) <= high * (1 + 1e-14)
    # half a step from the extreme at most, plus what the normal turns: (0.01)^2 of e over r
    assert min(speeds) == pytest.approx(low, rel=1e-3)
    assert max(speeds) == pytest.approx(high, rel=5e-3)


@pytest.mark.parametrize(
    ("given_", "message"),
    [
        (
            (0.06, 0.06, 0.06, 0.6),
            "eccentricity = 60 mm must be below the radius of the driven sprocket, 60 mm",
        ),
        ((0.06, 0.06, 0.01, 0.1), "distance = 100 mm must exceed both radii and the eccentricity, 130 mm"),
    ],
)
def test_chains_that_cannot_run_are_refused(given_, message):
    with pytest.raises(LoomfmuError, match=message):
        eccentric_chain(*given_)


def test_hook_angle_from_the_corners_of_the_linkage():
    rho, phi, f, c, b, eta = 0.2, 0.1, 0.3, 0.25, 0.2, HOOK_BASE
    # A in the origin, D at the angle 90 deg - (phi + eta) from AK, M on the far side of DK
    k = (rho, 0.0)
    corner = pi / 2 - (phi + eta)
    d = (f * cos(corner), f * sin(corner))
    s = hypot(k[0] - d[0], k[1] - d[1])
    along = (s * s + c * c - b * b) / (2 * s)
    across = (c * c - along * along) ** 0.5
    unit = ((k[0] - d[0]) / s, (k[1] - d[1]) / s)

    def angle(at, one, other):
        return abs(
            (atan2(one[1] - at[1], one[0] - at[0]) - atan2(other[1] - at[1], other[0] - at[0]) + pi)
            % (2 * pi)
            - pi
        )

    for side in (1.0, -1.0):
        m = (
            d[0] + along * unit[0] - side * across * unit[1],
            d[1] + along * unit[1] + side * across * unit[0],
        )
        if (
            abs(angle(d, (0.0, 0.0), m) - angle(d, (0.0, 0.0), k) - angle(d, k, m)) < 1e-12
        ):  # K between A and M
            expected = pi - angle(d, (0.0, 0.0), m) + eta - angle(m, d, k)
            assert hook_angle(rho, phi, frame=f, link=c, hook=b) == pytest.approx(expected, abs=1e-12)
            return
    pytest.fail("D sees K between A and M on neither side")


def test_eta_is_the_published_one():
    assert pytest.approx((40 + 7 / 60 + 20 / 3600) * pi / 180, rel=1e-15) == HOOK_BASE


def test_a_triangle_that_does_not_close_is_refused():
    with pytest.raises(
        LoomfmuError, match=r"the triangle DMK does not close: its sides are 50, \d+\.\d+ and 50 mm"
    ):
        hook_angle(0.2, 0.0, frame=0.3, link=0.05, hook=0.05)
