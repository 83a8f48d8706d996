"""Warp on a sprung heald carrier: threads and carrier move each other, and are solved together.

The threads stretch with the carrier, `h = y + z + offset` with y the lift of the frame and z the
displacement in it, and pull it back to the warp line. Over a piece of the motion the load runs on the cubic
that meets value and rate at both ends; with it the carrier (`damper.propagate`) and the threads
(`warp.thread_force`) have exact solutions, and the end is found by repetition. Law of the threads: Korolev
(3.28), corrected.
"""

from math import fabs

from .damper import propagate
from .numerics.motion import joined, moved_on
from .warp import eye_bend, eye_pull, thread_drive, thread_extension, thread_force

MOST_REPEATS = 30  # of a piece: each leaves a tenth of the error at most on a piece short enough
SETTLED = 4e-16  # of the load: what rounding leaves


def force_after(
    height: float,
    velocity: float,
    acceleration: float,
    end_height: float,
    end_velocity: float,
    end_acceleration: float,
    force: float,
    stiffness: float,
    creep: float,
    relaxation: float,
    front: float,
    back: float,
    duration: float,
) -> float:
    """Force of the threads above their pretension after a piece of the eyes' motion, of the law (3.28).

    Args:
        height, velocity, acceleration: of the eyes above the warp line at the start [m, m/s, m/s2]
        end_height, end_velocity, end_acceleration: the same at the end
        force: at the start [N]
        stiffness, creep, relaxation: b [N/m], n and r [1/s]
        front, back: lengths of the warp [m]
        duration: of the piece [s]

    >>> round(force_after(0.0, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 10.0, 0.0, 0.0, 0.4, 0.4, 0.1), 12)  # a spring
    2.0
    """
    x0, rate, second = thread_extension(height, velocity, acceleration, front, back)
    x1, end_rate, end_second = thread_extension(end_height, end_velocity, end_acceleration, front, back)
    square = duration * duration
    a0, a1, a2, a3 = joined(
        x0, duration * rate, square * second, x1, duration * end_rate, square * end_second
    )
    p0, p1, p2, p3, p4, p5 = thread_drive(stiffness, creep * duration, x0, x1, a0, a1, a2, a3)
    end, _area = thread_force(force, relaxation * duration, p0, p1, p2, p3, p4, p5, 1.0)
    return end


def warp_load(
    height: float,
    velocity: float,
    force: float,
    pretension: float,
    stiffness: float,
    creep: float,
    relaxation: float,
    front: float,
    back: float,
) -> tuple[float, float]:
    """Load of the threads on their eyes, positive upwards, and its rate; none while they are slack.

    `L = -(T0 + F) s`, `L' = -F' s - (T0 + F) s' h'`, with `F' = b (s h' + n x) - r F`.

    Args:
        height, velocity: of the eyes above the warp line [m, m/s]
        force, pretension: F and T0 of all threads [N]
        stiffness .. back: as for `force_after`

    Returns:
        load [N], rate [N/s]

    >>> warp_load(0.3, 0.0, 4.0, 1.0, 10.0, 0.0, 0.0, 0.4, 0.4)
    (-6.0, -0.0)
    """
    pull = pretension + force
    if pull <= 0.0:
        return 0.0, 0.0
    slope = eye_pull(height, front, back)
    extension, rate, _second = thread_extension(height, velocity, 0.0, front, back)
    growth = stiffness * (rate + creep * extension) - relaxation * force
    return -pull * slope, -growth * slope - pull * eye_bend(height, front, back) * velocity


def warp_stiffness(
    height: float, force: float, pretension: float, stiffness: float, front: float, back: float
) -> float:
    """Stiffness of all threads against a fast motion of their eyes, `b s^2 + (T0 + F) s'` [N/m].

    >>> warp_stiffness(0.0, 0.0, 2.0, 10.0, 0.5, 0.5)
    8.0
    """
    pull = pretension + force
    slope = eye_pull(height, front, back)
    return stiffness * slope * slope + fabs(pull) * eye_bend(height, front, back)


def cubic_between(
    start: float, start_rate: float, end: float, end_rate: float, duration: float
) -> tuple[float, float, float, float]:
    """Cubic in time that meets value and rate at both ends: coefficients of 1, t, t^2, t^3.

    >>> cubic_between(0.0, 0.0, 8.0, 12.0, 2.0)
    (0.0, 0.0, 0.0, 1.0)
    """
    mean = (end - start) / duration
    return (
        start,
        start_rate,
        (3.0 * mean - 2.0 * start_rate - end_rate) / duration,
        (start_rate + end_rate - 2.0 * mean) / (duration * duration),
    )


def settled_load(
    position: float,
    rate: float,
    force: float,
    mass: float,
    stiffness: float,
    damping: float,
    u0: float,
    u1: float,
    u2: float,
    u3: float,
    lift: float,
    velocity: float,
    a0: float,
    a1: float,
    a2: float,
    a3: float,
    pretension: float,
    thread_stiffness: float,
    creep: float,
    relaxation: float,
    front: float,
    back: float,
    duration: float,
) -> tuple[float, float, float, float, bool]:
    """Load of the threads on the carrier over a piece of their common motion, a cubic in time.

    Repeated until the load with which the carrier moves is the one that its motion gives.

    Args:
        position, rate: z and z' of the carrier in its frame at the start [m, m/s]
        force: F of all threads at the start [N]
        mass: of the carrier [kg]
        stiffness, damping, u0 .. u3: as for `propagate`, without the threads
        lift, velocity, a0 .. a3: of the frame, as for `moved_on`; the lift is that of eyes in mid-travel
            above the warp line
        pretension, thread_stiffness: T0 [N] and b [N/m] of all threads
        creep .. duration: as for `force_after`

    Returns:
        coefficients of 1, t, t^2, t^3, and whether the piece is short enough for this
    """
    height = lift + position
    speed = velocity + rate
    load, load_rate = warp_load(
        height, speed, force, pretension, thread_stiffness, creep, relaxation, front, back
    )
    acceleration = a0 + u0 + load / mass - stiffness * position - damping * rate
    end_lift, end_velocity, end_acceleration = moved_on(lift, velocity, a0, a1, a2, a3, duration)
    t = duration
    drive = u0 + t * (u1 + t * (u2 + t * u3))
    end_load = load + load_rate * duration
    end_rate = load_rate
    for _ in range(MOST_REPEATS):
        d0, d1, d2, d3 = cubic_between(load, load_rate, end_load, end_rate, duration)
        z, v = propagate(
            position,
            rate,
            stiffness,
            damping,
            u0 + d0 / mass,
            u1 + d1 / mass,
            u2 + d2 / mass,
            u3 + d3 / mass,
            duration,
        )
        end_height = end_lift + z
        end_speed = end_velocity + v
        end_force = force_after(
            height,
            speed,
            acceleration,
            end_height,
            end_speed,
            end_acceleration + drive + end_load / mass - stiffness * z - damping * v,
            force,
            thread_stiffness,
            creep,
            relaxation,
            front,
            back,
            duration,
        )
        last = end_load
        last_rate = end_rate
        end_load, end_rate = warp_load(
            end_height, end_speed, end_force, pretension, thread_stiffness, creep, relaxation, front, back
        )
        size = fabs(load) + fabs(end_load) + duration * (fabs(load_rate) + fabs(end_rate))
        if fabs(end_load - last) + duration * fabs(end_rate - last_rate) <= SETTLED * size:
            return d0, d1, d2, d3, True
    return load, load_rate, 0.0, 0.0, False
