"""Motors by points: the characteristic itself, against numpy, both ways and mirrored."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from loomfmu.physics.motor import Motor, line_at

points = st.lists(
    st.tuples(st.integers(-40, 400), st.integers(-200, 200)), min_size=2, max_size=8, unique_by=lambda p: p[0]
).map(sorted)


@given(points, st.floats(-50.0, 450.0))
def test_between_its_points_the_torque_is_interpolated(rows, velocity):
    velocities, torques = (list(map(float, column)) for column in zip(*rows, strict=True))
    motor = Motor(40.0, 0.0, len(rows), velocities, torques)
    mirrored = Motor(-40.0, 0.0, len(rows), velocities, torques)
    for upwards in (True, False):
        torque, fall, low, high = line_at(motor, velocity, 0.0, upwards)
        back, same, minus_high, minus_low = line_at(mirrored, -velocity, 0.0, not upwards)
        assert (back, same, -minus_low, -minus_high) == (-torque, fall, low, high)
        assert low <= velocity <= high
        if velocities[0] <= velocity <= velocities[-1]:
            # roundings of torques that the slope takes from hundreds
            assert torque == pytest.approx(np.interp(velocity, velocities, torques), abs=1e-10)
        else:  # on along the outer lines
            end, other = (0, 1) if velocity < velocities[0] else (-1, -2)
            slope = (torques[end] - torques[other]) / (velocities[end] - velocities[other])
            assert torque == pytest.approx(torques[end] + slope * (velocity - velocities[end]), abs=1e-10)
            assert fall == -slope
