"""Heald frames in plain weave at constant speed, and carriers, warp threads and healds on them."""

import math
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root

from loomfmu.components.dobby.drive import DobbyDrive
from loomfmu.components.heald_damper import HealdDamper
from loomfmu.components.heald_frame import HealdFrame
from loomfmu.components.heald_play import HealdPlay
from loomfmu.components.warp_tension import WarpTension
from loomfmu.physics.damper import design_stiffness
from loomfmu.physics.rotor_laws.rotor import SLOPED_SINE, UNIFORM
from validation.computed.rotor import LAWS

Floats = NDArray[np.float64]
STEPS, TURNS = 360, 10  # of a start less than 1e-7 is left after eight turns
FREQUENCY = math.sqrt(4.0 * 5960.0 / HealdDamper().carrier_mass) / (2.0 * math.pi)  # of the suspension [1/s]


class HealdLine:
    """Dobby and frame in even steps; the slow point lies at half a turn, so it starts amid a change."""

    def __init__(self, speed: float, steps: int, law: int = SLOPED_SINE) -> None:
        self.dobby = DobbyDrive(speed=speed, law=law, speed_reduction=0.5, start_angle=0.0)
        self.heald = HealdFrame(inputs_at_step_end=True)
        self.step_size = 2.0 * math.pi / speed / steps
        self.done = 0
        self.dobby.initialize(0.0)
        self._wire()
        self.heald.initialize(0.0)

    @property
    def time(self) -> float:
        """Time at the end of the last step."""
        return self.done * self.step_size

    def _wire(self) -> None:
        for signal in ("rotor_angle", "rotor_velocity", "rotor_acceleration"):
            setattr(self.heald, signal, getattr(self.dobby, signal))

    def advance(self, *followers: Any) -> None:
        """Take one step, followers of the frame with it."""
        before = self.time
        self.dobby.step(before, self.step_size)
        self._wire()
        self.heald.step(before, self.step_size)
        self.done += 1
        for each in followers:
            self.feed(each)
            each.step(before, self.step_size)

    def feed(self, follower: Any) -> None:
        """Give a follower the motion of the frame."""
        for signal in ("lift", "velocity", "acceleration"):
            setattr(follower, signal, getattr(self.heald, signal))

    def start(self, follower: Any) -> None:
        """Initialize a follower where the frame is."""
        self.feed(follower)
        follower.initialize(self.time)


@cache
def carrier(
    rpm: float, picks: float, steps: float = STEPS, law: str = "sloped sine", warp: float = 0.0
) -> Any:
    """The default damper after some picks from the closed shed, with the default warp or without."""
    line = HealdLine(rpm * math.pi / 30.0, int(steps), LAWS[law])
    damper = HealdDamper(inputs_at_step_end=True, thread_count=WarpTension().thread_count if warp else 0)
    line.start(damper)
    for _ in range(int(picks * steps)):
        line.advance(damper)
    return damper


@cache
def first_contact(law: str) -> float:
    """Lowest speed at which the default carrier touches a stop in four picks, at most 1000 [rev/min]."""
    low, high = 100.0, 1000.0
    while high - low > 0.01 and carrier(1000.0, 4, law=law).stop_contacts:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if carrier(middle, 4, law=law).stop_contacts else (middle, high)
    return high


@cache
def _woven(rpm: float, law: int, **thread: float) -> tuple[Floats, Floats]:
    """Tension of a thread over two picks, after its start has faded, and the height of its eye."""
    line = HealdLine(rpm * math.pi / 30.0, STEPS, law)
    threads = WarpTension(inputs_at_step_end=True, **thread)
    line.start(threads)
    rows = []
    for _ in range(TURNS * STEPS):
        line.advance(threads)
        rows.append((threads.tension, threads.lift - 0.5 * threads.stroke + threads.shed_offset))
    tension, height = np.array(rows[-2 * STEPS :]).T
    return tension, height


def mean_tension(part: str) -> float:
    """Mean tension of a thread in the upper or lower part of the shed, 280 picks/min [N]."""
    tension, height = _woven(280.0, SLOPED_SINE)
    return float(tension[height > 0.0 if part == "upper" else height < 0.0].mean())


def highest_tensions(**thread: float) -> tuple[float, float]:
    """Highest tension in the upper and in the lower part of the shed at 300 rev/min, without dwell [N]."""
    tension, height = _woven(300.0, UNIFORM, **thread)
    return float(tension[height > 0.0].max()), float(tension[height < 0.0].max())


@cache
def fitted_thread() -> tuple[float, float]:
    """Offset of the shed [m] and stiffness of the thread [N/m] with which the measured maxima come out."""

    def off(values: Floats) -> Floats:
        found = highest_tensions(shed_offset=1e-3 * float(values[0]), thread_stiffness=float(values[1]))
        return 100.0 * np.array(found) - (76.6, 26.2)

    found = root(off, (15.0, 65.0), tol=1e-8)
    return 1e-3 * float(found.x[0]), float(found.x[1])


@cache
def blows(restitution: float = 0.5, rpm: float = 300.0, **heald: float) -> float:
    """Blows of a heald in one rise or fall, on a frame without dwell: mean of both."""
    line = HealdLine(rpm * math.pi / 30.0, STEPS, UNIFORM)
    threads = WarpTension(inputs_at_step_end=True)
    play = HealdPlay(inputs_at_step_end=True, restitution=restitution, **heald)
    line.start(threads)
    play.warp_load = threads.frame_load
    line.start(play)
    counted = [play.blows]
    for _ in range(5 * STEPS):
        before = line.time
        line.advance(threads)
        line.feed(play)
        play.warp_load = threads.frame_load
        play.step(before, line.step_size)
        counted.append(play.blows)
    return 0.5 * (counted[-1] - counted[3 * STEPS])


def spring() -> float:
    """Stiffness of a spring by the source's design [N/m]."""
    return design_stiffness(5040 * 0.76 / 4.0, 15.0, 40.0, 0.015)


@cache
def motion(of: str) -> tuple[Floats, ...]:
    """Shaft angle [deg], lift [mm], velocity and acceleration [SI] of a `frame` or `carrier`."""
    line, damper = HealdLine(250.0 * math.pi / 30.0, 720), HealdDamper(inputs_at_step_end=True)
    line.start(damper)
    rows = []
    for _ in range(4 * 720):
        line.advance(damper)
        frame = line.heald
        row = (frame.lift, frame.velocity, frame.acceleration)
        if of == "carrier":
            row = (
                frame.lift + damper.displacement,
                frame.velocity + damper.rate,
                damper.carrier_acceleration,
            )
        rows.append((0.5 * line.done, 1e3 * row[0], *row[1:]))
    return tuple(np.array(rows).T)
