"""BeltDynamics under its weight and on a race board: closed forms, elements with one-sided stops."""

import math
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from belt_board_reference import MovingOnBoard, on_board
from belt_loom import Loom, X, ends, shape
from belt_pushed_reference import PushedBelt
from belt_reference import FiniteElements
from scipy.optimize import brentq

from loomfmu import judge, run
from loomfmu.components.belt_dynamics import BeltDynamics
from loomfmu.declaring.variables import variables_of

PLAY, GUIDED = 2, 2
OWN, SPAN = 1, 2
BOW_SIDE, OTHER_SIDE = 2, 3
EARTH = 9.80665
GRAVITY = 0.01  # so little that slopes are small
# What the belt is given, its stiffness, whether guide and head are clamped, how well six modes give its sag:
# sines of its odd ones fall with the fifth power of their number; with both ends clamped six are few
ENDS = [
    ({}, 0.25 / 0.64, False, False, 6e-5),
    ({"guide_end": PLAY, "guide_clearance": 0.0}, 0.25, True, False, 6e-5),
    ({"head_end": GUIDED}, 0.25 / 0.64, False, True, 6e-5),
    ({"guide_end": PLAY, "guide_clearance": 0.0, "head_end": GUIDED}, 0.25, True, True, 2e-4),
]


def sag(weight, stiffness, load, length, guide_clamped, head_clamped):
    """Deflection of a beam-column under its weight at places from the head: B u_xxxx + P u_xx = weight.

    u = a + b x + c cos k x + d sin k x + weight x^2 / (2 P), by its ends.
    """
    k, end = sqrt(load / stiffness), length
    at_head = [0.0, 1.0, 0.0, k] if head_clamped else [0.0, 0.0, -k * k, 0.0]
    at_guide = (
        [0.0, 1.0, -k * sin(k * end), k * cos(k * end)]
        if guide_clamped
        else [0.0, 0.0, -k * k * cos(k * end), -k * k * sin(k * end)]
    )
    rows = [[1.0, 0.0, 1.0, 0.0], at_head, [1.0, end, cos(k * end), sin(k * end)], at_guide]
    share = weight / load
    known = [
        0.0,
        0.0 if head_clamped else -share,
        -0.5 * share * end**2,
        -share * end if guide_clamped else -share,
    ]
    a, b, c, d = np.linalg.solve(rows, known)
    x = X * length
    return a + b * x + c * np.cos(k * x) + d * np.sin(k * x) + 0.5 * share * x**2


@pytest.mark.parametrize(("ends", "stiffness", "guide", "head", "within"), ENDS)
@pytest.mark.parametrize("length", [0.1737, 0.5])
@pytest.mark.parametrize("share", [0.01, 0.5, 0.79])
def test_a_belt_sags_under_its_weight_as_a_beam_column(ends, stiffness, guide, head, within, length, share):
    load = share * stiffness * (pi / length) ** 2
    belt = BeltDynamics(gravity=GRAVITY, bow=0.0, **ends)
    belt.travel, belt.yarn_tension = belt.idle_travel + belt.head_length + length, load
    assert belt.initialize(0.0) == 0
    expected = sag(belt.belt_mass * GRAVITY, stiffness, load, length, guide, head)
    assert belt.deflection == pytest.approx(np.abs(expected).max(), rel=within)
    place = length * (1.0 - X[np.abs(expected).argmax()])
    assert belt.deflection_place == pytest.approx(place, abs=0.005 * length)  # of 201 places


def curvature(bow, bow_of):
    """Of an unloaded belt, from the guide; half waves of 0.2 m from the head."""
    if bow_of == SPAN:
        return lambda x, length: -bow * (pi / length) ** 2 * np.sin(pi * x / length)
    return lambda x, length: -bow * (pi / 0.2) ** 2 * np.sin(pi * (length - x) / 0.2)


def drawn(number, stiffness):
    """A random belt at rest on a board: its deflection, that on a rigid board, the nodes that touch it."""
    draw = np.random.default_rng(number)
    length, bow, gravity = draw.uniform(0.05, 0.8), draw.uniform(0.0, 0.5e-3), draw.uniform(-10.0, 10.0)
    bow_of, board = int(draw.integers(1, 3)), int(draw.integers(BOW_SIDE, OTHER_SIDE + 1))
    given, bending, guide, head, _within = ENDS[draw.integers(4)]
    side = 1.0 if board == BOW_SIDE else -1.0
    distance = draw.choice([0.0, draw.uniform(0.0, 1e-3)])
    offset = 0.0 if guide else -side * draw.uniform(0.0, 0.15e-3)
    compression = draw.uniform(0.0, 0.79) * bending * (pi / length) ** 2
    belt = BeltDynamics(
        bow=bow,
        bow_of=bow_of,
        gravity=gravity,
        guide_offset=offset,
        board=board,
        board_distance=distance,
        board_stiffness=stiffness,
        **given,
    )
    belt.travel, belt.yarn_tension = belt.idle_travel + belt.head_length + length, compression
    assert belt.initialize(0.0) == 0
    elements = FiniteElements(
        lambda _t: (length, 0.0, 0.0),
        curvature(bow, bow_of),
        stiffness=bending,
        elements=40,
        guided=head,
        gravity=gravity,
        offset=offset,
    )
    return belt.deflection, *on_board(elements, length, compression, side, distance, int(guide))


@pytest.mark.few(8)
@pytest.mark.parametrize("number", range(100))
def test_a_belt_at_rest_on_a_board_lies_as_on_rigid_stops(number):
    found, expected, touching = drawn(number, 1e7)
    if touching == 0:  # slopes of 3 % change a bow by their square, ten times as much near Euler's load
        assert found == pytest.approx(expected, rel=2e-2)
    # the cover gives way by a few micrometres; half waves of a sixth of the belt bend no more sharply
    assert found == pytest.approx(expected, rel=9e-2, abs=25e-6)


@pytest.mark.slow
def test_the_stiffer_the_cover_the_nearer_is_the_board_to_rigid_stops():
    off = []
    for stiffness in (1e6, 1e7, 1e8):
        cases = [drawn(number, stiffness) for number in range(40)]
        off.append(np.mean([abs(found - expected) for found, expected, touching in cases if touching]))
    assert off[0] > 1.5 * off[1]
    assert off[1] > off[2]  # what six modes and 24 places leave remains


def on_its_board(belt_class, share=0.8, steps=1440, start=85.0, machine="WL450-4600", **given):
    """The belt of a machine at a share of its static limit, its bow down, lying on the board."""
    speed = {"WL680-3600": 681.8, "WL450-4600": 212.6}[machine]
    return Loom(
        belt_class,
        share * speed,
        steps,
        start,
        machine,
        **{"gravity": EARTH, "board": BOW_SIDE, **given},
    )


@pytest.mark.slow
@pytest.mark.no_cover
@pytest.mark.parametrize("distance", [0.0, 0.3e-3])
def test_a_belt_in_motion_on_a_board_against_finite_elements(belt_in_c, distance):
    loom = on_its_board(belt_in_c, start=88.0, board_distance=distance)
    belt, rates = loom.belt, loom.belt.mode_rate
    length, speed, _acceleration = loom.motion(loom.time)
    modes, (end, end_rate) = belt.mode, ends(belt, length, speed)
    times, found = [loom.time], [belt.deflection]
    for degrees in range(90, 106, 2):
        loom.turn_to(degrees)
        times.append(loom.time)
        found.append(belt.deflection)
    assert belt.largest_known
    elements = MovingOnBoard(
        loom.motion,
        curvature(belt.bow, OWN),
        stiffness=belt.given().stiffness,
        elements=8,
        gravity=EARTH,
        distance=distance,
        cover=belt.board_stiffness,
    )
    expected = elements.run(
        lambda x: shape(modes, end, 1.0 - x),
        lambda x: shape(rates, end_rate, 1.0 - x),
        times,
        1e-6,
        1e-10,
    )
    # fourteen elements find what eight find to 3e-3; six modes and 24 places do not bounce quite alike
    assert found[-1] == pytest.approx(np.abs(expected[:, -1]).max(), rel=2.5e-2)
    assert max(found) > 0.5e-3


LIMITS = {"WL680-3600": 681.8, "WL800-3600": 553.3, "WL450-4600": 212.6, "WL450-5400": 137.5}  # rev/min


def pushed(belt_class, number):
    """A random belt on its board, at the end of its push, and the reference's on a cover of a stiffness."""
    draw = np.random.default_rng(number)
    machine, share = draw.choice(list(LIMITS)), draw.uniform(0.6, 1.2)
    bow, bow_of = draw.uniform(0.05e-3, 0.5e-3), int(draw.integers(OWN, SPAN + 1))
    board = int(draw.integers(BOW_SIDE, OTHER_SIDE + 1))
    side, distance = 1.0 if board == BOW_SIDE else -1.0, draw.choice([0.0, draw.uniform(0.0, 0.6e-3)])
    given = {
        "bow": bow,
        "bow_of": bow_of,
        "board": board,
        "board_distance": distance,
        "gravity": side * EARTH,
    }
    loom = Loom(belt_class, share * LIMITS[machine], 1440, 60.0, machine=machine, **given)
    belt, motion, start = loom.belt, loom.motion, None
    while not belt.released:
        start = loom.time if not belt.outside else start
        loom.turn_to(math.degrees(loom.time * loom.weft.speed) + 0.25)
    start = brentq(lambda time: motion(time)[0] - belt.shortest_length, start, loom.time, xtol=1e-12)
    unloaded = curvature(bow, bow_of)

    def expected(cover):
        reference = PushedBelt(
            motion,
            lambda x, length: unloaded(length - x, length),
            belt.belt_mass,
            belt.head_mass,
            belt.given().stiffness,
            belt.gravity,
            side,
            distance,
            cover,
        )
        times, found = reference.run(start, loom.time, 1e-5)
        lengths, _speeds, accelerations = np.array([motion(time) for time in times]).T
        at_risk = (belt.head_mass + 0.5 * belt.belt_mass * lengths) * accelerations > 0.0
        return np.abs(found[at_risk & ((lengths <= 1.0) | (bow_of == SPAN))]).max()

    return belt, expected


@pytest.mark.slow
@pytest.mark.no_cover
@pytest.mark.parametrize("number", range(30))
def test_random_belts_are_pushed_along_their_boards_as_another_integration_says(belt_in_c, number):
    belt, expected = pushed(belt_in_c, number)
    # of 39, to 6e-3 in the mean: slopes of some percent, six modes and 24 places do not bounce quite alike
    assert belt.largest_at_risk == pytest.approx(expected(belt.board_stiffness), rel=3e-2)
    flat = belt.bow_of == SPAN and belt.board == BOW_SIDE and belt.board_distance < belt.bow
    if not flat:  # a rigid board presses this bow flat, a cover only where the belt is long
        assert belt.largest_at_risk == pytest.approx(expected(0.0), rel=5e-2, abs=60e-6)


@pytest.mark.parametrize("distance", [0.0, 0.3e-3])
def test_deflections_on_a_board_hardly_depend_on_the_steps(belt_in_c, distance):
    coarse, fine = (on_its_board(belt_in_c, steps=steps, board_distance=distance) for steps in (360, 2880))
    for loom in (coarse, fine):
        loom.turn_to(110.0)
        assert loom.belt.followed
    # where places begin and cease to touch lies anywhere in an integration step
    assert coarse.belt.largest_at_risk == pytest.approx(fine.belt.largest_at_risk, rel=2e-3)


def test_a_belt_on_a_board_translates_to_the_same_bits(belt_in_c):
    live, native = (on_its_board(each, 1.0, 180, 92.0, "WL680-3600") for each in (BeltDynamics, belt_in_c))
    for loom in (live, native):
        loom.turn_to(108.0)
        assert not loom.belt.largest_known
    for variable in variables_of(BeltDynamics):
        assert getattr(live.belt, variable.name) == getattr(native.belt, variable.name)


def test_a_board_too_far_away_to_be_touched_changes_nothing_under_the_push(belt_in_c):
    free, above = (Loom(belt_in_c, 600.0, **given) for given in ({}, {"board": 2, "board_distance": 0.5}))
    for loom in (free, above):
        loom.turn_to(101.0)
    # its steps need not be balanced so well
    assert above.belt.deflection == pytest.approx(free.belt.deflection, rel=1e-6)


def test_a_belt_is_let_go_after_its_push_until_it_is_back_in_its_guide(belt_in_c):
    usual, pushed = (Loom(belt_in_c, 600.0, only_push=alone) for alone in (False, True))
    for loom in (usual, pushed):
        loom.turn_to(100.0)
    assert pushed.belt.deflection == usual.belt.deflection
    for loom in (usual, pushed):
        assert loom.turn_to(150.0) == {0}
    belt = pushed.belt
    assert (belt.largest_known, belt.deflection_known, belt.deflection) == (False, False, 0.0)
    assert belt.largest_deflection == belt.largest_at_risk == usual.belt.largest_at_risk
    assert usual.belt.largest_deflection > 1.5 * belt.largest_deflection
    pushed.turn_to(300.0)
    assert belt.deflection_known and not belt.outside
    pushed.turn_to(360.0 + 100.0)
    assert belt.deflection_known and belt.deflection > 0.0


def test_a_guide_that_ends_beyond_the_board_is_refused():
    assert BeltDynamics(board=OTHER_SIDE, guide_offset=-1e-4).initialize(0.0) == 4
    assert BeltDynamics(board=BOW_SIDE, guide_offset=-1e-4).initialize(0.0) == 0


def test_what_a_belt_does_after_its_push_on_a_board_is_undecided(tmp_path):
    changes = {"belt_motion.board": "other", "belt_motion.gravity": -EARTH}
    changes |= {"steps_per_revolution": 360, "revolutions": 1}
    result = run("sims/belt_motion.toml", output=tmp_path / "run.h5", set=changes)
    assert not result.claims[1].decided
    assert "belt_motion.largest_known is false" in result.claims[1].note
    assert judge(result.trace, kind="below", signal="belt_motion.largest_at_risk", bound=1e-3).holds
