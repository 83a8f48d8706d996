"""Bending and shortening of the belt against fine quadrature of its shape; the balance of its energy."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from loomfmu.physics.belt_bending import bent_belt
from loomfmu.physics.belt_ends import end_shape
from loomfmu.physics.belt_modes import Bow
from loomfmu.physics.belt_motion import accelerations, ends_at, energy_and_powers
from loomfmu.physics.belt_moving import Belt, Board, instant
from loomfmu.physics.belt_steps import MOST_STEPS, pieces

NODES, WEIGHTS = np.polynomial.legendre.leggauss(100)
X, Y, W = 0.5 * (1.0 + NODES), 0.5 * (1.0 - NODES), 0.5 * WEIGHTS
NUMBERS = np.arange(1, 7)
LENGTH, VELOCITY, ACCELERATION = 0.7, 12.0, 800.0
BOW, BOW_LENGTH = 1e-3, 0.9
CLAMPED = 4.493409457909064  # k L at Euler's load with one end clamped


def buckled(clamped):
    """Sines of the shape in which the belt buckles, 0.08 of its length high or so."""
    if clamped == 0:
        return 0.08 * LENGTH * np.array([1.0, 0.1, 0.02, 5e-3, 1e-3, 2e-4])
    n, high = NUMBERS, 0.08 * LENGTH
    if clamped == 3:
        return np.where(n % 2, -8.0 * high / (pi * n * (n * n - 4.0 + (n == 2))), 0.0)
    sines = 1.2 * high * CLAMPED**2 / (n * (n * n * pi * pi - CLAMPED**2)) * np.where(n % 2, -1.0, 1.0)
    return sines if clamped == 1 else np.where(n % 2, sines, -sines)


def belt(clamped, **given):
    """A belt with clamped ends, 1 at the guide, 2 at the head, 3 both, and its contact in the guide."""
    by_default = {
        "head_mass": 0.1,
        "mass": 0.05,
        "gravity": 40.0,
        "damping": 0.4,
        "stiffness": 0.39,
        "bow": Bow(1, BOW, BOW_LENGTH),
        "offset": 2e-4,
        "guide_length": 1.0,
        "clearance": 1e-3,
        "leaning": True,
        "guided": clamped >= 2,
        "board": Board(-1.0, 2e-3, 1e5),
        "modes": 6,
    }
    return Belt(**{**by_default, **given}), clamped % 2


def integrals(clamped, modes, length):
    """Bending energy over the stiffness without the end shapes' own to the second order, and shortening."""
    given, contact = belt(clamped)
    ends = ends_at(given, instant(given, length, 0.0, 0.0, 0.0), contact, list(modes), list(modes))
    guide, head = ends.guide, ends.head
    a = np.array(end_shape(guide, head, list(modes))) * NUMBERS * pi
    slope = a @ np.cos(pi * np.outer(NUMBERS, X)) + guide * (3.0 * X**2 - 1.0) - head * (3.0 * Y**2 - 1.0)
    bend = 6.0 * (guide * X + head * Y) - (a * NUMBERS * pi) @ np.sin(pi * np.outer(NUMBERS, X))
    slope, bend = slope / length, bend / length**2
    alone = pi**4 / (4.0 * length**3) * (NUMBERS**4 * modes**2).sum()
    more = length * W @ (0.5 * bend**2 * slope**2 / (1.0 - slope**2))
    return np.array([alone + more, length * W @ (1.0 - np.sqrt(1.0 - slope**2))])


def difference(function, step):
    return (function(step) - function(-step)) / (2.0 * step)


@pytest.mark.parametrize("clamped", [0, 1, 2, 3])
def test_bending_and_shortening_and_their_rates_are_those_of_the_shape(clamped):
    modes = buckled(clamped)
    speeds = modes * np.array([30.0, -20.0, 40.0, 10.0, -60.0, 20.0])
    given, contact = belt(clamped)
    at = instant(given, LENGTH, VELOCITY, ACCELERATION, 0.0)
    ends = ends_at(given, at, contact, list(modes), list(speeds))
    found = bent_belt(at, ends, list(modes), list(speeds))

    def later(time):
        length = LENGTH + time * VELOCITY + 0.5 * time**2 * ACCELERATION
        return integrals(clamped, modes + time * speeds, length)

    energies, shortenings = np.array(
        [difference(lambda step, n=n: integrals(clamped, modes + step * n, LENGTH), 1e-6) for n in np.eye(6)]
    ).T
    by_length = difference(lambda step: integrals(clamped, modes, LENGTH + step), 1e-6)
    tiny = 2e-5
    second = (later(tiny) - 2.0 * later(0.0) + later(-tiny))[1] / tiny**2
    within = 6e-3 if clamped else 3e-4  # of 12 panels, whose sum is exact but for what the end shapes add
    energy, shortening = integrals(clamped, modes, LENGTH)
    assert (found.energy, found.shortening) == pytest.approx((energy, shortening), rel=within)
    assert -np.array(found.moments) == pytest.approx(energies, abs=within * np.abs(energies).max())
    assert found.pulls == pytest.approx(shortenings, abs=within * np.abs(shortenings).max())
    assert found.rate == pytest.approx(difference(later, tiny)[1], rel=within)
    assert found.second == pytest.approx(second, rel=within)
    assert (found.energy_by_length, found.by_length) == pytest.approx(tuple(by_length), rel=within)


@settings(max_examples=60, deadline=None)
@given(
    clamped=st.integers(0, 3),
    shape=st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6),
    swing=st.lists(st.floats(-100.0, 100.0), min_size=6, max_size=6),
    size=st.floats(1e-4, 0.05),
    velocity=st.floats(-30.0, 30.0),
    acceleration=st.floats(-2000.0, 2000.0),
    head_mass=st.floats(0.0, 1.0),
)
def test_the_energy_changes_by_the_powers(clamped, shape, swing, size, velocity, acceleration, head_mass):
    """To rounding, however coarse the sums over panels are: all forces come of one energy."""
    modes = LENGTH * size * np.array(shape) / NUMBERS**2
    speeds = modes * np.array(swing)
    given, contact = belt(clamped, head_mass=head_mass)

    def energy(time, load=0.0):
        length = LENGTH + time * velocity + 0.5 * time**2 * acceleration
        at = instant(given, length, velocity + time * acceleration, acceleration, 3.0)
        place = list(modes + time * speeds + 0.5 * time**2 * found)
        return energy_and_powers(given, at, contact, place, list(speeds + time * found), list(found), load)

    at = instant(given, LENGTH, velocity, acceleration, 3.0)
    rates, load = accelerations(given, at, contact, list(modes), list(speeds))
    found = np.array(rates)
    fastest = 1e3 + np.abs(swing).max() + np.sqrt(np.abs(found).max() / (np.abs(modes).max() + 1e-9))
    step = 1e-3 / fastest
    growth = (
        8.0 * difference(lambda t: energy(t)[0], step) - 2.0 * difference(lambda t: energy(t)[0], 2.0 * step)
    ) / 6.0
    held, push, guide, loss = energy(0.0, load)
    through = abs(push) + abs(guide) + abs(loss) + abs(held) / step
    assert growth == pytest.approx(push + guide - loss, abs=1e-7 * through)  # of the differences


@pytest.mark.parametrize(
    ("duration", "number"), [(0.0, 1), (5e-4, 1), (5.1e-4, 2), (1e-3, 2), (2e-3, 4), (1e9, MOST_STEPS)]
)
def test_a_long_step_is_taken_in_pieces_of_half_a_millisecond(duration, number):
    assert pieces(duration) == number
