"""A belt in motion as its model is given it: what it is made of, its path over a step, an instant of it.

In all modules of the belt's motion `belt` is what it is made of, `at` an instant of it, `ends` its end
shapes then, q and v its modes and their rates [m, m/s], and `contact` the side of its guide on which it
leans, 1 or -1; 0 while it turns freely there.
"""

from dataclasses import dataclass

from .belt import weft_load
from .belt_ends import FreeEnds, end_amplitudes
from .belt_modes import Bow, bow_forces, summed, weight_forces
from .numerics.absent import absent
from .numerics.brackets import at_root
from .numerics.motion import joined_rate, joined_value


@dataclass(frozen=True)
class Board:
    """Race board on the side of the bow (1) or on the other one (-1); 0 if there is none.

    Its distance from the head's line [m], and the stiffness of its cover for each length of belt [N/m2].
    """

    side: float
    distance: float
    stiffness: float


@dataclass(frozen=True)
class Belt:
    """A rapier belt between guide and head, and how these hold it.

    Masses of head and belt [kg, kg/m], gravity across the belt [m/s2], damping c [N s/m2], bending stiffness
    B [N m2], offset of the guide's exit from the head's line [m], length of the guide and clearance in it
    [m]; `leaning` if the belt turns freely in its guide up to a slope, `guided` if the head cannot turn; the
    number of modes that move.
    """

    head_mass: float
    mass: float
    gravity: float
    damping: float
    stiffness: float
    bow: Bow
    offset: float
    guide_length: float
    clearance: float
    leaning: bool
    guided: bool
    board: Board
    modes: int


@dataclass(frozen=True)
class Path:
    """The free length over a step, by the coefficients of `joined` and the share of the step [m].

    Its duration [s]; velocity and acceleration of a step without one; tension of the weft at its start and
    end [N]; the shortest length that counts [m].
    """

    joined: list[float]
    duration: float
    velocity: float
    acceleration: float
    tension: float
    end_tension: float
    taker: bool
    shortest: float


@dataclass(frozen=True)
class Instant:
    """An instant of a belt: free length L, V, A [m, m/s, m/s2], its load by the weft T [N], and its bow.

    The bow, and the belt's weight with it, by moments on the modes over the stiffness, their rates by L, and
    the bow by its end shapes.
    """

    length: float
    velocity: float
    acceleration: float
    tension: float
    moments: list[float]
    by_length: list[float]
    ends: FreeEnds


def may_clamp(belt: Belt) -> bool:
    """Return whether an end may be clamped at some time."""
    return belt.leaning or belt.guided


def length_at(path: Path, share: float) -> float:
    """Free length at a share of the step, at least the shortest one [m]."""
    start, rate, a0, a1, a2, a3 = path.joined
    length, _second = joined_value(start, rate, a0, a1, a2, a3, share)
    return length if length > path.shortest else path.shortest


def motion_at(path: Path, share: float) -> tuple[float, float, float, float]:
    """Free length, its velocity and acceleration, and the weft's load, at a share of the step."""
    start, rate, a0, a1, a2, a3 = path.joined
    length, second = joined_value(start, rate, a0, a1, a2, a3, share)
    length = length if length > path.shortest else path.shortest
    velocity = path.velocity
    acceleration = path.acceleration
    if path.duration > 0.0:
        velocity = joined_rate(rate, a0, a1, a2, a3, share) / path.duration
        acceleration = second / (path.duration * path.duration)
    tension = path.tension + share * (path.end_tension - path.tension)
    return length, velocity, acceleration, weft_load(tension, velocity, path.taker)


def crossing(path: Path, length: float) -> float:
    """Share of the step at which the free length passes a length."""
    low = 0.0
    high = 1.0
    starts_longer = length_at(path, 0.0) > length
    for _ in range(60):
        middle = 0.5 * (low + high)
        if (length_at(path, middle) > length) == starts_longer:
            low = middle
        else:
            high = middle
    _start, rate, a0, a1, a2, a3 = path.joined
    return at_root(high, length_at(path, high) - length, joined_rate(rate, a0, a1, a2, a3, high))


def stands(path: Path) -> bool:
    """Return whether neither the belt nor its load moves over the step."""
    for n in range(1, 6):
        if path.joined[n] != 0.0:
            return False
    return path.end_tension == path.tension


def instant(belt: Belt, length: float, velocity: float, acceleration: float, tension: float) -> Instant:
    """The instant of a belt with that free length, its rates and its load."""
    moments, by_length = bow_forces(belt.bow, length)
    if not absent(belt.gravity):
        weight = weight_forces(belt.mass * belt.gravity / belt.stiffness)
        moments = summed(length, weight, moments)
        by_length = summed(1.0, weight, by_length)
    return Instant(
        length,
        velocity,
        acceleration,
        tension,
        list(moments),
        list(by_length),
        end_amplitudes(belt.bow, length, may_clamp(belt)),
    )


def instant_at(belt: Belt, path: Path, share: float) -> Instant:
    """The instant at a share of the step."""
    length, velocity, acceleration, tension = motion_at(path, share)
    return instant(belt, length, velocity, acceleration, tension)


def pushed(belt: Belt, length: float, acceleration: float, tension: float) -> float:
    """Compression of a straight belt in its middle [N]."""
    return (belt.head_mass + 0.5 * belt.mass * length) * acceleration + tension
