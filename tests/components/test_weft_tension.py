"""WeftTension: each effect alone and exact, all of them against an ODE solver, the pick's events, slack."""

import re
from functools import partial
from math import cos, exp, pi, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from loomfmu.components.weft_insertion import WeftInsertion
from loomfmu.components.weft_tension import WeftTension
from loomfmu.declaring.variables import variables_of
from loomfmu.physics.weft import capstan_gain, drag_per_length
from loomfmu.units import parse

RPM = pi / 30.0
SPEED = 400.0 * RPM
NOTHING = {
    "linear_density": 0.0,
    "air_friction": 0.0,
    "supply_tension": 0.0,
    "brake_force": 0.0,
    "friction": 0.0,
    "pick_up_travel": 0.0,
}


def harmonic(t, speed=SPEED, stroke=2.0):
    """Motion of a head between its dead centres."""
    return (
        0.5 * stroke * (1.0 - cos(speed * t)),
        0.5 * stroke * speed * sin(speed * t),
        0.5 * stroke * speed**2 * cos(speed * t),
    )


def drawn(motion=harmonic, end=2.0 * pi / SPEED, steps=720, start=0.0, watch=None, **parameters):
    """A weft after a motion of the head, as our master runs it; `watch` sees it after each step."""
    weft = WeftTension(**{"inputs_at_step_end": True, "speed": SPEED} | parameters)
    step = (end - start) / steps
    for n in range(steps + 1):
        now = start + n * step
        weft.travel, weft.velocity, weft.acceleration = motion(now)
        assert (weft.step(now - step, step) if n else weft.initialize(start)) == 0
        if watch:
            watch(now, weft)
    return weft


# Each effect alone, to rounding


DRAG = drag_per_length(0.04, 0.2e-3)
ALONE = {  # parameters, and the tension at a travel, velocity and acceleration of the head
    "capstan": (
        {"brake_force": 0.3, "supply_tension": 0.05, "friction": 0.25, "wrap_angle": 2.5},
        lambda _s, _v, _a: 0.35 * exp(0.25 * 2.5),
    ),
    # while the yarn pulls: the rate of its momentum, q (v^2 + L a)
    "momentum": (
        {"linear_density": 30e-6, "yarn_stiffness": 1e4},
        lambda s, v, a: max(30e-6 * (v**2 + (0.6 + s) * a), 0.0),
    ),
    # the brake holds: a spring of the length that it had, and its damper
    "spring": ({"brake_force": 1e3, "retardation_time": 1e-3}, lambda s, v, _a: 75.0 * (s + 1e-3 * v) / 0.6),
    "drag": ({"air_friction": 0.04, "yarn_diameter": 0.2e-3}, lambda s, v, _a: DRAG * (0.6 + s) * v**2),
}


@pytest.mark.parametrize("effect", ALONE)
def test_each_effect_alone(effect):
    parameters, tension = ALONE[effect]
    seen = []

    def watch(now, weft):
        if 0.1 < SPEED * now < pi - 1e-6:  # on the way in, without the steps in which it is taken
            seen.append((weft.tension, tension(*harmonic(now)), weft.slack))
            assert seen[-1][0] == pytest.approx(seen[-1][1], rel=1e-12, abs=1e-14)

    weft = drawn(**NOTHING | parameters, end=pi / SPEED, watch=watch)
    assert weft.highest_tension >= max(found for found, _exact, _slack in seen) * (1.0 - 1e-15)
    assert {slack for *_, slack in seen} == ({False, True} if effect == "momentum" else {False})


# All together, against a solver


PROGRAM = {f"brake_program_{n}": 1.0 + 0.8 * sin(n) for n in range(1, 25)}
EVERYTHING = PROGRAM | {"retardation_time": 2e-3, "pick_up_travel": 0.0, "yarn_stiffness": 20.0}


def brake_at(angle):
    place = angle * 24.0 / (2.0 * pi)
    point = int(place // 1.0)
    u = place - point
    low, high = (1.0 + 0.8 * sin((point + k) % 24 + 1) for k in (0, 1))
    return 0.2 * (low + (high - low) * u * u * (3.0 - 2.0 * u))


def solved(times):
    """Tension by F' = min((EA + F) v / L, (H - F) / tau), from the giver's start to the taker's end."""
    gain, drag = capstan_gain(0.2, 0.5 * pi), drag_per_length(0.04, 0.2e-3)

    def parts(t):
        travel, velocity, acceleration = harmonic(t)
        sign = 1.0 if SPEED * t < pi else -1.0
        length = 0.6 + travel if sign > 0.0 else 4.6 - travel
        limit = gain * (0.05 + brake_at(SPEED * t)) + 30e-6 * velocity**2
        return length, sign * velocity, sign * acceleration, limit

    def rate(t, force):
        length, speed, _acceleration, limit = parts(t)
        return [min((20.0 + force[0]) * speed / length, (limit - force[0]) / 2e-3)]

    found = solve_ivp(rate, (0.0, times[-1]), [0.0], "LSODA", times, rtol=1e-11, atol=1e-12, max_step=5e-5)
    tensions = []
    for t, force in zip(times, found.y[0], strict=True):
        length, speed, acceleration, limit = parts(t)
        behind = min(force + 2e-3 * (20.0 + force) * speed / length, limit)
        tensions.append(max(behind + length * (30e-6 * acceleration + drag * speed**2), 0.0))
    return np.array(tensions)


@pytest.mark.no_cover
@pytest.mark.parametrize(
    ("steps", "error"), [(50, 2e-9), (72, 5e-10), (100, 2e-10), (144, 1e-10), (720, 1e-10)]
)
def test_everything_together(steps, error):
    times = np.linspace(0.0, 2.0 * pi / SPEED, steps + 1)[1:-1]
    seen = []
    weft = drawn(steps=steps, watch=lambda _now, weft: seen.append(weft.tension), **EVERYTHING)
    difference = np.abs(np.array(seen)[1:-1] - solved(times))
    # at the hand-over itself the acceleration, and with it the tension, jumps
    difference[steps // 2 - 1] = 0.0
    # cubics of the limit on quarters of a step, wherever the points lie; at last the solver's own 4e-11
    assert difference.max() < error
    assert weft.highest_tension >= max(seen) * (1.0 - 1e-15)


@pytest.mark.no_cover
@pytest.mark.parametrize("steps", [24, 30, 50, 78, 100])
def test_the_highest_tension_does_not_depend_on_where_samples_meet_the_program(steps):
    times = np.linspace(0.0, 2.0 * pi / SPEED, 20001)[1:-1]
    weft = drawn(steps=steps, **EVERYTHING)
    # 2 curves of fourth order in a quarter of 15 deg: 3e-7 at most; the solver looks every 7 us
    assert weft.highest_tension == pytest.approx(solved(times).max(), abs=4e-7)


def test_a_short_hold_of_the_brake_is_not_missed():
    """The brake closes fast from 135 to 150 deg, and holds a soft yarn meanwhile for less than 4 deg."""

    def strains(steps):
        seen = []
        soft = {"pick_up_travel": 0.0, "yarn_stiffness": 5.0, "retardation_time": 2e-4}
        drawn(
            steps=steps,
            end=pi / SPEED,
            watch=lambda _now, weft: seen.append(weft.strain),
            brake_program_11=1.9224310776942357,
            **soft,
        )
        return np.array(seen)

    # missed it is 4e-6; the cubics of the coarse steps are 2e-9 off
    assert strains(10) == pytest.approx(strains(360)[::36], abs=1e-8)


def test_the_way_through_the_program_may_be_long_or_backward():
    """Steps of a whole revolution, or a shaft that turns backward, see every point of the program."""
    backward = drawn(
        steps=50,
        speed=-SPEED,
        **EVERYTHING | {f"brake_program_{n}": 1.0 + 0.8 * sin(26 - n) for n in range(2, 25)},
    )
    forward = drawn(steps=50, **EVERYTHING)
    # mirrored about 0 deg: point n becomes point 26 - n; the same but for rounding
    assert backward.highest_tension == pytest.approx(forward.highest_tension, rel=1e-10)
    at_rest = NOTHING | PROGRAM | {"brake_force": 0.2, "retardation_time": 1e-4}
    resting = drawn(lambda _t: (1.0, 0.0, 0.0), 20.0 * pi / SPEED, 7, **at_rest)  # 34 points in a step
    lowest = 0.2 * min(PROGRAM.values())
    # the brake lets go what it holds less of, with a lag of 0.1 ms behind a program that stays there for 1 ms
    assert resting.strain * 75.0 == pytest.approx(lowest, rel=1e-3)


@pytest.mark.few(1)
@pytest.mark.no_cover
@pytest.mark.parametrize("at_end", [True, False])
def test_extremes_do_not_depend_on_the_step(at_end):
    def on_a_loom(steps):
        weft, head = WeftTension(inputs_at_step_end=at_end, speed=60.0), WeftInsertion(speed=60.0)
        step = 2.0 * pi / 60.0 / steps
        head.initialize(0.0)
        for n in range(steps + 2):
            weft.travel, weft.velocity, weft.acceleration = head.travel, head.velocity, head.acceleration
            assert (weft.step((n - at_end) * step, step) if n else weft.initialize(0.0)) == 0
            head.step(n * step, step)
        return weft.highest_tension, weft.longest_slack

    fine = on_a_loom(2880)
    assert fine[1] > 1e-3  # the taker brakes harder than the yarn's brake
    for steps, error in ((72, 1e-5), (144, 4e-7), (720, 2e-9)):
        # the quintic between samples; the rest is their rounding, in the acceleration
        assert on_a_loom(steps) == pytest.approx(fine, rel=error)


README = Path(__file__).parents[2] / "fmus" / "weft_tension" / "README.md"
BANDS = re.findall(
    r"^\| `(\w+)`[^|]*\| [^|]* \| (\S+) \.\. (\S+) ?([^|]*?) \| (.*) \|$", README.read_text(), re.MULTILINE
)


def on_the_demo(name, value):
    """Highest tension and snatch in cN, longest slack in ms, with one other value."""
    weft, head = WeftTension(inputs_at_step_end=True, speed=600.0 * RPM, **{name: value}), WeftInsertion()
    head.speed = weft.speed
    head.initialize(0.0)
    step = 2.0 * pi / weft.speed / 144
    for n in range(145):
        weft.travel, weft.velocity, weft.acceleration = head.travel, head.velocity, head.acceleration
        assert (weft.step((n - 1) * step, step) if n else weft.initialize(0.0)) == 0
        head.step(n * step, step)
    return 100.0 * weft.highest_tension, 100.0 * weft.highest_snatch, 1e3 * weft.longest_slack


@pytest.mark.few(4)
@pytest.mark.parametrize("band", BANDS, ids=lambda band: band[0])
def test_the_readme_prints_what_the_ends_of_the_assumed_ranges_do(band):
    name, low, high, unit, printed = band
    target = next(variable.unit for variable in variables_of(WeftTension) if variable.name == name)
    ends = [on_the_demo(name, parse(f"{each} {unit or '1'}", target)) for each in (low, high)]
    for texts, values in zip(printed.split(" | "), zip(*ends, strict=True), strict=True):
        texts = texts.split(" .. ")
        for text, value in zip(texts if len(texts) == 2 else 2 * texts, values, strict=True):
            digits = len(text.partition(".")[2])
            assert round(value, digits) == float(text), (name, text, value)


# Laws

positive = st.floats(0.01, 2.0)


def peak(**parameters):
    return drawn(steps=90, **parameters).highest_tension


@pytest.mark.no_cover
@settings(max_examples=15)
@given(positive, positive)
def test_a_stronger_brake_never_lowers_the_highest_tension(force, more):
    assert peak(brake_force=force + more) >= peak(brake_force=force) - 1e-12


@pytest.mark.no_cover
@settings(max_examples=15)
@given(positive, st.floats(0.0, 0.6), st.floats(0.0, 4.0))
def test_eyes_multiply_what_is_behind_them(force, friction, angle):
    massless = {"linear_density": 0.0, "air_friction": 0.0, "brake_force": force, "yarn_stiffness": 1e3}
    plain = peak(friction=0.0, **massless)
    assert peak(friction=friction, wrap_angle=angle, **massless) == pytest.approx(
        plain * exp(friction * angle), rel=1e-12
    )


@settings(max_examples=15)
@given(positive, st.floats(1e-6, 1e-3), st.floats(1.0, 1e4), st.floats(1e-7, 1e-2), st.floats(0.0, 0.5))
def test_yarn_never_pushes(force, density, stiffness, retardation, pick_up):
    def watch(_now, weft):
        assert weft.tension >= 0.0
        assert weft.tension <= weft.highest_tension * (1.0 + 1e-12)
        assert weft.slack == (weft.carried and weft.tension == 0.0)

    drawn(
        steps=90,
        brake_force=force,
        linear_density=density,
        yarn_stiffness=stiffness,
        watch=watch,
        retardation_time=retardation,
        pick_up_travel=pick_up,
    )


@pytest.mark.no_cover
@settings(max_examples=10)
@given(st.floats(0.1, 10.0))
def test_all_forces_scale_together(scale):
    forces = {"linear_density": 30e-6, "air_friction": 0.04, "brake_force": 0.2, "supply_tension": 0.05}
    forces["yarn_stiffness"] = 75.0
    scaled = {name: value * scale for name, value in forces.items()}
    assert peak(**scaled) == pytest.approx(scale * peak(**forces), rel=1e-11)


# A pick from start to end


def test_a_pick():
    seen = {}

    def watch(now, weft):
        seen[round(np.degrees(SPEED * now), 6)] = weft.carried, weft.length, weft.tension

    drawn(steps=720, end=1.5 * 2.0 * pi / SPEED, watch=watch, pick_up_travel=0.25)
    assert seen[41.25][0] is False and seen[41.25][2] == 0.0  # travel 0.248
    assert seen[42.0][0] is True
    assert seen[90.0][1] == pytest.approx(0.6 + 1.0 - 0.25, abs=1e-14)
    assert seen[180.0][1] == pytest.approx(0.6 + 2.0 - 0.25, abs=1e-14)
    assert seen[270.0][1] == pytest.approx(0.6 + 2.0 - 0.25 + 1.0, abs=1e-14)  # the taker draws on
    assert seen[318.0][0] is True
    assert seen[319.5][0] is False
    # the next pick is like the first one
    assert seen[450.0] == pytest.approx(seen[90.0], rel=1e-9)


def test_hand_over_between_samples():
    """What is drawn does not depend on whether a sample lies at the dead centre."""
    late = partial(drawn, start=0.003 * 2.0 * pi / SPEED, end=0.753 * 2.0 * pi / SPEED, pick_up_travel=0.0)
    exact = 4.6 - harmonic(0.753 * 2.0 * pi / SPEED)[0]
    for steps in (100, 1000):
        assert late(steps=steps).length == pytest.approx(exact, rel=1e-8)


@pytest.mark.parametrize("steps", [7, 50, 400])
def test_slack_is_timed_exactly(steps):
    """A head that brakes evenly: q (v^2 + L a) falls to zero at the root of a quadratic."""
    speed, brake = 30.0, -800.0

    def motion(t):
        return speed * t + 0.5 * brake * t * t, speed + brake * t, brake

    end = 0.9 * speed / -brake
    weft = drawn(motion, end, steps, **NOTHING | {"linear_density": 30e-6, "yarn_stiffness": 1e4})
    # v^2 + a L = v0^2 + a L0 + 3 v0 a t + 1.5 (a t)^2
    a, b, c = 1.5 * brake**2, 3.0 * speed * brake, speed**2 + 0.6 * brake
    hanging = end - (-b - sqrt(b * b - 4.0 * a * c)) / (2.0 * a)
    # roundings of the samples, over the slope of the tension
    assert weft.longest_slack == pytest.approx(hanging, rel=1e-11)
    assert weft.slack


def test_a_weft_that_is_carried_at_the_start_is_drawn_steadily():
    weft = WeftTension(travel=1.0, velocity=10.0, acceleration=0.0, **{"air_friction": 0.0})
    assert weft.initialize(0.0) == 0
    assert weft.tension == pytest.approx(exp(0.1 * pi) * (0.05 + 0.2) + 30e-6 * 100.0, rel=1e-12)
    late = WeftTension(travel=1.0, velocity=-10.0)
    assert late.initialize(0.0) == 0
    assert late.carried and late.length == pytest.approx(0.6 + 1.0 - 0.1)


@pytest.mark.parametrize("velocity", [0.0, 1e-13, -1e-13, -5e-12])
def test_a_start_at_the_hand_over_is_the_givers_whatever_rounding_leaves_of_the_velocity(velocity):
    # its head slows down; the taker would quicken, and the tension be 23 % higher
    weft = WeftTension(travel=2.0, velocity=velocity, acceleration=-2000.0, brake_force=1.0)
    assert weft.initialize(0.0) == 0
    assert weft.tension == pytest.approx(exp(0.1 * pi) * 1.05 - 30e-6 * 2.5 * 2000.0, rel=1e-12)


# Motions of a loom that are not picks


def rocking(t):
    """A shaft that turns to 100 deg, back by 20 deg and on: its angle, velocity and acceleration."""
    phase = 30.0 * t
    middle, swing = np.radians(90.0), np.radians(10.0)
    if phase < 0.5 * pi:  # up to the first reversal
        angle = (middle + swing) * (1.0 - cos(phase))
        return angle, 30.0 * (middle + swing) * sin(phase), 900.0 * (middle + swing) * cos(phase)
    return (
        middle + swing * cos(phase - 0.5 * pi),
        -30.0 * swing * sin(phase - 0.5 * pi),
        -900.0 * swing * cos(phase - 0.5 * pi),
    )


def known(motion, pick_up, steps=200, end=0.25):
    """Whether the weft was followed, after each step of a shaft that moves a harmonic head."""
    weft, seen = WeftTension(inputs_at_step_end=True, follow_shaft=True, pick_up_travel=pick_up), []
    step = end / steps
    for n in range(steps + 1):
        angle, speed, change = motion(n * step)
        weft.shaft_angle, weft.shaft_velocity, weft.shaft_acceleration = angle, speed, change
        weft.travel = 1.0 - cos(angle)
        weft.velocity = sin(angle) * speed
        weft.acceleration = cos(angle) * speed**2 + sin(angle) * change
        assert (weft.step((n - 1) * step, step) if n else weft.initialize(0.0)) == 0
        seen.append(weft.followed)
    return seen


def test_a_shaft_that_turns_back_in_mid_shed_is_not_followed():
    seen = known(rocking, 0.1)
    turned_back = int(0.5 * pi / 30.0 / 0.25 * 200)
    assert all(seen[: turned_back + 1])
    assert not any(seen[turned_back + 2 :])


def test_a_shaft_that_turns_back_outside_the_shed_or_turns_backward_throughout_is():
    assert all(known(rocking, 1.3))  # 1 - cos(100 deg) = 1.17: no head carries the weft yet
    assert all(known(lambda t: (-60.0 * t, -60.0, 0.0), 0.1))
    assert all(
        known(
            lambda t: (
                (2.0, 0.0, 0.0) if t < 0.1 else (2.0 + 300.0 * (t - 0.1) ** 2, 600.0 * (t - 0.1), 600.0)
            ),
            0.1,
        )
    )


def test_rounding_turns_no_head_round():
    """A shaft at rest after many turns: the last bits of the travel fell, and the yarn with them."""

    def trembling(t):
        travel, _velocity, _acceleration = harmonic(0.25 * pi / SPEED)
        return travel * (1.0 + 1e-13 * (-1) ** round(1e4 * t)), 0.0, 0.0

    tensions = []
    drawn(trembling, end=0.002, steps=20, watch=lambda _now, weft: tensions.append(weft.tension))
    assert tensions[0] > 0.3 and tensions == pytest.approx(21 * [tensions[0]], rel=1e-9)


def test_the_snatch_is_that_of_the_wave_along_the_yarn():
    """The wave equation for yarn at rest whose end moves off at v; exact along its characteristics."""
    stiffness, density, speed = 75.0, 30e-6, 20.0
    wave = sqrt(stiffness / density)
    cells, length = 200, 0.6
    cell = length / cells
    before, now = np.zeros(cells + 1), np.zeros(cells + 1)
    for n in range(1, 2 * cells):  # until the wave is back
        following = np.zeros(cells + 1)
        following[1:-1] = now[2:] + now[:-2] - before[1:-1]
        following[-1] = speed * n * cell / wave
        before, now = now, following
        # the tension at the head, constant from the first step on
        assert stiffness * (now[-1] - now[-2]) / cell == pytest.approx(speed * sqrt(stiffness * density))

    steady = partial(drawn, lambda t: (speed * t, speed, 0.0), 0.02)
    for steps in (7, 50):
        weft = steady(steps, pick_up_travel=0.1, linear_density=density, yarn_stiffness=stiffness)
        assert weft.highest_snatch == pytest.approx(speed * sqrt(stiffness * density), rel=1e-12)
    # the giver takes the yarn up at s = 0.25 m of harmonic motion, at any step
    for steps in (24, 50, 360):
        weft = drawn(steps=steps, pick_up_travel=0.25)
        there = SPEED * sin(np.arccos(0.75))
        assert weft.highest_snatch == pytest.approx(there * sqrt(75.0 * 30e-6), rel=3e-6 * (24 / steps) ** 4)
    assert drawn(pick_up_travel=0.0).highest_snatch == pytest.approx(0.0, abs=1e-6)
