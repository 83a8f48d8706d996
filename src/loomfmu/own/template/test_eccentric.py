"""Eccentric: against values that are known, and by the checks that every mechanism has to pass."""

from math import pi
from pathlib import Path

import loomfmu
import pytest
from eccentric import Eccentric
from loomfmu.own.checks import check_extremes, check_rates

SCENE = Path(__file__).with_name("eccentric.toml")


def test_half_a_revolution_lifts_by_the_stroke() -> None:
    """A value that is known without the code."""
    mechanism = Eccentric(stroke=0.03, start_angle=pi)
    assert mechanism.initialize(0.0) == 0
    assert mechanism.lift == pytest.approx(0.03, rel=1e-15)


def test_rates_are_those_of_their_values() -> None:
    """Of every output that is declared with `rate=`."""
    check_rates(Eccentric)


def test_extremes_do_not_depend_on_the_step() -> None:
    """Of every output that is declared with `lowest_of=` or `highest_of=`."""
    check_extremes(Eccentric)


def test_it_follows_the_shaft() -> None:
    """A start-up changes what it does."""
    steady = loomfmu.evaluate(SCENE, values=["eccentric.lift"])
    started = loomfmu.evaluate(SCENE, set={"shaft.ramp_duration": "0.2 s"}, values=["eccentric.lift"])
    assert abs(steady.trace["eccentric.lift"] - started.trace["eccentric.lift"]).max() > 1e-3


def test_the_scene_holds_with_few_steps_as_with_many() -> None:
    """Between two steps it moves on a curve that values and rates give."""
    many, few = (loomfmu.evaluate(SCENE, set={"steps_per_revolution": steps}) for steps in (1440, 360))
    assert many.holds
    assert few.holds
    # equal steps of 1 deg know the curve between them to its fourth derivative * (1 deg)^4 / 384:
    # 2e-10 of the speed here, and 2e-6 for a motion ten times as fast as the shaft
    assert few.claims[0].worst == pytest.approx(many.claims[0].worst, rel=1e-5)
