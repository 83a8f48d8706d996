"""Claims on the drive: motor power, speed fluctuation; the balance of energy is tested with a driven loom."""

import numpy as np
import pytest

import loomfmu
from loomfmu.cosim.scenes import scene as scenes

SCENE = """
revolutions = 3
steps_per_revolution = 180
coupling = "iterated"
[loom]
machine = "WL680-3600"
[shaft]
component = "DrivenShaft"
start_at_speed = false
[[claims]]
kind = "motor_power"
at_most = "17.55 kW"
[[claims]]
kind = "speed_fluctuation"
at_most = "5 %"
skip = 1
"""


def claims(**given):
    return loomfmu.evaluate(scenes.parse(SCENE, overrides=given), flavour="live").claims


def test_the_motors_peak_lies_at_half_its_speed():
    power, _fluctuation = claims()
    # the parabola k (w0 - w) w of the torque line: k w0^2 / 4, passed on the way up
    assert power.holds
    assert power.worst == pytest.approx(40.0 * (400.0 * np.pi / 30.0) ** 2 / 4.0, rel=1e-6)  # quintic
    assert (power.label, power.bound) == ("kW", 17550.0)


def test_fluctuation_is_judged_in_each_revolution_after_those_that_are_skipped():
    scene = scenes.parse(SCENE)
    found = loomfmu.evaluate(scene, flavour="live")
    trace = found.trace
    turns = (trace["shaft.angle"] - trace["shaft.angle"][0]) / (2.0 * np.pi)
    second = (turns >= 1.0) & (turns <= 2.0)  # the last one is not whole: the shaft has started from rest
    speed = trace["shaft.velocity"][second]
    mean = 2.0 * np.pi / np.ptp(np.interp([1.0, 2.0], turns, trace.time))
    # samples 2 deg apart miss the extremes by 1e-3 of the swing
    assert found.claims[1].worst == pytest.approx(np.ptp(speed) / mean, rel=5e-3)
    assert found.claims[1].holds == (found.claims[1].worst <= 0.05)


def test_a_run_without_a_whole_revolution_is_not_judged():
    claim = claims(revolutions=0.5)[1]
    assert not claim.holds
    assert claim.note == "the run has no whole revolution to judge"


def test_a_scene_without_a_motor_has_no_power_to_judge():
    text = '[loom]\nmachine = "WL680-3600"\n[[claims]]\nkind = "motor_power"\nat_most = 1.0\n'
    with pytest.raises(loomfmu.LoomfmuError, match="shaft has no output 'motor_power'"):
        loomfmu.evaluate(scenes.parse(text))
