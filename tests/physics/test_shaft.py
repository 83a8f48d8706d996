"""Main shaft: the ramp and the ripple are derivatives of their angle, exactly."""

import pytest
from hypothesis import given
from hypothesis import strategies as st
from reference import MP

from loomfmu.physics.shaft import ramp, shaft_motion


def exact_angle(time, speed, start, duration, amplitude, order):
    """Shaft angle from the definition, in 50 digits: the mean angle p of a quintic ramp, then the ripple."""
    t, speed, start, duration, amplitude = map(MP.mpf, (time, speed, start, duration, amplitude))
    share = MP.mpf(0) if duration == 0 else min(t, duration) / duration
    ramped = duration * (share**6 - 3 * share**5 + MP.mpf(5) / 2 * share**4)
    p = start + speed * (ramped + max(t - duration, 0))
    # the integral of 1 + A sin(n p) over p
    return p + amplitude / order * (MP.cos(order * start) - MP.cos(order * p))


@given(
    st.floats(0.01, 3.0),
    st.floats(-100.0, 100.0),
    st.floats(-7.0, 7.0),
    st.sampled_from([0.0, 0.5, 2.0]),
    st.floats(0.0, 0.9),
    st.integers(1, 8),
)
def test_velocity_and_acceleration_belong_to_the_angle(time, speed, start, duration, amplitude, order):
    case = (speed, start, duration, amplitude, order)
    angle, velocity, acceleration = shaft_motion(time, *case)
    exact = [MP.diff(lambda t: exact_angle(t, *case), MP.mpf(time), n) for n in range(3)]
    # angles up to 300 rad are rounded to 1e-16 of themselves, and enter the ripple's sine n times
    slack = 1e-15 * (1 + abs(start) + 3 * abs(speed)) * order
    assert abs(angle - exact[0]) < slack
    assert abs(velocity - exact[1]) < slack * (1 + abs(speed)) * 2
    assert abs(acceleration - exact[2]) < slack * (1 + abs(speed)) ** 2 * order * 2


def test_ramp_joins_smoothly_and_costs_half_its_duration():
    # velocity, acceleration and jerk continuous: the rate starts and ends as the square of the time
    assert ramp(0.0, 2.0) == (0.0, 0.0, 0.0)
    assert ramp(-1.0, 2.0) == (0.0, 0.0, 0.0)
    assert ramp(5.0, 2.0) == (4.0, 1.0, 0.0)
    for near in (1e-6, 2.0 - 1e-6):
        equivalent, share, rate = ramp(near, 2.0)
        assert share == pytest.approx(round(share), abs=2e-15)  # 10 u^3 = 1e-18 and rounding of terms of 15
        assert rate < 1e-11  # 30 u^2 / T = 4e-12
        assert equivalent == pytest.approx(max(near - 1.0, 0.0), abs=1e-15)  # rounding
