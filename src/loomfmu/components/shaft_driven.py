"""The base class of the mechanisms that the main shaft drives."""

from dataclasses import dataclass
from typing import ClassVar

from ..declaring.declarations import at_step_end, input_, parameter
from ..declaring.variables import Component, Problem, Terminal
from ..physics.shaft import carried
from .quantities import ROTOR_ANGLE, TURNING
from .shared_declarations import shaft_speed, shaft_start
from .terminals import SHAFT


def turned_too_far(what: str) -> Problem:
    """Return the problem that is reported of an angle that is `too_far`."""
    return Problem(
        f"the {what} is more than 2e9 rad from zero, where rounding limits its angle to 2e-7 rad;"
        " start closer to time and angle 0"
    )


TOO_FAR = turned_too_far("shaft")


@dataclass(slots=True)
class ShaftDriven(Component):
    """A mechanism on the main shaft: at its own constant speed, or following shaft signals."""

    terminals: ClassVar[tuple[Terminal, ...]] = (
        SHAFT.of("shaft_angle", "shaft_velocity", "shaft_acceleration"),
    )

    speed: float = shaft_speed("Constant shaft speed, used if follow_shaft is false", unless="follow_shaft")
    start_angle: float = shaft_start(
        "Shaft angle at time 0, used if follow_shaft is false", unless="follow_shaft"
    )
    follow_shaft: bool = parameter(
        "1", False, "Follow shaft_angle, shaft_velocity and shaft_acceleration instead of turning at speed"
    )
    inputs_at_step_end: bool = at_step_end()
    shaft_angle: float = input_(
        ROTOR_ANGLE,
        0.0,
        "Shaft angle, not wrapped",
        unbounded=True,
        rate="shaft_velocity",
        when="follow_shaft",
    )
    shaft_velocity: float = input_(
        TURNING.within(-1e6, 1e6),
        41.88790204786391,
        "Shaft velocity",
        rate="shaft_acceleration",
        when="follow_shaft",
    )
    shaft_acceleration: float = input_(
        "rad/s2", 0.0, "Shaft acceleration", nominal=100.0, when="follow_shaft", minimum=-1e15, maximum=1e15
    )

    def shaft(self, time: float, step_size: float) -> tuple[float, float, float]:
        """Angle, velocity and acceleration of the shaft at the end of the step."""
        if not self.follow_shaft:
            return self.start_angle + self.speed * (time + step_size), self.speed, 0.0
        if self.inputs_at_step_end:
            return self.shaft_angle, self.shaft_velocity, self.shaft_acceleration
        return (
            carried(self.shaft_angle, self.shaft_velocity, self.shaft_acceleration, step_size),
            self.shaft_velocity + self.shaft_acceleration * step_size,
            self.shaft_acceleration,
        )


# input of a mechanism on a shaft, its angle first -> output of the shaft that it follows
FOLLOWED = dict(zip(ShaftDriven.terminals[0].variables, SHAFT.members, strict=True))
FOLLOWING = "follow_shaft"  # whether a class on ShaftDriven follows a shaft, or turns by itself
