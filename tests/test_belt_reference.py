"""The finite elements that BeltDynamics is compared with, by themselves: their ends against closed forms."""

import math
from functools import cache
from math import pi

import numpy as np
import pytest
from belt_guide_reference import CLAMPED, deflection
from belt_reference import FiniteElements
from scipy.linalg import eigh
from scipy.optimize import brentq

from loomfmu.components.weft_insertion import WeftInsertion
from loomfmu.machines import parameters

CLEARANCE, GUIDE = 0.3e-3, 0.05


def straight(x, _length):
    return 0.0 * x


def standing(elements, length=1.0, **given):
    """A straight belt of constant length with small slopes, EI = rho = 1 unless they are given."""
    usual = {"rho": 1.0, "mass": 0.0, "stiffness": 1.0, "bent": False}
    return FiniteElements(lambda _t: (length, 0.0, 0.0), straight, elements=elements, **{**usual, **given})


def extrapolated(value):
    """By six and twelve elements, whose error falls with the fourth power of their size."""
    coarse, fine = value(6), value(12)
    assert np.abs(coarse / fine - 1.0).max() < 8e-3  # of the third frequency of a clamped beam
    return (16.0 * fine - coarse) / 15.0


@pytest.mark.parametrize("guided", [False, True])
@pytest.mark.parametrize("touches", [0, 1])
def test_the_load_of_euler_for_each_pair_of_ends(guided, touches):
    def load(elements):
        matrices = standing(elements, guided=guided).matrices(1.0)
        bending, squeezed = (each[touches:, touches:] for each in matrices)  # the first slope is at the guide
        return eigh(bending, squeezed, eigvals_only=True)[0]

    clamped = 2.0 * pi if guided and touches else CLAMPED if guided or touches else pi
    # what is left of 1e-3 by extrapolation falls with the sixth power
    assert extrapolated(load) == pytest.approx(clamped**2, rel=2e-5)


def transcendental(frequency, compression, guided):
    """Vanishes at the frequencies of a beam with one end clamped and the other pinned or clamped."""
    root = math.sqrt(0.25 * compression**2 + frequency**2)
    a, b = math.sqrt(root + 0.5 * compression), math.sqrt(root - 0.5 * compression)
    if not guided:
        return a * math.cos(a) * math.tanh(b) - b * math.sin(a)
    return 2 * a * b * (1 / math.cosh(b) - math.cos(a)) + (b * b - a * a) * math.sin(a) * math.tanh(b)


@pytest.mark.parametrize("guided", [False, True])
@pytest.mark.parametrize("compression", [0.0, 10.0, -10.0])
def test_frequencies_of_a_belt_that_its_guide_holds(guided, compression):
    def frequencies(elements):
        belt = standing(elements, guided=guided, clearance=0.0, tension=compression)
        return np.sort(np.linalg.eigvals(belt.jacobian(0.0, None, 1.0)).imag)[-belt.free + 1 :][:3]

    found = extrapolated(frequencies)
    if compression == 0.0:  # published for beams that are clamped and pinned, and clamped
        assert found == pytest.approx(
            [22.37329, 61.67282, 120.90339] if guided else [15.41821, 49.96486, 104.24770], rel=1e-3
        )
    for number, each in enumerate(found):
        around = (0.98 * each, 1.02 * each)
        # as for the load of Euler; higher shapes are resolved less
        assert each == pytest.approx(
            brentq(transcendental, *around, args=(compression, guided)), rel=(2e-5, 1e-4, 1e-3)[number]
        )


def along_guide(belt, nodes):
    """Largest deflection from the line of the head, half the clearance off at the guide."""
    return np.abs(belt.places(401) @ nodes + 0.5 * CLEARANCE * np.linspace(1.0, 0.0, 401)).max()


@pytest.mark.parametrize("turn", [3.3, 3.8, 4.2])
@pytest.mark.parametrize("length", [0.2, 0.665])
def test_a_belt_that_leans_on_its_guide_is_deflected_as_in_statics(length, turn):
    belt = standing(12, length, clearance=CLEARANCE, guide=GUIDE)
    nodes = belt.equilibrium(0.0, 1.0, (turn / length) ** 2)
    # the load of Euler is off by 3e-5, which is magnified near it; 401 places know a bow to 1e-5
    assert along_guide(belt, nodes) == pytest.approx(deflection(turn, CLEARANCE, GUIDE, length), rel=3e-4)


def test_a_slow_load_leans_the_belt_on_its_guide_as_in_statics():
    length, turn = 0.1737, 3.8
    rate = (pi / length) ** 2 * math.sqrt(0.25 / 0.05)
    belt = standing(
        8,
        length,
        clearance=CLEARANCE,
        guide=GUIDE,
        stiffness=0.25,
        rho=0.05,
        tension=0.25 * (turn / length) ** 2,
        drag=0.1 * rate,
    )
    bow = 1e-4 * np.linalg.solve(belt.inner, belt.at((belt.n, np.sin(pi * belt.x))))
    found = belt.nodes(bow, 0.0 * bow, [0.0, 30.0 / rate], 1e-3, 1e-7)[:, -1]
    assert belt.touched(0.0, bow[0]) == 0.0
    assert belt.touched(0.0, found[0]) == 1.0
    # eight elements by themselves are off by 2e-4, and the run by its tolerance
    assert along_guide(belt, found) == pytest.approx(deflection(turn, CLEARANCE, GUIDE, length), rel=5e-4)


def test_a_stop_takes_no_energy_from_a_belt():
    # the end of an element has a mass that falls with the third power of its size, that of a belt has none
    lost = []
    for elements in (6, 12):
        belt = standing(elements, clearance=CLEARANCE, guide=GUIDE)
        shape = np.linalg.solve(belt.inner, belt.at((belt.n, np.sin(pi * belt.x))))
        _side, _nodes, stopped = belt.met(0.0, shape * belt.stopped(0.0, 1.0)[0] / shape[0], shape)
        assert stopped[0] == pytest.approx(0.0, abs=1e-12)  # rounding of pi
        lost.append(1.0 - stopped @ belt.inner @ stopped / (shape @ belt.inner @ shape))
    assert lost[0] / lost[1] == pytest.approx(8.0, rel=0.02)
    assert lost[1] < 1e-4


@cache
def head():
    """Way of the head of the WL680-3600 beyond its guide at 682 rev/min, and the duration of a degree."""
    weft = WeftInsertion(**parameters("WeftInsertion", machine="WL680-3600"), speed=682.0 * pi / 30.0)
    weft.initialize(0.0)

    def motion(time):
        weft.step(time, 0.0)
        return weft.travel - 0.793, weft.velocity, weft.acceleration

    return motion, 1.0 / (6.0 * 682.0)


def own_bow(x, length):
    return -0.3e-3 * (pi / 0.2) ** 2 * np.sin(pi * (length - x) / 0.2)


def bow_of_span(x, length):
    return -0.3e-3 * (pi / length) ** 2 * np.sin(pi * x / length)


@cache
def stroke(bow, elements=6, **given):
    """Belt, and its nodes at 93.45 (20 mm outside the guide, at rest) and at each of 94 to 106 deg."""
    motion, degree = head()
    belt = FiniteElements(motion, bow, stiffness=0.25, elements=elements, **{"bent": False, **given})
    times = degree * np.array([93.45, *range(94, 107)])
    side = belt.touched(times[0], belt.equilibrium(times[0])[0])
    before, start, after = (belt.equilibrium(times[0] + k * 1e-9, side) for k in (-1, 0, 1))
    return belt, times, belt.nodes(start, (after - before) / 2e-9, times, 1e-3, 1e-8)


def farthest(bow, *args, **given):
    belt, _times, nodes = stroke(bow, *args, **given)
    return np.abs(belt.places(201) @ nodes).max(axis=0)


PLAY = {"clearance": CLEARANCE, "guide": GUIDE}


@pytest.mark.few(1)
@pytest.mark.parametrize(("bow", "bent"), [(own_bow, False), (own_bow, True), (bow_of_span, False)])
def test_the_guide_holds_the_belt_on_its_stroke(bow, bent):
    belt, times, nodes = stroke(bow, bent=bent, **PLAY)
    most = np.array([belt.stopped(time, 1.0)[0] for time in times])
    assert (np.abs(nodes[0]) <= most * (1.0 + 1e-6)).all()  # what is left of the drift of both integrals
    assert (nodes[0] > most * (1.0 - 1e-6)).sum() >= 2
    held = farthest(bow, bent=bent, **PLAY)[-1]
    assert held < 0.97 * farthest(bow)[-1]
    # 1 to 2.5 mm of 0.3 m: the cosine of the slope is 1 - 1e-4, the head's lag relieves the belt by some 1e-3
    assert held == pytest.approx(farthest(bow, **PLAY)[-1], rel=5e-3)
    assert farthest(bow, guided=True, **PLAY)[-1] < 0.8 * held


@pytest.mark.few(1)
@pytest.mark.parametrize("bow", [own_bow, bow_of_span])
def test_six_elements_suffice_for_the_stroke(bow):
    # nine, twelve and more give a half to a quarter of what these are off
    assert farthest(bow, 6, **PLAY)[2:] == pytest.approx(farthest(bow, 9, **PLAY)[2:], rel=1e-3)


def test_the_inertia_of_a_chord_that_turns():
    motion, degree = head()
    belt = FiniteElements(motion, straight, elements=6, bent=False, drag=3.0)
    time, h = 98.0 * degree, 1e-6
    (length, _speed, a), y = motion(time), 0.15e-3
    point = length * (1.0 - belt.x)  # of the belt, that the head takes along
    before, here, after = (y * point / motion(time + k * h)[0] for k in (-1, 0, 1))
    load = belt.rho * (before - 2.0 * here + after) / h**2 + belt.drag * (after - before) / (2.0 * h)
    load = load + belt.rho * a * y / length  # of the compression, which falls towards the head
    found = FiniteElements(motion, straight, elements=6, bent=False, drag=3.0, offset=y).linear(time)[2]
    expected = -belt.inverse @ belt.at((belt.n, load)) / belt.rho
    assert found == pytest.approx(expected, rel=1e-4, abs=1e-4 * np.abs(expected).max())  # of differences


@pytest.mark.slow
def test_the_inertia_of_the_chord_is_not_small():
    """A finding: the chord from half the clearance to the head turns so fast that it bends the belt."""
    for bow, least, most in ((own_bow, 0.2, 0.6), (bow_of_span, 0.04, 0.08)):
        # at 104 deg
        none, less, more = (
            farthest(bow, offset=offset, **PLAY)[11] for offset in (0.0, 0.5 * CLEARANCE, -0.5 * CLEARANCE)
        )
        assert least < 1.0 - less / none < most
        assert least < more / none - 1.0 < most
