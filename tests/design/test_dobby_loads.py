"""Peaks of the loads on a dobby: against closed forms, fifty digits and a dense scan."""

from math import pi, sin

import numpy as np
import pytest
from reference import MP, Rotor

from loomfmu.design import loads
from loomfmu.errors import LoomfmuError

RPM = pi / 30.0


def test_even_rotor_has_its_peaks_in_closed_form():
    # lift H (1 - cos(x/2)) / 2: force m H w^2 / 8 at the ends, torque m H^2 w^2 / 64 half a pick later
    found = loads.dobby_loads("uniform", speed=40.0, stroke=0.1, frame_mass=12.0, gravity=0.0)
    assert abs(found.frame_force.value) == pytest.approx(12.0 * 0.1 * 1600.0 / 8.0, rel=1e-14)
    assert abs(found.rotor_torque.value) == pytest.approx(12.0 * 0.01 * 1600.0 / 64.0, rel=1e-14)
    assert found.shaft_torque == found.rotor_torque
    assert abs(sin(found.rotor_torque.angle)) == pytest.approx(1.0, abs=1e-15)  # a flat crest


@pytest.mark.parametrize("law", ["sloped_line", "sloped_sine"])
def test_peak_is_that_of_fifty_digits(law):
    of = Rotor(law, 0.5)
    mass, stroke, gravity, inertia, speed = (MP.mpf(each) for each in (15.0, 0.098, 9.80665, 0.02, 30.0))

    def torque(x):
        turned, first, second = of.angle(x), of.velocity(x), of.acceleration(x)
        slope = stroke / 4 * MP.sin(turned / 2)
        rise = stroke / 8 * MP.cos(turned / 2) * first**2 + slope * second
        frame = mass * (rise * speed**2 + gravity) * slope
        return (frame + inertia * second * speed**2) * first

    found = loads.dobby_loads(law, 0.5, speed=30.0, rotor_inertia=0.02).shaft_torque
    # the second pick is the mirror image of the first, its torques negative
    place, sign = (found.angle, 1) if found.angle < pi else (4 * MP.pi - MP.mpf(found.angle), -1)
    assert 0 < place < pi
    assert abs(torque(MP.mpf(place)) - sign * found.value) < 1e-12  # rounding
    # nothing higher nearby: the crest is flat to the square of its place
    near = [torque(MP.mpf(place) + MP.mpf(step)) for step in (-1e-3, -1e-5, 1e-5, 1e-3)]
    assert max(near) <= abs(found.value) * (1 + 1e-12)


@pytest.mark.parametrize("law", loads.LAWS)
def test_no_sample_is_beyond_the_peak(law):
    given = {"speed": 40.0, "rising": 3, "falling": 2, "rotor_inertia": 0.05, "warp_tension": 300.0}
    found = loads.dobby_loads(law, 0.6, **given)
    weave = loads._weave(law, 0.6, 40.0, 0.098, 15.0, 9.80665, 0.05, 3, 2)
    weave.warp, weave.front, weave.back = 300.0, 0.25, 0.5
    seen = np.array([weave.at(x) for x in np.linspace(0.0, 4.0 * pi, 3001)])
    for peak, column in zip((found.frame_force, found.rotor_torque, found.shaft_torque), seen.T, strict=True):
        assert np.abs(column).max() <= abs(peak.value) * (1 + 1e-12)
        # 3000 places miss a crest by (half a step)^2 of its bend, and a kink by its slope
        assert np.abs(column).max() == pytest.approx(abs(peak.value), rel=2e-2)


def test_frames_that_rise_and_fall_balance_their_weights():
    heavy = loads.dobby_loads(speed=1e-3, rising=2, falling=2)
    # what is left is inertia: 1e-6 of that at 1 rad/s
    assert abs(heavy.rotor_torque.value) < 1e-6
    assert loads.dobby_loads(speed=1e-3, rising=1).rotor_torque.value == pytest.approx(
        15.0 * 9.80665 * 0.098 / 4.0, rel=1e-6
    )


def test_inertia_alone_loads_the_rotor_more_with_every_reduction():
    for law in ("harmonic_ends", "sloped_line", "sloped_sine"):
        assert loads.least_loaded(law, "rotor_torque", gravity=0.0) == 0.0


def test_warp_that_balances_the_inertia_moves_the_least_load():
    given = {"speed": "280 rpm", "gravity": 0.0, "warp_tension": 359.0, "frame_mass": 6.5}
    least = loads.least_loaded("sloped_line", "rotor_torque", **given)
    peaks = [
        abs(loads.dobby_loads("sloped_line", least + step, **given).rotor_torque.value)
        for step in (-0.01, 0.0, 0.01)
    ]
    assert 0.4 < least < 0.5
    assert peaks[1] < min(peaks[0], peaks[2])


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"law": "square"}, "law = 'square' must be one of uniform, "),
        ({"rising": -1}, "rising = -1 must be a whole number, 0 or more"),
        ({"frame_mass": "2 m"}, "frame_mass: "),
        ({"speed_reduction": 1.5}, "speed_reduction = 1.5 is outside [0, 1]"),
    ],
)
def test_bad_values_are_named(given, message):
    with pytest.raises(LoomfmuError, match=r".") as error:
        loads.dobby_loads(**given)
    assert message in str(error.value)


def test_unknown_load_is_named():
    with pytest.raises(
        LoomfmuError, match="load = 'weight' must be one of frame_force, rotor_torque or shaft"
    ):
        loads.least_loaded(load="weight")
