"""MainShaft: the loom's main shaft, which all mechanisms follow."""

from collections.abc import Callable
from dataclasses import dataclass
from math import inf, pi
from typing import Any, ClassVar

from ..declaring.declarations import output, parameter
from ..declaring.variables import NOTHING, Component, Terminal
from ..physics.shaft import shaft_motion
from .quantities import ANGLE, RATIO, TURNING
from .shared_declarations import shaft_speed, shaft_start
from .terminals import SHAFT

WAVE = 16  # least steps in a ripple of the speed, and in the start-up


@dataclass(slots=True)
class MainShaft(Component):
    """The loom's main shaft: constant speed, a smooth start-up ramp, a speed ripple."""

    terminals: ClassVar[tuple[Terminal, ...]] = (SHAFT.of("angle", "velocity", "acceleration"),)
    keeps: ClassVar[str] = NOTHING
    longest_turn: ClassVar[float] = inf
    unsteady: ClassVar[tuple[str, ...]] = ("ramp_duration", "ripple_amplitude")

    speed: float = shaft_speed("Mean shaft speed after the start-up; one revolution is one pick")
    start_angle: float = shaft_start("Shaft angle at time 0; 0 is the rapiers' outer dead centre")
    ramp_duration: float = parameter(
        "s", 0.0, "Duration of the start-up from rest at time 0; 0 for no start-up", minimum=0.0, maximum=1e4
    )
    ripple_amplitude: float = parameter(
        RATIO.within(0.0, 0.95), 0.0, "Amplitude of the speed ripple, as a share of speed"
    )
    ripple_order: int = parameter("1", 2, "Ripples per revolution", minimum=1, maximum=100)
    angle: float = output(ANGLE, "Shaft angle, not wrapped", unbounded=True, nominal=6.0, rate="velocity")
    velocity: float = output(TURNING, "Shaft velocity", rate="acceleration")
    acceleration: float = output("rad/s2", "Shaft acceleration", nominal=100.0)

    @classmethod
    def longest_step(cls, value: Callable[[str], Any]) -> tuple[float, str]:
        """The longest step that shows a ripple of the speed, and the start-up."""
        looks = [(inf, "")]
        if value("ripple_amplitude"):
            order = value("ripple_order")
            wave = 2.0 * pi / (abs(value("speed")) * order)
            looks.append((wave / WAVE, f"the shaft ripples {order} times in a revolution"))
        if value("ramp_duration"):
            ramp = value("ramp_duration")
            looks.append((ramp / WAVE, f"the shaft starts up in {ramp:.4g} s"))
        return min(looks)

    def initialize(self, time: float) -> int:
        """Place the shaft where it is at the start."""
        return self.step(time, 0.0)

    def step(self, time: float, step_size: float) -> int:
        """Turn the shaft: a closed form of time, exact for every step."""
        self.angle, self.velocity, self.acceleration = shaft_motion(
            time + step_size,
            self.speed,
            self.start_angle,
            self.ramp_duration,
            self.ripple_amplitude,
            self.ripple_order,
        )
        return 0
