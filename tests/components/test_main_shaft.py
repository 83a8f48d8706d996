"""MainShaft: constant speed, start-up, ripple."""

import random
from math import pi

import pytest
from looms import RPM

from loomfmu.components import MainShaft
from loomfmu.physics.shaft import shaft_motion


def test_constant_speed_is_exact_for_any_steps():
    shaft = MainShaft(speed=600 * RPM, start_angle=0.5)
    assert shaft.initialize(0.0) == 0
    assert (shaft.angle, shaft.velocity, shaft.acceleration) == (0.5, 600 * RPM, 0.0)
    rng = random.Random(1)
    time = 0.0
    for _ in range(100):
        step = rng.uniform(0.0, 0.3)
        assert shaft.step(time, step) == 0
        time += step
        # an angle of 900 rad is rounded to 1e-13, and so is the sum of the times
        assert shaft.angle == pytest.approx(0.5 + 600 * RPM * time, abs=1e-12)


def test_outputs_are_the_closed_form():
    shaft = MainShaft(speed=40.0, start_angle=1.0, ramp_duration=2.0, ripple_amplitude=0.1, ripple_order=3)
    for time in (0.0, 0.7, 2.0, 5.0):
        shaft.initialize(time)
        assert (shaft.angle, shaft.velocity, shaft.acceleration) == shaft_motion(time, 40.0, 1.0, 2.0, 0.1, 3)


def test_start_up_from_rest():
    shaft = MainShaft(speed=50.0, ramp_duration=1.0)
    shaft.initialize(0.0)
    assert (shaft.angle, shaft.velocity, shaft.acceleration) == (0.0, 0.0, 0.0)
    speeds = []
    for n in range(100):
        shaft.step(n * 0.01, 0.01)
        speeds.append(shaft.velocity)
    assert speeds == sorted(speeds)
    # full speed after the ramp, which has cost half its duration: rounding
    assert shaft.velocity == pytest.approx(50.0, rel=1e-15)
    assert shaft.angle == pytest.approx(25.0, rel=1e-14)


def test_ripple_keeps_the_mean_speed():
    shaft = MainShaft(speed=20.0 * pi, ripple_amplitude=0.2, ripple_order=4)
    shaft.initialize(0.0)
    velocities = []
    for n in range(400):
        shaft.step(n * 2.5e-4, 2.5e-4)
        velocities.append(shaft.velocity / (20.0 * pi))
    assert shaft.angle == pytest.approx(2.0 * pi, abs=1e-13)  # a turn in 0.1 s: rounding
    # the ripple's extremes are met to half a step of 1/100 of its period: (pi / 100)^2 / 2 * 0.2
    assert max(velocities) == pytest.approx(1.2, abs=1e-4)
    assert min(velocities) == pytest.approx(0.8, abs=1e-4)
