"""The shed that an air stream needs: published heights, fifty digits, and what is refused."""

import numpy as np
import pytest
from reference import MP

from loomfmu.design import cam
from loomfmu.design.shed import (
    StreamHeights,
    control_points,
    greatest_height,
    shed_angle,
    stream_heights,
    stream_shed_height,
)
from loomfmu.errors import LoomfmuError
from loomfmu.machines import table

PUBLISHED = {
    "entry_upper": "1.75 mm",
    "entry_lower": "1.75 mm",
    "exit_upper": "1.25 mm",
    "exit_lower": "1.25 mm",
}


def published_heights():
    return stream_heights(stream_shed_height("10 mm", "5 mm", "1.5 mm"), "10 mm", **PUBLISHED)


def test_control_points_are_those_of_table_4_2():
    angles, heights = control_points(published_heights())
    rows = table("shed_control_points")
    assert np.degrees(angles) == pytest.approx([float(row["shaft_angle_deg"]) for row in rows], rel=1e-14)
    assert heights == pytest.approx([1e-3 * float(row["warp_height_mm"]) for row in rows], abs=1e-17)
    x = np.linspace(0.0, 2.0 * np.pi, 50)
    for mine, theirs in zip(cam.spline_law(angles, heights)(x), cam.spline_law()(x), strict=True):
        assert mine == pytest.approx(theirs, abs=1e-11)  # the spline's own rounding, twice differentiated


@pytest.mark.parametrize(
    ("height", "near", "far"), [(0.0165, 0.06, 0.4), (0.0165, 0.1, 0.6), (0.05, 0.1, 1.2)]
)
def test_angle_and_greatest_height_to_fifty_digits(height, near, far):
    angle = MP.atan(MP.mpf(height) / MP.mpf(near))
    assert shed_angle(height, near) == pytest.approx(float(angle), rel=4e-16)  # two roundings
    # by the half-angle of x = h/l, tan(atan(x)/2) = x / (1 + sqrt(1 + x^2)), and not by (4.3) itself
    x = MP.mpf(height) / MP.mpf(near)
    expected = float(2 * MP.mpf(far) * x / (1 + MP.sqrt(1 + x * x)))
    assert greatest_height(shed_angle(height, near), far) == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: stream_heights("16.5 mm", "10 mm", **PUBLISHED | {"entry_upper": "4 mm"}),
            "entry_upper = 4 mm is more than the shed leaves on either side of the confuser: .* = 3.25 mm",
        ),
        (
            lambda: control_points(StreamHeights(0, 1, 0, 1), ["80 deg", "295 deg", "290 deg", "657 deg"]),
            "angles = 80, 295, 290, 657 deg: give four that rise between 0 and 720 deg",
        ),
        (lambda: control_points(StreamHeights(0, 1, 0, 1), ["80 deg"]), "angles = 80 deg: give four"),
        (lambda: shed_angle("-1 mm", "80 mm"), "shed_height"),
    ],
)
def test_what_is_refused(call, message):
    with pytest.raises(LoomfmuError, match=message):
        call()
