"""BeltDynamics with a guided head and with free play in its guide: closed forms, statics, finite elements."""

import math
from dataclasses import astuple
from math import pi, sqrt

import numpy as np
import pytest
from belt_guide_reference import CLAMPED, PLACES, deflection
from belt_loom import Loom, ends, shape
from belt_reference import FiniteElements
from scipy.integrate import solve_bvp
from scipy.optimize import brentq
from scipy.special import ellipk

from loomfmu import run
from loomfmu.components.belt_dynamics import BeltDynamics
from loomfmu.declaring.variables import variables_of
from loomfmu.physics.belt_end_forces import (
    CROSS_ALONG,
    CROSS_TWICE,
    SQUARE_ALONG,
    SQUARE_TWICE,
    end_forces,
    head_forces,
)
from loomfmu.physics.belt_ends import CROSS, SQUARE, buckling, end_amplitudes, turned_by
from loomfmu.physics.belt_modes import Bow
from loomfmu.physics.belt_motion import accelerations
from loomfmu.physics.belt_moving import instant

BELT, SPAN = 1, 2
PLAY, GUIDED = 2, 2
LENGTH = 0.1737  # of the default travel
NO_CLEARANCE = {"guide_end": PLAY, "guide_clearance": 0.0}
# What the belt is given, its stiffness, what is clamped, k L at Euler's load; how well that load and three
# frequencies are met: the end shapes make up for the bending of the modes beyond six, and to first order for
# the push on them, but not for their mass.
ENDS = [
    ({}, 0.25 / 0.64, "", pi, 1e-6, (1e-9, 1e-9, 1e-9)),
    (NO_CLEARANCE, 0.25, "guide", CLAMPED, 1.4e-5, (2e-5, 2e-4, 8e-4)),
    ({"head_end": GUIDED}, 0.25 / 0.64, "head", CLAMPED, 1.4e-5, (2e-5, 2e-4, 8e-4)),
    ({**NO_CLEARANCE, "head_end": GUIDED}, 0.25, "guide, head", 2.0 * pi, 1.5e-4, (1.5e-4, 4e-4, 3e-3)),
]
EVERY_END = [
    {"guide_end": PLAY},
    {"head_end": GUIDED},
    {"guide_end": PLAY, "head_end": GUIDED, "guide_offset": 0.15e-3},
]


def squared_frequencies(load, **given):
    """Of the modes of a straight belt that stands under a load, in order."""
    belt = BeltDynamics(bow=0.0, **given)
    belt.initialize(0.0)
    columns = []
    for mode in np.eye(6) * 1e-12:
        at = instant(belt.given(), belt.free_length, 0.0, 0.0, load)
        columns.append(accelerations(belt.given(), at, belt.guide_contact, list(mode), [0.0] * 6)[0])
    return np.sort(-np.linalg.eigvals(np.array(columns).T / 1e-12).real)


@pytest.mark.parametrize("case", ENDS)
def test_the_load_of_euler_of_each_pair_of_ends(case):
    given, stiffness, _clamped, turn, within, _close = case
    expected = turn**2 * stiffness / LENGTH**2
    found = brentq(
        lambda load: squared_frequencies(load, **given)[0],
        0.9 * expected,
        1.1 * expected,
        xtol=1e-9 * expected,
    )
    assert found == pytest.approx(expected, rel=within)


def beam_frequency(clamped, compression, number):
    """Of a beam with EI = rho = L = 1, from its characteristic equation."""

    def rows(x, a, b, is_clamped):
        ch, sh, c, s = math.cosh(a * x), math.sinh(a * x), math.cos(b * x), math.sin(b * x)
        if is_clamped:
            return [ch, sh, c, s], [a * sh, a * ch, -b * s, b * c]
        return [ch, sh, c, s], [a * a * ch, a * a * sh, -b * b * c, -b * b * s]

    def determinant(root):
        inner = sqrt(0.25 * compression**2 + root**4)
        a, b = sqrt(inner - 0.5 * compression), sqrt(inner + 0.5 * compression)
        matrix = [*rows(0.0, a, b, "head" in clamped), *rows(1.0, a, b, "guide" in clamped)]
        return np.linalg.det(np.array(matrix)) / math.cosh(a)

    roots = np.linspace(0.2, (number + 1.2) * pi, 400)
    values = [determinant(root) for root in roots]
    at = [n for n in range(len(roots) - 1) if values[n] * values[n + 1] < 0.0][number - 1]
    return brentq(determinant, roots[at], roots[at + 1], xtol=1e-13) ** 2


@pytest.mark.parametrize("share", [0.0, 0.5])
@pytest.mark.parametrize("case", ENDS)
def test_frequencies_of_each_pair_of_ends_under_compression(case, share):
    given, stiffness, clamped, turn, _within, within = case
    compression = share * turn**2
    found = np.sqrt(squared_frequencies(compression * stiffness / LENGTH**2, **given))[:3]
    unit = sqrt(stiffness / 0.05) / LENGTH**2
    for number, frequency, close in zip((1, 2, 3), found, within, strict=True):
        assert frequency / unit == pytest.approx(beam_frequency(clamped, compression, number), rel=close)


@pytest.mark.parametrize("case", ENDS)
def test_beyond_its_load_the_belt_grows_at_the_rate_that_it_shows(belt_in_c, case):
    given, stiffness, _clamped, turn, _within, _close = case
    belt = belt_in_c(bow=0.0, **given)
    belt.initialize(0.0)
    belt.yarn_tension = 1.05 * turn**2 * stiffness / LENGTH**2
    belt.mode = (1e-10, 0.0, 0.0, 0.0, 0.0, 0.0)
    amplitudes = []
    for n in range(81):
        assert belt.step(5e-4 * n, 5e-4) == 0
        amplitudes.append(belt.deflection)
    # the rate is Rayleigh's, in the shape of the least load: 1e-3 off at a load of 5 % more
    assert math.log(amplitudes[80] / amplitudes[40]) / 0.02 == pytest.approx(belt.growth_rate, rel=2e-3)


def test_the_shapes_in_which_the_belt_buckles_have_the_wave_of_their_growth():
    x, w = np.polynomial.legendre.leggauss(40)
    x, w = 0.5 * (x + 1.0), 0.5 * w
    turn, wave = buckling(1)
    value, slope = np.sin(turn * x) - x * math.sin(turn), turn * np.cos(turn * x) - math.sin(turn)
    assert wave == pytest.approx(sqrt(w @ slope**2 / (w @ value**2)), rel=1e-12)
    turn, wave = buckling(3)
    value, slope = 1.0 - np.cos(turn * x), turn * np.sin(turn * x)
    assert wave == pytest.approx(sqrt(w @ slope**2 / (w @ value**2)), rel=1e-12)


# Free play


def under_slow_load(belt_class, turn, clearance, guide, length=LENGTH):
    """A belt with play at rest under a load, and how far it is from the line of the guide at most."""
    belt = belt_class(
        travel=0.793 + length,
        bow=0.0,
        guide_end=PLAY,
        guide_clearance=clearance,
        guide_length=guide,
        head_mass=1e-3,
        damping=(pi / length) ** 2 * sqrt(0.25 / 0.05),
    )
    belt.initialize(0.0)
    belt.mode_1 = 1e-4
    belt.yarn_tension = turn**2 * 0.25 / length**2
    for n in range(200):
        assert belt.step(0.3 / belt.damping * n, 0.3 / belt.damping) == 0
    from_chord = shape(belt.mode, ends(belt, length)[0], PLACES)
    return belt, np.abs(from_chord - 0.5 * belt.guide_contact * clearance * PLACES).max()


@pytest.mark.parametrize("guide", [0.025, 0.1])
@pytest.mark.parametrize("turn", [3.3, 3.8, 4.2])
def test_a_slow_load_bends_a_belt_with_play_as_statics_say(belt_in_c, turn, guide):
    belt, found = under_slow_load(belt_in_c, turn, 0.03e-3, guide)
    assert abs(belt.guide_contact) == 1
    # Euler's load of the clamped belt is 1.3e-5 off, and the deflection in relation to what is left of it
    within = 2e-5 / (1.0 - (turn / CLAMPED) ** 2)
    assert found == pytest.approx(deflection(turn, 0.03e-3, guide, LENGTH), rel=within)
    # the moment by which the guide keeps the belt on its slope, from the equation of statics at the guide
    expected = 0.25 * deflection_bend(turn, 0.03e-3, guide)
    assert abs(belt.guide_moment) == pytest.approx(expected, rel=5.0 * within)


def deflection_bend(turn, clearance, guide):
    """Curvature at the guide in the solution of `deflection`."""
    a = (0.5 * clearance + clearance / guide * LENGTH) / (math.sin(turn) - turn * math.cos(turn))
    return abs(a * (turn / LENGTH) ** 2 * math.sin(turn))


def test_below_the_load_of_pinned_ends_a_straight_belt_stays_straight_within_its_play(belt_in_c):
    belt, found = under_slow_load(belt_in_c, 2.0, 0.3e-3, 0.05)
    assert belt.guide_contact == 0
    assert found < 1e-8


def test_a_belt_that_never_leans_on_its_guide_is_a_pinned_one(belt_in_c):
    pinned = Loom(belt_in_c, 682.0, steps=360, start=96.0, bow_of=SPAN, length_factor=1.0)
    loose = Loom(belt_in_c, 682.0, steps=360, start=96.0, bow_of=SPAN, guide_end=PLAY, guide_clearance=0.04)
    for loom in (pinned, loose):
        loom.turn_to(110.0)
    assert loose.belt.guide_contact == 0
    for name in ("mode", "mode_rate", "deflection", "largest_deflection", "energy", "guide_work"):
        assert getattr(pinned.belt, name) == getattr(loose.belt, name), name


def elastica(clamped, ratio):
    """Deflection of a straight belt of length 1 under a load beyond Euler's, by its exact curve.

    With both ends clamped it is four quarters of the pinned one; with one it is integrated.
    """
    if clamped == "guide, head":
        square = brentq(lambda square: (2.0 * ellipk(square) / pi) ** 2 - ratio, 1e-9, 0.9)
        return 2.0 * sqrt(square / ratio) / pi
    load, x = ratio * CLAMPED**2, np.linspace(0.0, 1.0, 201)
    guess = (
        0.4
        * sqrt(ratio - 1.0)
        * np.array(
            [
                CLAMPED * np.cos(CLAMPED * x) - np.sin(CLAMPED),
                -(CLAMPED**2) * np.sin(CLAMPED * x),
                np.sin(CLAMPED * x) - x * np.sin(CLAMPED),
            ]
        )
    )

    def bent(_x, y, force):
        return [y[1], force * np.cos(y[0]) - load * np.sin(y[0]), np.sin(y[0])]

    solved = solve_bvp(
        bent,
        lambda head, guide, _force: [head[2], head[1], guide[0], guide[2]],
        x,
        guess,
        [load * 0.4 * sqrt(ratio - 1.0) * -np.sin(CLAMPED)],
        tol=1e-8,
        max_nodes=50_000,
    )
    assert solved.success
    return np.abs(solved.sol(np.linspace(0.0, 1.0, 4001))[2]).max()


@pytest.mark.parametrize(
    ("given", "clamped", "within"),
    [  # what the error of Euler's load leaves at 1 % beyond it, and of both ends what six modes leave
        (NO_CLEARANCE, "guide", 1.5e-3),
        ({"head_end": GUIDED}, "head", 1.5e-3),
        ({**NO_CLEARANCE, "head_end": GUIDED}, "guide, head", 1.7e-2),
    ],
)
@pytest.mark.parametrize("ratio", [1.01, 1.03])
def test_a_slow_load_beyond_euler_bends_a_clamped_belt_as_the_elastica(
    belt_in_c, given, clamped, within, ratio
):
    belt = belt_in_c(**given, bow=1e-6, bow_of=SPAN, damping=300.0, head_mass=1e-6)
    belt.travel = belt.idle_travel + belt.head_length + LENGTH
    belt.initialize(0.0)
    turn = 2.0 * pi if clamped == "guide, head" else CLAMPED
    belt.yarn_tension = ratio * (turn / LENGTH) ** 2 * belt.given().stiffness
    belt.initialize(0.0)
    for _ in range(4000):
        belt.step(0.0, 1.5e-3)
    assert belt.followed
    assert belt.deflection == pytest.approx(LENGTH * elastica(clamped, ratio), rel=within)


def test_a_slow_load_throws_a_crooked_belt_from_one_side_of_its_guide_to_the_other(belt_in_c):
    """Leaving one side, its end comes and goes for a while: it was given up there, with NaN in its stages."""
    belt = belt_in_c(
        guide_end=PLAY, head_end=GUIDED, guide_clearance=1e-4, damping=75.0, bow=2e-4, bow_length=0.23
    )
    belt.travel = belt.idle_travel + belt.head_length + 0.35
    belt.initialize(0.0)
    sides = []
    for n in range(2000):
        belt.yarn_tension = 72.5 * (n + 1) / 2000
        belt.step(1e-3 * n, 1e-3)
        sides.append(belt.guide_contact)
    assert belt.followed
    assert (sides[1600], sides[-1]) == (1, -1)
    assert abs(belt.energy_residual) < 1e-8 * belt.energy_through


def test_a_belt_that_is_given_up_leaves_no_value_that_is_not_finite(belt_in_c):
    belt = belt_in_c(guide_end=PLAY, head_end=GUIDED)
    belt.gauss = [math.nan, math.inf] * 9
    belt.lose()
    assert belt.gauss == (0.0,) * 18


def test_a_guide_shorter_than_its_clearance_is_refused():
    belt = BeltDynamics(guide_end=PLAY, guide_clearance=0.05, guide_length=0.05)
    assert "must be less than guide_length" in belt.problems[belt.initialize(0.0) - 1].text
    assert BeltDynamics(guide_clearance=0.05, guide_length=0.05).initialize(0.0) == 0


def test_little_clearance_is_close_to_none(belt_in_c):
    found = []
    for clearance in (0.0, 1e-7, 1e-6):
        loom = Loom(belt_in_c, 682.0, steps=360, guide_end=PLAY, guide_clearance=clearance)
        loom.turn_to(110.0)
        found.append(loom.belt.largest_deflection)
    # the deflection of 0.2 mm changes by as much as the play lets the belt turn: 110 times the clearance
    assert found[1] == pytest.approx(found[0], rel=1e-2)
    assert abs(found[2] - found[0]) > 5.0 * abs(found[1] - found[0])


# On a loom


@pytest.mark.parametrize("bow_of", [BELT, SPAN])
@pytest.mark.parametrize("given", [{}, {"damping": 20.0}, *EVERY_END])
def test_the_energy_is_balanced_over_both_strokes_with_each_end(belt_in_c, given, bow_of):
    loom = Loom(belt_in_c, 600.0, steps=720, bow_of=bow_of, **given)
    books = []
    for degrees in (105.0, 115.0):
        loom.turn_to(degrees)
        works = loom.belt.push_work + loom.belt.guide_work - loom.belt.lost_work
        books.append(loom.belt.energy - works)
    assert books[1] == pytest.approx(books[0], abs=1e-8 * loom.belt.energy_through)
    assert loom.turn_to(290.0) <= {0, 1, 3}  # a bow of the span folds on its way into a calibrated guide
    belt = loom.belt
    assert belt.energy_through > 1e-2
    assert abs(belt.energy_residual) <= 1e-8 * belt.energy_through
    assert (belt.lost_work > 0.0) == ("damping" in given)
    assert belt.free_length < 0.0
    assert (belt.deflection, belt.energy, belt.mode_1) == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("given", EVERY_END)
def test_live_and_native_belts_lean_on_their_guide_with_equal_bits(belt_in_c, given):
    live, native = (
        Loom(each, 682.0, steps=180, start=97.0, bow_of=SPAN, **given) for each in (BeltDynamics, belt_in_c)
    )
    for loom in (live, native):
        loom.turn_to(101.0)
    for variable in variables_of(BeltDynamics):
        assert getattr(live.belt, variable.name) == getattr(native.belt, variable.name), variable.name
    assert (live.belt.guide_contact != 0) == ("guide_end" in given)


@pytest.mark.parametrize("bow_of", [BELT, SPAN])
@pytest.mark.parametrize("given", [{}, *EVERY_END])
def test_deflections_with_each_end_do_not_depend_on_the_steps(belt_in_c, given, bow_of):
    coarse, fine = (Loom(belt_in_c, 682.0, steps=steps, bow_of=bow_of, **given) for steps in (360, 2880))
    for loom in (coarse, fine):
        loom.turn_to(106.0)
    # contact is located within 1e-6 of the modes; samples joined by quintics
    assert coarse.belt.largest_at_risk == pytest.approx(fine.belt.largest_at_risk, rel=3e-5)
    assert coarse.belt.largest_deflection == pytest.approx(fine.belt.largest_deflection, rel=3e-5)


def test_a_belt_in_motion_has_the_clearance_of_the_guide_of_its_loom(tmp_path):
    changes = {"belt_motion.guide_end": "play", "steps_per_revolution": 360}
    wide, narrow = (
        run(
            "sims/belt_motion.toml",
            output=tmp_path / f"{n}.h5",
            set={**changes, "belt.guide_clearance": f"{clearance} mm"},
        ).claims[1]
        for n, clearance in enumerate((0.3, 0.1))
    )
    assert narrow.worst < 0.8 * wide.worst
    assert narrow.holds


def end_shapes():
    """Weights and places of a quadrature, slopes and curvatures of the end shapes at guide and head there."""
    nodes, weights = np.polynomial.legendre.leggauss(60)
    x, sines = 0.5 * (nodes + 1.0), np.arange(1, 7)
    parts = 12.0 * (-1.0) ** sines / (pi * sines) ** 3

    def at(x):
        slope = 3.0 * x**2 - 1.0 - np.cos(np.outer(x, sines) * pi) @ (parts * pi * sines)
        return slope, 6.0 * x + np.sin(np.outer(x, sines) * pi) @ (parts * (pi * sines) ** 2)

    (guide, guide_bend), (head, head_bend) = at(x), at(1.0 - x)
    return 0.5 * weights, x, (guide, -head), (guide_bend, head_bend)


def test_the_end_shapes_act_on_the_modes_as_their_integrals_say():
    w, x, (guide, head), _bends = end_shapes()
    for forces, slope in ((end_forces, guide), (head_forces, head)):
        for given in np.eye(3):
            drifting, pushed, thrown = given
            for number, force in zip(range(1, 7), forces(*given), strict=True):
                tilted = number * pi * np.cos(number * pi * x)
                along = drifting * x * np.sin(number * pi * x) + (pushed * x + thrown * x**2) * tilted
                assert force == pytest.approx(w @ (slope * along), abs=1e-14)  # digits of the constants
    for power, square, cross in (
        (0, SQUARE, CROSS),
        (1, SQUARE_ALONG, CROSS_ALONG),
        (2, SQUARE_TWICE, CROSS_TWICE),
    ):
        assert square == pytest.approx(w @ (x**power * guide**2), rel=1e-11)
        assert cross == pytest.approx(w @ (x**power * guide * head), rel=1e-11)


@pytest.mark.parametrize("length", [0.05, 0.17, 0.31])
def test_the_end_shapes_of_an_unloaded_belt_have_the_least_bending_energy(length):
    w, x, _slopes, bends = end_shapes()
    # curvature of the unloaded belt, over x
    bow = -((pi / 0.2 * length) ** 2) * np.sin(pi / 0.2 * length * x)

    def amplitudes(length):
        return np.array(astuple(end_amplitudes(Bow(BELT, 1.0, 0.2), length, True)))

    energies = np.array([[w @ (one * other) for one in bends] for other in bends])
    expected = np.linalg.solve(energies, [w @ (bow * bend) for bend in bends])
    assert amplitudes(length)[:2] == pytest.approx(expected, rel=1e-9, abs=1e-9 * abs(expected[0]))
    rates = (amplitudes(length + 1e-6) - amplitudes(length - 1e-6))[:4] / 2e-6
    # of differences
    assert amplitudes(length)[2:] == pytest.approx(rates, rel=1e-6, abs=1e-6 * abs(rates[0]))


def test_amplitudes_of_the_end_shapes_turn_clamped_ends_alone():
    for clamped in range(4):
        guide, head = turned_by(clamped, 1.0, 2.0)
        assert (guide != 0.0) == (clamped in (1, 3))
        assert (head != 0.0) == (clamped in (2, 3))


def against_finite_elements(belt_class, bow_of, elements, **given):
    """Deflections from 96 to 106 deg, and those of finite elements in space from the same start."""
    loom = Loom(belt_class, 682.0, start=96.0, bow_of=bow_of, **given)
    belt, rates, bow, half = loom.belt, loom.belt.mode_rate, loom.belt.bow, loom.belt.bow_length

    def now():
        length, speed, _acceleration = loom.motion(loom.time)
        return belt.mode, *ends(belt, length, speed)

    modes, end, end_rate = now()
    times, found, contacts = [loom.time], [shape(modes, end)], {belt.guide_contact}
    for degrees in np.arange(97.0, 107.0):
        loom.turn_to(degrees)
        times.append(loom.time)
        found.append(shape(*now()[:2]))
        contacts.add(belt.guide_contact)

    def curvature(x, length):
        if bow_of == SPAN:
            return -bow * (pi / length) ** 2 * np.sin(pi * x / length)
        return -bow * (pi / half) ** 2 * np.sin(pi * (length - x) / half)

    reference = FiniteElements(
        loom.motion,
        curvature,
        stiffness=belt.given().stiffness,
        elements=elements,
        guided=belt.head_end == GUIDED,
        clearance=belt.guide_clearance if belt.guide_end == PLAY else None,
        guide=belt.guide_length,
        gravity=belt.gravity,
        offset=belt.guide_offset,
    )
    rtol = 1e-6 if elements < 10 else 1e-7
    expected = reference.run(
        lambda x: shape(modes, end, 1.0 - x),
        lambda x: shape(rates, end_rate, 1.0 - x),
        times,
        rtol,
        1e-4 * rtol,
    )
    return np.array(found).T, expected, contacts


LITTLE_PLAY = {"guide_end": PLAY, "guide_clearance": 0.1e-3}
OFF = {"guide_end": PLAY, "guide_offset": 0.15e-3}


@pytest.mark.few(1)
@pytest.mark.no_cover
@pytest.mark.parametrize(
    ("bow_of", "given", "elements", "everywhere", "farthest"),
    [  # six elements are off by 2e-3, ten by 5e-4; stopped by the guide, they lose some of their motion
        (SPAN, {}, 6, 1e-3, 5e-4),
        (BELT, {}, 6, 1e-3, 5e-4),
        (BELT, {"gravity": -60.0}, 6, 1e-3, 5e-4),
        # ten elements show that the farthest deflection is known to 1e-4
        pytest.param(SPAN, {}, 10, 2.5e-4, 1e-4, marks=pytest.mark.slow),
        pytest.param(BELT, {}, 10, 2.5e-4, 1e-4, marks=pytest.mark.slow),
        (BELT, LITTLE_PLAY, 6, 3e-3, 1e-3),
        (BELT, {"head_end": GUIDED}, 6, 1.2e-3, 1e-3),
        (SPAN, {"guide_end": PLAY, "head_end": GUIDED}, 6, 2.5e-3, 1.5e-3),
        (BELT, {"guide_offset": 0.15e-3}, 6, 1.2e-3, 1e-3),
        pytest.param(BELT, {"guide_offset": -0.15e-3}, 10, 4e-4, 2e-4, marks=pytest.mark.slow),
        pytest.param(SPAN, OFF, 10, 8e-3, 8e-3, marks=pytest.mark.slow),
        pytest.param(BELT, {"head_end": GUIDED, "gravity": 60.0}, 10, 4e-4, 2e-4, marks=pytest.mark.slow),
        pytest.param(BELT, LITTLE_PLAY, 10, 2e-3, 1e-3, marks=pytest.mark.slow),
        pytest.param(BELT, {"head_end": GUIDED}, 10, 4e-4, 2e-4, marks=pytest.mark.slow),
        pytest.param(SPAN, {"head_end": GUIDED}, 10, 6e-4, 2e-4, marks=pytest.mark.slow),
        pytest.param(SPAN, NO_CLEARANCE, 10, 6e-4, 4e-4, marks=pytest.mark.slow),
        pytest.param(SPAN, {"guide_end": PLAY, "head_end": GUIDED}, 10, 7e-4, 4e-4, marks=pytest.mark.slow),
        pytest.param(SPAN, {"guide_end": PLAY}, 10, 7e-3, 7e-3, marks=pytest.mark.slow),
    ],
)
def test_against_finite_elements_with_each_end(belt_in_c, bow_of, given, elements, everywhere, farthest):
    found, expected, contacts = against_finite_elements(belt_in_c, bow_of, elements, **given)
    assert np.abs(found - expected).max() <= everywhere * np.abs(expected).max()
    assert np.abs(found).max(axis=0) == pytest.approx(np.abs(expected).max(axis=0), rel=farthest)
    assert np.abs(expected).max() > 5.0 * np.abs(found[:, 0]).max()  # far from rest
    assert (len(contacts) > 1) == (given.get("guide_clearance", 1.0) > 0.0 and "guide_end" in given)
