"""PickingCam: the checks of every mechanism, and a value that is known."""

from math import pi

import pytest
from picking_cam import PickingCam

from loomfmu.own.checks import check_extremes, check_rates


def test_rates_and_extremes() -> None:
    check_rates(PickingCam)
    check_extremes(PickingCam)


def test_at_the_top_it_is_lifted_by_its_stroke() -> None:
    cam = PickingCam(start_angle=pi / 3.0)
    assert cam.initialize(0.0) == 0
    assert cam.contact_force == pytest.approx(500.0 + 5000.0 * 0.03, rel=1e-12)
