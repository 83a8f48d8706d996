"""Inputs of what a rapier head moves: the head's motion, and the tension of the weft that it carries.

Where one mechanism takes the motion of two heads, `prefix` begins the names of the inputs of each, and
`owner` is the instance that they are wired to.
"""

from typing import Any

from ..declaring.declarations import input_

HEAD = "the rapier head"


def head_travel(start: float = 0.9667, head: str = HEAD, prefix: str = "", owner: str = "") -> Any:
    """The input for the travel of a head."""
    return input_(
        "m",
        start,
        f"Travel of {head}",
        rate=f"{prefix}velocity",
        minimum=-1e5,
        maximum=1e5,
        source=f"{owner}.travel" if owner else None,
    )


def head_velocity(head: str = HEAD, prefix: str = "", owner: str = "") -> Any:
    """The input for the velocity of a head."""
    return input_(
        "m/s",
        0.0,
        f"Velocity of {head}",
        nominal=10.0,
        rate=f"{prefix}acceleration",
        minimum=-1e9,
        maximum=1e9,
        source=f"{owner}.velocity" if owner else None,
    )


def head_acceleration(start: float = 0.0, head: str = HEAD, owner: str = "") -> Any:
    """The input for the acceleration of a head."""
    return input_(
        "m/s2",
        start,
        f"Acceleration of {head}",
        nominal=1000.0,
        minimum=-1e15,
        maximum=1e15,
        source=f"{owner}.acceleration" if owner else None,
    )


def yarn_tension() -> Any:
    """The input for the tension of the weft."""
    return input_(
        "N",
        0.0,
        "Weft tension; acts on the belt while the head carries the weft: see taker",
        display="cN",
        minimum=-1e6,
        maximum=1e6,
        source="yarn.tension",
    )
