"""A dobby, a heald frame in plain weave and what hangs on it, at constant speed in even steps."""

import math

from ..components.dobby.drive import DobbyDrive
from ..components.heald_damper import HealdDamper
from ..components.heald_frame import HealdFrame
from ..components.heald_play import HealdPlay
from ..components.warp_tension import WarpTension
from ..physics.rotor_laws.rotor import SLOPED_SINE

RPM = math.pi / 30.0


class HealdLine:
    """Dobby and frame; the slow point lies at half a turn, so it starts in the middle of a change."""

    def __init__(
        self, rpm: float, steps: int, *, law: int = SLOPED_SINE, reduction: float = 0.5, start: float = 0.0
    ) -> None:
        speed = rpm * RPM
        self.dobby = DobbyDrive(speed=speed, law=law, speed_reduction=reduction, start_angle=start)
        self.heald = HealdFrame(inputs_at_step_end=True)
        self.step_size = 2.0 * math.pi / speed / steps
        self.done = 0
        self.dobby.initialize(0.0)
        self.wire()
        self.heald.initialize(0.0)

    @property
    def time(self) -> float:
        """Time at the end of the last step."""
        return self.done * self.step_size

    def wire(self) -> None:
        """Give the frame the motion of the rotor."""
        self.heald.rotor_angle = self.dobby.rotor_angle
        self.heald.rotor_velocity = self.dobby.rotor_velocity
        self.heald.rotor_acceleration = self.dobby.rotor_acceleration

    def advance(self) -> None:
        """One step on."""
        self.dobby.step(self.time, self.step_size)
        self.wire()
        self.heald.step(self.time, self.step_size)
        self.done += 1

    def feed(self, follower: HealdDamper | WarpTension | HealdPlay) -> None:
        """Give a follower the motion of the frame."""
        follower.lift = self.heald.lift
        follower.velocity = self.heald.velocity
        follower.acceleration = self.heald.acceleration


def carrier(
    rpm: float, picks: int, *, steps: int = 360, law: int = SLOPED_SINE, warp: bool = False
) -> HealdDamper:
    """The default damper after some picks from the closed shed, with the default warp or without."""
    line = HealdLine(rpm, steps, law=law)
    damper = HealdDamper(inputs_at_step_end=True, thread_count=WarpTension().thread_count if warp else 0)
    line.feed(damper)
    damper.initialize(0.0)
    for _ in range(picks * steps):
        before = line.time
        line.advance()
        line.feed(damper)
        damper.step(before, line.step_size)
    return damper
