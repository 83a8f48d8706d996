"""HealdDamper with threads: against one integration of carrier and threads together."""

from math import pi

import numpy as np
import pytest
from hung_warp_reference import Hung, stepped
from looms import RPM

from loomfmu.components import HealdDamper, heald_damper
from loomfmu.physics.hung_warp import settled_load


@pytest.mark.few(1)
@pytest.mark.parametrize(("rpm", "turns", "contacts"), [(200, 1, 0), (450, 2, 4)])
def test_carrier_and_threads_against_a_monolithic_integration(rpm, turns, contacts):
    speed, fine = rpm * RPM, 720
    times = np.arange(turns * fine + 1) * (2.0 * pi / speed / fine)
    times[-1] = 2.0 * pi * turns / speed
    exact, counted = Hung(HealdDamper(thread_count=1260)).together(speed, turns, times)
    assert counted == contacts
    scale = np.max(np.abs(exact), axis=0)
    errors = {}
    for steps in (90, 720):
        damper = HealdDamper(thread_count=1260)
        rows = stepped(damper, speed, turns, steps)
        errors[steps] = np.max(np.abs(rows - exact[:: fine // steps]) / scale)
        assert damper.stop_contacts == counted
        # the peak is found on the continuous curve; samples of the integration miss it by up to (w h)^2 / 8
        assert damper.peak_load >= scale[4] * (1 - 1e-6)
    # a cubic over a piece of 0.05 rad is off by (0.05)^4 / 384, 2e-8; every contact multiplies that
    assert errors[90] < 5e-7
    # fourth order: 8^4 times less, less what the jumps of the frame's third rate leave
    assert errors[720] < 1e-8


@pytest.mark.parametrize("displacement", [1e300, -1e300])
def test_a_piece_that_never_settles_ends_the_step(displacement, monkeypatch):
    """Such values come from states that somebody forged; they took minutes."""
    tried = 0

    def counted(*arguments):
        nonlocal tried
        tried += 1
        assert tried <= heald_damper.MOST_PIECES + heald_damper.MOST_HALVINGS
        return settled_load(*arguments)

    monkeypatch.setattr(heald_damper, "settled_load", counted)
    damper = HealdDamper(thread_count=200)
    damper.initialize(0.0)
    damper.displacement = displacement
    assert damper.step(0.0, 1e-3) != 0
