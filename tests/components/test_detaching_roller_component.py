"""DetachingRoller: torques over a nip, with the built-in motion and with given ones."""

from math import pi

import pytest
from reference import RPM

from loomfmu.components.detaching_roller import DetachingRoller

PEAK = 1.18 / 135.64e-6  # rad/s2, behind the published peak of the inertia torque


def at_division(division, nips=300, **given):
    """The rollers at a division of the nip."""
    roller = DetachingRoller(speed=float(nips * RPM), start_angle=2 * pi * division / 40, **given)
    assert roller.initialize(0.0) == 0
    assert roller.division == pytest.approx(division, abs=1e-12)
    return roller


def driven(division, acceleration, fibre_share=0.0, **given):
    return at_division(division, use_table=False, acceleration=acceleration, fibre_share=fibre_share, **given)


# Equations


@pytest.mark.parametrize("division", [0.0, 17.9, 18.4, 24.0, 29.9, 30.1, 39.9])
@pytest.mark.parametrize("use_table", [False, True])
def test_torques_add_up(division, use_table):
    roller = at_division(division, use_table=use_table, acceleration=-2000.0, fibre_share=0.6)
    assert roller.front_torque == roller.top_roller_torque + roller.inertia_torque
    assert roller.back_torque == roller.drafting_torque + roller.front_torque
    assert roller.unit_torque == roller.back_torque + roller.front_torque
    assert roller.drafting_torque == roller.drafting_force * roller.roller_radius
    # the energy is that of the inertia that the torques accelerate: of both rollers of every unit
    power = roller.units * roller.front_torque * roller.roller_velocity**2
    assert roller.kinetic_energy * roller.roller_acceleration == pytest.approx(power, rel=1e-14)


def test_given_motion():
    roller = driven(18.4, PEAK)
    assert roller.inertia_torque == pytest.approx(1.18, rel=1e-15)
    assert roller.top_roller_torque == pytest.approx(0.308, abs=5e-4)
    assert roller.drafting_force == 0.0
    assert roller.roller_acceleration == PEAK
    roller = driven(23.8, -0.53 / 135.64e-6, fibre_share=1.0)
    # (0.33 * 300 N * 12.5 mm + 0.1382 N m) / 2
    assert roller.drafting_torque == pytest.approx(0.688, abs=5e-4)


@pytest.mark.parametrize(
    ("division", "drafts"), [(17.99, False), (18.01, True), (29.99, True), (30.01, False)]
)
def test_drafts_from_18_to_30_alone(division, drafts):
    roller = driven(division, 0.0, fibre_share=0.8)
    assert roller.drafted_share == (0.8 if drafts else 0.0)
    assert roller.drafting_force == pytest.approx(0.5 * 0.8 * 0.33 * 300.0 if drafts else 0.0)


def test_without_motion_the_rollers_ask_for_the_drafting_alone():
    roller = driven(24.0, 0.0, fibre_share=0.5)
    assert roller.unit_torque == roller.back_torque == roller.drafting_torque > 0.0
    assert roller.front_torque == 0.0


def test_warns_where_the_nip_holds_nothing():
    # mu P < f1: at the peak, from 0.33 * 300 N * 12.5 mm = 1.2375 N m of the top roller
    fast = DetachingRoller(
        use_table=False, acceleration=5.0 * PEAK, start_angle=2 * pi * 0.5, fibre_share=0.5
    )
    assert fast.initialize(0.0) == 1
    assert DetachingRoller.problems[0].warning
    assert fast.drafting_force < 0.0
    fast.fibre_share = 0.0
    assert fast.step(0.0, 0.0) == 0
    # the built-in motion comes to that from 602 nips a minute, but at 18.4 few fibres are drafted yet
    for nips, problem in ((595, 0), (610, 1)):
        roller = DetachingRoller(speed=float(nips * RPM), start_angle=2 * pi * 18.4 / 40)
        assert roller.initialize(0.0) == problem
