"""What the rotor laws of a dobby drive are given by: their parameters, and the points of their splines."""

from dataclasses import dataclass
from math import pi
from typing import Any

from ...variables import parameter, state
from ..shaft_driven import ShaftDriven


def _cam_angle(number: int, degrees: float) -> Any:
    """Where a control point of the spline cam lies."""
    return parameter(
        "rad", degrees * pi / 180.0, f"Shaft angle of control point {number}, from the start of the rise",
        display="deg", minimum=0.0, maximum=4.0 * pi,
    )  # fmt: skip


def _cam_height(number: int, height: float) -> Any:
    """How high a control point of the spline cam lies."""
    return parameter(
        "m", height, f"Height at control point {number}: of the warp in the air stream, Table 4.2",
        display="mm", minimum=-1.0, maximum=1.0, nominal=0.01,
    )  # fmt: skip


def _table_point(number: int) -> Any:
    """Rotor angle at a point of the table, by default that of an even turn."""
    return parameter(
        "rad", 2.0 * pi * (number - 1) / 36, f"Rotor angle at point {number} of the table", display="deg",
        minimum=-2.0 * pi, maximum=4.0 * pi,
    )  # fmt: skip


@dataclass(slots=True)
class LawParameters(ShaftDriven):
    """Parameters of the rotor laws, and the present segment of a law that is a spline."""

    law: int = parameter(
        "1", 4, "Rotor law",
        choices=(
            "uniform", "harmonic_ends", "sloped_line", "sloped_sine", "slotted_levers", "noncircular_gears",
            "spline_cam", "table",
        ),
    )  # fmt: skip
    speed_reduction: float = parameter(
        "1", 0.5, "Share of the rotor speed taken off at the slow point, zeta (harmonic_ends, sloped_...)",
        minimum=0.0, maximum=1.0,
    )  # fmt: skip
    slow_point: float = parameter(
        "rad", 3.141592653589793,
        "Shaft angle of the slow point, the middle of the open-shed dwell; spline_cam starts to rise there",
        display="deg", minimum=-6.283185307179586, maximum=6.283185307179586,
    )  # fmt: skip
    dwell_tolerance: float = parameter(
        "1", 0.015, "Share of the stroke within which a frame counts as dwelling", minimum=1e-9, maximum=0.5
    )
    clear_fraction: float = parameter(
        "1", 0.08325, "Share of the stroke within which the warp counts as clear of the weft's way",
        minimum=1e-9, maximum=0.5,
    )  # fmt: skip
    lever_radius: float = parameter(
        "m", 0.1, "Radius of the pin on the driving pulley (slotted_levers; assumed)", display="mm",
        minimum=1e-3, maximum=10.0, nominal=0.1,
    )  # fmt: skip
    driven_radius: float = parameter(
        "m", 0.1, "Radius of the pin on the lever about the eccentric (slotted_levers; assumed)",
        display="mm", minimum=1e-3, maximum=10.0, nominal=0.1,
    )  # fmt: skip
    eccentricity: float = parameter(
        "m", 0.04, "Distance of the eccentric from the shaft (slotted_levers; assumed)", display="mm",
        minimum=0.0, maximum=10.0, nominal=0.1,
    )  # fmt: skip
    gear_harmonic_1: float = parameter(
        "1", -0.27, "Share of the speed that varies once in a turn (noncircular_gears; assumed)",
        minimum=-10.0, maximum=10.0,
    )  # fmt: skip
    gear_harmonic_2: float = parameter(
        "1", -0.13, "Share of the speed that varies twice in a turn", minimum=-10.0, maximum=10.0
    )
    gear_harmonic_3: float = parameter(
        "1", -0.05, "Share of the speed that varies three times in a turn", minimum=-10.0, maximum=10.0
    )
    gear_harmonic_4: float = parameter(
        "1", -0.025, "Share of the speed that varies four times in a turn", minimum=-10.0, maximum=10.0
    )
    cam_angle_1: float = _cam_angle(1, 0.0)
    cam_angle_2: float = _cam_angle(2, 80.0)
    cam_angle_3: float = _cam_angle(3, 295.0)
    cam_angle_4: float = _cam_angle(4, 450.0)
    cam_angle_5: float = _cam_angle(5, 657.0)
    cam_angle_6: float = _cam_angle(6, 720.0)
    cam_height_1: float = _cam_height(1, 0.0)
    cam_height_2: float = _cam_height(2, 0.002)
    cam_height_3: float = _cam_height(3, 0.015)
    cam_height_4: float = _cam_height(4, 0.0145)
    cam_height_5: float = _cam_height(5, 0.0015)
    cam_height_6: float = _cam_height(6, 0.0)
    table_points: int = parameter(
        "1", 36, "Points of the table, evenly spaced over a turn from the slow point", minimum=4, maximum=36
    )
    table_1: float = _table_point(1)
    table_2: float = _table_point(2)
    table_3: float = _table_point(3)
    table_4: float = _table_point(4)
    table_5: float = _table_point(5)
    table_6: float = _table_point(6)
    table_7: float = _table_point(7)
    table_8: float = _table_point(8)
    table_9: float = _table_point(9)
    table_10: float = _table_point(10)
    table_11: float = _table_point(11)
    table_12: float = _table_point(12)
    table_13: float = _table_point(13)
    table_14: float = _table_point(14)
    table_15: float = _table_point(15)
    table_16: float = _table_point(16)
    table_17: float = _table_point(17)
    table_18: float = _table_point(18)
    table_19: float = _table_point(19)
    table_20: float = _table_point(20)
    table_21: float = _table_point(21)
    table_22: float = _table_point(22)
    table_23: float = _table_point(23)
    table_24: float = _table_point(24)
    table_25: float = _table_point(25)
    table_26: float = _table_point(26)
    table_27: float = _table_point(27)
    table_28: float = _table_point(28)
    table_29: float = _table_point(29)
    table_30: float = _table_point(30)
    table_31: float = _table_point(31)
    table_32: float = _table_point(32)
    table_33: float = _table_point(33)
    table_34: float = _table_point(34)
    table_35: float = _table_point(35)
    table_36: float = _table_point(36)
    cam_bend_1: float = state("m", "Second derivative of the cam's spline at control point 1")
    cam_bend_2: float = state("m", "Second derivative of the cam's spline at control point 2")
    cam_bend_3: float = state("m", "Second derivative of the cam's spline at control point 3")
    cam_bend_4: float = state("m", "Second derivative of the cam's spline at control point 4")
    cam_bend_5: float = state("m", "Second derivative of the cam's spline at control point 5")
    cam_bend_6: float = state("m", "Second derivative of the cam's spline at control point 6")
    cam_top: float = state("rad", "Shaft angle from the start of the rise to the highest point of the cam")
    cam_span: float = state("m", "Largest height of the cam's spline above its start")
    lowest_speed: float = state("1", "Lowest rotor speed of a law that could turn back, over the shaft's")
    segment: int = state("1", "Present segment of the spline, counted from 0; -1 for none", start=-1)
    segment_start: float = state("rad", "Where the present segment starts")
    segment_length: float = state("rad", "Length of the present segment")
    segment_left: float = state("1", "Value at the start of the present segment")
    segment_right: float = state("1", "Value at the end of the present segment")
    segment_left_bend: float = state("1", "Second derivative at the start of the present segment")
    segment_right_bend: float = state("1", "Second derivative at the end of the present segment")

    def cam_knot(self, index: int) -> tuple[float, float, float]:
        """Angle, height and second derivative at a control point of the cam, counted from 0."""
        if index == 0:
            return self.cam_angle_1, self.cam_height_1, self.cam_bend_1
        if index == 1:
            return self.cam_angle_2, self.cam_height_2, self.cam_bend_2
        if index == 2:
            return self.cam_angle_3, self.cam_height_3, self.cam_bend_3
        if index == 3:
            return self.cam_angle_4, self.cam_height_4, self.cam_bend_4
        if index == 4:
            return self.cam_angle_5, self.cam_height_5, self.cam_bend_5
        return self.cam_angle_6, self.cam_height_6, self.cam_bend_6

    def table_point(self, index: int) -> float:
        """Rotor angle at a point of the table, counted from 0."""
        if index < 12:
            return self.table_point_1_to_12(index)
        if index < 24:
            return self.table_point_13_to_24(index)
        return self.table_point_25_to_36(index)

    def table_point_1_to_12(self, index: int) -> float:
        """As `table_point`, for the points 1 to 12."""
        if index == 0:
            return self.table_1
        if index == 1:
            return self.table_2
        if index == 2:
            return self.table_3
        if index == 3:
            return self.table_4
        if index == 4:
            return self.table_5
        if index == 5:
            return self.table_6
        if index == 6:
            return self.table_7
        if index == 7:
            return self.table_8
        if index == 8:
            return self.table_9
        if index == 9:
            return self.table_10
        if index == 10:
            return self.table_11
        return self.table_12

    def table_point_13_to_24(self, index: int) -> float:
        """As `table_point`, for the points 13 to 24."""
        if index == 12:
            return self.table_13
        if index == 13:
            return self.table_14
        if index == 14:
            return self.table_15
        if index == 15:
            return self.table_16
        if index == 16:
            return self.table_17
        if index == 17:
            return self.table_18
        if index == 18:
            return self.table_19
        if index == 19:
            return self.table_20
        if index == 20:
            return self.table_21
        if index == 21:
            return self.table_22
        if index == 22:
            return self.table_23
        return self.table_24

    def table_point_25_to_36(self, index: int) -> float:
        """As `table_point`, for the points 25 to 36."""
        if index == 24:
            return self.table_25
        if index == 25:
            return self.table_26
        if index == 26:
            return self.table_27
        if index == 27:
            return self.table_28
        if index == 28:
            return self.table_29
        if index == 29:
            return self.table_30
        if index == 30:
            return self.table_31
        if index == 31:
            return self.table_32
        if index == 32:
            return self.table_33
        if index == 33:
            return self.table_34
        if index == 34:
            return self.table_35
        return self.table_36
