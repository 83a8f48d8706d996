"""BeltMonitor: published safe speeds, the continuous curve between samples, and every way to begin."""

import itertools
from math import inf, isfinite, pi, sqrt

import pytest
from driving import values
from looms import RPM, Loom
from reference import ALL_MACHINES, machine
from scipy.optimize import minimize_scalar

from loomfmu.components import BeltMonitor
from loomfmu.physics.belt import NO_LIMIT, REST, critical_force, elastica_deflection, length_factor

STROKES = {"insertion": 0.0, "return": 0.5}  # turn at which each begins
every_stroke = pytest.mark.parametrize("begin", STROKES.values(), ids=STROKES)


# Accuracy


@pytest.mark.few(4)
@every_stroke
@pytest.mark.parametrize("name", ALL_MACHINES)
def test_lowest_values_are_those_of_the_continuous_curve(name, begin):
    safe = float(machine(name).safe_speed(machine(name).worst_angle(), 0.8)) / RPM
    loom = Loom(name, begin=begin, steps=1440, prescribe_length_factor=True, prescribed_length_factor=0.8)
    belt = loom.turn(0.5)
    # the component sees samples only: a quarter of a degree apart, joined by quintics whose second
    # derivative carries 60 roundings of the travel over the step's square, 1e-16 * 60 / (4e-3)^2 = 4e-10
    # of a second derivative of 0.5 m
    assert belt.lowest_speed_limit / RPM == pytest.approx(safe, rel=1e-8)
    load = (600.0 / safe) ** 2  # of the critical load; the worst angle does not depend on the speed
    assert belt.lowest_margin == pytest.approx(1.0 - load, abs=1e-8 * load)


def test_outputs_at_a_sample_are_the_formulas():
    loom = Loom("WL680-3600", steps=720)
    belt = loom.turn(200 / 720)  # 100 degrees: in the window
    assert belt.at_risk
    force = 0.1105 * belt.acceleration
    critical = pi**2 * 0.25 / (0.8 * belt.free_length) ** 2
    # a few roundings each
    assert belt.free_length == pytest.approx(belt.travel - 0.793, abs=1e-15)
    assert belt.inertia_force == belt.axial_force == pytest.approx(force, rel=1e-15)
    assert belt.critical_force == pytest.approx(critical, rel=1e-15)
    assert belt.margin == pytest.approx(1.0 - force / critical, abs=1e-15)
    assert belt.speed_limit == pytest.approx(600.0 * RPM * sqrt(critical / force), rel=1e-14)


# The way of the head


@pytest.mark.parametrize(("rpm", "buckled"), [(600.0, False), (681.0, False), (682.5, True), (700.0, True)])
@every_stroke
def test_buckled_above_the_safe_speed_and_for_good(rpm, buckled, begin):
    loom = Loom(rpm=rpm, begin=begin)
    seen = []
    loom.turn(1.0, lambda belt: seen.append(belt.buckled))
    assert seen[-1] is buckled
    assert seen == sorted(seen), "once buckled, buckled for good"
    assert (loom.belt.lowest_margin < 0.0) is buckled
    loom.weft.initialize(0.0)
    loom.wire()
    loom.belt.initialize(0.0)
    assert not loom.belt.buckled


@pytest.mark.parametrize("rpm", [600.0, -600.0])
def test_both_windows_are_seen(rpm):
    loom = Loom(rpm=rpm)
    angles = []
    start = abs(loom.step_size * loom.belt.speed)
    loom.turn(1.0, lambda belt: angles.append(loom.done * start) if belt.at_risk else None)
    degrees = [round(angle * 180 / pi, 1) for angle in angles]
    insertion = [angle for angle in degrees if angle < 180]
    back = [angle for angle in degrees if angle > 180]
    # 92.53 to 103.91 degrees and its mirror, in steps of half a degree
    assert (insertion[0], insertion[-1]) == (93.0, 103.5)
    assert (back[0], back[-1]) == (256.5, 267.0)


def test_turning_backwards_finds_the_same():
    forwards, backwards = (Loom(rpm=rpm, steps=360).turn(1.0) for rpm in (600.0, -600.0))
    # the same curve from the other side: the accuracy of the joined samples
    assert backwards.lowest_margin == pytest.approx(forwards.lowest_margin, abs=1e-8)
    assert backwards.lowest_speed_limit == pytest.approx(forwards.lowest_speed_limit, rel=1e-8)


@pytest.mark.parametrize("begin", [0.0, 95 / 360, 100 / 360, 180 / 360, 260 / 360, 262 / 360, 3.0 + 95 / 360])
def test_a_whole_turn_from_anywhere_finds_the_same(begin):
    # also from the middle of a window, which then wraps round the end of the turn
    belt = Loom(begin=begin, steps=720).turn(1.0)
    whole = Loom(steps=720).turn(1.0)
    # times of some seconds are rounded to 1e-16 of themselves; the accuracy of the joined samples is 1e-8
    assert belt.lowest_margin == pytest.approx(whole.lowest_margin, abs=2e-8)
    assert belt.lowest_speed_limit == pytest.approx(whole.lowest_speed_limit, rel=2e-8)


def test_first_sample_in_a_window_counts_at_once():
    loom = Loom(begin=100 / 360, rpm=700.0, steps=720)
    assert loom.belt.lowest_margin == pytest.approx(loom.belt.margin, abs=1e-15)  # the same formula
    assert loom.belt.margin < 0.0
    assert loom.belt.buckled
    assert loom.belt.deflection == elastica_deflection(1.0 - loom.belt.margin, loom.belt.free_length)


def test_a_wrapped_shaft_angle_only_costs_the_joining():
    # a tool that hands over the angle within one turn: the step across the jump counts by its samples
    def followed(wrap_at: float) -> BeltMonitor:
        loom = Loom(steps=720, follow_shaft=True)
        for _ in range(720):
            loom.weft.step(loom.time, loom.step_size)
            loom.wire()
            angle = loom.belt.speed * (loom.time + loom.step_size)
            loom.belt.shaft_velocity = loom.belt.speed
            loom.belt.shaft_angle = angle - 2.0 * pi if angle > wrap_at else angle
            assert loom.belt.step(loom.time, loom.step_size) == 0
            loom.done += 1
        return loom.belt

    whole = Loom(steps=720).turn(1.0)
    for wrap_at in (inf, 1.5 * pi, 100.3 * pi / 180):
        belt = followed(wrap_at)
        # the second window makes up for what the jump hides; the accuracy of the joined samples
        assert belt.lowest_margin == pytest.approx(whole.lowest_margin, abs=1e-8)
        assert belt.lowest_speed_limit == pytest.approx(whole.lowest_speed_limit, rel=1e-8)


@pytest.mark.parametrize("steps", [1, 2, 3, 4, 5, 6, 7])
def test_steps_above_an_eighth_of_a_turn_count_by_their_samples(steps):
    loom = Loom(rpm=700.0, steps=steps, begin=1.0)
    lowest = loom.belt.margin
    for _ in range(2 * steps):
        belt = loom.turn(1 / steps)
        lowest = min(lowest, belt.margin)
        assert belt.lowest_margin == lowest
        assert all(isfinite(value) for value in values(belt).values())


# Inputs at the start or at the end of a step


def test_inputs_at_the_start_of_a_step_agree_as_it_shrinks():
    errors = []
    for steps in (360, 720, 1440):
        ends: list[tuple[float, ...]] = []
        starts: list[tuple[float, ...]] = []
        for at_end, rows in ((True, ends), (False, starts)):
            loom = Loom(steps=steps, inputs_at_step_end=at_end)
            loom.turn(1.0, lambda b, rows=rows: rows.append((b.free_length, b.margin, b.lowest_margin)))
        pairs = list(zip(ends, starts, strict=True))
        errors.append([max(abs(end[i] - start[i]) for end, start in pairs) for i in range(3)])
    for coarse, fine in itertools.pairwise(errors):
        # carried over a step with its rates the travel is of fourth order, the acceleration and so the
        # margin of second; the lowest margin is found one sample later, of first order. Whole orders are
        # met to 15 %
        ratios = [a / b for a, b in zip(coarse, fine, strict=True)]
        assert ratios == pytest.approx([16.0, 4.0, 2.0], rel=0.15)


# Clearance, tension, standing still


def test_wear_of_the_guide():
    loom = Loom(guide_clearance=0.3e-3)
    factors = []
    for clearance in (0.0, 0.3e-3, 0.4e-3, 0.8e-3, 1.0e-3):
        loom.belt.guide_clearance = clearance
        loom.turn(1 / 720)
        assert loom.problem == 0
        assert loom.belt.length_factor == length_factor(clearance)
        factors.append(loom.belt.length_factor)
    assert factors == sorted(factors)


def test_warning_beyond_one_millimetre():
    loom = Loom(guide_clearance=1.001e-3)
    assert loom.problem == 1
    loom.turn(1 / 720)
    assert loom.problem == 1
    assert BeltMonitor.problems[0].warning
    assert loom.belt.length_factor == 1.0
    loom.belt.guide_clearance = 1e-3
    loom.turn(1 / 720)
    assert loom.problem == 0
    assert Loom(guide_clearance=2e-3, prescribe_length_factor=True).problem == 0, "the clearance is not used"


def test_tension_presses_the_belt():
    slack, tight = (Loom(rpm=500.0, yarn_tension=force).turn(200 / 720) for force in (0.0, 5.0))
    assert tight.axial_force == pytest.approx(slack.axial_force + 5.0, rel=1e-15)  # rounding
    assert tight.inertia_force == slack.inertia_force
    assert tight.margin == pytest.approx(slack.margin - 5.0 / slack.critical_force, abs=1e-14)
    assert tight.speed_limit < slack.speed_limit
    assert tight.lowest_speed_limit < slack.lowest_speed_limit


def test_tension_alone_can_buckle():
    belt = Loom(rpm=100.0, yarn_tension=1e3).turn(0.5)
    assert belt.buckled
    assert belt.lowest_speed_limit == 0.0
    pulled = Loom(rpm=700.0, yarn_tension=-1e3).turn(0.5)
    assert not pulled.buckled
    assert pulled.lowest_margin >= 1.0


@pytest.mark.parametrize("taker", [False, True])
def test_weft_loads_the_belt_only_while_the_head_carries_it(taker):
    seen = []
    Loom(rpm=500.0, yarn_tension=5.0, taker=taker).turn(
        watch=lambda belt: seen.append((belt.velocity, belt.axial_force - belt.inertia_force))
    )
    # a giver pushes the weft in and returns empty; a taker goes in empty and pulls the weft out
    moving = {
        velocity > 0.0: {round(load, 9) for v, load in seen if v * velocity > REST} for velocity in (1, -1)
    }
    assert moving == ({True: {0.0}, False: {-5.0}} if taker else {True: {5.0}, False: {0.0}})


@pytest.mark.parametrize("taker", [False, True])
def test_at_the_hand_over_the_giver_has_the_weft_whatever_rounding_leaves_of_the_velocity(taker):
    loads = set()
    for velocity in (0.0, 1e-13, -1e-13, -5e-12):
        belt = BeltMonitor(velocity=velocity, yarn_tension=5.0, taker=taker, inputs_at_step_end=True)
        belt.initialize(0.0)
        belt.step(0.0, 0.0)
        loads.add(belt.axial_force - belt.inertia_force)
    assert loads == {0.0 if taker else 5.0}


@every_stroke
@pytest.mark.parametrize("taker", [False, True])
def test_speed_limits_of_giver_and_taker_in_either_stroke(taker, begin):
    # the return mirrors the insertion in time, so each stroke's limit is (12) with that stroke's weft load
    name, tension = "WL680-3600", 10.0
    load = (0.0, -tension)[begin > 0.0] if taker else (tension, 0.0)[begin > 0.0]
    of = machine(name)
    found = minimize_scalar(
        lambda angle: float(of.safe_speed(angle, 0.8, tension=load)),
        bounds=(float(of.free_start()) + 1e-3, float(of.push_end()) - 1e-3),
        method="bounded",
    )
    limit = found.fun
    belt = Loom(
        name, rpm=100.0, begin=begin, taker=taker, yarn_tension=tension, prescribe_length_factor=True
    ).turn(0.5)
    # the quintic of steps of half a degree, as in the table of steps above
    assert belt.lowest_speed_limit == pytest.approx(limit, rel=1e-8)


def test_the_load_changes_where_the_head_turns_within_a_step():
    # s = 1 + 2 u - 4 u^2 over a step of 0.1 s: the head turns at u = 1/4, where it is 0.25 m further in
    belt = BeltMonitor(
        travel=1.0,
        velocity=20.0,
        acceleration=-800.0,
        head_mass=1e-6,
        yarn_tension=1.0,
        inputs_at_step_end=True,
        speed=0.1,
        prescribe_length_factor=True,
    )
    belt.initialize(0.0)
    belt.travel, belt.velocity = -1.0, -60.0
    belt.step(0.0, 0.1)
    deepest = 1.25 - belt.idle_travel - belt.head_length
    expected = 1.0 - (1.0 - 8e-4) * (0.8 * deepest) ** 2 / (pi * pi * 0.25)
    # the place of a jump, by 40 golden sections
    assert belt.lowest_margin == pytest.approx(expected, abs=1e-9)


def test_a_change_of_tension_within_a_step_is_joined():
    # the tension rises over one step from nothing to just above the critical load: its end counts
    belt = BeltMonitor(travel=1.0, velocity=0.0, acceleration=0.0, inputs_at_step_end=True)
    belt.initialize(0.0)
    assert belt.lowest_margin == 1.0
    belt.yarn_tension = 1.01 * belt.critical_force
    belt.step(0.0, 1e-3)
    assert belt.lowest_margin == pytest.approx(-0.01, abs=1e-12)  # rounding of 1.01
    assert belt.buckled


def test_standing_still_there_is_no_speed_limit():
    belt = BeltMonitor(speed=0.0, travel=1.0, velocity=0.0, acceleration=200.0, inputs_at_step_end=True)
    assert belt.initialize(0.0) == 0
    for n in range(5):
        belt.step(n * 1e-3, 1e-3)
    assert belt.speed_limit == belt.lowest_speed_limit == NO_LIMIT
    # the margin knows no shaft: 22.1 N against the load that a free length of 0.207 m bears
    critical = critical_force(0.207, 0.8, 0.25)
    assert belt.margin == pytest.approx(1.0 - 0.1105 * 200.0 / critical, abs=1e-14)  # rounding
    assert belt.at_risk


def test_inside_the_guide_nothing_is_at_risk():
    belt = BeltMonitor(travel=0.5, acceleration=1e4)
    belt.initialize(0.0)
    assert (belt.margin, belt.at_risk, belt.buckled, belt.deflection) == (1.0, False, False, 0.0)
    assert belt.free_length == pytest.approx(-0.293, abs=1e-15)  # rounding
    assert belt.speed_limit == NO_LIMIT
    assert belt.critical_force == critical_force(1e-3, 0.8, 0.25)


def test_samples_closer_than_their_squares_can_be_told_apart_are_one():
    """A shaft that turns by 1e-232 rad between samples: the square of that underflows."""
    belt = BeltMonitor(follow_shaft=True, inputs_at_step_end=True)
    assert belt.initialize(0.0) == 0
    belt.shaft_angle = 1e-232
    assert belt.step(0.0, 1e-200) == 0
    assert belt.lowest_margin == pytest.approx(belt.margin)
