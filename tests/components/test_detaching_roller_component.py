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


def nip(nips):
    """Rollers at every hundredth of a division of a nip with the built-in motion."""
    return [at_division(k / 100, nips) for k in range(4000)]


@pytest.fixture(scope="module")
def published_nip():
    return nip(300)


def extremes(rollers, name):
    """Largest and smallest value of an output, each with its division."""
    values = [(getattr(roller, name), round(roller.division, 2)) for roller in rollers]
    return max(values), min(values)


# Published numbers, Tables 1 and 2, at 300 nips a minute


@pytest.mark.parametrize(
    ("name", "peak", "valley"),
    [
        # computed, at division; printed
        ("inertia_torque", (1.18, 18.4), (-0.53, 25.0)),  # 1.18, 18.4; 0.53, 25: what the motion is made for
        ("top_roller_torque", (0.308, 18.4), (-0.138, 25.0)),  # 0.31, 18.4; 0.14, 25
        ("front_torque", (1.488, 18.4), (-0.668, 25.0)),  # 1.36, 18.4; 0.61, 25: printed, not the sum
        ("drafting_torque", (0.668, 23.8), (0.0, 0.0)),  # 0.68, 23.8; 0
        ("back_torque", (1.496, 18.54), (-0.559, 27.61)),  # 1.36, 18.4; 0.46, 27.1
        ("unit_torque", (2.983, 18.46), (-1.174, 26.97)),  # 2.73, 18.4; 1, 26.1
    ],
)
def test_extremes_of_a_nip(published_nip, name, peak, valley):
    (largest, at_largest), (smallest, at_smallest) = extremes(published_nip, name)
    assert (largest, smallest) == pytest.approx((peak[0], valley[0]), abs=5e-4)
    assert (at_largest, at_smallest) == (peak[1], valley[1])


def test_machine_torque_is_that_of_eight_units(published_nip):
    for roller in published_nip[::50]:
        assert roller.machine_torque == 8 * roller.unit_torque


def test_drafting_hardly_touches_the_peaks_but_the_valleys(published_nip):
    # what the source concludes
    (back, _), (back_valley, at) = extremes(published_nip, "back_torque")
    (front, _), (front_valley, before) = extremes(published_nip, "front_torque")
    assert back == pytest.approx(front, rel=0.01)
    assert abs(back_valley) < 0.85 * abs(front_valley)
    assert at > before


def test_peaks_grow_with_the_square_of_the_speed():
    # Table 2: 21.84, 38.80, 60.56 N m, 2.77 times from 300 to 500; the drafting force does not grow with it
    peaks = [extremes(nip(nips)[1700:2000], "machine_torque")[0][0] for nips in (300, 400, 500)]
    assert peaks == pytest.approx([23.86, 42.36, 66.15], abs=5e-3)
    assert peaks[2] / peaks[0] == pytest.approx(60.56 / 21.84, rel=1e-3)


# Equations


@pytest.mark.parametrize("division", [0.0, 17.9, 18.4, 24.0, 29.9, 30.1, 39.9])
@pytest.mark.parametrize("use_table", [False, True])
def test_torques_add_up(division, use_table):
    roller = at_division(division, use_table=use_table, acceleration=-2000.0, fibre_share=0.6)
    assert roller.front_torque == roller.top_roller_torque + roller.inertia_torque
    assert roller.back_torque == roller.drafting_torque + roller.front_torque
    assert roller.unit_torque == roller.back_torque + roller.front_torque
    assert roller.drafting_torque == roller.drafting_force * roller.roller_radius


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


def test_built_in_motion_follows_an_accelerated_shaft():
    # the roller's angle is a function of the shaft's: a = s'' w^2 + s' e
    angle = 2 * pi * 20 / 40
    shaft = {"follow_shaft": True, "inputs_at_step_end": True, "shaft_angle": angle}
    still = DetachingRoller(**shaft, shaft_velocity=0.0, shaft_acceleration=100.0)
    steady = DetachingRoller(**shaft, shaft_velocity=30.0)
    both = DetachingRoller(**shaft, shaft_velocity=30.0, shaft_acceleration=100.0)
    for roller in (still, steady, both):
        assert roller.initialize(0.0) == 0
    assert still.roller_acceleration > 0.0
    total = still.roller_acceleration + steady.roller_acceleration
    assert both.roller_acceleration == pytest.approx(total, rel=1e-14)


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


def test_limits_are_kept():
    with pytest.raises(ValueError, match=r"DetachingRoller.fibre_share = 1.5 is outside \[0, 1\]"):
        DetachingRoller(fibre_share=1.5)
