"""The highest acceleration and jerk of the smooth rotor laws, those of slotted levers and of gears."""

from dataclasses import dataclass
from math import fabs, pi

from ...physics.rotor_laws.mechanisms import noncircular_gears, slotted_levers, slotted_levers_place


@dataclass(frozen=True)
class SmoothLaw:
    """A law of slotted levers [m], or one of noncircular gears by the amplitudes of its harmonics."""

    levers: bool
    lever_radius: float
    driven_radius: float
    eccentricity: float
    harmonic: list[float]


def rate_at(law: SmoothLaw, jerk: bool, place: float) -> float:
    """Size of acceleration or jerk of a smooth law: by shaft angle, for the levers by rotor angle."""
    if law.levers:
        x = slotted_levers_place(place, law.lever_radius, law.driven_radius, law.eccentricity)
        _angle, _first, second, third = slotted_levers(
            x, law.lever_radius, law.driven_radius, law.eccentricity
        )
    else:
        _angle, _first, second, third = noncircular_gears(
            place, law.harmonic[0], law.harmonic[1], law.harmonic[2], law.harmonic[3]
        )
    return fabs(third) if jerk else fabs(second)


def highest_of(law: SmoothLaw, jerk: bool) -> float:
    """Largest acceleration or jerk of a smooth law: 120 places of half a turn, then each crest.

    Both are as large before the slow point as behind it. By rotor angle the levers' quick stretch is
    drawn out, so that the places lie dense enough there.
    """
    step = pi / 120.0
    before = rate_at(law, jerk, -step)
    here = rate_at(law, jerk, 0.0)
    largest = 0.0
    for index in range(121):
        after = rate_at(law, jerk, step * (index + 1))
        if here >= before and here >= after and here > 0.0:
            crest = crest_of(law, jerk, step * (index - 1), step * (index + 1))
            if crest > largest:
                largest = crest
            if here > largest:
                largest = here
        before = here
        here = after
    return largest


def crest_of(law: SmoothLaw, jerk: bool, start: float, end: float) -> float:
    """Largest acceleration or jerk around one crest, by golden sections: exact to rounding."""
    golden = 0.6180339887498949
    low = start
    high = end
    left = high - golden * (high - low)
    right = low + golden * (high - low)
    at_left = rate_at(law, jerk, left)
    at_right = rate_at(law, jerk, right)
    for _ in range(35):
        if at_left > at_right:
            high = right
            right = left
            at_right = at_left
            left = high - golden * (high - low)
            at_left = rate_at(law, jerk, left)
        else:
            low = left
            left = right
            at_left = at_right
            right = low + golden * (high - low)
            at_right = rate_at(law, jerk, right)
    return at_left if at_left > at_right else at_right
