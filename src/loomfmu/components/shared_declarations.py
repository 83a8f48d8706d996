"""Declarations that several components share, each with the limits that they have in common."""

from typing import Any

from ..declaring.declarations import Unit, input_, output, parameter
from .quantities import ACCELERATION, ANGLE, LENGTH, TENSION, TRAVEL, TURNING, VELOCITY

HEAD = "the rapier head"


def found_once(unit: Unit, description: str, nominal: float | None = None) -> Any:
    """The output for what follows from the parameters alone."""
    return output(unit, description, variability="discrete", nominal=nominal, constant=True)


def shaft_speed(description: str, unless: str | None = None) -> Any:
    """The parameter for the speed of a shaft."""
    return parameter(TURNING.within(-1000.0, 1000.0), 41.88790204786391, description, unless=unless)


def shaft_start(description: str, unless: str | None = None) -> Any:
    """The parameter for the angle of a shaft at the start."""
    return parameter(ANGLE.within(-1e6, 1e6), 0.0, description, unless=unless)


def frame_lift(start: float, moved: str = "the frame") -> Any:
    """The input for the lift of a heald frame."""
    return input_(LENGTH.within(-1e3, 1e3, nominal=0.1), start, f"Lift of {moved}", rate="velocity")


def frame_velocity(moved: str = "the frame") -> Any:
    """The input for the velocity of a heald frame."""
    return input_(VELOCITY.within(-1e9, 1e9), 0.0, f"Velocity of {moved}", rate="acceleration")


def frame_acceleration(start: float, moved: str = "the frame") -> Any:
    """The input for the acceleration of a heald frame."""
    return input_(ACCELERATION.within(-1e15, 1e15, nominal=10.0), start, f"Acceleration of {moved}")


# Inputs of what a rapier head moves. Where one mechanism takes the motion of two heads, `prefix` begins the
# names of the inputs of each, and `owner` is the instance that they are wired to.


def head_travel(start: float = 0.9667, head: str = HEAD, prefix: str = "", owner: str = "") -> Any:
    """The input for the travel of a head."""
    within = TRAVEL.within(-1e5, 1e5)
    source = f"{owner}.travel" if owner else None
    return input_(within, start, f"Travel of {head}", rate=f"{prefix}velocity", source=source)


def head_velocity(head: str = HEAD, prefix: str = "", owner: str = "") -> Any:
    """The input for the velocity of a head."""
    within = VELOCITY.within(-1e9, 1e9, nominal=10.0)
    source = f"{owner}.velocity" if owner else None
    return input_(within, 0.0, f"Velocity of {head}", rate=f"{prefix}acceleration", source=source)


def head_acceleration(start: float = 0.0, head: str = HEAD, owner: str = "") -> Any:
    """The input for the acceleration of a head."""
    within = ACCELERATION.within(-1e15, 1e15, nominal=1000.0)
    source = f"{owner}.acceleration" if owner else None
    return input_(within, start, f"Acceleration of {head}", source=source)


def yarn_tension() -> Any:
    """The input for the tension of the weft."""
    return input_(
        TENSION.within(-1e6, 1e6),
        0.0,
        "Weft tension; acts on the belt while the head carries the weft: see taker",
        source="yarn.tension",
    )
