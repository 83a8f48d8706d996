"""MainShaft: constant speed, start-up and ripple in their closed form."""

import pytest

from loomfmu.components import MainShaft
from loomfmu.physics.shaft import shaft_motion


@pytest.mark.parametrize("case", [(62.8, 0.5, 0.0, 0.0, 2), (40.0, 1.0, 2.0, 0.1, 3)])
def test_outputs_are_the_closed_form_after_any_steps(case):
    names = ("speed", "start_angle", "ramp_duration", "ripple_amplitude", "ripple_order")
    shaft = MainShaft(**dict(zip(names, case, strict=True)))
    assert shaft.initialize(0.0) == 0
    for time, step in ((0.0, 0.0), (0.0, 0.7), (0.7, 1.3), (2.0, 1e-9), (2.0, 3.0)):
        assert shaft.step(time, step) == 0
        assert (shaft.angle, shaft.velocity, shaft.acceleration) == shaft_motion(time + step, *case)
