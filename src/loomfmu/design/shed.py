"""The shed that an air stream needs: its angle, its greatest height, where the warp has to be and when.

The procedure that comes before the cam: from the channel of the stream and the gaps round it to the control
points for `cam.spline_law`. Source: Korolev, thesis on rotary dobbies (Moscow), section 4.1, equations
(4.1) to (4.7), Tables 4.1 and 4.2. Lengths in metres, angles in radians, or as texts with a unit, such as
"1.5 mm".
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import atan, degrees, pi, tan

from ..errors import LoomfmuError
from .quantities import Quantity, read

TABLE_4_2 = ("80 deg", "295 deg", "450 deg", "657 deg")


def stream_shed_height(confuser: Quantity, above: Quantity, below: Quantity) -> float:
    """Height of the open shed at the axis of the stream [m], `h_c = D_k + D_1 + D_2 + D_3`, equation (4.2).

    Args:
        confuser: inner diameter D_k of the confuser's plates [m]
        above: gap of the upper warp above the plate and height of the plate there, D_1 + D_3 [m]
        below: gap of the lower warp below the plate's inside, D_2 [m]

    >>> round(1000 * stream_shed_height("10 mm", "5 mm", "1.5 mm"), 9)  # published 16.5
    16.5
    """
    return read("confuser", confuser) + read("gap", above) + read("gap", below)


def shed_angle(height: Quantity, distance: Quantity) -> float:
    """Angle of the shed, `gamma_1 = atan(h_c / l_c)`, equation (4.1).

    The lower warp is level by this equation, and (4.3) halves the angle, as if the shed were symmetric. For a
    symmetric shed the angle would be `2 atan(h_c / (2 l_c))`: larger by a share of `(h_c / l_c)^2 / 4`.

    Args:
        height: h_c, at the axis of the stream [m]
        distance: l_c, from the fell to the axis of the stream [m]

    >>> round(degrees(shed_angle("16.5 mm", "80 mm")), 3)
    11.654
    """
    return atan(read("shed_height", height) / read("distance", distance))


def greatest_height(angle: Quantity, distance: Quantity) -> float:
    """Greatest height of the shed at the healds, `h_max = 2 l_1 tan(gamma_1 / 2)`, equation (4.3).

    The source does not say what l_1 is: the distance from the fell to the frame, we infer.

    Args:
        angle: gamma_1 of the shed [rad]
        distance: l_1, from the fell to the healds [m]

    >>> round(1000 * greatest_height("11.653 deg", "480 mm"), 1)
    98.0
    """
    return 2.0 * read("distance", distance) * tan(0.5 * read("shed_angle", angle))


@dataclass(frozen=True)
class StreamHeights:
    """Heights of the warp above its lowest place while the weft enters and leaves the shed [m]."""

    entry_lower: float
    entry_upper: float
    exit_lower: float
    exit_upper: float


def stream_heights(
    height: Quantity,
    confuser: Quantity,
    *,
    entry_upper: Quantity,
    entry_lower: Quantity,
    exit_upper: Quantity,
    exit_lower: Quantity,
) -> StreamHeights:
    """Heights that the warp must have passed when the weft enters and leaves, equations (4.4) to (4.7).

    The confuser stands in the middle of the shed here, as in the source, although the gaps of (4.2) above and
    below it differ.

    Args:
        height: h_c of the open shed at the axis of the stream [m]
        confuser: inner diameter D_k [m]
        entry_upper, entry_lower: gaps D_4 and D_5 beyond the confuser when the weft enters [m]
        exit_upper, exit_lower: gaps D_6 and D_7 when it leaves [m]

    Raises:
        LoomfmuError: the confuser does not fit the shed, or a gap is larger than the shed leaves

    >>> published = dict(entry_upper=1.75e-3, entry_lower=1.75e-3, exit_upper=1.25e-3, exit_lower=1.25e-3)
    >>> heights = stream_heights("16.5 mm", "10 mm", **published)
    >>> [round(1000 * h, 9) for h in (heights.entry_lower, heights.entry_upper)]  # published 1.5 and 15
    [1.5, 15.0]
    """
    whole, opening = read("shed_height", height), read("confuser", confuser)
    room = 0.5 * (whole - opening)
    gaps = {
        name: read("gap", gap)
        for name, gap in (
            ("entry_upper", entry_upper),
            ("entry_lower", entry_lower),
            ("exit_upper", exit_upper),
            ("exit_lower", exit_lower),
        )
    }
    for name, gap in gaps.items():
        if gap > room:
            raise LoomfmuError(
                f"{name} = {1e3 * gap:.7g} mm is more than the shed leaves on either side of the confuser:"
                f" (height {1e3 * whole:.7g} mm - confuser {1e3 * opening:.7g} mm) / 2 = {1e3 * room:.7g} mm"
            )
    return StreamHeights(
        entry_lower=room - gaps["entry_lower"],
        entry_upper=whole - room + gaps["entry_upper"],
        exit_lower=room - gaps["exit_lower"],
        exit_upper=whole - room + gaps["exit_upper"],
    )


def control_points(
    heights: StreamHeights, angles: Sequence[Quantity] = TABLE_4_2
) -> tuple[list[float], list[float]]:
    """Control points of a frame that rises in one pick and falls in the next, as in Table 4.2.

    Args:
        heights: of the warp, from `stream_heights`
        angles: of the main shaft from where the frame begins to rise: exit of the weft under the rising
            warp, entry under the raised one, exit under the falling one, entry over the lowered one [rad]

    Returns:
        angles [rad] and heights [m], for `cam.spline_law`; multiply the heights for those of the frame

    Raises:
        LoomfmuError: not four angles that rise between 0 and 720 deg

    >>> from loomfmu.design.cam import spline_law
    >>> law = spline_law(*control_points(StreamHeights(1.5e-3, 15e-3, 2e-3, 14.5e-3)))
    """
    places = [read("shaft_angle", angle) for angle in angles]
    row = [0.0, *places, 4.0 * pi]
    if len(places) != 4 or any(later <= earlier for earlier, later in pairwise(row)):
        shown = ", ".join(f"{degrees(place):.7g}" for place in places)
        raise LoomfmuError(f"angles = {shown} deg: give four that rise between 0 and 720 deg")
    return row, [0.0, heights.exit_lower, heights.entry_upper, heights.exit_upper, heights.entry_lower, 0.0]
