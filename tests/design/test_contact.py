"""Contact of cam and roller: Hertz's pressure against the elastic half-plane, motion against differences."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import make_interp_spline

from loomfmu.design.cam import TURN, design_cam, lift_law
from loomfmu.design.contact import radial_contact, rocker_contact
from loomfmu.design.rocker_cam import design_rocker_cam
from loomfmu.errors import LoomfmuError

SPEED = 60.0  # rad/s of the main shaft
SMOOTH = lift_law(lambda angle: 1.0 - np.cos(angle))
OF_RADIAL = {"speed": SPEED, "mass": 15.0, "load": 2000.0, "width": "20 mm"}
DRIVE = {"distance": "200 mm", "arm": "160 mm", "lowest_angle": "30 deg", "swing": "8 deg"}
COUNTER = DRIVE | {"lowest_angle": "38 deg", "swing": "-8 deg", "trailing": False}
OF_ROCKER = {"speed": SPEED, "inertia": 0.5, "width": "20 mm"}
either = pytest.mark.parametrize("on_roller", [False, True])


def by_angle(values, angles):
    """First and second derivative of what is periodic in the angle of the roller, by a quintic spline."""
    order = np.argsort(angles[:-1] % TURN)
    x, y = (angles[:-1] % TURN)[order], values[:-1][order]
    spline = make_interp_spline(np.append(x, x[0] + TURN), np.append(y, y[0]), k=5, bc_type="periodic")
    at = np.where(angles % TURN < x[0], angles % TURN + TURN, angles % TURN)
    return spline(at, 1), spline(at, 2)


@either
def test_force_and_speed_of_a_radial_roller_are_those_of_its_path(on_roller):
    cam = design_cam(SMOOTH, law_on_roller=on_roller)
    found = radial_contact(cam, **OF_RADIAL)
    radius, place = np.hypot(*cam.path.T), np.unwrap(np.arctan2(cam.path[:, 1], cam.path[:, 0]))
    first, second = by_angle(radius, place)
    force = (2000.0 + 15.0 * second * 30.0**2) * np.hypot(1.0, first / radius)
    # of the spline
    assert found.force == pytest.approx(force, rel=1e-6)
    # where the profile goes in the frame of a roller that does not turn: along its tangent
    profile = cam.profile[:, 0] + 1j * cam.profile[:, 1]
    path = cam.path[:, 0] + 1j * cam.path[:, 1]
    outwards = path / np.abs(path)
    body = 1j * 30.0 * profile  # the cam turns, the roller's centre goes along its guide
    centre = first * 30.0 * outwards * (-1.0)
    tangent = 1j * (path - profile) / cam.roller_radius
    assert found.sliding_speed == pytest.approx(np.real((body - centre) * np.conj(tangent)), rel=1e-6)


def test_a_cam_that_speeds_up_pushes_its_roller_where_that_rises():
    cam = design_cam(SMOOTH)
    still, sped = (radial_contact(cam, **OF_RADIAL, acceleration=each) for each in (0.0, 800.0))
    radius, place = np.hypot(*cam.path.T), np.unwrap(np.arctan2(cam.path[:, 1], cam.path[:, 0]))
    first, _second = by_angle(radius, place)
    more = 15.0 * first * 400.0 * np.hypot(1.0, first / radius)
    assert sped.force - still.force == pytest.approx(more, rel=1e-6, abs=1e-6 * np.max(more))  # of the spline


def test_a_round_cam_on_a_roller_has_the_pressure_of_two_cylinders():
    cam = design_cam(lift_law(lambda angle: np.cos(angle)), lowest_radius=0.1, highest_radius=0.1 + 1e-7)
    found = radial_contact(cam, **OF_RADIAL | {"speed": 0.0}, roller_modulus="70 GPa")
    softness = (1.0 - 0.3**2) * (1.0 / 206e9 + 1.0 / 70e9)
    radius = 1.0 / (1.0 / 0.1 + 1.0 / 0.019)
    half, highest = found.half_width[0], found.pressure[0]
    pressure = lambda x: highest * np.sqrt(max(0.0, 1.0 - (x / half) ** 2))  # noqa: E731
    carried, _error = quad(pressure, -half, half, epsrel=1e-10)
    assert 0.02 * carried == pytest.approx(2000.0, rel=1e-6)  # a radius that is not quite constant
    for x in (-0.7 * half, 0.2 * half, 0.9 * half):  # both faces bend to one, by the half-plane's influence
        bent, _error = quad(pressure, -half, half, weight="cauchy", wvar=x)
        assert 2.0 * softness / pi * -bent == pytest.approx(x / radius, rel=1e-4)


@pytest.mark.parametrize("drive", [DRIVE, COUNTER], ids=["cam", "counter-cam"])
def test_a_rocker_gets_from_the_cam_the_work_that_it_takes(drive):
    cam = design_rocker_cam(SMOOTH, **drive)
    found = rocker_contact(cam, torque=200.0, **OF_ROCKER)
    _share, slope, bend = SMOOTH(cam.angle)
    rate = cam.swing * slope * 30.0  # of the rocker, as the cam turns at 30 rad/s
    power = (200.0 + 0.5 * cam.swing * bend * 30.0**2) * rate
    # a force along the normal at the profile of a cam that turns against the roller's way round it
    path, profile = (curve[:, 0] + 1j * curve[:, 1] for curve in (cam.path, cam.profile))
    normal = (path - profile) / cam.roller_radius
    given = found.force * np.real(np.conj(normal) * -1j * 30.0 * profile)
    assert given == pytest.approx(power, abs=1e-9 * np.abs(power).max())


def test_cam_and_counter_cam_share_what_the_rocker_takes():
    cam, counter = (design_rocker_cam(SMOOTH, **drive) for drive in (DRIVE, COUNTER))
    one = rocker_contact(cam, torque=10.0, **OF_ROCKER)
    other = rocker_contact(counter, torque=-10.0, **OF_ROCKER)
    assert ((one.force > 0.0) != (other.force > 0.0)).all()
    assert (np.minimum(one.pressure, other.pressure) == 0.0).all()
    assert one.highest_pressure > 0.0 < other.highest_pressure


def test_the_pressure_grows_with_the_root_of_the_load():
    cam = design_cam(SMOOTH)
    given = OF_RADIAL | {"speed": 0.0}
    once, four = (radial_contact(cam, **given | {"load": load}) for load in (500.0, 2000.0))
    assert four.pressure == pytest.approx(2.0 * once.pressure, rel=1e-14)
    assert four.endures("1 GPa") and not four.endures(0.99 * four.highest_pressure)


def test_a_roller_that_lifts_off_has_no_pressure():
    found = radial_contact(design_cam(SMOOTH), **OF_RADIAL | {"load": 10.0, "speed": "600 rpm"})
    assert found.force.min() < 0.0
    assert (found.pressure[found.force < 0.0] == 0.0).all()


def test_impossible_bodies_are_refused():
    with pytest.raises(LoomfmuError, match="contact_width = 0 mm is outside"):
        radial_contact(design_cam(SMOOTH), **OF_RADIAL | {"width": 0.0})
