"""Declarations that several components share, each with the limits that they have in common."""

from typing import Any

from ..declaring.declarations import input_, output, parameter


def link_length(start: float, description: str) -> Any:
    """The parameter for the length of a link or a lever."""
    return parameter("m", start, description, display="mm", minimum=1e-4, maximum=10.0, nominal=0.1)


def link_place(start: float, description: str) -> Any:
    """The parameter for a coordinate of a pivot."""
    return parameter("m", start, description, display="mm", minimum=-10.0, maximum=10.0)


def found_once(unit: str, description: str, display: str | None = None, nominal: float | None = None) -> Any:
    """The output for what follows from the parameters alone."""
    return output(unit, description, display=display, variability="discrete", nominal=nominal, depends=())


def shaft_speed(description: str, unless: str | None = None) -> Any:
    """The parameter for the speed of a shaft."""
    return parameter(
        "rad/s",
        41.88790204786391,
        description,
        display="rev/min",
        minimum=-1000.0,
        maximum=1000.0,
        nominal=50.0,
        unless=unless,
    )


def shaft_start(description: str, unless: str | None = None) -> Any:
    """The parameter for the angle of a shaft at the start."""
    return parameter("rad", 0.0, description, display="deg", minimum=-1e6, maximum=1e6, unless=unless)


def frame_lift(start: float, moved: str = "the frame") -> Any:
    """The input for the lift of a heald frame."""
    return input_(
        "m", start, f"Lift of {moved}", display="mm", nominal=0.1, rate="velocity", minimum=-1e3, maximum=1e3
    )


def frame_velocity(moved: str = "the frame") -> Any:
    """The input for the velocity of a heald frame."""
    return input_("m/s", 0.0, f"Velocity of {moved}", rate="acceleration", minimum=-1e9, maximum=1e9)


def frame_acceleration(start: float, moved: str = "the frame") -> Any:
    """The input for the acceleration of a heald frame."""
    return input_("m/s2", start, f"Acceleration of {moved}", nominal=10.0, minimum=-1e15, maximum=1e15)
