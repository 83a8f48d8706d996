"""Heald carrier on springs between stops: exact propagation of a driven linear oscillator.

Source: Korolev, thesis on rotary dobbies (Moscow), sections 5.2 and 5.3, equations (5.1) to (5.6). The
dynamics behind the design formula, per unit of carrier mass and relative to the outer frame, are
`z'' + c z' + k z = u(t)`; a stop adds its own spring and dashpot. Between changes of contact this is
linear, and the power series of its solution, which converges for every step, is summed to rounding.
"""

from dataclasses import dataclass
from math import atan2, exp, fabs, log, pi, sqrt

from .numerics.brackets import at_root
from .numerics.motion import moved_on


def design_stiffness(load: float, mass: float, acceleration: float, travel: float) -> float:
    """Stiffness of one of the four springs [N/m], `c = (T - m a) / (4 S)`, equation (5.6).

    Erratum: the source prints 59.6 N/mm for what is 5.96 N/mm.

    Args:
        load: largest load T of the warp on the frame [N]
        mass: of the carrier m [kg]
        acceleration: of the frame a [m/s2]
        travel: of the carrier in the frame S [m]

    >>> round(design_stiffness(957.6, 15.0, 40.0, 0.015))
    5960
    """
    return (load - mass * acceleration) / (4.0 * travel)


def stop_damping_ratio(restitution: float) -> float:
    """Damping ratio r, 0 to 1 [1], of a stop that returns a mass with a given share of its speed.

    A spring and dashpot that act only in compression let go when their force is zero, after the time
    `(pi - atan2(2 r s, 1 - 2 r^2)) / (s w)`, `s = sqrt(1 - r^2)`; the share of the speed left is
    `exp(-r w time)`. Solved for r by bisection. See Schwager and Poeschel, Granular Matter 9 (2007) 465.
    The restitution is the speed after a contact over that before it, 0.15 to 1 [1].

    >>> stop_damping_ratio(1.0) < 1e-12, round(stop_damping_ratio(0.5), 4)
    (True, 0.2553)
    """
    low = 0.0
    high = 1.0 - 1e-9
    for _ in range(60):
        ratio = 0.5 * (low + high)
        if exp(-_decay(ratio)) > restitution:
            low = ratio
        else:
            high = ratio
    ratio = 0.5 * (low + high)
    rest = 1.0 - ratio * ratio
    slope = _decay(ratio) / (ratio * rest) - 2.0 * ratio / rest
    return at_root(ratio, _decay(ratio) + log(restitution), slope) if ratio > 1e-9 else ratio


def _decay(ratio: float) -> float:
    """Decay of the speed in a contact, as the exponent of `stop_damping_ratio`."""
    root = sqrt(1.0 - ratio * ratio)
    return ratio / root * (pi - atan2(2.0 * ratio * root, 1.0 - 2.0 * ratio * ratio))


@dataclass(frozen=True)
class Swing:
    """A driven oscillator, `z'' + c z' + k z = u0 + u1 t + u2 t^2 + u3 t^3`, from a state on.

    z [m] and z' [m/s] at the start, k [1/s2] and c [1/s], u0 [m/s2] to u3 [m/s5].
    """

    position: float
    rate: float
    stiffness: float
    damping: float
    drive: float
    drive_1: float
    drive_2: float
    drive_3: float


@dataclass(frozen=True)
class Ride:
    """The motion of a frame: lift [m], velocity [m/s], and acceleration, a cubic in time [m/s2 .. m/s5]."""

    lift: float
    velocity: float
    a0: float
    a1: float
    a2: float
    a3: float


def ride_on(ride: Ride, time: float) -> Ride:
    """The motion of a frame from a later time on.

    >>> ride_on(Ride(1.0, 2.0, 6.0, 0.0, 0.0, 0.0), 0.5)
    Ride(lift=2.75, velocity=5.0, a0=6.0, a1=0.0, a2=0.0, a3=0.0)
    """
    a1, a2, a3 = ride.a1, ride.a2, ride.a3
    lift, velocity, acceleration = moved_on(ride.lift, ride.velocity, ride.a0, a1, a2, a3, time)
    return Ride(
        lift, velocity, acceleration, a1 + time * (2.0 * a2 + time * 3.0 * a3), a2 + 3.0 * a3 * time, a3
    )


def propagate(swing: Swing, duration: float) -> tuple[float, float]:
    """State of an oscillator after a duration, `z` [m] and `z'` [m/s].

    The power series of the exact solution, summed until its terms are below rounding. Valid for `sqrt(k) t`
    and `c t` up to about 1, where nothing cancels; the caller splits longer steps.

    >>> from math import cos, sin
    >>> z, v = propagate(Swing(1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.5)
    >>> abs(z - cos(0.5)) < 1e-16, abs(v + sin(0.5)) < 1e-16
    (True, True)
    """
    position = swing.position
    rate = swing.rate
    if duration == 0.0:
        return position, rate
    square = duration * duration
    elastic = swing.stiffness * square
    viscous = swing.damping * duration
    fourth_power = square * square
    following = rate * duration
    # the terms that the drive feeds
    second = (swing.drive * square - viscous * following - elastic * position) / 2.0
    third = (swing.drive_1 * duration * square - 2.0 * viscous * second - elastic * following) / 6.0
    fourth = (swing.drive_2 * fourth_power - 3.0 * viscous * third - elastic * second) / 12.0
    fifth = (swing.drive_3 * duration * fourth_power - 4.0 * viscous * fourth - elastic * third) / 20.0
    total = position + following + second + third + fourth + fifth
    slope = following + 2.0 * second + 3.0 * third + 4.0 * fourth + 5.0 * fifth
    term = fourth
    following = fifth
    n = 6
    while n < 103:
        if n * (fabs(term) + fabs(following)) <= 1e-18 * (fabs(total) + fabs(slope)):
            break
        new = -(viscous * (n - 1) * following + elastic * term) / ((n - 1) * n)
        total = total + new
        slope = slope + n * new
        term = following
        following = new
        n = n + 1
    return total, slope / duration


def drive_at(swing: Swing, time: float) -> float:
    """Drive of an oscillator at a time [m/s2].

    >>> drive_at(Swing(0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0), 2.0)
    49.0
    """
    return swing.drive + time * (swing.drive_1 + time * (swing.drive_2 + time * swing.drive_3))


@dataclass(frozen=True)
class Piece:
    """A piece of a carrier's motion: its swing, what a stop pushes back at z = 0 [m/s2], and what loads it.

    The load is a cubic in time [N .. N/s3].
    """

    swing: Swing
    preload: float
    load: float
    load_1: float
    load_2: float
    load_3: float


def load_at(piece: Piece, time: float) -> float:
    """Load of a carrier at a time of a piece [N]."""
    return piece.load + time * (piece.load_1 + time * (piece.load_2 + time * piece.load_3))


def power_of_frame(
    mass: float, preload: float, swing: Swing, velocity: float, acceleration: float, jerk: float
) -> tuple[float, float, float]:
    """Power of the frame on its carrier [W], `-m (k z + c z' - p) v`, and its first and second rate.

    Args:
        mass: of the carrier m [kg]
        preload: p, what a stop pushes back at z = 0 [m/s2]
        swing: of the carrier in its frame, at its start
        velocity, acceleration, jerk: of the frame [m/s, m/s2, m/s3]

    >>> at_rest = Swing(0.5, 0.0, 3.0, 0.0, 1.5, 0.0, 0.0, 0.0)  # in the moving frame
    >>> power_of_frame(2.0, 0.0, at_rest, 4.0, 1.0, 0.0)
    (-12.0, -3.0, -0.0)
    """
    stiffness = swing.stiffness
    damping = swing.damping
    second = swing.drive - stiffness * swing.position - damping * swing.rate
    third = swing.drive_1 - stiffness * swing.rate - damping * second
    force = mass * (stiffness * swing.position + damping * swing.rate - preload)
    growth = mass * (stiffness * swing.rate + damping * second)
    bend = mass * (stiffness * second + damping * third)
    return (
        -force * velocity,
        -growth * velocity - force * acceleration,
        -bend * velocity - 2.0 * growth * acceleration - force * jerk,
    )
