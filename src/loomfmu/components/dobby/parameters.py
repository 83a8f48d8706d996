"""The parameters of the rotor laws of a dobby drive, and the points of their splines."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

from ...declaring.arrays import array
from ...declaring.declarations import auxiliary, parameter
from ..shaft_driven import ShaftDriven


@dataclass(slots=True)
class LawParameters(ShaftDriven):
    """Parameters of the rotor laws, and the present segment of a law that is a spline."""

    law: int = parameter(
        "1",
        4,
        "Rotor law",
        choices=(
            "uniform",
            "harmonic_ends",
            "sloped_line",
            "sloped_sine",
            "slotted_levers",
            "noncircular_gears",
            "spline_cam",
            "table",
            "plateau",
        ),
    )
    speed_reduction: float = parameter(
        "1",
        0.5,
        "Share by which the rotor slows down at the slow point, zeta (harmonic_ends, sloped_..., plateau)",
        minimum=0.0,
        maximum=1.0,
    )
    slow_point: float = parameter(
        "rad",
        3.141592653589793,
        "Shaft angle of the slow point, the middle of the open-shed dwell; start of the rise for spline_cam",
        display="deg",
        minimum=-6.283185307179586,
        maximum=6.283185307179586,
    )
    dwell_tolerance: float = parameter(
        "1", 0.015, "Share of the stroke within which a frame counts as dwelling", minimum=1e-9, maximum=0.5
    )
    clear_fraction: float = parameter(
        "1",
        0.08325,
        "Share of the stroke within which the warp counts as clear of the weft",
        minimum=1e-9,
        maximum=0.5,
    )
    lever_radius: float = parameter(
        "m",
        0.1,
        "Radius of the pin on the driving pulley (slotted_levers; assumed)",
        display="mm",
        minimum=1e-3,
        maximum=10.0,
        nominal=0.1,
    )
    driven_radius: float = parameter(
        "m",
        0.1,
        "Radius of the pin on the lever about the eccentric (slotted_levers; assumed)",
        display="mm",
        minimum=1e-3,
        maximum=10.0,
        nominal=0.1,
    )
    eccentricity: float = parameter(
        "m",
        0.04,
        "Distance of the eccentric from the shaft (slotted_levers; assumed)",
        display="mm",
        minimum=0.0,
        maximum=10.0,
        nominal=0.1,
    )
    gear_harmonic: tuple[float, ...] = array(
        parameter(
            "1",
            share,
            f"Amplitude of the {which} harmonic of the rotor speed (noncircular_gears; assumed)",
            minimum=-10.0,
            maximum=10.0,
        )
        for share, which in ((-0.27, "1st"), (-0.13, "2nd"), (-0.05, "3rd"), (-0.025, "4th"))
    )
    cam_angle: tuple[float, ...] = array(
        parameter(
            "rad",
            degrees * pi / 180.0,
            f"Shaft angle of control point {number}, from the start of the rise",
            display="deg",
            minimum=0.0,
            maximum=4.0 * pi,
        )
        for number, degrees in enumerate((0.0, 80.0, 295.0, 450.0, 657.0, 720.0), start=1)
    )
    cam_height: tuple[float, ...] = array(
        parameter(
            "m",
            height,
            f"Height at control point {number}, of the warp in the air stream (Table 4.2)",
            display="mm",
            minimum=-1.0,
            maximum=1.0,
            nominal=0.01,
        )
        for number, height in enumerate((0.0, 0.002, 0.015, 0.0145, 0.0015, 0.0), start=1)
    )
    table_points: int = parameter(
        "1", 36, "Number of points, evenly spaced over a turn from the slow point", minimum=4, maximum=36
    )
    table: tuple[float, ...] = array(  # by default that of an even turn
        parameter(
            "rad",
            2.0 * pi * point / 36,
            f"Rotor angle at point {point + 1} of the table",
            display="deg",
            minimum=-2.0 * pi,
            maximum=4.0 * pi,
        )
        for point in range(36)
    )
    plateau_angle: float = parameter(
        "rad",
        0.5 * pi,
        "Shaft angle of lowest speed, half to either side of the slow point (plateau; inferred)",
        display="deg",
        minimum=0.0,
        maximum=2.0 * pi,
    )
    ramp_angle: float = parameter(
        "rad",
        40.9 * pi / 180.0,
        "Shaft angle from lowest to highest speed (plateau; inferred)",
        display="deg",
        minimum=pi / 180.0,
        maximum=pi,
    )
    cam_bend: Sequence[float] = array(
        auxiliary("m", f"Second derivative of the cam's spline at control point {number}")
        for number in range(1, 7)
    )
    cam_top: float = auxiliary(
        "rad", "Shaft angle from the start of the rise to the highest point of the cam"
    )
    cam_span: float = auxiliary("m", "Largest height of the cam's spline above its start")
    lowest_speed: float = auxiliary("1", "Lowest rotor speed over the shaft's, for laws that could reverse")
    segment: int = auxiliary(
        "1", "Current segment of the spline, counted from 0; -1 for none", start=-1, minimum=-1, maximum=36
    )
    segment_start: float = auxiliary("rad", "Start of the current segment")
    segment_length: float = auxiliary("rad", "Length of the current segment", minimum=0.0)
    segment_left: float = auxiliary("1", "Value at the start of the current segment")
    segment_right: float = auxiliary("1", "Value at the end of the current segment")
    segment_left_bend: float = auxiliary("1", "Second derivative at the start of the current segment")
    segment_right_bend: float = auxiliary("1", "Second derivative at the end of the current segment")
