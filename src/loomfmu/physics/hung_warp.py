"""Warp on a sprung heald carrier: threads and carrier move each other, and are solved together.

The threads stretch with the carrier, `h = y + z + offset` with y the lift of the frame and z the
displacement in it, and pull it back to the warp line. Over a piece of the motion the load runs on the cubic
that meets value and rate at both ends; with it the carrier (`damper.propagate`) and the threads
(`warp.thread_force`) have exact solutions, and the end is found by repetition. Law of the threads: Korolev
(3.28), corrected.
"""

from dataclasses import dataclass
from math import fabs

from .damper import Ride, Swing, drive_at, propagate
from .numerics.motion import joined, moved_on
from .warp import eye_bend, eye_pull, thread_drive, thread_extension, thread_force

MOST_REPEATS = 30  # of a piece: each leaves a tenth of the error at most on a piece short enough
SETTLED = 4e-16  # of the load: what rounding leaves


@dataclass(frozen=True)
class Warp:
    """Threads that a carrier lifts.

    Pretension T0 [N] and stiffness b [N/m] of all, creep n and relaxation r [1/s]; lengths of the warp in
    front of the eyes and behind them [m].
    """

    pretension: float
    stiffness: float
    creep: float
    relaxation: float
    front: float
    back: float


def force_after(
    warp: Warp,
    force: float,
    height: float,
    velocity: float,
    acceleration: float,
    end_height: float,
    end_velocity: float,
    end_acceleration: float,
    duration: float,
) -> float:
    """Force of the threads above their pretension after a piece of the eyes' motion, of the law (3.28).

    Args:
        warp: the threads
        force: at the start [N]
        height, velocity, acceleration: of the eyes above the warp line at the start [m, m/s, m/s2]
        end_height, end_velocity, end_acceleration: the same at the end
        duration: of the piece [s]

    >>> spring = Warp(0.0, 10.0, 0.0, 0.0, 0.4, 0.4)
    >>> round(force_after(spring, 0.0, 0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.1), 12)
    2.0
    """
    x0, rate, second = thread_extension(height, velocity, acceleration, warp.front, warp.back)
    x1, end_rate, end_second = thread_extension(
        end_height, end_velocity, end_acceleration, warp.front, warp.back
    )
    square = duration * duration
    a0, a1, a2, a3 = joined(
        x0, duration * rate, square * second, x1, duration * end_rate, square * end_second
    )
    p = thread_drive(warp.stiffness, warp.creep * duration, x0, x1, a0, a1, a2, a3)
    end, _area = thread_force(force, warp.relaxation * duration, p, 1.0)
    return end


def warp_load(warp: Warp, force: float, height: float, velocity: float) -> tuple[float, float]:
    """Load of the threads on their eyes [N], positive upwards, and its rate [N/s]; none while they are slack.

    `L = -(T0 + F) s`, `L' = -F' s - (T0 + F) s' h'`, with `F' = b (s h' + n x) - r F`.

    Args:
        warp: the threads
        force: F of all threads [N]
        height, velocity: of the eyes above the warp line [m, m/s]

    >>> warp_load(Warp(1.0, 10.0, 0.0, 0.0, 0.4, 0.4), 4.0, 0.3, 0.0)
    (-6.0, -0.0)
    """
    pull = warp.pretension + force
    if pull <= 0.0:
        return 0.0, 0.0
    slope = eye_pull(height, warp.front, warp.back)
    extension, rate, _second = thread_extension(height, velocity, 0.0, warp.front, warp.back)
    growth = warp.stiffness * (rate + warp.creep * extension) - warp.relaxation * force
    return -pull * slope, -growth * slope - pull * eye_bend(height, warp.front, warp.back) * velocity


def warp_stiffness(warp: Warp, force: float, height: float) -> float:
    """Stiffness of all threads against a fast motion of their eyes, `b s^2 + (T0 + F) s'` [N/m].

    >>> warp_stiffness(Warp(2.0, 10.0, 0.0, 0.0, 0.5, 0.5), 0.0, 0.0)
    8.0
    """
    pull = warp.pretension + force
    slope = eye_pull(height, warp.front, warp.back)
    return warp.stiffness * slope * slope + fabs(pull) * eye_bend(height, warp.front, warp.back)


def cubic_between(
    start: float, start_rate: float, end: float, end_rate: float, duration: float
) -> list[float]:
    """Cubic in time that meets value and rate at both ends: coefficients of 1, t, t^2, t^3.

    >>> cubic_between(0.0, 0.0, 8.0, 12.0, 2.0)
    [0.0, 0.0, 0.0, 1.0]
    """
    mean = (end - start) / duration
    return [
        start,
        start_rate,
        (3.0 * mean - 2.0 * start_rate - end_rate) / duration,
        (start_rate + end_rate - 2.0 * mean) / (duration * duration),
    ]


def settled_load(
    warp: Warp, force: float, mass: float, swing: Swing, eyes: Ride, duration: float
) -> tuple[float, float, float, float, bool]:
    """Load of the threads on the carrier over a piece of their common motion, a cubic in time.

    Repeated until the load with which the carrier moves is the one that its motion gives.

    Args:
        warp, force: the threads, and F of all at the start [N]
        mass: of the carrier [kg]
        swing: of the carrier in its frame, without the threads
        eyes: motion of the eyes above the warp line, in mid-travel
        duration: of the piece [s]

    Returns:
        coefficients of 1, t, t^2, t^3, and whether the piece is short enough for this
    """
    stiffness = swing.stiffness
    damping = swing.damping
    height = eyes.lift + swing.position
    speed = eyes.velocity + swing.rate
    load, load_rate = warp_load(warp, force, height, speed)
    acceleration = eyes.a0 + swing.drive + load / mass - stiffness * swing.position - damping * swing.rate
    end_lift, end_velocity, end_second = moved_on(
        eyes.lift, eyes.velocity, eyes.a0, eyes.a1, eyes.a2, eyes.a3, duration
    )
    drive = drive_at(swing, duration)
    end_load = load + load_rate * duration
    end_rate = load_rate
    for _ in range(MOST_REPEATS):
        d0, d1, d2, d3 = cubic_between(load, load_rate, end_load, end_rate, duration)
        loaded = pulled(swing, mass, d0, d1, d2, d3)
        z, v = propagate(loaded, duration)
        end_height = end_lift + z
        end_speed = end_velocity + v
        end_acceleration = end_second + drive + end_load / mass - stiffness * z - damping * v
        end_force = force_after(
            warp, force, height, speed, acceleration, end_height, end_speed, end_acceleration, duration
        )
        last = end_load
        last_rate = end_rate
        end_load, end_rate = warp_load(warp, end_force, end_height, end_speed)
        size = fabs(load) + fabs(end_load) + duration * (fabs(load_rate) + fabs(end_rate))
        if fabs(end_load - last) + duration * fabs(end_rate - last_rate) <= SETTLED * size:
            return d0, d1, d2, d3, True
    return load, load_rate, 0.0, 0.0, False


def pulled(swing: Swing, mass: float, d0: float, d1: float, d2: float, d3: float) -> Swing:
    """The motion of a mass on which a load acts as well, a cubic in time [N .. N/s3].

    >>> pulled(Swing(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 2.0, 4.0, 0.0, 0.0, 0.0).drive
    2.0
    """
    return Swing(
        swing.position,
        swing.rate,
        swing.stiffness,
        swing.damping,
        swing.drive + d0 / mass,
        swing.drive_1 + d1 / mass,
        swing.drive_2 + d2 / mass,
        swing.drive_3 + d3 / mass,
    )
